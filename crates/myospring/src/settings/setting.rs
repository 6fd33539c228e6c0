//! One setting: its key, allowed values, and how it is read from and written to a run.

use super::bounds::{Bounds, Whole};
use super::problem::{Failure, Problem};
use super::run::Run;
use super::value::Value;
use super::words::Word;
use crate::microscopy::read::unread_kind;
use crate::units::Dimension;
use std::collections::BTreeMap;

/// A setting: one row of the table.
#[derive(Debug, Clone, Copy)]
pub struct Setting {
    /// The key with its table: `material.thickness`.
    pub key: &'static str,
    /// Its description; unit, bounds and words are not repeated.
    pub doc: &'static str,
    /// What happens without it, if there is no default value: `0.95 of the stability limit`.
    pub otherwise: Option<&'static str>,
    /// Its option on the command line, if there is one.
    pub option: Option<CommandOption>,
    /// Type of its values, and its field in a [`Run`].
    pub kind: ValueKind,
}

/// How a setting is written on the command line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CommandOption {
    /// With its dashes: `--thickness`.
    pub name: &'static str,
    /// Placeholder of its value in the help: `LENGTH`; empty for a flag.
    pub value: &'static str,
    /// Its help, without full stop, instead of the setting's description.
    pub help: Option<&'static str>,
    /// An alias, with its dashes.
    pub alias: Option<&'static str>,
}

/// Reads a value from a run; `None` if the run has no such value.
pub type Get<T> = fn(&Run) -> Option<T>;
/// Writes a value to a run. A value without a field, such as the label of a built-in cell, is
/// ignored here and rejected by the rules of run files.
pub type Set<T> = fn(&mut Run, T);
/// Values by name.
pub type Named = BTreeMap<String, Value>;

/// Type of a setting's values, with the reader and writer of its field in a [`Run`].
#[derive(Debug, Clone, Copy)]
pub enum ValueKind {
    /// Any text, or a name from a list that is defined elsewhere.
    Text {
        /// Reader.
        get: Get<String>,
        /// Writer.
        set: fn(&mut Run, &str) -> Result<(), Problem>,
    },
    /// A name from a list that is defined elsewhere, or the name of a file with one of some endings.
    NameOrFile {
        /// Endings of the files, without the dot.
        endings: &'static [&'static str],
        /// Reader.
        get: Get<String>,
        /// Writer.
        set: fn(&mut Run, &str) -> Result<(), Problem>,
    },
    /// The name of a file, or one of some words instead.
    File {
        /// Known endings, without the dot.
        endings: &'static [&'static str],
        /// Words that do not name a file; `./word.csv` is a file.
        words: &'static [Word],
        /// An example, as written by users.
        example: &'static str,
        /// Reader.
        get: Get<String>,
        /// Writer.
        set: Set<String>,
    },
    /// One of some words.
    Words {
        /// The words.
        words: &'static [Word],
        /// Reader.
        get: Get<&'static str>,
        /// Writer; `None` for any other word.
        set: fn(&mut Run, &str) -> Option<()>,
    },
    /// True or false.
    Flag {
        /// Reader.
        get: Get<bool>,
        /// Writer.
        set: Set<bool>,
    },
    /// A whole number.
    Whole {
        /// Its bounds.
        bounds: Whole,
        /// Reader.
        get: Get<u32>,
        /// Writer.
        set: Set<u32>,
    },
    /// A number with a unit, or a dimensionless number.
    Quantity {
        /// Its bounds.
        bounds: Bounds,
        /// Reader, in the internal unit.
        get: Get<f64>,
        /// Writer, in the internal unit.
        set: Set<f64>,
    },
    /// Text or a number in a special form.
    Written {
        /// Its bounds, if it is a quantity.
        bounds: Option<Bounds>,
        /// Whether it may be a number without unit.
        numbers: bool,
        /// An example, as written by users.
        example: &'static str,
        /// Reader.
        get: Get<Value>,
        /// Writer.
        set: fn(&mut Run, &Value) -> Result<(), Problem>,
    },
    /// Quantities by name, each a number with or without unit.
    Named {
        /// A name and its value.
        example: (&'static str, &'static str),
        /// Reader.
        get: Get<Named>,
        /// Writer; a failure states which of them caused it.
        set: fn(&mut Run, &Named) -> Result<(), Failure>,
    },
}

