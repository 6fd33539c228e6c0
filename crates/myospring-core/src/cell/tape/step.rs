//! One step of all lanes by the method of `stiff` steps; each lane has its own step size.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]
#![allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]

use super::elimination::Elimination;
use super::graph::Outer;
use super::program::Program;
use crate::cell::stiff::rosenbrock::{A, C, D, GAMMA, STAGES};
use crate::cell::stiff::{LONGEST_MS, restart};
use std::sync::Arc;

/// Number of cells that are integrated together.
pub(super) const LANES: usize = 8;

/// Cells being integrated; stored by quantity, then by lane.
pub(super) struct Lanes<const N: usize> {
    pub(super) tolerance: f64,
    restart: f64,
    program: Arc<Program>,
    elimination: Elimination<N>,
    /// Inputs and working space of the tapes.
    rows: Vec<[f64; N]>,
    /// Floor in the scale of each variable's error.
    pub(super) floors: Vec<[f64; N]>,
    /// End of the last step, ms, and the state there, after events.
    pub(super) end_ms: [f64; N],
    pub(super) end: Vec<[f64; N]>,
    /// The step must not pass this time, ms.
    pub(super) stop_ms: [f64; N],
    /// The step to try next, ms; NaN after an event, when it is chosen from the rates.
    pub(super) planned_ms: [f64; N],
    /// The step that was tried, ms; whether it ends at the stop; its end state; its error relative
    /// to the tolerance, NaN if its equations could not be solved.
    pub(super) tried_ms: [f64; N],
    pub(super) to_stop: [bool; N],
    pub(super) trial: Vec<[f64; N]>,
    pub(super) error: [f64; N],
    stages: [Vec<[f64; N]>; STAGES],
}

impl<const N: usize> Lanes<N> {
    pub(super) fn new(program: &Arc<Program>, tolerance: f64) -> Self {
        let zeros = || vec![[0.0; N]; program.states];
        let rows = program.rates.rows.max(program.jacobian.rows);
        let mut lanes = Self {
            tolerance,
            restart: restart(tolerance),
            program: Arc::clone(program),
            elimination: Elimination::new(&program.plan),
            rows: vec![[0.0; N]; rows],
            floors: vec![[1.0; N]; program.states],
            end_ms: [0.0; N],
            end: zeros(),
            stop_ms: [f64::INFINITY; N],
            planned_ms: [f64::NAN; N],
            tried_ms: [0.0; N],
            to_stop: [false; N],
            trial: zeros(),
            error: [0.0; N],
            stages: std::array::from_fn(|_| zeros()),
        };
        lanes.rows[program.layout.outer(Outer::Stretch)] = [1.0; N];
        lanes
    }

    /// Puts the numbers of a cell into a lane.
    pub(super) fn put(&mut self, lane: usize, fixed: &[f64]) {
        for (row, value) in self.rows.iter_mut().zip(fixed) {
            row[lane] = *value;
        }
    }

    pub(super) fn set_stimulus(&mut self, lane: usize, stimulus: f64) {
        self.rows[self.program.layout.outer(Outer::Stimulus)][lane] = stimulus;
    }

    /// Coefficients of curvature of the step that was tried, as in the curve of a single cell.
    pub(super) fn bends(&self, place: usize, lane: usize) -> [f64; 2] {
        let bend = |weights: &[f64; 5]| {
            let stages = weights.iter().zip(&self.stages);
            stages.map(|(weight, stage)| weight * stage[place][lane]).sum()
        };
        [bend(&D[0]), bend(&D[1])]
    }

    #[inline(always)]
    pub(super) fn try_step(&mut self) {
        let program = Arc::clone(&self.program);
        let states = program.states;
        let first = program.layout.state(0);
        let mut per_step = [0.0; N];
        for stage in 0..STAGES {
            for place in 0..states {
                let mut argument = self.end[place];
                for (weight, earlier) in A[stage].iter().zip(&self.stages) {
                    argument = plus(argument, *weight, &earlier[place]);
                }
                self.rows[first + place] = argument;
            }
            let tape = if stage == 0 { &program.jacobian } else { &program.rates };
            tape.evaluate(&mut self.rows);
            if stage == 0 {
                self.choose_steps(&program);
                let diagonal = self.tried_ms.map(|h| 1.0 / (GAMMA * h));
                let entries = program.jacobian.roots[states..].iter().map(|row| self.rows[*row]);
                self.elimination.factorise(&program.plan, &diagonal, entries);
                per_step = self.tried_ms.map(|h| 1.0 / h);
            }
            let (earlier, this) = self.stages.split_at_mut(stage);
            let this = &mut this[0];
            for place in 0..states {
                let mut bent = [0.0; N];
                for (weight, earlier) in C[stage].iter().zip(&*earlier) {
                    bent = plus(bent, *weight, &earlier[place]);
                }
                let rates = self.rows[tape.roots[place]];
                let mut right = [0.0; N];
                for lane in 0..N {
                    right[lane] = rates[lane] + bent[lane] * per_step[lane];
                }
                this[place] = right;
            }
            self.elimination.solve(&program.plan, this);
        }
        self.finish(first, states);
    }

    /// End state of the step and its error.
    #[inline(always)]
    fn finish(&mut self, first: usize, states: usize) {
        let mut largest = [0.0; N];
        for place in 0..states {
            // End state: the last argument plus the last stage.
            let errors = self.stages[STAGES - 1][place];
            let end = plus(self.rows[first + place], 1.0, &errors);
            self.trial[place] = end;
            let (floors, start) = (self.floors[place], self.end[place]);
            for lane in 0..N {
                let (before, after) = (start[lane].abs(), end[lane].abs());
                let size = floors[lane] + if after > before { after } else { before };
                let part = errors[lane].abs() / (self.tolerance * size);
                // NaN stays.
                let larger = (part > largest[lane]) | part.is_nan();
                largest[lane] = if larger { part } else { largest[lane] };
            }
        }
        let doubt = self.elimination.doubt();
        for lane in 0..N {
            self.error[lane] = largest[lane] + doubt[lane];
        }
    }

    /// Chooses the step of each lane; after an event, from the rates.
    #[inline(always)]
    fn choose_steps(&mut self, program: &Program) {
        let mut fastest = [0.0; N];
        for place in 0..program.states {
            let rates = self.rows[program.jacobian.roots[place]];
            let (floors, end) = (self.floors[place], self.end[place]);
            for lane in 0..N {
                let speed = rates[lane].abs() / (floors[lane] + end[lane].abs());
                fastest[lane] = if speed > fastest[lane] { speed } else { fastest[lane] };
            }
        }
        for lane in 0..N {
            if self.planned_ms[lane].is_nan() {
                self.planned_ms[lane] = (self.restart / fastest[lane]).min(LONGEST_MS);
            }
            // No tiny rest is left before the stop.
            let (planned, room) = (self.planned_ms[lane], self.stop_ms[lane] - self.end_ms[lane]);
            self.to_stop[lane] = 1.01 * planned >= room;
            self.tried_ms[lane] = if self.to_stop[lane] { room } else { planned };
        }
    }
}

/// A number of each lane plus a weight times others.
#[inline(always)]
fn plus<const N: usize>(mut sum: [f64; N], weight: f64, other: &[f64; N]) -> [f64; N] {
    for lane in 0..N {
        sum[lane] += weight * other[lane];
    }
    sum
}

/// One step of all lanes, compiled for each kind of vector unit.
pub(super) struct TryStep<'a, const N: usize>(pub(super) &'a mut Lanes<N>);

impl<const N: usize> pulp::WithSimd for TryStep<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.try_step();
    }
}
