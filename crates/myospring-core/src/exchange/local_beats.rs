//! When each place of a tissue is activated and repolarised, while it is simulated.

use crate::recording::LocalBeat;

/// A potential has repolarised when this part of its height is left.
const LEFT: f64 = 0.1;

/// The potential of each node, followed from step to step.
#[derive(Debug, Clone)]
pub(super) struct Followed {
    beats: Vec<Vec<LocalBeat>>,
    /// After the last step.
    before: Vec<f64>,
    /// The highest of the last beat; `None` once that has repolarised.
    highest: Vec<Option<f64>>,
    rest: f64,
    level: f64,
}

impl Followed {
    /// From these potentials on; a place is activated when its potential rises above `level`.
    pub(super) fn new(potentials: Vec<f64>, rest: f64, level: f64) -> Self {
        let count = potentials.len();
        Self {
            beats: vec![Vec::new(); count],
            before: potentials,
            highest: vec![None; count],
            rest,
            level,
        }
    }

    /// The beats of each node.
    pub(super) fn beats(&self) -> &[Vec<LocalBeat>] {
        &self.beats
    }

    /// Takes the potentials after a step that ends now; times within it are linear.
    pub(super) fn step(&mut self, potentials: &[f64], now: f64, step: f64) {
        let Self { beats, before, highest, rest, level } = self;
        let nodes = beats.iter_mut().zip(before).zip(highest);
        for (((beats, before), highest), &after) in nodes.zip(potentials) {
            let crossed = |at: f64| now - step * ((after - at) / (after - *before)).clamp(0.0, 1.0);
            if *before <= *level && after > *level {
                beats.push(LocalBeat { activated_ms: crossed(*level), repolarised_ms: None });
                *highest = Some(after);
            } else if let Some(top) = *highest {
                let low = *rest + LEFT * (top - *rest);
                if after <= low {
                    if let Some(last) = beats.last_mut() {
                        last.repolarised_ms = Some(crossed(low));
                    }
                    *highest = None;
                } else {
                    *highest = Some(top.max(after));
                }
            }
            *before = after;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Follows one potential with steps of 1 ms from 0 ms on.
    fn follow(potentials: &[f64]) -> Vec<LocalBeat> {
        let mut followed = Followed::new(vec![potentials[0]], 0.0, 0.5);
        for (ms, potential) in potentials.iter().enumerate().skip(1) {
            followed.step(&[*potential], ms as f64, 1.0);
        }
        followed.beats()[0].clone()
    }

    #[test]
    fn a_beat_is_activated_and_repolarised_between_steps() {
        let beat = LocalBeat { activated_ms: 1.25, repolarised_ms: Some(6.5) };
        assert_eq!(follow(&[0.0, 0.3, 1.1, 2.0, 1.0, 0.7, 0.3, 0.1]), [beat]);
        assert_eq!(follow(&[0.0, 0.4, 0.3]), []);
    }

    #[test]
    fn a_place_that_is_activated_again_before_it_has_repolarised_has_another_beat() {
        let beats = follow(&[0.0, 1.0, 0.4, 1.0, 0.6, 0.05]);
        assert_eq!(beats.len(), 2);
        assert_eq!(beats[0], LocalBeat { activated_ms: 0.5, repolarised_ms: None });
        assert!((beats[1].repolarised_ms.unwrap() - (5.0 - 0.05 / 0.55)).abs() < 1e-12);
    }
}