impl Setting {
    pub(super) const fn new(key: &'static str, doc: &'static str, kind: ValueKind) -> Self {
        Self { key, doc, otherwise: None, option: None, kind }
    }

    pub(super) const fn quantity(
        key: &'static str,
        doc: &'static str,
        bounds: Bounds,
        get: Get<f64>,
        set: Set<f64>,
    ) -> Self {
        Self::new(key, doc, ValueKind::Quantity { bounds, get, set })
    }

    /// Sets what happens without it.
    pub(super) const fn otherwise(mut self, otherwise: &'static str) -> Self {
        self.otherwise = Some(otherwise);
        self
    }

    /// Adds an option of the command line with the setting's description as help.
    pub(super) const fn option(mut self, name: &'static str, value: &'static str) -> Self {
        self.option = Some(CommandOption { name, value, help: None, alias: None });
        self
    }

    /// Adds an option of the command line with its own help.
    pub(super) const fn option_saying(
        mut self,
        name: &'static str,
        value: &'static str,
        help: &'static str,
    ) -> Self {
        self.option = Some(CommandOption { name, value, help: Some(help), alias: None });
        self
    }

    /// Adds an alias of its option.
    pub(super) const fn alias(mut self, alias: &'static str) -> Self {
        if let Some(option) = &mut self.option {
            option.alias = Some(alias);
        }
        self
    }

