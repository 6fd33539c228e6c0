//! The trait of methods that move a body in time.

use crate::mechanics::{Body, Tension};

/// Moves a body in equal time steps: Verlet's method in one of its forms ([`super::verlet`],
/// [`super::fused`]), or a method of your own.
///
/// `simulation` calls it for each exchange interval.
pub trait Stepper<const D: usize = 2>: Send {
    /// Makes `steps` steps while the tension changes linearly from `tensions[0]` to `tensions[1]`.
    ///
    /// # Errors
    /// [`StepError::Poisoned`] if a panic, of a force or of a thread, has interrupted this or an
    /// earlier call; [`StepError::Failed`] if the method fails. The body may then be between two
    /// steps.
    fn advance(&mut self, steps: usize, tensions: [Tension<'_>; 2]) -> Result<(), StepError>;

    /// The body at present; its velocities belong to the same time as its positions.
    fn body(&self) -> &Body<D>;

    /// The time step, ms.
    fn time_step(&self) -> f64;

    /// Steps made so far.
    fn steps(&self) -> u64;

    /// Stores the present state for [`Stepper::back`].
    fn mark(&mut self);

    /// Returns to the last stored state, as if no step had been made since; does nothing without
    /// one.
    fn back(&mut self);
}

/// Why a body cannot be moved further.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A force or a thread has panicked while it moved the masses.
    #[error("a panic interrupted the motion, so the masses are between two steps")]
    Poisoned,
    /// The method has failed, with its message.
    #[error("{0}")]
    Failed(String),
}
