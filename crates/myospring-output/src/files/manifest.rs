//! The list of the files that commands wrote to a folder of results; only these files may be
//! replaced.

use super::error::FileError;
use super::names::MANIFEST;
use super::reads::Reads;
use super::write::{create_folder, write, write_and};
use sha2::{Digest, Sha256};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Read as _, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};

const TITLE: &str = "# myospring wrote these files; `sha256sum -c myospring.sha256` checks them. What is not in this list, \
                     or was changed since, is never replaced or removed.\n";
/// Beginning of the first line.
const MARK: &str = "# myospring wrote these files";
/// Marks a file that changes while a study runs.
const CHANGING: &str = "# changes while a study goes on: ";
/// Files that operating systems put into folders.
const OF_THE_SYSTEM: [&str; 3] = ["Thumbs.db", "desktop.ini", "Icon\r"];
/// Largest number of files that an error names.
const NAMED: usize = 3;

/// The manifest of a folder of results.
///
/// A file is listed with its hash before it gets its name, so that files of an interrupted command
/// are known, too. Only a listed file whose content has a listed hash is replaced or removed.
#[derive(Debug, Clone)]
pub struct Manifest {
    folder: PathBuf,
    /// The subfolder that this refers to, ending in `/`; empty for the whole folder.
    within: String,
    writing: Arc<Mutex<()>>,
}

/// The content of a manifest.
#[derive(Debug, Default)]
struct Listed {
    /// Hashes that each file has or will have, the newest last.
    hashes: BTreeMap<String, Vec<String>>,
    changing: BTreeSet<String>,
}

impl Manifest {
    /// The manifest of a folder, which need not exist.
    pub fn of(folder: &Path) -> Self {
        Self { folder: folder.to_owned(), within: String::new(), writing: Arc::default() }
    }

    /// The same list, limited to one subfolder.
    #[must_use]
    pub fn part(&self, name: &str) -> Self {
        Self { within: format!("{}{name}/", self.within), ..self.clone() }
    }

    /// The folder of the results, or the subfolder.
    pub fn folder(&self) -> PathBuf {
        match self.within.strip_suffix('/') {
            Some(within) => self.folder.join(within),
            None => self.folder.clone(),
        }
    }

    /// Whether the folder has a manifest.
    pub fn is_there(&self) -> bool {
        let path = self.folder.join(MANIFEST);
        let mut start = [0; MARK.len()];
        let read = File::open(&path).and_then(|mut file| file.read_exact(&mut start));
        is_file(&path) && read.is_ok() && start == MARK.as_bytes()
    }

    /// Begins the list if there is none.
    ///
    /// # Errors
    /// A folder that cannot be written to, or a file of that name that is not a manifest.
    pub fn begin(&self) -> Result<(), FileError> {
        let path = self.folder.join(MANIFEST);
        if self.is_there() {
            return Ok(());
        }
        if fs::symlink_metadata(&path).is_ok() {
            return Err(FileError::Foreign { path });
        }
        create_folder(&self.folder)?;
        write(&path, TITLE)
    }

    /// Checks that replacing the content of the folder would not lose a file: one that the manifest
    /// does not list, one that was changed since, or one that is read. Hidden files and other
    /// results in the folder are ignored; they stay.
    ///
    /// # Errors
    /// [`FileError::NoManifest`], [`FileError::NotOurs`] or [`FileError::Read`]; a folder that cannot be read.
    pub fn check_replaceable(&self, reads: &Reads) -> Result<(), FileError> {
        let folder = self.folder();
        reads.check_folder(&folder)?;
        let failed = |source| FileError::Folder { path: folder.clone(), source };
        let listed = self.listed().map_err(failed)?;
        let mut foreign = Vec::new();
        Self::foreign(listed.as_ref(), &folder, &self.within, &mut foreign).map_err(failed)?;
        if !foreign.is_empty() {
            let more = if foreign.len() > NAMED { ", ..." } else { "" };
            foreign.truncate(NAMED);
            let names = foreign.join(", ") + more;
            return Err(match listed {
                Some(_) => FileError::NotOurs { folder, names },
                None => FileError::NoManifest { folder, names },
            });
        }
        self.check_reads(reads)
    }

    /// Checks that no file that is read, under any name or link, is one that may be replaced.
    ///
    /// # Errors
    /// [`FileError::Read`].
    pub fn check_reads(&self, reads: &Reads) -> Result<(), FileError> {
        let listed = self.listed().ok().flatten().unwrap_or_default();
        reads.check(self.names(&listed).map(|name| self.folder.join(name)))
    }

