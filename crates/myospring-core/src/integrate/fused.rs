//! Stoermer-Verlet by the fused kernel of a lattice ([`super::stencil`]).

use super::stencil::{Stencil, Units, Unsupported};
use super::stepper::{StepError, Stepper};
use super::verlet::{Integrator, Motion};
use crate::mechanics::{Body, System, Tension, Vectors};
use crate::mesh::Lattice;

/// A moving body on a lattice with a uniform tension: equal to [`Motion`] except for rounding, and
/// several times faster.
pub struct FusedMotion<'a, const D: usize = 2> {
    /// Makes the first step, which starts from velocities at the full step, and owns the body.
    plain: Motion<'a, D>,
    kernel: Stencil<D>,
    under_way: bool,
}

impl<'a, const D: usize> FusedMotion<'a, D> {
    /// A body to be moved with a fixed time step in ms, on at most `threads` threads.
    ///
    /// # Errors
    /// A force or support that the kernel does not support.
    ///
    /// # Panics
    /// If the processor lacks the vector units, see [`Units::available`].
    pub fn new(
        system: &'a System<D>,
        body: Body<D>,
        lattice: &Lattice<D>,
        time_step: f64,
        threads: usize,
        units: Units,
    ) -> Result<Self, Unsupported> {
        let kernel = Stencil::new(system, &body, lattice, time_step, threads, units)?;
        let plain = Motion::new(system, body, Integrator::StoermerVerlet, time_step);
        Ok(Self { plain, kernel, under_way: false })
    }

    /// As [`Stepper::advance`]; the numbers are uniform tensions in kPa.
    ///
    /// # Errors
    /// If a panic has interrupted this or an earlier call.
    pub fn advance(&mut self, steps: usize, tensions: [f64; 2]) -> Result<(), StepError> {
        Stepper::advance(self, steps, tensions.map(Tension::Uniform))
    }

    /// Number of threads in use.
    pub fn threads(&self) -> usize {
        self.kernel.threads()
    }

    /// Velocities at the last half step, um/ms: those used by the dashpots.
    pub fn half_velocities(&self) -> &Vectors<D> {
        self.plain.half_velocities()
    }

    /// Copies the body to the kernel.
    fn put(&mut self) {
        self.kernel.put(&self.plain.body.positions, self.plain.half_velocities());
    }

    fn step_on(&mut self, steps: usize, [start, end]: [f64; 2]) -> Result<(), StepError> {
        let (mut start, mut left) = (start, steps);
        if self.plain.steps() == 0 && steps > 0 {
            let next = start + (end - start) / steps as f64;
            self.plain.advance(1, [start, next])?;
            (start, left) = (next, steps - 1);
            self.put();
        }
        self.kernel.advance(left, [start, end])?;
        let (body, half_velocities) = self.plain.moved_by(left as u64);
        self.kernel.read_half_step(&mut body.positions, half_velocities);
        self.kernel.read_velocities(end, &mut body.velocities)
    }
}

impl<const D: usize> Stepper<D> for FusedMotion<'_, D> {
    /// # Panics
    /// If the tension is not uniform.
    fn advance(&mut self, steps: usize, tensions: [Tension<'_>; 2]) -> Result<(), StepError> {
        let [Some(start), Some(end)] = tensions.map(|tension| tension.uniform()) else {
            unreachable!("the fused kernel is not chosen for a tension that is not uniform");
        };
        if std::mem::replace(&mut self.under_way, true) {
            return Err(StepError::Poisoned);
        }
        self.step_on(steps, [start, end])?;
        self.under_way = false;
        Ok(())
    }

    fn body(&self) -> &Body<D> {
        &self.plain.body
    }

    fn time_step(&self) -> f64 {
        self.plain.time_step()
    }

    fn steps(&self) -> u64 {
        self.plain.steps()
    }

    fn mark(&mut self) {
        self.plain.mark();
    }

    fn back(&mut self) {
        self.plain.back();
        self.put();
    }
}
