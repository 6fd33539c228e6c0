//! Methods in time with their settings, and what can go wrong on the way.

use super::pacing::ProtocolError;
use crate::interruption::Interrupted;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A method in time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    #[serde(rename = "runge-kutta-4")]
    /// Classical Runge-Kutta, order 4 where the equations are smooth; fixed steps.
    RungeKutta4,
    /// Forward Euler, order 1; fixed steps.
    ForwardEuler,
    /// Forward Euler that updates first `u, v, w, s`, then `Ta_i`, then `Ta`, each with the new values of
    /// those before, order 1; fixed steps. The authors of `coelho_2021` step so; for the minimal model only.
    StaggeredEuler,
    /// Gates by their exact solution at constant potential, the rest by forward Euler, order 1; fixed steps.
    /// For models that name their gates.
    RushLarsen,
    /// Steps as long as the accuracy allows, cut at the model's switches; for the minimal model only.
    Adaptive,
    /// Implicit steps as long as the accuracy allows, for models whose equations do not jump; made for stiff
    /// ones.
    Stiff,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::RungeKutta4,
        Self::ForwardEuler,
        Self::StaggeredEuler,
        Self::RushLarsen,
        Self::Adaptive,
        Self::Stiff,
    ];

    /// Name as chosen in a run file: `runge-kutta-4`.
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

    /// Whether it chooses its steps by the tolerance.
    pub const fn chooses_steps(self) -> bool {
        matches!(self, Self::Adaptive | Self::Stiff)
    }
}

impl fmt::Display for Method {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// Numerical settings of a cell; the measured error of the default is in the head of
/// [`solve`](super::solve).
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Settings {
    /// Default: Runge-Kutta 4.
    pub method: Method,
    /// Largest step of a method with fixed steps, ms; default 0.005.
    pub step_ms: f64,
    /// Largest error of a step over the size of each variable, for a method that chooses its steps;
    /// default 1e-5.
    pub tolerance: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self::of(Method::RungeKutta4)
    }
}

impl Settings {
    /// Smallest and largest tolerance: below, rounding counts; above, the estimate means nothing.
    pub const TOLERANCES: [f64; 2] = [1e-10, 1e-2];

    /// A method with the default step and tolerance.
    pub const fn of(method: Method) -> Self {
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

/// Why a cell could not be moved in time.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// It was asked to end early.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The method is not made for the model.
    #[error("cell model `{model}` cannot be integrated by `{method}`, {reason}; take {instead}")]
    Unsuited {
        /// The model.
        model: String,
        /// The method.
        method: Method,
        /// What the method is made for.
        reason: &'static str,
        /// Methods that serve it.
        instead: &'static str,
    },
    /// The protocol cannot be followed.
    #[error(transparent)]
    Protocol(#[from] ProtocolError),
    /// No positive finite step.
    #[error("cell step {step_ms} ms must be a finite time above 0 ms")]
    Step {
        /// What was given, ms.
        step_ms: f64,
    },
    /// No positive finite time.
    #[error("{name} {value} ms must be a finite time above 0 ms")]
    Time {
        /// Which time.
        name: &'static str,
        /// What was given, ms.
        value: f64,
    },
    /// Time runs forward.
    #[error("the cell is at {time_ms} ms and cannot go to {target_ms} ms")]
    BackInTime {
        /// Where it was to go, ms.
        target_ms: f64,
        /// Where it is, ms.
        time_ms: f64,
    },
    /// A state to start in that is none of the model.
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
    /// No possible stretch.
    #[error("stretch {value} at {time_ms} ms must be a finite number above 0")]
    Stretch {
        /// What was given.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
    /// No possible rate of stretch.
    #[error("rate of stretch {value}/ms at {time_ms} ms must be a finite number")]
    StretchRate {
        /// What was given, 1/ms.
        value: f64,
        /// When, ms.
        time_ms: f64,
    },
    /// The solution left the numbers.
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
        /// At the end of which step, ms.
        time_ms: f64,
        /// The step, ms.
        step_ms: f64,
    },
    /// No possible tolerance.
    #[error("tolerance {value} must be between {minimum} and {maximum}")]
    Tolerance {
        /// What was given.
        value: f64,
        /// Smallest.
        minimum: f64,
        /// Largest.
        maximum: f64,
    },
    /// Adaptive steps no longer get on.
    #[error(
        "cell model `{model}` does not get beyond {time_ms} ms: a step of {step_ms} ms still misses \
         the tolerance, and takes `{variable}` to {value}; a smaller stimulus or other parameters \
         may help"
    )]
    Stalled {
        /// The model.
        model: String,
        /// The state variable that is no longer finite, or the first.
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
        "cell model `{model}` has no tension, so it moves no cell; take one that has, like tor_ord_land"
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
        /// When, ms.
        time_ms: f64,
    },
}

/// Refuses what is not a positive finite time.
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
        for method in Method::ALL {
            let written = serde_json::to_string(&method).unwrap();
            assert_eq!(written, format!("\"{method}\""));
            assert_eq!(serde_json::from_str::<Method>(&written).unwrap(), method);
        }
    }
}
