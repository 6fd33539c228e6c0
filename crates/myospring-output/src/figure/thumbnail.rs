//! A cell in its picture, small.

use super::photograph::{Part, embedded};
use super::sheet::{Area, Path, Sheet, Stroke};
use super::theme::Colour;
use super::{Figure, FigureError};

/// Line of the outline (Okabe-Ito yellow), readable on black and on grey.
const LINE: Colour = Colour(0xf0e442);

/// A part of a picture, `width` px wide, with outlines on it; `place` is where a point in um is in the part, from 0 to 1
/// from its upper left corner.
pub(crate) fn thumbnail<'a>(
    part: &Part<'_>,
    width: f64,
    rings: impl Iterator<Item = &'a [[f64; 2]]>,
    place: impl Fn([f64; 2]) -> [f64; 2],
) -> Result<Figure, FigureError> {
    let [columns, rows] = [part.columns, part.rows].map(|[first, end]| (end - first) as f64);
    let size = [width, width * rows / columns];
    let mut sheet = Sheet::default();
    sheet.picture(Area { corner: [0.0, 0.0], size }, embedded(part, width)?);
    let mut path = Path::default();
    for ring in rings {
        path.add_ring(ring.iter().map(|&point| {
            let at = place(point);
            [0, 1].map(|axis| at[axis] * size[axis])
        }));
    }
    sheet.path(path, Stroke::new(LINE, 1.3));
    Ok(sheet.finish(size[0], size[1]))
}
