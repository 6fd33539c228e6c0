//! Outlines to pixels: masks and label pictures.

use std::ops::Range;

use png::{BitDepth, ColorType, Compression, Encoder};

use super::{NamedOutline, OutlineWriteError, PixelFrame};
use crate::dilation::{Norm, dilated};
use myospring_core::mesh::mask::{Mask, MaskError, Part};
use myospring_core::mesh::outline::Outline;

/// Largest label of a 16-bit picture.
const MOST_LABELS: usize = 65_535;

/// The pixels of a picture whose centres lie within an outline.
///
/// It is the exact inverse of [`super::trace::trace_mask`].
///
/// # Errors
/// An outline that covers no pixel of the picture, or all.
///
/// # Example
/// ```
/// use myospring::mesh::{outline::Outline, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{PixelFrame, raster::rasterise};
/// let corners = vec![[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
/// let outline = Outline::new(corners, vec![])?;
/// let mask = rasterise(&outline, &PixelFrame::new(10, 8, PixelSize::new(0.5)?)?)?;
/// assert_eq!((mask.cell_pixels(), mask.area_um2()), (24, outline.area()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn rasterise(outline: &Outline, frame: &PixelFrame) -> Result<Mask, MaskError> {
    let (width, height) = (frame.width(), frame.height());
    let part = part(outline, frame).ok_or(MaskError::Empty { width, height })?;
    Mask::of_part(width, height, frame.pixel_size(), part)
}

/// The pixels whose centres lie within an outline, in their bounding box; `None` if there are none.
pub(super) fn part(outline: &Outline, frame: &PixelFrame) -> Option<Part> {
    let mut spans = Vec::new();
    within(outline, frame, |row, columns| spans.push((row, columns)));
    // Rows are sorted from the top.
    let (top, last) = (spans.first()?.0, spans.last()?.0);
    let left = spans.iter().map(|(_, columns)| columns.start).min()?;
    let width = spans.iter().map(|(_, columns)| columns.end).max()? - left;
    let mut inside = vec![false; width * (last + 1 - top)];
    for (row, columns) in spans {
        inside[(row - top) * width..][columns.start - left..columns.end - left].fill(true);
    }
    Some(Part { left, top, width, inside })
}

/// The pixels of a picture whose centres lie within an outline: rows from the top, each with ranges
/// of columns that are not empty.
pub(crate) fn within(
    outline: &Outline,
    frame: &PixelFrame,
    visit: impl FnMut(usize, Range<usize>),
) {
    let rings: Vec<Vec<[f64; 2]>> = outline
        .rings()
        .map(|ring| ring.iter().map(|&point| frame.to_pixels(point)).collect())
        .collect();
    spans(&rings, frame.width(), frame.height(), visit);
}

/// The pixels of a picture of this width within a margin (pixels) of some of them, and these, row by row.
pub fn grown(inside: &[bool], width: usize, margin: f64) -> Vec<bool> {
    dilated(inside, width, margin.round() as usize, Norm::Euclid)
}

/// Pixels whose centres lie within rings in pixels, by the even-odd rule: row by row, the centres
/// between the first and second crossing of the row with an edge, the third and fourth, and so on.
pub(super) fn fill(rings: &[Vec<[f64; 2]>], width: usize, height: usize) -> Vec<bool> {
    let mut inside = vec![false; width * height];
    spans(rings, width, height, |row, columns| inside[row * width..][columns].fill(true));
    inside
}

/// The pixels of [`fill`] as ranges of columns that are not empty, row by row from the top.
fn spans(
    rings: &[Vec<[f64; 2]>],
    width: usize,
    height: usize,
    mut visit: impl FnMut(usize, Range<usize>),
) {
    /// An edge from its first row on: the column where it crosses the row, and its change per row.
    struct Edge {
        first: usize,
        end: usize,
        start: [f64; 2],
        slope: f64,
    }
    let row_of = |y: f64| (y - 0.5).ceil().clamp(0.0, height as f64) as usize;
    let mut edges: Vec<Edge> = rings
        .iter()
        .flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)))
        .filter_map(|(&p, &q)| {
            let (p, q) = if p[1] <= q[1] { (p, q) } else { (q, p) };
            let (first, end) = (row_of(p[1]), row_of(q[1]));
            let slope = (q[0] - p[0]) / (q[1] - p[1]);
            (first < end).then_some(Edge { first, end, start: p, slope })
        })
        .collect();
    edges.sort_by_key(|edge| edge.first);

    let mut waiting = edges.iter().peekable();
    let mut active: Vec<&Edge> = Vec::new();
    let mut crossings: Vec<f64> = Vec::new();
    let first = edges.first().map_or(height, |edge| edge.first);
    let end = edges.iter().map(|edge| edge.end).max().unwrap_or(0);
    for row in first..end {
        active.retain(|edge| edge.end > row);
        while let Some(edge) = waiting.next_if(|edge| edge.first == row) {
            active.push(edge);
        }
        let centre = row as f64 + 0.5;
        crossings.clear();
        crossings.extend(
            active.iter().map(|edge| edge.start[0] + (centre - edge.start[1]) * edge.slope),
        );
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let column = |x: f64| (x - 0.5).ceil().clamp(0.0, width as f64) as usize;
            let (from, to) = (column(pair[0]), column(pair[1]));
            if from < to {
                visit(row, from..to);
            }
        }
    }
}

