//! What reading a file takes, and why it may fail.

use std::fmt;
use std::str::FromStr;

/// The longest file, bytes.
pub const LONGEST_FILE: usize = 8 << 20;

/// Variables that the user names, `component.variable`; what is not named is found.
///
/// # Example
/// ```
/// use myospring_cell_files::Choices;
/// let choices: Choices = "calcium=Ca.cai, stimulus=membrane.i_app".parse()?;
/// assert_eq!(choices.calcium.as_deref(), Some("Ca.cai"));
/// assert_eq!(choices.to_string(), "stimulus=membrane.i_app,calcium=Ca.cai");
/// # Ok::<(), String>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Choices {
    /// The membrane potential.
    pub potential: Option<String>,
    /// The stimulus current.
    pub stimulus: Option<String>,
    /// Free calcium in the cytosol.
    pub calcium: Option<String>,
    /// Active tension.
    pub tension: Option<String>,
}

impl FromStr for Choices {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut choices = Self::default();
        for part in text.split(',').map(str::trim).filter(|part| !part.is_empty()) {
            let wrong = |reason: &str| {
                format!(
                    "`{part}` {reason}; write ROLE=VARIABLE, separated by commas, where ROLE is potential, stimulus, \
                     calcium or tension: calcium=Ca.cai"
                )
            };
            let (role, variable) = part.split_once('=').ok_or_else(|| wrong("names no role"))?;
            let place = match role.trim() {
                "potential" => &mut choices.potential,
                "stimulus" => &mut choices.stimulus,
                "calcium" => &mut choices.calcium,
                "tension" => &mut choices.tension,
                _ => return Err(wrong("has an unknown role")),
            };
            if variable.trim().is_empty() {
                return Err(wrong("names no variable"));
            }
            if place.replace(variable.trim().to_owned()).is_some() {
                return Err(wrong("names a second variable for its role"));
            }
        }
        Ok(choices)
    }
}

impl fmt::Display for Choices {
    fn fmt(&self, form: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { potential, stimulus, calcium, tension } = self;
        let all = [
            ("potential", potential),
            ("stimulus", stimulus),
            ("calcium", calcium),
            ("tension", tension),
        ];
        let named = all.iter().filter_map(|(role, name)| Some((role, name.as_ref()?)));
        for (index, (role, name)) in named.enumerate() {
            let comma = if index > 0 { "," } else { "" };
            write!(form, "{comma}{role}={name}")?;
        }
        Ok(())
    }
}

/// Why a file cannot be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub struct ReadError {
    /// The file.
    pub file: String,
    /// The line, from 1, if it has one.
    pub line: Option<usize>,
    /// The component, if the reason lies in one.
    pub component: Option<String>,
    /// What is wrong, and how to mend it.
    pub reason: String,
}

impl fmt::Display for ReadError {
    fn fmt(&self, form: &mut fmt::Formatter<'_>) -> fmt::Result {
        form.write_str(&self.file)?;
        if let Some(line) = self.line {
            write!(form, ", line {line}")?;
        }
        if let Some(component) = &self.component {
            write!(form, ", component {component}")?;
        }
        write!(form, ": {}", self.reason)
    }
}
