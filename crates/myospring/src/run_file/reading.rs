//! Reads texts and options into one run file that remembers where each value came from.

use super::error::{Origin, RunFileError};
use super::file::{RunFile, from_toml, to_toml};
use super::rules;
use crate::cell_files::Choices;
use crate::settings::{
    Failure, FromFile, Models, Problem, Run, Setting, Value, find, read_toml, table, tables,
};
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table};

/// Builds a run file from a text and from options, which override the text.
///
/// # Example
/// ```
/// use myospring::run_file::Reader;
/// let text = "[material]\nthickness = \"8 um\"";
/// let reader = Reader::new().text("thin.toml", text)?;
/// assert_eq!(reader.clone().resolve()?.material.thickness, 8.0);
///
/// let error = reader.option("--thickness", "material.thickness", "0 um").resolve().err().unwrap();
/// assert_eq!(
///     error.to_string(),
///     "option --thickness: `material.thickness` = 0 um is outside its bounds, above 0 um, at most \
///      5000 um"
/// );
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Reader {
    table: Table,
    origins: BTreeMap<String, Place>,
    /// Name and text of the file.
    file: String,
    text: String,
    models: Models,
}

/// Position of a key and of its value.
#[derive(Debug, Clone)]
struct Place {
    key: Spot,
    value: Spot,
}

#[derive(Debug, Clone)]
enum Spot {
    /// Byte range in the text. Line and column are counted only when needed, since that reads the
    /// whole text.
    Span(Range<usize>),
    Elsewhere(Origin),
}

impl Reader {
    /// Creates a reader without text and options: a run with every default.
    pub fn new() -> Self {
        Self::default()
    }

    /// Allows `cell.model` to name these models in addition to the listed ones.
    #[must_use]
    pub fn knowing(self, models: Models) -> Self {
        Self { models, ..self }
    }

    /// Adds the text of a run file; messages call it `file`.
    ///
    /// # Errors
    /// Text that is not TOML, with its position.
    pub fn text(mut self, file: &str, text: &str) -> Result<Self, RunFileError> {
        let failed = |error: &toml::de::Error| RunFileError {
            origin: Origin::in_text(file, text, error.span().unwrap_or_default()),
            key: String::new(),
            problem: Problem::Syntax { reason: error.message().to_owned() },
        };
        let table: Table = read_toml(text).map_err(|error| failed(&error))?;
        let spans = DeTable::parse(text).map_err(|error| failed(&error))?;
        self.note("", spans.get_ref());
        self.table = table;
        (self.file, self.text) = (file.to_owned(), text.to_owned());
        Ok(self)
    }

    /// Makes the file names read so far relative to `folder`, the folder of the run file. Options
    /// added later stay relative to the current folder.
    ///
    /// # Example
    /// ```
    /// use myospring::run_file::Reader;
    /// let text = "[shape]\npicture = \"cell.tif\"\npixel_size = \"0.27 um\"";
    /// let reader = Reader::new().text("study/cell.toml", text)?.relative_to("study".as_ref());
    /// let run = reader.option("--outline", "segmentation.outline", "drawn.roi").resolve()?;
    /// let file = run.to_run_file();
    /// assert_eq!(file.get("shape.picture"), Some(&"study/cell.tif".into()));
    /// assert_eq!(file.get("segmentation.outline"), Some(&"drawn.roi".into()));
    /// # Ok::<(), myospring::run_file::RunFileError>(())
    /// ```
    #[must_use]
    pub fn relative_to(mut self, folder: &Path) -> Self {
        for setting in table() {
            if let Some((table, name)) = setting.key.split_once('.')
                && let Some(toml::Value::Table(table)) = self.table.get_mut(table)
                && let Some(toml::Value::String(path)) = table.get_mut(name)
                && setting.names_file(path)
            {
                *path = folder.join(&*path).to_string_lossy().into_owned();
            }
        }
        self
    }

    fn note(&mut self, prefix: &str, table: &DeTable<'_>) {
        for (key, value) in table {
            let path = join(prefix, key.get_ref());
            let (key, at) = (Spot::Span(key.span()), Spot::Span(Spanned::span(value)));
            let spots = Place { key, value: at };
            if let DeValue::Table(inner) = value.get_ref() {
                self.note(&path, inner);
            }
            self.origins.insert(path, spots);
        }
    }

    /// Sets a key, `table.key`, by an option of the command line, and drops the keys that it
    /// excludes. Another option that says what shape the cell has stays, so that both are refused together.
    #[must_use]
    pub fn option(self, option: &str, key: &str, value: impl Into<Value>) -> Self {
        self.overriding(Origin::Option(option.to_owned()), key, value)
    }

