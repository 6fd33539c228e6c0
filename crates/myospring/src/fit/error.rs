//! Why there is no fit.

use crate::analysis::curve::CurveError;
use crate::cell::ModelError;
use crate::cell::calcium::TraceError;
use crate::cell::solve::SolveError;
use crate::parameter::ParameterError;
use crate::settings::{MakeError, ShapeError};
use crate::simulation::SetupError;

/// Largest shortening at the peak of a beat that a cell can have, %.
pub(super) const MOST_SHORTENING_PCT: f64 = 50.0;

/// Why there is no fit.
#[derive(Debug, thiserror::Error)]
pub enum FitError {
    /// Hardly any frames.
    #[error("`{name}` has {frames} frames with a value; a fit needs 12 or more")]
    Frames {
        /// The curve.
        name: String,
        /// How many.
        frames: usize,
    },
    /// A curve without a beat.
    #[error(
        "`{name}` shows no beat; look at it with `myospring analyse`, or give the times of the stimuli"
    )]
    NoBeat {
        /// The curve.
        name: String,
    },
    /// A curve that shows no contraction.
    #[error(
        "`{name}` is a curve of {kind}; a fit needs a length, shortening or another motion (--kind says what a column is)"
    )]
    Kind {
        /// The curve.
        name: String,
        /// What it is.
        kind: String,
    },
    /// A curve without a scale.
    #[error(
        "`{name}` is in arbitrary units, so it does not say how far the cell shortens, and its own tension is not known; give a \
         length, a shortening in % (--kind, --unit), or the shortening at its peak (--peak-shortening)"
    )]
    NoHeight {
        /// The curve.
        name: String,
    },
    /// A shortening at the peak for a curve that has one.
    #[error(
        "`{name}` is not in arbitrary units, so it says itself how far the cell shortens; leave --peak-shortening out"
    )]
    HasHeight {
        /// The curve.
        name: String,
    },
    /// A shortening that no cell has.
    #[error(
        "--peak-shortening is {percent} %; it must be above 0 %, at most {MOST_SHORTENING_PCT} %"
    )]
    PeakShortening {
        /// What was given, %.
        percent: f64,
    },
    /// A tension that no cell has.
    #[error(
        "the curve asks for a tension that no cell has: {cause}; check the kind and the unit of the curve, and Young's modulus"
    )]
    NoCourse {
        /// Which.
        cause: TraceError,
    },
    /// A curve that cannot be read.
    #[error("`{name}`: {cause}")]
    Curve {
        /// Which.
        name: String,
        /// Why not.
        #[source]
        cause: CurveError,
    },
    /// A support that prevents shortening.
    #[error(
        "the ends of this cell are held, so it does not shorten, and a length cannot be fitted. Choose a support \
        that lets it shorten, such as free ends"
    )]
    DoesNotShorten,
    /// A force without anything that the cell pulls at.
    #[error(
        "`{name}` is a curve of the {}, but this cell has no support that it pulls at; choose the gel on which it was measured \
         (--support gel)",
        load.replace('_', " ")
    )]
    NoLoad {
        /// The curve.
        name: String,
        /// What it shows.
        load: &'static str,
    },
    /// An unknown that cannot be fitted.
    #[error("`{name}` cannot be fitted: {why}. What can be fitted: {known}")]
    Unknown {
        /// As it was written.
        name: String,
        /// Why not.
        why: String,
        /// Those that can.
        known: String,
    },
    /// A name to fix or to bound that is not fitted.
    #[error("`{name}` is not fitted; fitted are {sought}")]
    NotFitted {
        /// The name.
        name: String,
        /// Those that are.
        sought: String,
    },
    /// Parameters of the myofilaments that offset each other.
    #[error(
        "{names} cannot be fitted together: a curve determines at most two of them, since the third can offset the \
        others (correlation 1.00). Fix one of them; where calcium was not calibrated, fix Ca50_ref"
    )]
    TooMany {
        /// Which.
        names: String,
    },
    /// Invalid bounds.
    #[error(
        "the bounds of `{name}` are {low} to {high}; they must be above 0, in ascending order, and within what the \
        model allows, {least} to {most}"
    )]
    Bounds {
        /// Of which unknown.
        name: String,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
        /// The least that there is.
        least: f64,
        /// The most that there is.
        most: f64,
    },
    /// A setting of the run that a fit cannot use.
    #[error("{what}: {why}")]
    Setting {
        /// Which.
        what: &'static str,
        /// Why not.
        why: &'static str,
    },
    /// No start gave a curve.
    #[error("none of {starts} starts gave a curve: {why}")]
    Nowhere {
        /// How many there were.
        starts: usize,
        /// Of the last one.
        why: String,
    },
    /// A shape that cannot be meshed.
    #[error(transparent)]
    Shape(#[from] ShapeError),
    /// A run that gives no simulation.
    #[error(transparent)]
    Make(#[from] MakeError),
    /// The mesh has no equilibria.
    #[error(transparent)]
    Setup(#[from] SetupError),
    /// The cell cannot be solved.
    #[error(transparent)]
    Cell(#[from] SolveError),
    /// A model that contradicts itself.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A parameter out of bounds.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
}
