//! Trains of beats of a cell whose myofilaments depend on its length and whose calcium is
//! prescribed: `land_2017` on the equilibria of a mesh.
//!
//! Distortions depend on the rate of the stretch, which depends on the tension, which depends on
//! the distortions. The variable `y`, a distortion minus a multiple of the stretch, avoids this
//! implicit dependence:
//!
//! ```text
//! y = zeta - A lambda,   dy/dt = -c (y + A lambda)
//! lambda = S(Ta(XS, XW, y + A lambda, lambda))
//! ```
//!
//! with `S` the equilibria. A stronger pull shortens the cell and a shorter cell pulls less, so the
//! second line has one solution. Six equations without a rate on their right side remain; the
//! classical Runge-Kutta method integrates them with steps of two milliseconds.
//!
//! The shape of a viscous cell is that of another tension, `theta` ([`Lag`]): `lambda = S(theta)`.

use super::equilibria::TensionResponse;
use super::train::Train;
use super::{Simulation, StopReason};
use crate::cell::CellModel;
use crate::cell::calcium::Calcium;
use crate::cell::land_2017::{Myofilaments, STATES};
use crate::cell::tension::lag::Lag;

/// A step is at most this many times the fastest time constant: the method is stable up to 2.8. Steps are no longer than
/// between samples: against 0.1 ms curves are within 1e-5 of their height.
const OF_FASTEST: f64 = 1.5;
/// Steps of Newton's method, and the change of the stretch that ends it.
const TRIES: usize = 40;
const AGREED: f64 = 1e-10;
/// A train is steady if no state changes by more than this from beat to beat; each beat reduces the
/// change at least a hundredfold.
const STEADY: f64 = 1e-9;

/// The six states, with `y` for the distortions, and `theta`.
type State = [f64; STATES + 1];
const THETA: usize = STATES;

/// Myofilaments with prescribed calcium, on a mesh.
pub(super) struct GivenCalcium<'a> {
    filaments: &'a Myofilaments,
    calcium: &'a Calcium,
    response: &'a dyn TensionResponse,
    lag: Lag,
    /// Distortion of crossbridges per stretch; 0 while the cell rests before its first stimulus.
    distortion: f64,
    steady: f64,
}

/// Whether this method supports the model and the simulation, whose mesh must not be held or start
/// from its own state.
pub(super) fn serves(simulation: &Simulation, cell: &dyn CellModel) -> bool {
    equations(cell).is_some()
        && simulation.end_stretch == 1.0
        && simulation.resting_stretch.is_none()
        && simulation.start_state.is_none()
        && !simulation.support.clamps()
}

/// The equations and the calcium of a cell model that consists of myofilaments with prescribed
/// calcium.
fn equations(cell: &dyn CellModel) -> Option<(&Myofilaments, &Calcium)> {
    let filaments = cell.filaments().filter(|_| cell.states().len() == STATES)?;
    Some((filaments.equations, filaments.calcium?))
}

impl<'a> GivenCalcium<'a> {
    /// For a model on a mesh; `None` if the model is not supported.
    pub(super) fn of(
        cell: &'a dyn CellModel,
        response: &'a dyn TensionResponse,
        lag: Lag,
    ) -> Option<Self> {
        let (filaments, calcium) = equations(cell)?;
        Some(Self { filaments, calcium, response, lag, distortion: 0.0, steady: STEADY })
    }

    /// Shortening at every interval from the first requested stimulus on.
    pub(super) fn shortening(mut self, train: &Train) -> Result<Vec<f64>, StopReason> {
        let Train { before, beats, cycle_ms } = *train;
        let (intervals, length) = (train.intervals(), train.interval_ms());
        let none = |time: f64| StopReason::CellModel {
            cause: format!("no stretch belongs to its tension at t = {time} ms"),
        };
        let steps = self.steps(cycle_ms, length).ok_or_else(|| none(0.0))?;
        // Before the first stimulus the cell is at rest, and nothing is distorted.
        let mut state = [0.0; STATES + 1];
        state[..STATES].copy_from_slice(&self.filaments.steady(self.calcium.rest(), 1.0));
        let mut stretch = self.stretch_at_once(&state, 1.0).ok_or_else(|| none(0.0))?;
        state[THETA] = self.filaments.tension(&self.whole(&state, stretch), stretch);
        self.distortion = self.filaments.distortion_per_stretch();
        for y in [4, 5] {
            state[y] = -self.distortion * stretch;
        }
        let mut samples = Vec::with_capacity(beats * intervals + 1);
        samples.push(1.0 - stretch);
        let mut course = Vec::with_capacity(intervals);
        let mut is_steady = false;
        for beat in 0..before + beats {
            // Once steady, each beat equals the one before.
            if !is_steady {
                let was = state;
                course.clear();
                for interval in 0..intervals {
                    let since = interval as f64 * length;
                    let moved = self.interval(&mut state, &mut stretch, since, length, steps);
                    moved.ok_or_else(|| none(beat as f64 * cycle_ms + since))?;
                    course.push(1.0 - stretch);
                }
                let moved = state.iter().zip(was).map(|(now, was)| (now - was).abs());
                is_steady = moved.fold(0.0, f64::max) < self.steady;
            }
            if beat < before {
                samples[0] = 1.0 - stretch;
            } else {
                samples.extend_from_slice(&course);
            }
        }
        Ok(samples)
    }

    /// A number of steps from a time after the stimulus on.
    fn interval(
        &self,
        state: &mut State,
        stretch: &mut f64,
        since: f64,
        length: f64,
        steps: usize,
    ) -> Option<()> {
        let step = length / steps as f64;
        (0..steps).try_for_each(|at| self.step(state, stretch, since + at as f64 * step, step))
    }

