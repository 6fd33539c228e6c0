//! A run from equilibrium to equilibrium, for a tension that differs from place to place.
//!
//! Such a tension has no path that could be solved in advance: at the end of every exchange
//! interval the equilibrium under the tensions of all triangles is solved, starting from the last
//! one.

use super::coupler::Shaping;
use super::course::{Observable, Observed};
use super::fault::fault;
use super::held::Held;
use super::observer::{Progress, RunObserver, Samples};
use super::outcome::{Effort, Outcome};
use super::setup::{Assembly, Setup};
use super::space::Space;
use super::{SetupError, Simulation, StopReason};
use crate::integrate::quasi_static::{Equilibrium, PathError, Tolerance};
use crate::mechanics::{Body, Tension, Vectors};
use crate::recording::Recording;

/// A prepared run from equilibrium to equilibrium.
pub struct PreparedField<const D: usize = 2, const N: usize = 3> {
    pub(super) setup: Setup<D, N>,
    tolerance: Tolerance,
}

impl Simulation {
    /// Prepares a run from equilibrium to equilibrium, for any activation, such as one with a site
    /// for each triangle; time step and method of the numerical settings are not used.
    ///
    /// # Errors
    /// An invalid setting, or forces without equilibria.
    pub fn prepare_field(&self, tolerance: Tolerance) -> Result<PreparedField, SetupError> {
        self.refuse_thick("PreparedField")?;
        self.field(tolerance)
    }

    pub(super) fn field<const D: usize, const N: usize>(
        &self,
        tolerance: Tolerance,
    ) -> Result<PreparedField<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        let setup = self.set_up()?;
        Equilibrium::new(&setup.assembly.system, &setup.assembly.body, tolerance)?;
        Ok(PreparedField { setup, tolerance })
    }
}

#[allow(private_bounds, reason = "flat or thick, and nothing else")]
impl<const D: usize, const N: usize> PreparedField<D, N>
where
    Simulation: Space<D, N>,
{
    /// Runs to the end or to the first fault; `observe` is called at each recorded sample and stops
    /// the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`PreparedField::run`], for an observer that is also called when a part of the work
    /// begins.
    pub fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        let setup = &self.setup;
        let mut solved = [0; 3];
        let (recording, stop) = match FromRestToRest::start(setup, self.tolerance) {
            Ok(mut shaping) => {
                let run = setup.run(&mut shaping, observer);
                let Equilibrium { newton_iterations, .. } = shaping.equilibrium;
                solved = [shaping.solved, newton_iterations, shaping.equilibrium.factorisations()];
                run
            }
            Err(reason) => (Recording::default(), Some(reason)),
        };
        let [equilibria, newton_iterations, factorisations] = solved;
        let effort = Effort::Field { equilibria, newton_iterations, factorisations };
        let (stimulus_times_ms, s2_ms) = (setup.stimulus_times(), setup.s2_ms());
        Outcome { recording, stop, effort, engine: None, stimulus_times_ms, s2_ms }
    }
}

/// A mesh at rest under the tensions of its triangles.
struct FromRestToRest<'a, const D: usize, const N: usize> {
    setup: &'a Setup<D, N>,
    equilibrium: Equilibrium<'a, D>,
    state: State<D>,
    marked: State<D>,
    /// Equilibria so far.
    solved: usize,
}

#[derive(Clone)]
struct State<const D: usize> {
    /// At rest.
    body: Body<D>,
    /// Positions at the two ends of intervals before, the later first.
    past: [Vectors<D>; 2],
    tension: Held,
    active_work: f64,
}

impl<const D: usize> State<D> {
    /// Positions at the end of the next interval, if they go on along a parabola: where to begin, no more.
    fn foretold(&self) -> Vectors<D> {
        let [one, two] = &self.past;
        std::array::from_fn(|axis| {
            let [last, one, two] = [&self.body.positions[axis], &one[axis], &two[axis]];
            let next = |((last, one), two): ((&f64, &f64), &f64)| 3.0 * (last - one) + two;
            last.iter().zip(one).zip(two).map(next).collect()
        })
    }
}

impl<'a, const D: usize, const N: usize> FromRestToRest<'a, D, N>
where
    Simulation: Space<D, N>,
{
    /// In equilibrium under the tension before the run begins, that of the unstretched cell.
    fn start(setup: &'a Setup<D, N>, tolerance: Tolerance) -> Result<Self, StopReason> {
        let Assembly { system, body, .. } = &*setup.assembly;
        let broken_off = |error: PathError| match error {
            PathError::Interrupted => StopReason::Interrupted { time: 0.0 },
            error => StopReason::BrokenOff { time: 0.0, cause: error.to_string() },
        };
        let tolerance = setup.simulation.accepting(tolerance);
        let equilibrium =
            Equilibrium::new_interruptible(system, body, tolerance, &setup.simulation.interruption);
        let equilibrium = equilibrium.map_err(broken_off)?;
        let tension = Held::of(setup.activation.tension());
        let past = [body.positions.clone(), body.positions.clone()];
        let state = State { tension: tension.clone(), body: body.clone(), past, active_work: 0.0 };
        let mut shaping = Self { setup, equilibrium, marked: state.clone(), state, solved: 0 };
        shaping.follow(0.0, [tension.tension(); 2])?;
        shaping.state.active_work = 0.0;
        Ok(shaping)
    }
}

