//! Metrics of a beat of a cell without a mesh.

use crate::analysis::capture::{self, StimulusResponse};
use serde::{Deserialize, Serialize};

/// One beat of a cell, from its stimulus to the next or to the end.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct CellBeat {
    /// Time of the stimulus, ms.
    pub stimulus_ms: f64,
    /// Potential, in the unit of its state, just before the stimulus.
    pub resting_potential: f64,
    /// Highest potential.
    pub peak_potential: f64,
    /// Highest active tension, relative or in kPa as the model says.
    pub peak_tension: f64,
    /// Time of the highest tension, ms, on the clock of the run.
    pub peak_tension_ms: f64,
    /// From the stimulus to 90 % repolarisation, ms: after its peak, the potential has returned by
    /// 90 % towards its value before the stimulus. `None` if it does not within the beat.
    pub apd90_ms: Option<f64>,
}

impl CellBeat {
    /// Whether these beats are sufficient without samples. Samples are needed if a stimulus may
    /// have raised no action potential, or came while the tension of the previous beat was higher
    /// than that of its own; `unit` is that of the potential.
    pub fn suffice(beats: &[Self], unit: &str) -> bool {
        let early = |beat: &Self| beat.peak_tension_ms <= beat.stimulus_ms;
        let response = |beat: &Self| {
            let (rest, peak) = (beat.resting_potential, beat.peak_potential);
            StimulusResponse { rest, met: rest, peak, seen: true }
        };
        let responses: Vec<StimulusResponse> = beats.iter().map(response).collect();
        let missed =
            capture::captures(&responses, capture::least_height(unit)).contains(&Some(false));
        !missed && !beats.iter().any(early)
    }

    /// Reads beats from samples: potential (NaN without one) and tension at ascending times, ms,
    /// and the stimulus times. The potential is interpolated linearly.
    pub fn of_samples(
        times: &[f64],
        potential: &[f64],
        tension: &[f64],
        stimuli_ms: impl Iterator<Item = f64>,
    ) -> Vec<Self> {
        let mut stimuli = stimuli_ms.peekable();
        let mut beats = Vec::new();
        while let Some(stimulus_ms) = stimuli.next() {
            let first = times.partition_point(|time| *time < stimulus_ms);
            let next_ms = stimuli.peek().copied().unwrap_or(f64::INFINITY);
            let end = times.partition_point(|time| *time < next_ms);
            let highest = |column: &[f64]| {
                (first..end).fold(first, |top, at| if column[at] > column[top] { at } else { top })
            };
            if first >= end {
                break;
            }
            let resting_potential = potential[first.saturating_sub(1)];
            let (top, strongest) = (highest(potential), highest(tension));
            let level = resting_potential + 0.1 * (potential[top] - resting_potential);
            let back = (top + 1..end).find(|&at| potential[at] <= level);
            let apd90_ms = back.map(|at| {
                let part = (potential[at - 1] - level) / (potential[at - 1] - potential[at]);
                times[at - 1] + part * (times[at] - times[at - 1]) - stimulus_ms
            });
            beats.push(Self {
                stimulus_ms,
                resting_potential,
                peak_potential: potential[top],
                peak_tension: tension[strongest],
                peak_tension_ms: times[strongest],
                apd90_ms,
            });
        }
        beats
    }
}
