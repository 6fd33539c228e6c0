//! Run files: a TOML text becomes validated working types, and goes back to text.
//!
//! ```text
//! text + options  ->  RunFile (what was written)  ->  Run (checked, internal units)  ->  Simulation
//!                          ^                             |
//!                          +----------- to_run_file -----+
//! ```
//!
//! The keys are those of the table of [`settings`](crate::settings), of which [`schema`] makes a JSON
//! Schema and [`template`] a commented run file; what several keys have to keep together stands in
//! `run_file/rules.rs`. No file is opened here: pictures come through a closure ([`Shape::bytes`]).
//!
//! # Example
//! ```
//! use myospring::run_file::RunFile;
//! let run = RunFile::from_text("[cell]\npeak_tension = \"40 kPa\"")?.resolve()?;
//! assert_eq!((run.peak_tension, run.duration), (40.0, 600.0));
//!
//! let error = RunFile::from_text("[material]\nthicknes = \"8 um\"").unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "line 2, column 1: unknown key `thicknes` in [material]; did you mean `thickness`?"
//! );
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;
mod reading;
mod rules;
mod schema;
mod template;

pub use crate::settings::{
    Fibre, PictureSource, Problem, Run, Shape, ShapeBytes, ShapeError, Shaped, Source,
};
pub use error::{Origin, RunFileError};
pub use reading::Reader;
pub use schema::schema;
pub use template::template;

use crate::settings::{Failure, Named, Setting, Value, find, table, tables};
use crate::units::{self, Dimension};
use std::collections::BTreeMap;
use std::fmt::Write;

/// A run file as it was written: values by key, of which every one may be absent.
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
    values: BTreeMap<&'static str, Value>,
}

impl RunFile {
    /// Reads the text of a run file.
    ///
    /// # Errors
    /// Text that is not TOML, unknown keys and names, values of the wrong kind; with the place.
    pub fn from_text(text: &str) -> Result<Self, RunFileError> {
        Ok(Reader::new().text("", text)?.read()?.0)
    }

    /// The value of a key, if it was given.
    pub fn get(&self, key: &str) -> Option<&Value> {
        self.values.get(key)
    }

    /// Whether a key was given.
    pub fn has(&self, key: &str) -> bool {
        self.values.contains_key(key)
    }

    /// Gives a key a value.
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

    /// Takes a key out.
    pub fn remove(&mut self, key: &str) {
        self.values.remove(key);
    }

    fn take(&mut self, setting: &Setting, value: Value) -> Result<(), Failure> {
        self.values.insert(setting.key, setting.accept(value)?);
        Ok(())
    }

    /// Checks every value and fills in every default.
    ///
    /// # Errors
    /// A value with a wrong unit or outside its bounds, keys that exclude each other, a model or
    /// parameter that does not exist.
    pub fn resolve(&self) -> Result<Run, RunFileError> {
        self.run().map_err(RunFileError::bare)
    }

    fn run(&self) -> Result<Run, Failure> {
        let mut run = Run::default_run();
        for setting in table() {
            if let Some(value) = self.get(setting.key) {
                setting.set(&mut run, value)?;
            }
        }
        if !self.has("run.duration") {
            run.duration = run.usual_duration();
        }
        rules::check(self, &run)?;
        Ok(run)
    }

    /// The names of files in it.
    pub fn paths_mut(&mut self) -> impl Iterator<Item = &mut String> {
        self.values.iter_mut().filter_map(|(key, value)| match value {
            Value::Text(path) if find(key).is_some_and(Setting::is_file) => Some(path),
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
                    // The last of its table, so that the table's other keys stay its own.
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

impl Run {
    /// The run file of this run with every default written out.
    ///
    /// Spacing and time step stay absent where the shape and the stability limit decide them.
    pub fn to_run_file(&self) -> RunFile {
        let values = table().filter_map(|setting| Some((setting.key, setting.get(self)?)));
        RunFile { values: values.collect() }
    }

    /// The run file that repeats this run, with the spacing (um) and time step (ms) that it took;
    /// a quasi-static run takes none.
    pub fn settled(&self, spacing: f64, time_step: Option<f64>) -> RunFile {
        let mut file = self.to_run_file();
        let took = |value, dimension| Value::Text(units::format(value, dimension));
        file.values.insert("shape.spacing", took(spacing, Dimension::Length));
        file.values.remove("numerics.time_step");
        file.values
            .extend(time_step.map(|step| ("numerics.time_step", took(step, Dimension::Time))));
        file
    }
}

/// A value as TOML has it.
fn written(value: &Value) -> String {
    to_toml(value).to_string()
}

fn to_toml(value: &Value) -> toml::Value {
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

/// A value of TOML; `None` for lists and dates, which no setting takes.
fn from_toml(value: &toml::Value) -> Option<Value> {
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
