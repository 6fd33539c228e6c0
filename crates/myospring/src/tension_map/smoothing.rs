//! The smoothness of a map by generalised cross-validation, and a test whether it is uniform.

use nalgebra::{DMatrix, DVector, SymmetricEigen};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng as _, SeedableRng as _};
use std::f64::consts::TAU;

/// Levels of smoothing that are tried, how far apart their factors are, and the level of a uniform
/// map.
const LEVELS: i32 = 60;
const APART: f64 = 1.5;
const EVEN: f64 = 1e6;
/// Largest effective number of parameters of a map, as a part of the measured numbers;
/// cross-validation sometimes fits noise.
const MOST: f64 = 0.5;
/// Smallest response of a direction that is used, relative to the largest.
const NOTHING: f64 = 1e-12;
/// Simulated uniform cells with noise in the test of unevenness.
const EVEN_CELLS: usize = 999;

/// A linear problem with a smooth solution: rows are measured numbers, columns the numbers of the
/// map. The free motion of the whole cell is projected out of both.
#[derive(Clone)]
pub(super) struct Problem {
    pub(super) columns: DMatrix<f64>,
    /// The products of the columns with each other.
    pub(super) products: DMatrix<f64>,
    pub(super) seen: DVector<f64>,
    /// Measured numbers minus those of the free motion.
    pub(super) freedom: f64,
    /// `x.(P x)` is the unevenness of a map; 0 for a uniform one.
    pub(super) penalty: DMatrix<f64>,
}

/// How smooth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Smoothing {
    pub(super) lambda: f64,
    /// Effective number of parameters of the map; 1 for a uniform one.
    pub(super) numbers: f64,
    /// Standard deviation of the measured numbers.
    pub(super) noise: f64,
    /// Chance that a uniform tension with such noise would look as uneven.
    pub(super) chance_even: f64,
}

/// The problem in independent directions, the uniform one free.
struct Directions {
    /// Squares of the response in each.
    strengths: Vec<f64>,
    /// Component of the measured numbers along each.
    seen: Vec<f64>,
    /// The sum of squares of the rest.
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
        &self.products + &self.penalty * lambda
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
        // The uniform map is free, so any penalty may be added to it; with this one the penalty has
        // an inverse.
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
    /// Effective number of parameters of a map in addition to its mean.
    fn numbers(&self, lambda: f64) -> f64 {
        self.strengths.iter().map(|strength| strength / (strength + lambda)).sum()
    }

    /// Sum of squared residuals of the map.
    fn left(&self, lambda: f64) -> f64 {
        let part = |(strength, seen): (&f64, &f64)| (lambda / (strength + lambda) * seen).powi(2);
        self.beyond + self.strengths.iter().zip(&self.seen).map(part).sum::<f64>()
    }

    /// Generalised cross-validation.
    fn score(&self, lambda: f64) -> f64 {
        self.left(lambda) / (self.freedom - self.numbers(lambda)).powi(2)
    }

    /// The measurement of a simulated uniform cell with noise.
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
