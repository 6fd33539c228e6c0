//! The frames that the eye can distinguish.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;

/// Largest invisible error, as a part of the longer side of the cell: a quarter of a pixel in a
/// thousand.
pub(super) const UNSEEN: f64 = 1.0 / 4000.0;

/// Largest number of frames between two that are kept, if they fit.
const LONGEST: usize = 12;

/// Points below which a cell is not made coarser still: frames are left out instead.
const COARSE: usize = 900;

/// A cell as it may be drawn.
pub(super) struct Candidate<T> {
    pub(super) drawn: T,
    /// Number of its points.
    pub(super) points: usize,
    /// Bytes of each frame.
    pub(super) bytes: usize,
    /// How far all points have moved from rest in each frame, um.
    pub(super) displacements: Vec<Vec<f32>>,
}

/// A cell that is small enough.
pub(super) struct Fitted<T> {
    pub(super) drawn: T,
    pub(super) displacements: Vec<Vec<f32>>,
    /// Which frames are kept.
    pub(super) kept: Vec<usize>,
    /// Tolerance of positions between frames, um.
    pub(super) tolerance: f64,
}

/// A cell and frames that fit into some bytes: first the cell is made coarser, from `coarser` on, then frames are left out.
pub(super) fn fitted<T>(
    times: &[f64],
    mut coarser: u32,
    mut tolerance: f64,
    budget: usize,
    candidate: impl Fn(u32) -> Candidate<T>,
) -> Fitted<T> {
    let mut longest = LONGEST;
    loop {
        let Candidate { drawn, points, bytes, displacements } = candidate(coarser);
        loop {
            let kept = kept(times, &displacements, tolerance, longest);
            if kept.len() * bytes <= budget || kept.len() <= 2 {
                return Fitted { drawn, displacements, kept, tolerance };
            }
            if points > COARSE {
                break;
            }
            // This ends with two frames at the latest.
            tolerance *= 1.5;
            longest = longest * 3 / 2;
        }
        coarser += 1;
    }
}

/// Displacements of the kept frames in steps of 16 bits, and the step, um.
pub(super) fn quantised<T>(fitted: &Fitted<T>) -> (String, f64) {
    let moved = || fitted.kept.iter().flat_map(|&at| &fitted.displacements[at]);
    let furthest = moved().fold(0.0_f32, |most, value| most.max(value.abs()));
    let step = (f64::from(furthest) / f64::from(i16::MAX)).max(1e-9);
    (packed(moved().map(|&value| ((f64::from(value) / step).round() as i16).to_le_bytes())), step)
}

/// Bytes as text.
pub(super) fn packed<const N: usize>(numbers: impl Iterator<Item = [u8; N]>) -> String {
    STANDARD.encode(numbers.flatten().collect::<Vec<u8>>())
}

/// The frames to keep, so that every point of the others lies within `tolerance` um of the straight
/// line between the two around it: as few as a search over the next `longest` frames finds, the
/// first and last included.
fn kept(times: &[f64], displacements: &[Vec<f32>], tolerance: f64, longest: usize) -> Vec<usize> {
    let Some(last) = times.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![0];
    let mut from = 0;
    while from < last {
        let furthest = (from + longest).min(last);
        let mut rates = Rates::new(displacements[from].len());
        let mut to = from + 1;
        while to < furthest {
            let from_start = |at: usize| (times[at] - times[from]) as f32;
            let start = &displacements[from];
            rates.narrow(start, &displacements[to], from_start(to), tolerance as f32);
            if !rates.allow(start, &displacements[to + 1], from_start(to + 1)) {
                break;
            }
            to += 1;
        }
        kept.push(to);
        from = to;
    }
    kept
}

/// For each number, the slopes of the straight lines from the start that pass all values so far within the tolerance.
struct Rates {
    low: Vec<f32>,
    high: Vec<f32>,
}

impl Rates {
    fn new(count: usize) -> Self {
        Self { low: vec![f32::NEG_INFINITY; count], high: vec![f32::INFINITY; count] }
    }

    fn narrow(&mut self, start: &[f32], now: &[f32], after: f32, tolerance: f32) {
        let per = after.recip();
        let bounds = self.low.iter_mut().zip(&mut self.high);
        for ((low, high), (start, now)) in bounds.zip(start.iter().zip(now)) {
            let (least, most) = ((now - start - tolerance) * per, (now - start + tolerance) * per);
            // No number here is NaN, for which `max` and `min` would cost more.
            *low = if least > *low { least } else { *low };
            *high = if most < *high { most } else { *high };
        }
    }

    fn allow(&self, start: &[f32], now: &[f32], after: f32) -> bool {
        let per = after.recip();
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(start.iter().zip(now)).all(|((low, high), (start, now))| {
            let rate = (now - start) * per;
            (*low..=*high).contains(&rate)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_way_needs_its_ends_only_and_a_bend_is_kept() {
        let times: Vec<f64> = (0..11).map(f64::from).collect();
        let straight: Vec<Vec<f32>> = times.iter().map(|&t| vec![t as f32]).collect();
        assert_eq!(kept(&times, &straight, 1e-3, LONGEST), [0, 10]);
        let bent: Vec<Vec<f32>> = times.iter().map(|&t| vec![(t - 5.0).abs() as f32]).collect();
        assert_eq!(kept(&times, &bent, 1e-3, LONGEST), [0, 5, 10]);
        assert_eq!(kept(&times, &bent, 10.0, LONGEST), [0, 10]);
        assert_eq!(kept(&times, &bent, 10.0, 4), [0, 4, 8, 10]);
        assert!(kept(&[], &[], 1.0, LONGEST).is_empty());
    }
}
