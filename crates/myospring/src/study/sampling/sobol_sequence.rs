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

/// The first points of the sequence, from the origin on.
fn points(size: usize, dimensions: usize) -> Result<Vec<Vec<u64>>, SamplingError> {
    if dimensions > MOST_DIMENSIONS {
        return Err(SamplingError::Dimensions { dimensions });
    }
    // In the first dimension digits are turned round: van der Corput's sequence.
    let direction = |dimension: usize, bit: usize| match dimension {
        0 => 1 << (BITS - 1 - bit),
        _ => DIRECTIONS[dimension - 1][bit],
    };
    let mut point = vec![0; dimensions];
    let mut points = Vec::with_capacity(size);
    for index in 1..=size {
        points.push(point.clone());
        // Gray's code: one bit changes from one to the next (Antonov and Saleev 1979).
        let bit = index.trailing_zeros() as usize;
        for (dimension, value) in point.iter_mut().enumerate() {
            *value ^= direction(dimension, bit);
        }
    }
    Ok(points)
}

/// The first points, each digit of a column changed or not as a random number has it: as even as the sequence, and never
/// on the border.
pub(super) fn shifted(
    size: usize,
    dimensions: usize,
    seed: u64,
) -> Result<Vec<Vec<f64>>, SamplingError> {
    let mut random = Random::new(seed, SHIFT);
    let shifts: Vec<u64> = (0..dimensions).map(|_| random.bits() >> (64 - BITS)).collect();
    let place =
        |(value, shift): (u64, &u64)| ((value ^ shift) as f64 + 0.5) / (1_u64 << BITS) as f64;
    let points = points(size, dimensions)?.into_iter();
    Ok(points.map(|point| point.into_iter().zip(&shifts).map(place).collect()).collect())
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
        let unit = |value: &u64| *value as f64 / (1_u64 << BITS) as f64;
        for (point, expected) in points(8, 6).unwrap().iter().zip(expected) {
            assert_eq!(point.iter().map(unit).collect::<Vec<_>>(), expected);
        }
        // Point 1000 in dimensions 100 and 512.
        let last = &points(1001, MOST_DIMENSIONS).unwrap()[1000];
        assert_eq!([99, 511].map(|at: usize| unit(&last[at])), LATE);
    }

    const LATE: [f64; 2] = [0.186_523_437_5, 0.395_507_812_5];

    #[test]
    fn each_column_of_a_power_of_two_has_one_point_in_each_stratum() {
        for column in 0..40 {
            let points = shifted(256, 40, 7).unwrap();
            let mut strata: Vec<usize> =
                points.iter().map(|point| (point[column] * 256.0) as usize).collect();
            strata.sort_unstable();
            assert!(strata.into_iter().eq(0..256), "column {column}");
        }
    }
}