    /// The classical step of order 4.
    fn step(&self, state: &mut State, stretch: &mut f64, time: f64, h: f64) -> Option<()> {
        let from = *state;
        let moved = |by: f64, rate: &State| std::array::from_fn(|i| from[i] + by * rate[i]);
        let first = self.rates(&from, *stretch, time);
        let middle: State = moved(0.5 * h, &first);
        let at = self.stretch(&middle, *stretch)?;
        let second = self.rates(&middle, at, time + 0.5 * h);
        let middle: State = moved(0.5 * h, &second);
        let at = self.stretch(&middle, at)?;
        let third = self.rates(&middle, at, time + 0.5 * h);
        let end: State = moved(h, &third);
        let at = self.stretch(&end, at)?;
        let fourth = self.rates(&end, at, time + h);
        for i in 0..=THETA {
            state[i] += h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
        *stretch = self.stretch(state, at)?;
        Some(())
    }

    /// Rates of the states with `y` for the distortions, at the stretch that goes with them.
    fn rates(&self, state: &State, stretch: f64, time: f64) -> State {
        let whole = self.whole(state, stretch);
        let filaments = self.filaments;
        let mut rates = [0.0; STATES + 1];
        let of_filaments = filaments.rates(&whole, self.calcium.at(time), stretch, 0.0);
        rates[..STATES].copy_from_slice(&of_filaments);
        if !self.lag.is_none() {
            let tension = filaments.tension(&whole, stretch);
            rates[THETA] = self.lag.rate(state[THETA], tension);
        }
        rates
    }

    /// The state with distortions.
    fn whole(&self, state: &State, stretch: f64) -> [f64; STATES] {
        let [xs, xw, c, b, y_s, y_w, _] = *state;
        let all = self.distortion * stretch;
        [xs, xw, c, b, y_s + all, y_w + all]
    }

    /// The stretch of the mesh.
    fn stretch(&self, state: &State, guess: f64) -> Option<f64> {
        if self.lag.is_none() {
            return self.stretch_at_once(state, guess);
        }
        let stretch = 1.0 - self.response.shortening(state[THETA])[0];
        stretch.is_finite().then_some(stretch)
    }

    /// The stretch at which the mesh is in equilibrium with the tension at that stretch: Newton's
    /// method from a guess.
    fn stretch_at_once(&self, state: &State, guess: f64) -> Option<f64> {
        let mut stretch = guess;
        for _ in 0..TRIES {
            let whole = self.whole(state, stretch);
            let tension = self.filaments.tension(&whole, stretch);
            let [shortening, slope] = self.response.shortening(tension);
            let by = self.filaments.instantaneous_stiffness(&whole, stretch).max(0.0);
            // d/d lambda of lambda - S(Ta(lambda)), at least 1
            let step = (1.0 - shortening - stretch) / (1.0 + slope.max(0.0) * by);
            stretch += step;
            if step.abs() < AGREED {
                return stretch.is_finite().then_some(stretch);
            }
        }
        None
    }

    /// Steps an interval, such that none is longer than the fastest of the equations allows.
    fn steps(&self, cycle: f64, interval: f64) -> Option<usize> {
        let filaments = self.filaments;
        // Close enough that no peak of a long recording is missed.
        let count = (cycle / 5.0).clamp(200.0, 1e5) as u32;
        let calcium =
            (0..=count).map(|at| self.calcium.at(cycle * f64::from(at) / f64::from(count)));
        let calcium = calcium.fold(0.0, f64::max);
        // Each equation is linear in its own variable; without calcium bound, blocking is as fast as it gets.
        let none = [0.0; STATES];
        let still = filaments.rates(&none, calcium, 1.0, 0.0);
        let fastest = (0..STATES)
            .map(|place| {
                let mut one = none;
                one[place] = 1.0;
                let rate = filaments.rates(&one, calcium, 1.0, 0.0)[place] - still[place];
                rate.abs()
            })
            .fold(0.0, f64::max);
        // In a viscous cell crossbridges are also distorted by the lagging shape; their number is
        // at most that which this calcium would bind.
        let bound = filaments.steady(calcium, 1.0);
        let drawn = filaments.instantaneous_stiffness(&bound, 1.0);
        let gives = self.response.steepest();
        let fastest = fastest.max(self.lag.rate(0.0, 1.0 + gives * drawn));
        let steps = (interval * fastest / OF_FASTEST).ceil().max(1.0);
        (steps < 1e4).then_some(steps as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::land_2017::Land2017;
    use crate::integrate::quasi_static::Tolerance;
    use crate::mesh::lattice;

    #[test]
    fn a_steady_beat_stands_for_those_that_follow() {
        let simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
        let table = simulation.equilibria_to(0.2, Tolerance::default()).unwrap();
        let cell = Land2017::published();
        for lag in [0.0, 25.0].map(Lag::by) {
            for (before, cycle_ms) in [(0, 1000.0), (0, 380.0), (10, 380.0)] {
                let train = Train { before, beats: 8, cycle_ms };
                let of = |steady: f64| {
                    let given = GivenCalcium::of(&cell, &table, lag).unwrap();
                    GivenCalcium { steady, ..given }.shortening(&train).unwrap()
                };
                let [quick, whole] = [STEADY, 0.0].map(of);
                assert_eq!(quick.len(), whole.len());
                let off = quick.iter().zip(whole.iter()).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, f64::max);
                // No state is further from the steady one than it moves in a beat.
                assert!(off < 1e-9, "{before} beats of {cycle_ms} ms before, {lag:?}: {off}");
            }
        }
    }
}