    /// Writes a file by its name in the folder; an existing file is replaced if it is listed and
    /// unchanged.
    ///
    /// # Errors
    /// [`FileError::Foreign`] for any other existing file; errors of [`write()`](super::write()).
    pub fn write(&self, name: &str, contents: impl AsRef<[u8]>) -> Result<(), FileError> {
        let contents = contents.as_ref();
        let path = self.room_for(name)?;
        self.append(&line(&self.full(name), &sha256(contents)))?;
        write(&path, contents)
    }

    /// Like [`Manifest::write`], with content written by `fill`.
    ///
    /// # Errors
    /// Those of [`Manifest::write`] and of `fill`.
    pub fn write_with<E: From<FileError>>(
        &self,
        name: &str,
        fill: impl FnOnce(&mut BufWriter<&File>) -> Result<(), E>,
    ) -> Result<(), E> {
        let path = self.room_for(name)?;
        write_and(&path, fill, |written| {
            let failed = |source| FileError::Write { path: path.clone(), source };
            let hash = hash_of(written).map_err(failed)?;
            self.append(&line(&self.full(name), &hash))
        })
    }

    /// Lists a file that keeps changing, and returns its path; it may be replaced whatever its
    /// content.
    ///
    /// # Errors
    /// [`FileError::Foreign`] if a file of this name exists that is not listed.
    pub fn changing(&self, name: &str) -> Result<PathBuf, FileError> {
        let path = self.room_for(name)?;
        let full = self.full(name);
        let listed = self.listed().ok().flatten().unwrap_or_default();
        if !listed.changing.contains(&full) {
            self.append(&format!("{CHANGING}{full}\n"))?;
        }
        Ok(path)
    }

