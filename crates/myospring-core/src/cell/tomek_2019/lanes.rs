//! The equations of several cells at once: loops over cells around those of one, which the compiler vectorises.
//!
//! It does so only if a loop makes no calls and the compiler can see that no memory overlaps, so
//! everything that the loops read and write is in one structure.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::TomekModel;
use super::equations::{BEHIND, Form, GATES, Outside, Parts, other_rates};
use super::gate::Moving;
use super::parameters::Parameters;
use super::rates::gates;
use super::state::{Chloride, Gates, State};
use crate::cell::land_2017::{Myofilaments, NUMBERS};
use crate::cell::number::{Dual, Number, inlined};

/// Number of cells in lanes.
pub(in crate::cell) const LANES: usize = 8;
/// One number per lane.
pub(in crate::cell) type Wide = [f64; LANES];
/// Number of states of the largest form, of gates, and of states that are not gates.
pub(in crate::cell) const MOST: usize = Form::Land.len();
pub(in crate::cell) const GATED: usize = Gates::LEN;
pub(in crate::cell) const OTHERS: usize = MOST - GATED;
/// Number of directions of simultaneous differentiation.
const DIRECTIONS: usize = 5;
/// Columns of the Jacobian, rounded up.
pub(in crate::cell) const COLUMNS: usize = MOST.next_multiple_of(DIRECTIONS);

/// Several cells, all of them with myofilaments (`LAND`), or all without. With constant chloride,
/// it is a state that does not change.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Together<const LAND: bool> {
    /// State at which rates and Jacobian are computed, in the order of the model's states; constant
    /// chloride comes last.
    pub(in crate::cell) state: [Wide; MOST],
    /// The stimulus that acts, A/F.
    pub(in crate::cell) stimulus: Wide,
    /// The rates there.
    pub(in crate::cell) rates: [Wide; MOST],
    /// The derivative of each gate's rate with respect to the potential, and to the gate itself.
    pub(in crate::cell) gate_by_potential: [Wide; GATED],
    pub(in crate::cell) gate_by_itself: [Wide; GATED],
    /// The derivatives of the other rates with respect to each state.
    pub(in crate::cell) by_state: Box<[[Wide; OTHERS]; COLUMNS]>,
    parameters: [Wide; Parameters::LEN],
    myofilaments: [Wide; NUMBERS],
    /// 1 with dynamic chloride, else 0.
    chloride_moves: Wide,
    /// 1 for the states of the present directions of differentiation, else 0.
    active: [Wide; MOST],
    block: [[Wide; OTHERS]; DIRECTIONS],
}

impl<const LAND: bool> Together<LAND> {
    /// Number of integrated states.
    pub(in crate::cell) const STATES: usize =
        if LAND { Form::Land.len() } else { Form::MovingChloride.len() };
    /// Number of those that are not gates.
    pub(in crate::cell) const UNGATED: usize = Self::STATES - GATED;

    /// Index of the first gate.
    pub(in crate::cell) const GATES: usize = GATES;

    /// Index among all states of a state that is not a gate.
    pub(in crate::cell) const fn place(other: usize) -> usize {
        if other < GATES { other } else { other + GATED }
    }

    /// Empty lanes.
    #[allow(clippy::large_stack_arrays, reason = "made once for many cells, and moved to the heap")]
    pub(in crate::cell) fn new() -> Self {
        const NONE: Wide = [0.0; LANES];
        Self {
            state: [NONE; MOST],
            stimulus: NONE,
            rates: [NONE; MOST],
            gate_by_potential: [NONE; GATED],
            gate_by_itself: [NONE; GATED],
            by_state: Box::new([[NONE; OTHERS]; COLUMNS]),
            parameters: [NONE; Parameters::LEN],
            myofilaments: [NONE; NUMBERS],
            chloride_moves: NONE,
            active: [NONE; MOST],
            block: [[NONE; OTHERS]; DIRECTIONS],
        }
    }

    /// Puts a cell into a lane; returns its initial state.
    pub(in crate::cell) fn put(&mut self, lane: usize, model: &TomekModel) -> [f64; MOST] {
        let constants = &model.constants;
        let mut rows = self.parameters.iter_mut();
        constants.parameters.give(&mut |value| {
            if let Some(row) = rows.next() {
                row[lane] = value;
            }
        });
        for (row, value) in self.myofilaments.iter_mut().zip(constants.myofilaments.numbers()) {
            row[lane] = value;
        }
        let moves = constants.form == Form::MovingChloride;
        self.chloride_moves[lane] = if moves { 1.0 } else { 0.0 };
        let mut start = [constants.parameters.cl_i; MOST];
        for (value, state) in start.iter_mut().zip(crate::cell::CellModel::initial_state(model)) {
            *value = state;
        }
        start
    }

