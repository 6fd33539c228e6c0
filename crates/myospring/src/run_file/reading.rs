//! From texts and options to one run file that remembers where each value came from.

use super::error::{Origin, Problem, RunFileError};
use super::{Run, RunFile, check, resolve, schema};
use serde::Deserialize;
use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use toml::de::{DeTable, DeValue};
use toml::{Spanned, Table, Value};

/// Keys of which one puts the others out of force.
const ALTERNATIVES: [&[&str]; 2] = [
    &["shape.built_in", "shape.picture", "shape.outline"],
    &["material.young_modulus", "material.spring_stiffness"],
];

/// Keys that say something about one support only, and which.
const OF_ONE_SUPPORT: [(&str, &str); 2] =
    [("mechanics.end_stiffness", "spring-held-ends"), ("mechanics.bed_stiffness", "elastic-bed")];

/// Keys that name a file.
pub(super) const PATHS: [&str; 3] = ["shape.picture", "shape.outline", "segmentation.outline"];

/// Gathers a run file from a text and from options, which override it.
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
///      100 um"
/// );
/// # Ok::<(), myospring::run_file::RunFileError>(())
/// ```
#[derive(Debug, Clone, Default)]
pub struct Reader {
    table: Table,
    origins: BTreeMap<String, Place>,
}

#[derive(Debug, Clone)]
struct Place {
    key: Origin,
    value: Origin,
}

impl Reader {
    /// Nothing yet: a run with every default.
    pub fn new() -> Self {
        Self::default()
    }

    /// Takes in the text of a run file; `file` is its name in messages.
    ///
    /// # Errors
    /// Text that is not TOML, with the place.
    pub fn text(mut self, file: &str, text: &str) -> Result<Self, RunFileError> {
        let failed = |error: &toml::de::Error| RunFileError {
            origin: Origin::in_text(file, text, error.span().unwrap_or_default()),
            key: String::new(),
            problem: Problem::Syntax { reason: error.message().to_owned() },
        };
        let spans = DeTable::parse(text).map_err(|error| failed(&error))?;
        let table: Table = toml::from_str(text).map_err(|error| failed(&error))?;
        self.note(file, text, "", spans.get_ref());
        self.table = table;
        Ok(self)
    }

    /// Takes the names of files gathered so far as relative to a folder, that of the run file: options that
    /// come later stay relative to where the user stands.
    ///
    /// # Example
    /// ```
    /// use myospring::run_file::Reader;
    /// let text = "[shape]\npicture = \"cell.tif\"\npixel_size = \"0.27 um\"";
    /// let reader = Reader::new().text("study/cell.toml", text)?.beside("study".as_ref());
    /// let run = reader.option("--outline", "segmentation.outline", "drawn.roi").resolve()?;
    /// let file = run.to_run_file();
    /// assert_eq!(file.shape.picture.as_deref(), Some("study/cell.tif"));
    /// assert_eq!(file.segmentation.outline.as_deref(), Some("drawn.roi"));
    /// # Ok::<(), myospring::run_file::RunFileError>(())
    /// ```
    #[must_use]
    pub fn beside(mut self, folder: &Path) -> Self {
        for key in PATHS {
            if let Some((table, name)) = key.split_once('.')
                && let Some(Value::Table(table)) = self.table.get_mut(table)
                && let Some(Value::String(path)) = table.get_mut(name)
            {
                *path = folder.join(&*path).to_string_lossy().into_owned();
            }
        }
        self
    }

    fn note(&mut self, file: &str, text: &str, prefix: &str, table: &DeTable<'_>) {
        let place = |span: Range<usize>| Origin::in_text(file, text, span);
        for (key, value) in table {
            let path = join(prefix, key.get_ref());
            let spots = Place { key: place(key.span()), value: place(Spanned::span(value)) };
            if let DeValue::Table(inner) = value.get_ref() {
                self.note(file, text, &path, inner);
            }
            self.origins.insert(path, spots);
        }
    }

    /// Sets a key, `table.key`, by an option of the command line; what it excludes is dropped.
    #[must_use]
    pub fn option(mut self, option: &str, key: &str, value: impl Into<Value>) -> Self {
        for group in ALTERNATIVES.iter().filter(|group| group.contains(&key)) {
            for other in *group {
                self.remove(other);
            }
        }
        let value = value.into();
        if key == "mechanics.support" {
            for (other, _) in OF_ONE_SUPPORT.iter().filter(|row| value.as_str() != Some(row.1)) {
                self.remove(other);
            }
        }
        if key == "numerics.integrator" && value.as_str() == Some("quasi-static") {
            self.remove("numerics.time_step");
        }
        let origin = Origin::Option(option.to_owned());
        self.origins.insert(key.to_owned(), Place { key: origin.clone(), value: origin });
        if let Some((table, name)) = key.split_once('.') {
            let table = self.table.entry(table).or_insert_with(|| Table::new().into());
            if let Value::Table(table) = table {
                table.insert(name.to_owned(), value);
            }
        } else {
            self.table.insert(key.to_owned(), value);
        }
        self
    }

    fn remove(&mut self, key: &str) {
        if let Some((table, name)) = key.split_once('.')
            && let Some(Value::Table(table)) = self.table.get_mut(table)
        {
            table.remove(name);
        }
    }

    /// Where a key's value came from.
    pub fn origin(&self, key: &str) -> Origin {
        self.place(key).map_or(Origin::Unknown, |place| place.value.clone())
    }

    /// The place of a key, or else of the table that should hold it.
    fn place(&self, key: &str) -> Option<&Place> {
        let table = key.rsplit_once('.').map_or("", |(table, _)| table);
        self.origins.get(key).or_else(|| self.origins.get(table))
    }

    fn locate(&self, key: String, problem: Problem) -> RunFileError {
        let place = self.place(&key);
        let at_key = matches!(problem, Problem::UnknownKey { .. });
        let origin = place.map_or(Origin::Unknown, |place| {
            if at_key { place.key.clone() } else { place.value.clone() }
        });
        RunFileError { origin, key, problem }
    }

    /// The run file, every key known and of the right kind.
    ///
    /// # Errors
    /// Unknown keys and names, values of the wrong kind.
    pub fn read(self) -> Result<(RunFile, Self), RunFileError> {
        check::table(&schema(), &self.table, "")
            .map_err(|(key, problem)| self.locate(key, problem))?;
        let file = RunFile::deserialize(self.table.clone()).map_err(|error| {
            RunFileError::bare("", Problem::Syntax { reason: error.message().to_owned() })
        })?;
        Ok((file, self))
    }

    /// The run, every value checked and every default filled in.
    ///
    /// # Errors
    /// All that [`Reader::read`] and [`RunFile::resolve`] refuse, with the place.
    pub fn resolve(self) -> Result<Run, RunFileError> {
        let (file, reader) = self.read()?;
        resolve::resolve(&file).map_err(|(key, problem)| reader.locate(key, problem))
    }
}

pub(super) fn join(prefix: &str, key: &str) -> String {
    if prefix.is_empty() { key.to_owned() } else { format!("{prefix}.{key}") }
}
