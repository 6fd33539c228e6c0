//! The internal unit system, and quantities as text.
//!
//! Inside the library every number is a plain `f64` in one coherent system: ms, um, nN, ug, kPa
//! (= nN/um^2), nN/um, fJ (= nN um), mV, uM, mS/uF, A/F, nS, pA, pF. `1 nN = 1 ug um/ms^2`, so no equation
//! carries a hidden factor, and likewise in electrophysiology: `1 mS/uF mV = 1 A/F = 1 mV/ms`, the rate of
//! a membrane potential, `1 nS mV = 1 pA` and `1 pA/pF = 1 A/F`. Text becomes a number only here.

mod symbol;

use std::fmt;
pub use symbol::symbol;

/// What a quantity measures; it determines the internal unit and the accepted units.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Dimension {
    /// Time, ms.
    Time,
    /// Length, um.
    Length,
    /// Area, um^2.
    Area,
    /// Pressure, stress, tension or modulus, kPa.
    Pressure,
    /// Force, nN.
    Force,
    /// Spring stiffness, nN/um.
    Stiffness,
    /// Stiffness of an elastic bed, traction per displacement, kPa/um.
    BedStiffness,
    /// Dashpot coefficient, nN ms/um.
    Damping,
    /// Mass, ug.
    Mass,
    /// Mass density, ug/um^3.
    Density,
    /// Energy, fJ.
    Energy,
    /// Electric potential, mV.
    Voltage,
    /// Concentration, uM.
    Concentration,
    /// Conductance per membrane capacitance, mS/uF.
    ConductanceDensity,
    /// Current per membrane capacitance, A/F.
    CurrentDensity,
    /// Conductance, nS.
    Conductance,
    /// Current, pA.
    Current,
    /// Capacitance, pF.
    Capacitance,
    /// Rate, 1/ms.
    Rate,
    /// Speed, um/ms.
    Speed,
    /// Diffusion coefficient, um^2/ms.
    Diffusion,
    /// Angle, degrees.
    Angle,
    /// A dimensionless number; also accepted as a percentage.
    Number,
}

/// Symbols of units and their factors to the internal unit, which comes first. Names and other
/// spellings are converted to symbols before ([`symbol()`]).
type UnitTable = &'static [(&'static str, f64)];

impl Dimension {
    const fn table(self) -> UnitTable {
        match self {
            Self::Time => &[("ms", 1.0), ("s", 1e3), ("us", 1e-3), ("min", 6e4)],
            Self::Length => &[("um", 1.0), ("nm", 1e-3), ("mm", 1e3), ("m", 1e6)],
            Self::Area => &[("um^2", 1.0), ("mm^2", 1e6)],
            Self::Pressure => {
                &[("kPa", 1.0), ("Pa", 1e-3), ("MPa", 1e3), ("mN/mm^2", 1.0), ("nN/um^2", 1.0)]
            }
            Self::Force => &[("nN", 1.0), ("uN", 1e3), ("mN", 1e6), ("pN", 1e-3)],
            Self::Stiffness => {
                &[("nN/um", 1.0), ("mN/m", 1.0), ("N/m", 1e3), ("uN/um", 1e3), ("pN/nm", 1.0)]
            }
            Self::BedStiffness => &[("kPa/um", 1.0), ("Pa/um", 1e-3), ("nN/um^3", 1.0)],
            Self::Damping => &[("nN ms/um", 1.0), ("nN s/um", 1e3)],
            Self::Mass => &[("ug", 1.0), ("ng", 1e-3), ("mg", 1e3)],
            Self::Density => &[("ug/um^3", 1.0), ("kg/m^3", 1e-9), ("g/cm^3", 1e-6)],
            Self::Energy => &[("fJ", 1.0), ("pJ", 1e3)],
            Self::Voltage => &[("mV", 1.0), ("V", 1e3), ("uV", 1e-3)],
            Self::Concentration => {
                &[("uM", 1.0), ("nM", 1e-3), ("mM", 1e3), ("M", 1e6), ("pM", 1e-6)]
            }
            Self::ConductanceDensity => {
                &[("mS/uF", 1.0), ("nS/pF", 1.0), ("uS/nF", 1.0), ("S/F", 1e-3)]
            }
            Self::CurrentDensity => &[("A/F", 1.0), ("pA/pF", 1.0), ("uA/uF", 1.0), ("nA/nF", 1.0)],
            Self::Conductance => &[("nS", 1.0), ("pS", 1e-3), ("uS", 1e3), ("mS", 1e6), ("S", 1e9)],
            Self::Current => &[("pA", 1.0), ("nA", 1e3), ("uA", 1e6), ("mA", 1e9), ("A", 1e12)],
            Self::Capacitance => &[("pF", 1.0), ("nF", 1e3), ("uF", 1e6), ("mF", 1e9), ("F", 1e12)],
            Self::Rate => &[("1/ms", 1.0), ("/ms", 1.0), ("1/s", 1e-3), ("/s", 1e-3), ("Hz", 1e-3)],
            Self::Speed => {
                &[("um/ms", 1.0), ("um/s", 1e-3), ("mm/s", 1.0), ("cm/s", 10.0), ("m/s", 1e3)]
            }
            Self::Diffusion => {
                &[("um^2/ms", 1.0), ("cm^2/s", 1e5), ("mm^2/s", 1e3), ("mm^2/ms", 1e6)]
            }
            Self::Angle => &[("deg", 1.0), ("°", 1.0), ("rad", 57.295_779_513_082_32)],
            Self::Number => &[("", 1.0), ("%", 0.01)],
        }
    }