    /// The key within its table: `thickness`.
    pub fn name(&self) -> &'static str {
        self.key.rsplit_once('.').map_or(self.key, |(_, name)| name)
    }

    /// Its bounds, if it is a number.
    pub fn bounds(&self) -> Option<Bounds> {
        match self.kind {
            ValueKind::Quantity { bounds, .. } => Some(bounds),
            ValueKind::Written { bounds, .. } => bounds,
            _ => None,
        }
    }

    /// The internal unit; empty for a dimensionless number, `None` for other types.
    pub fn unit(&self) -> Option<&'static str> {
        match self.kind {
            ValueKind::Whole { .. } => Some(""),
            _ => self.bounds().map(|bounds| bounds.dimension.unit()),
        }
    }

    /// The bounds in words: `above 0 um, at most 100 um`.
    pub fn bounds_in_words(&self) -> Option<String> {
        match self.kind {
            ValueKind::Whole { bounds, .. } => {
                Some(format!("{} to {}", bounds.minimum, bounds.maximum))
            }
            _ => self.bounds()?.words(),
        }
    }

    /// Whether a value of it names a file.
    pub fn names_file(&self, value: &str) -> bool {
        match self.kind {
            ValueKind::File { words, .. } => words.iter().all(|word| word.name != value),
            ValueKind::NameOrFile { endings, .. } => {
                let ending = value.rsplit_once('.').map_or("", |(_, ending)| ending);
                endings.iter().any(|known| known.eq_ignore_ascii_case(ending))
            }
            _ => false,
        }
    }

    /// The allowed words; empty if it may be anything else.
    pub fn words(&self) -> &'static [Word] {
        match self.kind {
            ValueKind::Words { words, .. } => words,
            _ => &[],
        }
    }

    /// Its value in the run of an empty run file; `None` if that has none.
    pub fn default(&self) -> Option<Value> {
        self.get(&Run::default_run())
    }

    /// Whether it is written as text: with a unit, in words, or as a name.
    fn reads_text(&self) -> bool {
        !matches!(
            self.kind,
            ValueKind::Flag { .. } | ValueKind::Whole { .. } | ValueKind::Named { .. }
        )
    }

    /// Whether it may be a number without unit, in addition to text.
    pub fn takes_numbers(&self) -> bool {
        match self.kind {
            ValueKind::Quantity { bounds, .. } => bounds.dimension == Dimension::Number,
            ValueKind::Written { numbers, .. } => numbers,
            _ => false,
        }
    }

    /// An example, as written by users; `None` if any text is allowed.
    pub fn example(&self) -> Option<Value> {
        Some(match self.kind {
            ValueKind::Text { .. } | ValueKind::NameOrFile { .. } => return None,
            ValueKind::File { example, .. } => Value::from(example),
            ValueKind::Words { words, .. } => Value::from(words.first()?.name),
            ValueKind::Flag { .. } => Value::Flag(true),
            ValueKind::Whole { bounds, .. } => Value::Whole(bounds.example.into()),
            ValueKind::Quantity { bounds: Bounds { example, .. }, .. }
            | ValueKind::Written { example, .. } => {
                // A dimensionless number is written without quotes.
                let number = example.parse().ok().filter(|_| self.unit() == Some(""));
                number.map_or(Value::from(example), Value::Number)
            }
            ValueKind::Named { example: (name, value), .. } => {
                Value::Named([(name.to_owned(), Value::from(value))].into())
            }
        })
    }

    /// The value of this setting in a run, as written by users; `None` if it has none, or if the
    /// shape or the stability limit determines it.
    pub fn get(&self, run: &Run) -> Option<Value> {
        match self.kind {
            ValueKind::Text { get, .. }
            | ValueKind::NameOrFile { get, .. }
            | ValueKind::File { get, .. } => get(run).map(Value::Text),
            ValueKind::Words { get, .. } => get(run).map(Value::from),
            ValueKind::Flag { get, .. } => get(run).map(Value::Flag),
            ValueKind::Whole { get, .. } => get(run).map(|number| Value::Whole(number.into())),
            ValueKind::Quantity { bounds, get, .. } => get(run).map(|number| bounds.write(number)),
            ValueKind::Written { get, .. } => get(run),
            ValueKind::Named { get, .. } => {
                get(run).filter(|values| !values.is_empty()).map(Value::Named)
            }
        }
    }

    /// The value, if it has the right type; [`Setting::set`] checks units and bounds.
    ///
    /// # Errors
    /// A number for a word, a table for a number, an infinite number, an unknown word.
    pub fn accept(&self, value: Value) -> Result<Value, Failure> {
        let key = self.key;
        let fail = |problem| Err((key.to_owned(), problem));
        let whole = matches!(self.kind, ValueKind::Whole { .. });
        let value = match value {
            Value::Whole(number) if !whole => Value::Number(number as f64),
            value => value,
        };
        match (self.kind, value) {
            (_, Value::Number(value)) if !value.is_finite() => {
                fail(Problem::NotFinite { key: key.to_owned(), value })
            }
            (ValueKind::Words { words, .. }, Value::Text(word)) => {
                if words.iter().any(|known| known.name == word) {
                    return Ok(Value::Text(word));
                }
                fail(Problem::unknown_word(key, &word, words.iter().map(|word| word.name)))
            }
            (ValueKind::Whole { bounds, .. }, Value::Whole(number)) => {
                match bounds.read(key, number) {
                    Ok(number) => Ok(Value::Whole(number.into())),
                    Err(problem) => fail(problem),
                }
            }
            (ValueKind::Named { .. }, Value::Named(values)) => {
                let values = values.into_iter().map(|(name, value)| {
                    let number = named(&format!("{key}.{name}"), value)?;
                    Ok((name, number))
                });
                Ok(Value::Named(values.collect::<Result<_, Failure>>()?))
            }
            (ValueKind::Flag { .. }, value @ Value::Flag(_)) => Ok(value),
            (_, value @ Value::Text(_)) if self.reads_text() => Ok(value),
            // A number without a required unit is passed on to the reader of units, which reports
            // it.
            (_, value @ Value::Number(_)) if self.takes_numbers() || self.bounds().is_some() => {
                Ok(value)
            }
            (_, value) => {
                let (key, wanted) = (key.to_owned(), self.wanted().to_owned());
                fail(Problem::Kind { key, found: value.described(), wanted })
            }
        }
    }

    /// The type of its values, in a sentence.
    pub(crate) fn wanted(&self) -> &'static str {
        match self.kind {
            ValueKind::Flag { .. } => "true or false",
            ValueKind::Whole { .. } => "a whole number",
            ValueKind::Named { .. } => "a table",
            ValueKind::Quantity { .. } | ValueKind::Written { .. } if self.unit() == Some("") => {
                "a number"
            }
            _ => "text in quotes",
        }
    }

    /// Writes a value to a run.
    ///
    /// Settings depend on each other: a run is valid only after all of them were applied in the
    /// order of the table, and after the rules between settings were checked; a run file does both.
    ///
    /// # Errors
    /// A value of the wrong type, with a wrong unit or outside its bounds, with the key that caused
    /// it.
    pub fn set(&self, run: &mut Run, value: &Value) -> Result<(), Failure> {
        let key = self.key;
        let accepted = self.accept(value.clone())?;
        let done = match (self.kind, &accepted) {
            (ValueKind::Named { set, .. }, Value::Named(values)) => return set(run, values),
            (
                ValueKind::Text { set, .. } | ValueKind::NameOrFile { set, .. },
                Value::Text(text),
            ) => set(run, text),
            (ValueKind::File { endings, words, set, .. }, Value::Text(path)) => {
                let is_word = words.iter().any(|word| word.name == path);
                let checked =
                    if is_word { Ok(()) } else { check_ending(key, path, endings, words) };
                checked.map(|()| set(run, path.clone()))
            }
            (ValueKind::Words { words, set, .. }, Value::Text(word)) => {
                set(run, word).ok_or_else(|| {
                    Problem::unknown_word(key, word, words.iter().map(|word| word.name))
                })
            }
            (ValueKind::Flag { set, .. }, Value::Flag(flag)) => {
                set(run, *flag);
                Ok(())
            }
            (ValueKind::Whole { bounds, set, .. }, Value::Whole(number)) => {
                bounds.read(key, *number).map(|number| set(run, number))
            }
            (ValueKind::Quantity { bounds, set, .. }, value) => {
                bounds.read(key, value).map(|number| set(run, number))
            }
            (ValueKind::Written { set, .. }, value) => set(run, value),
            (_, value) => Err(Problem::Kind {
                key: key.to_owned(),
                found: value.described(),
                wanted: self.wanted().to_owned(),
            }),
        };
        done.map_err(|problem| (key.to_owned(), problem))
    }
}

