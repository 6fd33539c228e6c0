//! Unpacks LZMA in the browser, which has only gzip: the engine of the page is a quarter smaller so.
//!
//! The page writes packed bytes into `input`, calls `unpack`, and reads `unpacked_length` bytes from where that points.
#![allow(
    unsafe_code,
    reason = "the page finds the functions by their names; no pointer is followed here"
)]

use lzma_rust2::LzmaReader;
use std::cell::RefCell;
use std::io::Read as _;

/// Memory of the reader at most, kB.
const MEMORY_KB: u32 = 256 << 10;

thread_local! {
    static BYTES: RefCell<Vec<u8>> = RefCell::default();
}

/// The bytes that a `.lzma` file holds.
///
/// # Errors
/// Bytes that are no such file.
///
/// # Example
/// ```
/// assert!(myospring_unpack::unpacked(b"no such file").is_err());
/// ```
pub fn unpacked(packed: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    LzmaReader::new_mem_limit(packed, MEMORY_KB, None)?.read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Room for packed bytes.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn input(length: usize) -> *mut u8 {
    BYTES.with_borrow_mut(|bytes| {
        bytes.clear();
        bytes.resize(length, 0);
        bytes.as_mut_ptr()
    })
}

/// Unpacks the input; nothing is left of bytes that are not packed.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn unpack() -> *const u8 {
    BYTES.with_borrow_mut(|bytes| {
        *bytes = unpacked(bytes).unwrap_or_default();
        bytes.as_ptr()
    })
}

/// How many bytes were unpacked.
#[unsafe(no_mangle)]
pub(crate) extern "C" fn unpacked_length() -> usize {
    BYTES.with_borrow(Vec::len)
}
