//! Frames that were written twice.
//!
//! Programs that record or convert a film at another rate repeat frames. A repeated frame is not a
//! measurement: used as one, it suggests that the cell did not move. Camera noise makes any two
//! recorded frames differ, even of a resting cell. So a frame counts as a repeat if it differs from
//! the one before by far less than frames that are *not* near each other, and by far less than all
//! other frames differ from the ones before them. In a compressed film, a repeat is nearly but not
//! exactly identical.
//!
//! In a film without noise, such as a synthetic one, all pictures of the resting cell are
//! identical. Repeats cannot be recognised there, and no frame counts as one.

use super::{Film, FilmError};
use crate::plane::Plane;
use rayon::prelude::*;

/// Largest difference of a repeat from the frame before it, relative to the film's own difference
/// and to the smallest difference of any frame that is not a repeat.
const FAR_BELOW: f32 = 0.25;
/// Differences below this part of the film's own difference count as zero.
const SAME: f32 = 0.01;
/// Largest number of times that programs repeat a frame.
const MOST_REPEATED: usize = 8;
/// The film's own difference is this quantile over its frames.
const OWN: f64 = 0.1;
/// Largest number of frames that are compared with all others, and of values of each.
const MOST_FRAMES: usize = 300;
const MOST_VALUES: usize = 8192;
/// Frames that one thread decodes at a time.
const CHUNK: usize = 32;

impl Film {
    /// For each frame the earlier frame that it repeats; `None` for a frame that was recorded.
    ///
    /// # Errors
    /// A frame that cannot be read.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::film::Film;
    /// use myospring::microscopy::picture::Selection;
    /// // Noise, and one frame that was written twice.
    /// let mut bytes = b"YUV4MPEG2 W4 H4 F50:1 Cmono\n".to_vec();
    /// for frame in [0_u8, 1, 2, 2, 3, 4] {
    ///     bytes.extend(b"FRAME\n");
    ///     bytes.extend((0..16_u8).map(|pixel| (pixel + 1).wrapping_mul(41 * frame + 17) % 97));
    /// }
    /// let film = Film::read(bytes, &Selection::default())?;
    /// assert_eq!(film.repeats()?, [None, None, None, Some(2), None, None]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn repeats(&self) -> Result<Vec<Option<usize>>, FilmError> {
        let starts: Vec<usize> = (0..self.len).step_by(CHUNK).collect();
        let chunks: Vec<Vec<Sampled>> = starts
            .par_iter()
            .map(|&start| self.sampled(start..(start + CHUNK).min(self.len)))
            .collect::<Result<_, _>>()?;
        let frames: Vec<Sampled> = chunks.into_iter().flatten().collect();
        let below = threshold(&frames);
        let mut repeats: Vec<Option<usize>> = Vec::with_capacity(frames.len());
        for (at, frame) in frames.iter().enumerate() {
            let is_one = frame.from_last.is_some_and(|step| step < below);
            repeats.push(is_one.then(|| repeats[at - 1].unwrap_or(at - 1)));
        }
        Ok(repeats)
    }

    fn sampled(&self, range: std::ops::Range<usize>) -> Result<Vec<Sampled>, FilmError> {
        let every = self.len.div_ceil(MOST_FRAMES);
        let mut last = range.start.checked_sub(1).map(|before| self.frame(before)).transpose()?;
        range
            .map(|index| {
                let plane = self.frame(index)?;
                let from_last = last.as_ref().map(|last| difference(last.values(), plane.values()));
                let values = index.is_multiple_of(every).then(|| values(&plane));
                last = Some(plane);
                Ok(Sampled { from_last, values })
            })
            .collect()
    }
}

/// Samples of a frame.
struct Sampled {
    /// Mean size of the difference from the frame before it, grey levels.
    from_last: Option<f32>,
    /// Values at regular places, of the frames that are compared with all others.
    values: Option<Vec<f32>>,
}

/// Difference from the frame before, grey levels, below which a frame is a repeat; 0 if repeats
/// cannot be recognised.
fn threshold(frames: &[Sampled]) -> f32 {
    let own = own_difference(frames);
    let mut steps: Vec<f32> = frames.iter().filter_map(|frame| frame.from_last).collect();
    steps.sort_by(f32::total_cmp);
    // There must be a gap between the differences of repeats and all others. Slow drift, with small
    // differences, leaves no such gap.
    let nothing = SAME * own;
    let gap = |pair: &[f32]| pair[1] / pair[0].max(nothing);
    let below = steps.windows(2).filter(|pair| pair[0] < FAR_BELOW * own);
    match below.max_by(|a, b| gap(a).total_cmp(&gap(b))) {
        Some(pair) if gap(pair) >= FAR_BELOW.recip() => 0.5 * (pair[0].max(nothing) + pair[1]),
        _ => 0.0,
    }
}

/// The film's own difference, grey levels: how much frames differ that are not close in time. For
/// each frame the smallest difference from all frames farther away than programs repeat a frame; of
/// these, the quantile [`OWN`]. With noise this is the noise; without noise it is 0 if the cell
/// returns to rest.
fn own_difference(frames: &[Sampled]) -> f32 {
    let apart = (frames.len() / 4).clamp(2, MOST_REPEATED);
    let kept: Vec<(usize, &[f32])> = (frames.iter().enumerate())
        .filter_map(|(at, frame)| Some((at, frame.values.as_deref()?)))
        .collect();
    let mut least: Vec<f32> = kept
        .par_iter()
        .map(|&(at, values)| {
            let others = kept.iter().filter(|(other, _)| other.abs_diff(at) >= apart);
            let from = others.map(|(_, others)| difference(values, others));
            from.fold(f32::INFINITY, f32::min)
        })
        .filter(|difference| difference.is_finite())
        .collect();
    least.sort_by(f32::total_cmp);
    least.get((least.len() as f64 * OWN) as usize).copied().unwrap_or(0.0)
}

/// Mean absolute difference.
fn difference(one: &[f32], other: &[f32]) -> f32 {
    let (a, b) = (one.as_chunks::<8>(), other.as_chunks::<8>());
    let mut sums = [0.0_f32; 8];
    for (a, b) in a.0.iter().zip(b.0) {
        for at in 0..8 {
            sums[at] += (a[at] - b[at]).abs();
        }
    }
    let more: f32 = a.1.iter().zip(b.1).map(|(a, b)| (a - b).abs()).sum();
    (sums.iter().sum::<f32>() + more) / one.len() as f32
}

/// Values of a frame at regular places.
fn values(plane: &Plane) -> Vec<f32> {
    let step = (plane.values().len() as f64 / MOST_VALUES as f64).sqrt().ceil().max(1.0) as usize;
    let rows = plane.values().chunks_exact(plane.width()).step_by(step);
    rows.flat_map(|row| row.iter().step_by(step)).copied().collect()
}
