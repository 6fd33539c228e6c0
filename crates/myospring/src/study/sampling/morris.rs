//! Trajectories for the method of Morris (1991).

use super::random::Random;

/// Trajectories of `dimensions + 1` points on a grid of `levels`: from each point to the next one coordinate moves, by
/// `levels / (2 (levels - 1))`. The point of a row.
pub(super) fn point(levels: usize, dimensions: usize, seed: u64, row: usize) -> Vec<f64> {
    let (last, step) = (levels - 1, levels / 2);
    let (trajectory, moves) = (row / (dimensions + 1), row % (dimensions + 1));
    let mut random = Random::new(seed, trajectory as u64);
    let mut place: Vec<usize> = (0..dimensions).map(|_| random.below(levels)).collect();
    let mut order: Vec<usize> = (0..dimensions).collect();
    random.shuffle(&mut order);
    for &moved in &order[..moves] {
        // Half of the levels lie below the step, so only one direction is possible.
        place[moved] = if place[moved] < step { place[moved] + step } else { place[moved] - step };
    }
    place.iter().map(|&level| level as f64 / last as f64).collect()
}
