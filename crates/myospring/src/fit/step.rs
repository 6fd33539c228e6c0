//! The tension equations of `coelho_2021` over a step in which the bell `k(V)` is a straight line.

use crate::cell::CellModel as _;
use crate::cell::minimal::MinimalModel;
use std::f64::consts::PI;

/// Parts of the lag so short that Simpson's rule is exact to 1e-13.
const SHORT: f64 = 0.01;

/// Parameters that act on the tension alone, in the order of [`Rates`].
pub(super) const OF_TENSION: [&str; 4] = ["c_0", "x_1", "x_3", "sigma"];

/// What a curve tells of the tension equations.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rates {
    /// Rate of both variables, 1/ms.
    pub(super) c_0: f64,
    /// Rate of `Ta` while it waits, 1/ms.
    pub(super) x_1: f64,
    /// `Ta_i` up to which it waits.
    pub(super) x_3: f64,
    /// Width of the bell.
    pub(super) sigma: f64,
    /// Time by which the shape of a viscous cell lags behind its tension, ms; 0 of none.
    pub(super) lag: f64,
}

pub(super) fn model_value(model: &MinimalModel, name: &str) -> f64 {
    model.parameters().get(name).unwrap_or(f64::NAN)
}

/// `Ta_i` and `Ta`, and what a cell that lags behind makes of them.
pub(super) type State = [f64; 3];

impl Rates {
    /// Those of a model on a mesh whose shape lags behind its tension by a time, ms.
    pub(super) fn of(model: &MinimalModel, lag: f64) -> Self {
        let [c_0, x_1, x_3, sigma] = OF_TENSION.map(|name| model_value(model, name));
        Self { c_0, x_1, x_3, sigma, lag }
    }

    /// Eq. (34), for `V - 1`.
    pub(super) fn bell(&self, off_peak: f64) -> f64 {
        let z = off_peak / self.sigma;
        (-0.5 * z * z).exp() / (self.sigma * (2.0 * PI).sqrt())
    }
}

/// A step from node to node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// After the stimulus, ms.
    pub(super) begin: f64,
    pub(super) length: f64,
    pub(super) bell: f64,
    pub(super) slope: f64,
    pub(super) above: bool,
}

impl Step {
    /// The state so long after the begin of the step.
    pub(super) fn after(&self, time: f64, state: State, rates: &Rates) -> State {
        let [later, ta] = self.pull(time, state, rates);
        if rates.lag <= 0.0 {
            return [later, ta, ta];
        }
        // Ta bends where Ta_i passes x_3.
        let bend = self.switch(time, state[0], later, rates).unwrap_or(time);
        let theta = self.lagging([0.0, bend], state[2], state, rates);
        [later, ta, self.lagging([bend, time], theta, state, rates)]
    }

    /// `theta` at the end of a part of the step, from that at its begin: `tau d theta/dt = Ta - theta`, exact for a
    /// parabola through `Ta` at the ends and in the middle.
    fn lagging(&self, [begin, end]: [f64; 2], theta: f64, state: State, rates: &Rates) -> f64 {
        let time = end - begin;
        if time <= 0.0 {
            return theta;
        }
        let [from, middle, to] =
            [begin, f64::midpoint(begin, end), end].map(|time| self.pull(time, state, rates)[1]);
        let part = time / rates.lag;
        let decay = (-part).exp();
        if part < SHORT {
            // Simpson's rule, where the parabola's own would be differences of almost nothing.
            let sum = from * decay + 4.0 * middle * (-0.5 * part).exp() + to;
            return theta * decay + part * sum / 6.0;
        }
        let bend = 4.0 * (from - 2.0 * middle + to) / (time * time);
        let [first, last] = [4.0 * middle - 3.0 * from - to, 3.0 * to + from - 4.0 * middle]
            .map(|slope| slope / time);
        let behind = |ta: f64, slope: f64| ta - rates.lag * (slope - rates.lag * bend);
        behind(to, last) + (theta - behind(from, first)) * decay
    }

