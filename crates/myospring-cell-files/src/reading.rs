//! What reading a file takes, and why it may fail.

use std::fmt;

/// The longest file, bytes.
pub const LONGEST_FILE: usize = 8 << 20;

/// Variables that the user names, `component.variable`; what is not named is found.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
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
