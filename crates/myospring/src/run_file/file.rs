//! A run file as values by key, and as TOML.

use super::error::RunFileError;
use crate::settings::{Failure, Models, Named, Problem, Setting, Value, find, table, tables};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A run file as written: values by key; every key is optional.
///
/// # Example
/// ```
/// use myospring::run_file::RunFile;
/// let mut file = RunFile::default();
/// file.set("material.thickness", "8 um")?;
/// assert_eq!(file.resolve()?.material.thickness, 8.0);
/// assert_eq!(file.to_toml(), "[material]\nthickness = \"8 um\"\n");
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunFile {
    pub(super) values: BTreeMap<&'static str, Value>,
    pub(super) models: Models,
}

impl RunFile {
    /// The value of a key, if present.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.values.get(key)
    }

    /// All keys that are present, with their values.
    pub fn values(&self) -> impl Iterator<Item = (&'static str, &Value)> {
        self.values.iter().map(|(key, value)| (*key, value))
    }

    /// Whether a key is present.
    pub fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// Sets the value of a key.
    ///
    /// # Errors
    /// An unknown key, or a value of the wrong kind.
    pub fn set(&mut self, key: &str, value: impl Into<Value>) -> Result<(), RunFileError> {
        let Some(setting) = find(key) else {
            let known = table().map(|setting| setting.key);
            return Err(RunFileError::bare((key.to_owned(), Problem::unknown_key(key, "", known))));
        };
        self.take(setting, value.into()).map_err(RunFileError::bare)
    }

    /// Allows `cell.model` to name these models in addition to the listed ones. TOML output
    /// contains only their names.
    #[must_use]
    pub fn knowing(self, models: Models) -> Self {
        Self { models, ..self }
    }

    /// Removes a key.
    pub fn remove(&mut self, key: &str) {
        self.values.remove(key);
    }

    pub(super) fn take(&mut self, setting: &Setting, value: Value) -> Result<(), Failure> {
        self.values.insert(setting.key, setting.accept(value)?);
        Ok(())
    }

    /// The file names that it contains, for changing them.
    pub fn paths_mut(&mut self) -> impl Iterator<Item = &mut String> {
        self.values.iter_mut().filter_map(|(key, value)| match value {
            Value::Text(path) if find(key).is_some_and(|it| it.names_file(path)) => Some(path),
            _ => None,
        })
    }

    /// The run file as TOML; reading it gives the same run file.
    pub fn to_toml(&self) -> String {
        let mut parts = Vec::new();
        for table in tables() {
            let mut part = String::new();
            let given = table.settings.iter().filter_map(|row| Some((row, self.get(row.key)?)));
            for (setting, value) in given {
                match value {
                    // Named values form a sub-table, which must come last so that the table's other
                    // keys do not fall into it.
                    Value::Named(values) => {
                        let _ = write!(part, "\n[{}]\n{}", setting.key, rows(values));
                    }
                    value => {
                        let _ = writeln!(part, "{} = {}", setting.name(), written(value));
                    }
                }
            }
            if !part.is_empty() {
                let head = if table.name.is_empty() {
                    String::new()
                } else {
                    format!("[{}]\n", table.name)
                };
                parts.push(head + &part);
            }
        }
        parts.join("\n")
    }
}

/// Returns a value in TOML syntax.
pub(super) fn written(value: &Value) -> String {
    to_toml(value).to_string()
}

pub(super) fn to_toml(value: &Value) -> toml::Value {
    match value {
        Value::Flag(flag) => (*flag).into(),
        Value::Whole(number) => (*number).into(),
        Value::Number(number) => (*number).into(),
        Value::Text(text) => text.as_str().into(),
        Value::Named(values) => toml::Value::Table(rows(values)),
    }
}

fn rows(values: &Named) -> toml::Table {
    values.iter().map(|(name, value)| (name.clone(), to_toml(value))).collect()
}

/// Converts a TOML value; `None` for lists and dates, which no setting accepts.
pub(super) fn from_toml(value: &toml::Value) -> Option<Value> {
    Some(match value {
        toml::Value::Boolean(flag) => Value::Flag(*flag),
        toml::Value::Integer(number) => Value::Whole(*number),
        toml::Value::Float(number) => Value::Number(*number),
        toml::Value::String(text) => Value::from(text.as_str()),
        toml::Value::Table(rows) => {
            let rows = rows.iter().map(|(name, value)| Some((name.clone(), from_toml(value)?)));
            Value::Named(rows.collect::<Option<_>>()?)
        }
        toml::Value::Array(_) | toml::Value::Datetime(_) => return None,
    })
}
