//! Exchange between physiology and mechanics.
//!
//! An [`Activation`] computes the active tension from the time and from the stretch and rate of
//! stretch along the fibre. It has one site, the whole cell, or one site per triangle:
//!
//! ```text
//! stretch and rate, per site  ->  Activation  ->  tension in kPa, per site, and its derivatives
//! ```
//!
//! `simulation` calls it in every exchange interval. If the tension does not depend on stretch, it
//! is computed first and the mesh follows. If it depends on the stretch that it causes, both are
//! solved together: the activation may be called repeatedly from the same state
//! ([`Activation::advance`]), and its [`ActivationTangent`] gives the derivatives for the solver.
//! [`WholeCell`] is one cell model for the whole cell, [`ByTriangle`] has one in each triangle, and the cells of a [`Tissue`] stimulate
//! each other.

mod by_triangle;
mod cell_course;
mod coupling;
mod crossbridges;
mod diffusion;
mod felt;
mod local_beats;
mod members;
mod tips;
mod tissue;
mod velocity;
mod whole_cell;

pub use by_triangle::ByTriangle;
pub(crate) use cell_course::CellCourse;
pub use coupling::{Coupling, StimulusPlace, StretchCurrent};
pub use diffusion::Conduction;
pub use tissue::{Tissue, TissueCells, TissueError};
pub use whole_cell::WholeCell;

use crate::cell::Output;
use crate::mechanics::Tension;
use crate::recording::{LocalBeat, WaveTip};

/// Sites of an activation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sites {
    /// One site for the whole cell; its stretch is that of the cell's length.
    Whole,
    /// One site for each of this number of triangles; its stretch is that of the triangle along the
    /// fibre.
    PerElement(usize),
}

impl Sites {
    /// Returns the number of sites.
    pub fn count(self) -> usize {
        match self {
            Self::Whole => 1,
            Self::PerElement(count) => count,
        }
    }
}

/// Stretch and rate of stretch at each site; one entry per site.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StretchState<'a> {
    /// Stretch along the fibre, length over resting length.
    pub stretch: &'a [f64],
    /// Rate of stretch, 1/ms.
    pub rate: &'a [f64],
}

/// Derivatives of the tension of each site. For triangles, one entry per site, at least 0: the
/// tension must not decrease with stretch or rate of stretch. For a single site of the whole cell
/// the lists are not read; that the value exists tells that the tension depends on stretch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ActivationTangent<'a> {
    /// Derivative of the tension at the current time with respect to stretch, kPa.
    pub per_stretch: &'a [f64],
    /// Derivative with respect to the rate of stretch, kPa ms.
    pub per_rate: &'a [f64],
}

/// Upper bounds of an activation, for which the time step of the motion must be stable.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ActivationBounds {
    /// Tension, kPa.
    pub tension: f64,
    /// Derivative with respect to the stretch, kPa.
    pub per_stretch: f64,
    /// Derivative with respect to the rate of stretch, kPa ms.
    pub per_rate: f64,
}

/// Why an activation cannot continue.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{0}")]
pub struct ActivationError(pub String);

/// Source of the active tension: a cell model, a measured curve, a wave.
///
/// It starts from the last state that was kept, at first that of 0 ms.
///
/// # Example
/// A tension that rises by 1 kPa per ms, faster in a longer cell:
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
///     fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError> {
///         self.tension = to_ms * (1.0 + 2.0 * (now.stretch[0] - 1.0));
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
    /// Returns its sites; the same at all times.
    fn sites(&self) -> Sites;

    /// Advances from the last kept state to a time (ms), with the stretch at that time and its mean
    /// rate over the interval. It may be called repeatedly from the same state.
    ///
    /// # Errors
    /// A state that is NaN, an impossible stretch, or similar.
    fn advance(&mut self, to_ms: f64, now: StretchState<'_>) -> Result<(), ActivationError>;

    /// Keeps the current state as the start of the next interval.
    fn keep(&mut self);

    /// Returns the tension of the current state, kPa; uniform, or one per triangle.
    fn tension(&self) -> Tension<'_>;

    /// Returns the derivatives of that tension; `None`, at all times, if it does not depend on
    /// stretch.
    fn tangent(&self) -> Option<ActivationTangent<'_>>;

    /// Returns upper bounds of the tension and its derivatives.
    fn strongest(&self) -> ActivationBounds;

    /// Called before the first interval if the mesh is at rest at every time: what it feels then goes smoothly, so that it
    /// may be foretold. Nothing by default.
    fn at_equilibria(&mut self) {}

    /// Returns the potential variable, dimensionless, if there is one.
    fn potential(&self) -> Option<f64> {
        None
    }

    /// Returns the membrane potential, mV, if there is one.
    fn membrane_potential_mv(&self) -> Option<f64> {
        None
    }

    /// Returns the times of stimuli, ms; beats are measured from one to the next. Empty by default.
    fn stimulus_times_ms(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the time of an extra stimulus (S2) after those of a train, ms; none by default.
    fn s2_ms(&self) -> Option<f64> {
        None
    }

    /// Returns names and units of further outputs, such as calcium; the same at all times. Empty by
    /// default.
    fn outputs(&self) -> Vec<Output> {
        Vec::new()
    }

    /// Returns the current values of [`Activation::outputs`], in their order.
    fn output_values(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Returns the beats at each node of the mesh, in order of time; `None`, at all times, if the cells do not stimulate each other.
    fn local_beats(&self) -> Option<Vec<Vec<LocalBeat>>> {
        None
    }

    /// Returns the membrane potential at each node of the mesh, mV; `None`, at all times, if it is the same everywhere or the cells have
    /// no millivolts.
    fn potentials_mv(&self) -> Option<Vec<f64>> {
        None
    }

    /// Returns where waves ended so far, in order of time; none by default.
    fn wave_tips(&self) -> &[WaveTip] {
        &[]
    }

    /// Returns a copy in the same state, for another run.
    fn boxed(&self) -> Box<dyn Activation>;
}

impl Clone for Box<dyn Activation> {
    fn clone(&self) -> Self {
        self.boxed()
    }
}