impl<const D: usize, const N: usize> FromRestToRest<'_, D, N>
where
    Simulation: Space<D, N>,
{
    /// Sound positions at rest near a guess, and the tension there.
    fn at_rest_near(
        &mut self,
        guess: &Vectors<D>,
        time: f64,
        tension: Tension<'_>,
    ) -> Result<(Vectors<D>, Held), StopReason> {
        let Setup { simulation, fibre_stretch, volumes, .. } = self.setup;
        let positions = self.equilibrium.find(guess, tension).map_err(|cause| match cause {
            PathError::Interrupted => StopReason::Interrupted { time },
            cause => {
                let tension = Held::of(tension).average(volumes);
                StopReason::NoEquilibrium { time, tension, cause: cause.to_string() }
            }
        })?;
        let tension = match (tension, fibre_stretch) {
            (Tension::Following(law), Some(meter)) => {
                let stretch = meter.stretches(&positions);
                Held::PerElement((0..stretch.len()).map(|e| law.at(e, stretch[e], 0.0)).collect())
            }
            (tension, _) => Held::of(tension),
        };
        let average = tension.average(volumes);
        match fault(simulation.body_mesh(), &positions, time, average) {
            Some(reason) => Err(reason),
            None => Ok((positions, tension)),
        }
    }
}

impl<const D: usize, const N: usize> Setup<D, N>
where
    Simulation: Space<D, N>,
{
    /// The mesh at rest under the tension before the run begins.
    pub(super) fn at_rest(&self) -> Result<Body<D>, StopReason> {
        if Held::of(self.activation.tension()).is_zero() {
            return Ok(self.assembly.body.clone());
        }
        let mut shaping = FromRestToRest::start(self, Tolerance::default())?;
        self.settle(&mut shaping)?;
        Ok(shaping.state.body)
    }
}

impl<const D: usize, const N: usize> Shaping for FromRestToRest<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn is_static(&self) -> bool {
        true
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let Setup { assembly, .. } = self.setup;
        self.solved += 1;
        let foretold = self.state.foretold();
        let (positions, tension) = match self.at_rest_near(&foretold, time, tensions[1]) {
            Err(StopReason::Interrupted { time }) => return Err(StopReason::Interrupted { time }),
            // What was foretold may lead astray.
            Err(_) => {
                let last = self.state.body.positions.clone();
                self.at_rest_near(&last, time, tensions[1])?
            }
            Ok(found) => found,
        };
        let State { body, past, tension: before, active_work } = &mut self.state;
        let mean = before.mean(&tension);
        // W = -int grad E(x; Ta) dx
        let energy =
            |body: &Body<D>| assembly.system.active_energy(&body.configuration(mean.tension()));
        *active_work += energy(body);
        let last = std::mem::replace(&mut body.positions, positions);
        // Before the run begins nothing has moved.
        if time > 0.0 {
            past.rotate_right(1);
            past[0] = last;
        } else {
            *past = [body.positions.clone(), body.positions.clone()];
        }
        *active_work -= energy(body);
        *before = tension;
        Ok(())
    }

    fn mark(&mut self) {
        self.marked.clone_from(&self.state);
    }

    fn back(&mut self) {
        self.state.clone_from(&self.marked);
    }

    fn stretch_now(&self) -> Vec<f64> {
        self.setup.stretch_at(&self.state.body.positions)
    }
}

impl<const D: usize, const N: usize> Observable<D> for FromRestToRest<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn observe(&self) -> Observed {
        let Setup { simulation, assembly, .. } = self.setup;
        let State { body, tension, active_work, .. } = &self.state;
        let extent = assembly.measure(&body.positions);
        let at = body.configuration(tension.tension());
        let area = assembly.area(&simulation.mesh, &body.positions);
        Observed {
            length: extent.length,
            width: extent.width,
            area,
            elastic_energy: assembly.system.elastic_energy(&at),
            kinetic_energy: 0.0,
            active_work: *active_work,
            dissipated_energy: 0.0,
            momentum: 0.0,
            angular_momentum: 0.0,
            gauges: assembly.gauges.read_now(&assembly.system, &at, area),
        }
    }

    fn positions(&self) -> Vectors<D> {
        self.state.body.positions.clone()
    }
}
