//! Values as written by users.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fmt;

/// A value as written, before units and bounds are checked.
///
/// # Example
/// ```
/// use myospring::settings::Value;
/// assert_eq!(Value::from("50 kPa").to_string(), "\"50 kPa\"");
/// assert_eq!(Value::from(0.05).to_string(), "0.05");
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Value {
    /// True or false.
    Flag(bool),
    /// A whole number.
    Whole(i64),
    /// A number without unit.
    Number(f64),
    /// Text: a number with its unit, a word, or a name.
    Text(String),
    /// Values by name.
    Named(BTreeMap<String, Value>),
}

impl Value {
    /// The text, if it is one.
    pub fn as_text(&self) -> Option<&str> {
        match self {
            Self::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Its description, in a sentence: `the text "soft"`.
    pub(crate) fn described(&self) -> String {
        match self {
            Self::Text(text) => format!("the text \"{text}\""),
            Self::Named(_) => "a table".to_owned(),
            Self::Flag(_) | Self::Whole(_) | Self::Number(_) => self.to_string(),
        }
    }

    /// A number or text without quotes.
    pub(crate) fn written(&self) -> String {
        match self {
            Self::Text(text) => text.trim().to_owned(),
            other => other.to_string(),
        }
    }
}

impl fmt::Display for Value {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Flag(flag) => write!(formatter, "{flag}"),
            Self::Whole(number) => write!(formatter, "{number}"),
            Self::Number(number) => write!(formatter, "{number}"),
            Self::Text(text) => write!(formatter, "\"{text}\""),
            Self::Named(values) => {
                let rows = values.iter().map(|(name, value)| format!("{name} = {value}"));
                write!(formatter, "{{ {} }}", rows.collect::<Vec<_>>().join(", "))
            }
        }
    }
}

impl From<bool> for Value {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl From<i64> for Value {
    fn from(number: i64) -> Self {
        Self::Whole(number)
    }
}

impl From<f64> for Value {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<&str> for Value {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Value {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}
