//! The part of a picture around a cell.

use super::error::PageError;
use super::figure::address;
use crate::figure::FigureError;
use crate::figure::photograph::{Part, embedded};
use crate::figure::thumbnail;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::pixel_size::PixelSize;
use serde::Serialize;

/// Margin around the cell, as a part of its longer side.
const AROUND: f64 = 0.15;
/// Longest side, pixels.
const LONGEST: f64 = 900.0;
/// Longest side of a thumbnail, px, and its resolution, dots per inch: a pixel is a px.
const SMALL: f64 = 160.0;
const DPI: f64 = 96.0;

/// The picture of a cell: grey values row by row from the top left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Photograph<'a> {
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Values, any scale.
    pub values: &'a [f32],
    /// Side of one pixel; the lower left corner of the picture is at 0, 0 of the mesh.
    pub pixel_size: PixelSize,
}

#[derive(Debug, Serialize)]
pub(super) struct PictureData {
    href: String,
    corners_um: [[f64; 2]; 2],
}

impl<'a> Photograph<'a> {
    /// A cell with its outline, small: a PNG at most 160 pixels wide and high; `None` if it is
    /// outside the picture.
    ///
    /// # Errors
    /// A picture that cannot be drawn.
    pub fn thumbnail(&self, outline: &Outline) -> Result<Option<Vec<u8>>, FigureError> {
        let Some((part, [low, high])) = self.around(outline) else { return Ok(None) };
        let [width, height] = [0, 1].map(|axis| high[axis] - low[axis]);
        let place = |[x, y]: [f64; 2]| [(x - low[0]) / width, (high[1] - y) / height];
        let drawn = thumbnail(&part, SMALL * (width / height).min(1.0), outline.rings(), place)?;
        drawn.to_png(DPI).map(Some)
    }

    /// The part around an outline with its lower left and upper right corner, um; `None` if they do
    /// not overlap.
    fn around(&self, outline: &Outline) -> Option<(Part<'a>, [[f64; 2]; 2])> {
        let [low, high] = outline.bounds();
        let pixel = self.pixel_size.um();
        let room = AROUND * (high[0] - low[0]).max(high[1] - low[1]);
        let whole = [self.width, self.height];
        // Columns from the left, rows from the bottom.
        let [columns, rows] = [0, 1].map(|axis| {
            let end = whole[axis];
            let first = ((low[axis] - room) / pixel).floor().clamp(0.0, end as f64) as usize;
            let last = ((high[axis] + room) / pixel).ceil().clamp(0.0, end as f64) as usize;
            [first, last]
        });
        if columns[0] >= columns[1] || rows[0] >= rows[1] {
            return None;
        }
        let corner = |end: usize| [columns[end] as f64 * pixel, rows[end] as f64 * pixel];
        let part = Part {
            values: self.values,
            width: self.width,
            columns,
            rows: [self.height - rows[1], self.height - rows[0]],
        };
        Some((part, [corner(0), corner(1)]))
    }
}

/// The part around an outline; `None` if they do not overlap.
pub(super) fn of(
    picture: &Photograph<'_>,
    outline: &Outline,
) -> Result<Option<PictureData>, PageError> {
    let Some((part, corners_um)) = picture.around(outline) else { return Ok(None) };
    let width = (part.columns[1] - part.columns[0]) as f64;
    let png = embedded(&part, LONGEST.min(width))?.png;
    Ok(Some(PictureData { href: address("png", &png), corners_um }))
}
