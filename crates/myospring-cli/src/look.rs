//! The style of figures and films: colouring of the cell, light or dark.

use clap::Args;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use myospring::experiment::run::Style;
use myospring::output::field::Field;
use myospring::output::figure::Theme;

/// The style of figures and films.
#[derive(Debug, Clone, Copy, Default, Args)]
pub(crate) struct Look {
    /// Quantity that colours the cell in figures and films [default: fibre-strain, of a tissue potential]
    #[arg(long, value_name = "NAME", value_parser = colours(), help_heading = super::args::OUTPUT)]
    pub(crate) colour: Option<Field>,
    /// Background of figures and films
    #[arg(long, value_name = "THEME", value_parser = themes(), default_value = Theme::default().word(),
          help_heading = super::args::OUTPUT)]
    pub(crate) theme: Theme,
}

impl From<Look> for Style {
    fn from(Look { colour, theme }: Look) -> Self {
        Self { colour, theme }
    }
}

fn colours() -> impl TypedValueParser<Value = Field> {
    let value = |field: Field| {
        let unit = Some(field.unit()).filter(|unit| !unit.is_empty());
        let unit = unit.map(|unit| format!(", {unit}")).unwrap_or_default();
        PossibleValue::new(field.word()).help(format!("{}{unit}", field.definition()))
    };
    PossibleValuesParser::new(Field::ALL.map(value))
        .map(|word| Field::ALL.into_iter().find(|field| field.word() == word).unwrap_or_default())
}

fn themes() -> impl TypedValueParser<Value = Theme> {
    PossibleValuesParser::new(Theme::ALL.map(Theme::word))
        .map(|word| Theme::ALL.into_iter().find(|theme| theme.word() == word).unwrap_or_default())
}
