//! Samples of parameter values, as a matrix with one row per member and one column per parameter.
//!
//! A [`Sampler`] places points in the unit cube, and each parameter's [`Distribution`] takes its
//! column from there to values. A design depends only on its seed, so it has the same rows on every
//! machine.
//!
//! | sampler | rows | for |
//! |---|---|---|
//! | [`Sampler::Grid`] | all combinations of evenly spaced values | response curves of one or two parameters |
//! | [`Sampler::OneAtATime`] | D times the levels | response curves of many parameters |
//! | [`Sampler::LatinHypercube`] | any number | populations; a first look |
//! | [`Sampler::SobolSequence`] | a power of two is best | populations; means that converge fast |
//! | [`Sampler::Saltelli`] | N (D + 2), with pairs N (2 D + 2) | [Sobol indices](super::sensitivity) |
//! | [`Sampler::Morris`] | r (D + 1) | screening many parameters |
//!
//! # Example
//! ```
//! use myospring::study::sampling::{Distribution, Sampler, sample};
//!
//! let tau_si = Distribution::Normal { mean: 1.768, standard_deviation: 0.05 };
//! let modulus = Distribution::LogUniform { low: 100.0, high: 400.0 };
//! let design = sample(&Sampler::LatinHypercube { size: 100 }, &[tau_si, modulus], 1)?;
//! assert_eq!((design.count(), design.row(99).map(|row| row.len())), (100, Some(2)));
//! assert!(design.iter().all(|row| (100.0..=400.0).contains(&row[1])));
//! # Ok::<(), myospring::study::sampling::SamplingError>(())
//! ```

mod distribution;
mod error;
mod latin_hypercube;
mod morris;
mod points;
mod random;
mod saltelli;
mod sampler;
mod sobol_sequence;

pub use distribution::Distribution;
pub use error::{MOST_DIMENSIONS, SamplingError};
pub use points::Points;
pub use sampler::Sampler;

pub(super) use random::Random;

/// Parameter values, one row per member; each row is computed when it is requested.
#[derive(Debug, Clone, PartialEq)]
pub struct ParameterSample {
    points: Points,
    distributions: Vec<Distribution>,
}

impl ParameterSample {
    /// Returns the number of rows.
    pub fn count(&self) -> usize {
        self.points.count()
    }

    /// Returns the values of a row, counted from 0, in the order of the distributions; `None` past
    /// the last row.
    pub fn row(&self, row: usize) -> Option<Vec<f64>> {
        let mut places = self.points.point(row)?.into_iter();
        let value = |distribution: &Distribution| {
            let place = if distribution.is_fixed() { 0.5 } else { places.next().unwrap_or(0.5) };
            distribution.quantile(place)
        };
        Some(self.distributions.iter().map(value).collect())
    }

    /// Iterates over all rows, in order.
    pub fn iter(&self) -> impl Iterator<Item = Vec<f64>> {
        (0..self.count()).filter_map(|row| self.row(row))
    }
}

