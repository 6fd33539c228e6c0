//! Whole files or none: the only place of the library that writes to the disk, beside the journal of a study.

mod draft;
mod error;
mod hold;

pub use draft::Draft;
pub use error::FileError;
pub use hold::{Hold, hold};

use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

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
/// error the file is as it was before; a part that a killed process has left is written anew.
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
    let failed = |source| FileError::Write { path: path.to_owned(), source };
    write_with(path, |file| file.write_all(contents.as_ref()).map_err(failed))
}

/// As [`write()`], with what `fill` writes: a file that is larger than memory need not be held.
///
/// # Errors
/// Those of [`write()`] and of `fill`; the file is then as it was before.
pub fn write_with<E: From<FileError>>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    let Some(name) = path.file_name() else {
        return Err(FileError::NoName { path: path.to_owned() }.into());
    };
    let mut part_name = name.to_owned();
    part_name.push(".part");
    let part = path.with_file_name(part_name);
    let failed = |source| FileError::Write { path: path.to_owned(), source };
    // Held until it has its name, so that nobody else writes into it or takes it for a leftover.
    let file = match hold(&part).map_err(failed)? {
        Hold::Ours(file) | Hold::Unknown(file) => file,
        Hold::Others => return Err(FileError::InUse { path: path.to_owned() }.into()),
    };
    let filled = || {
        file.set_len(0).map_err(failed)?;
        let mut writer = BufWriter::new(&file);
        fill(&mut writer)?;
        writer.flush().and_then(|()| file.sync_all()).map_err(failed)?;
        let renamed = fs::rename(&part, path);
        Ok(renamed.map_err(|source| FileError::Rename { path: path.to_owned(), source })?)
    };
    let outcome = filled();
    if outcome.is_err() {
        // The error above says what went wrong; a rest that stays is named `.part`.
        fs::remove_file(&part).ok();
    }
    outcome
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
    fn a_part_that_was_left_is_written_anew_and_one_that_is_held_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let (path, part) = (folder.path().join("a.svg"), folder.path().join("a.svg.part"));
        fs::write(&part, "half of a file that was longer").unwrap();
        let held = hold(&part).unwrap();
        let error = write(&path, "new").unwrap_err();
        assert!(matches!(error, FileError::InUse { .. }) && part.exists(), "{error}");
        drop(held);
        write(&path, "new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert!(!part.exists());
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
