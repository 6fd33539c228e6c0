//! Directions and periods that a picture shows at the places of a grid.

use super::grid::Grid;
use super::window::Window;

/// Where the grid lies.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Place {
    pub(super) grid: Grid,
    /// Side of a block, um.
    pub(super) block_um: f64,
    /// Upper left corner, um, y upward.
    pub(super) corner_um: [f64; 2],
    /// Part of each block that is the cell.
    pub(super) share: Vec<f32>,
}

impl Place {
    /// A grid of square blocks over a window; `block` is the side of one in pixels.
    pub(super) fn over(window: &Window, block: usize) -> Self {
        let [columns, rows] = window.size;
        let grid = Grid::over(window.size, block.clamp(1, columns.max(rows)));
        let mut share = grid.zeros();
        let mut line = vec![0.0; columns];
        for (row, inside) in window.inside.chunks_exact(columns).enumerate() {
            for (weight, &inside) in line.iter_mut().zip(inside) {
                *weight = if inside { 1.0 } else { 0.0 };
            }
            grid.add_row(&mut share, row, &line);
        }
        let pixels = (grid.block * grid.block) as f32;
        for count in &mut share {
            *count /= pixels;
        }
        let block_um = window.pixel_um * grid.block as f64;
        Self { grid, block_um, corner_um: window.corner_um, share }
    }
}

/// Direction and period at one place.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(super) struct Reading {
    /// Unit vector at twice the angle of the fibre; zero where there is none.
    pub(super) doubled: [f32; 2],
    /// Weight of the picture relative to the long axis, 0 to 1.
    pub(super) part: f32,
    /// How sharply the picture shows one direction (and, of stripes, one period), 0 to 1.
    pub(super) order: f32,
    /// Period of the stripes along the fibre, um.
    pub(super) sarcomere_um: Option<f32>,
}

/// Directions and periods that a picture shows over a cell.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Readings {
    pub(super) place: Place,
    /// One for each block of the grid.
    pub(super) at: Vec<Reading>,
}

impl Readings {
    /// The same places without directions.
    pub(super) fn emptied(self) -> Self {
        let at = vec![Reading::default(); self.at.len()];
        Self { at, ..self }
    }

    /// Part of the cell in which the picture has the larger weight.
    pub(super) fn answered_share(&self) -> f64 {
        let (mut answered, mut area) = (0.0, 0.0);
        for (reading, &share) in self.at.iter().zip(&self.place.share) {
            area += f64::from(share);
            answered += if reading.part >= 0.5 { f64::from(share) } else { 0.0 };
        }
        if area > 0.0 { answered / area } else { 0.0 }
    }
}
