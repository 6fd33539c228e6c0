//! The frames that the eye can distinguish.

/// Largest number of frames between two that are kept, if they fit.
pub(super) const LONGEST: usize = 12;

/// The frames to keep, so that every point of the others lies within `tolerance` um of the straight
/// line between the two around it: as few as a search over the next `longest` frames finds, the
/// first and last included.
pub(super) fn kept(
    times: &[f64],
    displacements: &[Vec<f32>],
    tolerance: f64,
    longest: usize,
) -> Vec<usize> {
    let Some(last) = times.len().checked_sub(1) else { return Vec::new() };
    let mut kept = vec![0];
    let mut from = 0;
    while from < last {
        let furthest = (from + longest).min(last);
        let fits = |&to: &usize| {
            (from + 1..to).all(|at| {
                let part = ((times[at] - times[from]) / (times[to] - times[from])) as f32;
                let ends = displacements[from].iter().zip(&displacements[to]);
                ends.zip(&displacements[at])
                    .all(|((a, b), now)| f64::from((a + part * (b - a) - now).abs()) <= tolerance)
            })
        };
        let mut to = from + 1;
        while to < furthest && fits(&(to + 1)) {
            to += 1;
        }
        kept.push(to);
        from = to;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_straight_way_needs_its_ends_only_and_a_bend_is_kept() {
        let times: Vec<f64> = (0..11).map(f64::from).collect();
        let straight: Vec<Vec<f32>> = times.iter().map(|&t| vec![t as f32]).collect();
        assert_eq!(kept(&times, &straight, 1e-3, LONGEST), [0, 10]);
        let bent: Vec<Vec<f32>> = times.iter().map(|&t| vec![(t - 5.0).abs() as f32]).collect();
        assert_eq!(kept(&times, &bent, 1e-3, LONGEST), [0, 5, 10]);
        assert_eq!(kept(&times, &bent, 10.0, LONGEST), [0, 10]);
        assert_eq!(kept(&times, &bent, 10.0, 4), [0, 4, 8, 10]);
        assert!(kept(&[], &[], 1.0, LONGEST).is_empty());
    }
}
