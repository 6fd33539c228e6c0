//! Pixels to outlines: masks and label pictures.
//!
//! Two forms of one outline ([`Edge`]): along the edges of the pixels, which keeps every pixel and the
//! exact area, but whose length is that of a staircase, up to 1.27 times too long on average over all
//! directions; and smooth, which has the right length and direction too and is the one to use where
//! nothing speaks against it.
//!
//! Pixels that touch by a side or a corner are one cell, as for [`Mask::largest_part`]. Where two of
//! them meet in a corner only, the outline has a bridge of 0.001 pixel. Holes are kept.

use image::{ImageBuffer, Luma};
use imageproc::region_labelling::{Connectivity, connected_components};

use super::ring::{CUT, part_touching};
use super::smooth::smooth;
use super::{MOST_HOLES, MOST_OUTLINES, NamedOutline, PixelFrame};
use crate::mesh::mask::Mask;
use crate::mesh::outline::{Outline, OutlineError};
use crate::microscopy::plane::Plane;

/// Most corners that all traced rings may have: a picture of noise has more.
const MOST_CORNERS: usize = 4_000_000;

/// Which form of an outline to make.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Edge {
    /// Through the middles of the pixels' edges, averaged over some of them, and without points that
    /// deviate by less than half a pixel; its area is that of the pixels to 0.5 %. Where that cannot be kept, in cells of a few
    /// pixels, it is the exact one.
    #[default]
    Smooth,
    /// Along the edges of the pixels.
    Exact,
}

/// Why pixels give no outlines.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// A value that is no label.
    #[error(
        "the value {value} at column {column}, row {row} is no label; labels are whole numbers, 0 is \
         the background: is this the picture itself, not its labels?"
    )]
    NotALabel {
        /// The value.
        value: f32,
        /// Its column, 0 is the first.
        column: usize,
        /// Its row, 0 is the top.
        row: usize,
    },
    /// A picture whose size is not that of the frame.
    #[error(
        "the labels have {width} x {height} pixels, but the picture {wanted_width} x {wanted_height}"
    )]
    Size {
        /// Columns of the labels.
        width: usize,
        /// Rows of the labels.
        height: usize,
        /// Columns of the picture.
        wanted_width: usize,
        /// Rows of the picture.
        wanted_height: usize,
    },
    /// Background only.
    #[error("the label picture is empty: all of its pixels are 0, the background")]
    Empty,
    /// More than can be cells.
    #[error(
        "the pixels have {found} {what}, more than {bound}: is this the picture itself, not its \
         labels? Else fill holes and remove specks"
    )]
    TooMany {
        /// Of what.
        what: &'static str,
        /// How many, at least.
        found: usize,
        /// How many there may be.
        bound: usize,
    },
    /// A label whose pixels are no outline.
    #[error("label {label}: {error}")]
    Outline {
        /// The label.
        label: u32,
        /// What is wrong.
        error: OutlineError,
    },
}

/// Outlines of a label picture.
#[derive(Debug, Clone, PartialEq)]
pub struct LabelOutlines {
    /// One outline for each label, by ascending label, which is its name.
    pub outlines: Vec<NamedOutline>,
    /// What was left out: islands beside the largest part of a label, labels smaller than a cell.
    pub notes: Vec<String>,
}

/// Outline of the largest part of a mask, um from the lower left corner of the picture.
///
/// The exact one has the area of the part and gives the mesh that [`crate::mesh::lattice::from_mask`]
/// gives.
///
/// # Errors
/// A part of less than 1 um^2 or more than 10 mm, or with more than [`MOST_HOLES`] holes.
///
/// # Example
/// ```
/// use myospring::mesh::mask::Mask;
/// use myospring::microscopy::outlines::trace::{Edge, trace_mask};
/// let disc = |i: usize| (i % 60).abs_diff(30).pow(2) + (i / 60).abs_diff(30).pow(2) < 600;
/// let mask = Mask::new(60, 60, 0.5, (0..3600).map(disc).collect()).unwrap();
/// let [exact, smooth] = [Edge::Exact, Edge::Smooth].map(|edge| trace_mask(&mask, edge).unwrap());
/// assert!((exact.area() - mask.area_um2()).abs() < 1e-9 * mask.area_um2());
/// // The circle has a radius of 12.25 um; the staircase is as long as the square around
/// // its 49 pixels.
/// assert!((smooth.perimeter() / 77.0 - 1.0).abs() < 0.01);
/// assert_eq!(exact.perimeter(), 98.0);
/// ```
pub fn trace_mask(mask: &Mask, edge: Edge) -> Result<Outline, TraceError> {
    let (part, _) = mask.largest_part();
    let values: Vec<u32> = part.inside().iter().map(|&inside| u32::from(inside)).collect();
    let rings = trace(part.width(), part.height(), &values, 1)?.remove(0);
    outline(rings, &PixelFrame::of(mask), edge, 1)
}

