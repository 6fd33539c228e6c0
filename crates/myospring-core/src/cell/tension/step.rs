//! The tension equations of `coelho_2021` over a step in which the bell `k(V)` is a straight line.

use super::Tension;
use super::lag::Lag;
use std::f64::consts::PI;

/// The constants that act on the tension alone and not on the potential.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rates {
    /// Rate of both variables, 1/ms.
    pub c_0: f64,
    /// Rate of `Ta` while it waits, 1/ms.
    pub x_1: f64,
    /// `Ta_i` up to which it waits.
    pub x_3: f64,
    /// Width of the bell.
    pub sigma: f64,
    /// How what shapes the cell lags behind its tension.
    pub lag: Lag,
}

/// `Ta_i` and `Ta`, and what a cell that lags behind makes of them.
pub(super) type State = [f64; 3];

impl Rates {
    /// Their names as parameters, in the order of the fields.
    pub const NAMES: [&str; 4] = ["c_0", "x_1", "x_3", "sigma"];

    /// Those of a model on a mesh whose shape lags behind its tension.
    pub fn of(tension: &Tension, lag: Lag) -> Self {
        let Tension { c_0, x_1, x_3, sigma, .. } = *tension;
        Self { c_0, x_1, x_3, sigma, lag }
    }

    /// With other values of these, by their places in [`Rates::NAMES`].
    #[must_use]
    pub fn with(self, places: &[usize], values: &[f64]) -> Self {
        let mut all = [self.c_0, self.x_1, self.x_3, self.sigma];
        for (place, value) in places.iter().zip(values) {
            all[*place] = *value;
        }
        let [c_0, x_1, x_3, sigma] = all;
        Self { c_0, x_1, x_3, sigma, ..self }
    }

    /// Eq. (34), for `V - 1`.
    pub fn bell(&self, off_peak: f64) -> f64 {
        let z = off_peak / self.sigma;
        (-0.5 * z * z).exp() / (self.sigma * (2.0 * PI).sqrt())
    }
}

/// What a time makes of both variables while the bell is a straight line and nothing switches: sums of what they were,
/// of the bell at its begin and of its slope. Exact: (32) and (33) are linear.
#[derive(Debug, Clone, Copy)]
struct Propagator {
    /// `Ta_i` by itself, the bell and its slope.
    early: [f64; 3],
    /// `Ta` by itself, `Ta_i`, the bell and its slope.
    late: [f64; 4],
}

impl Propagator {
    /// Over a time, ms, in which `Ta` follows at a rate and `Ta_i` at `c_0`, 1/ms.
    fn over(time: f64, rate: f64, c_0: f64) -> Self {
        let (risen, mean) = self::risen(c_0 * time);
        let decay = 1.0 - risen;
        let early = [decay, risen, time * (1.0 - mean)];
        let is_one = rate == c_0;
        let (followed, late_mean) = if is_one { (risen, mean) } else { self::risen(rate * time) };
        let mixed = if is_one { 1.0 } else { self::risen((rate - c_0) * time).1 };
        let by_early = rate * time * decay * mixed;
        let by_bell = followed - by_early;
        let by_slope = time * (1.0 - late_mean) - by_bell / c_0;
        Self { early, late: [1.0 - followed, by_early, by_bell, by_slope] }
    }

    fn early(&self, bell: f64, slope: f64, ta_i: f64) -> f64 {
        let [itself, by_bell, by_slope] = self.early;
        itself * ta_i + (by_bell * bell + by_slope * slope)
    }

    fn late(&self, bell: f64, slope: f64, ta_i: f64, ta: f64) -> f64 {
        let [itself, by_early, by_bell, by_slope] = self.late;
        itself * ta + (by_early * ta_i + (by_bell * bell + by_slope * slope))
    }
}

/// `1 - exp(-z)`, and that over `z`: the mean of `exp(-z s)` for `s` from 0 to 1.
fn risen(z: f64) -> (f64, f64) {
    let risen = -(-z).exp_m1();
    (risen, if z == 0.0 { 1.0 } else { risen / z })
}

/// What steps of one length share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whole {
    /// How long they are, ms.
    pub(super) length: f64,
    free: Propagator,
    waiting: Propagator,
}

impl Whole {
    /// Of steps so long, ms.
    pub(super) fn new(length: f64, rates: &Rates) -> Self {
        let [free, waiting] =
            [rates.c_0, rates.x_1].map(|rate| Propagator::over(length, rate, rates.c_0));
        Self { length, free, waiting }
    }
}

/// A step from node to node.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// After the stimulus, ms.
    pub(super) begin: f64,
    /// How long it is, ms.
    pub(super) length: f64,
    /// `k(V)` at its begin.
    pub(super) bell: f64,
    /// How fast `k(V)` grows, 1/ms.
    pub(super) slope: f64,
    /// Whether `V > x_2` in it.
    pub(super) above: bool,
}

impl Step {
    /// The state so long after the begin of the step.
    pub(super) fn after(&self, time: f64, state: State, rates: &Rates) -> State {
        let [later, ta] = self.pull(time, state, rates);
        if rates.lag.is_none() {
            return [later, ta, ta];
        }
        // Ta bends where Ta_i passes x_3.
        let bend = self.switch(time, state[0], later, rates).unwrap_or(time);
        let theta = self.lagging([0.0, bend], state[2], state, rates);
        [later, ta, self.lagging([bend, time], theta, state, rates)]
    }

    /// `theta` at the end of a part of the step, from that at its begin.
    fn lagging(&self, [begin, end]: [f64; 2], theta: f64, state: State, rates: &Rates) -> f64 {
        if end <= begin {
            return theta;
        }
        let through =
            [begin, f64::midpoint(begin, end), end].map(|time| self.pull(time, state, rates)[1]);
        rates.lag.over_parabola(end - begin, theta, through)
    }

