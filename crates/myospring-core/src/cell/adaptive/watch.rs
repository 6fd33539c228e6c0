//! Records the beats of a cell and samples of its state.

use super::branch::State;
use super::lanes::{Lanes, repolarised};
use super::piece::{Piece, root};
use crate::cell::beat::CellBeat;
use crate::cell::pacing::same_instant;

/// Records the beats and samples of one cell; its lane keeps the running maxima.
#[derive(Debug, Clone, Default)]
pub(in crate::cell) struct Watch {
    beat: Option<CellBeat>,
    /// Highest `u` when the end of the action potential was detected.
    top_at_end: Option<f64>,
    pub(in crate::cell) beats: Vec<CellBeat>,
    sample_interval_ms: Option<f64>,
    pub(in crate::cell) samples: Vec<State>,
}

impl Watch {
    pub(super) fn new(sample_interval_ms: Option<f64>) -> Self {
        Self { sample_interval_ms, ..Self::default() }
    }

    /// Resets the running maxima.
    pub(super) fn reset<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
        state: &State,
    ) {
        lanes.resting[lane] = state[0];
        lanes.top_u[lane] = state[0];
        lanes.top_ta[lane] = state[5];
        lanes.top_ta_time[lane] = lanes.time[lane];
        self.top_at_end = None;
    }

    /// Begins a beat at this state.
    pub(super) fn begin_beat<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
        state: &State,
    ) {
        self.end_beat(lanes, lane);
        self.reset(lanes, lane, state);
        self.beat = Some(CellBeat {
            stimulus_ms: lanes.time[lane],
            resting_potential: state[0],
            peak_potential: state[0],
            peak_tension: state[5],
            peak_tension_ms: lanes.time[lane],
            apd90_ms: None,
        });
    }

    /// Ends a beat, at the next stimulus or at the end of the run.
    pub(super) fn end_beat<const N: usize>(&mut self, lanes: &Lanes<N>, lane: usize) {
        if let Some(beat) = self.beat.take() {
            let top = lanes.top_u[lane];
            self.beats.push(CellBeat {
                peak_potential: top,
                peak_tension: lanes.top_ta[lane],
                peak_tension_ms: lanes.top_ta_time[lane],
                // An end before the highest point does not count.
                apd90_ms: beat.apd90_ms.filter(|_| self.top_at_end == Some(top)),
                ..beat
            });
        }
    }

    /// Searches peaks and the end of the action potential within the part of a step up to
    /// `time_ms`.
    pub(super) fn look<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
        piece: &Piece,
        part: f64,
        time_ms: f64,
    ) {
        let (u, ta) = (piece.cubic(0), piece.cubic(5));
        let at = |x: f64| if x < part { piece.start_ms + x * piece.step_ms } else { time_ms };
        for x in ta.peak(part).into_iter().chain([part]) {
            let value = ta.value(x);
            if value > lanes.top_ta[lane] {
                lanes.top_ta[lane] = value;
                lanes.top_ta_time[lane] = at(x);
            }
        }
        let u_end = u.value(part);
        let top = u.peak(part).map_or(u_end, |x| u.value(x).max(u_end)).max(lanes.top_u[lane]);
        lanes.top_u[lane] = top;
        let level = repolarised(lanes.resting[lane], top);
        if let Some(beat) = &mut self.beat
            && self.top_at_end != Some(top)
            && piece.states[0][0] > level
            && u_end <= level
        {
            beat.apd90_ms = Some(at(root(|x| u.value(x) - level, part)) - beat.stimulus_ms);
            self.top_at_end = Some(top);
        }
    }

    /// The samples that fall within a step before `time_ms`.
    pub(super) fn sample_before<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
        piece: &Piece,
        time_ms: f64,
    ) {
        if let Some(interval_ms) = self.sample_interval_ms {
            while lanes.sample[lane] < time_ms && !same_instant(lanes.sample[lane], time_ms) {
                self.samples.push(piece.state_at(lanes.sample[lane]));
                lanes.sample[lane] = self.samples.len() as f64 * interval_ms;
            }
        }
    }

    /// Takes a sample at the time reached, after all events at that time.
    pub(super) fn sample_now<const N: usize>(&mut self, lanes: &mut Lanes<N>, lane: usize) {
        if let Some(interval_ms) = self.sample_interval_ms {
            let (sample_ms, time_ms) = (lanes.sample[lane], lanes.time[lane]);
            if sample_ms <= time_ms || same_instant(sample_ms, time_ms) {
                self.samples.push(Lanes::get(&lanes.state, lane));
            }
            lanes.sample[lane] = self.samples.len() as f64 * interval_ms;
        }
    }
}
