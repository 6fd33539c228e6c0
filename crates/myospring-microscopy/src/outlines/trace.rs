//! Traces the pixels of a cell as an outline.
//!
//! An outline has two forms ([`Edge`]). Along the edges of the pixels it keeps every pixel and the
//! exact area, but it is a staircase, whose length is too long, by a factor of 1.27 on average over
//! all directions. The smooth form also has the right length and direction; it is the default.
//!
//! Pixels that touch by a side or a corner are one cell, as for [`Mask::largest_part`]. Where two
//! of them touch only in a corner, the outline has a bridge 0.001 pixel wide. Holes are kept.

use super::ring::{CUT, part_touching};
use super::smooth::smooth;
use super::{MOST_HOLES, PixelFrame};
use myospring_core::mesh::mask::Mask;
use myospring_core::mesh::outline::{Outline, OutlineError};

/// Largest number of corners of all traced rings; a picture of noise has more.
const MOST_CORNERS: usize = 4_000_000;

/// The form of an outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edge {
    /// Through the midpoints of the pixels' edges, averaged over neighbours, without points that
    /// deviate by less than half a pixel. Its area differs from that of the pixels by at most 0.5
    /// %; if that is impossible, in cells of a few pixels, the exact form is used.
    #[default]
    Smooth,
    /// Along the edges of the pixels.
    Exact,
}

/// Why pixels have no valid outline.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// More corners or holes than a cell can have.
    #[error(
        "the pixels of the cell have {found} {what}, more than {bound}: is this the picture itself, not its mask? \
         Else fill holes and remove specks"
    )]
    TooMany {
        /// What there is too much of.
        what: &'static str,
        /// How many, at least.
        found: usize,
        /// How many are allowed.
        bound: usize,
    },
    /// The traced rings are not a valid outline.
    #[error("the pixels of the cell: {0}")]
    Outline(#[from] OutlineError),
}

/// Outline of the largest part of a mask, um from the lower left corner of the picture.
///
/// The exact form has the area of the part and gives the same mesh as
/// [`myospring_core::mesh::lattice::from_mask`] .
///
/// # Errors
/// A part of less than 1 um^2 or more than 10 mm, or with more than [`MOST_HOLES`] holes.
///
/// # Example
/// ```
/// use myospring::mesh::{mask::Mask, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::trace::{Edge, trace_mask};
/// let disc = |i: usize| (i % 60).abs_diff(30).pow(2) + (i / 60).abs_diff(30).pow(2) < 600;
/// let pixel = PixelSize::new(0.5).unwrap();
/// let mask = Mask::new(60, 60, pixel, (0..3600).map(disc).collect()).unwrap();
/// let [exact, smooth] = [Edge::Exact, Edge::Smooth].map(|edge| trace_mask(&mask, edge).unwrap());
/// assert!((exact.area() - mask.area_um2()).abs() < 1e-9 * mask.area_um2());
/// // The circle has a radius of 12.25 um; the staircase is as long as the square around
/// // its 49 pixels.
/// assert!((smooth.perimeter() / 77.0 - 1.0).abs() < 0.01);
/// assert_eq!(exact.perimeter(), 98.0);
/// ```
pub fn trace_mask(mask: &Mask, edge: Edge) -> Result<Outline, TraceError> {
    let (largest, _) = mask.largest_part();
    let part = largest.part();
    let mut rings = trace(part.width, part.height(), &part.inside)?;
    let corner = [part.left as f64, part.top as f64];
    for point in rings.iter_mut().flatten() {
        *point = [point[0] + corner[0], point[1] + corner[1]];
    }
    let frame = PixelFrame::of(mask);
    let found = rings.len().saturating_sub(1);
    if found > MOST_HOLES {
        return Err(TraceError::TooMany { what: "holes", found, bound: MOST_HOLES });
    }
    if edge == Edge::Smooth
        && let Some(outline) = smooth(&rings, &frame)
    {
        return Ok(outline);
    }
    part_touching(&mut rings, CUT);
    Ok(frame.outline(rings)?)
}

/// The rings of corners along the pixel edges of one connected set of pixels, the exterior first.
pub(super) fn trace(
    width: usize,
    height: usize,
    inside: &[bool],
) -> Result<Vec<Vec<[f64; 2]>>, TraceError> {
    let (signed_width, signed_height) = (width.cast_signed(), height.cast_signed());
    let at = |column: isize, row: isize| {
        let within = (0..signed_width).contains(&column) && (0..signed_height).contains(&row);
        within && inside[row as usize * width + column as usize]
    };
    let mut rings = Vec::new();
    // Every ring passes the upper side of a pixel, the exterior that of the first pixel.
    let mut passed = vec![false; inside.len()];
    let mut corners = 0;
    for (index, _) in inside.iter().enumerate().filter(|(_, inside)| **inside) {
        let start = [index % width, index / width].map(usize::cast_signed);
        if passed[index] || at(start[0], start[1] - 1) {
            continue;
        }
        let mut ring = Vec::new();
        follow(start, at, |step| {
            if step.side == 0 {
                passed[step.pixel[1] as usize * width + step.pixel[0] as usize] = true;
            }
            if step.turns {
                ring.push(step.end.map(|value| value as f64));
            }
        });
        corners += ring.len();
        if corners > MOST_CORNERS {
            let what = "corners of pixels along all edges";
            return Err(TraceError::TooMany { what, found: corners, bound: MOST_CORNERS });
        }
        rings.push(ring);
    }
    Ok(rings)
}

/// One pixel side of a ring.
pub(crate) struct Step {
    /// The pixel on its inner side: column and row.
    pub(crate) pixel: [isize; 2],
    /// Which of its sides: 0 upper, 1 right, 2 lower, 3 left.
    side: usize,
    /// Corner at the end of the side.
    end: [isize; 2],
    /// Whether the ring turns there.
    turns: bool,
}

/// Walks once around, from the upper side of a pixel, with the inside on the right; at a corner
/// where two inside pixels touch, it continues along the other one.
pub(crate) fn follow(
    start: [isize; 2],
    inside: impl Fn(isize, isize) -> bool,
    mut visit: impl FnMut(&Step),
) {
    const AHEAD: [[isize; 2]; 4] = [[1, 0], [0, 1], [-1, 0], [0, -1]];
    const END: [[isize; 2]; 4] = [[1, 0], [1, 1], [0, 1], [0, 0]];
    let add = |a: [isize; 2], b: [isize; 2]| [a[0] + b[0], a[1] + b[1]];
    let (mut pixel, mut side) = (start, 0);
    loop {
        let left = (side + 3) % 4;
        let ahead = add(pixel, AHEAD[side]);
        let ahead_left = add(ahead, AHEAD[left]);
        let (next, next_side) = if inside(ahead_left[0], ahead_left[1]) {
            (ahead_left, left)
        } else if inside(ahead[0], ahead[1]) {
            (ahead, side)
        } else {
            (pixel, (side + 1) % 4)
        };
        visit(&Step { pixel, side, end: add(pixel, END[side]), turns: next_side != side });
        (pixel, side) = (next, next_side);
        if (pixel, side) == (start, 0) {
            return;
        }
    }
}
