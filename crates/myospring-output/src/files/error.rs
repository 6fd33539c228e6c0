//! Why a file was not written.

use std::io;
use std::path::PathBuf;

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The path ends in no file name.
    #[error(
        "`{path}` names no file; give a path that ends in a file name, like results/traces.csv"
    )]
    NoName {
        /// The path that was given.
        path: PathBuf,
    },
    /// The folder could not be made.
    #[error("cannot make the folder `{path}`: {source}; choose a folder that you may write to")]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// Another process is writing there.
    #[error("another run is writing to `{path}`; wait until it is done, or choose another place")]
    InUse {
        /// The file or folder.
        path: PathBuf,
    },
    /// The bytes could not be written next to the file.
    #[error(
        "cannot write `{path}`: {source}; check that its folder exists, that you may write to it \
         and that the disk has room"
    )]
    Write {
        /// The file that was asked for.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
    /// The finished file could not take its name.
    #[error("cannot replace `{path}`: {source}; close programs that hold it open")]
    Rename {
        /// The file that was asked for.
        path: PathBuf,
        /// What the system says.
        source: io::Error,
    },
}
