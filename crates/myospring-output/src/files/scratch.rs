//! A file for what is not to be in memory.

use super::write::part_of;
use std::fs::{self, File};
use std::io;
use std::path::Path;

/// A file without a name, gone when it is closed, however the process ends.
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
pub struct Scratch(File);

impl Scratch {
    /// A file of some bytes, all 0, in a folder.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn new(folder: &Path, bytes: u64) -> io::Result<Self> {
        let (path, file) = part_of(&folder.join("scratch"))?;
        fs::remove_file(path)?;
        file.set_len(bytes)?;
        Ok(Self(file))
    }

    /// Reads the bytes from a place on.
    ///
    /// # Errors
    /// Errors of the system; fewer bytes.
    pub fn read(&mut self, place: u64, bytes: &mut [u8]) -> io::Result<()> {
        #[cfg(unix)]
        return std::os::unix::fs::FileExt::read_exact_at(&self.0, bytes, place);
        #[cfg(not(unix))]
        {
            use std::io::{Read as _, Seek as _};
            self.0.seek(io::SeekFrom::Start(place))?;
            self.0.read_exact(bytes)
        }
    }

    /// Writes bytes from a place on.
    ///
    /// # Errors
    /// Errors of the system.
    pub fn write(&mut self, place: u64, bytes: &[u8]) -> io::Result<()> {
        #[cfg(unix)]
        return std::os::unix::fs::FileExt::write_all_at(&self.0, bytes, place);
        #[cfg(not(unix))]
        {
            use std::io::{Seek as _, Write as _};
            self.0.seek(io::SeekFrom::Start(place))?;
            self.0.write_all(bytes)
        }
    }
}
