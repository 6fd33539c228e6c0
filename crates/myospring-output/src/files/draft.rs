//! A folder of results that is being written.

use super::error::FileError;
use super::hold::{Hold, hold, try_hold};
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// Lock file of a running process in its hidden folder; the name says which program made the
/// folder.
const LOCK: &str = "myospring.lock";
/// Subfolder with the files.
const FILES: &str = "files";
/// Number of attempts to make a folder that other processes may clear at the same moment.
const TRIES: usize = 10;

/// A hidden folder, `.NAME.part`, in which the content of the folder `NAME` is prepared. It lies
/// beside that folder if that does not exist yet, else inside it, since it may be a disk of its
/// own.
///
/// Only one process at a time may have it. Dropping it removes it; leftovers of a killed process
/// are removed when the next one begins in the same place.
#[derive(Debug)]
pub struct Draft {
    folder: PathBuf,
    /// Held while the draft exists.
    lock: Option<File>,
    /// Folders around it that were made for it, the innermost first: those that stay empty go with it.
    around: Vec<PathBuf>,
}

impl Draft {
    /// Begins the draft of the folder `target`.
    ///
    /// # Errors
    /// [`FileError::InUse`] if another process is writing there; a path without a folder name; a
    /// place that cannot be written to.
    pub fn begin(target: &Path) -> Result<Self, FileError> {
        let Some(name) = target.file_name() else {
            return Err(FileError::NoName { path: target.to_owned() });
        };
        let part = format!(".{}.part", name.to_string_lossy());
        let folder = if target.is_dir() { target.join(part) } else { target.with_file_name(part) };
        let failed = |source| FileError::Folder { path: target.to_owned(), source };
        let has_files = fs::read_dir(&folder).is_ok_and(|mut entries| entries.next().is_some());
        if has_files && !folder.join(LOCK).exists() {
            return Err(FileError::Foreign { path: folder });
        }
        let in_use = || FileError::InUse { path: target.to_owned() };
        let missing = |place: &&Path| !place.as_os_str().is_empty() && !place.exists();
        let around = folder.ancestors().skip(1).take_while(missing).map(Path::to_owned).collect();
        let lock = Self::lock(&folder, failed)?.ok_or_else(in_use)?;
        let files = folder.join(FILES);
        match lock {
            Hold::Ours(lock) => {
                let draft = Self { folder, lock: Some(lock), around };
                // Left by a process that has ended.
                remove_folder(&files).map_err(failed)?;
                fs::create_dir(&files).map_err(failed)?;
                draft.clear_leftovers();
                Ok(draft)
            }
            // On a disk without locks, existing files may belong to a running process.
            Hold::Unknown(_) => match fs::create_dir(&files) {
                Ok(()) => Ok(Self { folder, lock: None, around }),
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => Err(in_use()),
                Err(error) => Err(failed(error)),
            },
            Hold::Others => Err(in_use()),
        }
    }

    /// Makes and locks a hidden folder; `None` if other processes keep removing it.
    fn lock(
        folder: &Path,
        failed: impl Fn(io::Error) -> FileError,
    ) -> Result<Option<Hold>, FileError> {
        for _ in 0..TRIES {
            let held = fs::create_dir_all(folder).and_then(|()| hold(&folder.join(LOCK)));
            match held {
                Ok(held) => return Ok(Some(held)),
                Err(error) if error.kind() == io::ErrorKind::NotFound => {}
                Err(error) => return Err(failed(error)),
            }
        }
        Ok(None)
    }

    /// The folder for the files.
    pub fn folder(&self) -> PathBuf {
        self.folder.join(FILES)
    }

    /// Removes the hidden folders beside this one that no running process holds.
    fn clear_leftovers(&self) {
        let Some(entries) = self.folder.parent().and_then(|place| fs::read_dir(place).ok()) else {
            return;
        };
        for entry in entries.flatten() {
            let (name, path) = (entry.file_name(), entry.path());
            let name = name.to_string_lossy();
            if name.starts_with('.') && name.ends_with(".part") && path != self.folder {
                // A leftover that cannot be removed does no harm.
                if let Ok(Hold::Ours(lock)) = try_hold(&path.join(LOCK), false) {
                    drop(Self { folder: path, lock: Some(lock), around: Vec::new() });
                }
            }
        }
    }
}

