//! Trajectories for the method of Morris (1991).

use super::random::Random;

/// Trajectories of `dimensions + 1` points on a grid of `levels`: from each point to the next one coordinate moves, by
/// `levels / (2 (levels - 1))`.
pub(super) fn trajectories(
    count: usize,
    levels: usize,
    dimensions: usize,
    seed: u64,
) -> Vec<Vec<f64>> {
    let last = levels - 1;
    let step = levels / 2;
    let mut rows = Vec::with_capacity(count * (dimensions + 1));
    for trajectory in 0..count {
        let mut random = Random::new(seed, trajectory as u64);
        let mut place: Vec<usize> = (0..dimensions).map(|_| random.below(levels)).collect();
        let mut order: Vec<usize> = (0..dimensions).collect();
        random.shuffle(&mut order);
        let mut keep = |place: &[usize]| {
            rows.push(place.iter().map(|&level| level as f64 / last as f64).collect());
        };
        keep(&place);
        for moved in order {
            // Half of the levels lie below the step, so there is one way to go.
            place[moved] =
                if place[moved] < step { place[moved] + step } else { place[moved] - step };
            keep(&place);
        }
    }
    rows
}
