//! One lane's way: its events, whether a step is taken, its samples, its end.

use super::step::Lanes;
use crate::cell::cell_model::{CellModel as _, CellOutcome, CellSample};
use crate::cell::description::Input;
use crate::cell::pacer::Pacer;
use crate::cell::pacing::same_instant;
use crate::cell::settings::SolveError;
use crate::cell::stiff::{self, GROW, LONGEST_MS, SAFETY, SHORTEST_MS, SHRINK};
use crate::cell::tomek_2019::TomekModel;
use crate::cell::tomek_2019::lanes::MOST;

/// What a sample is made of: the potential, calcium, and what of the myofilaments pulls.
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

/// How far a cell has come.
pub(super) enum Moved {
    On,
    ToTheEnd,
    Nowhere(SolveError),
}

impl Course {
    /// At 0 ms, after whatever the protocol does then.
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

    /// Takes the step that was tried, if it is good, or chooses a shorter one.
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
        // A step cut short by the stop says nothing against the step before it.
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
        // A duration that is a multiple of the interval but for rounding keeps its last sample.
        if self.next_ms() > self.duration_ms * (1.0 + 1e-12) { Moved::ToTheEnd } else { Moved::On }
    }

    /// What it did.
    pub(super) fn outcome(&mut self) -> CellOutcome {
        let last = (self.duration_ms / self.interval_ms * (1.0 + 1e-12)).floor() as usize;
        self.samples.truncate(last + 1);
        let samples = std::mem::take(&mut self.samples);
        CellOutcome { beats: Vec::new(), samples, steps: self.steps, refused: self.refused }
    }

    /// Does what the protocol wants now.
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

    /// When the next sample is due, ms.
    fn next_ms(&self) -> f64 {
        self.samples.len() as f64 * self.interval_ms
    }

    /// A sample that falls on the time reached: the state after all that happened then.
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

/// A step that was taken, of what samples are made of.
struct Piece {
    start_ms: f64,
    step_ms: f64,
    /// Start, end and the two bends between them.
    curves: [[f64; 4]; SEEN.len()],
}

/// At a part of a step, `0..=1`.
fn at([start, end, first, second]: [f64; 4], x: f64) -> f64 {
    let rest = 1.0 - x;
    rest * start + x * (end + rest * (first + x * second))
}
