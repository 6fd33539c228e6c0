//! Any text as a cell model: a CellML file if it starts with `<`, else a Myokit file.
#![no_main]

use myospring::cell_files::{Choices, read};

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    let text = String::from_utf8_lossy(bytes);
    let _ = read("fuzzed", &text, &Choices::default(), &|_| Some(text.to_string()));
});
