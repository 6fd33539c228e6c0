//! What is done, line by line, so that an interrupted study goes on where it was.

use super::{Member, StudyError};
use crate::output::files::{self, FileError, Hold, hold};
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, DirEntry, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

const FILE: &str = "progress.jsonl";
const SETTINGS: &str = "settings.toml";

/// A member that is done.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Entry<R> {
    /// Its name, under the word for such members.
    #[serde(flatten)]
    name: BTreeMap<String, String>,
    /// The hash of its input; empty if there was none.
    sha256: String,
    rows: Vec<R>,
}

/// The journal of a study: `progress.jsonl`, a line for each member that is done, beside `settings.toml`, all
/// that they have in common. A study goes on only with the same settings to the letter. While it goes on, the
/// journal is locked: a second study in its folder is refused.
pub struct Journal<M: Member> {
    state: Mutex<State<M::Row>>,
}

struct State<R> {
    file: Option<(PathBuf, File)>,
    entries: BTreeMap<String, Entry<R>>,
}

impl<M: Member> Journal<M> {
    /// A journal that is forgotten with the study.
    pub fn in_memory() -> Self {
        Self { state: Mutex::new(State { file: None, entries: BTreeMap::new() }) }
    }

    /// Goes on with the journal in a folder of results, or begins one in a folder that is empty or not there.
    ///
    /// `settings` is what the rows depend on beside the members' input, as text.
    ///
    /// # Errors
    /// A folder that holds results of other settings, or anything else, that another study is writing to, or that
    /// cannot be written to.
    pub fn open(folder: &Path, settings: &str) -> Result<Self, StudyError> {
        files::create_folder(folder)?;
        Self::belongs(folder, settings)?;
        let (path, mut file) = Self::hold(folder)?;
        // Another study may have begun there in between.
        Self::belongs(folder, settings)?;
        let failed = |source| unwritten(&path, source);
        let known = known::<M>(&mut file).map_err(failed)?;
        files::write(&folder.join(SETTINGS), settings)?;
        Ok(Self::of(path, file, known))
    }

    /// Begins a journal in a folder, whatever it holds; of an earlier study there its journal and the files
    /// and folders named by `results` are removed.
    ///
    /// # Errors
    /// A folder that another study is writing to, or that cannot be written to.
    pub fn begin_anew(folder: &Path, settings: &str, results: &[&str]) -> Result<Self, StudyError> {
        files::create_folder(folder)?;
        let (path, file) = Self::hold(folder)?;
        if folder.join(SETTINGS).exists() {
            for name in results {
                let path = folder.join(name);
                remove(&path).map_err(|source| unwritten(&path, source))?;
            }
        }
        file.set_len(0).map_err(|source| unwritten(&path, source))?;
        files::write(&folder.join(SETTINGS), settings)?;
        Ok(Self::of(path, file, BTreeMap::new()))
    }

    fn of(path: PathBuf, file: File, entries: BTreeMap<String, Entry<M::Row>>) -> Self {
        Self { state: Mutex::new(State { file: Some((path, file)), entries }) }
    }

    /// Whether a study of these settings may go on or begin in a folder.
    fn belongs(folder: &Path, settings: &str) -> Result<(), StudyError> {
        let folder_path = || folder.to_owned();
        match fs::read_to_string(folder.join(SETTINGS)).ok() {
            Some(before) if before == settings => Ok(()),
            Some(_) => Err(StudyError::OtherSettings { folder: folder_path() }),
            None => {
                // A study that was about to begin has left its journal, with nothing in it.
                let begun = |entry: &DirEntry| {
                    let (name, length) = (entry.file_name(), entry.metadata().map(|of| of.len()));
                    name == FILE && length.is_ok_and(|length| length == 0)
                        || name.to_string_lossy().strip_suffix(".part") == Some(SETTINGS)
                };
                let mut entries =
                    fs::read_dir(folder).map_err(|source| unwritten(folder, source))?.flatten();
                if entries.any(|entry| !begun(&entry)) {
                    return Err(StudyError::Occupied { folder: folder_path() });
                }
                Ok(())
            }
        }
    }

