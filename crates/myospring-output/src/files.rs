//! Whole files or none: the only place of the library that writes to the disk, beside the journal of a study.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

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

/// Makes a folder with all above it; one that exists is fine.
///
/// # Errors
/// When the system refuses, or a file stands in the way.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|source| FileError::Folder { path: path.to_owned(), source })
}

/// Writes a file so that a reader sees the old one or the new one, never a part.
///
/// The bytes go to `<name>.part` in the same folder, which then takes the file's name. After an
/// error the file is as it was before.
///
/// # Errors
/// When the system refuses; the error names the file.
///
/// # Example
/// ```
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("traces.csv");
/// myospring::output::files::write(&path, "t_ms,u\n")?;
/// assert_eq!(std::fs::read_to_string(&path)?, "t_ms,u\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write(path: &Path, contents: impl AsRef<[u8]>) -> Result<(), FileError> {
    let Some(name) = path.file_name() else {
        return Err(FileError::NoName { path: path.to_owned() });
    };
    let mut part_name = name.to_owned();
    part_name.push(".part");
    let part = path.with_file_name(part_name);
    let outcome = write_through(&part, contents.as_ref())
        .map_err(|source| FileError::Write { path: path.to_owned(), source })
        .and_then(|()| {
            fs::rename(&part, path)
                .map_err(|source| FileError::Rename { path: path.to_owned(), source })
        });
    if outcome.is_err() {
        // The error above says what went wrong; a rest that stays is named `.part`.
        fs::remove_file(&part).ok();
    }
    outcome
}

fn write_through(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let mut file = File::create(path)?;
    file.write_all(bytes)?;
    file.sync_all()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_and_leaves_no_part() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.svg");
        write(&path, "old and longer").unwrap();
        write(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_failure_names_the_file_and_leaves_nothing_behind() {
        let folder = tempfile::tempdir().unwrap();
        let missing = folder.path().join("nowhere/a.csv");
        let message = write(&missing, "x").unwrap_err().to_string();
        assert!(message.contains("a.csv") && message.contains("folder exists"), "{message}");

        let taken = folder.path().join("taken");
        create_folder(&taken.join("inside")).unwrap();
        let error = write(&taken, "x").unwrap_err();
        assert!(matches!(error, FileError::Rename { .. }), "{error}");
        assert!(!folder.path().join("taken.part").exists());
        assert!(matches!(write(Path::new(".."), "x"), Err(FileError::NoName { .. })));
    }
}
