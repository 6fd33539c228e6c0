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
        let mut rates = Rates::new(displacements[from].len());
        let mut to = from + 1;
        while to < furthest {
            let from_start = |at: usize| (times[at] - times[from]) as f32;
            let start = &displacements[from];
            rates.narrow(start, &displacements[to], from_start(to), tolerance as f32);
            if !rates.allow(start, &displacements[to + 1], from_start(to + 1)) {
                break;
            }
            to += 1;
        }
        kept.push(to);
        from = to;
    }
    kept
}

/// For each number, the slopes of the straight lines from the start that pass all values so far within the tolerance.
struct Rates {
    low: Vec<f32>,
    high: Vec<f32>,
}

impl Rates {
    fn new(count: usize) -> Self {
        Self { low: vec![f32::NEG_INFINITY; count], high: vec![f32::INFINITY; count] }
    }

    fn narrow(&mut self, start: &[f32], now: &[f32], after: f32, tolerance: f32) {
        let per = after.recip();
        let bounds = self.low.iter_mut().zip(&mut self.high);
        for ((low, high), (start, now)) in bounds.zip(start.iter().zip(now)) {
            let (least, most) = ((now - start - tolerance) * per, (now - start + tolerance) * per);
            // No number here is NaN, for which `max` and `min` would cost more.
            *low = if least > *low { least } else { *low };
            *high = if most < *high { most } else { *high };
        }
    }

    fn allow(&self, start: &[f32], now: &[f32], after: f32) -> bool {
        let per = after.recip();
        let bounds = self.low.iter().zip(&self.high);
        bounds.zip(start.iter().zip(now)).all(|((low, high), (start, now))| {
            let rate = (now - start) * per;
            (*low..=*high).contains(&rate)
        })
    }
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