    /// The journal's file, which no other study may write to as long as it is open.
    fn hold(folder: &Path) -> Result<(PathBuf, File), StudyError> {
        let path = folder.join(FILE);
        match hold(&path) {
            Ok(Hold::Ours(file) | Hold::Unknown(file)) => Ok((path, file)),
            Ok(Hold::Others) => Err(FileError::InUse { path: folder.to_owned() }.into()),
            Err(source) => Err(unwritten(&path, source)),
        }
    }

    fn state(&self) -> MutexGuard<'_, State<M::Row>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Names of those members that are done and whose input has not changed since.
    pub(super) fn done(&self, members: &[M]) -> BTreeSet<String> {
        let state = self.state();
        let unchanged = |member: &&M| {
            let entry = state.entries.get(member.name());
            entry.is_some_and(|entry| member.key().is_some_and(|key| key == entry.sha256))
        };
        members.iter().filter(unchanged).map(|member| member.name().to_owned()).collect()
    }

    /// Adds members that are done, each with its key and rows; they are on the disk when this returns.
    pub(super) fn add<'a>(
        &self,
        done: impl IntoIterator<Item = (&'a M, Option<String>, Vec<M::Row>)>,
    ) -> Result<(), StudyError>
    where
        M: 'a,
    {
        let entries: Vec<Entry<M::Row>> = done
            .into_iter()
            .map(|(member, key, rows)| {
                let name = BTreeMap::from([(M::KIND.to_owned(), member.name().to_owned())]);
                Entry { name, sha256: key.unwrap_or_default(), rows }
            })
            .collect();
        let lines = lines(&entries)?;
        let mut state = self.state();
        if let Some((path, file)) = &mut state.file {
            append(file, lines.as_bytes()).map_err(|source| unwritten(path, source))?;
        }
        state.entries.extend(entries.into_iter().filter_map(named::<M>));
        Ok(())
    }

    /// The rows of these members, in their order, as far as they are done.
    pub fn rows(&self, members: &[M]) -> Vec<M::Row> {
        let state = self.state();
        let entries = members.iter().filter_map(|member| state.entries.get(member.name()));
        entries.flat_map(|entry| entry.rows.iter().cloned()).collect()
    }
}

fn unwritten(path: &Path, source: io::Error) -> StudyError {
    StudyError::Journal { path: path.to_owned(), source }
}

/// Removes a file, or a folder with all in it, if it is there.
fn remove(path: &Path) -> io::Result<()> {
    let removed = if path.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    removed.or_else(
        |error| {
            if error.kind() == io::ErrorKind::NotFound { Ok(()) } else { Err(error) }
        },
    )
}

fn lines<'a, R: Serialize + 'a>(
    entries: impl IntoIterator<Item = &'a Entry<R>>,
) -> Result<String, StudyError> {
    let mut lines = String::new();
    for entry in entries {
        lines.push_str(&serde_json::to_string(entry)?);
        lines.push('\n');
    }
    Ok(lines)
}

/// Adds whole lines at the end of a journal, or nothing.
fn append(file: &mut File, lines: &[u8]) -> io::Result<()> {
    let end = file.seek(SeekFrom::End(0))?;
    let written = file.write_all(lines).and_then(|()| file.sync_data());
    if written.is_err() {
        // A part of a line that stays is cut off by the next study.
        file.set_len(end).ok();
    }
    written
}

/// The entries of a journal, of several of one name the last; a last line that was cut off is removed.
fn known<M: Member>(file: &mut File) -> io::Result<BTreeMap<String, Entry<M::Row>>> {
    let mut bytes = Vec::new();
    file.read_to_end(&mut bytes)?;
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |end| end + 1);
    if whole < bytes.len() {
        file.set_len(whole as u64)?;
    }
    let lines = bytes[..whole].split(|byte| *byte == b'\n');
    let entries = lines.filter_map(|line| serde_json::from_slice(line).ok());
    Ok(entries.filter_map(named::<M>).collect())
}

/// An entry by its name, if it is of such a member.
fn named<M: Member>(entry: Entry<M::Row>) -> Option<(String, Entry<M::Row>)> {
    Some((entry.name.get(M::KIND)?.clone(), entry))
}
