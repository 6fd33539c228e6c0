//! One row per parameter: name, value, unit, range, source.

use serde::Serialize;
use std::borrow::Cow;

/// A model constant with unit, range, meaning and source.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name in the paper, ASCII: `tau_v1_minus`.
    pub name: Cow<'static, str>,
    /// Value in `unit`.
    pub value: f64,
    /// Unit; empty for a dimensionless number.
    pub unit: Cow<'static, str>,
    /// Smallest value that the model accepts.
    pub minimum: f64,
    /// Largest value that the model accepts.
    pub maximum: f64,
    /// Its meaning, in a few words.
    pub meaning: Cow<'static, str>,
    /// Source of the value: a key of `references.bib` and the place in it.
    pub source: Cow<'static, str>,
}

impl Parameter {
    /// A parameter with its value in `unit`, smallest and largest value, meaning and source.
    pub fn new(
        name: impl Into<Cow<'static, str>>,
        value: f64,
        unit: impl Into<Cow<'static, str>>,
        [minimum, maximum]: [f64; 2],
        meaning: impl Into<Cow<'static, str>>,
        source: impl Into<Cow<'static, str>>,
    ) -> Self {
        let (name, unit, meaning, source) =
            (name.into(), unit.into(), meaning.into(), source.into());
        Self { name, value, unit, minimum, maximum, meaning, source }
    }
}

/// Why a parameter or a set is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// No parameter has that name.
    #[error("no parameter is named `{name}`; the parameters are: {known}")]
    Unknown {
        /// The requested name.
        name: String,
        /// The existing names.
        known: String,
    },
    /// Two rows have one name.
    #[error("two parameters are named `{name}`; give one of them another name")]
    Twice {
        /// The name.
        name: String,
    },
    /// The value is not a number or outside the range.
    #[error(
        "parameter `{name}` = {value} {unit} is outside its range {minimum} to {maximum} {unit}"
    )]
    OutOfRange {
        /// The parameter.
        name: String,
        /// The given value.
        value: f64,
        /// Smallest value.
        minimum: f64,
        /// Largest value.
        maximum: f64,
        /// Unit of all three.
        unit: String,
    },
}

/// A named set of parameters, in the order of display.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterSet {
    rows: Vec<Parameter>,
}

impl ParameterSet {
    /// Makes a set from the rows of a table in the source code; names must differ.
    ///
    /// # Panics
    /// If two rows share a name: an error in the table, not in any input.
    pub fn new(rows: Vec<Parameter>) -> Self {
        match Self::try_new(rows) {
            Ok(set) => set,
            Err(error) => panic!("{error}"),
        }
    }

    /// Makes a set from rows that were read at run time.
    ///
    /// # Errors
    /// Two rows with one name.
    ///
    /// # Example
    /// ```
    /// use myospring::parameter::{Parameter, ParameterSet};
    /// let row = |name: &str| {
    ///     Parameter::new(name.to_owned(), 0.09, "mS/uF", [0.0, 1.0], "conductance", "a file")
    /// };
    /// assert!(ParameterSet::try_new(vec![row("g_s"), row("g_Na")]).is_ok());
    /// let error = ParameterSet::try_new(vec![row("g_s"), row("g_s")]).unwrap_err();
    /// assert!(error.to_string().contains("two parameters are named `g_s`"));
    /// ```
    pub fn try_new(rows: Vec<Parameter>) -> Result<Self, ParameterError> {
        for (index, row) in rows.iter().enumerate() {
            if rows[..index].iter().any(|other| other.name == row.name) {
                return Err(ParameterError::Twice { name: row.name.to_string() });
            }
        }
        Ok(Self { rows })
    }

    /// All rows in order.
    pub fn rows(&self) -> &[Parameter] {
        &self.rows
    }

    /// The value of a parameter, in its own unit.
    pub fn get(&self, name: &str) -> Option<f64> {
        self.rows.iter().find(|row| row.name == name).map(|row| row.value)
    }

    /// Changes one value, in its own unit.
    ///
    /// # Errors
    /// An unknown name, or a value that is not finite or outside the row's range.
    pub fn set(&mut self, name: &str, value: f64) -> Result<(), ParameterError> {
        let Some(row) = self.rows.iter_mut().find(|row| row.name == name) else {
            let known: Vec<&str> = self.rows.iter().map(|row| &*row.name).collect();
            return Err(ParameterError::Unknown { name: name.to_owned(), known: known.join(", ") });
        };
        if !(row.minimum..=row.maximum).contains(&value) {
            return Err(ParameterError::OutOfRange {
                name: row.name.to_string(),
                value,
                minimum: row.minimum,
                maximum: row.maximum,
                unit: row.unit.to_string(),
            });
        }
        row.value = value;
        Ok(())
    }
}

/// Likeness (Jaro-Winkler) from which on one name may be meant by another.
const ALIKE: f64 = 0.8;

/// Those of some names that may be meant by a written one, the likest first.
///
/// # Example
/// ```
/// use myospring::parameter::alike;
/// assert_eq!(alike("tau_Si", ["g_Na", "tau_so", "tau_si"]), ["tau_si", "tau_so"]);
/// assert!(alike("thickness", ["g_Na"]).is_empty());
/// ```
pub fn alike<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut found = by_likeness(written, known);
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    found.dedup_by_key(|(_, name)| *name);
    found.into_iter().map(|(_, name)| name).collect()
}

/// The likest of them, of equals the last.
pub fn nearest<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let found = by_likeness(written, known).into_iter();
    found.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, name)| name)
}

/// Those that are alike, each with its likeness.
fn by_likeness<'a>(written: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<(f64, &'a str)> {
    let written = written.to_lowercase();
    let likeness = |name: &'a str| (strsim::jaro_winkler(&written, &name.to_lowercase()), name);
    known.into_iter().map(likeness).filter(|(alike, _)| *alike > ALIKE).collect()
}
