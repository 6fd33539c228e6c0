//! Recordings that end at a limit of their device: many frames in a row at exactly the lowest or the highest value.

use crate::analysis::order::{median, quantile};

/// Fewest frames in a row.
const IN_A_ROW: usize = 4;
/// Part of the other frames that may equal their neighbour: more do in a curve with few digits, whose tops are flat anyway.
const ALIKE: f64 = 0.2;
/// Least median of third differences, a part of the range: a simulated cell rests without noise.
const NOISE: f64 = 1e-4;
/// Part of the frames at either end of the range that may be single bad ones.
const OUTLIERS: f64 = 0.01;

/// Frames of a curve that are at the limit of its device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Clipped {
    /// The limit.
    pub value: f64,
    /// How many frames are there, four or more in a row.
    pub frames: usize,
    /// Whether it is the lowest value of the curve.
    pub lowest: bool,
}

/// Where a curve is clipped; `None` if it is not, or shows no noise by which that could be told.
///
/// # Example
/// ```
/// use myospring::analysis::curve::clipped;
/// let noise = |at: usize| 0.01 * ((at * at) as f64 * 0.618).fract();
/// let curve: Vec<f64> = (0..300).map(|at| (at as f64 / 20.0).sin() + noise(at)).collect();
/// assert_eq!(clipped(&curve), None);
/// let clip: Vec<f64> = curve.iter().map(|value| value.min(0.8)).collect();
/// let found = clipped(&clip).unwrap();
/// assert!(found.value == 0.8 && !found.lowest && found.frames > 50);
/// ```
pub fn clipped(values: &[f64]) -> Option<Clipped> {
    let known: Vec<f64> = values.iter().copied().filter(|value| value.is_finite()).collect();
    let end = |part: f64| quantile(known.iter().copied(), part);
    let (low, high) = (end(OUTLIERS)?, end(1.0 - OUTLIERS)?);
    let third = |four: &[f64]| (four[3] - 3.0 * four[2] + 3.0 * four[1] - four[0]).abs();
    if median(known.windows(4).map(third))? <= NOISE * (high - low) {
        return None;
    }
    let at = |limit: f64, lowest: bool| {
        let runs = known.chunk_by(|a, b| a == b);
        let flat = |run: &&[f64]| run.len() >= IN_A_ROW && run[0] == limit;
        let frames: usize = runs.filter(flat).map(<[f64]>::len).sum();
        let others = known.windows(2).filter(|pair| pair[0] != limit);
        let alike = others.clone().filter(|pair| pair[0] == pair[1]).count() as f64;
        let few = alike < ALIKE * others.count() as f64;
        (frames > 0 && few).then_some(Clipped { value: limit, frames, lowest })
    };
    at(low, true).into_iter().chain(at(high, false)).max_by_key(|found| found.frames)
}

impl Clipped {
    /// What a reader must know.
    pub fn words(&self, unit: &str) -> String {
        let Self { value, frames, lowest } = self;
        let space = if unit.is_empty() { "" } else { " " };
        format!(
            "{frames} frames are at exactly {value}{space}{unit}, the {} value: the recording is clipped there, and what \
             its frames were is not known",
            if *lowest { "lowest" } else { "highest" }
        )
    }
}
