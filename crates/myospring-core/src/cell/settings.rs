//! Integration methods with their settings, and errors of integration.

use super::pacing::ProtocolError;
use crate::interruption::Interrupted;
use serde::{Deserialize, Serialize};
use std::fmt;

/// An integration method.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum CellMethod {
    #[serde(rename = "runge-kutta-4")]
    /// Classical Runge-Kutta, order 4 for smooth equations; fixed steps.
    RungeKutta4,
    /// Forward Euler, order 1; fixed steps.
    ForwardEuler,
    /// Forward Euler that updates first `u, v, w, s`, then `Ta_i`, then `Ta`, each with the new
    /// values of those before, order 1; fixed steps. The method of the authors of `coelho_2021`;
    /// only for the minimal model.
    StaggeredEuler,
    /// Gates by their exact solution at constant potential, the rest by forward Euler, order 1; fixed steps.
    /// For models that name their gates.
    RushLarsen,
    /// Adaptive steps that are cut at the model's switches; only for the minimal model.
    Adaptive,
    /// Implicit adaptive steps for stiff models whose equations do not jump.
    Stiff,
}

impl CellMethod {
    /// All methods.
    pub const ALL: [Self; 6] = [
        Self::RungeKutta4,
        Self::ForwardEuler,
        Self::StaggeredEuler,
        Self::RushLarsen,
        Self::Adaptive,
        Self::Stiff,
    ];

    /// Name in a run file: `runge-kutta-4`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::RungeKutta4 => "runge-kutta-4",
            Self::ForwardEuler => "forward-euler",
            Self::StaggeredEuler => "staggered-euler",
            Self::RushLarsen => "rush-larsen",
            Self::Adaptive => "adaptive",
            Self::Stiff => "stiff",
        }
    }

    /// Whether its steps are adaptive.
    pub const fn chooses_steps(self) -> bool {
        matches!(self, Self::Adaptive | Self::Stiff)
    }
}

impl fmt::Display for CellMethod {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Numerical settings of a cell; the measured error of the default is documented in
/// [`solve`](super::solve).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SolverSettings {
    /// Default: Runge-Kutta 4.
    pub method: CellMethod,
    /// Largest step of a method with fixed steps, ms; default 0.005.
    pub step_ms: f64,
    /// Largest error of an adaptive step relative to the size of each variable; default 1e-5.
    pub tolerance: f64,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self::of(CellMethod::RungeKutta4)
    }
}

impl SolverSettings {
    /// Smallest and largest tolerance: below, rounding errors dominate; above, the error estimate
    /// is meaningless.
    pub const TOLERANCES: [f64; 2] = [1e-10, 1e-2];

    /// Settings of a method with the default step and tolerance.
    pub const fn of(method: CellMethod) -> Self {
        Self { method, step_ms: 0.005, tolerance: 1e-5 }
    }

    /// Checks step and tolerance.
    ///
    /// # Errors
    /// A step that is not a positive finite time, a tolerance outside [`Self::TOLERANCES`].
    pub fn validate(&self) -> Result<(), SolveError> {
        if !(self.step_ms.is_finite() && self.step_ms > 0.0) {
            return Err(SolveError::Step { step_ms: self.step_ms });
        }
        let [minimum, maximum] = Self::TOLERANCES;
        if !(minimum..=maximum).contains(&self.tolerance) {
            return Err(SolveError::Tolerance { value: self.tolerance, minimum, maximum });
        }
        Ok(())
    }
}