    /// `Ta_i` and `Ta` so long after the begin of the step.
    fn pull(&self, time: f64, [ta_i, ta, _]: State, rates: &Rates) -> [f64; 2] {
        debug_assert!(time <= self.length * (1.0 + 1e-9));
        let later = self.early(time, ta_i, rates.c_0);
        let waits = self.above && ta_i < rates.x_3;
        let [first, second] = if waits { [rates.x_1, rates.c_0] } else { [rates.c_0, rates.x_1] };
        let Some(switch) = self.switch(time, ta_i, later, rates) else {
            return [later, self.late(0.0, time, ta_i, ta, first, rates.c_0)];
        };
        let ta = self.late(0.0, switch, ta_i, ta, first, rates.c_0);
        [later, self.late(switch, time, ta_i, ta, second, rates.c_0)]
    }

    /// When `Ta` begins or ceases to wait, where it does.
    fn switch(&self, time: f64, ta_i: f64, later: f64, rates: &Rates) -> Option<f64> {
        let waits = |ta_i: f64| self.above && ta_i < rates.x_3;
        (waits(ta_i) != waits(later)).then(|| self.crossing(time, ta_i, later, rates))
    }

    /// [`Step::after`] at its end, with the exponential of that known.
    pub(super) fn whole(&self, decay: f64, state: State, rates: &Rates) -> State {
        let [ta_i, ta, _] = state;
        let lag = self.slope / rates.c_0;
        let excess = ta_i - self.bell + lag;
        let later = self.bell - lag + self.slope * self.length + excess * decay;
        if self.above && (ta_i < rates.x_3 || later < rates.x_3) {
            return self.after(self.length, state, rates);
        }
        let steady = self.bell - 2.0 * lag;
        let rise = ta - steady + excess * rates.c_0 * self.length;
        let ta = steady + self.slope * self.length + rise * decay;
        [later, ta, ta]
    }

    /// The largest `Ta` inside of the step, where it has one: it is highest when it meets `Ta_i`.
    pub(super) fn top(&self, time: f64, from: State, to: State, rates: &Rates) -> f64 {
        let [before, after] = [from[0] - from[1], to[0] - to[1]];
        if !(before > 0.0 && after <= 0.0) {
            return 0.0;
        }
        self.after(time * before / (before - after), from, rates)[1]
    }

    /// Exact: (32) with a bell that is a straight line.
    fn early(&self, time: f64, ta_i: f64, c_0: f64) -> f64 {
        let lag = self.slope / c_0;
        self.bell - lag + self.slope * time + (ta_i - self.bell + lag) * (-c_0 * time).exp()
    }

    /// (33) from one time to another at a constant rate; `ta` is there at the first.
    fn late(&self, from: f64, to: f64, ta_i: f64, ta: f64, rate: f64, c_0: f64) -> f64 {
        let h = to - from;
        if rate == c_0 {
            // Exact: both equations have the same rate.
            let (lag, bell) = (self.slope / c_0, self.bell + self.slope * from);
            let excess = self.early(from, ta_i, c_0) - bell + lag;
            let steady = bell - 2.0 * lag;
            return steady + self.slope * h + (ta - steady + excess * c_0 * h) * (-c_0 * h).exp();
        }
        // It waits, slowly, for less than a step of the grid: Simpson's rule.
        let at = |time: f64| self.early(time, ta_i, c_0) * (-rate * (to - time)).exp();
        let sum = at(from) + 4.0 * at(f64::midpoint(from, to)) + at(to);
        ta * (-rate * h).exp() + rate * h * sum / 6.0
    }

    /// When `Ta_i` passes `x_3`: regula falsi and Newton's method in one, on a course that hardly bends.
    fn crossing(&self, time: f64, ta_i: f64, later: f64, rates: &Rates) -> f64 {
        let mut at = time * (rates.x_3 - ta_i) / (later - ta_i);
        for _ in 0..4 {
            let value = self.early(at, ta_i, rates.c_0);
            let rate = rates.c_0 * (self.bell + self.slope * at - value);
            if rate == 0.0 {
                break;
            }
            at = (at - (value - rates.x_3) / rate).clamp(0.0, time);
        }
        at
    }
}
