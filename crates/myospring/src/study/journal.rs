//! Journal of finished members, one per line, from which an interrupted study resumes.

mod lines;

use super::{Member, StudyError};
use crate::output::files::{self, FileError, Hold, MANIFEST, Manifest, Reads, hold, sha256};
use lines::{Line, Lines};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, DirEntry, File};
use std::io::{self, BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

const FILE: &str = "progress.jsonl";
const SETTINGS: &str = "settings.toml";
/// Text before and after the checksum, the last key of a line.
const CHECK: [&str; 2] = [",\"check\":\"", "\"}\n"];
/// Number of digits of the checksum.
const DIGITS: usize = 16;

/// A finished member.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Entry<R> {
    /// Its name, with [`Member::KIND`] as key.
    #[serde(flatten)]
    name: BTreeMap<String, String>,
    /// Hash of its input; empty if there was none.
    sha256: String,
    rows: Vec<R>,
}

/// Journal of a study: `progress.jsonl` with one line per finished member, and `settings.toml` with
/// everything that the members have in common. A study resumes only if its settings are identical.
/// While it runs, the journal is locked: a second study in the same folder is refused.
///
/// Each line ends with a checksum of the line and the settings. A damaged line, or one of another
/// study, is ignored: its member is computed again ([`Journal::damaged`]).
///
/// Rows stay on the disk, and so do the positions of their lines, in a file without a name in the same folder: memory does not grow with
/// the members that are done.
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
    lines: Lines,
    /// Hash of the settings, the first input of each checksum.
    settings: String,
    damaged: usize,
    manifest: Manifest,
}

/// Members that are to be computed.
pub(super) struct Left<'a, M> {
    pub(super) members: Vec<&'a M>,
    /// How many of them were computed with another input.
    pub(super) changed: usize,
}

/// Content of an entry besides the name of its member.
struct Done<R> {
    sha256: String,
    rows: Vec<R>,
}

impl<M: Member> Journal<M> {
    /// Creates a journal in memory, for studies that are not resumed.
    pub fn in_memory() -> Self {
        Self { state: Mutex::new(State::InMemory(BTreeMap::new())) }
    }

    /// Opens the journal in a folder of results, or begins one in a folder that is empty or does
    /// not exist.
    ///
    /// `settings` is the text of all settings on which the rows depend besides the members' input.
    ///
    /// # Errors
    /// A folder that contains results of other settings or other files, one that another study is
    /// writing to, or one that cannot be written to.
    pub fn open(folder: &Path, settings: &str) -> Result<Self, StudyError> {
        Self::open_protecting(folder, settings, &Reads::new())
    }

    /// Does what [`Journal::open`] does, in a folder whose results must not replace any of the
    /// input files.
    ///
    /// # Errors
    /// Those of [`Journal::open`], and an input file that a result would replace.
    pub fn open_protecting(
        folder: &Path,
        settings: &str,
        reads: &Reads,
    ) -> Result<Self, StudyError> {
        let manifest = Manifest::of(folder);
        reads.check_folder(folder)?;
        manifest.check_reads(reads)?;
        files::create_folder(folder)?;
        Self::belongs(folder, settings)?;
        let (path, file) = Self::hold(&manifest)?;
        // Another study may have begun there in the meantime.
        Self::belongs(folder, settings)?;
        files::clear_parts(folder).map_err(|source| unwritten(folder, source))?;
        let mut journal = Self::on_disk(path, file, settings, manifest)?;
        let read = journal.read::<M>();
        read.map_err(|source| unwritten(&journal.path, source))?;
        journal.manifest.write(SETTINGS, settings)?;
        Ok(Self { state: Mutex::new(State::OnDisk(journal)) })
    }

