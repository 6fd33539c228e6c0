//! The part of a picture around the cell.

use super::cell::Photograph;
use super::figure::address;
use super::given::PageError;
use crate::figure::photograph::{Part, embedded};
use myospring_core::mesh::outline::Outline;
use serde::Serialize;

/// What is shown around the cell, of its longer side.
const AROUND: f64 = 0.15;
/// Longest side, pixels.
const LONGEST: f64 = 900.0;

#[derive(Debug, Serialize)]
pub(super) struct PictureData {
    href: String,
    corners_um: [[f64; 2]; 2],
}

/// The part around an outline; none where they do not meet.
pub(super) fn of(
    picture: &Photograph<'_>,
    outline: &Outline,
) -> Result<Option<PictureData>, PageError> {
    let [low, high] = outline.bounds();
    let pixel = picture.pixel_size.um();
    let room = AROUND * (high[0] - low[0]).max(high[1] - low[1]);
    let whole = [picture.width, picture.height];
    // Columns from the left, rows from the bottom.
    let [columns, rows] = [0, 1].map(|axis| {
        let end = whole[axis];
        let first = ((low[axis] - room) / pixel).floor().clamp(0.0, end as f64) as usize;
        let last = ((high[axis] + room) / pixel).ceil().clamp(0.0, end as f64) as usize;
        [first, last]
    });
    if columns[0] >= columns[1] || rows[0] >= rows[1] {
        return Ok(None);
    }
    let part = Part {
        values: picture.values,
        width: picture.width,
        columns,
        rows: [picture.height - rows[1], picture.height - rows[0]],
    };
    let png = embedded(&part, LONGEST.min((columns[1] - columns[0]) as f64))?.png;
    let corner = |end: usize| [columns[end] as f64 * pixel, rows[end] as f64 * pixel];
    let href = address("png", &png);
    Ok(Some(PictureData { href, corners_um: [corner(0), corner(1)] }))
}