/// Outlines of all islands of a mask, from the top.
///
/// # Errors
/// As [`trace_mask`], for each island; more than [`MOST_OUTLINES`] islands.
///
/// # Example
/// ```
/// use myospring::mesh::mask::Mask;
/// use myospring::microscopy::outlines::trace::{Edge, trace_parts};
/// let mask = Mask::new(3, 1, 2.0, vec![true, false, true]).unwrap();
/// assert_eq!(trace_parts(&mask, Edge::Exact).unwrap().len(), 2);
/// ```
pub fn trace_parts(mask: &Mask, edge: Edge) -> Result<Vec<Outline>, TraceError> {
    let frame = PixelFrame::of(mask);
    let values = mask.inside().iter().map(|&inside| u32::from(inside)).collect();
    let (parts, count) = islands(&frame, values)?;
    trace(frame.width(), frame.height(), &parts, count)?
        .into_iter()
        .map(|rings| outline(rings, &frame, edge, 1))
        .collect()
}

/// Outlines of all labels of a label picture: whole numbers, 0 is the background.
///
/// Of a label in several pieces the largest is taken; what is left out, and labels of less than
/// 1 um^2, stand in the notes.
///
/// # Errors
/// Values that are no labels, no label at all, a size other than the frame's, too many labels, holes
/// or corners, or a label that [`Outline::new`] refuses.
///
/// # Example
/// ```
/// use myospring::microscopy::outlines::{PixelFrame, trace::{Edge, trace_labels}};
/// use myospring::microscopy::plane::Plane;
/// let labels = Plane::new(4, 1, vec![0.0, 5.0, 2.0, 2.0]).unwrap();
/// let traced = trace_labels(&labels, &PixelFrame::new(4, 1, 2.0)?, Edge::Exact)?;
/// let names: Vec<&str> = traced.outlines.iter().map(|cell| cell.name.as_str()).collect();
/// assert_eq!(names, ["2", "5"]);
/// assert_eq!(traced.outlines[1].outline.bounds(), [[2.0, 0.0], [4.0, 2.0]]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn trace_labels(
    labels: &Plane,
    frame: &PixelFrame,
    edge: Edge,
) -> Result<LabelOutlines, TraceError> {
    let (width, height) = (labels.width(), labels.height());
    if (width, height) != (frame.width(), frame.height()) {
        let (wanted_width, wanted_height) = (frame.width(), frame.height());
        return Err(TraceError::Size { width, height, wanted_width, wanted_height });
    }
    let values = whole_numbers(labels)?;
    let (parts, count) = islands(frame, values.clone())?;
    if count == 0 {
        return Err(TraceError::Empty);
    }
    // Label and number of pixels of each island, and for each label its largest island.
    let mut sizes = vec![(0_u32, 0_usize); count];
    for (&part, &label) in parts.iter().zip(&values).filter(|(part, _)| **part > 0) {
        let size = &mut sizes[part as usize - 1];
        *size = (label, size.1 + 1);
    }
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by_key(|&part| (sizes[part].0, std::cmp::Reverse(sizes[part].1), part));
    let mut rings = trace(width, height, &parts, count)?;
    let mut traced = LabelOutlines { outlines: Vec::new(), notes: Vec::new() };
    for group in order.chunk_by(|&a, &b| sizes[a].0 == sizes[b].0) {
        let (label, pixels) = sizes[group[0]];
        if group.len() > 1 {
            let left_out: usize = group[1..].iter().map(|&part| sizes[part].1).sum();
            traced.notes.push(format!(
                "label {label} is in {} pieces; the largest, {pixels} pixels, was taken and {left_out} \
                 pixels were left out",
                group.len()
            ));
        }
        match outline(std::mem::take(&mut rings[group[0]]), frame, edge, label) {
            Ok(outline) => {
                traced.outlines.push(NamedOutline { name: label.to_string(), outline });
            }
            Err(TraceError::Outline { error: OutlineError::TooSmall { area }, .. }) => {
                traced
                    .notes
                    .push(format!("label {label} has only {area:.3} um^2 and was left out"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(traced)
}

fn whole_numbers(labels: &Plane) -> Result<Vec<u32>, TraceError> {
    // Whole numbers up to here are exact in single precision.
    const LARGEST: f32 = 16_777_216.0;
    let whole = |value: f32| (0.0..=LARGEST).contains(&value) && value.fract() == 0.0;
    if let Some(index) = labels.values().iter().position(|&value| !whole(value)) {
        let (column, row) = (index % labels.width(), index / labels.width());
        return Err(TraceError::NotALabel { value: labels.values()[index], column, row });
    }
    Ok(labels.values().iter().map(|&value| value as u32).collect())
}

/// Numbers the islands of equal non-zero values from 1, from the top; and how many there are.
fn islands(frame: &PixelFrame, mut values: Vec<u32>) -> Result<(Vec<u32>, usize), TraceError> {
    // With a row of background below: the library panics where each pixel is an island of its own.
    let pixels = values.len();
    values.resize(pixels + frame.width(), 0);
    let (width, height) = (frame.width() as u32, frame.height() as u32 + 1);
    let Some(picture) = ImageBuffer::<Luma<u32>, _>::from_raw(width, height, values) else {
        return Err(TraceError::Empty);
    };
    let mut parts = connected_components(&picture, Connectivity::Eight, Luma([0])).into_raw();
    parts.truncate(pixels);
    let found = parts.iter().copied().max().unwrap_or(0) as usize;
    if found > MOST_OUTLINES {
        return Err(TraceError::TooMany { what: "islands", found, bound: MOST_OUTLINES });
    }
    Ok((parts, found))
}

/// An outline in um of rings along pixel edges, the exterior first.
fn outline(
    mut rings: Vec<Vec<[f64; 2]>>,
    frame: &PixelFrame,
    edge: Edge,
    label: u32,
) -> Result<Outline, TraceError> {
    let found = rings.len().saturating_sub(1);
    if found > MOST_HOLES {
        return Err(TraceError::TooMany { what: "holes in one cell", found, bound: MOST_HOLES });
    }
    if edge == Edge::Smooth
        && let Some(outline) = smooth(&rings, frame)
    {
        return Ok(outline);
    }
    part_touching(&mut rings, CUT);
    in_um(rings, frame).map_err(|error| TraceError::Outline { label, error })
}

pub(super) fn in_um(
    rings: Vec<Vec<[f64; 2]>>,
    frame: &PixelFrame,
) -> Result<Outline, OutlineError> {
    let mut rings =
        rings.into_iter().map(|ring| ring.into_iter().map(|point| frame.to_um(point)).collect());
    let exterior = rings.next().unwrap_or_default();
    Outline::new(exterior, rings.collect())
}

/// Corners along the pixel edges of every island, the exterior first; islands number from 1.
pub(super) fn trace(
    width: usize,
    height: usize,
    parts: &[u32],
    count: usize,
) -> Result<Vec<Vec<Vec<[f64; 2]>>>, TraceError> {
    let (signed_width, signed_height) = (width.cast_signed(), height.cast_signed());
    let at = |column: isize, row: isize| {
        let inside = (0..signed_width).contains(&column) && (0..signed_height).contains(&row);
        if inside { parts[row as usize * width + column as usize] } else { 0 }
    };
    let mut polygons = vec![Vec::new(); count];
    // Every ring passes the upper side of some pixel, the exterior that of the island's first.
    let mut passed = vec![false; parts.len()];
    let mut corners = 0;
    for (index, &part) in parts.iter().enumerate().filter(|(_, part)| **part > 0) {
        let start = [index % width, index / width].map(usize::cast_signed);
        if passed[index] || at(start[0], start[1] - 1) == part {
            continue;
        }
        let mut ring = Vec::new();
        follow(
            start,
            |column, row| at(column, row) == part,
            |step| {
                if step.side == 0 {
                    passed[step.pixel[1] as usize * width + step.pixel[0] as usize] = true;
                }
                if step.turns {
                    ring.push(step.end.map(|value| value as f64));
                }
            },
        );
        corners += ring.len();
        if corners > MOST_CORNERS {
            let what = "corners of pixels along all edges";
            return Err(TraceError::TooMany { what, found: corners, bound: MOST_CORNERS });
        }
        polygons[part as usize - 1].push(ring);
    }
    Ok(polygons)
}

/// One side of a pixel on the way round.
pub(super) struct Step {
    /// The pixel within: column and row.
    pub(super) pixel: [isize; 2],
    /// Which of its sides: 0 upper, 1 right, 2 lower, 3 left.
    side: usize,
    /// Corner at the end of the side.
    end: [isize; 2],
    /// Whether the way turns there.
    turns: bool,
}

/// Walks once round from the upper side of a pixel, with the inside on the right hand; at a corner
/// where two pixels of the inside meet it goes over to the other one.
pub(super) fn follow(
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
