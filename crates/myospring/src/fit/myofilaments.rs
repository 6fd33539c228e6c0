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
//! Runge and Kutta takes in steps of a millisecond.

use super::physics::Train;
use super::table::Tables;
use crate::cell::CellModel;
use crate::cell::land_2017::{Land2017, STATES};
use crate::simulation::Simulation;
use std::any::Any;
use std::sync::Arc;

/// Most between samples, ms; steps are as long or shorter.
const INTERVAL_MS: f64 = 1.0;
/// A step is at most this part of the fastest time constant.
const OF_FASTEST: f64 = 1.0;
/// Steps of Newton's method, and the change of the stretch that ends it.
const TRIES: usize = 40;
const AGREED: f64 = 1e-12;
/// A train is steady once no state changes by more than this from beat to beat.
const STEADY: f64 = 1e-7;

type State = [f64; STATES];

/// Beats of myofilaments on a mesh.
pub(super) struct Myofilaments {
    tables: Arc<Tables>,
    train: Train,
}

/// A cell on its way.
struct Way<'a> {
    model: &'a Land2017,
    tables: &'a Tables,
    stiffness: f64,
    distortion: f64,
}

impl Myofilaments {
    /// Whether a simulation's cell is such, and its mesh neither held nor begun in a way of its own.
    pub(super) fn serve(simulation: &Simulation) -> bool {
        land(&*simulation.cell).is_some()
            && simulation.material.retardation_time == 0.0
            && simulation.end_stretch == 1.0
            && simulation.resting_stretch.is_none()
            && simulation.start_state.is_none()
            && simulation.activation.is_none()
            && !simulation.has_sites_in_triangles()
            && !simulation.support.clamps()
    }

    pub(super) fn new(tables: Arc<Tables>, train: Train) -> Self {
        Self { tables, train }
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
        let model = land(cell)?;
        let filaments = model.myofilaments();
        let distortion = filaments.distortion_per_stretch();
        let mut way = Way { model, tables: &self.tables, stiffness, distortion: 0.0 };
        let Train { before, beats, cycle } = self.train;
        let (intervals, length) = (self.intervals(), self.interval());
        let steps = way.steps(cycle, length)?;
        // Before the first stimulus nothing moves, and nothing is distorted.
        let mut state = filaments.steady(model.calcium().rest(), 1.0);
        let mut stretch = way.stretch(&state, 1.0)?;
        way.distortion = distortion;
        for y in [4, 5] {
            state[y] = -distortion * stretch;
        }
        let mut samples = Vec::with_capacity(beats * intervals + 1);
        samples.push(1.0 - stretch);
        for _ in 0..before {
            let was = state;
            for interval in 0..intervals {
                way.interval(&mut state, &mut stretch, interval as f64 * length, length, steps)?;
            }
            samples[0] = 1.0 - stretch;
            let moved = state.iter().zip(was).map(|(now, was)| (now - was).abs());
            if moved.fold(0.0, f64::max) < STEADY {
                break;
            }
        }
        for interval in 0..beats * intervals {
            let since = (interval % intervals) as f64 * length;
            way.interval(&mut state, &mut stretch, since, length, steps)?;
            samples.push(1.0 - stretch);
        }
        Some(samples.into())
    }
}

fn land(cell: &dyn CellModel) -> Option<&Land2017> {
    (cell as &dyn Any).downcast_ref::<Land2017>()
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
        for i in 0..STATES {
            state[i] += h / 6.0 * (first[i] + 2.0 * (second[i] + third[i]) + fourth[i]);
        }
        *stretch = self.stretch(state, at)?;
        Some(())
    }

    /// Rates of the states with `y` for the distortions, at the stretch that goes with them.
    fn rates(&self, state: &State, stretch: f64, time: f64) -> State {
        let whole = self.whole(state, stretch);
        self.model.myofilaments().rates(&whole, self.model.calcium().at(time), stretch, 0.0)
    }

    /// The state with distortions.
    fn whole(&self, state: &State, stretch: f64) -> State {
        let [xs, xw, c, b, y_s, y_w] = *state;
        let all = self.distortion * stretch;
        [xs, xw, c, b, y_s + all, y_w + all]
    }

    /// The stretch of the mesh under the tension that it makes at that stretch: Newton's method from a guess.
    fn stretch(&self, state: &State, guess: f64) -> Option<f64> {
        let filaments = self.model.myofilaments();
        let mut stretch = guess;
        for _ in 0..TRIES {
            let whole = self.whole(state, stretch);
            let tension = filaments.tension(&whole, stretch);
            let [shortening, slope] = self.tables.with_slope(tension, self.stiffness);
            let by = filaments.instantaneous_stiffness(&whole, stretch).max(0.0);
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
        let filaments = self.model.myofilaments();
        let calcium = (0..=200).map(|at| self.model.calcium().at(cycle * f64::from(at) / 200.0));
        let calcium = calcium.fold(0.0, f64::max);
        // Each equation is linear in its own variable; without calcium bound, blocking is as fast as it gets.
        let none: State = [0.0; STATES];
        let still = filaments.rates(&none, calcium, 1.0, 0.0);
        let fastest = (0..STATES)
            .map(|place| {
                let mut one = none;
                one[place] = 1.0;
                let rate = filaments.rates(&one, calcium, 1.0, 0.0)[place] - still[place];
                rate.abs()
            })
            .fold(0.0, f64::max);
        let steps = (interval * fastest / OF_FASTEST).ceil().max(1.0);
        (steps < 1e4).then_some(steps as usize)
    }
}
