//! Masks and label images from the bytes of a PNG or TIFF file.

use std::collections::BTreeSet;

use super::picture::{Depth, Picture, Selection};
use super::plane::Plane;
use super::read::{PictureError, read_picture};
use crate::mesh::mask::{Mask, MaskError, PIXEL_SIZES_UM};

/// Largest label: `f32` tells all whole numbers up to it apart.
pub const LARGEST_LABEL: u32 = 1 << 24;

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
    /// The different non-zero values, ascending; of a picture in colour 1, 2, and so on, one for each
    /// luminance. More than one, where no label was asked for, may mean that the picture holds several
    /// cells, or is not a mask.
    pub values: Vec<u32>,
}

/// Why bytes are not a usable mask.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MaskPictureError {
    /// The picture cannot be read.
    #[error(transparent)]
    Picture(#[from] PictureError),
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
    /// A value that is no label.
    #[error(
        "the pixel at column {column}, row {row} is {value}, but a mask holds whole numbers from 0 to \
         {LARGEST_LABEL}; is this the picture itself, not its mask?"
    )]
    NoLabel {
        /// The value.
        value: f32,
        /// Column, from 0.
        column: usize,
        /// Row, from 0 at the top.
        row: usize,
    },
    /// The pixels do not make a mask.
    #[error(transparent)]
    Mask(#[from] MaskError),
}

/// Reads a mask or label image: every picture that [`read_picture`] reads.
///
/// A pixel is the cell when one of its colour channels is not zero and it is not fully transparent;
/// with a label, when its grey value is that label. Of several pages the first is read.
///
/// # Errors
/// What [`read_picture`] says, grey values that are no whole numbers from 0 to [`LARGEST_LABEL`], a label
/// that is not there, an absurd pixel size, or a mask without cell or without background.
///
/// # Example
/// ```
/// use myospring::microscopy::mask::{MaskOptions, read_mask};
/// let text = b"x_um,y_um";
/// let options = MaskOptions { label: None, pixel_size_um: 0.27 };
/// assert_eq!(
///     read_mask(text, &options).unwrap_err().to_string(),
///     "this is not a picture (9 bytes that start with \"x_um,y_u\"); give a PNG or TIFF file"
/// );
/// ```
pub fn read_mask(bytes: &[u8], options: &MaskOptions) -> Result<MaskPicture, MaskPictureError> {
    let pixel_size = options.pixel_size_um;
    if !PIXEL_SIZES_UM.contains(&pixel_size) {
        return Err(MaskError::PixelSize { pixel_size }.into());
    }
    let one_page = Selection { depth: Some(Depth::Slice(0)), ..Selection::default() };
    let Picture { plane, coloured, .. } = read_picture(bytes, &one_page)?;
    if let (Some(label), true) = (options.label, coloured) {
        return Err(MaskPictureError::Colour { label });
    }
    let values = if coloured { luminances(&plane) } else { labels(&plane)? };
    let inside: Vec<bool> = match options.label {
        None => plane.values().iter().map(|&value| value != 0.0).collect(),
        Some(0) => return Err(MaskPictureError::BackgroundLabel { found: listed(&values) }),
        Some(label) if !values.contains(&label) => {
            return Err(MaskPictureError::NoSuchLabel { label, found: listed(&values) });
        }
        Some(label) => plane.values().iter().map(|&value| value == label as f32).collect(),
    };
    let mask = Mask::new(plane.width(), plane.height(), pixel_size, inside)?;
    Ok(MaskPicture { mask, values: values.into_iter().collect() })
}

/// The different non-zero values; each must be a label.
fn labels(plane: &Plane) -> Result<BTreeSet<u32>, MaskPictureError> {
    let mut found = BTreeSet::new();
    let mut last = 0.0;
    for (at, &value) in plane.values().iter().enumerate() {
        if value == last || value == 0.0 {
            last = value;
            continue;
        }
        // Above the largest label, neighbours in the file may have become equal.
        if value < 0.0 || value.fract() != 0.0 || value >= LARGEST_LABEL as f32 {
            let (column, row) = (at % plane.width(), at / plane.width());
            return Err(MaskPictureError::NoLabel { value, column, row });
        }
        found.insert(value as u32);
        last = value;
    }
    Ok(found)
}

/// One number for each non-zero luminance.
fn luminances(plane: &Plane) -> BTreeSet<u32> {
    let mut found: Vec<f32> =
        plane.values().iter().copied().filter(|&value| value != 0.0).collect();
    found.sort_by(f32::total_cmp);
    found.dedup();
    (1..=found.len() as u32).collect()
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
