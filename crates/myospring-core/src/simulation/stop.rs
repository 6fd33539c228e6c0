//! Why a run cannot start, and why it stops before its end: with the time and the place.

use super::check::SettingError;
use crate::integrate::engine::EngineError;
use crate::integrate::quasi_static::PathError;
use crate::interruption::Interrupted;
use crate::mesh::Place;
use serde::{Deserialize, Serialize};

/// Why a run cannot start.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SetupError {
    /// An invalid setting.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// The engine cannot move this mesh.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// The time step is unstable.
    #[error(
        "time step {time_step} ms exceeds the stability limit {limit:.4} ms of this mesh (stiffest node \
         {node} at {place}); use a smaller step, or none for the default"
    )]
    UnstableStep {
        /// The requested time step, ms.
        time_step: f64,
        /// The limit, ms.
        limit: f64,
        /// The node that moves most in the fastest vibration.
        node: usize,
        /// Where it rests.
        place: Place,
    },
    /// There is no path of equilibria.
    #[error("no quasi-static run: {0}")]
    NoPath(PathError),
    /// The preparation was asked to end early.
    #[error("the preparation of the run was interrupted")]
    Interrupted,
    /// The cell model cannot start, or has no tension to scale.
    #[error("the cell model `{model}` cannot be run: {cause}")]
    CellModel {
        /// The model.
        model: String,
        /// What went wrong.
        cause: String,
    },
}

impl From<PathError> for SetupError {
    fn from(error: PathError) -> Self {
        match error {
            PathError::Interrupted => Self::Interrupted,
            error => Self::NoPath(error),
        }
    }
}

impl From<Interrupted> for SetupError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// Why a run stopped before its end.
#[derive(Debug, Clone, PartialEq, thiserror::Error, Serialize, Deserialize)]
#[serde(tag = "reason", rename_all = "snake_case")]
pub enum StopReason {
    /// A position is not a number.
    #[error(
        "the position of node {node} is not a number at t = {time} ms (it rests at {place}); lower the tension or the area modulus, or take a smaller time step"
    )]
    NotFinite {
        /// Time, ms.
        time: f64,
        /// The node.
        node: usize,
        /// Where it rests.
        #[serde(flatten)]
        place: Place,
    },
    /// A triangle turned inside out.
    #[error(
        "{} {triangle} is inverted at t = {time} ms under {tension:.1} kPa, near {place}: the forces are too strong for this lattice; lower the tension or the area modulus, \
         or raise Young's modulus",
        if place.z.is_some() { "tetrahedron" } else { "triangle" }
    )]
    Inverted {
        /// Time, ms.
        time: f64,
        /// Active tension, kPa.
        tension: f64,
        /// The triangle; in a thick cell, the tetrahedron.
        triangle: usize,
        /// Where it is.
        #[serde(flatten)]
        place: Place,
    },
    /// Two ends of a spring met.
    #[error(
        "spring {spring} has no length at t = {time} ms under {tension:.1} kPa, at {place}: the forces are too strong for this lattice; lower the tension or the area modulus, \
         or raise Young's modulus"
    )]
    ZeroLength {
        /// Time, ms.
        time: f64,
        /// Active tension, kPa.
        tension: f64,
        /// The spring.
        spring: usize,
        /// Where it is.
        #[serde(flatten)]
        place: Place,
    },
    /// The path of equilibria ends before this tension.
    #[error("the tension reaches {tension:.4} kPa at t = {time} ms, but {cause}")]
    NoEquilibrium {
        /// Time, ms.
        time: f64,
        /// Active tension, kPa.
        tension: f64,
        /// Where and why the path ends.
        cause: String,
    },
    /// The coupled solution of tension and stretch did not converge.
    #[error(
        "at t = {time} ms no tension near {tension:.4} kPa agrees with the stretch that it causes (it misses by \
         {miss:.1e}); take a shorter exchange interval, or a tension that depends less steeply on stretch \
         and rate"
    )]
    NoExchange {
        /// Time, ms.
        time: f64,
        /// The last trial tension, kPa.
        tension: f64,
        /// The residual at it: kPa, or change of a stretch.
        miss: f64,
    },
    /// The cell model failed.
    #[error("the cell model failed: {cause}")]
    CellModel {
        /// What went wrong, with time and state variable.
        cause: String,
    },
    /// A part of the program panicked while the masses moved.
    #[error("the motion of the masses broke off before t = {time} ms: {cause}")]
    BrokenOff {
        /// Time, ms.
        time: f64,
        /// What happened.
        cause: String,
    },
    /// The caller asked the run to stop.
    #[error("stopped by the user at t = {time} ms")]
    Interrupted {
        /// Time, ms.
        time: f64,
    },
}

impl StopReason {
    /// The time of the stop, ms; `None` for a cell model that failed, whose message has the time.
    pub fn time_ms(&self) -> Option<f64> {
        match *self {
            Self::NotFinite { time, .. }
            | Self::Inverted { time, .. }
            | Self::ZeroLength { time, .. }
            | Self::NoEquilibrium { time, .. }
            | Self::NoExchange { time, .. }
            | Self::BrokenOff { time, .. }
            | Self::Interrupted { time } => Some(time),
            Self::CellModel { .. } => None,
        }
    }
}
