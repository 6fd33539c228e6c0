//! Any bytes as a picture.
#![no_main]

#[path = "../../crates/myospring/tests/common/picture_bytes.rs"]
mod picture_bytes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    picture_bytes::exercise(bytes);
});
