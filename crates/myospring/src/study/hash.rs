//! One name for the same bytes.

use sha2::{Digest, Sha256};
use std::fmt::Write;

/// The SHA-256 of some bytes in hexadecimal digits.
///
/// # Example
/// ```
/// let hash = myospring::study::sha256(b"abc");
/// assert!(hash.starts_with("ba7816bf") && hash.len() == 64); // FIPS 180-2, appendix B.1
/// ```
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().fold(String::new(), |mut text, byte| {
        // Writing to a string does not fail.
        write!(text, "{byte:02x}").ok();
        text
    })
}
