//! A part of a frame.

use crate::plane::Plane;

/// A rectangle cut out of a frame.
pub(super) struct Window {
    pub(super) plane: Plane,
    /// Column and row of its upper left pixel in the frame.
    pub(super) first: [usize; 2],
}

impl Window {
    /// The part of a frame within `reach` pixels of a place along each axis.
    pub(super) fn around(plane: &Plane, place: [f64; 2], reach: usize) -> Self {
        let size = [plane.width(), plane.height()];
        let first = Self::origin(plane, place, reach);
        let end = [0, 1].map(|k: usize| {
            let last = place[k].round().max(0.0) as usize + reach + 1;
            last.clamp(first[k] + 1, size[k])
        });
        let width = end[0] - first[0];
        let rows = plane.values().chunks_exact(size[0]).skip(first[1]).take(end[1] - first[1]);
        let values: Vec<f32> =
            rows.flat_map(|row| &row[first[0]..first[0] + width]).copied().collect();
        let cut = Plane::new(width, end[1] - first[1], values);
        Self { plane: cut.unwrap_or_else(|| plane.clone()), first }
    }

    /// Column and row of its upper left pixel.
    pub(super) fn origin(plane: &Plane, place: [f64; 2], reach: usize) -> [usize; 2] {
        let size = [plane.width(), plane.height()];
        [0, 1].map(|k: usize| {
            let middle = place[k].round().max(0.0) as usize;
            middle.saturating_sub(reach).min(size[k] - 1)
        })
    }

    /// A place of the frame in the pixels of the window.
    pub(super) fn own(&self, place: [f64; 2]) -> [f64; 2] {
        [0, 1].map(|k: usize| place[k] - self.first[k] as f64)
    }
}
