//! Why a file was not written.

use super::names::MANIFEST;
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
    /// The name is taken by something that is no file.
    #[error("`{path}` is {what}, which is never replaced; give another name")]
    NotAFile {
        /// The path that was given.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// The file is there, and not one that may be replaced.
    #[error(
        "`{path}` was not written by myospring, or was changed since, so it is not replaced; move it elsewhere, or \
         choose another folder"
    )]
    Foreign {
        /// The file.
        path: PathBuf,
    },
    /// The file is not as it was written.
    #[error(
        "`{path}` is not the file that myospring wrote there: it was changed, damaged, removed or put there since, as \
         {MANIFEST} shows"
    )]
    Changed {
        /// The file.
        path: PathBuf,
    },
    /// The folder holds files that no command wrote.
    #[error(
        "`{folder}` holds files that myospring did not write, or that were changed since: {names}. Nothing was \
         replaced; move these files elsewhere, or choose another folder"
    )]
    NotOurs {
        /// The folder.
        folder: PathBuf,
        /// The first few of the files.
        names: String,
    },
    /// The folder has no list of what was written there.
    #[error(
        "`{folder}` holds files ({names}) and no list of those that myospring wrote, {MANIFEST}, which earlier versions \
         did not keep. Nothing was replaced; choose another folder, or remove this one yourself"
    )]
    NoManifest {
        /// The folder.
        folder: PathBuf,
        /// The first few of the files.
        names: String,
    },
    /// What would be written or removed is read.
    #[error(
        "this command reads `{path}`, which its results would replace or remove; choose another place for them"
    )]
    Read {
        /// The file.
        path: PathBuf,
    },
}
