//! What several tests share.
#![allow(
    dead_code,
    unused_imports,
    clippy::expect_used,
    reason = "no test uses all of it, and tests may fail"
)]

mod sample;
mod skipped;

pub(crate) use sample::Sample;
pub(crate) use skipped::{left_to_full, shared_data};

use myospring::analysis::trace;
use myospring::mesh::pixel_size::PixelSize;

/// Pixels of a side in um.
pub(crate) fn pixels_of(um: f64) -> PixelSize {
    PixelSize::new(um).expect("a pixel size")
}

/// The largest cell of a mask, whose pixels are 0.27 um wide.
#[cfg(feature = "microscopy")]
pub(crate) fn mask(file: std::path::PathBuf) -> myospring::mesh::mask::Mask {
    use myospring::microscopy::cells::{PictureCells, PictureOptions};
    use myospring::microscopy::segment::Choice;
    let bytes = std::fs::read(file).expect("the file is there");
    let options = PictureOptions { pixel_size: Some(pixels_of(0.27)), ..PictureOptions::default() };
    let cells = PictureCells::find(&bytes, &options).expect("a mask has a cell");
    assert_eq!(cells.modality(), "mask");
    cells.cell(Choice::Largest, false).expect("the largest cell is whole").mask
}

/// As in the library, NaN where the curve does not fall through the level.
pub(crate) fn falls_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    trace::falls_through(times, values, level, from).unwrap_or(f64::NAN)
}

/// As in the library, NaN where the curve does not rise through the level.
pub(crate) fn rises_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    trace::rises_through(times, values, level, from).unwrap_or(f64::NAN)
}

/// The checksum of PNG chunks (PNG specification, annex D).
pub(crate) fn png_checksum(bytes: &[u8]) -> u32 {
    let fold = |crc: u32, byte: &u8| {
        (0..8).fold(crc ^ u32::from(*byte), |crc, _| {
            if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 }
        })
    };
    !bytes.iter().fold(!0, fold)
}

/// A PNG of grey pixels (1 channel), with opacity (2), of colours (3), or both (4), 8 bits a sample.
#[cfg(feature = "microscopy")]
pub(crate) fn png(size: [u32; 2], channels: usize, samples: &[u8]) -> Vec<u8> {
    encoded_png(size, channels, png::BitDepth::Eight, samples)
}

/// A PNG of grey pixels, 16 bits a sample.
#[cfg(feature = "microscopy")]
pub(crate) fn wide_png(size: [u32; 2], samples: &[u16]) -> Vec<u8> {
    let bytes: Vec<u8> = samples.iter().flat_map(|sample| sample.to_be_bytes()).collect();
    encoded_png(size, 1, png::BitDepth::Sixteen, &bytes)
}

#[cfg(feature = "microscopy")]
fn encoded_png(
    [width, height]: [u32; 2],
    channels: usize,
    depth: png::BitDepth,
    bytes: &[u8],
) -> Vec<u8> {
    use png::ColorType::{Grayscale, GrayscaleAlpha, Rgb, Rgba};
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, width, height);
    encoder.set_color([Grayscale, GrayscaleAlpha, Rgb, Rgba][channels - 1]);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("a size");
    writer.write_image_data(bytes).expect("samples for every pixel");
    writer.finish().expect("memory");
    file
}

/// A TIFF whose pixels are of this kind, like `tiff::encoder::colortype::Gray16`.
#[cfg(feature = "microscopy")]
pub(crate) fn tiff<Kind: tiff::encoder::colortype::ColorType>(
    [width, height]: [u32; 2],
    samples: &[Kind::Inner],
) -> Vec<u8>
where
    [Kind::Inner]: tiff::encoder::TiffValue,
{
    let mut file = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).expect("memory");
    encoder.write_image::<Kind>(width, height, samples).expect("samples for every pixel");
    file.into_inner()
}
