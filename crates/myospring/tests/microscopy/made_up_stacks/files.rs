//! Stacks as the bytes of TIFF files.

use std::io::Cursor;
use tiff::encoder::TiffEncoder;
use tiff::encoder::colortype::Gray16;
use tiff::tags::Tag;

/// A page of 16 bits for each slice, without metadata.
pub(super) fn plain(slices: &[Vec<f32>], size: [usize; 2]) -> Vec<u8> {
    described(slices, size, "")
}

/// As [`plain`], with a description of the file.
pub(super) fn described(slices: &[Vec<f32>], [width, height]: [usize; 2], text: &str) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut file).unwrap();
    for (index, slice) in slices.iter().enumerate() {
        let values: Vec<u16> = slice.iter().map(|&value| value as u16).collect();
        let mut image = encoder.new_image::<Gray16>(width as u32, height as u32).unwrap();
        if index == 0 && !text.is_empty() {
            image.encoder().write_tag(Tag::ImageDescription, text).unwrap();
        }
        image.write_data(&values).unwrap();
    }
    file.into_inner()
}
