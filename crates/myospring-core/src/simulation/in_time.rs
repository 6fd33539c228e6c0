//! A mesh whose masses move in time.

use super::{Observed, Setup, Shaping, Simulation, StopReason, fault, projected_area};
use crate::integrate::verlet::Motion;
use crate::mechanics::{Body, Configuration, System, Vectors, zeros};

/// Masses that move in time, by Verlet's method.
pub(super) struct InTime<'a> {
    setup: &'a Setup<'a>,
    motion: Motion<'a>,
    /// In each exchange interval.
    steps: usize,
    ledger: Ledger,
}

impl<'a> InTime<'a> {
    /// A motion of so many steps in each exchange interval.
    pub(super) fn new(setup: &'a Setup<'a>, motion: Motion<'a>, steps: usize) -> Self {
        let ledger = Ledger::new(&setup.body, setup.tension_at_start());
        Self { setup, motion, steps, ledger }
    }

    /// Mechanical steps made so far.
    pub(super) fn steps_made(&self) -> u64 {
        self.motion.steps()
    }
}

impl Shaping for InTime<'_> {
    fn follow(&mut self, time: f64, tensions: [f64; 2]) -> Result<(), StopReason> {
        let Simulation { mesh, numerics, .. } = self.setup.simulation;
        self.motion
            .advance(self.steps, tensions)
            .map_err(|cause| StopReason::BrokenOff { time, cause: cause.to_string() })?;
        let body = &self.motion.body;
        if let Some(reason) = fault(mesh, &body.positions, time, tensions[1]) {
            return Err(reason);
        }
        self.ledger.settle(&self.setup.system, body, tensions[1], numerics.exchange_interval);
        Ok(())
    }

    fn length(&self) -> f64 {
        self.setup.meter.measure(&self.motion.body.positions).length
    }

    fn observe(&self) -> Observed {
        let (Setup { simulation, system, meter, .. }, body) = (self.setup, &self.motion.body);
        let extent = meter.measure(&body.positions);
        let (momentum, centre) = (body.momentum(), body.mass_centre());
        let orbital = centre[0] * momentum[1] - centre[1] * momentum[0];
        Observed {
            length: extent.length,
            width: extent.width,
            area: projected_area(&simulation.mesh, &body.positions),
            elastic_energy: system.elastic_energy(&body.configuration(self.ledger.tension)),
            kinetic_energy: body.kinetic_energy(),
            active_work: self.ledger.active_work,
            dissipated_energy: self.ledger.dissipated,
            momentum: momentum[0].hypot(momentum[1]),
            angular_momentum: body.angular_momentum() - orbital,
        }
    }

    fn positions(&self) -> Vectors {
        self.motion.body.positions.clone()
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
    tension: f64,
    dissipation: f64,
    positions: Vectors,
    still: Vectors,
}

impl Ledger {
    fn new(body: &Body, tension: f64) -> Self {
        Self {
            active_work: 0.0,
            dissipated: 0.0,
            tension,
            dissipation: 0.0,
            positions: body.positions.clone(),
            still: zeros(body.len()),
        }
    }

    fn settle(&mut self, system: &System, body: &Body, tension: f64, elapsed: f64) {
        let mean = 0.5 * (self.tension + tension);
        let energy = |positions: &Vectors| {
            system.active_energy(&Configuration {
                positions,
                velocities: &self.still,
                tension: mean,
            })
        };
        self.active_work += energy(&self.positions) - energy(&body.positions);
        let at = body.configuration(tension);
        let dissipation = system.dissipation(&at);
        self.dissipated += 0.5 * elapsed * (self.dissipation + dissipation);
        self.dissipation = dissipation;
        self.tension = tension;
        self.positions.clone_from(&body.positions);
    }
}
