//! What is done, line by line, so that an interrupted study goes on where it was.

use super::{Member, StudyError};
use crate::output::files::{self, FileError, Hold, hold};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, DirEntry, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
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
///
/// Rows stay on the disk: of each member that is done, memory has its name and the place of its line.
pub struct Journal<M: Member> {
    state: Mutex<State<M::Row>>,
}

enum State<R> {
    InMemory(BTreeMap<String, Done<R>>),
    OnDisk { path: PathBuf, file: File, lines: BTreeMap<Box<str>, Line> },
}

/// What is kept of an entry beside its member's name.
struct Done<R> {
    sha256: String,
    rows: Vec<R>,
}

/// The line of a member that is done.
#[derive(Debug, Clone, Copy)]
struct Line {
    /// Of the hash of its input: all that is asked is whether it is another.
    input: u64,
    start: u64,
    length: u32,
}

fn digest(sha256: &str) -> u64 {
    let mut hasher = DefaultHasher::new();
    sha256.hash(&mut hasher);
    hasher.finish()
}

impl<M: Member> Journal<M> {
    /// A journal that is forgotten with the study.
    pub fn in_memory() -> Self {
        Self { state: Mutex::new(State::InMemory(BTreeMap::new())) }
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

    fn of(path: PathBuf, file: File, lines: BTreeMap<Box<str>, Line>) -> Self {
        Self { state: Mutex::new(State::OnDisk { path, file, lines }) }
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

    /// The members that are not done, or whose input has changed since.
    pub(super) fn left<'a>(&self, members: &'a [M]) -> Vec<&'a M> {
        let state = self.state();
        let unchanged = |member: &&M| match &*state {
            State::InMemory(entries) => entries
                .get(member.name())
                .is_some_and(|entry| member.key().is_some_and(|key| key == entry.sha256)),
            State::OnDisk { lines, .. } => lines
                .get(member.name())
                .is_some_and(|line| member.key().is_some_and(|key| digest(&key) == line.input)),
        };
        members.iter().filter(|member| !unchanged(member)).collect()
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
        let texts = entries.iter().map(line).collect::<Result<Vec<String>, _>>()?;
        match &mut *self.state() {
            State::InMemory(known) => known.extend(entries.into_iter().filter_map(named::<M>)),
            State::OnDisk { path, file, lines } => {
                let mut start = append(file, texts.concat().as_bytes())
                    .map_err(|source| unwritten(path, source))?;
                for (entry, text) in entries.into_iter().zip(texts) {
                    let length = text.len();
                    lines.extend(placed::<M>(&entry, start, length));
                    start += length as u64;
                }
            }
        }
        Ok(())
    }

    /// The rows of these members, in their order, as far as they are done.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub fn rows(&self, members: &[M]) -> Result<Vec<M::Row>, StudyError> {
        let mut rows = Vec::with_capacity(members.len());
        match &mut *self.state() {
            State::InMemory(entries) => {
                let entries = members.iter().filter_map(|member| entries.get(member.name()));
                rows.extend(entries.flat_map(|entry| entry.rows.iter().cloned()));
            }
            State::OnDisk { path, file, lines } => {
                let mut reader = BufReader::new(file);
                let mut here =
                    reader.stream_position().map_err(|source| unwritten(path, source))?;
                let mut bytes = Vec::new();
                for line in members.iter().filter_map(|member| lines.get(member.name())) {
                    bytes.resize(line.length as usize, 0);
                    // Neighbours in the journal are mostly neighbours in the study.
                    reader
                        .seek_relative(line.start.cast_signed() - here.cast_signed())
                        .and_then(|()| reader.read_exact(&mut bytes))
                        .map_err(|source| unwritten(path, source))?;
                    here = line.start + u64::from(line.length);
                    rows.extend(serde_json::from_slice::<Entry<M::Row>>(&bytes)?.rows);
                }
            }
        }
        Ok(rows)
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

fn line<R: Serialize>(entry: &Entry<R>) -> Result<String, StudyError> {
    Ok(serde_json::to_string(entry)? + "\n")
}

/// Adds whole lines at the end of a journal, or nothing; returns where they begin.
fn append(file: &mut File, lines: &[u8]) -> io::Result<u64> {
    let end = file.seek(SeekFrom::End(0))?;
    let written = file.write_all(lines).and_then(|()| file.sync_data());
    if written.is_err() {
        // A part of a line that stays is cut off by the next study.
        file.set_len(end).ok();
    }
    written.map(|()| end)
}

/// The lines of a journal, of several of one name the last; a last line that was cut off is removed.
fn known<M: Member>(file: &mut File) -> io::Result<BTreeMap<Box<str>, Line>> {
    let mut lines = BTreeMap::new();
    let mut start = 0;
    let mut reader = BufReader::new(&mut *file);
    let mut bytes = Vec::new();
    loop {
        bytes.clear();
        let length = reader.read_until(b'\n', &mut bytes)?;
        if bytes.last() != Some(&b'\n') {
            break;
        }
        let entry = serde_json::from_slice::<Entry<M::Row>>(&bytes).ok();
        lines.extend(entry.and_then(|entry| placed::<M>(&entry, start, length)));
        start += length as u64;
    }
    if start < file.metadata()?.len() {
        file.set_len(start)?;
    }
    Ok(lines)
}

/// An entry by its name, if it is of such a member.
fn named<M: Member>(mut entry: Entry<M::Row>) -> Option<(String, Done<M::Row>)> {
    let done = Done { sha256: entry.sha256, rows: entry.rows };
    Some((entry.name.remove(M::KIND)?, done))
}

/// The place of an entry by its name, if it is of such a member.
fn placed<M: Member>(entry: &Entry<M::Row>, start: u64, length: usize) -> Option<(Box<str>, Line)> {
    let name = entry.name.get(M::KIND)?.as_str().into();
    let length = u32::try_from(length).ok()?;
    Some((name, Line { input: digest(&entry.sha256), start, length }))
}
