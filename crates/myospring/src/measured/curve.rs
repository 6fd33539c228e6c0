//! Measured curves, and what was taken for granted of them.

use crate::analysis::kind::Kind;

/// A measured curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its column, or row, as the file calls it, or by number.
    pub name: String,
    /// What its values are.
    pub kind: Kind,
    /// Unit of the values: `um`, `px`, `%`, `nN`, `kPa`, `uM`, `mV`, `a.u.`, or nothing for pure numbers.
    pub unit: &'static str,
    /// Times in ms, rising; as the file has them, or frames over the frame rate from 0 on.
    pub times_ms: Vec<f64>,
    /// A value for each time.
    pub values: Vec<f64>,
    /// The line of the file that each value stands in, from 1.
    pub lines: Vec<u64>,
    /// When a pacer stimulated, ms on the same clock, where the file has marks of one.
    pub stimuli_ms: Vec<f64>,
}

impl Curve {
    /// Frames a second: the inverse of the median time between them; `None` of less than two.
    pub fn frame_rate_per_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.times_ms.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        Some(1e3 / steps.get(steps.len() / 2)?)
    }

    /// The part from one time to another, ms on its own clock; `None` takes what there is.
    ///
    /// # Errors
    /// A part without a frame, or an end that does not come after its start; with when the recording begins and ends.
    pub fn part(mut self, from_ms: Option<f64>, until_ms: Option<f64>) -> Result<Self, String> {
        let (Some(first), Some(last)) = (self.times_ms.first(), self.times_ms.last()) else {
            return Ok(self);
        };
        let (from, until) = (from_ms.unwrap_or(*first), until_ms.unwrap_or(*last));
        let keep: Vec<bool> =
            self.times_ms.iter().map(|time| (from..=until).contains(time)).collect();
        if !keep.contains(&true) {
            return Err(format!(
                "nothing of `{}` lies from {from} to {until} ms; the recording runs from {first} to {last} ms",
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
    /// In the order of the file; at least one.
    pub curves: Vec<Curve>,
    /// What was found and taken for granted, as sentences for people.
    pub notes: Vec<String>,
}
