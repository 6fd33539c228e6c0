//! The part of the picture that a cell covers while it moves.

use super::cell::{CellMotion, spacing};
use crate::outlines::PixelFrame;
use crate::region::Region;

/// Points of a lattice that are grown by this part of their spacing have no gaps.
const CLOSED: f64 = 0.75;

impl CellMotion {
    /// For each pixel of the film, row by row from the top left, whether the cell covers it in any frame, or lies within a margin (um)
    /// of it.
    pub fn covered(&self, frame: &PixelFrame, margin_um: f64) -> Vec<bool> {
        let (width, height) = (frame.width(), frame.height());
        let mut seen = vec![false; width * height];
        for (at, stage) in self.stage_um.iter().enumerate() {
            let [xs, ys] = self.positions(at);
            for (x, y) in xs.iter().zip(&ys) {
                let [column, row] = frame.to_pixels([x + stage[0], y + stage[1]]).map(f64::floor);
                if (0.0..width as f64).contains(&column) && (0.0..height as f64).contains(&row) {
                    seen[row as usize * width + column as usize] = true;
                }
            }
        }
        let [gap, margin] =
            [CLOSED * spacing(&self.mesh), margin_um].map(|um| um / frame.pixel_size().um());
        let points = Region::new(width, height, seen.into_iter());
        points.grown(gap + margin).shrunk(gap).inside().collect()
    }
}