    /// Lists files that are about to be moved here, each by its name with its current path.
    ///
    /// # Errors
    /// A file that cannot be read, a manifest that cannot be written.
    pub fn announce<'a>(
        &self,
        names: impl IntoIterator<Item = &'a String>,
        from: &Path,
    ) -> Result<(), FileError> {
        let mut lines = String::new();
        for name in names {
            let path = from.join(name);
            let hash = hash_of(&path).map_err(|source| FileError::Write { path, source })?;
            lines.push_str(&line(&self.full(name), &hash));
        }
        self.append(&lines)
    }

    /// Removes every listed and unchanged file except those named in `but`, and the folders that
    /// are empty then.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn clear(&self, but: &[&str]) -> io::Result<()> {
        let Some(listed) = self.listed()? else { return Ok(()) };
        let mut folders = BTreeSet::new();
        for name in self.names(&listed) {
            let stays = but.iter().any(|but| self.full(but) == *name);
            let path = self.folder.join(name);
            if !stays && is_file(&path) && listed.knows(name, &path)? {
                fs::remove_file(&path)?;
                let above = Path::new(name).ancestors().skip(1);
                folders.extend(above.filter(|it| !it.as_os_str().is_empty()).map(Path::to_owned));
            }
        }
        for folder in folders.iter().rev() {
            // A folder with other content stays.
            fs::remove_dir(self.folder.join(folder)).ok();
        }
        Ok(())
    }

    /// Rewrites the list: each existing file once, with its current hash.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn settle(&self) -> Result<(), FileError> {
        let path = self.folder.join(MANIFEST);
        let failed = |source| FileError::Write { path: path.clone(), source };
        let Some(listed) = self.listed().map_err(failed)? else { return Ok(()) };
        let mut text = TITLE.to_owned();
        for (name, hashes) in &listed.hashes {
            let file = self.folder.join(name);
            match hashes.as_slice() {
                _ if !is_file(&file) => {}
                [one] => text.push_str(&line(name, one)),
                several => {
                    let now = hash_of(&file).map_err(failed)?;
                    let known = several.iter().find(|hash| **hash == now).or(several.last());
                    text.extend(known.map(|hash| line(name, hash)));
                }
            }
        }
        for name in listed.changing.iter().filter(|name| self.folder.join(name).exists()) {
            text.push_str(CHANGING);
            text.push_str(name);
            text.push('\n');
        }
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        write(&path, text)
    }

    /// Checks that a file is as it was written: not changed, missing, or from elsewhere. A file
    /// that neither exists nor is listed passes.
    ///
    /// # Errors
    /// [`FileError::Changed`].
    pub fn check_unchanged(&self, name: &str) -> Result<(), FileError> {
        let full = self.full(name);
        let path = self.folder.join(&full);
        let is_listed = |listed: &Listed| listed.hashes.contains_key(&full);
        let same = match self.listed() {
            Ok(Some(listed)) if path.exists() => listed.knows(&full, &path).unwrap_or(false),
            Ok(Some(listed)) => !is_listed(&listed),
            _ => false,
        };
        if same { Ok(()) } else { Err(FileError::Changed { path }) }
    }

    fn full(&self, name: &str) -> String {
        format!("{}{name}", self.within)
    }

    /// The listed names of this part.
    fn names<'a>(&'a self, listed: &'a Listed) -> impl Iterator<Item = &'a String> {
        let all = listed.hashes.keys().chain(&listed.changing);
        all.filter(|name| name.starts_with(&self.within))
    }

    /// The path of a file that may be written; creates the folders above it.
    fn room_for(&self, name: &str) -> Result<PathBuf, FileError> {
        let full = self.full(name);
        let path = self.folder.join(&full);
        let failed = |source| FileError::Write { path: path.clone(), source };
        match fs::symlink_metadata(&path) {
            Ok(_) => {
                let listed = self.listed().map_err(failed)?.unwrap_or_default();
                if !is_file(&path) || !listed.knows(&full, &path).map_err(failed)? {
                    return Err(FileError::Foreign { path });
                }
            }
            Err(_) => path.parent().map_or(Ok(()), create_folder)?,
        }
        Ok(path)
    }

    /// The files of a folder that are not listed or were changed, at most one more than errors
    /// name.
    fn foreign(
        listed: Option<&Listed>,
        folder: &Path,
        within: &str,
        found: &mut Vec<String>,
    ) -> io::Result<()> {
        let entries = match fs::read_dir(folder) {
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            entries => entries?.collect::<io::Result<Vec<_>>>()?,
        };
        let mut entries: Vec<_> =
            entries.into_iter().map(|entry| (entry.file_name(), entry.path())).collect();
        entries.sort();
        for (name, path) in entries {
            let name = name.to_string_lossy();
            let of_nobody = name.starts_with('.') || OF_THE_SYSTEM.contains(&&*name);
            let full = format!("{within}{name}");
            let is_folder = fs::symlink_metadata(&path)?.is_dir();
            if found.len() > NAMED {
                break;
            }
            if of_nobody || name == MANIFEST && listed.is_some() {
                continue;
            }
            if is_folder {
                // Results of another command have a manifest of their own.
                if !Self::of(&path).is_there() {
                    Self::foreign(listed, &path, &format!("{full}/"), found)?;
                }
            } else if !(is_file(&path)
                && listed.is_some_and(|listed| listed.knows(&full, &path).unwrap_or(false)))
            {
                found.push(full);
            }
        }
        Ok(())
    }

    fn append(&self, lines: &str) -> Result<(), FileError> {
        self.begin()?;
        let _writing = self.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let path = self.folder.join(MANIFEST);
        let append = || {
            let mut file = OpenOptions::new().append(true).open(&path)?;
            file.write_all(lines.as_bytes())?;
            file.sync_data()
        };
        append().map_err(|source| FileError::Write { path: path.clone(), source })
    }

    /// The content of the manifest; `None` if there is none.
    fn listed(&self) -> io::Result<Option<Listed>> {
        let path = self.folder.join(MANIFEST);
        let text = match fs::read(&path) {
            Ok(bytes) if is_file(&path) => String::from_utf8_lossy(&bytes).into_owned(),
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => return Ok(None),
        };
        // The end of the title may differ between versions.
        let Some((_, lines)) = text.split_once('\n').filter(|(title, _)| title.starts_with(MARK))
        else {
            return Ok(None);
        };
        let mut listed = Listed::default();
        // A damaged line lists nothing, so its file counts as not ours.
        for line in lines.split_inclusive('\n').filter_map(|line| line.strip_suffix('\n')) {
            if let Some(name) = line.strip_prefix(CHANGING) {
                listed.changing.extend(Some(name.to_owned()).filter(|name| is_inside(name)));
            } else if let Some((name, hash)) = parsed(line) {
                let hashes = listed.hashes.entry(name).or_default();
                hashes.retain(|other| *other != hash);
                hashes.push(hash);
            }
        }
        Ok(Some(listed))
    }
}

impl Listed {
    /// Whether a file's content was written under this name.
    fn knows(&self, name: &str, path: &Path) -> io::Result<bool> {
        if self.changing.contains(name) {
            return Ok(true);
        }
        let Some(hashes) = self.hashes.get(name) else { return Ok(false) };
        Ok(hashes.contains(&hash_of(path)?))
    }
}

/// Whether this is a regular file, not a link or device.
fn is_file(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|about| about.is_file())
}

/// Whether a name stays within the folder.
fn is_inside(name: &str) -> bool {
    !name.is_empty() && Path::new(name).components().all(|it| matches!(it, Component::Normal(_)))
}

