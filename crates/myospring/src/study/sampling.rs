//! Samples of parameters: where a study looks, as a matrix with one row a member and one column a parameter.
//!
//! A [`Sampler`] places points in the unit cube, and each parameter's [`Distribution`] takes its column from there to
//! values. A design hangs on its seed alone: the same rows on every machine.
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
//! let rows = sample(&Sampler::LatinHypercube { size: 100 }, &[tau_si, modulus], 1)?;
//! assert_eq!((rows.len(), rows[0].len()), (100, 2));
//! assert!(rows.iter().all(|row| (100.0..=400.0).contains(&row[1])));
//! # Ok::<(), myospring::study::sampling::SamplingError>(())
//! ```

mod distribution;
mod error;
mod latin_hypercube;
mod morris;
mod random;
mod saltelli;
mod sobol_sequence;

pub use distribution::Distribution;
pub use error::{MOST_DIMENSIONS, SamplingError};

use error::MOST_ROWS;
use latin_hypercube::latin_hypercube;
pub(super) use random::Random;
use serde::{Deserialize, Serialize};

/// How points are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "sampler", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Sampler {
    /// Every combination of so many values of each parameter, evenly spaced in probability from one end of its
    /// distribution to the other; the last parameter changes fastest.
    Grid {
        /// Values of each parameter.
        levels: usize,
    },
    /// For each parameter so many of its values, evenly spaced in probability, with all others in the middle of their
    /// distributions.
    OneAtATime {
        /// Values of each parameter; with an odd number the middle is one of them.
        levels: usize,
    },
    /// So many rows, in each column one value in each of as many equally likely strata (McKay et al. 1979).
    LatinHypercube {
        /// Rows.
        size: usize,
    },
    /// The first points of Sobol's sequence, shifted at random (Joe and Kuo 2008).
    SobolSequence {
        /// Rows.
        size: usize,
    },
    /// Saltelli's design for Sobol indices: for each of `size` base points the rows A, A with one column of B for each
    /// parameter, and B; with `pairs` also B with one column of A, before the last (Saltelli 2002; the order of SALib).
    Saltelli {
        /// Base points; a power of two is best.
        size: usize,
        /// Whether interactions of pairs of parameters are wanted, too.
        #[serde(default)]
        pairs: bool,
    },
    /// Trajectories through a grid, on which one parameter changes at a time (Morris 1991).
    Morris {
        /// Trajectories.
        trajectories: usize,
        /// Levels of the grid, an even number; 4 is usual.
        #[serde(default = "usual_levels")]
        levels: usize,
    },
}

fn usual_levels() -> usize {
    4
}

impl Sampler {
    /// How many rows it gives for so many parameters that vary.
    ///
    /// # Errors
    /// A size of nothing, or too many rows.
    pub fn rows(&self, dimensions: usize) -> Result<usize, SamplingError> {
        let at_least = |what, value, least: usize, must| {
            if value >= least { Ok(()) } else { Err(SamplingError::Size { what, value, must }) }
        };
        let d = dimensions as f64;
        let rows = match *self {
            Self::Grid { levels } => {
                at_least("the number of levels", levels, 2, "2 or more")?;
                (levels as f64).powf(d)
            }
            Self::OneAtATime { levels } => {
                at_least("the number of levels", levels, 2, "2 or more")?;
                levels as f64 * d
            }
            Self::LatinHypercube { size } | Self::SobolSequence { size } => {
                at_least("the size", size, 1, "1 or more")?;
                size as f64
            }
            Self::Saltelli { size, pairs } => {
                at_least("the size", size, 2, "2 or more, 512 for a first answer")?;
                size as f64 * if pairs { 2.0 * d + 2.0 } else { d + 2.0 }
            }
            Self::Morris { trajectories, levels } => {
                at_least(
                    "the number of trajectories",
                    trajectories,
                    2,
                    "2 or more; 10 to 50 are usual",
                )?;
                if levels < 2 || levels % 2 == 1 {
                    let (what, must) = ("the number of levels", "an even number; 4 is usual");
                    return Err(SamplingError::Size { what, value: levels, must });
                }
                trajectories as f64 * (d + 1.0)
            }
        };
        if rows > MOST_ROWS as f64 { Err(SamplingError::Rows { rows }) } else { Ok(rows as usize) }
    }

    /// The points in the unit cube: one row a member, one column a dimension.
    ///
    /// # Errors
    /// A size that is not possible, or no dimension.
    pub fn unit_cube(&self, dimensions: usize, seed: u64) -> Result<Vec<Vec<f64>>, SamplingError> {
        if dimensions == 0 {
            return Err(SamplingError::NoParameters);
        }
        let rows = self.rows(dimensions)?;
        match *self {
            Self::Grid { levels } => {
                let last = (levels - 1) as f64;
                let digit = |row: usize, column: usize| {
                    row / levels.pow((dimensions - 1 - column) as u32) % levels
                };
                let point = |row| (0..dimensions).map(|at| digit(row, at) as f64 / last).collect();
                Ok((0..rows).map(point).collect())
            }
            Self::OneAtATime { levels } => {
                let place = |row: usize| (row % levels) as f64 / (levels - 1) as f64;
                let at = |row: usize, column| if row / levels == column { place(row) } else { 0.5 };
                let point = |row| (0..dimensions).map(|column| at(row, column)).collect();
                Ok((0..rows).map(point).collect())
            }
            Self::LatinHypercube { size } => Ok(latin_hypercube(size, dimensions, seed)),
            Self::SobolSequence { size } => sobol_sequence::shifted(size, dimensions, seed),
            Self::Saltelli { size, pairs } => saltelli::saltelli(size, dimensions, pairs, seed),
            Self::Morris { trajectories, levels } => {
                Ok(morris::trajectories(trajectories, levels, dimensions, seed))
            }
        }
    }
}

/// The values of parameters, in the order of their distributions: one row a member. Those that are fixed take no
/// dimension of the design.
///
/// # Errors
/// A distribution or size that is not possible, or nothing that varies.
pub fn sample(
    sampler: &Sampler,
    distributions: &[Distribution],
    seed: u64,
) -> Result<Vec<Vec<f64>>, SamplingError> {
    distributions.iter().try_for_each(Distribution::check)?;
    let varied = distributions.iter().filter(|distribution| !distribution.is_fixed()).count();
    let points = sampler.unit_cube(varied, seed)?;
    let values = |point: Vec<f64>| {
        let mut places = point.into_iter();
        let value = |distribution: &Distribution| {
            let place = if distribution.is_fixed() { 0.5 } else { places.next().unwrap_or(0.5) };
            distribution.quantile(place)
        };
        distributions.iter().map(value).collect()
    };
    Ok(points.into_iter().map(values).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    const UNIT: Distribution = Distribution::Uniform { low: 0.0, high: 1.0 };

    #[test]
    fn a_seed_gives_the_same_rows_for_ever_and_another_seed_others() {
        let sampler = Sampler::LatinHypercube { size: 3 };
        let rows = sampler.unit_cube(2, 1).unwrap();
        assert_eq!(rows, sampler.unit_cube(2, 1).unwrap());
        assert_ne!(rows, sampler.unit_cube(2, 2).unwrap());
        // A study that is resumed with a later version must go on with the same members.
        assert_eq!(rows[0], FIRST);
    }

    const FIRST: [f64; 2] = [0.8655200603116183, 0.5195841832102822];

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
                let points = sampler.unit_cube(dimensions, 3).unwrap();
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
        let rows = sample(&Sampler::SobolSequence { size: 4096 }, &distributions, 5).unwrap();
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
