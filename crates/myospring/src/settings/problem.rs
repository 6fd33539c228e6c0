//! Problems of settings, and how to solve them.

use crate::cell::pacing::ProtocolError;
use crate::cell::{ModelError, UnknownModel};
use crate::parameter::{ParameterError, nearest};
use crate::units::UnitError;

/// The key that caused a problem, with its table, and the problem.
pub type Failure = (String, Problem);

/// What is wrong.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Problem {
    /// The text is not TOML.
    #[error("this is not TOML: {reason}")]
    Syntax {
        /// What the parser says.
        reason: String,
    },
    /// A key that does not exist.
    #[error("unknown key `{key}`{}{}", place(table), guess(suggestion.as_ref()))]
    UnknownKey {
        /// The written key.
        key: String,
        /// The table in which it was written; empty for the top level.
        table: String,
        /// A similar key.
        suggestion: Option<String>,
        /// The known keys.
        known: Vec<String>,
    },
    /// A word that is not in the list of allowed ones.
    #[error("`{key}` = \"{word}\" is none of: {}{}", known.join(", "), guess(suggestion.as_ref()))]
    UnknownWord {
        /// The key.
        key: String,
        /// The written word.
        word: String,
        /// A similar word.
        suggestion: Option<String>,
        /// The allowed words.
        known: Vec<String>,
    },
    /// A value of the wrong kind.
    #[error("`{key}` is {found}, but {wanted} is needed")]
    Kind {
        /// The key.
        key: String,
        /// The written value.
        found: String,
        /// What is expected.
        wanted: String,
    },
    /// NaN or infinity.
    #[error("`{key}` = {value} is not a finite number")]
    NotFinite {
        /// The key.
        key: String,
        /// The value.
        value: f64,
    },
    /// Text in a form that cannot be read.
    #[error("`{key}`: {reason}")]
    Text {
        /// The key.
        key: &'static str,
        /// What is wrong, and how to mend it.
        reason: String,
    },
    /// A value with a wrong unit, or without one.
    #[error("`{key}`: {cause}")]
    Unit {
        /// The key.
        key: String,
        /// What is wrong with it.
        cause: UnitError,
        /// An example.
        example: String,
    },
    /// A value outside its bounds.
    #[error("`{key}` = {value} is outside its bounds, {bounds}")]
    OutOfBounds {
        /// The key.
        key: &'static str,
        /// The given value, with its unit.
        value: String,
        /// The bounds, in words.
        bounds: String,
        /// An example of an allowed value.
        example: &'static str,
    },
    /// Keys that exclude each other.
    #[error("`{first}` and `{second}` exclude each other: {advice}")]
    Conflict {
        /// One key.
        first: &'static str,
        /// The other.
        second: &'static str,
        /// What to do.
        advice: &'static str,
    },
    /// A missing key that another one needs.
    #[error("`{key}` is missing; {reason}")]
    Missing {
        /// The key.
        key: &'static str,
        /// Why it is needed.
        reason: &'static str,
    },
    /// An interval that does not divide another.
    #[error("`{key}` = {value} ms is not a multiple of `{unit_key}` = {unit} ms")]
    NotAMultiple {
        /// The longer one's key.
        key: &'static str,
        /// The longer one, ms.
        value: f64,
        /// The shorter one's key.
        unit_key: &'static str,
        /// The shorter one, ms.
        unit: f64,
    },
    /// Too much to record.
    #[error(
        "`{key}` = {value} ms would record {count:.0} {what}, more than {most:.0}, in all beats of the run"
    )]
    TooMany {
        /// The interval's key.
        key: &'static str,
        /// The interval, ms.
        value: f64,
        /// Number of records.
        count: f64,
        /// What would be recorded.
        what: &'static str,
        /// Largest number of records.
        most: f64,
    },
    /// A file with an unknown ending.
    #[error("`{key}` = \"{path}\"{}", kind.as_ref().map_or(" has an ending that is not known".to_owned(), |kind| format!(": {kind}")))]
    Ending {
        /// The key.
        key: &'static str,
        /// The file.
        path: String,
        /// Known endings.
        known: String,
        /// What the file is and what to do, if the ending shows it.
        kind: Option<String>,
    },
    /// No cell model of that name.
    #[error("`cell.model`: {0}")]
    Model(UnknownModel),
    /// The file of a cell model that cannot be read or simulated.
    #[error("{reason}")]
    ModelFile {
        /// File, line, component, what is wrong, and how to mend it.
        reason: String,
    },
    /// A parameter that does not exist, or a value outside its range.
    #[error("`cell.parameters`: {0}")]
    Parameter(ParameterError),
    /// Parameters that contradict each other.
    #[error("`cell.parameters`: {0}")]
    Parameters(ModelError),
    /// An invalid stimulus.
    #[error("`stimulus`: {0}")]
    Stimulus(ProtocolError),
    /// An extra stimulus that the run does not reach.
    #[error(
        "`run.duration` = {duration_ms} ms ends before S2 at {s2_ms} ms; make it longer, or leave it out"
    )]
    EndsBeforeS2 {
        /// Time simulated, ms.
        duration_ms: f64,
        /// Time of S2, ms.
        s2_ms: f64,
    },
}

