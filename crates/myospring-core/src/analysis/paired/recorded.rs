//! Curves that are paired.

use crate::analysis::curve::Analysis;
use crate::analysis::kind::Kind;

/// An analysed curve.
#[derive(Debug, Clone, Copy)]
pub struct Recorded<'a> {
    /// Times of its frames, ms.
    pub times_ms: &'a [f64],
    /// Kind of its values.
    pub kind: Kind,
    /// Their unit.
    pub unit: &'static str,
    /// Its beats.
    pub analysis: &'a Analysis,
}

impl Recorded<'_> {
    /// Its first and last time, ms.
    pub(super) fn span(&self) -> [f64; 2] {
        let end = |time: Option<&f64>| time.copied().unwrap_or(f64::NAN);
        [end(self.times_ms.first()), end(self.times_ms.last())]
    }
}
