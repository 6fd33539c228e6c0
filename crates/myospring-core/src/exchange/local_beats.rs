//! When each place of a tissue is activated and repolarised, while it is simulated.

use crate::recording::LocalBeat;

/// A potential has repolarised when this part of its height is left.
const LEFT: f64 = 0.1;

/// The highest potential where there is no beat: nothing is above or below it.
const NONE: f64 = f64::NAN;

/// Nodes that are looked at together.
const PIECE: usize = 64;

/// The potential of each node, followed from step to step.
#[derive(Debug, Clone)]
pub(super) struct Followed {
    /// In order of activation, each with its node.
    beats: Vec<(usize, LocalBeat)>,
    /// The last beat of each node, if it has one.
    last: Vec<usize>,
    /// After the last step.
    before: Vec<f64>,
    /// The highest of the last beat; `NONE` once that has repolarised.
    highest: Vec<f64>,
    rest: f64,
    level: f64,
}

impl Followed {
    /// From these potentials on; a place is activated when its potential rises above `level`.
    pub(super) fn new(potentials: Vec<f64>, rest: f64, level: f64) -> Self {
        let count = potentials.len();
        Self {
            beats: Vec::new(),
            last: vec![usize::MAX; count],
            before: potentials,
            highest: vec![NONE; count],
            rest,
            level,
        }
    }

    /// How many nodes there are.
    pub(super) fn nodes(&self) -> usize {
        self.last.len()
    }

    /// The beats of each node, in order of time.
    pub(super) fn beats(&self) -> Vec<Vec<LocalBeat>> {
        let mut beats = vec![Vec::new(); self.last.len()];
        self.beats.iter().for_each(|&(node, beat)| beats[node].push(beat));
        beats
    }

    /// Takes the potentials after a step that ends now; times within it are linear.
    #[allow(
        clippy::needless_bitwise_bool,
        reason = "without branches the loop fills vector registers"
    )]
    pub(super) fn step(&mut self, potentials: &[f64], now: f64, step: f64) {
        let (rest, level) = (self.rest, self.level);
        let low = |highest: f64| rest + LEFT * (highest - rest);
        let pieces = potentials.chunks(PIECE).zip(self.before.chunks_mut(PIECE));
        let pieces = pieces.zip(self.highest.chunks_mut(PIECE)).enumerate();
        for (piece, ((potentials, before), highest)) in pieces {
            // In most pieces no beat begins or ends; one test without branches shows that for all their nodes.
            let nodes = potentials.iter().zip(&*before).zip(&*highest);
            let happens = nodes.fold(false, |any, ((&after, &before), &highest)| {
                any | ((before <= level) & (after > level)) | (after <= low(highest))
            });
            let nodes = potentials.iter().zip(&*before).zip(&mut *highest).enumerate();
            for (at, ((&after, &before), highest)) in nodes.filter(|_| happens) {
                let node = PIECE * piece + at;
                let crossed =
                    |at: f64| now - step * ((after - at) / (after - before)).clamp(0.0, 1.0);
                if before <= level && after > level {
                    let beat = LocalBeat { activated_ms: crossed(level), repolarised_ms: None };
                    self.last[node] = self.beats.len();
                    self.beats.push((node, beat));
                    *highest = after;
                } else if after <= low(*highest) {
                    if let Some((_, beat)) = self.beats.get_mut(self.last[node]) {
                        beat.repolarised_ms = Some(crossed(low(*highest)));
                    }
                    *highest = NONE;
                }
            }
            for (highest, &after) in highest.iter_mut().zip(potentials) {
                // Stays what it is where there is no beat.
                *highest = if after > *highest { after } else { *highest };
            }
            before.copy_from_slice(potentials);
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
