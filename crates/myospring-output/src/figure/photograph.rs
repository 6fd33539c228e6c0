//! Prepares a part of a picture for embedding in a figure.

use super::FigureError;
use super::raster::grey_png;
use super::sheet::Picture;
use myospring_core::analysis::order::quantile;

/// Longest side of an embedded picture, pixels.
const LONGEST: f64 = 1600.0;

/// Parts of the pixels that become black and white, so that a few hot pixels or a speck of dirt do
/// not darken the cell.
const DARKEST: f64 = 0.005;
const BRIGHTEST: f64 = 0.998;

/// Number of values from which percentiles are computed.
const LOOKED_AT: usize = 100_000;

/// A part of a picture.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Part<'a> {
    /// Grey values of the whole picture row by row from the top left.
    pub(crate) values: &'a [f32],
    /// Its columns.
    pub(crate) width: usize,
    /// First column of the part, and the one after its last.
    pub(crate) columns: [usize; 2],
    /// First row of the part from the top, and the one after its last.
    pub(crate) rows: [usize; 2],
}

impl<'a> Part<'a> {
    fn lines(&self) -> impl Iterator<Item = &'a [f32]> + Clone {
        let Self { values, width, columns: [left, right], rows: [top, bottom] } = *self;
        values.chunks_exact(width).take(bottom).skip(top).map(move |row| &row[left..right])
    }

    /// The values that become black and white.
    pub(crate) fn ends(&self) -> [f32; 2] {
        percentiles(self.lines())
    }
}

/// Scales a part of a picture to at most about `wanted` pixels of width.
pub(crate) fn embedded(part: &Part<'_>, wanted: f64) -> Result<Picture, FigureError> {
    between(part, part.ends(), wanted, u8::MAX)
}

/// The same with given values for black and white, and about `levels` of grey above black, which makes the file smaller.
pub(crate) fn between(
    part: &Part<'_>,
    [low, high]: [f32; 2],
    wanted: f64,
    levels: u8,
) -> Result<Picture, FigureError> {
    let Part { columns: [left, right], rows: [top, bottom], .. } = *part;
    let scale = if high > low { 255.0 / (high - low) } else { 0.0 };
    let flat = if high > low { 0.0 } else { 96.0 };
    let grey: Vec<u8> = part
        .lines()
        .flatten()
        // NaN becomes black.
        .map(|value| ((value - low) * scale + flat).clamp(0.0, 255.0).round() as u8)
        .collect();
    let from = [right - left, bottom - top];
    // No more pixels than will be visible.
    let factor = (wanted / from[0] as f64).min(LONGEST / from[0].max(from[1]) as f64);
    let to = from.map(|length| ((length as f64 * factor.min(1.0)).round() as usize).max(1));
    let mut grey = if to == from { grey } else { reduced(&grey, from, to) };
    if levels < u8::MAX {
        let step = f64::from(u8::MAX) / f64::from(levels.max(1));
        let coarse = |level: &mut u8| *level = ((f64::from(*level) / step).round() * step) as u8;
        grey.iter_mut().for_each(coarse);
    }
    let size = to.map(|length| length as u32);
    let png = grey_png(size, &grey)?;
    Ok(Picture { size, grey, png })
}

/// Reduces the number of columns and rows; each new value is the mean over the area that it covers.
fn reduced(grey: &[u8], from: [usize; 2], to: [usize; 2]) -> Vec<u8> {
    let columns: Vec<Vec<(usize, f64)>> =
        (0..to[0]).map(|column| covered(column, from[0], to[0])).collect();
    let mut smaller = Vec::with_capacity(to[0] * to[1]);
    let mut line = vec![0.0; from[0]];
    for row in 0..to[1] {
        line.fill(0.0);
        for (old_row, part) in covered(row, from[1], to[1]) {
            for (sum, &level) in line.iter_mut().zip(&grey[old_row * from[0]..]) {
                *sum += part * f64::from(level);
            }
        }
        smaller.extend(columns.iter().map(|covered| {
            covered.iter().map(|&(column, part)| part * line[column]).sum::<f64>().round() as u8
        }));
    }
    smaller
}

/// The pixels of a line of `from` that pixel `index` of `to` covers, each with its fraction.
fn covered(index: usize, from: usize, to: usize) -> Vec<(usize, f64)> {
    let size = from as f64 / to as f64;
    let [start, end] = [index, index + 1].map(|edge| edge as f64 * size);
    (start as usize..(end.ceil() as usize).min(from))
        .map(|old| (old, (end.min((old + 1) as f64) - start.max(old as f64)) / size))
        .collect()
}

/// The values that become black and white.
fn percentiles<'a>(rows: impl Iterator<Item = &'a [f32]> + Clone) -> [f32; 2] {
    let count: usize = rows.clone().map(<[f32]>::len).sum();
    // An odd step does not sample the same columns in every row of even width.
    let step = (count / LOOKED_AT) | 1;
    let seen = rows.flatten().copied().step_by(step).filter(|value| value.is_finite());
    [DARKEST, BRIGHTEST].map(|part| quantile(seen.clone(), part).unwrap_or(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smaller_picture_has_the_means_of_what_its_pixels_cover() {
        assert_eq!(reduced(&[0, 10, 20, 30, 40, 50, 60, 70], [4, 2], [2, 1]), [25, 45]);
        // 3 to 2: one and a half pixels each.
        assert_eq!(reduced(&[0, 90, 240], [3, 1], [2, 1]), [30, 190]);
        assert_eq!(reduced(&[200; 7 * 5], [7, 5], [3, 2]), [200; 6]);
    }
}
