//! Bounds of a number: dimension, smallest and largest value, and an example.

use super::problem::Problem;
use super::value::Value;
use crate::units::{self, Dimension};

/// Bounds of a quantity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Its dimension.
    pub dimension: Dimension,
    /// Smallest value in the internal unit; allowed unless `open`.
    pub minimum: f64,
    /// Whether the smallest value itself is not allowed.
    pub open: bool,
    /// Largest value in the internal unit.
    pub maximum: f64,
    /// An example, as written by users.
    pub example: &'static str,
}

impl Bounds {
    /// Any finite number of a dimension.
    pub(super) const fn any(dimension: Dimension, example: &'static str) -> Self {
        Self { dimension, minimum: f64::MIN, open: false, maximum: f64::MAX, example }
    }

    /// Sets the smallest value, which is allowed.
    pub(super) const fn from(mut self, minimum: f64) -> Self {
        self.minimum = minimum;
        self
    }

    /// Sets the smallest value, which is not allowed.
    pub(super) const fn above(mut self, minimum: f64) -> Self {
        self.minimum = minimum;
        self.open = true;
        self
    }

    /// Sets the largest value.
    pub(super) const fn to(mut self, maximum: f64) -> Self {
        self.maximum = maximum;
        self
    }

    /// The bounds in words: `above 0 um, at most 100 um`; `None` for any finite number.
    pub fn words(&self) -> Option<String> {
        if self.minimum == f64::MIN && self.maximum == f64::MAX {
            return None;
        }
        let low = units::format(self.minimum, self.dimension);
        let high = units::format(self.maximum, self.dimension);
        Some(if self.open {
            format!("above {low}, at most {high}")
        } else {
            format!("{low} to {high}")
        })
    }

    /// Whether a value in the internal unit is within the bounds.
    pub fn contains(&self, value: f64) -> bool {
        let low = if self.open { value > self.minimum } else { value >= self.minimum };
        low && value <= self.maximum
    }

    /// Reads the value of a key in the internal unit.
    pub(super) fn read(&self, key: &'static str, value: &Value) -> Result<f64, Problem> {
        let number = units::parse(&value.written(), self.dimension).map_err(|cause| {
            Problem::Unit { key: key.to_owned(), cause, example: self.example.to_owned() }
        })?;
        if self.contains(number) {
            return Ok(number);
        }
        Err(Problem::OutOfBounds {
            key,
            value: units::format(number, self.dimension),
            bounds: self.words().unwrap_or_default(),
            example: self.example,
        })
    }

    /// A value in the internal unit as text with unit.
    pub(super) fn write(&self, value: f64) -> Value {
        match self.dimension {
            Dimension::Number => Value::Number(value),
            dimension => Value::Text(units::format(value, dimension)),
        }
    }
}

/// Bounds of a whole number.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Whole {
    /// Smallest value.
    pub minimum: u32,
    /// Largest value.
    pub maximum: u32,
    /// An example.
    pub example: u32,
}

impl Whole {
    /// Reads the value of a key.
    pub(super) fn read(&self, key: &'static str, value: i64) -> Result<u32, Problem> {
        let number = u32::try_from(value).ok();
        number.filter(|number| (self.minimum..=self.maximum).contains(number)).ok_or_else(|| {
            let wanted = format!("a whole number from {} to {}", self.minimum, self.maximum);
            Problem::Kind { key: key.to_owned(), found: value.to_string(), wanted }
        })
    }
}
