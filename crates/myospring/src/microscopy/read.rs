//! Masks and label images from the bytes of a PNG or TIFF file.

use std::collections::BTreeSet;
use std::io::Cursor;

use image::{DynamicImage, ImageDecoder, ImageError, ImageFormat, ImageReader, Limits};

use crate::mesh::mask::{Mask, MaskError, PIXEL_SIZES_UM};

/// Most pixels that a picture may declare.
pub const MOST_PIXELS: u64 = 100_000_000;

/// Longest side that a picture may declare, pixels.
pub const LONGEST_SIDE: u32 = 32_768;

/// Most memory that reading a picture may take, bytes.
const MOST_MEMORY: u64 = 1 << 30;

/// How to read a mask.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaskOptions {
    /// Take the pixels of this value only; without it every non-zero pixel is the cell.
    pub label: Option<u32>,
    /// Side of one pixel, um.
    pub pixel_size_um: f64,
}

/// A mask, and the values that its picture holds.
#[derive(Debug, Clone, PartialEq)]
pub struct MaskPicture {
    /// Which pixels are the cell.
    pub mask: Mask,
    /// The different non-zero values, ascending. More than one, where no label was asked for, may
    /// mean that the picture holds several cells, or is not a mask.
    pub values: Vec<u32>,
}

/// Why bytes are not a usable mask.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PictureError {
    /// The bytes are no picture at all.
    #[error(
        "this is not a picture ({bytes} bytes that start with {start}); give a PNG or TIFF file"
    )]
    NotAPicture {
        /// Size of the file, bytes.
        bytes: usize,
        /// Its first bytes.
        start: String,
    },
    /// A picture of another kind.
    #[error(
        "this is a {format} picture, which is not read here; save the mask as PNG or TIFF without \
         lossy compression"
    )]
    Format {
        /// What it is.
        format: String,
    },
    /// A PNG or TIFF that is damaged, or of a kind that cannot be read.
    #[error("the {format} picture cannot be read: {reason}; is the file complete?")]
    Unreadable {
        /// PNG or TIFF.
        format: &'static str,
        /// What the decoder says.
        reason: String,
    },
    /// Pixels of a kind that cannot be read.
    #[error(
        "the {format} picture has pixels of a kind that is not read ({reason}); save the mask with 8 \
         or 16 bits per pixel"
    )]
    Pixels {
        /// PNG or TIFF.
        format: &'static str,
        /// What the decoder says.
        reason: String,
    },
    /// The header declares more pixels than a mask may have.
    #[error(
        "the picture declares {width} x {height} pixels; at most {LONGEST_SIDE} per side and \
         {MOST_PIXELS} in all are read: cut out the cell"
    )]
    TooLarge {
        /// Columns.
        width: u32,
        /// Rows.
        height: u32,
    },
    /// No pixel has the chosen label.
    #[error("label {label} is not in the picture, which holds {found}")]
    NoSuchLabel {
        /// The label asked for.
        label: u32,
        /// The labels that are there.
        found: String,
    },
    /// Zero is the background.
    #[error("label 0 is the background; choose one of the cells: {found}")]
    BackgroundLabel {
        /// The labels that are there.
        found: String,
    },
    /// Colours are no labels.
    #[error(
        "label {label} was asked for, but the picture is in colour; save the labels as grey values, \
         or give a mask of one cell without a label"
    )]
    Colour {
        /// The label asked for.
        label: u32,
    },
    /// The pixels do not make a mask.
    #[error(transparent)]
    Mask(#[from] MaskError),
}

