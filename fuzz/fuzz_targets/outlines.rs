//! Any bytes as outlines: the first one picks the reader.
#![no_main]

#[path = "../../crates/myospring/tests/common/outline_bytes.rs"]
mod outline_bytes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| outline_bytes::exercise(bytes));
