//! Latin hypercubes (McKay, Beckman and Conover 1979).

use super::random::Random;

/// `size` points: in each column, one in each of `size` strata.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LatinHypercube {
    seed: u64,
    size: usize,
    /// For each column the stratum of every point: a permutation, which must be stored as a whole.
    strata: Vec<Vec<u32>>,
}

impl LatinHypercube {
    pub(super) fn new(size: usize, dimensions: usize, seed: u64) -> Self {
        let column = |column: usize| {
            let mut strata: Vec<u32> = (0..).take(size).collect();
            Random::new(seed, column as u64).shuffle(&mut strata);
            strata
        };
        Self { seed, size, strata: (0..dimensions).map(column).collect() }
    }

    pub(super) fn point(&self, row: usize) -> Vec<f64> {
        let place = |(column, strata): (usize, &Vec<u32>)| {
            // Places within strata are drawn after the order of the strata, which takes one number less than points.
            let mut random = Random::new(self.seed, column as u64);
            random.skip(self.size - 1 + row);
            (f64::from(strata[row]) + random.unit()) / self.size as f64
        };
        self.strata.iter().enumerate().map(place).collect()
    }
}
