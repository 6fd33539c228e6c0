//! Many cells in vector lanes: one step of each at once, every cell with its own time and step.
//!
//! The loops over lanes contain no branches and no calls, so the compiler vectorises them. Each
//! lane does the same operations as a single cell, so results do not depend on the number of lanes
//! or the vector units.
#![allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]
#![allow(clippy::inline_always, reason = "functions called in vectorised loops must be inlined")]

use super::branch::{Branch, Field, Side, Sliding, State};

/// Numbers of both sides of a switch.
const SIDES: usize = 2 * Side::LEN;
/// Smallest and largest change of the step from one to the next.
const SHRINK: f64 = 0.2;
const GROW: f64 = 5.0;
/// Safety factor: the aimed error as a part of the tolerance.
const SAFETY: f64 = 0.9;
/// The longest step, ms.
pub(super) const LONGEST_MS: f64 = 25.0;

/// If a step below this is rejected, ms, integration fails.
const SHORTEST_MS: f64 = 1e-11;

/// Floor in the scale of the error of a step: `tolerance (FLOOR + |value|)`.
pub(super) const FLOOR: State = [0.1, 0.1, 0.1, 0.1, 0.01, 0.01];

/// What single-cell code must handle: 0 nothing, 1 an event within an accepted step.
pub(in crate::cell) type Attention = u64;
/// The step size became too small.
pub(super) const STALLED: Attention = 2;

/// Cells in lanes; everything is stored by quantity, then by lane.
#[derive(Debug, Clone)]
pub(in crate::cell) struct Lanes<const N: usize> {
    pub(super) tolerance: f64,
    /// Time reached, ms.
    pub(super) time: [f64; N],
    /// The step to try next, ms; 0 puts a lane to sleep.
    pub(super) step: [f64; N],
    /// The step must not pass this time, ms.
    pub(super) stop: [f64; N],
    pub(super) state: [[f64; N]; 6],
    pub(super) rates: [[f64; N]; 6],
    pub(super) branch: [[f64; N]; Branch::LEN],
    /// 1 for a lane that slides along a switch, between the sides in `sides`; else 0.
    pub(super) sliding: [f64; N],
    pub(super) sides: [[f64; N]; SIDES],
    /// The region of `u` and of `Ta_i` in which the branch holds.
    pub(super) u_within: [[f64; N]; 2],
    pub(super) ta_i_within: [[f64; N]; 2],
    /// Time of the next requested sample, ms.
    pub(super) sample: [f64; N],
    /// Highest `u` and `Ta` of this beat at the end of a step, and their times, ms.
    pub(super) top_u: [f64; N],
    pub(super) top_ta: [f64; N],
    pub(super) top_ta_time: [f64; N],
    /// `u` just before the stimulus of this beat.
    pub(super) resting: [f64; N],
    /// The step that was tried, ms, and its end state.
    pub(super) tried: [f64; N],
    pub(super) new_time: [f64; N],
    pub(super) new_state: [[f64; N]; 6],
    pub(super) new_rates: [[f64; N]; 6],
    /// If not 0, the step is accurate but an event lies within it; the lane has not moved yet.
    pub(in crate::cell) attention: [Attention; N],
    /// Number of steps taken without attention, and of rejected steps.
    pub(in crate::cell) taken: [u64; N],
    pub(in crate::cell) refused: [u64; N],
}

impl<const N: usize> Lanes<N> {
    /// All lanes asleep.
    pub(in crate::cell) fn new(tolerance: f64) -> Self {
        let zero = [0.0; N];
        let mut lanes = Self {
            tolerance,
            time: zero,
            step: zero,
            stop: [f64::INFINITY; N],
            state: [zero; 6],
            rates: [zero; 6],
            branch: [zero; Branch::LEN],
            sliding: zero,
            sides: [zero; SIDES],
            u_within: [zero; 2],
            ta_i_within: [zero; 2],
            sample: [f64::INFINITY; N],
            top_u: zero,
            top_ta: zero,
            top_ta_time: zero,
            resting: zero,
            tried: zero,
            new_time: zero,
            new_state: [zero; 6],
            new_rates: [zero; 6],
            attention: [0; N],
            taken: [0; N],
            refused: [0; N],
        };
        for lane in 0..N {
            lanes.sleep(lane);
        }
        lanes
    }