/// Reads a mask or label image: PNG or TIFF, grey of 1 to 16 bits, colour or palette.
///
/// A pixel is the cell when one of its colour channels is not zero and it is not fully transparent;
/// with a label, when its grey value is that label. Of a TIFF with several pages the first is read.
/// The size that the header declares is checked before any memory is taken.
///
/// # Errors
/// Bytes that are not a complete PNG or TIFF, more than [`MOST_PIXELS`] or [`LONGEST_SIDE`], a label
/// that is not there, an absurd pixel size, or a mask without cell or without background.
///
/// # Example
/// ```
/// use myospring::microscopy::read::{MaskOptions, read_mask};
/// let text = b"x_um,y_um";
/// let options = MaskOptions { label: None, pixel_size_um: 0.27 };
/// assert_eq!(
///     read_mask(text, &options).unwrap_err().to_string(),
///     "this is not a picture (9 bytes that start with \"x_um,y_u\"); give a PNG or TIFF file"
/// );
/// ```
pub fn read_mask(bytes: &[u8], options: &MaskOptions) -> Result<MaskPicture, PictureError> {
    let pixel_size = options.pixel_size_um;
    if !PIXEL_SIZES_UM.contains(&pixel_size) {
        return Err(MaskError::PixelSize { pixel_size }.into());
    }
    let (picture, scale) = decode(bytes)?;
    let (width, height) = (picture.width() as usize, picture.height() as usize);
    let pixels = grey_values(&picture, scale);
    if let (Some(label), true) = (options.label, pixels.coloured) {
        return Err(PictureError::Colour { label });
    }
    let values: BTreeSet<u32> = distinct(&pixels.values);
    let inside: Vec<bool> = match options.label {
        None => pixels.values.iter().map(|&value| value != 0).collect(),
        Some(0) => return Err(PictureError::BackgroundLabel { found: listed(&values) }),
        Some(label) if !values.contains(&label) => {
            return Err(PictureError::NoSuchLabel { label, found: listed(&values) });
        }
        Some(label) => pixels.values.iter().map(|&value| value == label).collect(),
    };
    let mask = Mask::new(width, height, pixel_size, inside)?;
    Ok(MaskPicture { mask, values: values.into_iter().collect() })
}

/// The picture, and the factor by which the decoder stretched its grey values to fill 8 bits.
fn decode(bytes: &[u8]) -> Result<(DynamicImage, u32), PictureError> {
    let guessed = ImageReader::new(Cursor::new(bytes)).with_guessed_format();
    let (mut reader, name) = match guessed.map(|reader| (reader.format(), reader)) {
        Ok((Some(ImageFormat::Png), reader)) => (reader, "PNG"),
        Ok((Some(ImageFormat::Tiff), reader)) => (reader, "TIFF"),
        Ok((Some(other), _)) => {
            return Err(PictureError::Format { format: format!("{other:?}").to_uppercase() });
        }
        _ => {
            let start = format!("{:?}", String::from_utf8_lossy(&bytes[..bytes.len().min(8)]));
            return Err(PictureError::NotAPicture { bytes: bytes.len(), start });
        }
    };
    let failed = |error: ImageError| match error {
        ImageError::Unsupported(_) => {
            PictureError::Pixels { format: name, reason: error.to_string() }
        }
        error => PictureError::Unreadable { format: name, reason: error.to_string() },
    };
    if let Some((width, height)) = png_size(bytes) {
        check_size(width, height)?;
    }
    let mut limits = Limits::no_limits();
    limits.max_alloc = Some(MOST_MEMORY);
    reader.limits(limits);
    let decoder = reader.into_decoder().map_err(failed)?;
    let (width, height) = decoder.dimensions();
    check_size(width, height)?;
    let picture = DynamicImage::from_decoder(decoder).map_err(failed)?;
    Ok((picture, grey_stretch(bytes)))
}

fn check_size(width: u32, height: u32) -> Result<(), PictureError> {
    let pixels = u64::from(width) * u64::from(height);
    if width > LONGEST_SIDE || height > LONGEST_SIDE || pixels > MOST_PIXELS {
        return Err(PictureError::TooLarge { width, height });
    }
    Ok(())
}

