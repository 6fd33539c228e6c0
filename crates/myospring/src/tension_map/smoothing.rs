//! How smooth a map must be: generalised cross-validation, and whether there is anything but an even one.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use std::f64::consts::TAU;

/// Levels of smoothing that are tried, how far apart their factors are, and the one that stands for an even map.
const LEVELS: i32 = 60;
const APART: f64 = 1.5;
const EVEN: f64 = 1e6;
/// Most numbers that a map may have, as a part of those that were seen: cross-validation sometimes takes noise for signal.
const MOST: f64 = 0.5;
/// Directions in which the cell hardly answers at all, relative to the strongest one.
const NOTHING: f64 = 1e-12;
/// Even cells with noise that a gain is compared with.
const EVEN_CELLS: usize = 999;

/// A linear problem whose answer shall be smooth: rows are what was seen, columns the numbers of the map. What is left
/// open (the motion of the whole cell) is taken out of both before.
pub(super) struct Problem {
    pub(super) columns: DMatrix<f64>,
    pub(super) seen: DVector<f64>,
    /// Numbers that were seen, less those that are left open.
    pub(super) freedom: f64,
    /// `x.(P x)` is how uneven a map is; 0 for an even one.
    pub(super) penalty: DMatrix<f64>,
}

/// How smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Smoothing {
    pub(super) lambda: f64,
    /// Numbers that the map has in effect; 1 of an even one.
    pub(super) numbers: f64,
    /// Standard deviation of what was seen.
    pub(super) noise: f64,
    /// Chance that an even map with such noise would gain as much by being uneven.
    pub(super) chance_even: f64,
}

/// The problem in directions that do not know of each other, the even one left open.
struct Directions {
    /// Squares of how much is seen of each.
    strengths: Vec<f64>,
    /// How much of what was seen lies along each.
    seen: Vec<f64>,
    /// The sum of squares of what lies along none.
    beyond: f64,
    freedom: f64,
}

impl Problem {
    /// The smoothing of least generalised cross-validation.
    pub(super) fn smoothing(&self) -> Option<Smoothing> {
        let directions = self.directions()?;
        let strongest = directions.strengths.iter().copied().fold(0.0, f64::max);
        let levels: Vec<f64> = std::iter::once(EVEN * strongest)
            .chain((0..LEVELS).map(|level| 10.0 * strongest * APART.powi(-level)))
            .filter(|&lambda| directions.numbers(lambda) <= MOST * directions.freedom)
            .collect();
        let best = |directions: &Directions| {
            let scores = levels.iter().map(|&lambda| (lambda, directions.score(lambda)));
            scores.min_by(|a, b| a.1.total_cmp(&b.1))
        };
        let gain = |directions: &Directions, best: f64| directions.score(levels[0]) / best;
        let (lambda, score) = best(&directions)?;
        let found = gain(&directions, score);
        let mut random = Normal(ChaCha8Rng::seed_from_u64(1));
        let as_uneven = (0..EVEN_CELLS).filter(|_| {
            let even = directions.even(&mut random);
            best(&even).is_some_and(|(_, score)| gain(&even, score) >= found * (1.0 - 1e-9))
        });
        let chance_even = (as_uneven.count() + 1) as f64 / (EVEN_CELLS + 1) as f64;
        let numbers = directions.numbers(lambda);
        let noise = (directions.left(lambda) / (directions.freedom - numbers)).sqrt();
        Some(Smoothing { lambda, numbers: numbers + 1.0, noise, chance_even })
    }

    /// The matrix of the normal equations.
    pub(super) fn hessian(&self, lambda: f64) -> DMatrix<f64> {
        self.columns.tr_mul(&self.columns) + &self.penalty * lambda
    }

    fn directions(&self) -> Option<Directions> {
        let count = self.columns.ncols();
        let even = self.columns.column_sum();
        let size = even.norm_squared();
        if size.is_nan() || size <= 0.0 {
            return None;
        }
        let columns = &self.columns - &even * (self.columns.tr_mul(&even) / size).transpose();
        let seen = &self.seen - &even * (even.dot(&self.seen) / size);
        // With the even map left open, anything may be asked of it, so that the penalty has an inverse.
        let penalty = self.penalty.add_scalar(1.0 / count as f64);
        let lower = penalty.cholesky()?.l();
        let half = lower.solve_lower_triangular(&columns.transpose())?;
        let SymmetricEigen { eigenvalues, eigenvectors } =
            SymmetricEigen::new(&half * half.transpose());
        let along = eigenvectors.tr_mul(&(half * &seen));
        let strongest = eigenvalues.max();
        let kept = (0..count).filter(|&at| eigenvalues[at] > NOTHING * strongest);
        let (strengths, seen_along): (Vec<f64>, Vec<f64>) =
            kept.map(|at| (eigenvalues[at], along[at] / eigenvalues[at].sqrt())).unzip();
        let beyond = seen.norm_squared() - seen_along.iter().map(|part| part * part).sum::<f64>();
        let freedom = self.freedom - 1.0;
        Some(Directions { strengths, seen: seen_along, beyond: beyond.max(0.0), freedom })
    }
}

impl Directions {
    /// Numbers that a map has beside its mean.
    fn numbers(&self, lambda: f64) -> f64 {
        self.strengths.iter().map(|strength| strength / (strength + lambda)).sum()
    }

    /// Sum of squares of what the map leaves.
    fn left(&self, lambda: f64) -> f64 {
        let part = |(strength, seen): (&f64, &f64)| (lambda / (strength + lambda) * seen).powi(2);
        self.beyond + self.strengths.iter().zip(&self.seen).map(part).sum::<f64>()
    }

    /// Generalised cross-validation.
    fn score(&self, lambda: f64) -> f64 {
        self.left(lambda) / (self.freedom - self.numbers(lambda)).powi(2)
    }

    /// What an even cell with noise would show.
    fn even(&self, random: &mut Normal) -> Self {
        let seen: Vec<f64> = self.strengths.iter().map(|_| random.next()).collect();
        let others = (self.freedom as usize).saturating_sub(seen.len());
        let beyond = (0..others).map(|_| random.next().powi(2)).sum();
        Self { strengths: self.strengths.clone(), seen, beyond, freedom: self.freedom }
    }
}

/// Normal numbers (Box and Muller).
struct Normal(ChaCha8Rng);

impl Normal {
    fn unit(&mut self) -> f64 {
        ((self.0.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn next(&mut self) -> f64 {
        let (a, b) = (self.unit(), self.unit());
        (-2.0 * a.ln()).sqrt() * (TAU * b).cos()
    }
}