    /// Puts a lane to sleep: its steps are 0 ms and need no attention.
    pub(in crate::cell) fn sleep(&mut self, lane: usize) {
        self.step[lane] = 0.0;
        self.stop[lane] = f64::INFINITY;
        self.sample[lane] = f64::INFINITY;
        self.sliding[lane] = 0.0;
        Self::put(&mut self.branch, lane, Branch::asleep().to_array());
        Self::put(&mut self.state, lane, [0.0; 6]);
        Self::put(&mut self.rates, lane, [0.0; 6]);
        Self::put(&mut self.u_within, lane, [f64::NEG_INFINITY, f64::INFINITY]);
        Self::put(&mut self.ta_i_within, lane, [f64::NEG_INFINITY, f64::INFINITY]);
        self.resting[lane] = 0.0;
        self.top_u[lane] = 0.0;
    }

    /// The numbers of one lane.
    #[inline(always)]
    pub(super) fn get<const K: usize>(numbers: &[[f64; N]; K], lane: usize) -> [f64; K] {
        std::array::from_fn(|k| numbers[k][lane])
    }

    /// Sets the numbers of one lane.
    pub(super) fn put<const K: usize>(numbers: &mut [[f64; N]; K], lane: usize, values: [f64; K]) {
        for (numbers, value) in numbers.iter_mut().zip(values) {
            numbers[lane] = value;
        }
    }

    #[inline(always)]
    pub(super) fn sides(&self, lane: usize) -> Sliding {
        let numbers = Self::get(&self.sides, lane);
        Sliding {
            below: Side::from_array(std::array::from_fn(|k| numbers[k])),
            above: Side::from_array(std::array::from_fn(|k| numbers[Side::LEN + k])),
        }
    }

    /// Tries one step in every lane, and accepts it if there is no event within it.
    ///
    /// A rejected step changes only the step to try next. A step with a crossed switch, a sample, a
    /// peak or the stop sets [`Self::attention`] and is accepted by single-cell code.
    #[inline(always)]
    pub(in crate::cell) fn try_step(&mut self) {
        let (mut error, mut outside) = self.propose();
        if self.sliding.iter().any(|sliding| *sliding > 0.0) {
            self.slide(&mut error, &mut outside);
        }
        self.judge(&error, &outside);
    }

    /// Makes a step in the branch of every lane: errors, and whether it leaves that branch.
    #[inline(always)]
    fn propose(&mut self) -> ([f64; N], [Attention; N]) {
        let mut error = [0.0; N];
        let mut outside = [0; N];
        for i in 0..N {
            // A step that would leave a tiny rest before the stop is extended to the stop.
            let room = self.stop[i] - self.time[i];
            let to_stop = self.step[i] * 1.001 >= room;
            let h = if to_stop { room } else { self.step[i] };
            self.tried[i] = h;
            self.new_time[i] = if to_stop { self.stop[i] } else { self.time[i] + h };

            let branch = Branch::from_array(Self::get(&self.branch, i));
            let (y, f) = (Self::get(&self.state, i), Self::get(&self.rates, i));
            let trial = bogacki_shampine(&branch, &y, &f, h);
            error[i] = trial.error;
            for k in 0..6 {
                self.new_state[k][i] = trial.state[k];
                self.new_rates[k][i] = trial.rates[k];
            }
            // The middle of the cubic detects an excursion that ends within the step.
            let middle = 0.5 * (y[0] + trial.state[0]) + 0.125 * h * (f[0] - trial.rates[0]);
            let [low, high] = Self::get(&self.u_within, i);
            let leaves = flag(trial.state[0] < low)
                | flag(trial.state[0] > high)
                | flag(middle < low)
                | flag(middle > high);
            outside[i] = leaves;
        }
        (error, outside)
    }

    /// Makes the step again where a lane slides between two branches.
    #[inline(always)]
    fn slide(&mut self, error: &mut [f64; N], outside: &mut [Attention; N]) {
        for i in 0..N {
            let sliding = self.sliding[i] > 0.0;
            let field = self.sides(i);
            let (y, f) = (Self::get(&self.state, i), Self::get(&self.rates, i));
            let trial = bogacki_shampine(&field, &y, &f, self.tried[i]);
            let [upwards, downwards] = field.holds(&trial.state);
            let leaves = flag(upwards <= 0.0) | flag(downwards <= 0.0);
            error[i] = if sliding { trial.error } else { error[i] };
            outside[i] = if sliding { leaves } else { outside[i] };
            for k in 0..6 {
                self.new_state[k][i] = if sliding { trial.state[k] } else { self.new_state[k][i] };
                self.new_rates[k][i] = if sliding { trial.rates[k] } else { self.new_rates[k][i] };
            }
        }
    }

