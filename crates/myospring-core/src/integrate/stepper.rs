//! A body on its way through time, whatever moves it.

use crate::mechanics::{Body, Tension};

/// Moves a body in equal time steps: Verlet's method in one of its forms ([`super::verlet`],
/// [`super::fused`]), or a method of your own.
///
/// `simulation` asks it to follow the tension over one exchange interval after the other.
pub trait Stepper<const D: usize = 2>: Send {
    /// Moves `steps` steps on, while the tension goes linearly from `tensions[0]` to `tensions[1]`.
    ///
    /// # Errors
    /// [`StepError::Poisoned`] if a panic, of a force or of a thread, has interrupted this or an earlier call;
    /// [`StepError::Failed`] if the method gives up. The body may then stand between two steps.
    fn advance(&mut self, steps: usize, tensions: [Tension<'_>; 2]) -> Result<(), StepError>;

    /// The body now; its velocities belong to the same time as its positions.
    fn body(&self) -> &Body<D>;

    /// The time step, ms.
    fn time_step(&self) -> f64;

    /// Steps made so far.
    fn steps(&self) -> u64;

    /// Remembers the present state for [`Stepper::back`].
    fn mark(&mut self);

    /// Goes back to the state that was remembered last, as if no step had been made since; without one,
    /// nothing happens.
    fn back(&mut self);
}

/// Why a body cannot move on.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum StepError {
    /// A force or a thread has panicked while it moved the masses.
    #[error("a panic interrupted the motion, so the masses stand between two steps")]
    Poisoned,
    /// The method has failed, and says why.
    #[error("{0}")]
    Failed(String),
}
