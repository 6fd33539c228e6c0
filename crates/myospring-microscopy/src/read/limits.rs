//! Limits on the size of a picture.

/// Largest number of pixels of a picture.
pub const MOST_PIXELS: u64 = 100_000_000;

/// Longest side of a picture, pixels.
pub const LONGEST_SIDE: u32 = 32_768;

/// Largest memory of the decoded bytes of a picture, or of one of its strips or tiles, bytes.
pub(super) const MOST_MEMORY: u64 = 1 << 29;
