//! Any bytes as a workbook of curves.
#![no_main]

#[path = "../../crates/myospring/tests/common/workbook_bytes.rs"]
mod workbook_bytes;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    workbook_bytes::exercise(bytes);
});
