//! How high a cell is above each place of its outline.
//!
//! From an outline alone the thickness is not known; a profile assumes it. Poisson's equation
//!
//! ```text
//! d2 phi/dx2 + d2 phi/dy2 = -2 inside,        phi = 0 on the outline
//! ```
//!
//! has the solution `b^2 - y^2` on a strip of half width `b`, and on an ellipse one that falls from the middle like `1 - x^2/a^2 -
//! y^2/b^2`. With the square root of it as half thickness, a strip has an elliptic section, and an ellipse becomes an ellipsoid.

use super::coverage::{Grid, Source};
use serde::Serialize;

/// How the thickness of a cell varies over its outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Profile {
    /// Rounded above and below: an elliptic section.
    Round,
    /// Rounded above, flat below: a cell that adheres to what it lies on.
    Dome,
    /// The same thickness everywhere.
    Slab,
}

/// Squares of the finer raster along a square of the lattice, at least.
const FINER: usize = 4;
/// Squares of the raster across the cell, about.
const ACROSS: f64 = 80.0;
/// The largest number of squares of a raster.
const MOST: f64 = 4e6;
/// Part of the first residual that is left.
const SOLVED: f64 = 1e-6;
/// Largest number of rounds of conjugate gradients: some times the squares across a cell are enough.
const ROUNDS: usize = 10_000;

/// Lower and upper face of a cell over the squares of a raster that is finer than the lattice.
pub(super) struct Heights {
    /// Squares of the raster along one of the lattice.
    pub(super) finer: usize,
    /// Squares of the raster along x.
    pub(super) columns: usize,
    /// Part of each square that is inside the outline, from 0 to 1.
    pub(super) inside: Vec<f64>,
    /// Height of the lower and upper face above the lowest point, um.
    pub(super) faces: Vec<[f64; 2]>,
}

impl Profile {
    /// All profiles.
    pub const ALL: [Self; 3] = [Self::Round, Self::Dome, Self::Slab];

    /// Its name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Round => "round",
            Self::Dome => "dome",
            Self::Slab => "slab",
        }
    }

    /// The faces of a cell of this greatest thickness, um, over a grid that covers its outline.
    pub(super) fn heights(self, source: &impl Source, grid: &Grid, thickness: f64) -> Heights {
        let across = (ACROSS * grid.spacing / source.shape().width).ceil() as usize;
        let fits = (MOST / (grid.columns * grid.rows) as f64).sqrt() as usize;
        let finer = across.max(FINER).min(fits).max(1);
        let raster = Grid {
            spacing: grid.spacing / finer as f64,
            origin: grid.origin,
            columns: grid.columns * finer,
            rows: grid.rows * finer,
        };
        let inside = source.coverage(&raster);
        let face = |half: f64| match self {
            Self::Round => [0.5 * thickness * (1.0 - half), 0.5 * thickness * (1.0 + half)],
            Self::Dome => [0.0, thickness * half],
            Self::Slab => [0.0, thickness],
        };
        let faces = match self {
            Self::Slab => vec![face(1.0); inside.len()],
            Self::Round | Self::Dome => {
                let phi = poisson(&inside, raster.columns);
                let most = phi.iter().copied().fold(f64::MIN_POSITIVE, f64::max);
                phi.into_iter().map(|phi| face((phi.max(0.0) / most).sqrt())).collect()
            }
        };
        Heights { finer, columns: raster.columns, inside, faces }
    }
}

/// The solution of Poisson's equation on the squares that are at least half inside, in units of their area, by conjugate gradients;
/// 0 elsewhere, as on the outline, which runs along their sides.
fn poisson(inside: &[f64], columns: usize) -> Vec<f64> {
    let is_in = |at: usize| inside[at] >= 0.5;
    let neighbours = |at: usize| {
        let column = at % columns;
        [
            (column > 0).then(|| at - 1),
            (column + 1 < columns).then_some(at + 1),
            at.checked_sub(columns),
            (at + columns < inside.len()).then_some(at + columns),
        ]
    };
    let squares: Vec<usize> = (0..inside.len()).filter(|&at| is_in(at)).collect();
    // A side of the outline is half a square away from the centre: twice the slope, twice the weight.
    let times = |values: &[f64], product: &mut [f64]| {
        for &at in &squares {
            let mut sum = 0.0;
            for neighbour in neighbours(at) {
                sum += match neighbour {
                    Some(other) if is_in(other) => values[at] - values[other],
                    _ => 2.0 * values[at],
                };
            }
            product[at] = sum;
        }
    };
    let dot = |a: &[f64], b: &[f64]| squares.iter().map(|&at| a[at] * b[at]).sum::<f64>();
    let mut phi = vec![0.0; inside.len()];
    let mut product = phi.clone();
    let mut residual: Vec<f64> =
        (0..inside.len()).map(|at| if is_in(at) { 2.0 } else { 0.0 }).collect();
    let mut direction = residual.clone();
    let mut size = dot(&residual, &residual);
    let enough = SOLVED * SOLVED * size;
    for _ in 0..ROUNDS {
        if size <= enough {
            break;
        }
        times(&direction, &mut product);
        let step = size / dot(&direction, &product);
        for &at in &squares {
            phi[at] += step * direction[at];
            residual[at] -= step * product[at];
        }
        let next = dot(&residual, &residual);
        for &at in &squares {
            direction[at] = residual[at] + next / size * direction[at];
        }
        size = next;
    }
    phi
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_ellipse_becomes_an_ellipsoid() {
        let (a, b) = (60.0, 16.0);
        let (columns, rows) = (122, 34_u32);
        let rule = |at: usize| {
            let x = (at % columns) as f64 + 0.5 - 0.5 * columns as f64;
            let y = (at / columns) as f64 + 0.5 - 0.5 * f64::from(rows);
            1.0 - (x / a).powi(2) - (y / b).powi(2)
        };
        let squares = columns * rows as usize;
        let inside: Vec<f64> = (0..squares).map(|at| f64::from(u8::from(rule(at) > 0.0))).collect();
        let phi = poisson(&inside, columns);
        let most = phi.iter().copied().fold(0.0, f64::max);
        // On the ellipse phi = (1 - x^2/a^2 - y^2/b^2) / (1/a^2 + 1/b^2).
        let exact = 1.0 / (1.0 / (a * a) + 1.0 / (b * b));
        assert!((most / exact - 1.0).abs() < 0.01, "{most}, {exact}");
        let volume: f64 = phi.iter().map(|phi| 2.0 * (phi / most).sqrt() * b).sum();
        let ellipsoid = 4.0 / 3.0 * std::f64::consts::PI * a * b * b;
        // Steps of squares on the outline: a half part of 32 squares.
        assert!((volume / ellipsoid - 1.0).abs() < 0.01, "{}", volume / ellipsoid);
        let worst = (0..phi.len()).map(|at| (phi[at] / exact - rule(at).max(0.0)).abs());
        assert!(worst.fold(0.0, f64::max) < 0.06);
    }

    #[test]
    fn a_strip_has_an_elliptic_section() {
        // 20 squares across, long enough for its ends not to matter.
        let (columns, rows) = (200, 20);
        let phi = poisson(&vec![1.0; columns * rows], columns);
        for row in 0..rows {
            let y = row as f64 + 0.5 - 10.0;
            // Finite volumes on squares are off by a quarter of their side squared, everywhere.
            let exact = 100.0 - y * y;
            let found = phi[row * columns + 100];
            assert!((found - exact).abs() < 0.3, "{found}, {exact}");
        }
    }
}
