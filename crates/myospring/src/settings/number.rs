//! The numbers of a run by name: settings that are quantities, and the parameters of its cell
//! model.

use super::setting::ValueKind;
use super::value::Value;
use super::{Named, Problem, Run, find, table};
use crate::parameter::alike;
use crate::units::{self, Dimension, UnitError};

const PARAMETERS: &str = "cell.parameters";
/// How many names are offered for one that does not exist.
const OFFERED: usize = 3;

/// A number of a run: a parameter of the cell model, or a setting that is a quantity.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NumericSetting {
    /// Its key in a run file: `cell.parameters.tau_si`, `material.thickness`.
    pub key: String,
    /// Its unit; empty for a dimensionless number.
    pub unit: String,
}

/// Why a name does not identify a number.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NumberError {
    /// No number of the run has that name.
    #[error(
        "`{name}` is neither a parameter of the cell model {model} nor a setting with a number{}",
        offered(nearest)
    )]
    Unknown {
        /// The requested name.
        name: String,
        /// The model whose parameters were searched.
        model: String,
        /// The most similar names, the most similar first.
        nearest: Vec<String>,
    },
    /// A setting that is not a number.
    #[error(
        "`{key}` is a setting, but not a number, so it cannot be varied; give it a fixed value"
    )]
    OtherSetting {
        /// Its key.
        key: String,
    },
    /// Several numbers have that name.
    #[error("`{name}` is ambiguous; write one of: {}", keys.join(", "))]
    Several {
        /// The requested name.
        name: String,
        /// Their keys.
        keys: Vec<String>,
    },
}

fn offered(nearest: &[String]) -> String {
    if nearest.is_empty() {
        String::new()
    } else {
        format!("; the nearest are {}", nearest.join(", "))
    }
}

impl NumericSetting {
    /// All numbers of a run: those of its cell model first.
    pub fn all(run: &Run) -> Vec<Self> {
        let rows = run.cell.parameters().rows().iter();
        let parameters = rows.map(|row| Self {
            key: format!("{PARAMETERS}.{}", row.name),
            unit: row.unit.to_string(),
        });
        let settings = table().filter(|setting| matches!(setting.kind, ValueKind::Quantity { .. }));
        let settings = settings.map(|setting| Self {
            key: setting.key.to_owned(),
            unit: setting.unit().unwrap_or_default().to_owned(),
        });
        parameters.chain(settings).collect()
    }

    /// The number of a run with this name (`tau_si`, `peak_tension`) or key (`material.thickness`).
    ///
    /// # Errors
    /// An unknown name, with similar ones, or an ambiguous one.
    ///
    /// # Example
    /// ```
    /// use myospring::settings::{NumericSetting, Run};
    /// let mut run = Run::default_run();
    /// let thickness = NumericSetting::named(&run, "thickness")?;
    /// assert_eq!((thickness.key.as_str(), thickness.get(&run)), ("material.thickness", Some(10.0)));
    /// thickness.set(&mut run, 8.0)?;
    /// assert_eq!(run.material.thickness, 8.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn named(run: &Run, name: &str) -> Result<Self, NumberError> {
        let all = Self::all(run);
        if let Some(number) = all.iter().find(|number| number.key == name) {
            return Ok(number.clone());
        }
        let mut found: Vec<&Self> = all.iter().filter(|number| number.name() == name).collect();
        match found.len() {
            1 => Ok(found.remove(0).clone()),
            0 => {
                let last = |key: &str| key.rsplit_once('.').is_some_and(|(_, end)| end == name);
                if let Some(other) = table().find(|it| it.key == name || last(it.key)) {
                    return Err(NumberError::OtherSetting { key: other.key.to_owned() });
                }
                let name = name.to_owned();
                let likest = alike(&name, all.iter().map(Self::name)).into_iter().take(OFFERED);
                let nearest = likest.map(str::to_owned);
                let model = run.cell.name().to_owned();
                Err(NumberError::Unknown { name, model, nearest: nearest.collect() })
            }
            _ => {
                let keys = found.into_iter().map(|number| number.key.clone()).collect();
                Err(NumberError::Several { name: name.to_owned(), keys })
            }
        }
    }

    /// Its name without the table: `tau_si`.
    pub fn name(&self) -> &str {
        self.key.rsplit_once('.').map_or(self.key.as_str(), |(_, name)| name)
    }

    /// The parameter of the cell model that it is; `None` for a setting.
    pub fn parameter(&self) -> Option<&str> {
        self.key.strip_prefix(PARAMETERS)?.strip_prefix('.')
    }

    /// Its value in a run, in its unit; `None` if the run determines it itself, or has none.
    pub fn get(&self, run: &Run) -> Option<f64> {
        if let Some(parameter) = self.parameter() {
            return run.cell.parameters().get(parameter);
        }
        match find(&self.key)?.kind {
            ValueKind::Quantity { get, .. } => get(run),
            _ => None,
        }
    }

    /// Sets its value, in its unit.
    ///
    /// # Errors
    /// A value outside its bounds.
    pub fn set(&self, run: &mut Run, value: f64) -> Result<(), Problem> {
        let parameter = self.parameter();
        let Some(setting) = find(parameter.map_or(&self.key, |_| PARAMETERS)) else {
            return Ok(());
        };
        let value = match parameter {
            Some(parameter) => {
                Value::Named(Named::from([(parameter.to_owned(), Value::Number(value))]))
            }
            None => self.written(value),
        };
        setting.set(run, &value).map_err(|(_, problem)| problem)
    }

    /// A value, in its unit, as written in a run file.
    pub fn written(&self, value: f64) -> Value {
        let setting = find(&self.key);
        let whole = setting.is_some_and(|it| matches!(it.kind, ValueKind::Whole { .. }));
        match setting.and_then(super::Setting::bounds) {
            // As text, its error would not say that it is not a number.
            _ if !value.is_finite() => Value::Number(value),
            _ if whole && value.fract() == 0.0 => Value::Whole(value as i64),
            Some(bounds) => Value::Text(units::format(value, bounds.dimension)),
            None => Value::Number(value),
        }
    }

    /// Reads a value as written by a user: `"1 um"`, or a number in its unit.
    ///
    /// # Errors
    /// A unit of another dimension, or text that is not a number.
    pub fn read(&self, text: &str) -> Result<f64, UnitError> {
        let bounds = find(&self.key).and_then(super::Setting::bounds);
        let dimension = bounds.map(|bounds| bounds.dimension);
        let dimension = dimension.or_else(|| Dimension::of_unit(&self.unit));
        units::parse(text, dimension.unwrap_or(Dimension::Number))
    }
}
