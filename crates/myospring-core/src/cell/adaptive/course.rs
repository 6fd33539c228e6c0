//! Integrates one cell: switches, sliding and stimuli between smooth steps.

use super::branch::{Branch, Field, Pieces, Side, Sliding, State};
use super::lanes::{FLOOR, LONGEST_MS, Lanes, STALLED};
use super::piece::{Cubic, Piece, root};
use super::watch::Watch;
use crate::cell::pacing::{Event, Protocol};

/// First step after a switch, as a part of the step that the tolerance would allow for a straight
/// line.
const RESTART: f64 = 0.3;
/// After this number of consecutive switches less than [`PROGRESS_MS`] apart, the cell is stuck.
const STANDSTILL: u32 = 50;
const PROGRESS_MS: f64 = 1e-9;

/// Which smooth field applies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Place {
    /// Between two thresholds of `u`.
    Region(usize),
    /// Sliding along this threshold.
    Switch(usize),
}

/// What ends a step early.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Crossing {
    /// `u` reaches a threshold, from below or from above.
    Threshold { index: usize, from_below: bool },
    /// The switch no longer holds `u`; it leaves upwards or downwards.
    Leaves { index: usize, upwards: bool },
    /// `Ta_i` reaches `x_3`.
    Onset,
}

/// No step, however small, succeeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::cell) struct Stuck {
    pub(super) time_ms: f64,
    pub(super) step_ms: f64,
    /// Where the step would have ended.
    pub(super) state: State,
}

/// A cell to be integrated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::cell) struct Task {
    pub(in crate::cell) pieces: Pieces,
    pub(in crate::cell) initial_state: State,
    pub(in crate::cell) protocol: Protocol,
    pub(in crate::cell) duration_ms: f64,
    pub(in crate::cell) sample_interval_ms: Option<f64>,
}

/// The integration of one cell.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Course {
    pieces: Pieces,
    protocol: Protocol,
    duration_ms: f64,
    place: Place,
    delayed: bool,
    stimulus: f64,
    next_event: u64,
    standstill: u32,
    pub(in crate::cell) watch: Watch,
    /// The last step that was taken here, and their number.
    pub(super) piece: Piece,
    pub(in crate::cell) steps: u64,
}

impl Course {
    /// Puts a cell into a lane, at 0 ms, after the protocol's events at 0 ms.
    pub(in crate::cell) fn start<const N: usize>(
        task: &Task,
        lanes: &mut Lanes<N>,
        lane: usize,
    ) -> Self {
        let mut course = Self {
            pieces: task.pieces,
            protocol: task.protocol,
            duration_ms: task.duration_ms,
            place: Place::Region(0),
            delayed: true,
            stimulus: 0.0,
            next_event: 0,
            standstill: 0,
            watch: Watch::new(task.sample_interval_ms),
            piece: Piece::default(),
            steps: 0,
        };
        let mut state = task.initial_state;
        lanes.time[lane] = 0.0;
        lanes.step[lane] = f64::INFINITY;
        lanes.taken[lane] = 0;
        lanes.refused[lane] = 0;
        Lanes::put(&mut lanes.state, lane, state);
        course.watch.reset(lanes, lane, &state);
        course.locate(&state);
        course.events(lanes, lane, &mut state);
        course.enter(lanes, lane);
        course.piece.states = [state; 2];
        lanes.sample[lane] = if task.sample_interval_ms.is_some() { 0.0 } else { f64::INFINITY };
        course.watch.sample_now(lanes, lane);
        course
    }

    /// Time since the last stimulus began, ms, and the current of the stimulus, at the time reached.
    pub(super) fn since_stimulus(&self, time_ms: f64) -> (f64, f64) {
        (self.protocol.since_stimulus(time_ms), self.stimulus)
    }