/// A line in the format of `sha256sum`, which escapes line breaks in names.
fn line(name: &str, hash: &str) -> String {
    if name.contains(['\n', '\\', '\r']) {
        let name = name.replace('\\', r"\\").replace('\n', r"\n").replace('\r', r"\r");
        format!("\\{hash}  {name}\n")
    } else {
        format!("{hash}  {name}\n")
    }
}

/// Name and hash of a line.
fn parsed(line: &str) -> Option<(String, String)> {
    let (line, marked) = line.strip_prefix('\\').map_or((line, false), |line| (line, true));
    let (hash, name) = line.split_once("  ")?;
    let is_hash = hash.len() == 64 && hash.bytes().all(|byte| byte.is_ascii_hexdigit());
    let mut plain = String::with_capacity(name.len());
    let mut letters = name.chars();
    while let Some(letter) = letters.next() {
        match letter {
            '\\' if marked => plain.push(match letters.next()? {
                'n' => '\n',
                'r' => '\r',
                other => other,
            }),
            letter => plain.push(letter),
        }
    }
    (is_hash && is_inside(&plain)).then(|| (plain, hash.to_ascii_lowercase()))
}

fn hash_of(path: &Path) -> io::Result<String> {
    let mut hasher = Sha256::new();
    io::copy(&mut File::open(path)?, &mut hasher)?;
    Ok(in_hexadecimal(&hasher.finalize()))
}

/// The SHA-256 of some bytes in hexadecimal digits.
///
/// # Example
/// ```
/// let hash = myospring::study::sha256(b"abc");
/// assert!(hash.starts_with("ba7816bf") && hash.len() == 64); // FIPS 180-2, appendix B.1
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    in_hexadecimal(&Sha256::digest(bytes))
}

fn in_hexadecimal(hash: &[u8]) -> String {
    hash.iter().fold(String::with_capacity(64), |mut text, byte| {
        // Writing to a string does not fail.
        write!(text, "{byte:02x}").ok();
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_is_listed_as_sha256sum_does_and_none_leads_out_of_the_folder() {
        let place = tempfile::tempdir().unwrap();
        let (folder, outside) = (place.path().join("res"), place.path().join("mine.csv"));
        let manifest = Manifest::of(&folder);
        let names = if cfg!(unix) {
            ["a b.csv", "x\ny.csv", "c\\d.csv"]
        } else {
            ["a b.csv", "x.csv", "c.csv"]
        };
        for name in names {
            manifest.write(name, "abc").unwrap();
            manifest.part("inner").write(name, "abc").unwrap();
        }
        // FIPS 180-2, appendix B.1.
        let hash = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        let path = folder.join(MANIFEST);
        let mut text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(&format!("\n{hash}  a b.csv\n")), "{text}");
        assert!(!cfg!(unix) || text.contains(&format!("\n\\{hash}  x\\ny.csv\n")), "{text}");
        fs::write(&outside, "abc").unwrap();
        text.push_str(&line("../mine.csv", hash));
        fs::write(&path, text).unwrap();
        manifest.check_replaceable(&Reads::new()).unwrap();
        manifest.clear(&[]).unwrap();
        assert!(outside.exists());
        let left = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().file_name());
        assert_eq!(left.collect::<Vec<_>>(), [MANIFEST]);
    }

    #[test]
    fn a_file_that_was_changed_is_neither_written_nor_removed() {
        let place = tempfile::tempdir().unwrap();
        let manifest = Manifest::of(place.path());
        let at = |name: &str| place.path().join(name);
        manifest.write("a.csv", "old").unwrap();
        manifest.write("a.csv", "new").unwrap();
        manifest.check_unchanged("a.csv").unwrap();
        manifest.settle().unwrap();
        assert_eq!(fs::read_to_string(at(MANIFEST)).unwrap().lines().count(), 2);
        fs::write(at("a.csv"), "mine").unwrap();
        assert!(matches!(manifest.write("a.csv", "x"), Err(FileError::Foreign { .. })));
        assert!(matches!(manifest.check_unchanged("a.csv"), Err(FileError::Changed { .. })));
        let refused = manifest.check_replaceable(&Reads::new()).unwrap_err().to_string();
        assert!(refused.contains("a.csv"), "{refused}");
        manifest.clear(&[]).unwrap();
        assert_eq!(fs::read_to_string(at("a.csv")).unwrap(), "mine");
        // Old content again is ours again.
        fs::write(at("a.csv"), "new").unwrap();
        let mut reads = Reads::new();
        reads.add(&at("a.csv"));
        assert!(matches!(manifest.check_reads(&reads), Err(FileError::Read { .. })));
        manifest.clear(&["a.csv"]).unwrap();
        assert!(at("a.csv").exists());
    }
}
