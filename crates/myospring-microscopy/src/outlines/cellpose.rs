//! Cellpose's `_outlines.txt`: one cell a line, `x1,y1,x2,y2,...`, as its `io.outlines_to_text` writes.
//!
//! The points are the pixels of the cell's edge, in whole numbers from the top left, each a
//! neighbour of the one before. These pixels belong to the cell, so a ring through their centres
//! would be half a pixel too small on all sides. Therefore the ring is filled and traced; the
//! outline is that of Cellpose's own mask, without its holes.

use super::raster::{fill, no_pixel, part};
use super::trace::{follow, trace};
use super::{
    CoordinateUnit, MOST_OUTLINES, MOST_POINTS, NamedOutline, OutlineFileError, OutlineWriteError,
    PixelFrame, Raw,
};

/// Largest number of pixels in the bounding box of a cell.
const MOST_PIXELS: usize = 100_000_000;

/// Reads all cells; they are named by the number of their line. Empty lines, which Cellpose writes for
/// cells of a few pixels, are skipped.
pub(super) fn read(bytes: &[u8]) -> Result<Vec<Raw>, OutlineFileError> {
    let text = std::str::from_utf8(bytes).map_err(|error| OutlineFileError::PointList {
        line: 1,
        problem: format!("bytes that are no text ({error})"),
    })?;
    let mut outlines = Vec::new();
    for (index, line) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let wrong = |problem| OutlineFileError::PointList { line: index + 1, problem };
        let points = points(line).map_err(wrong)?;
        let ring = match chain(&points) {
            Some(chain) => around(&chain).map_err(wrong)?,
            // Edited or thinned out: a ring through pixel centres.
            None => points.iter().map(|point| point.map(|value| value + 0.5)).collect(),
        };
        let name = (index + 1).to_string();
        outlines.push(Raw { name, unit: CoordinateUnit::Pixel, rings: vec![ring] });
        if outlines.len() > MOST_OUTLINES {
            let (what, found) = ("outlines", outlines.len());
            return Err(OutlineFileError::TooMany { what, found, bound: MOST_OUTLINES });
        }
    }
    Ok(outlines)
}

fn points(line: &str) -> Result<Vec<[f64; 2]>, String> {
    let mut numbers = Vec::new();
    for field in line.trim().trim_end_matches(',').split(',') {
        let field = field.trim();
        match field.parse::<f64>() {
            Ok(number) if number.is_finite() => numbers.push(number),
            _ => {
                let shown: String = field.chars().take(20).collect();
                return Err(format!("`{shown}` where a number should be"));
            }
        }
        if numbers.len() > 2 * MOST_POINTS {
            return Err(format!("more than {MOST_POINTS} points"));
        }
    }
    if numbers.len() % 2 == 1 {
        return Err(format!("{} numbers, an odd count", numbers.len()));
    }
    Ok(numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect())
}

/// The points as pixels, if they are whole and each touches the one before.
fn chain(points: &[[f64; 2]]) -> Option<Vec<[isize; 2]>> {
    const LARGEST: f64 = 1e6;
    let whole = |value: f64| value.fract() == 0.0 && (0.0..=LARGEST).contains(&value);
    let touch = |(p, q): (&[f64; 2], &[f64; 2])| (0..2).all(|k| (p[k] - q[k]).abs() <= 1.0);
    let all_whole = points.iter().flatten().all(|&value| whole(value));
    let closed = points.iter().zip(points.iter().cycle().skip(1)).all(touch);
    (all_whole && closed)
        .then(|| points.iter().map(|point| point.map(|value| value as isize)).collect())
}

/// The outline, along pixel edges, of the pixels on and within a closed chain of pixels.
fn around(chain: &[[isize; 2]]) -> Result<Vec<[f64; 2]>, String> {
    let ends = |axis: usize| {
        let values = || chain.iter().map(|point| point[axis]);
        [values().min().unwrap_or(0), values().max().unwrap_or(0)]
    };
    let ([left, right], [top, bottom]) = (ends(0), ends(1));
    let (width, height) = ((right - left + 1) as usize, (bottom - top + 1) as usize);
    if width.saturating_mul(height) > MOST_PIXELS {
        return Err(format!("a cell of {width} x {height} pixels, more than {MOST_PIXELS}"));
    }
    let middle = |&[x, y]: &[isize; 2]| [(x - left) as f64 + 0.5, (y - top) as f64 + 0.5];
    let ring: Vec<[f64; 2]> = chain.iter().map(middle).collect();
    let mut inside = fill(&[ring], width, height);
    for &[x, y] in chain {
        inside[(y - top) as usize * width + (x - left) as usize] = true;
    }
    let rings = trace(width, height, &inside).map_err(|error| error.to_string())?;
    let exterior = rings.into_iter().next().unwrap_or_default();
    let shift = [left as f64, top as f64];
    Ok(exterior.into_iter().map(|[x, y]| [x + shift[0], y + shift[1]]).collect())
}

/// Writes outlines as Cellpose does, in the pixels of a picture; holes are lost.
///
/// If the pixels of an outline are not connected, the part nearest to the top is written.
///
/// # Errors
/// An outline that covers no pixel of the picture.
///
/// # Example
/// ```
/// use myospring::mesh::{outline::Outline, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{NamedOutline, PixelFrame, write_cellpose};
/// let corners = vec![[1.0, 1.0], [4.0, 1.0], [4.0, 3.0], [1.0, 3.0]];
/// let cell = NamedOutline { name: "1".to_owned(), outline: Outline::new(corners, vec![])? };
/// let text = write_cellpose(&[cell], &PixelFrame::new(10, 8, PixelSize::new(1.0)?)?)?;
/// assert_eq!(text, "1,5,2,5,3,5,3,6,2,6,1,6\n");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_cellpose(
    cells: &[NamedOutline],
    frame: &PixelFrame,
) -> Result<String, OutlineWriteError> {
    let mut text = String::new();
    for cell in cells {
        let part = part(&cell.outline, frame).ok_or_else(|| no_pixel(cell, frame))?;
        let [left, top] = [part.left, part.top].map(usize::cast_signed);
        let (width, height) = (part.width.cast_signed(), part.height().cast_signed());
        let within = |x: isize, y: isize| {
            let (x, y) = (x - left, y - top);
            (0..width).contains(&x)
                && (0..height).contains(&y)
                && part.inside[y as usize * part.width + x as usize]
        };
        let first = part.inside.iter().position(|&inside| inside).unwrap_or(0);
        let start =
            [left + (first % part.width).cast_signed(), top + (first / part.width).cast_signed()];
        let mut chain: Vec<[isize; 2]> = Vec::new();
        follow(start, within, |step| chain.push(step.pixel));
        chain.dedup();
        while chain.len() > 1 && chain.first() == chain.last() {
            chain.pop();
        }
        let numbers: Vec<String> = chain.iter().flatten().map(ToString::to_string).collect();
        text.push_str(&numbers.join(","));
        text.push('\n');
    }
    Ok(text)
}
