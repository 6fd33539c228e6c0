//! The files that this process reads, which none of its results may replace.

use myospring::measured::{self, Options, ReadError, Table};
use myospring::output::files::{self, Reads};
use std::io;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

static READ: Mutex<Reads> = Mutex::new(Reads::new());

/// Notes a file that is read, or a folder whose files are.
pub(crate) fn note(path: &Path) {
    READ.lock().unwrap_or_else(PoisonError::into_inner).add(path);
}

/// All that were noted.
pub(crate) fn all() -> Reads {
    READ.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

/// Reads a file, or what a pipe gives.
///
/// # Errors
/// As [`files::read`].
pub(crate) fn bytes(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    note(path.as_ref());
    files::read(path.as_ref())
}

/// Reads the curves of a file.
pub(crate) fn table(path: &Path, options: &Options) -> Result<Table, ReadError> {
    let name = path.display().to_string();
    match bytes(path) {
        Ok(bytes) => measured::read_bytes(&name, &bytes, options),
        Err(cause) => Err(ReadError::Read { path: name, cause }),
    }
}
