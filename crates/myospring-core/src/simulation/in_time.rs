//! A mesh whose masses move in time.

use super::coupler::Shaping;
use super::course::{Observable, Observed};
use super::fault::{fault, projected_area};
use super::held::Held;
use super::observer::{Progress, RunObserver, Samples};
use super::outcome::{Effort, Outcome};
use super::setup::Setup;
use super::{SAFETY, SetupError, Simulation, StopReason};
use crate::exchange::Sites;
use crate::integrate::engine::{EngineUsed, Task};
use crate::integrate::stepper::Stepper;
use crate::mechanics::stability::StabilityLimit;
use crate::mechanics::{Body, System, Tension, Vectors};
use crate::recording::Recording;

/// Steps times masses between checks for an interruption: less than half a second.
const STEPS_OF_MASSES: usize = 10_000_000;

/// A prepared run in time: forces assembled, time step chosen, engine checked.
pub struct Prepared {
    pub(super) setup: Setup,
    /// The stability limit at peak tension.
    pub limit: StabilityLimit,
    /// Mechanical steps in each exchange interval.
    pub steps_per_exchange: usize,
    engine: EngineUsed,
    /// At rest under the tension before the first beat.
    start: Body,
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
        let setup = self.set_up()?;
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
            let [x, y] = self.mesh.point(node);
            let limit = limit.time_step;
            return Err(SetupError::UnstableStep { time_step, limit, node, x, y });
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

impl Prepared {
    /// The mechanical time step, ms.
    pub fn time_step(&self) -> f64 {
        self.setup.simulation.numerics.exchange_interval / self.steps_per_exchange as f64
    }

    /// The engine of the run.
    pub fn engine(&self) -> &EngineUsed {
        &self.engine
    }

    fn stepper(&self) -> Result<(Box<dyn Stepper + '_>, EngineUsed), SetupError> {
        let Setup { simulation, assembly, .. } = &self.setup;
        let (system, body) = (&assembly.system, &self.start);
        if let Some(make) = &simulation.stepper {
            return Ok((make(system, body.clone(), self.time_step()), EngineUsed::Own));
        }
        let task = Task {
            system,
            body,
            lattice: simulation.mesh.lattice.as_ref(),
            form: simulation.numerics.method.in_time(),
            time_step: self.time_step(),
            uniform_tension: self.setup.sites() == Sites::Whole,
        };
        Ok(simulation.numerics.engine.stepper(&task)?)
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
        let effort = match self.engine {
            EngineUsed::Own => Effort::OwnStepper { time_step_ms, stability_limit_ms, steps },
            _ => Effort::Verlet { time_step_ms, stability_limit_ms, steps },
        };
        let (engine, stimulus_times_ms) = (Some(self.engine.clone()), self.setup.stimulus_times());
        let s2_ms = self.setup.s2_ms();
        Outcome { recording, stop, effort, engine, stimulus_times_ms, s2_ms }
    }
}

/// Masses that move in time.
struct InTime<'a> {
    setup: &'a Setup,
    stepper: Box<dyn Stepper + 'a>,
    /// Steps in each exchange interval.
    steps: usize,
    ledger: Ledger,
    marked: Option<Ledger>,
}

impl<'a> InTime<'a> {
    /// A motion with a number of steps in each exchange interval.
    fn new(setup: &'a Setup, stepper: Box<dyn Stepper + 'a>, steps: usize) -> Self {
        let ledger = Ledger::new(stepper.body(), Held::of(setup.activation.tension()));
        Self { setup, stepper, steps, ledger, marked: None }
    }

    /// Advances by an exchange interval, in parts if it takes long, so that it can be interrupted.
    fn advance(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let Simulation { mesh, interruption, .. } = &self.setup.simulation;
        let at_once = (STEPS_OF_MASSES / mesh.len().max(1)).max(1);
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

impl Shaping for InTime<'_> {
    fn is_static(&self) -> bool {
        false
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let Simulation { mesh, numerics, .. } = &self.setup.simulation;
        self.advance(time, tensions)?;
        let tension = self.now(tensions[1]);
        let body = self.stepper.body();
        let average = tension.average(&self.setup.volumes);
        if let Some(reason) = fault(mesh, &body.positions, time, average) {
            return Err(reason);
        }
        let system = &self.setup.assembly.system;
        let mean = Held::of(tensions[0]).mean(&tension);
        self.ledger.settle(system, body, [mean, tension], numerics.exchange_interval);
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

impl Observable for InTime<'_> {
    fn observe(&self) -> Observed {
        let (Setup { simulation, assembly, .. }, body) = (self.setup, self.stepper.body());
        let extent = assembly.meter.measure(&body.positions);
        let (momentum, centre) = (body.momentum(), body.mass_centre());
        let orbital = centre[0] * momentum[1] - centre[1] * momentum[0];
        let at = body.configuration(self.ledger.tension.tension());
        Observed {
            length: extent.length,
            width: extent.width,
            area: projected_area(&simulation.mesh, &body.positions),
            elastic_energy: assembly.system.elastic_energy(&at),
            kinetic_energy: body.kinetic_energy(),
            active_work: self.ledger.active_work,
            dissipated_energy: self.ledger.dissipated,
            momentum: momentum[0].hypot(momentum[1]),
            angular_momentum: body.angular_momentum() - orbital,
            gauges: assembly.gauges.read_now(&assembly.system, &at),
        }
    }

    fn positions(&self) -> Vectors {
        self.stepper.body().positions.clone()
    }
}

/// Work and dissipation added up over a run.
///
/// Dissipation by the trapezoidal rule in its power. Work of the active forces as the drop of their
/// energy at the mean tension of the interval, `W = -int grad E(x; Ta) dx`, which needs no velocity
/// and so does not miss fast vibrations between two exchanges.
#[derive(Debug, Clone)]
struct Ledger {
    active_work: f64,
    dissipated: f64,
    tension: Held,
    dissipation: f64,
    /// Where the masses were, at rest.
    before: Body,
}

impl Ledger {
    fn new(body: &Body, tension: Held) -> Self {
        let mut before = body.clone();
        before.velocities.iter_mut().flatten().for_each(|v| *v = 0.0);
        Self { active_work: 0.0, dissipated: 0.0, tension, dissipation: 0.0, before }
    }

    /// Adds an interval that ends with this body, under these mean and last tensions.
    fn settle(&mut self, system: &System, body: &Body, [mean, tension]: [Held; 2], elapsed: f64) {
        let energy = |body: &Body| system.active_energy(&body.configuration(mean.tension()));
        self.active_work += energy(&self.before) - energy(body);
        let dissipation = system.dissipation(&body.configuration(tension.tension()));
        self.dissipated += 0.5 * elapsed * (self.dissipation + dissipation);
        self.dissipation = dissipation;
        self.tension = tension;
        self.before.positions.clone_from(&body.positions);
    }
}
