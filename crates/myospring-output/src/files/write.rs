//! Writes one file completely or not at all.

use super::error::FileError;
use std::fs::{self, File};
use std::hash::{BuildHasher, Hasher, RandomState};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

/// Number of attempts to find an unused name for the temporary file.
const TRIES: usize = 100;
/// Parts of its name before and after the random part.
const PART: [&str; 2] = [".myospring-", ".part"];

/// Creates a folder and its parents; it may exist already.
///
/// # Errors
/// Errors of the system, or a file of the same name.
pub fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|source| FileError::Folder { path: path.to_owned(), source })
}

/// Writes a file atomically: a reader sees either the old file or the new one.
///
/// The bytes go to a hidden file with an unused name in the same folder, which is then renamed.
/// After an error the file is unchanged. A link stays, and the file that it leads to is written.
///
/// # Errors
/// Errors of the system, or a folder, device, pipe or broken link of that name; the error names the
/// file.
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

/// Like [`write()`], with content written by `fill`, for files larger than memory.
///
/// # Errors
/// Those of [`write()`] and of `fill`; the file is then unchanged.
pub fn write_with<E: From<FileError>>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
) -> Result<(), E> {
    write_and(path, fill, |_| Ok(()))
}

/// Like [`write_with`]; `named` is called with the path of the complete file just before it is
/// renamed.
pub(super) fn write_and<E: From<FileError>>(
    path: &Path,
    fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
    named: impl FnOnce(&Path) -> Result<(), FileError>,
) -> Result<(), E> {
    let target = destination(path)?;
    let failed = |source| FileError::Write { path: path.to_owned(), source };
    let (part, file) = part_of(&target).map_err(failed)?;
    let filled = || {
        let mut writer = BufWriter::new(&file);
        fill(&mut writer)?;
        writer.flush().and_then(|()| file.sync_all()).map_err(failed)?;
        named(&part)?;
        let renamed = fs::rename(&part, &target);
        Ok(renamed.map_err(|source| FileError::Rename { path: path.to_owned(), source })?)
    };
    let outcome = filled();
    if outcome.is_err() {
        // The error above says what went wrong; a leftover is hidden.
        fs::remove_file(&part).ok();
    }
    outcome
}

/// Checks that a path can be written without replacing something that is not a file.
///
/// # Errors
/// Those of [`write()`].
pub fn check_writable(path: &Path) -> Result<(), FileError> {
    destination(path).map(drop)
}

/// The path to write: for a link, the file to which it leads.
fn destination(path: &Path) -> Result<PathBuf, FileError> {
    let refused = |what| FileError::NotAFile { path: path.to_owned(), what };
    if path.file_name().is_none() {
        return Err(FileError::NoName { path: path.to_owned() });
    }
    let Ok(named) = fs::symlink_metadata(path) else { return Ok(path.to_owned()) };
    let real = if named.is_symlink() {
        path.canonicalize().map_err(|_| refused("a link that leads nowhere"))?
    } else {
        path.to_owned()
    };
    let about =
        fs::metadata(&real).map_err(|source| FileError::Write { path: path.to_owned(), source })?;
    match about.file_type() {
        kind if kind.is_file() => Ok(real),
        kind if kind.is_dir() => Err(refused("a folder")),
        _ => Err(refused("a device or a pipe")),
    }
}

/// Creates a file beside another, under an unused hidden name.
pub(super) fn part_of(path: &Path) -> io::Result<(PathBuf, File)> {
    let [before, after] = PART;
    let mut tries = 0;
    loop {
        let random = RandomState::new().build_hasher().finish();
        let part = path.with_file_name(format!("{before}{random:016x}{after}"));
        match File::create_new(&part) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && tries < TRIES => {
                tries += 1;
            }
            made => return Ok((part, made?)),
        }
    }
}

/// Removes temporary files that killed processes left in a folder and those in it; no other process
/// may be writing there.
///
/// # Errors
/// Errors of the system.
pub fn clear_parts(folder: &Path) -> io::Result<()> {
    let [before, after] = PART;
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = entry.file_name().to_string_lossy().into_owned();
        let random = name.strip_prefix(before).and_then(|name| name.strip_suffix(after));
        let ours = |random: &str| {
            random.len() == 16 && random.bytes().all(|byte| byte.is_ascii_hexdigit())
        };
        let kind = entry.file_type()?;
        if kind.is_dir() {
            clear_parts(&entry.path())?;
        } else if random.is_some_and(ours) && kind.is_file() {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
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
    fn files_of_others_beside_it_stay_and_what_a_killed_process_left_is_cleared() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let theirs = ["a.svg.part", ".a.svg.part", ".myospring-of-mine.part"];
        for name in theirs {
            fs::write(at(name), "theirs").unwrap();
        }
        fs::create_dir(at("figures")).unwrap();
        let left = ["a.svg", "figures/a.svg"].map(|name| part_of(&at(name)).unwrap().0);
        write(&at("a.svg"), "new").unwrap();
        clear_parts(folder.path()).unwrap();
        assert!(left.iter().all(|part| !part.exists()));
        for name in theirs {
            assert_eq!(fs::read_to_string(at(name)).unwrap(), "theirs", "{name}");
        }
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_stays_and_what_is_no_file_is_refused() {
        use std::os::unix::fs::symlink;
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        fs::write(at("far.toml"), "old").unwrap();
        symlink("far.toml", at("near.toml")).unwrap();
        write(&at("near.toml"), "new").unwrap();
        assert!(fs::symlink_metadata(at("near.toml")).unwrap().is_symlink());
        assert_eq!(fs::read_to_string(at("far.toml")).unwrap(), "new");
        symlink("nowhere", at("lost.toml")).unwrap();
        symlink("/dev/null", at("null.toml")).unwrap();
        let socket = std::os::unix::net::UnixListener::bind(at("socket")).unwrap();
        for name in ["lost.toml", "null.toml", "socket"] {
            let error = write(&at(name), "x").unwrap_err();
            assert!(matches!(error, FileError::NotAFile { .. }), "{name}: {error}");
        }
        drop(socket);
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 5);
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
        assert!(matches!(error, FileError::NotAFile { what: "a folder", .. }), "{error}");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
        assert!(matches!(write(Path::new(".."), "x"), Err(FileError::NoName { .. })));
    }
}
