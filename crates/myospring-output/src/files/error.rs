//! Why a file was not written.

use super::names::MANIFEST;
use std::io;
use std::path::PathBuf;

/// Why a file was not written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// The path does not end in a file name.
    #[error(
        "`{path}` does not name a file; give a path that ends in a file name, like results/traces.csv"
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
    /// The name belongs to something that is not a file.
    #[error("`{path}` is {what}, which is never replaced; give another name")]
    NotAFile {
        /// The path that was given.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// The file exists and must not be replaced.
    #[error(
        "`{path}` was not written by myospring, or was changed since, so it is not replaced; move it elsewhere, or \
         choose another folder"
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file differs from what was written.
    #[error(
        "`{path}` is not the file that myospring wrote there: it was changed, damaged, removed or put there since, as \
         {MANIFEST} shows"
    )]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// The folder contains files that myospring did not write.
    #[error(
        "`{folder}` contains files that myospring did not write, or that were changed since: {names}. Nothing was \
         replaced; move these files elsewhere, or choose another folder"
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// The first few of the files.
        names: String,
    },
    /// The folder has files but no list of those that myospring wrote.
    #[error(
        "`{folder}` contains files ({names}) and no list of those that myospring wrote, {MANIFEST}, which earlier versions \
         did not keep. Nothing was replaced; choose another folder, or remove this one yourself"
    )]
    NoManifest {
        /// The folder.
        folder: PathBuf,
        /// The first few of the files.
        names: String,
    },
    /// A file that would be replaced or removed is also read.
    #[error(
        "this command reads `{path}`, which its results would replace or remove; choose another place for them"
    )]
    Read {
        /// The file.
        path: PathBuf,
    },
}
