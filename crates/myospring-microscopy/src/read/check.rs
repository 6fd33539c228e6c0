//! Checks of a picture's declared size, before memory is allocated.

use super::error::PictureError;
use super::limits::{LONGEST_SIDE, MOST_MEMORY, MOST_PIXELS};

/// Rejects sizes out of range; called before memory is allocated.
pub(super) fn check_size(width: u32, height: u32) -> Result<(), PictureError> {
    let pixels = u64::from(width) * u64::from(height);
    if width > LONGEST_SIDE || height > LONGEST_SIDE || pixels > MOST_PIXELS {
        return Err(PictureError::TooLarge { width, height });
    }
    Ok(())
}

/// Rejects a buffer larger than [`MOST_MEMORY`].
pub(super) fn check_memory(bytes: u64) -> Result<(), PictureError> {
    if bytes <= MOST_MEMORY {
        return Ok(());
    }
    Err(PictureError::TooMuch {
        what: format!("{} MiB of memory at once", bytes >> 20),
        most: format!("{} MiB are allowed", MOST_MEMORY >> 20),
        mend: "cut out the cell, or save the picture as grey values",
    })
}

/// Rejects a number that is not below `count`.
pub(super) fn check_range(
    what: &'static str,
    asked: usize,
    count: usize,
) -> Result<(), PictureError> {
    if asked < count { Ok(()) } else { Err(PictureError::OutOfRange { what, asked, count }) }
}