    /// Begins a journal in a folder and removes the earlier results that the folder's manifest
    /// lists.
    ///
    /// # Errors
    /// A folder that contains files that the manifest does not list, that were changed since, or
    /// that are input files (`reads`); one that another study is writing to, or that cannot be
    /// written to.
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
        let journal = Self::on_disk(path, file, settings, manifest)?;
        Ok(Self { state: Mutex::new(State::OnDisk(journal)) })
    }

    fn on_disk(
        path: PathBuf,
        file: File,
        settings: &str,
        manifest: Manifest,
    ) -> Result<OnDisk, StudyError> {
        let settings = sha256(settings.as_bytes());
        let lines = Lines::new(&manifest.folder()).map_err(|source| unwritten(&path, source))?;
        Ok(OnDisk { path, file, lines, settings, damaged: 0, manifest })
    }

    /// Checks that a study with these settings may resume or begin in a folder.
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
                // An empty journal is that of a study that was interrupted at its start.
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

    /// Opens and locks the journal's file: no other study may write to it while it is open.
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

    /// Returns the manifest of its folder; `None` for a journal in memory.
    pub fn manifest(&self) -> Option<Manifest> {
        match &*self.state() {
            State::InMemory(_) => None,
            State::OnDisk(journal) => Some(journal.manifest.clone()),
        }
    }

    /// Returns the number of lines, or results that belong to a line, that were damaged since they
    /// were written. Their content is lost, and their members are computed again.
    pub fn damaged(&self) -> usize {
        match &*self.state() {
            State::InMemory(_) => 0,
            State::OnDisk(journal) => journal.damaged,
        }
    }

    /// Marks members as not finished, because their results in other files are damaged.
    ///
    /// # Errors
    /// A journal that cannot be read or written.
    pub(super) fn forget<'a>(
        &self,
        members: impl IntoIterator<Item = &'a M>,
    ) -> Result<(), StudyError>
    where
        M: 'a,
    {
        if let State::OnDisk(OnDisk { path, lines, damaged, .. }) = &mut *self.state() {
            for member in members {
                let had = lines.remove(member.name()).map_err(|source| unwritten(path, source))?;
                *damaged += usize::from(had);
            }
        }
        Ok(())
    }

    /// Returns how many of these members were computed with another input; they are computed again.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub fn changed(&self, members: &[M]) -> Result<usize, StudyError> {
        Ok(self.left(members)?.changed)
    }

    /// Returns the members that are not finished, or whose input has changed since.
    ///
    /// # Errors
    /// A journal that cannot be read.
    pub(super) fn left<'a>(&self, members: &'a [M]) -> Result<Left<'a, M>, StudyError> {
        let mut left = Left { members: Vec::new(), changed: 0 };
        match &mut *self.state() {
            State::InMemory(entries) => {
                let unchanged = |member: &&M| {
                    entries
                        .get(member.name())
                        .is_some_and(|entry| member.key().is_some_and(|key| key == entry.sha256))
                };
                left.members.extend(members.iter().filter(|member| !unchanged(member)));
            }
            State::OnDisk(OnDisk { path, lines, .. }) => {
                for member in members {
                    let line =
                        lines.get(member.name()).map_err(|source| unwritten(path, source))?;
                    let unchanged =
                        line.is_some_and(|line| member.key().is_some_and(|key| line.is_of(&key)));
                    if !unchanged {
                        left.members.push(member);
                        left.changed += usize::from(line.is_some());
                    }
                }
            }
        }
        Ok(left)
    }

    /// Adds finished members, each with its key and rows; they are on disk when this returns.
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
                    if let Some(name) = entry.name.get(M::KIND) {
                        let line = Line::new(start, text.len(), &entry.sha256);
                        lines.insert(name, line).map_err(|source| unwritten(path, source))?;
                    }
                    start += text.len() as u64;
                }
            }
        }
        Ok(())
    }

    /// Returns the rows of those of these members that are finished, in order.
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
                for member in members {
                    let line =
                        lines.get(member.name()).map_err(|source| unwritten(path, source))?;
                    let Some(Line { start, length, .. }) = line else { continue };
                    bytes.resize(length as usize, 0);
                    // Members that follow one another in the study mostly do so in the journal.
                    reader
                        .seek_relative(start.cast_signed() - here.cast_signed())
                        .and_then(|()| reader.read_exact(&mut bytes))
                        .map_err(|source| unwritten(path, source))?;
                    here = start + length;
                    let entry = serde_json::from_slice::<Entry<M::Row>>(&bytes)?;
                    if entry.name.get(M::KIND).is_none_or(|name| name != member.name()) {
                        let (path, member) = (path.clone(), member.name().to_owned());
                        return Err(StudyError::Changed { path, member });
                    }
                    rows.extend(entry.rows);
                }
            }
        }
        Ok(rows)
    }
}

fn unwritten(path: &Path, source: io::Error) -> StudyError {
    StudyError::Journal { path: path.to_owned(), source }
}

/// Returns an entry as a line with its checksum.
fn line<R: Serialize>(entry: &Entry<R>, settings: &str) -> Result<String, StudyError> {
    let mut text = serde_json::to_string(entry)?;
    let check = checksum(&text, settings);
    text.truncate(text.len() - 1);
    let [before, after] = CHECK;
    Ok(text + before + &check + after)
}

/// Returns the checksum of an entry's text in a study with these settings.
fn checksum(text: &str, settings: &str) -> String {
    let mut all = sha256(format!("{settings}{text}").as_bytes());
    all.truncate(DIGITS);
    all
}

/// Returns the text of an entry if its checksum is right.
fn checked(line: &[u8], settings: &str) -> Option<String> {
    let [before, after] = CHECK;
    let line = str::from_utf8(line).ok()?.strip_suffix(after)?;
    let (rest, check) = line.split_at_checked(line.len().checked_sub(DIGITS)?)?;
    let text = rest.strip_suffix(before)?.to_owned() + "}";
    (checksum(&text, settings) == check).then_some(text)
}

/// Appends whole lines to a journal, or nothing if that fails; returns their position.
fn append(file: &mut File, lines: &[u8]) -> io::Result<u64> {
    let end = file.seek(SeekFrom::End(0))?;
    let written = file.write_all(lines).and_then(|()| file.sync_data());
    if written.is_err() {
        // If a partial line remains, the next study removes it.
        file.set_len(end).ok();
    }
    written.map(|()| end)
}

impl OnDisk {
    /// Reads the lines and removes an incomplete last line. If several lines have one name, the
    /// last counts.
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
            let named = entry.and_then(named::<M>);
            match named {
                Some((name, done)) => {
                    self.lines.insert(&name, Line::new(start, length, &done.sha256))?;
                }
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

/// Returns the name and content of an entry if it belongs to a member of this kind.
fn named<M: Member>(mut entry: Entry<M::Row>) -> Option<(String, Done<M::Row>)> {
    let done = Done { sha256: entry.sha256, rows: entry.rows };
    Some((entry.name.remove(M::KIND)?, done))
}