/// A named quantity, if it is a number or text.
fn named(key: &str, value: Value) -> Result<Value, Failure> {
    let key = key.to_owned();
    match value {
        Value::Number(value) if !value.is_finite() => {
            Err((key.clone(), Problem::NotFinite { key, value }))
        }
        Value::Whole(number) => Ok(Value::Number(number as f64)),
        Value::Number(_) | Value::Text(_) => Ok(value),
        Value::Flag(_) | Value::Named(_) => {
            let (found, wanted) = (value.described(), "a number".to_owned());
            Err((key.clone(), Problem::Kind { key, found, wanted }))
        }
    }
}

fn check_ending(
    key: &'static str,
    path: &str,
    endings: &[&str],
    words: &[Word],
) -> Result<(), Problem> {
    let lower = path.to_lowercase();
    if endings.iter().any(|ending| lower.ends_with(&format!(".{ending}"))) {
        return Ok(());
    }
    if !(words.is_empty() || path.contains(['.', '/', '\\'])) {
        let known = words.iter().map(|word| word.name).chain(["the name of a file"]);
        return Err(Problem::unknown_word(key, path, known));
    }
    let known = endings.iter().map(|ending| format!(".{ending}")).collect::<Vec<_>>().join(", ");
    let kind = lower.rsplit('.').next().and_then(unread_kind).map(|kind| kind.to_string());
    Err(Problem::Ending { key, path: path.to_owned(), known, kind })
}