/// The size in a PNG's header, which always comes first: 8 bytes of signature, 8 of chunk name,
/// then width, height, bit depth and colour type (PNG specification, 11.2.2).
fn png_size(bytes: &[u8]) -> Option<(u32, u32)> {
    let number = |at: usize| Some(u32::from_be_bytes(*bytes.get(at..)?.first_chunk()?));
    let is_png = bytes.starts_with(b"\x89PNG\r\n\x1a\n") && bytes.get(12..16)? == b"IHDR";
    if is_png { Some((number(16)?, number(20)?)) } else { None }
}

/// Grey PNGs of 1, 2 and 4 bits come out stretched to 0..=255, and 1-bit TIFFs likewise: a label n
/// reads n times 255, 85, 17. Only PNG is undone here; a 1-bit TIFF has no label but its one value.
fn grey_stretch(bytes: &[u8]) -> u32 {
    if png_size(bytes).is_none() {
        return 1;
    }
    match bytes.get(24..26) {
        Some([1, 0]) => 255,
        Some([2, 0]) => 85,
        Some([4, 0]) => 17,
        _ => 1,
    }
}

/// One number per pixel: the grey value, or for a colour all channels in one.
struct Values {
    values: Vec<u32>,
    coloured: bool,
}

fn grey_values(picture: &DynamicImage, stretch: u32) -> Values {
    let mut coloured = false;
    let mut colour = |rgb: [u32; 3]| {
        coloured |= rgb[0] != rgb[1] || rgb[1] != rgb[2];
        // Any value would do that is zero for black only; grey stays itself.
        if rgb[0] == rgb[1] && rgb[1] == rgb[2] { rgb[0] } else { rgb[0] | rgb[1] | rgb[2] }
    };
    let values = match picture {
        DynamicImage::ImageLuma8(grey) => {
            grey.as_raw().iter().map(|&value| u32::from(value) / stretch).collect()
        }
        DynamicImage::ImageLuma16(grey) => grey.as_raw().iter().map(|&v| u32::from(v)).collect(),
        DynamicImage::ImageLumaA8(grey) => {
            grey.pixels().map(|p| if p[1] == 0 { 0 } else { u32::from(p[0]) / stretch }).collect()
        }
        DynamicImage::ImageLumaA16(grey) => {
            grey.pixels().map(|p| if p[1] == 0 { 0 } else { u32::from(p[0]) }).collect()
        }
        DynamicImage::ImageRgb8(rgb) => rgb.pixels().map(|p| colour(p.0.map(u32::from))).collect(),
        DynamicImage::ImageRgb16(rgb) => rgb.pixels().map(|p| colour(p.0.map(u32::from))).collect(),
        DynamicImage::ImageRgba8(rgb) => rgb
            .pixels()
            .map(|p| if p[3] == 0 { 0 } else { colour([p[0], p[1], p[2]].map(u32::from)) })
            .collect(),
        other => other
            .to_rgba16()
            .pixels()
            .map(|p| if p[3] == 0 { 0 } else { colour([p[0], p[1], p[2]].map(u32::from)) })
            .collect(),
    };
    Values { values, coloured }
}

fn distinct(values: &[u32]) -> BTreeSet<u32> {
    let mut found = BTreeSet::new();
    let mut last = 0;
    for &value in values {
        if value != last && value != 0 {
            found.insert(value);
        }
        last = value;
    }
    found
}

/// The first labels in words: `the labels 1, 2, 5`.
fn listed(values: &BTreeSet<u32>) -> String {
    const SHOWN: usize = 12;
    let shown: Vec<String> = values.iter().take(SHOWN).map(u32::to_string).collect();
    match values.len() {
        0 => "no label at all".to_owned(),
        1 => format!("the label {}", shown[0]),
        count if count > SHOWN => format!("{count} labels: {}, ...", shown.join(", ")),
        _ => format!("the labels {}", shown.join(", ")),
    }
}
