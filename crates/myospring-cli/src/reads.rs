//! The files that this process reads, which none of its results may replace.

use myospring::measured::{self, Options, ReadError, Table};
use myospring::output::files::Reads;
use std::fs::{File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;
use std::sync::{Mutex, PoisonError};

/// Bytes of the largest file that is read: films of an hour are smaller.
const LARGEST: u64 = 64 << 30;
/// Bytes that are read of a pipe, which does not say how many it has.
const LARGEST_PIPE: u64 = 1 << 30;

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
/// What the system says; a device, a file of more than [`LARGEST`] bytes and a pipe that gives more than [`LARGEST_PIPE`]
/// are [`io::ErrorKind::InvalidData`].
pub(crate) fn bytes(path: impl AsRef<Path>) -> io::Result<Vec<u8>> {
    let path = path.as_ref();
    note(path);
    let file = File::open(path)?;
    let about = file.metadata()?;
    let refused = |what: String| Err(io::Error::new(io::ErrorKind::InvalidData, what));
    let most = if about.is_file() { LARGEST } else { LARGEST_PIPE };
    if is_device(&about) {
        return refused("it is a device, not a file".to_owned());
    }
    if about.len() > most {
        return refused(too_large(most));
    }
    let mut bytes = Vec::with_capacity(about.len() as usize);
    // One more than may be, so that more is seen.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return refused(too_large(most));
    }
    Ok(bytes)
}

/// Reads the curves of a file.
pub(crate) fn table(path: &Path, options: &Options) -> Result<Table, ReadError> {
    let name = path.display().to_string();
    match bytes(path) {
        Ok(bytes) => measured::read_bytes(&name, &bytes, options),
        Err(cause) => Err(ReadError::Read { path: name, cause }),
    }
}

fn too_large(most: u64) -> String {
    format!("it has more than {} GB, the most that is read", most >> 30)
}

#[cfg(unix)]
fn is_device(about: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt as _;
    about.file_type().is_char_device() || about.file_type().is_block_device()
}

#[cfg(not(unix))]
fn is_device(_about: &Metadata) -> bool {
    false
}