fn place(table: &str) -> String {
    if table.is_empty() { String::new() } else { format!(" in [{table}]") }
}

fn guess(suggestion: Option<&String>) -> String {
    suggestion.map(|word| format!("; did you mean `{word}`?")).unwrap_or_default()
}

impl Problem {
    /// The problem of an unknown key of a table.
    pub(crate) fn unknown_key<'a>(
        key: &str,
        table: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<String> = known.into_iter().map(str::to_owned).collect();
        let (key, table) = (key.to_owned(), table.to_owned());
        let suggestion = nearest(&key, known.iter().map(String::as_str)).map(str::to_owned);
        Self::UnknownKey { suggestion, key, table, known }
    }

    /// The problem of an unknown word for a key.
    pub(crate) fn unknown_word<'a>(
        key: &str,
        word: &str,
        known: impl IntoIterator<Item = &'a str>,
    ) -> Self {
        let known: Vec<String> = known.into_iter().map(str::to_owned).collect();
        let (key, word) = (key.to_owned(), word.to_owned());
        let suggestion = nearest(&word, known.iter().map(String::as_str)).map(str::to_owned);
        Self::UnknownWord { suggestion, key, word, known }
    }

    /// How to solve it; `name` is what is written before a value.
    pub(crate) fn advice(&self, name: &str) -> Option<String> {
        match self {
            Self::Syntax { .. } => {
                Some("`myospring init` writes a run file with every key to start from".to_owned())
            }
            Self::UnknownKey { table, known, .. } if table.is_empty() => {
                Some(format!("tables and keys at the top: {}", known.join(", ")))
            }
            Self::UnknownKey { table, known, .. } => {
                Some(format!("keys in [{table}]: {}", known.join(", ")))
            }
            Self::Unit { example, .. } => Some(format!("write it like {name}\"{example}\"")),
            Self::OutOfBounds { example, .. } => {
                Some(format!("give a value within the bounds, like {name}\"{example}\""))
            }
            Self::NotFinite { .. } => Some("give a number, or leave the key out".to_owned()),
            Self::NotAMultiple { unit, .. } => {
                Some(format!("give a multiple of {unit} ms, or change that one too"))
            }
            Self::TooMany { .. } => {
                Some("give a longer interval, fewer beats or a shorter duration".to_owned())
            }
            Self::Ending { known, .. } => Some(format!("files that are read: {known}")),
            Self::Model(_) => Some("`myospring models` lists the cell models".to_owned()),
            Self::ModelFile { .. } => Some(
                "`myospring models FILE` shows what is found in the file of a cell model"
                    .to_owned(),
            ),
            Self::Parameter(_) | Self::Parameters(_) => {
                Some("`myospring models NAME` lists the parameters with their ranges".to_owned())
            }
            Self::UnknownWord { .. }
            | Self::Kind { .. }
            | Self::Text { .. }
            | Self::Conflict { .. }
            | Self::Missing { .. }
            | Self::EndsBeforeS2 { .. }
            | Self::Stimulus(_) => None,
        }
    }
}