/// Samples parameter values, in the order of their distributions. Fixed parameters take no
/// dimension of the design.
///
/// # Errors
/// An invalid distribution or size, or no parameter that varies.
pub fn sample(
    sampler: &Sampler,
    distributions: &[Distribution],
    seed: u64,
) -> Result<ParameterSample, SamplingError> {
    distributions.iter().try_for_each(Distribution::check)?;
    let varied = distributions.iter().filter(|distribution| !distribution.is_fixed()).count();
    let points = sampler.unit_cube(varied, seed)?;
    Ok(ParameterSample { points, distributions: distributions.to_vec() })
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Distribution = Distribution::Uniform { low: 0.0, high: 1.0 };

    #[test]
    fn a_seed_gives_the_same_rows_for_ever_and_another_seed_others() {
        // A study that is resumed with a later version must go on with the same members.
        let ever = [
            (Sampler::LatinHypercube { size: 17 }, LATIN_HYPERCUBE),
            (Sampler::SobolSequence { size: 17 }, SOBOL_SEQUENCE),
            (Sampler::Saltelli { size: 17, pairs: true }, SALTELLI),
            (Sampler::Morris { trajectories: 17, levels: 4 }, MORRIS),
        ];
        for (sampler, expected) in ever {
            let last = |seed| sampler.unit_cube(3, seed).unwrap().iter().last().unwrap();
            assert_eq!(last(1), expected, "{sampler:?}");
            assert_ne!(last(2), expected, "{sampler:?}");
        }
    }

    const LATIN_HYPERCUBE: [f64; 3] = [0.3593085563283518, 0.8635590956533196, 0.8560637086707912];
    const SOBOL_SEQUENCE: [f64; 3] = [0.2777798629611582, 0.5879063288845575, 0.6703291539033179];
    const SALTELLI: [f64; 3] = [0.35865496152824583, 0.9346939133633417, 0.22703695849868055];
    const MORRIS: [f64; 3] = [1.0, 2.0 / 3.0, 2.0 / 3.0];

    #[test]
    fn a_row_of_a_design_of_millions_is_had_without_the_others() {
        let design = Sampler::Saltelli { size: 2_000_000, pairs: false };
        let point = design.unit_cube(36, 1).unwrap().point(75_999_999).unwrap();
        // Base points are the first of the sequence, however many there are; this is B of the last one.
        let both = Sampler::SobolSequence { size: 2_000_000 }.unit_cube(72, 1).unwrap();
        assert_eq!(point, both.point(1_999_999).unwrap()[36..]);
        assert_eq!(both.point(2_000_000), None);
    }

    #[test]
    fn every_sampler_gives_the_rows_that_it_promises_within_the_unit_cube() {
        for sampler in [
            Sampler::Grid { levels: 3 },
            Sampler::OneAtATime { levels: 5 },
            Sampler::LatinHypercube { size: 17 },
            Sampler::SobolSequence { size: 20 },
            Sampler::Saltelli { size: 8, pairs: false },
            Sampler::Saltelli { size: 8, pairs: true },
            Sampler::Morris { trajectories: 5, levels: 6 },
        ] {
            for dimensions in 1..=5 {
                let points: Vec<_> = sampler.unit_cube(dimensions, 3).unwrap().iter().collect();
                assert_eq!(points.len(), sampler.rows(dimensions).unwrap(), "{sampler:?}");
                let within = |x: &f64| (0.0..=1.0).contains(x);
                assert!(
                    points
                        .iter()
                        .all(|point| point.len() == dimensions && point.iter().all(within))
                );
            }
        }
    }

    #[test]
    fn a_latin_hypercube_has_one_row_in_each_stratum_of_each_column() {
        let points = Sampler::LatinHypercube { size: 50 }.unit_cube(4, 8).unwrap();
        let points: Vec<_> = points.iter().collect();
        for column in 0..4 {
            let mut strata: Vec<usize> =
                points.iter().map(|point| (point[column] * 50.0) as usize).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..50));
        }
    }

    #[test]
    fn rows_of_saltelli_differ_from_their_base_point_in_one_column() {
        let points = Sampler::Saltelli { size: 16, pairs: true }.unit_cube(3, 4).unwrap();
        let points: Vec<_> = points.iter().collect();
        let differ =
            |x: &[f64], y: &[f64]| -> Vec<usize> { (0..3).filter(|&at| x[at] != y[at]).collect() };
        for rows in points.chunks_exact(8) {
            let [a, b] = [&rows[0], &rows[7]];
            assert_eq!(differ(a, b), [0, 1, 2]);
            for column in 0..3 {
                assert_eq!(differ(a, &rows[1 + column]), [column]);
                assert_eq!(differ(b, &rows[4 + column]), [column]);
            }
        }
    }

    #[test]
    fn distributions_have_the_means_and_spreads_that_they_state() {
        let distributions = [
            Distribution::Normal { mean: 5.0, standard_deviation: 2.0 },
            Distribution::Lognormal { median: 3.0, log_standard_deviation: 0.1 },
            Distribution::LogUniform { low: 1.0, high: 100.0 },
            Distribution::Fixed { value: 7.0 },
            UNIT,
        ];
        let design = sample(&Sampler::SobolSequence { size: 4096 }, &distributions, 5).unwrap();
        let rows: Vec<_> = design.iter().collect();
        let mean = |of: &dyn Fn(&Vec<f64>) -> f64| rows.iter().map(of).sum::<f64>() / 4096.0;
        // The sequence's error for 4096 points is some 1e-3.
        let close = |found: f64, expected: f64| {
            assert!((found - expected).abs() < 2e-3 * expected, "{found}, not {expected}");
        };
        close(mean(&|row| row[0]), 5.0);
        close(mean(&|row| (row[0] - 5.0).powi(2)), 4.0);
        close(mean(&|row| row[1]), 3.0 * (0.005_f64).exp());
        close(mean(&|row| row[2].log10()), 1.0);
        close(mean(&|row| row[4]), 0.5);
        assert!(rows.iter().all(|row| row[3] == 7.0));
    }

    #[test]
    fn what_cannot_be_sampled_is_said_with_its_number_and_its_bound() {
        let said = |sampler: Sampler, distributions: &[Distribution]| {
            sample(&sampler, distributions, 1).unwrap_err().to_string()
        };
        let ten = Sampler::LatinHypercube { size: 10 };
        let turned = Distribution::Uniform { low: 2.0, high: 1.0 };
        assert_eq!(
            said(ten, &[turned]),
            "a uniform distribution needs high above low, but high is 1"
        );
        let zero = Distribution::LogUniform { low: 0.0, high: 1.0 };
        assert!(said(ten, &[zero]).contains("needs low above 0, but low is 0"));
        assert!(said(ten, &[Distribution::Fixed { value: 1.0 }]).contains("no parameter varies"));
        assert!(said(Sampler::Grid { levels: 1 }, &[UNIT]).contains("levels is 1; give 2 or more"));
        assert!(said(Sampler::Grid { levels: 10 }, &[UNIT; 12]).contains("1000000000000 rows"));
        let saltelli = Sampler::Saltelli { size: 4, pairs: false };
        assert!(said(saltelli, &[UNIT; 300]).contains("600 dimensions"));
        let morris = Sampler::Morris { trajectories: 4, levels: 5 };
        assert!(said(morris, &[UNIT]).contains("levels is 5; give an even number"));
    }
}
