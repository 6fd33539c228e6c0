//! The integration of one lane: events, acceptance of steps, samples, end.

use super::member::Member;
use super::step::Lanes;
use crate::cell::cell_model::{CellModel, CellOutcome, CellSample};
use crate::cell::description::Input;
use crate::cell::pacer::Pacer;
use crate::cell::pacing::same_instant;
use crate::cell::settings::SolveError;
use crate::cell::stiff::{self, GROW, LONGEST_MS, SAFETY, SHORTEST_MS, SHRINK};

/// A cell in a lane.
pub(super) struct Course<'a> {
    model: &'a dyn CellModel,
    /// The states from which samples are computed.
    seen: &'a [usize],
    pacer: Pacer,
    duration_ms: f64,
    interval_ms: f64,
    samples: Vec<CellSample>,
    steps: u64,
    refused: u64,
    state: Vec<f64>,
    curves: Vec<[f64; 4]>,
}

/// Progress of a cell.
pub(super) enum Moved {
    On,
    ToTheEnd,
    Nowhere(SolveError),
}

impl<'a> Course<'a> {
    /// Starts a cell at 0 ms, after the protocol's events at 0 ms.
    pub(super) fn start<const N: usize>(
        member: &'a Member<'a>,
        interval_ms: f64,
        lanes: &mut Lanes<N>,
        lane: usize,
    ) -> Self {
        let Member { cell, compiled, pacer } = member;
        let model: &dyn CellModel = &**cell.model();
        lanes.put(lane, &compiled.fixed);
        let state = model.initial_state();
        for (row, value) in lanes.end.iter_mut().zip(&state) {
            row[lane] = *value;
        }
        for (row, variable) in lanes.floors.iter_mut().zip(model.states()) {
            row[lane] = stiff::floor(variable);
        }
        lanes.end_ms[lane] = 0.0;
        lanes.planned_ms[lane] = f64::NAN;
        let mut course = Self {
            model,
            seen: &compiled.seen,
            pacer: pacer.clone(),
            duration_ms: cell.duration_ms(),
            interval_ms,
            samples: Vec::new(),
            steps: 0,
            refused: 0,
            state,
            curves: Vec::new(),
        };
        course.act(lanes, lane);
        course.sample_now(lanes, lane);
        course
    }

    /// Accepts the step that was tried, if it is accurate, or chooses a shorter one.
    pub(super) fn follow<const N: usize>(&mut self, lanes: &mut Lanes<N>, lane: usize) -> Moved {
        let (error, tried_ms) = (lanes.error[lane], lanes.tried_ms[lane]);
        // The companion's error per step is of order 4.
        let factor = if error.is_nan() {
            SHRINK
        } else {
            (SAFETY / error.max(1e-12).sqrt().sqrt()).clamp(SHRINK, GROW)
        };
        let start_ms = lanes.end_ms[lane];
        if error > 1.0 || error.is_nan() {
            self.refused += 1;
            lanes.planned_ms[lane] = tried_ms * factor;
            if tried_ms < SHORTEST_MS || start_ms + tried_ms == start_ms {
                return Moved::Nowhere(self.stalled(lanes, lane));
            }
            return Moved::On;
        }
        self.steps += 1;
        let next = tried_ms * factor;
        // A step shortened by the stop does not reduce the following step.
        let next = if lanes.to_stop[lane] { next.max(lanes.planned_ms[lane]) } else { next };
        lanes.planned_ms[lane] = next.min(LONGEST_MS);
        lanes.end_ms[lane] =
            if lanes.to_stop[lane] { lanes.stop_ms[lane] } else { start_ms + tried_ms };
        let curve = |place: &usize| {
            let [first, second] = lanes.bends(*place, lane);
            [lanes.end[*place][lane], lanes.trial[*place][lane], first, second]
        };
        self.curves.clear();
        if self.next_ms() < lanes.end_ms[lane] {
            self.curves.extend(self.seen.iter().map(curve));
        }
        for (end, trial) in lanes.end.iter_mut().zip(&lanes.trial) {
            end[lane] = trial[lane];
        }
        self.act(lanes, lane);
        while self.next_ms() < lanes.end_ms[lane]
            && !same_instant(self.next_ms(), lanes.end_ms[lane])
        {
            let x = (self.next_ms() - start_ms) / tried_ms;
            for (place, curve) in self.seen.iter().zip(&self.curves) {
                self.state[*place] = at(*curve, x);
            }
            self.sample();
        }
        self.sample_now(lanes, lane);
        // If the duration is a multiple of the interval except for rounding, the last sample is
        // kept.
        if self.next_ms() > self.duration_ms * (1.0 + 1e-12) { Moved::ToTheEnd } else { Moved::On }
    }

    /// Its outcome.
    pub(super) fn outcome(&mut self) -> CellOutcome {
        let last = (self.duration_ms / self.interval_ms * (1.0 + 1e-12)).floor() as usize;
        self.samples.truncate(last + 1);
        let samples = std::mem::take(&mut self.samples);
        CellOutcome { beats: Vec::new(), samples, steps: self.steps, refused: self.refused }
    }

    /// Applies the protocol's events at the current time.
    fn act<const N: usize>(&mut self, lanes: &mut Lanes<N>, lane: usize) {
        for (value, row) in self.state.iter_mut().zip(&lanes.end) {
            *value = row[lane];
        }
        if self.pacer.act(lanes.end_ms[lane], &mut self.state) {
            for (row, value) in lanes.end.iter_mut().zip(&self.state) {
                row[lane] = *value;
            }
            lanes.planned_ms[lane] = f64::NAN;
        }
        lanes.set_stimulus(lane, self.pacer.current());
        lanes.stop_ms[lane] = self.pacer.next_ms().unwrap_or(f64::INFINITY);
    }

    /// Time of the next sample, ms.
    fn next_ms(&self) -> f64 {
        self.samples.len() as f64 * self.interval_ms
    }

    /// Takes a sample at the time reached, after all events at that time.
    fn sample_now<const N: usize>(&mut self, lanes: &Lanes<N>, lane: usize) {
        if same_instant(self.next_ms(), lanes.end_ms[lane]) {
            for place in self.seen {
                self.state[*place] = lanes.end[*place][lane];
            }
            self.sample();
        }
    }

    fn sample(&mut self) {
        self.samples.push(CellSample::of(self.model, &self.state, &Input::REST));
    }

    fn stalled<const N: usize>(&self, lanes: &Lanes<N>, lane: usize) -> SolveError {
        let states = self.model.states();
        let finite = |place: usize| lanes.trial[place][lane].is_finite();
        let worst = (0..states.len()).find(|place| !finite(*place)).unwrap_or(0);
        SolveError::Stalled {
            model: self.model.name().to_owned(),
            variable: states[worst].name.to_string(),
            value: lanes.trial[worst][lane],
            time_ms: lanes.end_ms[lane],
            step_ms: lanes.tried_ms[lane],
        }
    }
}

/// Value at a fraction of a step, `0..=1`.
fn at([start, end, first, second]: [f64; 4], x: f64) -> f64 {
    let rest = 1.0 - x;
    rest * start + x * (end + rest * (first + x * second))
}