/// Writes the pixels of an outline as an 8-bit PNG: 255 within, 0 outside.
///
/// # Errors
/// An outline that covers no pixel of the picture.
///
/// # Example
/// ```
/// use myospring::mesh::{outline::Outline, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{NamedOutline, PixelFrame, raster::write_mask_png};
/// use myospring::microscopy::{picture::Selection, read::read_picture};
/// let corners = vec![[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
/// let cell = NamedOutline { name: "a".to_owned(), outline: Outline::new(corners, vec![])? };
/// let png = write_mask_png(&cell, &PixelFrame::new(10, 8, PixelSize::new(0.5)?)?)?;
/// let read = read_picture(&png, &Selection::default())?.plane;
/// assert_eq!(read.values().iter().filter(|&&value| value == 255.0).count(), 24);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_mask_png(
    cell: &NamedOutline,
    frame: &PixelFrame,
) -> Result<Vec<u8>, OutlineWriteError> {
    let mut pixels = vec![0; frame.width() * frame.height()];
    paint(cell, frame, &mut pixels, 255)?;
    encode(frame, BitDepth::Eight, &pixels)
}

/// Writes outlines as a label picture, a PNG: the first is 1, the second 2, and so on, the background
/// 0; 8 bits up to 255 outlines, else 16. Where two overlap, the later one is on top.
///
/// # Errors
/// More than 65535 outlines, or one that covers no pixel of the picture.
///
/// # Example
/// ```
/// use myospring::mesh::{outline::Outline, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{NamedOutline, PixelFrame, raster::write_labels_png};
/// let corners = vec![[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
/// let cell = NamedOutline { name: "a".to_owned(), outline: Outline::new(corners, vec![])? };
/// let png = write_labels_png(&[cell], &PixelFrame::new(10, 8, PixelSize::new(0.5)?)?)?;
/// assert!(png.starts_with(b"\x89PNG"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_labels_png(
    cells: &[NamedOutline],
    frame: &PixelFrame,
) -> Result<Vec<u8>, OutlineWriteError> {
    let found = cells.len();
    if found > MOST_LABELS {
        return Err(OutlineWriteError::TooMany { found, bound: MOST_LABELS });
    }
    let size = frame.width() * frame.height();
    if u8::try_from(found).is_ok() {
        let mut labels = vec![0_u8; size];
        for (label, cell) in (1..=u8::MAX).zip(cells) {
            paint(cell, frame, &mut labels, label)?;
        }
        return encode(frame, BitDepth::Eight, &labels);
    }
    let mut labels = vec![0_u16; size];
    for (label, cell) in (1..=u16::MAX).zip(cells) {
        paint(cell, frame, &mut labels, label)?;
    }
    let wide: Vec<u8> = labels.into_iter().flat_map(u16::to_be_bytes).collect();
    encode(frame, BitDepth::Sixteen, &wide)
}

/// A grey PNG of the size of the frame.
fn encode(
    frame: &PixelFrame,
    depth: BitDepth,
    pixels: &[u8],
) -> Result<Vec<u8>, OutlineWriteError> {
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, frame.width() as u32, frame.height() as u32);
    encoder.set_color(ColorType::Grayscale);
    encoder.set_depth(depth);
    encoder.set_compression(Compression::Fast);
    let written = encoder.write_header().and_then(|mut writer| {
        writer.write_image_data(pixels)?;
        writer.finish()
    });
    match written {
        Ok(()) => Ok(bytes),
        Err(error) => Err(OutlineWriteError::Encode { reason: error.to_string() }),
    }
}

/// Sets the pixels within an outline to a value.
fn paint<Value: Copy>(
    cell: &NamedOutline,
    frame: &PixelFrame,
    pixels: &mut [Value],
    value: Value,
) -> Result<(), OutlineWriteError> {
    let mut any = false;
    within(&cell.outline, frame, |row, columns| {
        pixels[row * frame.width()..][columns].fill(value);
        any = true;
    });
    if any { Ok(()) } else { Err(no_pixel(cell, frame)) }
}

/// The error for an outline that covers no pixel of the picture.
pub(super) fn no_pixel(cell: &NamedOutline, frame: &PixelFrame) -> OutlineWriteError {
    OutlineWriteError::NoPixel {
        name: cell.name.clone(),
        width: frame.width(),
        height: frame.height(),
        pixel_size: frame.pixel_size(),
    }
}
