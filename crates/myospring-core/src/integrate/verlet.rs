//! Verlet's method in its two forms.
//!
//! Stoermer-Verlet, `coelho_2021`, Eq. (16), with the velocity of Eq. (17) in the drag:
//!
//! ```text
//! x_{n+1} = [2 x_n - (1 - g) x_{n-1} + dt^2 f_n/m] / (1 + g)              g = gamma dt/2
//! ```
//!
//! Velocity Verlet with the drag explicit in the first half-kick and implicit in the last:
//!
//! ```text
//! v_{n+1/2} = v_n + dt/2 (f_n/m - gamma v_n)
//! x_{n+1}   = x_n + dt v_{n+1/2}
//! v_{n+1}   = (v_{n+1/2} + dt/2 f_{n+1}/m) / (1 + g)
//! ```
//!
//! They are the same method: equal positions to rounding, of order 2 with and without drag. Dashpots
//! see the half-step velocity `(x_{n+1} - x_n)/dt`, the last one known when `f_{n+1}` is computed.
//! One force evaluation a step; the first half-kick uses the force at the start.

use crate::mechanics::stencil::{Poisoned, Stencil, Units};
use crate::mechanics::{Body, Configuration, System, Vectors, zeros};
use crate::mesh::Lattice;
use serde::Serialize;

/// Which form of Verlet's method moves the masses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Integrator {
    /// Stoermer-Verlet, the paper's Eq. (16): positions of two times, no velocities.
    StoermerVerlet,
    /// Velocity Verlet with implicit drag in the last half-kick: the same positions to rounding.
    VelocityVerlet,
}

impl Integrator {
    /// All integrators.
    pub const ALL: [Self; 2] = [Self::StoermerVerlet, Self::VelocityVerlet];
}

/// A body in motion under a system of forces.
pub struct Motion<'a> {
    system: &'a System,
    integrator: Integrator,
    /// The body; its velocities belong to the same time as its positions.
    pub body: Body,
    time_step: f64,
    /// 1/m of each mass: a division in the hot loop costs more than the rest of it.
    inverse_masses: Vec<f64>,
    forces: Vectors,
    /// Velocities at the last half step; at the start those of the body.
    half_velocities: Vectors,
    /// Positions one step before, for Stoermer-Verlet.
    previous: Vectors,
    /// Steps made so far.
    steps: u64,
    kernel: Option<Stencil>,
    /// Whether [`Motion::advance`] has begun and not come to its end.
    under_way: bool,
}

impl<'a> Motion<'a> {
    /// A body about to move with a fixed time step in ms, no larger than the stability limit
    /// ([`crate::mechanics::stability::StabilityLimit`]).
    pub fn new(system: &'a System, body: Body, integrator: Integrator, time_step: f64) -> Self {
        let count = body.len();
        let half_velocities = body.velocities.clone();
        let previous = body.positions.clone();
        let inverse_masses = body.masses.iter().map(|mass| 1.0 / mass).collect();
        Self {
            system,
            integrator,
            body,
            time_step,
            inverse_masses,
            forces: zeros(count),
            half_velocities,
            previous,
            steps: 0,
            kernel: None,
            under_way: false,
        }
    }

    /// Lets the fused kernel ([`crate::mechanics::stencil`]) make the steps on at most so many threads,
    /// if it knows all forces; otherwise the motion stays with the sum of the forces, which gives the
    /// same to rounding. From the first step on the body is only to be read.
    #[must_use]
    pub fn on_lattice(self, lattice: &Lattice, threads: usize) -> Self {
        self.on_lattice_with(lattice, threads, Units::best())
    }

    /// As [`Motion::on_lattice`], with vector units of one's choice.
    #[must_use]
    pub fn on_lattice_with(mut self, lattice: &Lattice, threads: usize, units: Units) -> Self {
        self.kernel =
            Stencil::new(self.system, &self.body, lattice, self.time_step, threads, units);
        self
    }

    /// Whether the fused kernel makes the steps.
    pub fn is_fused(&self) -> bool {
        self.kernel.is_some()
    }

    /// The time step, ms.
    pub fn time_step(&self) -> f64 {
        self.time_step
    }

    /// Velocities at the last half step, um/ms: those that the dashpots have seen.
    pub fn half_velocities(&self) -> &Vectors {
        &self.half_velocities
    }

    /// Steps made so far.
    pub fn steps(&self) -> u64 {
        self.steps
    }

    /// Moves `steps` steps on, while the tension (kPa) goes linearly from `tensions[0]` to
    /// `tensions[1]`.
    ///
    /// # Errors
    /// If a panic, of a force or of a thread, has interrupted this or an earlier call: the body then
    /// stands between two steps.
    pub fn advance(&mut self, steps: usize, tensions: [f64; 2]) -> Result<(), Poisoned> {
        if std::mem::replace(&mut self.under_way, true) {
            return Err(Poisoned);
        }
        if self.kernel.is_some() {
            self.advance_fused(steps, tensions)?;
        } else {
            self.advance_plainly(steps, tensions);
        }
        self.under_way = false;
        Ok(())
    }

