//! The contraction of a cell whose myofilaments feel its length and whose calcium is given: `land_2017` along a mesh's
//! equilibria.
//!
//! Distortions follow the rate of the stretch, which follows the tension, which follows the distortions. What a
//! distortion has beyond the stretch itself has no such circle:
//!
//! ```text
//! y = zeta - A lambda,   dy/dt = -c (y + A lambda)
//! lambda = S(Ta(XS, XW, y + A lambda, lambda))
//! ```
//!
//! with `S` the table of equilibria. A stronger pull shortens the cell and a shorter cell pulls less, so the second line
//! has one solution. What is left are six equations without a rate on their right side, which the classical method of
//! Runge and Kutta takes in steps of two milliseconds.
//!
//! The shape of a viscous cell is that of another tension, `theta` ([`Lag`]): `lambda = S(theta)`.

use super::physics::Train;
use super::table::Tables;
use crate::cell::CellModel;
use crate::cell::calcium::Calcium;
use crate::cell::land_2017::{self, STATES};
use crate::cell::tension::lag::Lag;
use crate::simulation::Simulation;
use std::sync::Arc;

/// Most between samples, ms; steps are as long or shorter. Against steps of 0.1 ms curves are within 1e-5 of their
/// height.
const INTERVAL_MS: f64 = 2.0;
/// A step is at most so many times the fastest time constant: the method is stable up to 2.8.
const OF_FASTEST: f64 = 1.5;
/// Steps of Newton's method, and the change of the stretch that ends it.
const TRIES: usize = 40;
const AGREED: f64 = 1e-10;
/// A train is steady once no state changes by more than this from beat to beat: each beat brings it a hundred times
/// closer, or more.
const STEADY: f64 = 1e-9;

/// The six, with `y` for the distortions, and `theta`.
type State = [f64; STATES + 1];
const THETA: usize = STATES;

/// Beats of myofilaments on a mesh.
pub(super) struct Myofilaments {
    tables: Arc<Tables>,
    train: Train,
    lag: Lag,
    steady: f64,
}

/// A cell on its way.
struct Way<'a> {
    filaments: &'a land_2017::Myofilaments,
    calcium: &'a Calcium,
    tables: &'a Tables,
    stiffness: f64,
    distortion: f64,
    lag: Lag,
}

impl Myofilaments {
    /// Whether a simulation's cell is such, and its mesh neither held nor begun in a way of its own.
    pub(super) fn serve(simulation: &Simulation) -> bool {
        given(&*simulation.cell).is_some() && is_plain(simulation)
    }

    pub(super) fn new(tables: Arc<Tables>, train: Train, lag: Lag) -> Self {
        Self { tables, train, lag, steady: STEADY }
    }

    /// Between samples, ms: a cycle is a whole number of them.
    pub(super) fn interval(&self) -> f64 {
        self.train.cycle / self.intervals() as f64
    }

    fn intervals(&self) -> usize {
        ((self.train.cycle / INTERVAL_MS).ceil() as usize).max(3)
    }

