//! Reads files of unknown origin, up to a largest size.

use std::fs::{File, Metadata};
use std::io::{self, Read as _};
use std::path::Path;

/// Largest file that is read, bytes; a film of an hour is smaller.
const LARGEST: u64 = 64 << 30;

/// Largest number of bytes read from a pipe, whose size is not known in advance.
const LARGEST_PIPE: u64 = 1 << 30;

/// Reads the bytes of a file or pipe.
///
/// # Errors
/// Errors of the system; a device, a file of more than 64 GB and a pipe with more than 1 GB give
/// [`io::ErrorKind::InvalidData`].
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
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
    // One byte more than allowed, to detect larger input.
    file.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        return refused(too_large(most));
    }
    Ok(bytes)
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

#[cfg(all(test, unix))]
mod tests {
    use super::read;
    use std::path::Path;

    #[test]
    fn a_device_and_a_file_without_end_are_refused_before_they_are_read() {
        for device in ["/dev/zero", "/dev/urandom"] {
            let error = read(Path::new(device)).unwrap_err().to_string();
            assert!(error.contains("it is a device"), "{device}: {error}");
        }
        // A file of which the disk holds nothing.
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("long.csv");
        std::fs::File::create(&path).unwrap().set_len(65 << 30).unwrap();
        let error = read(&path).unwrap_err().to_string();
        assert!(error.contains("more than 64 GB"), "{error}");
    }
}
