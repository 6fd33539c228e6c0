//! One row per parameter: name, value, unit, range, source.

use serde::Serialize;
use std::borrow::Cow;

/// A model constant with everything a reader needs to trust it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Parameter {
    /// The field's name for it, ASCII, as in the paper: `tau_v1_minus`.
    pub name: Cow<'static, str>,
    /// Value in `unit`.
    pub value: f64,
    /// Unit as written for people; empty for a pure number.
    pub unit: Cow<'static, str>,
    /// Smallest value that the model accepts.
    pub minimum: f64,
    /// Largest value that the model accepts.
    pub maximum: f64,
    /// What it does, in a few words.
    pub meaning: Cow<'static, str>,
    /// Where the value comes from: a key of `references.bib` and the place in it.
    pub source: Cow<'static, str>,
}

/// Why a parameter was not changed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum ParameterError {
    /// No parameter has that name.
    #[error("no parameter is named `{name}`; the parameters are: {known}")]
    Unknown {
        /// What was asked for.
        name: String,
        /// The names there are.
        known: String,
    },
    /// The value is not a number or outside the range.
    #[error(
        "parameter `{name}` = {value} {unit} is outside its range {minimum} to {maximum} {unit}"
    )]
    OutOfRange {
        /// The parameter.
        name: String,
        /// What was given.
        value: f64,
        /// Smallest value.
        minimum: f64,
        /// Largest value.
        maximum: f64,
        /// Unit of all three.
        unit: String,
    },
}

/// A named set of parameters, in the order they are shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ParameterSet {
    rows: Vec<Parameter>,
}

impl ParameterSet {
    /// Collects rows; names must differ.
    ///
    /// # Panics
    /// If two rows share a name: a slip in the table, not in any input.
    pub fn new(rows: Vec<Parameter>) -> Self {
        for (index, row) in rows.iter().enumerate() {
            assert!(rows[..index].iter().all(|other| other.name != row.name), "{} twice", row.name);
        }
        Self { rows }
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
