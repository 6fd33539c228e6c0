//! The files that a command reads, which it must never replace.

use super::error::FileError;
use same_file::is_same_file;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// Files that are read, by the names under which they were given.
#[derive(Debug, Clone, Default)]
pub struct Reads(BTreeSet<PathBuf>);

impl Reads {
    /// An empty set.
    pub const fn new() -> Self {
        Self(BTreeSet::new())
    }

    /// Adds a file, or all files directly in a folder. Paths that do not exist are ignored.
    pub fn add(&mut self, path: &Path) {
        if let Ok(entries) = fs::read_dir(path) {
            let files = entries.flatten().map(|entry| entry.path());
            self.0.extend(files.filter(|path| path.is_file()));
        } else if path.exists() {
            self.0.insert(path.to_owned());
        }
    }

    /// Checks that a file to be written is not one of these, under any name or link.
    ///
    /// # Errors
    /// [`FileError::Read`].
    pub fn check_file(&self, path: &Path) -> Result<(), FileError> {
        self.check([path.to_owned()])
    }

    /// Checks that none of the files to be written or removed is read.
    pub(super) fn check(&self, files: impl IntoIterator<Item = PathBuf>) -> Result<(), FileError> {
        // Only files of equal length need to be compared.
        let mut by_length: BTreeMap<u64, Vec<&PathBuf>> = BTreeMap::new();
        for read in &self.0 {
            if let Ok(about) = fs::metadata(read) {
                by_length.entry(about.len()).or_default().push(read);
            }
        }
        for file in files {
            let Ok(about) = fs::metadata(&file) else { continue };
            let mut alike = by_length.get(&about.len()).into_iter().flatten();
            let same = |read: &&&PathBuf| is_same_file(read, &file).unwrap_or(false);
            if let Some(read) = alike.find(same) {
                return Err(FileError::Read { path: (*read).clone() });
            }
        }
        Ok(())
    }

    /// Checks that none of these files is in a folder of results.
    ///
    /// # Errors
    /// [`FileError::Read`].
    pub fn check_folder(&self, folder: &Path) -> Result<(), FileError> {
        let Ok(folder) = folder.canonicalize() else { return Ok(()) };
        let inside =
            |read: &&PathBuf| read.canonicalize().is_ok_and(|read| read.starts_with(&folder));
        match self.0.iter().find(inside) {
            Some(read) => Err(FileError::Read { path: read.clone() }),
            None => Ok(()),
        }
    }
}
