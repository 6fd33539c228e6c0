//! The integration of one lane: events, acceptance of steps, samples, end.

use super::step::Lanes;
use crate::cell::cell_model::{CellModel as _, CellOutcome, CellSample};
use crate::cell::description::Input;
use crate::cell::pacer::Pacer;
use crate::cell::pacing::same_instant;
use crate::cell::settings::SolveError;
use crate::cell::stiff::{self, GROW, LONGEST_MS, SAFETY, SHORTEST_MS, SHRINK};
use crate::cell::tomek_2019::TomekModel;
use crate::cell::tomek_2019::lanes::MOST;

/// States from which a sample is computed: potential, calcium, and the myofilament states of
/// tension.
const SEEN: [usize; 6] = [0, 5, 43, 44, 47, 48];

/// A cell in a lane.
pub(super) struct Course {
    model: TomekModel,
    pacer: Pacer,
    duration_ms: f64,
    interval_ms: f64,
    samples: Vec<CellSample>,
    steps: u64,
    refused: u64,
}

/// Progress of a cell.
pub(super) enum Moved {
    On,
    ToTheEnd,
    Nowhere(SolveError),
}

impl Course {
    /// Starts a cell at 0 ms, after the protocol's events at 0 ms.
    pub(super) fn start<const LAND: bool>(
        model: &TomekModel,
        pacer: &Pacer,
        duration_ms: f64,
        interval_ms: f64,
        lanes: &mut Lanes<LAND>,
        lane: usize,
    ) -> Self {
        let start = lanes.cells.put(lane, model);
        for (row, value) in lanes.end.iter_mut().zip(start) {
            row[lane] = value;
        }
        let floors = model.states().iter().map(stiff::floor);
        for (row, floor) in lanes.floors.iter_mut().zip(floors.chain(std::iter::repeat(1.0))) {
            row[lane] = floor;
        }
        lanes.end_ms[lane] = 0.0;
        lanes.planned_ms[lane] = f64::NAN;
        let (model, pacer, samples) = (model.clone(), pacer.clone(), Vec::new());
        let mut course =
            Self { model, pacer, duration_ms, interval_ms, samples, steps: 0, refused: 0 };
        course.act(lanes, lane);
        course.sample_now(lanes, lane);
        course
    }

    /// Accepts the step that was tried, if it is accurate, or chooses a shorter one.
    pub(super) fn follow<const LAND: bool>(
        &mut self,
        lanes: &mut Lanes<LAND>,
        lane: usize,
    ) -> Moved {
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
        let curve = |place: usize| {
            let [first, second] = lanes.bends(place, lane);
            [lanes.end[place][lane], lanes.trial[place][lane], first, second]
        };
        let piece = Piece { start_ms, step_ms: tried_ms, curves: SEEN.map(curve) };
        for (end, trial) in lanes.end.iter_mut().zip(&lanes.trial) {
            end[lane] = trial[lane];
        }
        self.act(lanes, lane);
        while self.next_ms() < lanes.end_ms[lane]
            && !same_instant(self.next_ms(), lanes.end_ms[lane])
        {
            let x = (self.next_ms() - piece.start_ms) / piece.step_ms;
            self.sample(piece.curves.map(|curve| at(curve, x)));
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
    fn act<const LAND: bool>(&mut self, lanes: &mut Lanes<LAND>, lane: usize) {
        let mut state = lanes.end.map(|row| row[lane]);
        if self.pacer.act(lanes.end_ms[lane], &mut state) {
            for (row, value) in lanes.end.iter_mut().zip(state) {
                row[lane] = value;
            }
            lanes.planned_ms[lane] = f64::NAN;
        }
        lanes.cells.stimulus[lane] = self.pacer.current();
        lanes.stop_ms[lane] = self.pacer.next_ms().unwrap_or(f64::INFINITY);
    }

    /// Time of the next sample, ms.
    fn next_ms(&self) -> f64 {
        self.samples.len() as f64 * self.interval_ms
    }

    /// Takes a sample at the time reached, after all events at that time.
    fn sample_now<const LAND: bool>(&mut self, lanes: &Lanes<LAND>, lane: usize) {
        if same_instant(self.next_ms(), lanes.end_ms[lane]) {
            self.sample(SEEN.map(|place| lanes.end[place][lane]));
        }
    }

    fn sample(&mut self, seen: [f64; SEEN.len()]) {
        let mut state = [0.0; MOST];
        for (place, value) in SEEN.into_iter().zip(seen) {
            state[place] = value;
        }
        self.samples.push(CellSample::of(&self.model, &state, &Input::REST));
    }

    fn stalled<const LAND: bool>(&self, lanes: &Lanes<LAND>, lane: usize) -> SolveError {
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

/// An accepted step, for the states in samples.
struct Piece {
    start_ms: f64,
    step_ms: f64,
    /// Start, end, and the two coefficients of curvature.
    curves: [[f64; 4]; SEEN.len()],
}

/// Value at a fraction of a step, `0..=1`.
fn at([start, end, first, second]: [f64; 4], x: f64) -> f64 {
    let rest = 1.0 - x;
    rest * start + x * (end + rest * (first + x * second))
}