    fn advance_fused(&mut self, steps: usize, tensions: [f64; 2]) -> Result<(), Poisoned> {
        let mut start = tensions[0];
        let mut steps_left = steps;
        if self.steps == 0 && steps > 0 {
            // The first step of all starts from velocities at the full step.
            start += (tensions[1] - tensions[0]) / steps as f64;
            self.advance_plainly(1, [tensions[0], start]);
            steps_left -= 1;
            if let Some(kernel) = &mut self.kernel {
                kernel.put(&self.body.positions, &self.half_velocities);
            }
        }
        if let Some(kernel) = &mut self.kernel {
            kernel.advance(steps_left, [start, tensions[1]])?;
            let body = &mut self.body;
            kernel.read_half_step(&mut body.positions, &mut self.half_velocities);
            kernel.read_velocities(tensions[1], &mut body.velocities)?;
            self.steps += steps_left as u64;
        }
        Ok(())
    }

    fn advance_plainly(&mut self, steps: usize, tensions: [f64; 2]) {
        if self.steps == 0 {
            self.evaluate(tensions[0]);
        }
        for step in 1..=steps {
            let part = step as f64 / steps as f64;
            let tension = tensions[0] + (tensions[1] - tensions[0]) * part;
            match self.integrator {
                Integrator::VelocityVerlet => self.velocity_verlet_step(tension),
                Integrator::StoermerVerlet => self.stoermer_verlet_step(tension),
            }
            self.steps += 1;
        }
        if self.integrator == Integrator::StoermerVerlet {
            // Eq. (17) without waiting for the next step: put Eq. (16) for x_{n+1} into it.
            self.last_half_kick();
        }
    }

    /// Forces at the present positions, dashpots at the half-step velocities.
    fn evaluate(&mut self, tension: f64) {
        let at = Configuration {
            positions: &self.body.positions,
            velocities: &self.half_velocities,
            tension,
        };
        self.system.sum_forces(&at, &mut self.forces);
        self.system.constrain(&self.body.positions, &self.body.masses, &mut self.forces);
    }

    fn velocity_verlet_step(&mut self, tension: f64) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let inverse_masses = &self.inverse_masses;
        for axis in 0..2 {
            let force = &self.forces[axis];
            let half = &mut self.half_velocities[axis];
            let velocity = &self.body.velocities[axis];
            let position = &mut self.body.positions[axis];
            for i in 0..inverse_masses.len() {
                half[i] =
                    velocity[i] + 0.5 * dt * force[i] * inverse_masses[i] - half_drag * velocity[i];
                position[i] += dt * half[i];
            }
        }
        self.evaluate(tension);
        self.last_half_kick();
    }

    /// v_{n+1} = (v_{n+1/2} + dt/2 f_{n+1}/m) / (1 + g)
    fn last_half_kick(&mut self) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let slowing = 1.0 / (1.0 + half_drag);
        let inverse_masses = &self.inverse_masses;
        for axis in 0..2 {
            let (force, half) = (&self.forces[axis], &self.half_velocities[axis]);
            let velocity = &mut self.body.velocities[axis];
            for i in 0..inverse_masses.len() {
                velocity[i] = (half[i] + 0.5 * dt * force[i] * inverse_masses[i]) * slowing;
            }
        }
    }

    fn stoermer_verlet_step(&mut self, tension: f64) {
        let (dt, half_drag) = (self.time_step, 0.5 * self.time_step * self.system.drag.rate);
        let inverse_masses = &self.inverse_masses;
        let (slowing, per_step) = (1.0 / (1.0 + half_drag), 1.0 / dt);
        let first = self.steps == 0;
        for axis in 0..2 {
            let force = &self.forces[axis];
            let half = &mut self.half_velocities[axis];
            let (position, previous) = (&mut self.body.positions[axis], &mut self.previous[axis]);
            let velocity = &self.body.velocities[axis];
            for i in 0..inverse_masses.len() {
                let now = position[i];
                let kick = dt * dt * force[i] * inverse_masses[i];
                let next = if first {
                    // Taylor's series, Eq. (14), since there is no step before the first.
                    now + dt * (1.0 - half_drag) * velocity[i] + 0.5 * kick
                } else {
                    // Eq. (16), ordered so that a mass under no force stays put to the last bit
                    now + ((1.0 - half_drag) * (now - previous[i]) + kick) * slowing
                };
                half[i] = (next - now) * per_step;
                previous[i] = now;
                position[i] = next;
            }
        }
        self.evaluate(tension);
    }
}