    /// The internal unit: `um`, `kPa`, `ms`.
    pub const fn unit(self) -> &'static str {
        self.table()[0].0
    }

    /// The accepted units, the internal one first.
    pub fn symbols(self) -> impl Iterator<Item = &'static str> {
        self.table().iter().map(|row| row.0)
    }

    /// The dimension's name in a sentence: `a length`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Time => "a time",
            Self::Length => "a length",
            Self::Area => "an area",
            Self::Pressure => "a pressure",
            Self::Force => "a force",
            Self::Stiffness => "a stiffness",
            Self::BedStiffness => "a bed stiffness",
            Self::Damping => "a dashpot coefficient",
            Self::Mass => "a mass",
            Self::Density => "a density",
            Self::Energy => "an energy",
            Self::Voltage => "a potential",
            Self::Concentration => "a concentration",
            Self::ConductanceDensity => "a conductance per capacitance",
            Self::CurrentDensity => "a current per capacitance",
            Self::Conductance => "a conductance",
            Self::Current => "a current",
            Self::Capacitance => "a capacitance",
            Self::Rate => "a rate",
            Self::Speed => "a speed",
            Self::Diffusion => "a diffusion coefficient",
            Self::Angle => "an angle",
            Self::Number => "a number",
        }
    }

    const ALL: [Self; 23] = [
        Self::Time,
        Self::Length,
        Self::Area,
        Self::Pressure,
        Self::Force,
        Self::Stiffness,
        Self::BedStiffness,
        Self::Damping,
        Self::Mass,
        Self::Density,
        Self::Energy,
        Self::Voltage,
        Self::Concentration,
        Self::ConductanceDensity,
        Self::CurrentDensity,
        Self::Conductance,
        Self::Current,
        Self::Capacitance,
        Self::Rate,
        Self::Speed,
        Self::Diffusion,
        Self::Angle,
        Self::Number,
    ];

    /// The dimension whose internal unit this is; `""` is dimensionless.
    pub fn of_unit(unit: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|dimension| dimension.unit() == unit)
    }

    fn accepted(self) -> String {
        let names: Vec<&str> =
            self.table().iter().map(|row| row.0).filter(|unit| unit.is_ascii()).collect();
        if self == Self::Number { "none or %".to_owned() } else { names.join(", ") }
    }
}

