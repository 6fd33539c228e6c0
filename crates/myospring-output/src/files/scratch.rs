//! Temporary storage on the disk, for what is too large for memory.

use super::write::part_of;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

/// A file without a name, which is gone when it is closed. On a disk that gives files a name as long as they are open, it is hidden until
/// then; [`clear_parts`](super::clear_parts) removes one that a killed process left.
///
/// # Example
/// ```
/// # let folder = tempfile::tempdir()?;
/// let mut scratch = myospring::output::files::Scratch::new(folder.path(), 100)?;
/// scratch.write(40, b"beat")?;
/// let mut bytes = [1; 6];
/// scratch.read(39, &mut bytes)?;
/// assert_eq!(&bytes, b"\0beat\0");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Scratch {
    // It is closed first: then its name can be removed.
    file: File,
    _name: Option<Name>,
}

/// A name that is removed at the end.
#[derive(Debug)]
struct Name(PathBuf);

impl Scratch {
    /// Makes a file of `bytes` zeros in a folder.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn new(folder: &Path, bytes: u64) -> io::Result<Self> {
        let (path, file) = part_of(&folder.join("scratch"))?;
        let scratch = Self { file, _name: fs::remove_file(&path).is_err().then_some(Name(path)) };
        scratch.file.set_len(bytes)?;
        Ok(scratch)
    }

    /// Reads the bytes from a place on.
    ///
    /// # Errors
    /// Errors of the system; a file that ends before `bytes` is full.
    pub fn read(&mut self, place: u64, bytes: &mut [u8]) -> io::Result<()> {
        #[cfg(unix)]
        return std::os::unix::fs::FileExt::read_exact_at(&self.file, bytes, place);
        #[cfg(not(unix))]
        {
            use std::io::{Read as _, Seek as _};
            self.file.seek(io::SeekFrom::Start(place))?;
            self.file.read_exact(bytes)
        }
    }

    /// Writes bytes from a place on.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        #[cfg(unix)]
        return std::os::unix::fs::FileExt::write_all_at(&self.file, bytes, place);
        #[cfg(not(unix))]
        {
            use std::io::{Seek as _, Write as _};
            self.file.seek(io::SeekFrom::Start(place))?;
            self.file.write_all(bytes)
        }
    }
}

impl Drop for Name {
    fn drop(&mut self) {
        fs::remove_file(&self.0).ok();
    }
}
