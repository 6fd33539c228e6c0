//! Measured curves, and the assumptions made when they were read.

use crate::analysis::kind::Kind;

/// A measured curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Name of its column or row in the file, or its number.
    pub name: String,
    /// Kind of its values.
    pub kind: Kind,
    /// Unit of the values: `um`, `px`, `%`, `nN`, `kPa`, `fJ`, `uM`, `mV`, `a.u.`, or nothing for pure numbers.
    pub unit: &'static str,
    /// Times in ms, increasing: those of the file, or frame number over frame rate, from 0 on.
    pub times_ms: Vec<f64>,
    /// Values, one per time.
    pub values: Vec<f64>,
    /// Line of the file that each value was read from, counted from 1.
    pub lines: Vec<u64>,
    /// Times of stimuli on the same clock, ms, if the file has marks of a pacer.
    pub stimuli_ms: Vec<f64>,
}

impl Curve {
    /// Returns the frame rate in frames per second, the inverse of the median interval; `None` for
    /// fewer than two frames.
    pub fn frame_rate_per_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.times_ms.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        Some(1e3 / steps.get(steps.len() / 2)?)
    }

    /// Returns the part of the curve from one time to another, in ms on its own clock; `None`
    /// stands for its start or end.
    ///
    /// # Errors
    /// A part without a frame, or an end that is not after its start; the message states when the
    /// recording begins and ends.
    pub fn part(mut self, from_ms: Option<f64>, until_ms: Option<f64>) -> Result<Self, String> {
        let (Some(first), Some(last)) = (self.times_ms.first(), self.times_ms.last()) else {
            return Ok(self);
        };
        let (from, until) = (from_ms.unwrap_or(*first), until_ms.unwrap_or(*last));
        let keep: Vec<bool> =
            self.times_ms.iter().map(|time| (from..=until).contains(time)).collect();
        if !keep.contains(&true) {
            return Err(format!(
                "`{}` has no values from {from} to {until} ms; the recording runs from {first} to {last} ms",
                self.name
            ));
        }
        let mut kept = keep.iter();
        self.times_ms.retain(|_| kept.next() == Some(&true));
        let mut kept = keep.iter();
        self.values.retain(|_| kept.next() == Some(&true));
        let mut kept = keep.iter();
        self.lines.retain(|_| kept.next() == Some(&true));
        let part = from_ms.unwrap_or(f64::NEG_INFINITY)..=until_ms.unwrap_or(f64::INFINITY);
        self.stimuli_ms.retain(|time| part.contains(time));
        Ok(self)
    }
}

/// The curves of a file.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Curves in the order of the file; at least one.
    pub curves: Vec<Curve>,
    /// What was detected and assumed, as sentences for users.
    pub notes: Vec<String>,
}