impl fmt::Display for Dimension {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Whether a text is a unit of anything: `um`, `microns`.
pub fn is_unit(text: &str) -> bool {
    let unit = symbol(text);
    let tables = Dimension::ALL.iter().flat_map(|dimension| dimension.table());
    !unit.is_empty() && tables.into_iter().any(|row| row.0 == unit)
}

/// Why a text is not the expected quantity.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum UnitError {
    /// The text does not start with a number.
    #[error("`{text}` does not start with a number; write it like \"{example}\"")]
    NotANumber {
        /// The text.
        text: String,
        /// An example of a correct text.
        example: String,
    },
    /// NaN or infinity.
    #[error("`{text}` is not a finite number; write it like \"{example}\"")]
    NotFinite {
        /// The text.
        text: String,
        /// An example of a correct text.
        example: String,
    },
    /// A comma in the number, which may separate decimals or thousands.
    #[error("`{text}` has a comma in its number; write {instead}")]
    Comma {
        /// The text.
        text: String,
        /// What may be meant.
        instead: String,
    },
    /// A number without the unit that its dimension needs.
    #[error(
        "`{text}` has no unit, but {wanted} needs one: {accepted}; write it like \"{example}\""
    )]
    MissingUnit {
        /// The text.
        text: String,
        /// The expected dimension.
        wanted: Dimension,
        /// Accepted units.
        accepted: String,
        /// An example of a correct text.
        example: String,
    },
    /// A unit of another dimension, or an unknown one.
    #[error("`{text}` is {given}, but {wanted} is needed, in one of: {accepted}{meant}")]
    WrongUnit {
        /// The text.
        text: String,
        /// The dimension of that unit, or that it is unknown.
        given: String,
        /// The expected dimension.
        wanted: Dimension,
        /// Accepted units.
        accepted: String,
        /// A suggestion that differs only in upper and lower case.
        meant: String,
    },
}

/// Reads `"50 kPa"` as a number in the dimension's internal unit; `"50 kilopascals"`, too.
///
/// # Errors
/// Text that is not a finite number followed by a unit of `dimension`.
///
/// # Example
/// ```
/// use myospring::units::{Dimension, parse};
/// assert_eq!(parse("0.6 s", Dimension::Time).unwrap(), 600.0);
/// let error = parse("50 mV", Dimension::Pressure).unwrap_err();
/// assert_eq!(
///     error.to_string(),
///     "`50 mV` is a potential, but a pressure is needed, in one of: kPa, Pa, MPa, mN/mm^2, nN/um^2"
/// );
/// ```
pub fn parse(text: &str, dimension: Dimension) -> Result<f64, UnitError> {
    let trimmed = text.trim();
    let example = if dimension == Dimension::Number {
        "0.5".to_owned()
    } else {
        format!("50 {}", dimension.unit())
    };
    let (number, unit) = split_number(trimmed);
    if let Some(instead) = without_comma(trimmed, number) {
        return Err(UnitError::Comma { text: trimmed.to_owned(), instead });
    }
    let unit = &*symbol(unit);
    let Ok(value) = number.parse::<f64>() else {
        return Err(UnitError::NotANumber { text: trimmed.to_owned(), example });
    };
    if !value.is_finite() {
        return Err(UnitError::NotFinite { text: trimmed.to_owned(), example });
    }
    if let Some((_, factor)) = dimension.table().iter().find(|row| row.0 == unit) {
        return Ok(value * factor);
    }
    if unit.is_empty() {
        return Err(UnitError::MissingUnit {
            text: trimmed.to_owned(),
            wanted: dimension,
            accepted: dimension.accepted(),
            example,
        });
    }
    let given = Dimension::ALL
        .into_iter()
        .find(|other| other.table().iter().any(|row| row.0 == unit))
        .map_or_else(|| format!("in an unknown unit `{unit}`"), |other| other.name().to_owned());
    // `MPa` and `mPa` differ only in case, so an inexact match is only suggested.
    let alike = dimension.table().iter().find(|row| row.0.eq_ignore_ascii_case(unit));
    let meant = alike.map(|row| format!("; did you mean \"{number} {}\"?", row.0));
    Err(UnitError::WrongUnit {
        text: trimmed.to_owned(),
        given,
        wanted: dimension,
        accepted: dimension.accepted(),
        meant: meant.unwrap_or_default(),
    })
}

/// What a number with a comma may mean; `number` is the part before the comma.
fn without_comma(text: &str, number: &str) -> Option<String> {
    let decimal = text.replace(',', ".");
    if !text.contains(',') || split_number(&decimal).0.len() <= number.len() {
        return None;
    }
    let digits = text.split(',').nth(1)?.chars().take_while(char::is_ascii_digit).count();
    let several = text.matches(',').count() > 1;
    let thousands = format!("\"{}\"", text.replace(',', ""));
    Some(match digits {
        _ if several => thousands,
        3 => format!("\"{decimal}\", or {thousands} if the comma separates thousands"),
        _ => format!("\"{decimal}\", with a point"),
    })
}

