//! What is done, line by line, so that an interrupted study goes on where it was.

use super::{Member, StudyError};
use crate::output::files;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
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
/// that they have in common. A study goes on only with the same settings to the letter.
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
    /// A folder that holds results of other settings, or anything else, or cannot be written to.
    pub fn open(folder: &Path, settings: &str) -> Result<Self, StudyError> {
        files::create_folder(folder)?;
        let before = fs::read_to_string(folder.join(SETTINGS)).ok();
        if before.as_deref() == Some(settings) {
            let path = folder.join(FILE);
            let entries = entries::<M>(&path).map_err(|source| unwritten(&path, source))?;
            return Self::write(folder, settings, entries);
        }
        let occupied =
            fs::read_dir(folder).map_err(|source| unwritten(folder, source))?.next().is_some();
        let folder_path = folder.to_owned();
        match (before, occupied) {
            (Some(_), _) => Err(StudyError::OtherSettings { folder: folder_path }),
            (None, true) => Err(StudyError::Occupied { folder: folder_path }),
            (None, false) => Self::write(folder, settings, BTreeMap::new()),
        }
    }

    /// Begins a journal in a folder, whatever it holds; of an earlier study there its journal and the files
    /// and folders named by `results` are removed.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn begin_anew(folder: &Path, settings: &str, results: &[&str]) -> Result<Self, StudyError> {
        files::create_folder(folder)?;
        if folder.join(SETTINGS).exists() {
            for name in results {
                let path = folder.join(name);
                remove(&path).map_err(|source| unwritten(&path, source))?;
            }
        }
        Self::write(folder, settings, BTreeMap::new())
    }

    /// Writes what is known, which also drops a line that was cut off, and stays open for more.
    fn write(
        folder: &Path,
        settings: &str,
        entries: BTreeMap<String, Entry<M::Row>>,
    ) -> Result<Self, StudyError> {
        files::write(&folder.join(SETTINGS), settings)?;
        let path = folder.join(FILE);
        files::write(&path, lines(entries.values())?)?;
        let file = OpenOptions::new().append(true).open(&path);
        let file = file.map_err(|source| unwritten(&path, source))?;
        Ok(Self { state: Mutex::new(State { file: Some((path, file)), entries }) })
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
            let written = file.write_all(lines.as_bytes()).and_then(|()| file.sync_data());
            written.map_err(|source| unwritten(path, source))?;
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

/// The entries of a journal; the last line may have been cut off.
fn entries<M: Member>(path: &Path) -> io::Result<BTreeMap<String, Entry<M::Row>>> {
    let text = match fs::read_to_string(path) {
        Err(error) if error.kind() == io::ErrorKind::NotFound => String::new(),
        text => text?,
    };
    let entries = text.lines().filter_map(|line| serde_json::from_str(line).ok());
    Ok(entries.filter_map(named::<M>).collect())
}

/// An entry by its name, if it is of such a member.
fn named<M: Member>(entry: Entry<M::Row>) -> Option<(String, Entry<M::Row>)> {
    Some((entry.name.get(M::KIND)?.clone(), entry))
}
