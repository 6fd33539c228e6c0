//! A mesh whose masses move in time.

use super::coupler::Shaping;
use super::course::{Observable, Observed};
use super::fault::Watch;
use super::held::Held;
use super::observer::{Progress, RunObserver, Samples};
use super::outcome::{Effort, Outcome};
use super::setup::Setup;
use super::shared_cell::SharedCell;
use super::space::Space;
use super::{SAFETY, SetupError, Simulation, StopReason};
use crate::exchange::Sites;
use crate::integrate::engine::EngineUsed;
use crate::integrate::stepper::Stepper;
use crate::mechanics::stability::StabilityLimit;
use crate::mechanics::{Body, System, Tension, Vectors};
use crate::mesh::Place;
use crate::recording::Recording;
use std::sync::Arc;

/// Steps times masses between checks for an interruption: less than half a second.
const STEPS_OF_MASSES: usize = 10_000_000;

/// A prepared run in time: forces assembled, time step chosen, engine checked.
pub struct Prepared<const D: usize = 2, const N: usize = 3> {
    pub(super) setup: Setup<D, N>,
    /// The stability limit at peak tension.
    pub limit: StabilityLimit,
    /// Mechanical steps in each exchange interval.
    pub steps_per_exchange: usize,
    engine: EngineUsed,
    /// At rest under the tension before the first beat.
    start: Body<D>,
    /// Why it is not, and is instead in the shape without tension.
    pub(super) not_at_rest: Option<String>,
}

impl Simulation {
    /// Checks everything, assembles the forces and chooses the time step of a motion in time, whatever method
    /// the numerical settings name.
    ///
    /// # Errors
    /// An invalid setting, a time step above the stability limit, an engine that cannot move this
    /// mesh, or a cell model without tension to scale.
    pub fn prepare(&self) -> Result<Prepared, SetupError> {
        self.refuse_thick("Prepared")?;
        self.in_time()
    }

    pub(super) fn in_time<const D: usize, const N: usize>(
        &self,
    ) -> Result<Prepared<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        self.check()?;
        let known = SharedCell::of(self);
        let chosen = self.with_period(&known)?;
        let assembly = Arc::new(chosen.assembled_at_rest()?);
        let setup = chosen.set_up_on(assembly, &known)?;
        let (system, body) = (&setup.assembly.system, &setup.assembly.body);
        let limit = setup.under_strongest(|tension| {
            StabilityLimit::of_interruptible(system, body, tension, &self.interruption)
        })?;
        // A custom stepper may be stable at larger steps than Verlet's method.
        if let Some(time_step) = self.numerics.time_step
            && self.stepper.is_none()
            && time_step > limit.time_step
        {
            let node = limit.stiffest_node;
            let place = Place::of(&self.body_mesh().points, node);
            let limit = limit.time_step;
            return Err(SetupError::UnstableStep { time_step, limit, node, place });
        }
        let wanted = self.numerics.time_step.unwrap_or(SAFETY * limit.time_step);
        // Equal steps that fill the exchange interval; with a margin for rounding of the quotient.
        let steps = (self.numerics.exchange_interval / wanted - 1e-9).ceil().max(1.0) as usize;
        let (start, not_at_rest) = match setup.at_rest() {
            Ok(body) => (body, None),
            Err(StopReason::Interrupted { .. }) => return Err(SetupError::Interrupted),
            Err(reason) => (setup.assembly.body.clone(), Some(reason.to_string())),
        };
        let engine = EngineUsed::Own;
        let steps_per_exchange = steps;
        let mut prepared =
            Prepared { setup, limit, steps_per_exchange, engine, start, not_at_rest };
        let (_, engine) = prepared.stepper()?;
        prepared.engine = engine;
        Ok(prepared)
    }
}

