//! What of a cell makes its curve: numbers that are sought, and how it is paced.

/// How a cell is paced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Train {
    /// Beats before those that were recorded.
    pub(super) before: usize,
    /// Those that were.
    pub(super) beats: usize,
    /// From stimulus to stimulus, ms.
    pub(super) cycle: f64,
}

/// A cell with some of its numbers changed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Physics<'a> {
    /// Factor on the peak of tension, over stiffness.
    pub(super) tension: f64,
    /// Factor on every elastic constant.
    pub(super) stiffness: f64,
    /// Values of the parameters that are free, in the order in which they are.
    pub(super) parameters: &'a [f64],
}