    /// Accepts the step that a lane tried, up to the first event within it, and handles that event.
    /// True when the cell has reached its end.
    pub(in crate::cell) fn attend<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
    ) -> Result<bool, Stuck> {
        let piece = Piece {
            start_ms: lanes.time[lane],
            step_ms: lanes.tried[lane],
            states: [Lanes::get(&lanes.state, lane), Lanes::get(&lanes.new_state, lane)],
            rates: [Lanes::get(&lanes.rates, lane), Lanes::get(&lanes.new_rates, lane)],
        };
        let stuck =
            Stuck { time_ms: piece.start_ms, step_ms: piece.step_ms, state: piece.states[1] };
        if lanes.attention[lane] & STALLED != 0 {
            return Err(stuck);
        }
        self.steps += 1;
        self.piece = piece;
        let (part, crossing) = self.first_crossing(lanes, lane);
        let time_ms =
            if part < 1.0 { piece.start_ms + part * piece.step_ms } else { lanes.new_time[lane] };
        self.watch.sample_before(lanes, lane, &piece, time_ms);
        self.watch.look(lanes, lane, &piece, part, time_ms);

        let mut state = piece.state(part);
        lanes.time[lane] = time_ms;
        Lanes::put(&mut lanes.state, lane, state);
        Lanes::put(&mut lanes.rates, lane, piece.rates[1]);
        if let Some(crossing) = crossing {
            self.standstill =
                if time_ms - piece.start_ms > PROGRESS_MS { 0 } else { self.standstill + 1 };
            if self.standstill > STANDSTILL {
                return Err(stuck);
            }
            self.cross(crossing, &mut state);
            Lanes::put(&mut lanes.state, lane, state);
            self.enter(lanes, lane);
        }
        if time_ms >= lanes.stop[lane] {
            if self.events(lanes, lane, &mut state) {
                self.enter(lanes, lane);
            }
            if time_ms >= self.duration_ms {
                self.watch.end_beat(lanes, lane);
                self.watch.sample_now(lanes, lane);
                return Ok(true);
            }
        }
        self.watch.sample_now(lanes, lane);
        Ok(false)
    }

    /// The first crossing within the step: its position, as a part of the step, and its kind.
    fn first_crossing<const N: usize>(
        &self,
        lanes: &Lanes<N>,
        lane: usize,
    ) -> (f64, Option<Crossing>) {
        let piece = &self.piece;
        let mut first = (1.0, None);
        let mut consider = |part: f64, crossing| {
            if part < first.0 || first.1.is_none() {
                first = (part, Some(crossing));
            }
        };
        // If the end is past the bound by less than the cubic's rounding, the crossing is at the
        // end.
        let leaves = |curve: &Cubic, end: f64, bound: f64, sign: f64| {
            let past = (sign * (end - bound) < 0.0).then_some(1.0);
            curve.inside(bound, sign).first_root().or(past)
        };
        match self.place {
            Place::Region(region) => {
                let [low, high] = self.pieces.interval(region);
                let (curve, end) = (piece.cubic(0), piece.states[1][0]);
                if let Some(part) = leaves(&curve, end, low, 1.0) {
                    consider(part, Crossing::Threshold { index: region - 1, from_below: false });
                }
                if let Some(part) = leaves(&curve, end, high, -1.0) {
                    consider(part, Crossing::Threshold { index: region, from_below: true });
                }
            }
            Place::Switch(index) => {
                let sides = lanes.sides(lane);
                let holds = sides.holds(&piece.states[1]);
                for (which, upwards) in [(0, true), (1, false)] {
                    if holds[which] <= 0.0 {
                        let part = root(|x| sides.holds(&piece.state(x))[which], 1.0);
                        consider(part, Crossing::Leaves { index, upwards });
                    }
                }
            }
        }
        let [low, high] = Lanes::get(&lanes.ta_i_within, lane);
        for (bound, sign) in [(low, 1.0), (high, -1.0)] {
            if bound.is_finite()
                && let Some(part) = leaves(&piece.cubic(4), piece.states[1][4], bound, sign)
            {
                consider(part, Crossing::Onset);
            }
        }
        first
    }

    /// Changes to the other side.
    fn cross(&mut self, crossing: Crossing, state: &mut State) {
        match crossing {
            Crossing::Threshold { index, from_below } => {
                state[0] = self.pieces.thresholds()[index];
                self.place = self.settle(index, state, Some(from_below));
            }
            Crossing::Leaves { index, upwards } => {
                state[0] = self.pieces.thresholds()[index];
                self.place = Place::Region(index + usize::from(upwards));
            }
            Crossing::Onset => state[4] = self.pieces.onset(),
        }
        self.choose_onset(state);
    }

    /// Determines the region of a state that was not reached by integration.
    fn locate(&mut self, state: &State) {
        let thresholds = self.pieces.thresholds();
        self.place = match thresholds.iter().position(|threshold| *threshold == state[0]) {
            Some(index) => self.settle(index, state, None),
            None => Place::Region(thresholds.iter().filter(|theta| **theta < state[0]).count()),
        };
        self.choose_onset(state);
    }

    /// Where a state on a threshold continues: into the region to which the flow points, or along
    /// the switch if both sides point at it. If both point away, it continues in its previous
    /// direction, or upwards if there is none.
    fn settle(&self, index: usize, state: &State, from_below: Option<bool>) -> Place {
        let rate = |region| self.side(region, state[0]).u_rate(state);
        let (below, above) = (rate(index), rate(index + 1));
        // One side may just touch the threshold: du/dt vanishes there, and also in the mixture.
        if (below > 0.0 && above <= 0.0) || (below >= 0.0 && above < 0.0) {
            Place::Switch(index)
        } else if below >= 0.0 && above >= 0.0 {
            Place::Region(index + 1)
        } else if below <= 0.0 && above <= 0.0 {
            Place::Region(index)
        } else {
            Place::Region(index + usize::from(from_below.unwrap_or(true)))
        }
    }

    /// Chooses the side of `x_3`; exactly on it, the side to which `Ta_i` moves.
    fn choose_onset(&mut self, state: &State) {
        let [u, .., ta_i, _] = *state;
        let onset = self.pieces.onset();
        let region = match self.place {
            Place::Region(region) | Place::Switch(region) => region,
        };
        let rises = || self.side(region, u).rates(state)[4] >= 0.0;
        self.delayed = ta_i < onset || (ta_i == onset && !rises());
    }

    fn side(&self, region: usize, u: f64) -> Side {
        self.pieces.branch(region, self.delayed, self.stimulus).at(u)
    }

    /// Gives the lane the field that applies now, with its rates and a first step.
    fn enter<const N: usize>(&self, lanes: &mut Lanes<N>, lane: usize) {
        let state = Lanes::get(&lanes.state, lane);
        let (rates, switches_tension) = match self.place {
            Place::Region(region) => {
                let branch = self.pieces.branch(region, self.delayed, self.stimulus);
                Lanes::put(&mut lanes.branch, lane, branch.to_array());
                lanes.sliding[lane] = 0.0;
                Lanes::put(&mut lanes.u_within, lane, self.pieces.interval(region));
                (branch.rates(&state), self.pieces.switches_tension(region))
            }
            Place::Switch(index) => {
                let [below, above] = [index, index + 1].map(|region| self.side(region, state[0]));
                for (k, number) in below.to_array().into_iter().chain(above.to_array()).enumerate()
                {
                    lanes.sides[k][lane] = number;
                }
                // The other loop also runs over this lane; with zero rates it stays finite.
                Lanes::put(&mut lanes.branch, lane, Branch::asleep().to_array());
                lanes.sliding[lane] = 1.0;
                (Sliding { below, above }.rates(&state), self.pieces.switches_tension(index + 1))
            }
        };
        Lanes::put(&mut lanes.rates, lane, rates);
        let onset = self.pieces.onset();
        let ta_i_within = match (switches_tension, self.delayed) {
            (false, _) => [f64::NEG_INFINITY, f64::INFINITY],
            (true, true) => [f64::NEG_INFINITY, onset],
            (true, false) => [onset, f64::INFINITY],
        };
        Lanes::put(&mut lanes.ta_i_within, lane, ta_i_within);
        let speed =
            (0..6).map(|k| rates[k].abs() / (FLOOR[k] + state[k].abs())).fold(0.0, f64::max);
        let step_ms = (RESTART * lanes.tolerance.cbrt() / speed).min(LONGEST_MS);
        lanes.step[lane] = lanes.step[lane].min(step_ms);
    }

    /// Applies the protocol's events at the time reached; true if there were any.
    fn events<const N: usize>(
        &mut self,
        lanes: &mut Lanes<N>,
        lane: usize,
        state: &mut State,
    ) -> bool {
        let time_ms = lanes.time[lane];
        let mut any = false;
        let next_ms = loop {
            let Some((event_ms, event)) = self.protocol.nth_event(self.next_event) else {
                break f64::INFINITY;
            };
            if event_ms > time_ms {
                break event_ms;
            }
            match event {
                Event::Jump(amplitude) => {
                    self.watch.begin_beat(lanes, lane, state);
                    state[0] += amplitude;
                }
                Event::CurrentOn(rate) => {
                    self.watch.begin_beat(lanes, lane, state);
                    self.stimulus = rate;
                }
                Event::CurrentOff => self.stimulus = 0.0,
            }
            self.next_event += 1;
            any = true;
        };
        if any {
            self.locate(state);
            Lanes::put(&mut lanes.state, lane, *state);
            lanes.top_u[lane] = lanes.top_u[lane].max(state[0]);
            lanes.step[lane] = f64::INFINITY;
        }
        lanes.stop[lane] = next_ms.min(self.duration_ms);
        any
    }
}