    /// `Ta_i` and `Ta` so long after the begin of the step.
    fn pull(&self, time: f64, [ta_i, ta, _]: State, rates: &Rates) -> [f64; 2] {
        debug_assert!(time <= self.length * (1.0 + 1e-9));
        let free = Propagator::over(time, rates.c_0, rates.c_0);
        let later = free.early(self.bell, self.slope, ta_i);
        let waits = self.above && ta_i < rates.x_3;
        let Some(switch) = self.switch(time, ta_i, later, rates) else {
            let all = if waits { Propagator::over(time, rates.x_1, rates.c_0) } else { free };
            return [later, all.late(self.bell, self.slope, ta_i, ta)];
        };
        let [first, second] = if waits { [rates.x_1, rates.c_0] } else { [rates.c_0, rates.x_1] };
        let before = Propagator::over(switch, first, rates.c_0);
        let there = before.early(self.bell, self.slope, ta_i);
        let ta = before.late(self.bell, self.slope, ta_i, ta);
        let after = Propagator::over(time - switch, second, rates.c_0);
        [later, after.late(self.bell + self.slope * switch, self.slope, there, ta)]
    }

    /// When `Ta` begins or ceases to wait, where it does.
    fn switch(&self, time: f64, ta_i: f64, later: f64, rates: &Rates) -> Option<f64> {
        let waits = |ta_i: f64| self.above && ta_i < rates.x_3;
        (waits(ta_i) != waits(later)).then(|| self.crossing(time, ta_i, later, rates))
    }

    /// `Ta_i` and `Ta` at its end, by the propagators of that; `None` where `Ta` begins or ceases to wait.
    pub(super) fn whole(
        &self,
        by: &Whole,
        [ta_i, ta]: [f64; 2],
        rates: &Rates,
    ) -> Option<[f64; 2]> {
        let later = by.free.early(self.bell, self.slope, ta_i);
        let waits = self.above && ta_i < rates.x_3;
        if waits != (self.above && later < rates.x_3) {
            return None;
        }
        let all = if waits { &by.waiting } else { &by.free };
        Some([later, all.late(self.bell, self.slope, ta_i, ta)])
    }

    /// `Ta` where it meets `Ta_i`, which it was below before and is not any more at the end of that time.
    pub(super) fn top(&self, time: f64, from: State, to: State, rates: &Rates) -> f64 {
        let meets = if self.bell == 0.0 && self.slope == 0.0 {
            // A cell at rest, however long: Ta_i falls as exp(-c_0 t), Ta as (Ta + c_0 Ta_i t) exp(-c_0 t).
            (1.0 - from[1] / from[0]) / rates.c_0
        } else {
            let [before, after] = [from[0] - from[1], to[0] - to[1]];
            time * before / (before - after)
        };
        self.after(meets, from, rates)[1]
    }

    /// When `Ta_i` passes `x_3`: regula falsi and Newton's method in one, on a course that hardly bends.
    fn crossing(&self, time: f64, ta_i: f64, later: f64, rates: &Rates) -> f64 {
        let mut at = time * (rates.x_3 - ta_i) / (later - ta_i);
        for _ in 0..4 {
            let there = Propagator::over(at, rates.c_0, rates.c_0);
            let value = there.early(self.bell, self.slope, ta_i);
            let rate = rates.c_0 * (self.bell + self.slope * at - value);
            if rate == 0.0 {
                break;
            }
            at = (at - (value - rates.x_3) / rate).clamp(0.0, time);
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const C_0: f64 = 0.0166016;
    const BELL: f64 = 3.0;
    const SLOPE: f64 = -0.7;

    /// (32) and (33) in small steps of the classical method of Runge and Kutta.
    fn plain(time: f64, rate: f64, state: [f64; 2]) -> [f64; 2] {
        let slopes =
            |at: f64, [ta_i, ta]: [f64; 2]| [C_0 * (BELL + SLOPE * at - ta_i), rate * (ta_i - ta)];
        let moved = |from: [f64; 2], by: f64, slope: [f64; 2]| {
            [from[0] + by * slope[0], from[1] + by * slope[1]]
        };
        let step = time / 1000.0;
        (0..1000).fold(state, |state, number| {
            let begin = f64::from(number) * step;
            let first = slopes(begin, state);
            let second = slopes(begin + 0.5 * step, moved(state, 0.5 * step, first));
            let third = slopes(begin + 0.5 * step, moved(state, 0.5 * step, second));
            let fourth = slopes(begin + step, moved(state, step, third));
            [0, 1].map(|k| {
                let sum = first[k] + 2.0 * (second[k] + third[k]) + fourth[k];
                state[k] + step / 6.0 * sum
            })
        })
    }

    #[test]
    fn a_propagator_is_the_equations_whatever_their_rates_and_however_long_it_is() {
        let state = [0.4, 1.7];
        for rate in [0.0, 1e-4, C_0, C_0 * (1.0 + 1e-9), 5.0 * C_0] {
            for time in [0.0, 0.05, 0.5, 8.0, 60.0] {
                let by = Propagator::over(time, rate, C_0);
                let found =
                    [by.early(BELL, SLOPE, state[0]), by.late(BELL, SLOPE, state[0], state[1])];
                let expected = plain(time, rate, state);
                for (found, expected) in found.iter().zip(expected) {
                    let off = (found - expected).abs();
                    assert!(off < 1e-11, "{rate} 1/ms over {time} ms: off by {off}");
                }
            }
        }
    }
}
