//! Exclusive use of a file by one process.
//!
//! It is a lock of the operating system, which ends with the process, however the process ends; so
//! it is never necessary to guess whether another process is still running.

use same_file::Handle;
use std::fs::{File, OpenOptions, TryLockError};
use std::io;
use std::path::Path;
use std::thread::sleep;
use std::time::Duration;

/// Number of attempts while another process holds the file, and the time between them: a process
/// that clears leftovers holds a file for a moment.
const TRIES: usize = 10;
const PAUSE: Duration = Duration::from_millis(20);

/// Which process holds a file.
#[derive(Debug)]
pub enum Hold {
    /// This process, until the file is dropped.
    Ours(File),
    /// Unknown, because the disk does not support locks.
    Unknown(File),
    /// Another process, or another part of this one.
    Others,
}

/// Opens a file for reading and writing, creates it if it does not exist, and locks it.
///
/// # Errors
/// Errors of the system.
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

/// [`hold`] without waiting; the file is created only if `make` is true.
pub(super) fn try_hold(path: &Path, make: bool) -> io::Result<Hold> {
    let mut options = OpenOptions::new();
    let file = options.read(true).write(true).create(make).truncate(false).open(path)?;
    let locked = match file.try_lock() {
        Ok(()) => true,
        Err(TryLockError::Error(_)) => false,
        Err(TryLockError::WouldBlock) => return Ok(Hold::Others),
    };
    // The previous holder may have removed or renamed the file since it was opened here.
    Ok(match is_at(&file, path)? {
        true if locked => Hold::Ours(file),
        true => Hold::Unknown(file),
        false => Hold::Others,
    })
}

/// Whether this path still refers to the open file.
fn is_at(file: &File, path: &Path) -> io::Result<bool> {
    let opened = Handle::from_file(file.try_clone()?)?;
    match Handle::from_path(path) {
        Ok(named) => Ok(named == opened),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(false),
        Err(error) => Err(error),
    }
}