#[allow(private_bounds, reason = "flat or thick, and nothing else")]
impl<const D: usize, const N: usize> Prepared<D, N>
where
    Simulation: Space<D, N>,
{
    /// The mechanical time step, ms.
    pub fn time_step(&self) -> f64 {
        self.setup.simulation.numerics.exchange_interval / self.steps_per_exchange as f64
    }

    /// The engine of the run.
    pub fn engine(&self) -> &EngineUsed {
        &self.engine
    }

    fn stepper(&self) -> Result<(Box<dyn Stepper<D> + '_>, EngineUsed), SetupError> {
        let Setup { simulation, assembly, .. } = &self.setup;
        let uniform = self.setup.sites() == Sites::Whole;
        Ok(simulation.moved(&assembly.system, &self.start, self.time_step(), uniform)?)
    }

    /// Runs to the end or to the first fault; `observe` is called at each recorded sample and stops
    /// the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`Prepared::run`], for an observer that is also called when a part of the work begins.
    pub fn run_observed(&self, observer: &mut dyn RunObserver) -> Outcome {
        let (steps, recording, stop) = match self.stepper() {
            Ok((stepper, _)) => {
                let mut shaping = InTime::new(&self.setup, stepper, self.steps_per_exchange);
                let (recording, stop) = self.setup.run(&mut shaping, observer);
                (shaping.stepper.steps(), recording, stop)
            }
            // It was created once already, but a custom function may still fail.
            Err(error) => {
                let stop = StopReason::BrokenOff { time: 0.0, cause: error.to_string() };
                (0, Recording::default(), Some(stop))
            }
        };
        let (time_step_ms, stability_limit_ms) = (self.time_step(), self.limit.time_step);
        let simulation = &self.setup.simulation;
        let is_even = self.setup.sites() == Sites::Whole;
        let effort = if self.engine == EngineUsed::Own {
            Effort::OwnStepper { time_step_ms, stability_limit_ms, steps }
        } else {
            Effort::Verlet {
                time_step_ms,
                stability_limit_ms,
                steps,
                slowest_period_ms: simulation.material.slowest_period,
                lag_pct: simulation.lag_pct(&recording.samples).filter(|_| is_even),
            }
        };
        let (engine, stimulus_times_ms) = (Some(self.engine.clone()), self.setup.stimulus_times());
        let s2_ms = self.setup.s2_ms();
        Outcome { recording, stop, effort, engine, stimulus_times_ms, s2_ms }
    }
}

/// Masses that move in time.
struct InTime<'a, const D: usize, const N: usize> {
    setup: &'a Setup<D, N>,
    stepper: Box<dyn Stepper<D> + 'a>,
    /// Steps in each exchange interval.
    steps: usize,
    ledger: Ledger<D>,
    marked: Option<Ledger<D>>,
    watch: Watch<D>,
}

impl<'a, const D: usize, const N: usize> InTime<'a, D, N>
where
    Simulation: Space<D, N>,
{
    /// A motion with a number of steps in each exchange interval.
    fn new(setup: &'a Setup<D, N>, stepper: Box<dyn Stepper<D> + 'a>, steps: usize) -> Self {
        let ledger = Ledger::new(stepper.body(), Held::of(setup.activation.tension()));
        Self { setup, stepper, steps, ledger, marked: None, watch: Watch::new() }
    }

    /// Advances by an exchange interval, in parts if it takes long, so that it can be interrupted.
    fn advance(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let interruption = &self.setup.simulation.interruption;
        let at_once = (STEPS_OF_MASSES / self.stepper.body().len().max(1)).max(1);
        let [from, to] = match tensions {
            [Tension::Uniform(from), Tension::Uniform(to)] if self.steps > at_once => [from, to],
            // A tension that differs from place to place follows the mesh, so the interval is not
            // divided.
            _ => return self.step(self.steps, time, tensions),
        };
        let all = self.steps;
        let after = |steps: usize| from + (to - from) * steps as f64 / all as f64;
        for done in (0..all).step_by(at_once) {
            interruption.check().map_err(|_| StopReason::Interrupted { time })?;
            let until = (done + at_once).min(all);
            let tensions = [after(done), after(until)].map(Tension::Uniform);
            self.step(until - done, time, tensions)?;
        }
        Ok(())
    }

    fn step(
        &mut self,
        steps: usize,
        time: f64,
        tensions: [Tension<'_>; 2],
    ) -> Result<(), StopReason> {
        let moved = self.stepper.advance(steps, tensions);
        moved.map_err(|cause| StopReason::BrokenOff { time, cause: cause.to_string() })
    }

    /// The present tension of each triangle.
    fn now(&self, tension: Tension<'_>) -> Held {
        let (Tension::Following(law), Some(meter)) = (tension, &self.setup.fibre_stretch) else {
            return Held::of(tension);
        };
        let Body { positions, velocities, .. } = self.stepper.body();
        let (stretch, rate) = (meter.stretches(positions), meter.rates(positions, velocities));
        Held::PerElement((0..stretch.len()).map(|e| law.at(e, stretch[e], rate[e])).collect())
    }
}

impl<const D: usize, const N: usize> Shaping for InTime<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn is_static(&self) -> bool {
        false
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let simulation = &self.setup.simulation;
        self.advance(time, tensions)?;
        let tension = self.now(tensions[1]);
        let body = self.stepper.body();
        let average = tension.average(&self.setup.volumes);
        let mesh = simulation.body_mesh();
        if let Some(reason) = self.watch.fault(mesh, &body.positions, time, average) {
            return Err(reason);
        }
        let system = &self.setup.assembly.system;
        let mean = Held::of(tensions[0]).mean(&tension);
        self.ledger.settle(system, body, [mean, tension], simulation.numerics.exchange_interval);
        Ok(())
    }

    fn mark(&mut self) {
        self.stepper.mark();
        self.marked = Some(self.ledger.clone());
    }

    fn back(&mut self) {
        self.stepper.back();
        if let Some(ledger) = &self.marked {
            self.ledger.clone_from(ledger);
        }
    }

    fn stretch_now(&self) -> Vec<f64> {
        self.setup.stretch_at(&self.stepper.body().positions)
    }
}

