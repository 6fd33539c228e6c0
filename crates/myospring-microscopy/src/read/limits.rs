//! How large a picture may be.

/// Most pixels that a picture may declare.
pub const MOST_PIXELS: u64 = 100_000_000;

/// Longest side that a picture may declare, pixels.
pub const LONGEST_SIDE: u32 = 32_768;

/// Most memory that the decoded bytes of a picture, or of one of its strips or tiles, may take, bytes.
pub(super) const MOST_MEMORY: u64 = 1 << 29;
