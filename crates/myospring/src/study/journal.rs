//! What is done, line by line, so that an interrupted study goes on where it was.

use super::{Member, StudyError};
use crate::output::files::{self, FileError, Hold, MANIFEST, Manifest, Reads, hold, sha256};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, DirEntry, File};
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

const FILE: &str = "progress.jsonl";
const SETTINGS: &str = "settings.toml";
/// Before and after the checksum of a line, its last key.
const CHECK: [&str; 2] = [",\"check\":\"", "\"}\n"];
/// Digits of the checksum.
const DIGITS: usize = 16;

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
/// Each line ends with a checksum over itself and the settings. A line that was damaged, or that is of another study,
/// counts for nothing: its member is worked on anew ([`Journal::damaged`]).
///
/// Rows stay on the disk: of each member that is done, memory has its name and the place of its line.
pub struct Journal<M: Member> {
    state: Mutex<State<M::Row>>,
}

enum State<R> {
    InMemory(BTreeMap<String, Done<R>>),
    OnDisk(OnDisk),
}

struct OnDisk {
    path: PathBuf,
    file: File,
    lines: BTreeMap<Box<str>, Line>,
    /// The hash of the settings, with which each checksum begins.
    settings: String,
    damaged: usize,
    manifest: Manifest,
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
        Self::open_beside(folder, settings, &Reads::new())
    }

    /// As [`Journal::open`], in a folder whose results must not replace any of the files that are read.
    ///
    /// # Errors
    /// Those of [`Journal::open`], and a file that is both.
    pub fn open_beside(folder: &Path, settings: &str, reads: &Reads) -> Result<Self, StudyError> {
        let manifest = Manifest::of(folder);
        reads.check_folder(folder)?;
        manifest.check_reads(reads)?;
        files::create_folder(folder)?;
        Self::belongs(folder, settings)?;
        let (path, file) = Self::hold(&manifest)?;
        // Another study may have begun there in between.
        Self::belongs(folder, settings)?;
        files::clear_parts(folder).map_err(|source| unwritten(folder, source))?;
        let mut journal = Self::on_disk(path, file, settings, manifest);
        let read = journal.read::<M>();
        read.map_err(|source| unwritten(&journal.path, source))?;
        journal.manifest.write(SETTINGS, settings)?;
        Ok(Self { state: Mutex::new(State::OnDisk(journal)) })
    }

    /// Begins a journal in a folder. What its manifest lists of earlier results is removed.
    ///
    /// # Errors
    /// A folder that holds files which the manifest does not list, which were changed since, or which are read, as
    /// `reads` has them; one that another study is writing to, or that cannot be written to.
    pub fn begin_anew(folder: &Path, settings: &str, reads: &Reads) -> Result<Self, StudyError> {
        let manifest = Manifest::of(folder);
        if manifest.is_there() && folder.join(FILE).exists() {
            Self::hold(&manifest)?;
        }
        manifest.check_replaceable(reads)?;
        files::create_folder(folder)?;
        let (path, file) = Self::hold(&manifest)?;
        let cleared = manifest.clear(&[FILE]).and_then(|()| files::clear_parts(folder));
        cleared.and_then(|()| file.set_len(0)).map_err(|source| unwritten(&path, source))?;
        manifest.settle()?;
        manifest.write(SETTINGS, settings)?;
        let journal = Self::on_disk(path, file, settings, manifest);
        Ok(Self { state: Mutex::new(State::OnDisk(journal)) })
    }

    fn on_disk(path: PathBuf, file: File, settings: &str, manifest: Manifest) -> OnDisk {
        let settings = sha256(settings.as_bytes());
        OnDisk { path, file, lines: BTreeMap::new(), settings, damaged: 0, manifest }
    }

    /// Whether a study of these settings may go on or begin in a folder.
    fn belongs(folder: &Path, settings: &str) -> Result<(), StudyError> {
        let folder_path = || folder.to_owned();
        match fs::read_to_string(folder.join(SETTINGS)).ok() {
            Some(_) if !Manifest::of(folder).is_there() => {
                let names = format!("{FILE}, {SETTINGS}");
                Err(FileError::NoManifest { folder: folder_path(), names }.into())
            }
            Some(before) if before == settings => Ok(()),
            Some(_) => Err(StudyError::OtherSettings { folder: folder_path() }),
            None => {
                // A study that was about to begin has left its journal, with nothing in it.
                let begun = |entry: &DirEntry| {
                    let (name, length) = (entry.file_name(), entry.metadata().map(|of| of.len()));
                    name == MANIFEST
                        || name == FILE && length.is_ok_and(|length| length == 0)
                        || name.to_string_lossy().starts_with('.')
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
    fn hold(manifest: &Manifest) -> Result<(PathBuf, File), StudyError> {
        let path = manifest.changing(FILE)?;
        match hold(&path) {
            Ok(Hold::Ours(file) | Hold::Unknown(file)) => Ok((path, file)),
            Ok(Hold::Others) => Err(FileError::InUse { path: manifest.folder() }.into()),
            Err(source) => Err(unwritten(&path, source)),
        }
    }

    fn state(&self) -> MutexGuard<'_, State<M::Row>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The list of the files in its folder; `None` of one in memory.
    pub fn manifest(&self) -> Option<Manifest> {
        match &*self.state() {
            State::InMemory(_) => None,
            State::OnDisk(journal) => Some(journal.manifest.clone()),
        }
    }

    /// How many lines, or results that belong to a line, were damaged since they were written. What they said is lost,
    /// and their members are worked on anew.
    pub fn damaged(&self) -> usize {
        match &*self.state() {
            State::InMemory(_) => 0,
            State::OnDisk(journal) => journal.damaged,
        }
    }

    /// Takes members for not done whose results elsewhere are damaged.
    pub(super) fn forget<'a>(&self, members: impl IntoIterator<Item = &'a M>)
    where
        M: 'a,
    {
        if let State::OnDisk(journal) = &mut *self.state() {
            for member in members {
                journal.damaged += usize::from(journal.lines.remove(member.name()).is_some());
            }
        }
    }

    /// The members that are not done, or whose input has changed since.
    pub(super) fn left<'a>(&self, members: &'a [M]) -> Vec<&'a M> {
        let state = self.state();
        let unchanged = |member: &&M| match &*state {
            State::InMemory(entries) => entries
                .get(member.name())
                .is_some_and(|entry| member.key().is_some_and(|key| key == entry.sha256)),
            State::OnDisk(OnDisk { lines, .. }) => lines
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
        match &mut *self.state() {
            State::InMemory(known) => known.extend(entries.into_iter().filter_map(named::<M>)),
            State::OnDisk(OnDisk { path, file, lines, settings, .. }) => {
                let texts = entries.iter().map(|entry| line(entry, settings));
                let texts = texts.collect::<Result<Vec<String>, _>>()?;
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
            State::OnDisk(OnDisk { path, file, lines, .. }) => {
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

/// An entry as a line with its checksum.
fn line<R: Serialize>(entry: &Entry<R>, settings: &str) -> Result<String, StudyError> {
    let mut text = serde_json::to_string(entry)?;
    let check = checksum(&text, settings);
    text.truncate(text.len() - 1);
    let [before, after] = CHECK;
    Ok(text + before + &check + after)
}

/// The checksum of an entry's text in a study of these settings.
fn checksum(text: &str, settings: &str) -> String {
    let mut all = sha256(format!("{settings}{text}").as_bytes());
    all.truncate(DIGITS);
    all
}

/// The text of an entry, where its checksum is right.
fn checked(line: &[u8], settings: &str) -> Option<String> {
    let [before, after] = CHECK;
    let line = str::from_utf8(line).ok()?.strip_suffix(after)?;
    let (rest, check) = line.split_at_checked(line.len().checked_sub(DIGITS)?)?;
    let text = rest.strip_suffix(before)?.to_owned() + "}";
    (checksum(&text, settings) == check).then_some(text)
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

impl OnDisk {
    /// Reads the lines, of several of one name the last; a last line that was cut off is removed.
    fn read<M: Member>(&mut self) -> io::Result<()> {
        let mut start = 0;
        let mut reader = BufReader::new(&self.file);
        let mut bytes = Vec::new();
        loop {
            bytes.clear();
            let length = reader.read_until(b'\n', &mut bytes)?;
            if bytes.last() != Some(&b'\n') {
                break;
            }
            let text = checked(&bytes, &self.settings);
            let entry = text.and_then(|text| serde_json::from_str::<Entry<M::Row>>(&text).ok());
            match entry.and_then(|entry| placed::<M>(&entry, start, length)) {
                Some((name, line)) => drop(self.lines.insert(name, line)),
                None => self.damaged += 1,
            }
            start += length as u64;
        }
        if start < self.file.metadata()?.len() {
            self.file.set_len(start)?;
        }
        Ok(())
    }
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