    /// Sets a key as [`Reader::option`] does, with the origin that messages name.
    #[must_use]
    pub fn overriding(mut self, origin: Origin, key: &str, value: impl Into<Value>) -> Self {
        let value = value.into();
        let model = value.as_text().filter(|_| key == "cell.model");
        let how = FromFile { variables: self.variables(), myofilaments: None };
        let model = model.and_then(|name| self.models.model(name, &how).ok());
        for other in rules::put_out_of_force(key, &value, model.as_deref()) {
            let of_shape = [key, other].iter().any(|key| rules::SHAPES.contains(key));
            if !(of_shape && self.origin(other).stands_beside(&origin)) {
                self.remove(other);
            }
        }
        let value = to_toml(&value);
        let spot = Spot::Elsewhere(origin);
        self.origins.insert(key.to_owned(), Place { key: spot.clone(), value: spot });
        if let Some((table, name)) = key.split_once('.') {
            let table = self.table.entry(table).or_insert_with(|| Table::new().into());
            if let toml::Value::Table(table) = table {
                table.insert(name.to_owned(), value);
            }
        } else {
            self.table.insert(key.to_owned(), value);
        }
        self
    }

    fn remove(&mut self, key: &str) {
        if let Some((table, name)) = key.split_once('.')
            && let Some(toml::Value::Table(table)) = self.table.get_mut(table)
        {
            table.remove(name);
        }
    }

    /// Returns where a key's value came from.
    pub fn origin(&self, key: &str) -> Origin {
        self.place(key).map_or(Origin::Unknown, |place| self.origin_of(&place.value))
    }

    fn origin_of(&self, spot: &Spot) -> Origin {
        match spot {
            Spot::Span(span) => Origin::in_text(&self.file, &self.text, span.clone()),
            Spot::Elsewhere(origin) => origin.clone(),
        }
    }

    /// Returns the position of a key, or else of the table that should contain it.
    fn place(&self, key: &str) -> Option<&Place> {
        let table = key.rsplit_once('.').map_or("", |(table, _)| table);
        self.origins.get(key).or_else(|| self.origins.get(table))
    }

    fn locate(&self, (key, problem): Failure) -> RunFileError {
        let place = self.place(&key);
        let at_key = matches!(problem, Problem::UnknownKey { .. });
        let origin = place.map_or(Origin::Unknown, |place| {
            self.origin_of(if at_key { &place.key } else { &place.value })
        });
        RunFileError { origin, key, problem }
    }

    /// Returns the run file, in which every key is known and has a value of the right kind.
    ///
    /// # Errors
    /// Unknown keys and names, values of the wrong kind.
    pub fn read(self) -> Result<(RunFile, Self), RunFileError> {
        let file = self.gathered().map_err(|failure| self.locate(failure))?;
        Ok((file, self))
    }

    /// The variables that the user named so far.
    fn variables(&self) -> Choices {
        let named = self.table.get("cell").and_then(|cell| cell.get("variables"));
        named.and_then(|text| text.as_str()?.parse().ok()).unwrap_or_default()
    }

    fn gathered(&self) -> Result<RunFile, Failure> {
        let mut file = RunFile::default().knowing(self.models.clone());
        for (key, value) in &self.table {
            if let Some(rows) = tables().iter().find(|rows| rows.name == key) {
                let toml::Value::Table(table) = value else {
                    let (found, wanted) = (found(value), "a table".to_owned());
                    return Err((key.clone(), Problem::Kind { key: key.clone(), found, wanted }));
                };
                for (name, value) in table {
                    let known = rows.settings.iter().map(Setting::name);
                    take(&mut file, &join(key, name), value, |_| {
                        Problem::unknown_key(name, key, known)
                    })?;
                }
            } else {
                let known = tables().iter().flat_map(|rows| match rows.name {
                    "" => rows.settings.iter().map(|row| row.key).collect(),
                    name => vec![name],
                });
                take(&mut file, key, value, |key| Problem::unknown_key(key, "", known))?;
            }
        }
        Ok(file)
    }

    /// Returns the run, with every value checked and every default filled in.
    ///
    /// # Errors
    /// All errors of [`Reader::read`] and [`RunFile::resolve`], with their positions.
    pub fn resolve(self) -> Result<Run, RunFileError> {
        let (file, reader) = self.read()?;
        file.run().map_err(|failure| reader.locate(failure))
    }
}

impl RunFile {
    /// Reads the text of a run file.
    ///
    /// # Errors
    /// Text that is not TOML, unknown keys and names, values of the wrong kind; with their
    /// positions.
    pub fn from_text(text: &str) -> Result<Self, RunFileError> {
        Ok(Reader::new().text("", text)?.read()?.0)
    }
}

/// Adds a value to the run file if its key is known and its kind is right.
fn take(
    file: &mut RunFile,
    key: &str,
    value: &toml::Value,
    unknown: impl FnOnce(&str) -> Problem,
) -> Result<(), Failure> {
    let Some(setting) = find(key) else { return Err((key.to_owned(), unknown(key))) };
    let Some(value) = from_toml(value) else {
        let (found, wanted) = (found(value), setting.wanted().to_owned());
        return Err((key.to_owned(), Problem::Kind { key: key.to_owned(), found, wanted }));
    };
    file.take(setting, value)
}

/// Describes a value for a message.
fn found(value: &toml::Value) -> String {
    match value {
        toml::Value::Datetime(date) => format!("the date {date}"),
        toml::Value::Array(_) => "a list".to_owned(),
        other => from_toml(other).map_or("a table".to_owned(), |value| value.described()),
    }
}

fn join(prefix: &str, key: &str) -> String {
    if prefix.is_empty() { key.to_owned() } else { format!("{prefix}.{key}") }
}