    /// Accepts the step where its error is small and nothing happens within it, and chooses the next.
    #[inline(always)]
    fn judge(&mut self, error: &[f64; N], outside: &[Attention; N]) {
        for i in 0..N {
            let scaled = error[i] / self.tolerance;
            let good = scaled <= 1.0;
            let [u, ..] = Self::get(&self.state, i);
            let [new_u, .., new_ta_i, new_ta] = Self::get(&self.new_state, i);
            let [u_rate, .., ta_rate] = Self::get(&self.rates, i);
            let [new_u_rate, .., new_ta_rate] = Self::get(&self.new_rates, i);
            let [low, high] = Self::get(&self.ta_i_within, i);
            let level = repolarised(self.resting[i], self.top_u[i]);
            let special = outside[i]
                | flag(new_ta_i < low)
                | flag(new_ta_i > high)
                | flag(self.new_time[i] >= self.stop[i])
                | flag(self.new_time[i] >= self.sample[i])
                | (flag(u_rate > 0.0) & flag(new_u_rate <= 0.0))
                | (flag(ta_rate > 0.0) & flag(new_ta_rate <= 0.0))
                | (flag(u > level) & flag(new_u <= level));
            let stalled = flag(!good) & flag(self.tried[i] < SHORTEST_MS);
            self.attention[i] = (special & flag(good)) | (STALLED * stalled);
            let commit = good & (special == 0);
            self.time[i] = if commit { self.new_time[i] } else { self.time[i] };
            for k in 0..6 {
                self.state[k][i] = if commit { self.new_state[k][i] } else { self.state[k][i] };
                self.rates[k][i] = if commit { self.new_rates[k][i] } else { self.rates[k][i] };
            }
            let higher = commit & (new_ta > self.top_ta[i]);
            self.top_ta[i] = if higher { new_ta } else { self.top_ta[i] };
            self.top_ta_time[i] = if higher { self.time[i] } else { self.top_ta_time[i] };
            self.top_u[i] = if commit & (new_u > self.top_u[i]) { new_u } else { self.top_u[i] };
            self.taken[i] += flag(commit);
            self.refused[i] += flag(!good);

            // Error per step is of order 3; the fourth root damps the changes of the step.
            let ratio = if scaled < 1e-12 { 1e-12 } else { scaled };
            let root = (1.0 / ratio).sqrt().sqrt();
            let factor = SAFETY * if good { root } else { root * root.sqrt() };
            let factor = if factor > SHRINK { factor } else { SHRINK };
            let factor = if factor < GROW { factor } else { GROW };
            let next = self.tried[i] * factor;
            // A step shortened by the stop does not reduce the following step.
            let next = if good & (next < self.step[i]) & (self.tried[i] < self.step[i]) {
                self.step[i]
            } else {
                next
            };
            self.step[i] = if next < LONGEST_MS { next } else { LONGEST_MS };
        }
    }
}

/// `u` of 90 % repolarisation.
#[inline(always)]
pub(super) fn repolarised(resting: f64, top: f64) -> f64 {
    resting + 0.1 * (top - resting)
}

#[inline(always)]
fn flag(condition: bool) -> Attention {
    Attention::from(condition)
}

/// One step: end state, rates there, and error relative to its scale.
pub(super) struct Trial {
    pub(super) state: State,
    pub(super) rates: State,
    pub(super) error: f64,
}

/// The pair 3(2) of `bogacki_shampine_1989`: third order, the error by a second-order companion; the
/// last evaluation is the first of the next step.
#[inline(always)]
pub(super) fn bogacki_shampine(field: &impl Field, y: &State, k1: &State, h: f64) -> Trial {
    let k2 = &field.rates(&std::array::from_fn(|i| y[i] + h * (1.0 / 2.0 * k1[i])));
    let k3 = &field.rates(&std::array::from_fn(|i| y[i] + h * (3.0 / 4.0 * k2[i])));
    let state = std::array::from_fn(|i| {
        y[i] + h * (2.0 / 9.0 * k1[i] + 3.0 / 9.0 * k2[i] + 4.0 / 9.0 * k3[i])
    });
    let rates = field.rates(&state);
    let mut error = 0.0;
    for i in 0..6 {
        let difference =
            -5.0 / 72.0 * k1[i] + 1.0 / 12.0 * k2[i] + 1.0 / 9.0 * k3[i] - 1.0 / 8.0 * rates[i];
        let (before, after) = (y[i].abs(), state[i].abs());
        let size = FLOOR[i] + if after > before { after } else { before };
        let part = (h * difference).abs() / size;
        // NaN is kept.
        error = if (part > error) | part.is_nan() { part } else { error };
    }
    Trial { state, rates, error }
}
