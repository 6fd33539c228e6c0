//! A run along the path of equilibria.
//!
//! The cell model runs in time and depends on the stretch as in any run; the mesh takes at once the
//! equilibrium shape under the tension ([`Equilibria`]). Frames are shapes of the path.
//!
//! Momenta, kinetic energy and dissipation are 0, their limits for a slow contraction. The work of
//! the active force equals the elastic energy; it is computed independently, as in a run in time.

use super::coupler::Shaping;
use super::course::{Observable, Observed};
use super::equilibria::{Equilibria, MARGIN, PER_TENSION, Quantities};
use super::fault::fault;
use super::observer::{Progress, RunObserver, Samples};
use super::outcome::{Effort, Outcome};
use super::setup::Setup;
use super::space::Space;
use super::{SettingError, Simulation, StopReason};
use crate::cell::tension::lag::Lag;
use crate::exchange::Sites;
use crate::integrate::quasi_static::{PathError, Shapes};
use crate::mechanics::{Tension, Vectors};
use crate::recording::Recording;

/// A prepared quasi-static run: its path is solved up to the peak of tension.
pub struct PreparedPath<const D: usize = 2, const N: usize = 3> {
    pub(super) setup: Setup<D, N>,
    pub(super) equilibria: Equilibria<D, N>,
}

impl<const D: usize, const N: usize> Setup<D, N> {
    /// Refuses simulations whose path cannot be solved in advance.
    pub(super) fn check_path(&self) -> Result<(), SettingError> {
        match self.sites() {
            Sites::Whole => Ok(()),
            Sites::PerElement(_) => Err(SettingError::Conflict {
                what: "a tension for each triangle",
                with: "a path of equilibria, which is solved in advance",
                because: "take Simulation::build, or prepare_field, which goes from one to the next",
            }),
        }
    }

    /// The tension up to which a path is solved in advance, kPa.
    pub(super) fn peak(&self) -> f64 {
        (1.0 + MARGIN) * self.strongest.tension
    }
}

#[allow(private_bounds, reason = "flat or thick, and nothing else")]
impl<const D: usize, const N: usize> PreparedPath<D, N>
where
    Simulation: Space<D, N>,
{
    /// Why the path ends before the peak of tension, if it does.
    pub fn end(&self) -> Option<&PathError> {
        self.equilibria.end(self.setup.peak())
    }

    /// Runs to the end or to the first fault; `observe` is called at each recorded sample and stops
    /// the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`PreparedPath::run`], for an observer that is also called when a part of the work
    /// begins.
    pub fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        let setup = &self.setup;
        let start = setup.activation.tension().at(0);
        let state = Lagging { tension: start, work: 0.0 };
        let equilibria = self.equilibria.clone();
        let mut shaping =
            AlongPath { setup, equilibria, state, marked: state, start: Quantities::default() };
        let (recording, stop) = match shaping.follow(0.0, [start.into(); 2]) {
            Ok(()) => {
                shaping.start = shaping.equilibria.at(start);
                setup.run(&mut shaping, observer)
            }
            Err(reason) => (Recording::default(), Some(reason)),
        };
        let Equilibria { held, loaded } = &shaping.equilibria;
        let paths = || std::iter::once(held).chain(loaded.as_deref()).map(|branch| &branch.shapes);
        let effort = Effort::QuasiStatic {
            load_steps: paths().map(Shapes::load_steps).sum(),
            newton_iterations: paths().map(Shapes::newton_iterations).sum(),
            factorisations: paths().map(Shapes::factorisations).sum(),
            interpolation_error_um: paths().map(Shapes::error).fold(0.0, f64::max),
            delay_ms: paths().map(Shapes::delay).fold(0.0, f64::max),
        };
        let (stimulus_times_ms, s2_ms) = (setup.stimulus_times(), setup.s2_ms());
        Outcome { recording, stop, effort, engine: None, stimulus_times_ms, s2_ms }
    }
}

/// A mesh that takes the shapes of a path, at the present tension or lagging behind it.
struct AlongPath<'a, const D: usize, const N: usize> {
    setup: &'a Setup<D, N>,
    equilibria: Equilibria<D, N>,
    state: Lagging,
    marked: Lagging,
    /// At the start of the run.
    start: Quantities,
}

/// The position of a mesh on the path.
#[derive(Debug, Clone, Copy)]
struct Lagging {
    /// The tension at which its shape is an equilibrium, kPa: the active tension, unless the cell
    /// is viscous.
    tension: f64,
    /// Work of the active tension since the start of the run, fJ; only for a viscous cell.
    work: f64,
}

impl<const D: usize, const N: usize> AlongPath<'_, D, N> {
    /// Whether the work of the tension depends on more than the present shape.
    fn keeps_account(&self) -> bool {
        self.is_viscous() || self.equilibria.loaded.is_some()
    }

    fn is_viscous(&self) -> bool {
        self.setup.simulation.material.retardation_time > 0.0
    }
}

impl<const D: usize, const N: usize> Shaping for AlongPath<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn is_static(&self) -> bool {
        true
    }

    fn mark(&mut self) {
        self.marked = self.state;
    }

    fn back(&mut self) {
        self.state = self.marked;
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let acting = tensions.map(|tension| tension.at(0));
        let simulation = &self.setup.simulation;
        let lag = Lag::by(simulation.material.retardation_time);
        let over = time.min(simulation.numerics.exchange_interval);
        let tension = lag.over_line(over, self.state.tension, acting);
        self.equilibria.reach(simulation, time, tension)?;
        if self.keeps_account() {
            let per_tension = |tension: f64| self.equilibria.at(tension)[PER_TENSION];
            let [before, after] = [self.state.tension, tension].map(per_tension);
            self.state.work += 0.5 * (acting[0] + acting[1]) * (before - after);
        }
        self.state.tension = tension;
        let [lowest, highest] = self.equilibria.branch(tension).intact();
        if !(lowest..=highest).contains(&tension) {
            let positions = self.positions();
            if let Some(reason) = fault(simulation.body_mesh(), &positions, time, tension) {
                return Err(reason);
            }
        }
        Ok(())
    }

    fn stretch_now(&self) -> Vec<f64> {
        let [length, ..] = self.equilibria.at(self.state.tension);
        vec![self.setup.assembly.stretch(length)]
    }
}

impl<const D: usize, const N: usize> Observable<D> for AlongPath<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn observe(&self) -> Observed {
        let [length, width, area, elastic_energy, work, _, gauges @ ..] =
            self.equilibria.at(self.state.tension);
        let told = self.setup.assembly.gauges.outputs().len();
        let [_, _, _, elastic_at_start, work_at_start, ..] = self.start;
        let active_work = if self.keeps_account() { self.state.work } else { work - work_at_start };
        let dissipated_energy =
            if self.is_viscous() { active_work - (elastic_energy - elastic_at_start) } else { 0.0 };
        Observed {
            length,
            width,
            area,
            elastic_energy,
            kinetic_energy: 0.0,
            active_work,
            dissipated_energy,
            momentum: 0.0,
            angular_momentum: 0.0,
            gauges: gauges[..told].to_vec(),
        }
    }

    /// The path reaches every tension of the run.
    fn positions(&self) -> Vectors<D> {
        let tension = self.state.tension;
        let positions = self.equilibria.positions(tension);
        positions.unwrap_or_else(|| self.setup.assembly.body.positions.clone())
    }

    fn pulls(&self) -> Option<Vectors<D>> {
        self.equilibria.pulls(self.state.tension)
    }
}
