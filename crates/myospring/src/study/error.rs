//! Why a study cannot go on.

use crate::cell::solve::SolveError;
use crate::output::files::FileError;
use std::error::Error;
use std::io;
use std::path::PathBuf;

/// Anything that can go wrong with one member, or with whoever watches.
pub type Cause = Box<dyn Error + Send + Sync>;

/// Why a study did not begin or go on; what is wrong with one member is a row instead.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// The folder belongs to another study.
    #[error(
        "`{folder}` already holds results of other settings; choose another folder, or begin anew there"
    )]
    OtherSettings {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds something that is no study.
    #[error("`{folder}` already holds files; choose another folder, or begin anew there")]
    Occupied {
        /// The folder.
        folder: PathBuf,
    },
    /// Two members would be taken for one.
    #[error("two members of the study are named `{name}`; give each a name of its own")]
    SameName {
        /// The name.
        name: String,
    },
    /// The journal cannot be read or written.
    #[error(
        "cannot write `{path}`: {source}; choose a folder that you may write to, on a disk that has room"
    )]
    Journal {
        /// Its file.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// A row cannot be written as JSON.
    #[error("a row cannot be written as JSON: {0}; keys of maps must be text or numbers")]
    Row(#[from] serde_json::Error),
    /// A file of the results cannot be written.
    #[error(transparent)]
    File(#[from] FileError),
    /// Settings of the cells' integration that are not possible.
    #[error(transparent)]
    Cells(#[from] SolveError),
    /// The system gives no threads.
    #[error("the system gives no threads: {0}; ask for fewer")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// Whoever watches the study cannot go on.
    #[error(transparent)]
    Observer(Cause),
}
