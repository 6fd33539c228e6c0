//! Samplers: how points are placed.

use super::error::{MOST_ROWS, SamplingError};
use serde::{Deserialize, Serialize};

/// How points are placed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(tag = "sampler", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Sampler {
    /// Every combination of a number of values of each parameter, evenly spaced in probability from
    /// one end of its distribution to the other; the last parameter changes fastest.
    Grid {
        /// Values of each parameter.
        levels: usize,
    },
    /// For each parameter a number of its values, evenly spaced in probability, with all others in
    /// the middle of their distributions.
    OneAtATime {
        /// Values of each parameter; with an odd number the middle is one of them.
        levels: usize,
    },
    /// A number of rows, in each column one value in each of as many equally likely strata (McKay
    /// et al. 1979).
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
        /// Whether to compute interactions of pairs of parameters, too.
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
    /// Word of each, the keys that it needs, and those that it may have beside `seed`.
    pub(in crate::study) const KEYS: [(&str, &[&str], &[&str]); 6] = [
        ("grid", &["levels"], &[]),
        ("one-at-a-time", &["levels"], &[]),
        ("latin-hypercube", &["size"], &[]),
        ("sobol-sequence", &["size"], &[]),
        ("saltelli", &["size"], &["pairs"]),
        ("morris", &["trajectories"], &["levels"]),
    ];

    /// Whether its rows are a population, drawn from the distributions.
    pub(in crate::study) fn is_population(&self) -> bool {
        matches!(self, Self::LatinHypercube { .. } | Self::SobolSequence { .. })
    }

    /// The number of rows for this number of varied parameters.
    ///
    /// # Errors
    /// A size of 0, or too many rows.
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
}