impl<const D: usize, const N: usize> Observable<D> for InTime<'_, D, N>
where
    Simulation: Space<D, N>,
{
    fn observe(&self) -> Observed {
        let (Setup { simulation, assembly, .. }, body) = (self.setup, self.stepper.body());
        let extent = assembly.measure(&body.positions);
        let (momentum, centre) = (body.momentum(), body.mass_centre());
        let turning = |[p, q]: [usize; 2]| {
            body.angular_momentum_in([p, q]) - (centre[p] * momentum[q] - centre[q] * momentum[p])
        };
        let angular_momentum = match D {
            2 => turning([0, 1]),
            _ => [[0, 1], [1, 2], [2, 0]].map(turning).into_iter().fold(0.0, f64::hypot),
        };
        let at = body.configuration(self.ledger.tension.tension());
        let area = assembly.area(&simulation.mesh, &body.positions);
        Observed {
            length: extent.length,
            width: extent.width,
            area,
            elastic_energy: assembly.system.elastic_energy(&at),
            kinetic_energy: body.kinetic_energy(),
            active_work: self.ledger.active_work,
            dissipated_energy: self.ledger.dissipated,
            momentum: momentum.into_iter().reduce(f64::hypot).unwrap_or_default(),
            angular_momentum,
            gauges: assembly.gauges.read_now(&assembly.system, &at, area),
        }
    }

    fn positions(&self) -> Vectors<D> {
        self.stepper.body().positions.clone()
    }
}

/// Work and dissipation added up over a run.
///
/// Dissipation by the trapezoidal rule in its power. Work of the active forces as the drop of their
/// energy at the mean tension of the interval, `W = -int grad E(x; Ta) dx`, which needs no velocity
/// and so does not miss fast vibrations between two exchanges.
#[derive(Debug, Clone)]
struct Ledger<const D: usize> {
    active_work: f64,
    dissipated: f64,
    tension: Held,
    dissipation: f64,
    /// Where the masses were, at rest.
    before: Body<D>,
}

impl<const D: usize> Ledger<D> {
    fn new(body: &Body<D>, tension: Held) -> Self {
        let mut before = body.clone();
        before.velocities.iter_mut().flatten().for_each(|v| *v = 0.0);
        Self { active_work: 0.0, dissipated: 0.0, tension, dissipation: 0.0, before }
    }

    /// Adds an interval that ends with this body, under these mean and last tensions.
    fn settle(
        &mut self,
        system: &System<D>,
        body: &Body<D>,
        [mean, tension]: [Held; 2],
        elapsed: f64,
    ) {
        let energy = |body: &Body<D>| system.active_energy(&body.configuration(mean.tension()));
        self.active_work += energy(&self.before) - energy(body);
        let dissipation = system.dissipation(&body.configuration(tension.tension()));
        self.dissipated += 0.5 * elapsed * (self.dissipation + dissipation);
        self.dissipation = dissipation;
        self.tension = tension;
        self.before.positions.clone_from(&body.positions);
    }
}
