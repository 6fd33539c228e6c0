//! A file that one process has for itself.
//!
//! What says so is a lock that the system keeps: it ends with the process, however that ends, so nobody has to
//! guess from a number whether the process is still alive.

use same_file::Handle;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

/// How often another process is given time to let go, and for how long: whoever clears leftovers holds a file
/// for a moment.
const TRIES: usize = 10;
const PAUSE: Duration = Duration::from_millis(20);

/// Who has a file.
#[derive(Debug)]
pub enum Hold {
    /// This process, until the file is dropped.
    Ours(File),
    /// Perhaps this process: the disk has no locks.
    Unknown(File),
    /// Another process, or another part of this one.
    Others,
}

/// Opens a file for reading and writing, makes it if it is not there, and locks it.
///
/// # Errors
/// When the system gives no such file.
///
/// # Example
/// ```
/// use myospring::output::files::{Hold, hold};
/// # let folder = tempfile::tempdir()?;
/// let path = folder.path().join("journal");
/// let first = hold(&path)?;
/// assert!(matches!(hold(&path)?, Hold::Others));
/// drop(first);
/// assert!(matches!(hold(&path)?, Hold::Ours(_)));
/// # Ok::<(), std::io::Error>(())
/// ```
pub fn hold(path: &Path) -> io::Result<Hold> {
    for _ in 0..TRIES {
        match try_hold(path, true)? {
            Hold::Others => sleep(PAUSE),
            held => return Ok(held),
        }
    }
    Ok(Hold::Others)
}

/// [`hold`] without waiting, for a file that is made only if `make` says so.
pub(super) fn try_hold(path: &Path, make: bool) -> io::Result<Hold> {
    let mut options = OpenOptions::new();
    let file = options.read(true).write(true).create(make).truncate(false).open(path)?;
    let locked = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::Error(_)) => false,
        Err(TryLockError::WouldBlock) => return Ok(Hold::Others),
    };
    // Whoever had it before may have removed or renamed it since it was opened here.
    Ok(match is_at(&file, path)? {
        true if locked => Hold::Ours(file),
        true => Hold::Unknown(file),
        false => Hold::Others,
    })
}

/// Whether the file of this name is the open one.
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    let opened = Handle::from_file(file.try_clone()?)?;
    match Handle::from_path(path) {
        Ok(named) => Ok(named == opened),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
