//! One step of all lanes by the method of `stiff` steps; each lane has its own step size.
#![allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::elimination::Elimination;
use crate::cell::stiff::rosenbrock::{A, C, D, GAMMA, STAGES};
use crate::cell::stiff::{LONGEST_MS, restart};
use crate::cell::tomek_2019::lanes::{LANES, MOST, Together, Wide};

const NONE: Wide = [0.0; LANES];

/// Cells being integrated; stored by quantity, then by lane.
pub(super) struct Lanes<const LAND: bool> {
    pub(super) tolerance: f64,
    restart: f64,
    pub(super) cells: Box<Together<LAND>>,
    elimination: Box<Elimination<LAND>>,
    /// Floor in the scale of each variable's error.
    pub(super) floors: [Wide; MOST],
    /// End of the last step, ms, and the state there, after events.
    pub(super) end_ms: Wide,
    pub(super) end: [Wide; MOST],
    /// The step must not pass this time, ms.
    pub(super) stop_ms: Wide,
    /// The step to try next, ms; NaN after an event, when it is chosen from the rates.
    pub(super) planned_ms: Wide,
    /// The step that was tried, ms; whether it ends at the stop; its end state; its error relative
    /// to the tolerance, NaN if its equations could not be solved.
    pub(super) tried_ms: Wide,
    pub(super) to_stop: [bool; LANES],
    pub(super) trial: [Wide; MOST],
    pub(super) error: Wide,
    stages: [[Wide; MOST]; STAGES],
}

impl<const LAND: bool> Lanes<LAND> {
    #[allow(clippy::large_stack_arrays, reason = "made once for many cells, and moved to the heap")]
    pub(super) fn new(tolerance: f64) -> Self {
        Self {
            tolerance,
            restart: restart(tolerance),
            cells: Box::new(Together::new()),
            elimination: Box::new(Elimination::new()),
            floors: [[1.0; LANES]; MOST],
            end_ms: NONE,
            end: [NONE; MOST],
            stop_ms: [f64::INFINITY; LANES],
            planned_ms: [f64::NAN; LANES],
            tried_ms: NONE,
            to_stop: [false; LANES],
            trial: [NONE; MOST],
            error: NONE,
            stages: [[NONE; MOST]; STAGES],
        }
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
    pub(super) fn try_step<S: pulp::Simd>(&mut self, simd: S) {
        let states = Together::<LAND>::STATES;
        let mut per_step = NONE;
        for stage in 0..STAGES {
            for place in 0..states {
                let mut argument = self.end[place];
                for (weight, earlier) in A[stage].iter().zip(&self.stages) {
                    argument = plus(argument, *weight, earlier[place]);
                }
                self.cells.state[place] = argument;
            }
            self.cells.find_rates();
            if stage == 0 {
                self.choose_steps();
                self.cells.find_jacobian();
                let diagonal = self.tried_ms.map(|h| 1.0 / (GAMMA * h));
                self.elimination.factorise(simd, &diagonal, &self.cells, &self.end, &self.floors);
                per_step = self.tried_ms.map(|h| 1.0 / h);
            }
            for place in 0..states {
                let mut bent = NONE;
                for (weight, earlier) in C[stage].iter().zip(&self.stages) {
                    bent = plus(bent, *weight, earlier[place]);
                }
                let rates = self.cells.rates[place];
                self.stages[stage][place] =
                    std::array::from_fn(|lane| rates[lane] + bent[lane] * per_step[lane]);
            }
            self.elimination.solve(simd, &mut self.stages[stage]);
        }
        let mut largest = NONE;
        for place in 0..states {
            // End state: the last argument plus the last stage.
            let errors = self.stages[STAGES - 1][place];
            let end = plus(self.cells.state[place], 1.0, errors);
            self.trial[place] = end;
            let (floors, start) = (self.floors[place], self.end[place]);
            for lane in 0..LANES {
                let (before, after) = (start[lane].abs(), end[lane].abs());
                let size = floors[lane] + if after > before { after } else { before };
                let part = errors[lane].abs() / (self.tolerance * size);
                // NaN stays.
                let larger = (part > largest[lane]) | part.is_nan();
                largest[lane] = if larger { part } else { largest[lane] };
            }
        }
        let doubt = self.elimination.doubt();
        self.error = std::array::from_fn(|lane| largest[lane] + doubt[lane]);
    }

    /// Chooses the step of each lane; after an event, from the rates.
    #[inline(always)]
    fn choose_steps(&mut self) {
        let mut fastest = NONE;
        for place in 0..Together::<LAND>::STATES {
            let (rates, floors, end) =
                (self.cells.rates[place], self.floors[place], self.end[place]);
            for lane in 0..LANES {
                let speed = rates[lane].abs() / (floors[lane] + end[lane].abs());
                fastest[lane] = if speed > fastest[lane] { speed } else { fastest[lane] };
            }
        }
        for lane in 0..LANES {
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
fn plus(sum: Wide, weight: f64, other: Wide) -> Wide {
    std::array::from_fn(|lane| sum[lane] + weight * other[lane])
}

/// One step of all lanes, compiled for each kind of vector unit.
pub(super) struct TryStep<'a, const LAND: bool>(pub(super) &'a mut Lanes<LAND>);

impl<const LAND: bool> pulp::WithSimd for TryStep<'_, LAND> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, simd: S) {
        self.0.try_step(simd);
    }
}