/// The longest prefix that is a number, and the rest without leading space.
fn split_number(text: &str) -> (&str, &str) {
    for word in ["nan", "inf", "infinity"] {
        let bare = text.trim_start_matches(['+', '-']);
        if bare.len() >= word.len() && bare.is_char_boundary(word.len()) {
            let (head, tail) = bare.split_at(word.len());
            if head.eq_ignore_ascii_case(word) && (tail.is_empty() || tail.starts_with(' ')) {
                return (&text[..text.len() - tail.len()], tail.trim());
            }
        }
    }
    let end = number_length(text);
    (&text[..end], text[end..].trim())
}

/// Bytes of the decimal number with which a text begins: `-1.5e3`, `.5`, `5.`; 0 without one. To try whether each prefix is one takes
/// seconds for 300 000 digits.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let signed = |from: usize| from + usize::from(matches!(bytes.get(from), Some(b'+' | b'-')));
    let digits =
        |from: usize| bytes[from..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    let start = signed(0);
    let whole = start + digits(start);
    let (mut end, mut count) = (whole, whole - start);
    if bytes.get(end) == Some(&b'.') {
        let decimals = digits(end + 1);
        end += 1 + decimals;
        count += decimals;
    }
    if count == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let exponent = signed(end + 1);
        let length = digits(exponent);
        if length > 0 {
            end = exponent + length;
        }
    }
    end
}

