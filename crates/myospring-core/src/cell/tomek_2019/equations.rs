//! The state as one vector, and its rates.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::gate::Moving;
use super::membrane::Chlorides;
use super::parameters::Parameters;
use super::rates::{Flows, chloride_rates, gates, rates};
use super::state::{Chloride, Gates, State};
use crate::cell::land_2017::{Myofilaments, STATES as MYOFILAMENTS};
use crate::cell::number::{Dual, Number};

/// Index, among the myofilaments' states, of the part of troponin with calcium.
const TROPONIN: usize = 2;

/// Which states follow those of membrane and gates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// Constant chloride: 43 states, as in the paper.
    Published,
    /// Dynamic chloride: 45 states.
    MovingChloride,
    /// Troponin belongs to myofilaments, which generate tension: 49 states.
    Land,
}

/// Index of the first gate.
pub(super) const GATES: usize = State::LEN;
/// Index of the first state after the gates.
pub(super) const BEHIND: usize = State::LEN + Gates::LEN;

/// States of the largest form.
const MOST: usize = Form::Land.len();

impl Form {
    /// Number of states.
    pub(super) const fn len(self) -> usize {
        match self {
            Self::Published => BEHIND,
            Self::MovingChloride => BEHIND + Chloride::LEN,
            Self::Land => BEHIND + MYOFILAMENTS,
        }
    }
}

/// The parts of a state.
pub(super) struct Parts<T> {
    pub(super) state: State<T>,
    pub(super) gates: Gates<T>,
    pub(super) chloride: Option<Chloride<T>>,
    pub(super) myofilaments: Option<[T; MYOFILAMENTS]>,
}

/// All constants of a cell.
#[derive(Debug, Clone, Copy)]
pub(in crate::cell) struct Constants<C> {
    pub(super) form: Form,
    pub(super) parameters: Parameters<C>,
    pub(super) myofilaments: Myofilaments<C>,
}

/// External inputs.
#[derive(Debug, Clone, Copy)]
pub(in crate::cell) struct Outside<C> {
    pub(in crate::cell) stimulus: C,
    pub(in crate::cell) stretch: C,
    pub(in crate::cell) stretch_rate: C,
}

impl<T: Number> Parts<T> {
    #[inline(always)]
    pub(super) fn of(form: Form, state: &[T]) -> Self {
        let mut rest = state.iter();
        let mut next = || rest.next().copied().unwrap_or_else(|| T::of(f64::NAN));
        Self {
            state: State::take(&mut next),
            gates: Gates::take(&mut next),
            chloride: (form == Form::MovingChloride).then(|| Chloride::take(&mut next)),
            myofilaments: (form == Form::Land).then(|| std::array::from_fn(|_| next())),
        }
    }

    /// Chloride in both volumes.
    #[inline(always)]
    pub(super) fn chlorides(&self, p: &Parameters<T>) -> Chlorides<T> {
        match self.chloride {
            Some(moving) => Chlorides { i: moving.cl_i, ss: moving.cl_ss },
            None => Chlorides { i: p.cl_i, ss: p.cl_i },
        }
    }

    #[inline(always)]
    pub(super) fn flows(&self, p: &Parameters<T>) -> Flows<T> {
        Flows::new(p, &self.state, &self.gates, &self.chlorides(p))
    }
}

/// Writes the rate of every state.
#[inline(always)]
pub(in crate::cell) fn derivatives<T: Number>(
    constants: &Constants<T::Constant>,
    state: &[T],
    outside: &Outside<T::Constant>,
    out: &mut [T],
) {
    others(constants, state, outside, out);
    let p = &constants.parameters.map(T::constant);
    let mut places = out[GATES..].iter_mut().zip(&state[GATES..]);
    gates(p, state[0]).give(&mut |gate: Moving<T>| {
        if let Some((rate, x)) = places.next() {
            *rate = (gate.steady_state - *x) * gate.rate;
        }
    });
}

/// Writes the rates of all states but the gates.
#[inline(always)]
fn others<T: Number>(
    constants: &Constants<T::Constant>,
    state: &[T],
    outside: &Outside<T::Constant>,
    out: &mut [T],
) {
    let (before, behind) = out.split_at_mut(BEHIND);
    let mut places = before[..GATES].iter_mut().chain(behind);
    let Constants { form, parameters, myofilaments } = constants;
    let parts = Parts::of(*form, state);
    other_rates(parameters, myofilaments, &parts, outside, &mut |rate| {
        if let Some(place) = places.next() {
            *place = rate;
        }
    });
}

/// Passes the rate of each state that is not a gate to a closure, in order.
#[inline(always)]
pub(super) fn other_rates<T: Number>(
    parameters: &Parameters<T::Constant>,
    myofilaments: &Myofilaments<T::Constant>,
    parts: &Parts<T>,
    outside: &Outside<T::Constant>,
    tell: &mut impl FnMut(T),
) {
    let p = &parameters.map(T::constant);
    let flows = parts.flows(p);
    let pull = parts.myofilaments.as_ref().map(|state| {
        let calcium_um = parts.state.ca_i * 1e3;
        myofilaments.rates_of(state, calcium_um, outside.stretch, outside.stretch_rate)
    });
    let stimulus = T::constant(outside.stimulus);
    let bound = pull.map(|rates| rates[TROPONIN]);
    rates(p, &parts.state, &parts.gates, &flows, stimulus, bound).give(tell);
    if let Some(chloride) = &parts.chloride {
        chloride_rates(chloride, &flows.exchange).give(tell);
    }
    if let Some(pull) = pull {
        for rate in pull {
            tell(rate);
        }
    }
}

/// Number of directions of simultaneous differentiation.
const DIRECTIONS: usize = 8;

/// Writes the derivative of each rate with respect to each state, rate by rate.
pub(super) fn jacobian(
    constants: &Constants<f64>,
    state: &[f64],
    outside: &Outside<f64>,
    jacobian: &mut [f64],
) {
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || differentiate(constants, state, outside, jacobian),
    );
}

#[inline(always)]
fn differentiate(
    constants: &Constants<f64>,
    state: &[f64],
    outside: &Outside<f64>,
    jacobian: &mut [f64],
) {
    let size = state.len();
    jacobian.fill(0.0);
    let zero = Dual::<f64, DIRECTIONS>::of(0.0);
    let (mut numbers, mut rates) = ([zero; MOST], [zero; MOST]);
    for first in (0..size).step_by(DIRECTIONS) {
        let last = size.min(first + DIRECTIONS);
        for (k, (number, value)) in numbers.iter_mut().zip(state).enumerate() {
            let own = (first..last).contains(&k);
            *number = if own { Dual::variable(*value, k - first) } else { Dual::of(0.0) + *value };
        }
        others(constants, &numbers[..size], outside, &mut rates[..size]);
        for (row, rate) in jacobian.chunks_exact_mut(size).zip(&rates) {
            row[first..last].copy_from_slice(&rate.slopes[..last - first]);
        }
    }
    // A gate depends on the potential and itself.
    let p = constants.parameters.map(Dual::<f64, 1>::constant);
    let mut places = GATES..;
    gates(&p, Dual::variable(state[0], 0)).give(&mut |gate: Moving<Dual<f64, 1>>| {
        if let Some(place) = places.next() {
            let rate = (gate.steady_state - state[place]) * gate.rate;
            let row = &mut jacobian[place * size..(place + 1) * size];
            row.fill(0.0);
            row[0] = rate.slopes[0];
            row[place] = -gate.rate.value;
        }
    });
}