impl Drop for Draft {
    fn drop(&mut self) {
        // What cannot be removed here is cleared by the next process. The lock is removed last,
        // while it is held, so that another process that starts now makes a new one.
        remove_folder(&self.folder.join(FILES)).ok();
        fs::remove_file(self.folder.join(LOCK)).ok();
        fs::remove_dir(&self.folder).ok();
        self.lock = None;
        // One that holds something stays.
        self.around.iter().try_for_each(fs::remove_dir).ok();
    }
}

/// Removes a folder with its content, if it exists.
fn remove_folder(path: &Path) -> io::Result<()> {
    fs::remove_dir_all(path).or_else(|error| match error.kind() {
        io::ErrorKind::NotFound => Ok(()),
        _ => Err(error),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).unwrap();
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect()
    }

    #[test]
    fn a_folder_is_drafted_by_one_at_a_time_and_nothing_is_left() {
        let place = tempfile::tempdir().unwrap();
        let target = place.path().join("beat");
        let first = Draft::begin(&target).unwrap();
        fs::write(first.folder().join("traces.csv"), "t_ms\n").unwrap();
        let error = Draft::begin(&target).unwrap_err();
        assert!(matches!(error, FileError::InUse { .. }), "{error}");
        assert!(first.folder().join("traces.csv").exists(), "the first keeps its files");
        let other = Draft::begin(&place.path().join("other")).unwrap();
        assert!(first.folder().exists(), "it is held, so it is no leftover");
        drop((first, other));
        assert_eq!(names(place.path()), [""; 0]);
        Draft::begin(&target).unwrap();
        // Nor are folders that were made for it, unless something else came there.
        let results = place.path().join("all/results");
        let [beat, other] =
            ["beat", "other"].map(|name| Draft::begin(&results.join(name)).unwrap());
        fs::write(place.path().join("all/mine.txt"), "").unwrap();
        // The one that made them goes last.
        drop((other, beat));
        assert_eq!(names(place.path()), ["all"]);
        assert_eq!(names(&place.path().join("all")), ["mine.txt"]);
    }

    #[test]
    fn what_a_killed_process_has_left_is_cleared_and_what_is_not_ours_stays() {
        let place = tempfile::tempdir().unwrap();
        // Its own and that of another name: nobody holds their locks.
        for name in [".beat.part", ".old.part"] {
            fs::create_dir_all(place.path().join(name).join(FILES)).unwrap();
            fs::write(place.path().join(name).join(LOCK), "").unwrap();
            fs::write(place.path().join(name).join(FILES).join("traces.csv"), "t_").unwrap();
        }
        fs::create_dir_all(place.path().join(".mine.part/files/notes")).unwrap();
        let error = Draft::begin(&place.path().join("mine")).unwrap_err();
        assert!(matches!(error, FileError::Foreign { .. }), "{error}");
        let draft = Draft::begin(&place.path().join("beat")).unwrap();
        assert_eq!(names(&draft.folder()), [""; 0]);
        drop(draft);
        assert_eq!(names(place.path()), [".mine.part"]);
    }

    #[test]
    fn many_at_once_in_one_place_each_have_their_own() {
        let place = tempfile::tempdir().unwrap();
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let place = place.path();
                scope.spawn(move || {
                    for turn in 0..25 {
                        let target = place.join(format!("cell_{thread}"));
                        let draft = Draft::begin(&target).unwrap();
                        let file = draft.folder().join("traces.csv");
                        fs::write(&file, format!("{turn}")).unwrap();
                        assert_eq!(fs::read_to_string(&file).unwrap(), format!("{turn}"));
                    }
                });
            }
        });
        assert_eq!(names(place.path()), [""; 0]);
    }
}