    /// Shortening at every interval from the first stimulus of those that were recorded on; `None` where there is no
    /// beat.
    pub(super) fn shortening(&self, cell: &dyn CellModel, stiffness: f64) -> Option<Arc<[f64]>> {
        let (filaments, calcium) = given(cell)?;
        let distortion = filaments.distortion_per_stretch();
        let (tables, lag) = (&*self.tables, self.lag);
        let mut way = Way { filaments, calcium, tables, stiffness, distortion: 0.0, lag };
        let Train { before, beats, cycle } = self.train;
        let (intervals, length) = (self.intervals(), self.interval());
        let steps = way.steps(cycle, length)?;
        // Before the first stimulus nothing moves, and nothing is distorted.
        let mut state = [0.0; STATES + 1];
        state[..STATES].copy_from_slice(&filaments.steady(calcium.rest(), 1.0));
        let mut stretch = way.stretch_at_once(&state, 1.0)?;
        state[THETA] = filaments.tension(&way.whole(&state, stretch), stretch);
        way.distortion = distortion;
        for y in [4, 5] {
            state[y] = -distortion * stretch;
        }
        let mut samples = Vec::with_capacity(beats * intervals + 1);
        samples.push(1.0 - stretch);
        let mut course = Vec::with_capacity(intervals);
        let mut is_steady = false;
        for beat in 0..before + beats {
            // Once steady, each beat is as the one before.
            if !is_steady {
                let was = state;
                course.clear();
                for interval in 0..intervals {
                    let since = interval as f64 * length;
                    way.interval(&mut state, &mut stretch, since, length, steps)?;
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
        Some(samples.into())
    }
}

/// The stretch of a mesh under the tension that myofilaments make at that stretch: Newton's method from a guess. The
/// first of `shaping` times that tension, and the second, shape the mesh; `whole` is the state at a stretch, and which
/// part of a distortion that comes with it is gone already.
pub(super) fn meet(
    filaments: &land_2017::Myofilaments,
    tables: &Tables,
    stiffness: f64,
    guess: f64,
    [share, kept]: [f64; 2],
    whole: impl Fn(f64) -> ([f64; STATES], f64),
) -> Option<f64> {
    let mut stretch = guess;
    for _ in 0..TRIES {
        let (state, gone) = whole(stretch);
        let tension = share * filaments.tension(&state, stretch) + kept;
        let [shortening, slope] = tables.with_slope(tension, stiffness);
        let by = (1.0 - gone) * share * filaments.instantaneous_stiffness(&state, stretch).max(0.0);
        // d/d lambda of lambda - S(Ta(lambda)), at least 1
        let step = (1.0 - shortening - stretch) / (1.0 + slope.max(0.0) * by);
        stretch += step;
        if step.abs() < AGREED {
            return stretch.is_finite().then_some(stretch);
        }
    }
    None
}

/// Whether a mesh is neither held nor begun in a way of its own, and its tension one.
pub(super) fn is_plain(simulation: &Simulation) -> bool {
    simulation.end_stretch == 1.0
        && simulation.resting_stretch.is_none()
        && simulation.start_state.is_none()
        && simulation.activation.is_none()
        && !simulation.has_sites_in_triangles()
        && !simulation.support.clamps()
}

/// The equations and the calcium of a cell that is nothing but myofilaments with given calcium.
fn given(cell: &dyn CellModel) -> Option<(&land_2017::Myofilaments, &Calcium)> {
    let filaments = cell.filaments().filter(|_| cell.states().len() == STATES)?;
    Some((filaments.equations, filaments.calcium?))
}

impl Way<'_> {
    /// So many steps from a time after the stimulus on.
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
        let stretch = 1.0 - self.tables.at(state[THETA], self.stiffness);
        stretch.is_finite().then_some(stretch)
    }

    /// The stretch of the mesh under the tension that it makes at that stretch.
    fn stretch_at_once(&self, state: &State, guess: f64) -> Option<f64> {
        let filaments = self.filaments;
        let whole = |stretch: f64| (self.whole(state, stretch), 0.0);
        meet(filaments, self.tables, self.stiffness, guess, [1.0, 0.0], whole)
    }

    /// Steps an interval, such that none is longer than the fastest of the equations allows.
    fn steps(&self, cycle: f64, interval: f64) -> Option<usize> {
        let filaments = self.filaments;
        let calcium = (0..=200).map(|at| self.calcium.at(cycle * f64::from(at) / 200.0));
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
        // A shape that lags is drawn by crossbridges that it distorts: no more of them than that calcium would bind.
        let bound = filaments.steady(calcium, 1.0);
        let drawn = filaments.instantaneous_stiffness(&bound, 1.0);
        let gives = self.tables.largest_slope() / self.stiffness;
        let fastest = fastest.max(self.lag.rate(0.0, 1.0 + gives * drawn));
        let steps = (interval * fastest / OF_FASTEST).ceil().max(1.0);
        (steps < 1e4).then_some(steps as usize)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fit::table::Shelf;
    use crate::mesh::lattice;

    #[test]
    fn a_steady_beat_stands_for_those_that_follow() {
        let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
        simulation.cell = Arc::new(land_2017::Land2017::published());
        let tables = Shelf::default().tables(&simulation, 0.2, false).unwrap();
        for lag in [0.0, 25.0] {
            for (before, cycle) in [(0, 1000.0), (0, 380.0), (10, 380.0)] {
                let train = Train { before, beats: 8, cycle };
                let lag = Lag::by(lag);
                let quick = Myofilaments::new(Arc::clone(&tables), train, lag);
                let whole = Myofilaments {
                    steady: 0.0,
                    ..Myofilaments::new(Arc::clone(&tables), train, lag)
                };
                let [quick, whole] =
                    [quick, whole].map(|way| way.shortening(&*simulation.cell, 1.0).unwrap());
                assert_eq!(quick.len(), whole.len());
                let off = quick.iter().zip(whole.iter()).map(|(a, b)| (a - b).abs());
                let off = off.fold(0.0, f64::max);
                // No state is further from the steady one than it moves in a beat.
                assert!(off < 1e-9, "{before} beats of {cycle} ms before, {lag:?}: {off}");
            }
        }
    }
}
