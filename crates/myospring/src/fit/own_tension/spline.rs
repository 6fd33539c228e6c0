//! A penalised spline through noisy points, as smooth as they ask for.
//!
//! Uniform cubic B-splines with a penalty on the third differences of their coefficients (Eilers and Marx 1996), weighted by the
//! noise of each point; the penalty by generalised cross-validation (Craven and Wahba 1979); the band of the posterior
//! (`wahba_1983`). All matrices have seven diagonals, and of the inverse only those are computed.

/// Coefficients that a basis function shares a point with, to one side.
const BAND: usize = 3;
/// Third differences.
const DIFFERENCE: [f64; BAND + 1] = [-1.0, 3.0, -3.0, 1.0];
/// Most coefficients.
const MOST: usize = 20_000;
/// Penalties that are tried, as powers of ten of the ratio of both traces, and their distance.
const POWERS: [f64; 2] = [-10.0, 8.0];
const STEP: f64 = 0.25;

/// Row `i` has the entries `(i, i - BAND)` to `(i, i)` of a symmetric matrix.
type Banded = Vec<[f64; BAND + 1]>;

/// A spline and how sure it is.
pub(super) struct Spline {
    start: f64,
    spacing: f64,
    coefficients: Vec<f64>,
    /// Posterior covariance of the coefficients within the band.
    covariance: Banded,
}

impl Spline {
    /// Through values with these standard deviations at ascending places; four points or more.
    pub(super) fn through(places: &[f64], values: &[f64], deviations: &[f64]) -> Self {
        let (start, end) = (places[0], places[places.len() - 1]);
        let pieces = (places.len() - 1).min(MOST);
        let spacing = (end - start) / pieces as f64;
        let count = pieces + BAND;
        let rows: Vec<(usize, [f64; 4])> = places
            .iter()
            .map(|place| {
                let (first, weights, _) = basis(*place, start, spacing, pieces);
                (first, weights)
            })
            .collect();
        let mut normal: Banded = vec![[0.0; BAND + 1]; count];
        let mut right = vec![0.0; count];
        for (((first, row), value), deviation) in rows.iter().zip(values).zip(deviations) {
            let weight = 1.0 / (deviation * deviation);
            for (k, a) in row.iter().enumerate() {
                right[first + k] += weight * a * value;
                for (l, b) in row.iter().enumerate().take(k + 1) {
                    normal[first + k][BAND - (k - l)] += weight * a * b;
                }
            }
        }
        let mut penalty: Banded = vec![[0.0; BAND + 1]; count];
        for first in 0..count - BAND {
            for (k, a) in DIFFERENCE.iter().enumerate() {
                for (l, b) in DIFFERENCE.iter().enumerate().take(k + 1) {
                    penalty[first + k][BAND - (k - l)] += a * b;
                }
            }
        }
        let trace = |of: &Banded| of.iter().map(|row| row[BAND]).sum::<f64>();
        let scale = trace(&normal) / trace(&penalty);
        let solved = |power: f64| {
            let by = scale * 10_f64.powf(power);
            let sum = |(a, b): (&[f64; 4], &[f64; 4])| std::array::from_fn(|k| a[k] + by * b[k]);
            let matrix: Banded = normal.iter().zip(&penalty).map(sum).collect();
            let (factor, pivots) = decompose(&matrix)?;
            let coefficients = solve(&factor, &pivots, &right);
            let covariance = inverse(&factor, &pivots);
            let (mut squares, mut trace) = (0.0, 0.0);
            for (((first, row), value), deviation) in rows.iter().zip(values).zip(deviations) {
                let at: f64 =
                    row.iter().enumerate().map(|(k, a)| a * coefficients[first + k]).sum();
                squares += ((value - at) / deviation).powi(2);
                trace += variance(&covariance, *first, row) / (deviation * deviation);
            }
            let free = places.len() as f64 - trace;
            let score = squares / (free * free);
            (free > 0.0 && score.is_finite()).then_some((score, coefficients, covariance))
        };
        let powers = (0..=((POWERS[1] - POWERS[0]) / STEP) as usize)
            .map(|number| POWERS[0] + STEP * number as f64);
        let best = powers.filter_map(solved).min_by(|a, b| a.0.total_cmp(&b.0));
        let (coefficients, covariance) = best.map_or_else(
            || (vec![values[0]; count], vec![[0.0; BAND + 1]; count]),
            |(_, coefficients, covariance)| (coefficients, covariance),
        );
        Self { start, spacing, coefficients, covariance }
    }

    /// Value plus `slope` times the derivative at a place, and the standard deviation of both together.
    pub(super) fn at(&self, place: f64, slope: f64) -> [f64; 2] {
        let pieces = self.coefficients.len() - BAND;
        let (first, values, slopes) = basis(place, self.start, self.spacing, pieces);
        let row: [f64; 4] = std::array::from_fn(|k| values[k] + slope * slopes[k]);
        let value: f64 =
            row.iter().enumerate().map(|(k, a)| a * self.coefficients[first + k]).sum();
        [value, variance(&self.covariance, first, &row).max(0.0).sqrt()]
    }
}

