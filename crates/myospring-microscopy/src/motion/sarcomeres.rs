//! Mean length of the sarcomeres, with its uncertainty.

use super::CellMotion;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A number and its 95 % interval.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its 95 % confidence interval, from the differences between the parts of the cell (Student's
    /// t).
    pub interval: [f64; 2],
}

impl Estimate {
    /// Estimate of a mean over independent values; `None` for fewer than two.
    fn new(value: f64, parts: &[f64]) -> Option<Self> {
        let count = parts.len() as f64;
        let student = StudentsT::new(0.0, 1.0, count - 1.0).ok()?;
        let mean = parts.iter().sum::<f64>() / count;
        let variance = parts.iter().map(|part| (part - mean).powi(2)).sum::<f64>() / (count - 1.0);
        let away = student.inverse_cdf(0.975) * (variance / count).sqrt();
        Some(Self { value, interval: [value - away, value + away] })
    }
}

impl CellMotion {
    /// Mean length of the sarcomeres, um, in the followed frame with index `at`; `None` if stripes
    /// were read in too few parts of the cell.
    pub fn sarcomere_length_um(&self, at: usize) -> Option<Estimate> {
        let parts: Vec<f64> =
            self.sarcomeres_by_part_um.get(at)?.iter().flatten().copied().collect();
        Estimate::new(self.sarcomeres_um[at]?, &parts)
    }

    /// Shortening of the sarcomeres relative to the frame at rest, per cent, in the followed frame
    /// with index `at`. The interval is that of the shortening itself: differences in resting
    /// length between parts of the cell do not widen it.
    pub fn sarcomere_shortening_pct(&self, at: usize) -> Option<Estimate> {
        let rest = self.rest_index();
        let shorter = |now: f64, rest: f64| 100.0 * (1.0 - now / rest);
        let [now, at_rest] = [at, rest].map(|at| self.sarcomeres_by_part_um.get(at));
        let parts: Vec<f64> = (now?.iter().zip(at_rest?))
            .filter_map(|(now, rest)| Some(shorter((*now)?, (*rest)?)))
            .collect();
        Estimate::new(shorter(self.sarcomeres_um[at]?, self.sarcomeres_um[rest]?), &parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_interval_of_a_mean_is_students() {
        // Student's data of sleep, 1908: mean 0.75, interval -0.53 to 2.03.
        let hours = [0.7, -1.6, -0.2, -1.2, -0.1, 3.4, 3.7, 0.8, 0.0, 2.0];
        let found = Estimate::new(0.75, &hours).unwrap();
        assert!((found.interval[0] + 0.5297804).abs() < 1e-6, "{found:?}");
        assert!((found.interval[1] - 2.0297804).abs() < 1e-6, "{found:?}");
        assert_eq!(Estimate::new(0.7, &[0.7]), None);
    }
}
