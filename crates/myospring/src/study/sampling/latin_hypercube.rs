//! Latin hypercubes (McKay, Beckman and Conover 1979).

use super::random::Random;

/// `size` points: in each column, one in each of `size` strata.
pub(super) fn latin_hypercube(size: usize, dimensions: usize, seed: u64) -> Vec<Vec<f64>> {
    let mut points = vec![vec![0.0; dimensions]; size];
    for column in 0..dimensions {
        let mut random = Random::new(seed, column as u64);
        let mut strata: Vec<usize> = (0..size).collect();
        random.shuffle(&mut strata);
        for (point, stratum) in points.iter_mut().zip(strata) {
            point[column] = (stratum as f64 + random.unit()) / size as f64;
        }
    }
    points
}
