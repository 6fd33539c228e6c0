//! Gaps in the times of a curve: missing frames.

use super::order::median;

/// Interval between frames, relative to the usual one, from which on it is a gap; a single lost
/// frame is not.
const LONG: f64 = 2.5;

/// Least part of the intervals near the usual one if frames come regularly; if they do not (as in a
/// curve digitised by hand), there are no gaps.
const REGULAR: f64 = 0.75;

/// Least number of intervals from which a usual one is determined.
const ENOUGH: usize = 7;

/// Two neighbouring frames between which others are missing.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Hole {
    /// The frame before it, from 1.
    pub after_frame: usize,
    /// Time of the frame before it, ms.
    pub from_ms: f64,
    /// Time of the frame after it, ms.
    pub to_ms: f64,
    /// The usual time between frames, ms.
    pub usual_ms: f64,
}

impl Hole {
    /// Its length, ms.
    pub fn length_ms(&self) -> f64 {
        self.to_ms - self.from_ms
    }
}

/// The gaps in ascending times, ms: intervals of more than 2.5 times the usual one, if three
/// quarters of the intervals differ from it by less than a half.
///
/// # Example
/// ```
/// use myospring::analysis::holes::of;
/// let times: Vec<f64> = (0..100).filter(|i| !(40..60).contains(i)).map(|i| 4.0 * f64::from(i)).collect();
/// let holes = of(&times);
/// assert_eq!((holes.len(), holes[0].from_ms, holes[0].to_ms), (1, 156.0, 240.0));
/// assert!(of(&[0.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 400.0]).is_empty());
/// ```
pub fn of(times: &[f64]) -> Vec<Hole> {
    let intervals: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let enough = intervals.len() >= ENOUGH;
    let Some(usual_ms) = median(intervals.iter().copied()).filter(|_| enough) else {
        return Vec::new();
    };
    let near = intervals.iter().filter(|own| (0.5..=1.5).contains(&(**own / usual_ms))).count();
    if (near as f64) < REGULAR * intervals.len() as f64 {
        return Vec::new();
    }
    let long = intervals.iter().enumerate().filter(|(_, own)| **own > LONG * usual_ms);
    long.map(|(at, _)| Hole {
        after_frame: at + 1,
        from_ms: times[at],
        to_ms: times[at + 1],
        usual_ms,
    })
    .collect()
}
