//! The points of a sampler, each computed on request.

use super::error::SamplingError;
use super::latin_hypercube::LatinHypercube;
use super::sampler::Sampler;
use super::sobol_sequence::SobolSequence;
use super::{morris, saltelli};

/// The points of a sampler in the unit cube. Each can be computed without the others, so a part of
/// a large design takes no more memory than that of a small one, except for a Latin hypercube,
/// which stores 4 bytes a number.
#[derive(Debug, Clone, PartialEq)]
pub struct Points {
    rows: usize,
    dimensions: usize,
    seed: u64,
    from: From,
}

#[derive(Debug, Clone, PartialEq)]
enum From {
    Grid { levels: usize },
    OneAtATime { levels: usize },
    LatinHypercube(LatinHypercube),
    SobolSequence(SobolSequence),
    Saltelli { both: SobolSequence, pairs: bool },
    Morris { levels: usize },
}

impl Sampler {
    /// The points in the unit cube: one row a member, one column a dimension.
    ///
    /// # Errors
    /// A size that is not possible, or no dimension.
    pub fn unit_cube(&self, dimensions: usize, seed: u64) -> Result<Points, SamplingError> {
        if dimensions == 0 {
            return Err(SamplingError::NoParameters);
        }
        let rows = self.rows(dimensions)?;
        let from = match *self {
            Sampler::Grid { levels } => From::Grid { levels },
            Sampler::OneAtATime { levels } => From::OneAtATime { levels },
            Sampler::LatinHypercube { size } => {
                From::LatinHypercube(LatinHypercube::new(size, dimensions, seed))
            }
            Sampler::SobolSequence { .. } => {
                From::SobolSequence(SobolSequence::new(dimensions, seed)?)
            }
            Sampler::Saltelli { pairs, .. } => {
                From::Saltelli { both: SobolSequence::new(2 * dimensions, seed)?, pairs }
            }
            Sampler::Morris { levels, .. } => From::Morris { levels },
        };
        Ok(Points { rows, dimensions, seed, from })
    }
}

impl Points {
    /// How many there are.
    pub fn count(&self) -> usize {
        self.rows
    }

    /// The point of a row, from 0; `None` past the last.
    pub fn point(&self, row: usize) -> Option<Vec<f64>> {
        let dimensions = self.dimensions;
        (row < self.rows).then(|| match &self.from {
            From::Grid { levels } => {
                let digit = |column| row / levels.pow((dimensions - 1 - column) as u32) % levels;
                (0..dimensions).map(|column| evenly(digit(column), *levels)).collect()
            }
            From::OneAtATime { levels } => {
                let own = |column| row / levels == column;
                let place = |column| if own(column) { evenly(row % levels, *levels) } else { 0.5 };
                (0..dimensions).map(place).collect()
            }
            From::LatinHypercube(hypercube) => hypercube.point(row),
            From::SobolSequence(sequence) => sequence.point(row),
            From::Saltelli { both, pairs } => saltelli::point(both, dimensions, *pairs, row),
            From::Morris { levels } => morris::point(*levels, dimensions, self.seed, row),
        })
    }

    /// All of them, in order.
    pub fn iter(&self) -> impl Iterator<Item = Vec<f64>> {
        (0..self.rows).filter_map(|row| self.point(row))
    }
}

/// A place among levels that divide [0, 1] evenly.
fn evenly(level: usize, levels: usize) -> f64 {
    level as f64 / (levels - 1) as f64
}
