//! Exchange: where physiology and mechanics meet.
//!
//! An [`Activation`] turns time and what it feels of the mesh, stretch and rate of stretch along the fibre,
//! into active tension. It has one site, the whole cell, or one for each triangle:
//!
//! ```text
//! stretch and rate, per site  ->  Activation  ->  tension in kPa, per site, and how it depends on them
//! ```
//!
//! `simulation` asks it once in every exchange interval. An activation that feels nothing is asked
//! first, and the mesh follows. Where the tension depends on the stretch that it causes, both are found
//! together: the activation may be asked again and again from the same start ([`Activation::advance`]),
//! and says by its [`ActivationTangent`] where to look. [`WholeCell`] is a cell model as an activation, [`ByTriangle`] has one
//! in each triangle.

mod by_triangle;
mod crossbridges;
mod whole_cell;

pub use by_triangle::ByTriangle;
pub use whole_cell::WholeCell;

use crate::cell::Output;
use crate::mechanics::Tension;

/// Where an activation has its sites.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sites {
    /// One for the whole cell, which feels its length.
    Whole,
    /// One for each of so many triangles, which feels its triangle's fibre.
    PerElement(usize),
}

impl Sites {
    /// How many there are.
    pub fn count(self) -> usize {
        match self {
            Self::Whole => 1,
            Self::PerElement(count) => count,
        }
    }
}

/// What each site feels; as many entries as there are sites.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchState<'a> {
    /// Stretch along the fibre, length over resting length.
    pub stretch: &'a [f64],
    /// Its rate, 1/ms.
    pub rate: &'a [f64],
}

/// How the tension of each site depends on what it feels there; of one site for the whole cell only that it does,
/// the lists are not read. Of triangles as many entries as there are sites, none negative: a longer site pulls at least as strongly, and so does one that is drawn out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActivationTangent<'a> {
    /// Derivative of the tension at the time reached with respect to the stretch felt, kPa.
    pub per_stretch: &'a [f64],
    /// Derivative with respect to the rate of stretch felt, kPa ms.
    pub per_rate: &'a [f64],
}

/// The most that is to be expected of an activation: the time step of a motion must be stable under it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ActivationBounds {
    /// Tension, kPa.
    pub tension: f64,
    /// Derivative with respect to the stretch, kPa.
    pub per_stretch: f64,
    /// Derivative with respect to the rate of stretch, kPa ms.
    pub per_rate: f64,
}

/// Why an activation cannot go on.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ActivationError(pub String);

/// What makes the tension: a cell model, a measured curve, a wave.
///
/// It stands at the last state that was kept, at first that of 0 ms.
///
/// # Example
/// A tension that rises by 1 kPa in a ms, more in a longer cell:
/// ```
/// use myospring::exchange::{Activation, ActivationError, StretchState, Sites, ActivationBounds, ActivationTangent};
/// use myospring::mechanics::Tension;
///
/// #[derive(Clone)]
/// struct Ramp {
///     tension: f64,
/// }
///
/// impl Activation for Ramp {
///     fn sites(&self) -> Sites {
///         Sites::Whole
///     }
///     fn advance(&mut self, to_ms: f64, felt: StretchState<'_>) -> Result<(), ActivationError> {
///         self.tension = to_ms * (1.0 + 2.0 * (felt.stretch[0] - 1.0));
///         Ok(())
///     }
///     fn keep(&mut self) {}
///     fn tension(&self) -> Tension<'_> {
///         self.tension.into()
///     }
///     fn tangent(&self) -> Option<ActivationTangent<'_>> {
///         Some(ActivationTangent { per_stretch: &[], per_rate: &[] })
///     }
///     fn strongest(&self) -> ActivationBounds {
///         ActivationBounds { tension: 60.0, per_stretch: 120.0, per_rate: 0.0 }
///     }
///     fn boxed(&self) -> Box<dyn Activation> {
///         Box::new(self.clone())
///     }
/// }
///
/// use myospring::prelude::*;
/// let simulation = Simulation {
///     activation: Some(Box::new(Ramp { tension: 0.0 })),
///     duration: 50.0,
///     ..Simulation::new(lattice::rectangle(20, 4, 5.0)?)
/// };
/// let outcome = simulation.build()?.run(|_progress| true);
/// let end = outcome.recording.samples.last().ok_or("no sample")?;
/// assert!((end.ta_kpa - 50.0 * (1.0 - 2.0 * end.shortening_pct / 100.0)).abs() < 1e-6);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub trait Activation: Send + Sync {
    /// Where it has its sites; the same at all times.
    fn sites(&self) -> Sites;

    /// Moves from the state that was kept last to a time (ms), under what each site feels there: the stretch at
    /// that time and its mean rate on the way. It may be asked again from the same start.
    ///
    /// # Errors
    /// A state that is no longer a number, a stretch that means nothing, or the like.
    fn advance(&mut self, to_ms: f64, felt: StretchState<'_>) -> Result<(), ActivationError>;

    /// Keeps the state that it was moved to: the start of what comes next.
    fn keep(&mut self);

    /// Tension in the state that it was moved to, kPa; uniform, or one for each triangle.
    fn tension(&self) -> Tension<'_>;

    /// How that tension depends on what was felt; `None`, at all times, if it does not.
    fn tangent(&self) -> Option<ActivationTangent<'_>>;

    /// The most that is to be expected.
    fn strongest(&self) -> ActivationBounds;

    /// Called before the first interval if the mesh is at rest at every time: what it feels then goes smoothly, so that it
    /// may be foretold. Nothing by default.
    fn at_equilibria(&mut self) {}

    /// The potential variable, dimensionless, where there is one.
    fn potential(&self) -> Option<f64> {
        None
    }

    /// Membrane potential, mV, where there is one.
    fn membrane_potential_mv(&self) -> Option<f64> {
        None
    }

    /// When it is stimulated, ms: beats are measured from one to the next; nothing by default.
    fn stimulus_times_ms(&self) -> Vec<f64> {
        Vec::new()
    }

    /// When an extra stimulus, S2, comes after those of a train, ms; none by default.
    fn s2_ms(&self) -> Option<f64> {
        None
    }

    /// What it tells besides, such as calcium: name and unit, the same at all times; nothing by default.
    fn outputs(&self) -> Vec<Output> {
        Vec::new()
    }

    /// The values of [`Activation::outputs`] now, in their order.
    fn output_values(&self) -> Vec<f64> {
        Vec::new()
    }

    /// A copy in the same state, for another run from there.
    fn boxed(&self) -> Box<dyn Activation>;
}

impl Clone for Box<dyn Activation> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
