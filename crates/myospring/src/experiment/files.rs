//! The files that an experiment reads, which its results never replace.

use super::error::ExperimentError;
use crate::measured::{self, ReadError, Table, TableOptions};
use crate::output::files::{self, Reads};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::{Arc, Mutex, PoisonError};
use std::{fs, io};

/// Reads files and remembers which, so that results never replace what was read. Clones share what they remember.
#[derive(Debug, Clone, Default)]
pub struct Files {
    reads: Arc<Mutex<Reads>>,
    /// Contents by name, for files that are not on the disk.
    held: Arc<BTreeMap<String, Vec<u8>>>,
}

impl Files {
    /// Files of which some are not on the disk; `held` has their contents, by the names that
    /// settings use.
    pub fn holding(held: BTreeMap<String, Vec<u8>>) -> Self {
        Self { held: Arc::new(held), ..Self::default() }
    }

    /// Contents of the files that are not on the disk, by name.
    pub fn held(&self) -> Arc<BTreeMap<String, Vec<u8>>> {
        Arc::clone(&self.held)
    }

    /// Whether a path is that of a folder; a file that is held is none.
    ///
    /// # Errors
    /// Nothing is there.
    pub fn is_folder(&self, path: &Path) -> io::Result<bool> {
        if path.to_str().is_some_and(|name| self.held.contains_key(name)) {
            return Ok(false);
        }
        fs::metadata(path).map(|about| about.is_dir())
    }

    /// Notes a file that is read, or a folder whose files are.
    pub fn note(&self, path: &Path) {
        self.reads.lock().unwrap_or_else(PoisonError::into_inner).add(path);
    }

    /// All that were noted.
    pub fn reads(&self) -> Reads {
        self.reads.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// Reads a file, or what a pipe gives.
    ///
    /// # Errors
    /// As [`files::read`].
    pub fn bytes(&self, path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
        let path = path.as_ref();
        self.note(path);
        match path.to_str().and_then(|name| self.held.get(name)) {
            Some(bytes) => Ok(bytes.clone()),
            None => files::read(path),
        }
    }

    /// Reads the text of a file that a person wrote, in any encoding of an editor.
    ///
    /// # Errors
    /// A file that cannot be read, or that is not text.
    pub fn text(&self, path: &Path) -> Result<String, ExperimentError> {
        let bytes = self.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
        measured::decoded(&bytes)
            .map_err(|what| ExperimentError::new(format!("`{}` is {what}", path.display())))
    }

    /// Reads the curves of a file.
    ///
    /// # Errors
    /// As [`measured::read_bytes`], and a file that cannot be read.
    pub fn table(&self, path: &Path, options: &TableOptions) -> Result<Table, ReadError> {
        let name = path.display().to_string();
        match self.bytes(path) {
            Ok(bytes) => measured::read_bytes(&name, &bytes, options),
            Err(cause) => Err(ReadError::Read { path: name, cause }),
        }
    }

    /// Refuses to write a file that was read, or whose name is not a file name.
    ///
    /// # Errors
    ///
    /// The reason, and how to mend it.
    pub fn check_writable(&self, path: &Path) -> Result<(), ExperimentError> {
        self.reads().check_file(path)?;
        Ok(files::check_writable(path)?)
    }

    /// Writes a file that a person named, unless [`Files::check_writable`] refuses it.
    ///
    /// # Errors
    /// A file that is read, or that cannot be written.
    pub fn write(&self, path: &Path, content: impl AsRef<[u8]>) -> Result<(), ExperimentError> {
        self.check_writable(path)?;
        Ok(files::write(path, content)?)
    }

    /// As [`Files::write`]; makes the folder of the file where there is none.
    ///
    /// # Errors
    /// Those of [`Files::write`], and a folder that cannot be made.
    pub fn write_in_folder(
        &self,
        path: &Path,
        content: impl AsRef<[u8]>,
    ) -> Result<(), ExperimentError> {
        if let Some(folder) = path.parent().filter(|folder| !folder.as_os_str().is_empty()) {
            files::create_folder(folder)?;
        }
        self.write(path, content)
    }
}