/// The first of four basis functions at a place, their values and derivatives.
fn basis(place: f64, start: f64, spacing: f64, pieces: usize) -> (usize, [f64; 4], [f64; 4]) {
    let at = (place - start) / spacing;
    let first = (at.max(0.0) as usize).min(pieces - 1);
    let u = at - first as f64;
    let v = 1.0 - u;
    let values = [
        v.powi(3) / 6.0,
        (3.0 * u.powi(3) - 6.0 * u * u + 4.0) / 6.0,
        (3.0 * v.powi(3) - 6.0 * v * v + 4.0) / 6.0,
        u.powi(3) / 6.0,
    ];
    let slopes = [-0.5 * v * v, 1.5 * u * u - 2.0 * u, 2.0 * v - 1.5 * v * v, 0.5 * u * u];
    (first, values, slopes.map(|slope| slope / spacing))
}

fn variance(covariance: &Banded, first: usize, row: &[f64; 4]) -> f64 {
    let mut sum = 0.0;
    for (k, a) in row.iter().enumerate() {
        for (l, b) in row.iter().enumerate() {
            let (low, high) = (k.min(l), k.max(l));
            sum += a * b * covariance[first + high][BAND - (high - low)];
        }
    }
    sum
}

/// `L D L^T`: the lower factor without its unit diagonal, and the pivots; `None` unless positive definite.
fn decompose(matrix: &Banded) -> Option<(Banded, Vec<f64>)> {
    let mut lower = matrix.clone();
    let mut pivots: Vec<f64> = Vec::with_capacity(matrix.len());
    for i in 0..matrix.len() {
        let first = i.saturating_sub(BAND);
        for j in first..i {
            let mut sum = lower[i][BAND - (i - j)];
            for k in first.max(j.saturating_sub(BAND))..j {
                sum -= lower[i][BAND - (i - k)] * pivots[k] * lower[j][BAND - (j - k)];
            }
            lower[i][BAND - (i - j)] = sum / pivots[j];
        }
        let squares = (first..i).map(|k| lower[i][BAND - (i - k)].powi(2) * pivots[k]);
        let pivot = matrix[i][BAND] - squares.sum::<f64>();
        if pivot.is_nan() || pivot <= 0.0 {
            return None;
        }
        pivots.push(pivot);
    }
    Some((lower, pivots))
}

fn solve(lower: &Banded, pivots: &[f64], right: &[f64]) -> Vec<f64> {
    let count = right.len();
    let mut x = right.to_vec();
    for i in 0..count {
        for k in i.saturating_sub(BAND)..i {
            x[i] -= lower[i][BAND - (i - k)] * x[k];
        }
    }
    for (x, pivot) in x.iter_mut().zip(pivots) {
        *x /= pivot;
    }
    for i in (0..count).rev() {
        for k in i + 1..(i + BAND + 1).min(count) {
            x[i] -= lower[k][BAND - (k - i)] * x[k];
        }
    }
    x
}

/// The diagonals of the inverse, from the last backwards (Hutchinson and de Hoog 1985).
fn inverse(lower: &Banded, pivots: &[f64]) -> Banded {
    let count = pivots.len();
    let mut found: Banded = vec![[0.0; BAND + 1]; count];
    let entry = |found: &Banded, i: usize, j: usize| {
        let (low, high) = (i.min(j), i.max(j));
        found[high][BAND - (high - low)]
    };
    for i in (0..count).rev() {
        let last = (i + BAND + 1).min(count);
        for j in (i + 1..last).rev() {
            let sum: f64 =
                (i + 1..last).map(|k| lower[k][BAND - (k - i)] * entry(&found, k, j)).sum();
            found[j][BAND - (j - i)] = -sum;
        }
        let sum: f64 = (i + 1..last).map(|k| lower[k][BAND - (k - i)] * entry(&found, k, i)).sum();
        found[i][BAND] = 1.0 / pivots[i] - sum;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_curve_and_its_slope_are_found_in_noise_within_their_band() {
        use crate::study::sampling::{Distribution, Sampler, sample};
        let places: Vec<f64> = (0..200).map(|at| 5.0 * f64::from(at)).collect();
        let wave = |t: f64| (t / 90.0).sin();
        let normal = Distribution::Normal { mean: 0.0, standard_deviation: 0.05 };
        let mut within = 0;
        for seed in 0..10 {
            let draws = sample(&Sampler::LatinHypercube { size: 200 }, &[normal], seed).unwrap();
            let values: Vec<f64> =
                places.iter().zip(draws.iter()).map(|(t, draw)| wave(*t) + draw[0]).collect();
            let spline = Spline::through(&places, &values, &[0.05; 200]);
            within += places
                .iter()
                .filter(|t| {
                    let truth = wave(**t) + 30.0 / 90.0 * (**t / 90.0).cos();
                    let [value, deviation] = spline.at(**t, 30.0);
                    (value - truth).abs() < 1.96 * deviation
                })
                .count();
        }
        // The band is one on average over the curve.
        assert!((0.92..0.99).contains(&(f64::from(within as u32) / 2000.0)), "{within} of 2000");
    }

    #[test]
    fn the_band_of_the_inverse_is_that_of_the_inverse() {
        let matrix: Banded = (0..6).map(|i| [0.1, -0.3, 0.5, 2.0 + f64::from(i)]).collect();
        let (lower, pivots) = decompose(&matrix).unwrap();
        let found = inverse(&lower, &pivots);
        for column in 0..6 {
            let unit: Vec<f64> = (0..6).map(|row| f64::from(u8::from(row == column))).collect();
            let x = solve(&lower, &pivots, &unit);
            for row in column..(column + BAND + 1).min(6) {
                assert!((found[row][BAND - (row - column)] - x[row]).abs() < 1e-14);
            }
        }
    }
}
