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
}

impl Curve {
    /// Frames a second: the inverse of the median time between them; `None` of less than two.
    pub fn frame_rate_per_s(&self) -> Option<f64> {
        let mut steps: Vec<f64> = self.times_ms.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        Some(1e3 / steps.get(steps.len() / 2)?)
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