/// Why a cell could not be integrated.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// It was interrupted.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The method does not suit the model.
    #[error("cell model `{model}` cannot be integrated by `{method}`, {reason}; take {instead}")]
    Unsuited {
        /// The model.
        model: String,
        /// The method.
        method: CellMethod,
        /// Why it does not.
        reason: &'static str,
        /// Methods that suit it.
        instead: &'static str,
    },
    /// The protocol is invalid.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// A step that is not positive and finite.
    #[error("cell step {step_ms} ms must be a finite time above 0 ms")]
    Step {
        /// The given value, ms.
        step_ms: f64,
    },
    /// A time that is not positive and finite.
    #[error("{name} {value} ms must be a finite time above 0 ms")]
    Time {
        /// Which time.
        name: &'static str,
        /// The given value, ms.
        value: f64,
    },
    /// A time before the present one.
    #[error("the cell is at {time_ms} ms and cannot go to {target_ms} ms")]
    BackInTime {
        /// The requested time, ms.
        target_ms: f64,
        /// The present time, ms.
        time_ms: f64,
    },
    /// An initial state that does not fit the model.
    #[error(
        "a state of `{model}` has {expected} finite numbers; {found} were given, or one is not finite"
    )]
    StartState {
        /// The model.
        model: String,
        /// Numbers given.
        found: usize,
        /// States of the model.
        expected: usize,
    },
    /// An impossible stretch.
    #[error("stretch {value} at {time_ms} ms must be a finite number above 0")]
    Stretch {
        /// The given value.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
    /// An impossible rate of stretch.
    #[error("rate of stretch {value}/ms at {time_ms} ms must be a finite number")]
    StretchRate {
        /// The given value, 1/ms.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
    /// A state variable is not finite.
    #[error(
        "state variable `{variable}` of cell model `{model}` became {value} at {time_ms} ms; \
         a cell step below {step_ms} ms or other parameters may help"
    )]
    NotFinite {
        /// The model.
        model: String,
        /// The state variable.
        variable: String,
        /// What it became.
        value: f64,
        /// Time at the end of that step, ms.
        time_ms: f64,
        /// The step, ms.
        step_ms: f64,
    },
    /// A tolerance out of range.
    #[error("tolerance {value} must be between {minimum} and {maximum}")]
    Tolerance {
        /// The given value.
        value: f64,
        /// Smallest.
        minimum: f64,
        /// Largest.
        maximum: f64,
    },
    /// The adaptive step became too small.
    #[error(
        "cell model `{model}` cannot be integrated beyond {time_ms} ms: a step of {step_ms} ms still misses \
         the tolerance, with `{variable}` = {value}; a smaller stimulus or other parameters \
         may help"
    )]
    Stalled {
        /// The model.
        model: String,
        /// The state variable that is not finite, or else the one with the largest error.
        variable: String,
        /// What it became.
        value: f64,
        /// Time reached, ms.
        time_ms: f64,
        /// The step tried, ms.
        step_ms: f64,
    },
    /// The model has no tension, and some was asked for.
    #[error(
        "cell model `{model}` has no tension, so it moves no cell; choose one with tension, such as tor_ord_land, or for a \
         model from a file the myofilaments of land_2017, which need the name of its calcium if that was not found"
    )]
    NoTension {
        /// The model.
        model: String,
    },
    /// One default beat raises no tension that peaks within the reference time.
    #[error(
        "cell model `{model}` has no peak of tension within {duration_ms} ms of one default beat: \
         highest {value} at {time_ms} ms"
    )]
    NoPeak {
        /// The model.
        model: String,
        /// Length of the reference beat, ms.
        duration_ms: f64,
        /// Highest tension.
        value: f64,
        /// Its time, ms.
        time_ms: f64,
    },
}

/// Rejects a time that is not positive and finite.
pub(super) fn validate_time(name: &'static str, value: f64) -> Result<(), SolveError> {
    if value.is_finite() && value > 0.0 {
        return Ok(());
    }
    Err(SolveError::Time { name, value })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_names_are_those_of_run_files() {
        for method in CellMethod::ALL {
            let written = serde_json::to_string(&method).unwrap();
            assert_eq!(written, format!("\"{method}\""));
            assert_eq!(serde_json::from_str::<CellMethod>(&written).unwrap(), method);
        }
    }
}