    #[inline(always)]
    fn parameters(&self, lane: usize) -> Parameters<f64> {
        let mut k = 0;
        Parameters::take(&mut || {
            k += 1;
            self.parameters[k - 1][lane]
        })
    }

    #[inline(always)]
    fn myofilaments(&self, lane: usize) -> Myofilaments {
        Myofilaments::of_numbers(std::array::from_fn(|k| self.myofilaments[k][lane]))
    }

    /// The parts of a state from consecutive numbers.
    #[inline(always)]
    fn parts<T: Number>(next: &mut impl FnMut() -> T) -> Parts<T> {
        let (state, gates) = (State::take(next), Gates::take(next));
        let chloride = if LAND { None } else { Some(Chloride::take(next)) };
        let myofilaments =
            if LAND { Some([next(), next(), next(), next(), next(), next()]) } else { None };
        Parts { state, gates, chloride, myofilaments }
    }

    /// Computes the rates at the state.
    #[inline(always)]
    pub(in crate::cell) fn find_rates(&mut self) {
        for lane in 0..LANES {
            let (p, myofilaments) = (self.parameters(lane), self.myofilaments(lane));
            let stimulus = self.stimulus[lane];
            let outside = Outside { stimulus, stretch: 1.0, stretch_rate: 0.0 };
            let mut k = 0;
            let parts = Self::parts(&mut || {
                k += 1;
                self.state[k - 1][lane]
            });
            let moves = self.chloride_moves[lane];
            let mut other = 0;
            other_rates::<f64>(
                &p,
                &myofilaments,
                &parts,
                &outside,
                &mut inlined(
                    #[inline(always)]
                    |rate: f64| {
                        let still = !LAND && other >= GATES;
                        self.rates[Self::place(other)][lane] =
                            if still { rate * moves } else { rate };
                        other += 1;
                    },
                ),
            );
            let v = self.state[0][lane];
            let mut place = GATES;
            gates(&p, v).give(&mut inlined(
                #[inline(always)]
                |gate: Moving<f64>| {
                    self.rates[place][lane] =
                        (gate.steady_state - self.state[place][lane]) * gate.rate;
                    place += 1;
                },
            ));
        }
    }

    /// Computes the Jacobian at the state.
    #[inline(always)]
    pub(in crate::cell) fn find_jacobian(&mut self) {
        for lane in 0..LANES {
            let p = self.parameters(lane).map(Dual::<f64, 1>::constant);
            let v = Dual::variable(self.state[0][lane], 0);
            let mut k = 0;
            gates(&p, v).give(&mut inlined(
                #[inline(always)]
                |gate: Moving<Dual<f64, 1>>| {
                    let rate = (gate.steady_state - self.state[GATES + k][lane]) * gate.rate;
                    self.gate_by_potential[k][lane] = rate.slopes[0];
                    self.gate_by_itself[k][lane] = -gate.rate.value;
                    k += 1;
                },
            ));
        }
        for first in (0..Self::STATES).step_by(DIRECTIONS) {
            for (place, active) in self.active.iter_mut().enumerate() {
                let within = (first..first + DIRECTIONS).contains(&place);
                *active = [if within { 1.0 } else { 0.0 }; LANES];
            }
            self.differentiate();
            self.by_state[first..first + DIRECTIONS].copy_from_slice(&self.block);
        }
    }

    /// Differentiates with respect to the active states.
    #[inline(always)]
    fn differentiate(&mut self) {
        for lane in 0..LANES {
            let (p, myofilaments) = (self.parameters(lane), self.myofilaments(lane));
            let outside = Outside { stimulus: 0.0, stretch: 1.0, stretch_rate: 0.0 };
            let mut place = 0;
            let parts = Self::parts(&mut || {
                let (value, active) = (self.state[place][lane], self.active[place][lane]);
                let direction = place % DIRECTIONS;
                place += 1;
                let slope = |k| if k == direction { active } else { 0.0 };
                Dual::<f64, DIRECTIONS> { value, slopes: std::array::from_fn(slope) }
            });
            let moves = self.chloride_moves[lane];
            let mut other = 0;
            other_rates(
                &p,
                &myofilaments,
                &parts,
                &outside,
                &mut inlined(
                    #[inline(always)]
                    |rate: Dual<f64, DIRECTIONS>| {
                        let still = !LAND && other >= GATES;
                        for k in 0..DIRECTIONS {
                            let slope = rate.slopes[k];
                            self.block[k][other][lane] = if still { slope * moves } else { slope };
                        }
                        other += 1;
                    },
                ),
            );
        }
    }
}

const _: () = assert!(BEHIND == GATES + GATED);
