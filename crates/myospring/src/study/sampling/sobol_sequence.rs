//! Sobol's sequence with the direction numbers of Joe and Kuo (2008).

use super::error::{MOST_DIMENSIONS, SamplingError};
use super::random::Random;
use std::sync::LazyLock;

/// Bits of a point: all that a double holds.
const BITS: usize = 52;
/// The stream of random numbers that shifts the sequence.
const SHIFT: u64 = u64::MAX;

/// Direction numbers of each dimension but the first, the highest bit being a half.
static DIRECTIONS: LazyLock<Vec<[u64; BITS]>> = LazyLock::new(|| {
    let lines = include_str!("joe_kuo.txt").lines().filter(|line| !line.starts_with('#'));
    lines
        .map(|line| {
            let mut numbers = line.split(' ').filter_map(|number| number.parse::<u64>().ok());
            let polynomial = numbers.next().unwrap_or(1);
            directions(polynomial, &numbers.collect::<Vec<_>>())
        })
        .collect()
});

fn directions(polynomial: u64, initial: &[u64]) -> [u64; BITS] {
    let degree = initial.len();
    let mut v = [0; BITS];
    for bit in 0..BITS {
        v[bit] = if bit < degree {
            initial[bit] << (BITS - 1 - bit)
        } else {
            let oldest = v[bit - degree];
            (1..degree)
                .filter(|k| polynomial >> (degree - k) & 1 == 1)
                .fold(oldest ^ (oldest >> degree), |sum, k| sum ^ v[bit - k])
        };
    }
    v
}

/// The sequence with a random digital shift for each column: as uniform as the sequence, and never
/// on the border.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SobolSequence {
    shifts: Vec<u64>,
}

impl SobolSequence {
    pub(super) fn new(dimensions: usize, seed: u64) -> Result<Self, SamplingError> {
        if dimensions > MOST_DIMENSIONS {
            return Err(SamplingError::Dimensions { dimensions });
        }
        let mut random = Random::new(seed, SHIFT);
        let shifts = (0..dimensions).map(|_| random.bits() >> (64 - BITS)).collect();
        Ok(Self { shifts })
    }

    pub(super) fn point(&self, row: usize) -> Vec<f64> {
        let place = |(dimension, shift): (usize, &u64)| {
            ((digits(dimension, row) ^ shift) as f64 + 0.5) / (1_u64 << BITS) as f64
        };
        self.shifts.iter().enumerate().map(place).collect()
    }
}

/// A coordinate of the point of a row, the first of which is the origin.
fn digits(dimension: usize, row: usize) -> u64 {
    // Gray's code: one bit changes from one row to the next (Antonov and Saleev 1979).
    let gray = row ^ (row >> 1);
    // In the first dimension digits are reversed: van der Corput's sequence.
    let direction = |bit: usize| match dimension {
        0 => 1 << (BITS - 1 - bit),
        _ => DIRECTIONS[dimension - 1][bit],
    };
    (0..BITS).filter(|bit| gray >> bit & 1 == 1).fold(0, |sum, bit| sum ^ direction(bit))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_points_are_those_that_others_state() {
        // `scipy.stats.qmc.Sobol(d=6, scramble=False).random(8)`, SciPy 1.17.1, which has the same direction numbers.
        let expected = [
            [0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5, 0.5, 0.5],
            [0.75, 0.25, 0.25, 0.25, 0.75, 0.75],
            [0.25, 0.75, 0.75, 0.75, 0.25, 0.25],
            [0.375, 0.375, 0.625, 0.875, 0.375, 0.125],
            [0.875, 0.875, 0.125, 0.375, 0.875, 0.625],
            [0.625, 0.125, 0.875, 0.625, 0.625, 0.875],
            [0.125, 0.625, 0.375, 0.125, 0.125, 0.375],
        ];
        let unit = |dimension, row| digits(dimension, row) as f64 / (1_u64 << BITS) as f64;
        for (row, expected) in expected.into_iter().enumerate() {
            assert_eq!([0, 1, 2, 3, 4, 5].map(|dimension| unit(dimension, row)), expected);
        }
        // Point 1000 in dimensions 100 and 512.
        assert_eq!([99, MOST_DIMENSIONS - 1].map(|dimension| unit(dimension, 1000)), LATE);
    }

    const LATE: [f64; 2] = [0.186_523_437_5, 0.395_507_812_5];

    #[test]
    fn each_column_of_a_power_of_two_has_one_point_in_each_stratum() {
        let sequence = SobolSequence::new(40, 7).unwrap();
        for column in 0..40 {
            let mut strata: Vec<usize> =
                (0..256).map(|row| (sequence.point(row)[column] * 256.0) as usize).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..256), "column {column}");
        }
    }
}
