//! Errors that end a study.

use crate::cell::solve::SolveError;
use crate::output::files::FileError;
use std::error::Error;
use std::io;
use std::path::PathBuf;

/// Error of one member, or of an observer.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why a study did not begin or continue; the error of one member is a row instead.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The folder belongs to another study.
    #[error(
        "`{folder}` already contains results of other settings; choose another folder, or start again there"
    )]
    OtherSettings {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder contains files that do not belong to a study.
    #[error("`{folder}` already contains files; choose another folder, or start again there")]
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
    /// Two members have the same name.
    #[error("two members of the study are named `{name}`; give each its own name")]
    SameName {
        /// The name.
        name: String,
    },
    /// The journal cannot be read or written.
    #[error(
        "cannot write `{path}`: {source}; choose a folder that you may write to, on a disk that has room"
    )]
    Journal {
        /// The file.
        path: PathBuf,
        /// Error of the operating system.
        source: io::Error,
    },
    /// The journal no longer has a member's line where it was written.
    #[error(
        "`{path}` was changed while the study ran: the line of `{member}` is no longer where it was written; start the study again in \
         an empty folder"
    )]
    Changed {
        /// The file.
        path: PathBuf,
        /// Name of the member.
        member: String,
    },
    /// A row cannot be written as JSON.
    #[error("a row cannot be written as JSON: {0}; keys of maps must be text or numbers")]
    Row(#[from] serde_json::Error),
    /// A file of the results cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Invalid settings of the integration of cells.
    #[error(transparent)]
    Cells(#[from] SolveError),
    /// The operating system refuses threads.
    #[error("the operating system refuses threads: {0}; use fewer")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// The observer failed.
    #[error(transparent)]
    Observer(Cause),
}
