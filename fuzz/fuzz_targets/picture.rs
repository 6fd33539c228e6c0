//! Any bytes as a picture, and as a mask: an answer or an error, in little time and memory.
#![no_main]

use libfuzzer_sys::fuzz_target;
use myospring::microscopy::mask::{MaskOptions, read_mask};
use myospring::microscopy::picture::{Depth, Selection};
use myospring::microscopy::read::read_picture;

fuzz_target!(|bytes: &[u8]| {
    let maximum = Selection { depth: Some(Depth::Maximum), ..Selection::default() };
    let inner = Selection { channel: Some(1), frame: 1, depth: Some(Depth::Slice(1)) };
    for selection in [Selection::default(), maximum, inner] {
        let _ = read_picture(bytes, &selection);
    }
    let _ = read_mask(bytes, &MaskOptions { label: None, pixel_size_um: 0.27 });
});