/// Writes a number in the dimension's internal unit: `50 kPa`.
///
/// # Example
/// ```
/// use myospring::units::{Dimension, format};
/// assert_eq!(format(0.27, Dimension::Length), "0.27 um");
/// ```
pub fn format(value: f64, dimension: Dimension) -> String {
    // `Debug` takes an exponent where the decimals would be many.
    let number = format!("{value:?}");
    let number = number.strip_suffix(".0").unwrap_or(&number);
    format!("{number} {}", dimension.unit()).trim_end().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_written_unit_scales_to_the_internal_one() {
        for (text, dimension, value) in [
            ("50 kPa", Dimension::Pressure, 50.0),
            ("50000Pa", Dimension::Pressure, 50.0),
            ("  600 ms ", Dimension::Time, 600.0),
            ("1e-3 s", Dimension::Time, 1.0),
            ("-0.5 1/s", Dimension::Rate, -0.5e-3),
            ("0.27 µm", Dimension::Length, 0.27),
            ("12 %", Dimension::Number, 0.12),
            ("3", Dimension::Number, 3.0),
            ("1000 kg/m^3", Dimension::Density, 1e-6),
            ("0.1 mM", Dimension::Concentration, 100.0),
            ("70 nM", Dimension::Concentration, 0.07),
            ("14.838 nS/pF", Dimension::ConductanceDensity, 14.838),
            ("120 S/F", Dimension::ConductanceDensity, 0.12),
            ("-52 uA/uF", Dimension::CurrentDensity, -52.0),
            ("0.3 uS", Dimension::Conductance, 300.0),
            ("-2.5 nA", Dimension::Current, -2500.0),
            ("0.185 nF", Dimension::Capacitance, 185.0),
            ("0.27 \u{3bc}m", Dimension::Length, 0.27),
            ("0.27 \u{c2}\u{b5}m", Dimension::Length, 0.27),
            ("0.27 microns", Dimension::Length, 0.27),
            ("0.27 Micrometers", Dimension::Length, 0.27),
            ("0.27micrometre", Dimension::Length, 0.27),
            ("270 nanometers", Dimension::Length, 0.27),
            ("600 milliseconds", Dimension::Time, 600.0),
            ("600 msec", Dimension::Time, 600.0),
            ("0.6 sec.", Dimension::Time, 600.0),
            ("0.6 seconds", Dimension::Time, 600.0),
            ("1 minute", Dimension::Time, 6e4),
            ("50 kilopascals", Dimension::Pressure, 50.0),
            ("50 mN/mm²", Dimension::Pressure, 50.0),
            ("50 nN / µm2", Dimension::Pressure, 50.0),
            ("2 newtons per metre", Dimension::Stiffness, 2e3),
            ("30°", Dimension::Angle, 30.0),
            ("30 degrees", Dimension::Angle, 30.0),
            ("-80 millivolts", Dimension::Voltage, -80.0),
            ("70 nanomolar", Dimension::Concentration, 0.07),
            ("12 per cent", Dimension::Number, 0.12),
            ("12 percent", Dimension::Number, 0.12),
            ("30 fps", Dimension::Rate, 0.03),
            ("30 frames per second", Dimension::Rate, 0.03),
            ("30 frames/s", Dimension::Rate, 0.03),
        ] {
            let parsed = parse(text, dimension).unwrap();
            assert!((parsed - value).abs() <= 4.0 * f64::EPSILON * value.abs(), "{text}: {parsed}");
        }
    }

    /// Otherwise a text would be read as the first that knows it.
    #[test]
    fn no_unit_is_of_two_dimensions() {
        let all = Dimension::ALL.iter().flat_map(|dimension| dimension.table());
        let mut units: Vec<&str> = all.map(|row| row.0).collect();
        let count = units.len();
        units.sort_unstable();
        units.dedup();
        assert_eq!(units.len(), count);
    }

    /// Otherwise it could not be written.
    #[test]
    fn a_symbol_is_its_own() {
        for (unit, _) in Dimension::ALL.iter().flat_map(|dimension| dimension.table()) {
            assert_eq!(symbol(unit), *unit);
        }
    }

    #[test]
    fn what_is_written_reads_back() {
        for dimension in Dimension::ALL {
            assert_eq!(parse(&format(1.25, dimension), dimension).unwrap(), 1.25, "{dimension}");
        }
    }

    #[test]
    fn a_number_is_the_longest_prefix_that_reads_as_one() {
        let symbols = "+-.05eEm";
        let mut texts = vec![String::new()];
        for _ in 0..5 {
            let longer =
                texts.iter().flat_map(|text| symbols.chars().map(move |c| format!("{text}{c}")));
            texts = longer.collect();
            for text in &texts {
                let ends = (1..=text.len()).rev();
                let mut numbers = ends.map(|end| &text[..end]).filter(|number| {
                    number.ends_with(['0', '5', '.']) && number.parse::<f64>().is_ok()
                });
                assert_eq!(split_number(text).0, numbers.next().unwrap_or_default(), "{text}");
            }
        }
    }

    #[test]
    fn wrong_text_says_what_is_wrong_with_it() {
        for (text, dimension, message) in [
            ("fifty kPa", Dimension::Pressure, "does not start with a number"),
            ("", Dimension::Pressure, "does not start with a number"),
            ("nan", Dimension::Length, "not a finite number"),
            ("inf um", Dimension::Length, "not a finite number"),
            ("1e999 um", Dimension::Length, "not a finite number"),
            ("50", Dimension::Pressure, "has no unit"),
            ("50 mV", Dimension::Pressure, "is a potential, but a pressure is needed"),
            ("50 furlong", Dimension::Length, "unknown unit `furlong`"),
            ("0,27 um", Dimension::Length, "write \"0.27 um\", with a point"),
            ("-,5um", Dimension::Length, "write \"-.5um\", with a point"),
            ("1,000 um", Dimension::Length, "write \"1.000 um\", or \"1000 um\" if the comma"),
            ("1,000,000 um", Dimension::Length, "write \"1000000 um\""),
            ("0,5", Dimension::Number, "write \"0.5\", with a point"),
            ("50 KPA", Dimension::Pressure, "did you mean \"50 kPa\"?"),
            ("50 mPa", Dimension::Pressure, "did you mean \"50 MPa\"?"),
            ("600 milliseconds", Dimension::Length, "is a time, but a length is needed"),
            ("50 mV", Dimension::Concentration, "is a potential, but a concentration is needed"),
            ("1 mS", Dimension::ConductanceDensity, "is a conductance, but a conductance per"),
            ("1 pA", Dimension::CurrentDensity, "in one of: A/F, pA/pF, uA/uF, nA/nF"),
        ] {
            let error = parse(text, dimension).unwrap_err().to_string();
            assert!(error.contains(message), "{text}: {error}");
        }
    }
}
