//! A run made ready by the method that its settings name.

use super::observer::{Observer, Samples};
use super::quasi_static::QuasiStaticOutcome;
use super::{Outcome, Prepared, PreparedPath, Progress, SetupError, Simulation, StopReason};
use crate::integrate::Method;
use crate::integrate::quasi_static::Tolerance;
use crate::recording::Recording;
use serde::Serialize;

/// Strengths relative to the published parameters' that need no remark.
const ORDINARY: std::ops::RangeInclusive<f64> = 0.5..=2.0;

/// A run made ready.
pub enum Ready<'a> {
    /// In time: forces assembled, time step chosen.
    InTime(Prepared<'a>),
    /// Along the path of equilibria, which is solved.
    AlongPath(PreparedPath<'a>),
}

/// What came of a run by any method.
#[derive(Debug, Clone, PartialEq)]
pub struct Finished {
    /// All that was recorded, up to the stop.
    pub recording: Recording,
    /// Why it stopped early, if it did.
    pub stop: Option<StopReason>,
    /// What it took.
    pub effort: Effort,
}

/// What a run took, for the record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(tag = "integrator", rename_all = "kebab-case")]
pub enum Effort {
    /// In time.
    Verlet {
        /// Mechanical time step, ms.
        time_step_ms: f64,
        /// Largest stable time step, ms.
        stability_limit_ms: f64,
        /// Mechanical steps made.
        steps: u64,
    },
    /// Along the path of equilibria.
    QuasiStatic {
        /// Load steps of the path.
        load_steps: usize,
        /// Iterations of Newton's method.
        newton_iterations: usize,
        /// Matrices factorised.
        factorisations: usize,
        /// Largest estimated error of a position, um.
        interpolation_error_um: f64,
        /// Time by which a motion with the same dampings lags behind, ms.
        delay_ms: f64,
    },
}

impl Effort {
    /// The mechanical time step, ms, where there is one.
    pub fn time_step(&self) -> Option<f64> {
        match *self {
            Self::Verlet { time_step_ms, .. } => Some(time_step_ms),
            Self::QuasiStatic { .. } => None,
        }
    }
}

impl Simulation {
    /// Makes the run ready by the method of its numerical settings: chooses the time step, or solves
    /// the path of equilibria.
    ///
    /// # Errors
    /// Those of [`Simulation::prepare`] or [`Simulation::prepare_quasi_static`].
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::Method;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::{Effort, Simulation};
    ///
    /// let mut simulation = Simulation::coelho_2021(lattice::rectangle(20, 4, 5.0)?);
    /// simulation.numerics.method = Method::QuasiStatic;
    /// let finished = simulation.ready()?.run(|_progress| true);
    /// assert!(matches!(finished.effort, Effort::QuasiStatic { load_steps: 2..10, .. }));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn ready(&self) -> Result<Ready<'_>, SetupError> {
        Ok(match self.numerics.method {
            Method::Verlet(_) => Ready::InTime(self.prepare()?),
            Method::QuasiStatic => {
                Ready::AlongPath(self.prepare_quasi_static(Tolerance::default())?)
            }
        })
    }
}

impl Ready<'_> {
    /// What a person should know before a long run.
    pub fn warnings(&self) -> Vec<String> {
        let (setup, plain_loops) = match self {
            Self::InTime(prepared) => (&prepared.setup, prepared.plain_loops()),
            Self::AlongPath(prepared) => (&prepared.setup, None),
        };
        let mut warnings = Vec::new();
        if let Some(hindrance) = plain_loops {
            warnings.push(format!(
                "the plain loops move the masses, several times slower than the fused kernel, which does not \
                 serve {hindrance}"
            ));
        }
        let strength = setup.strength;
        if !ORDINARY.contains(&strength) {
            warnings.push(format!(
                "the cell model's parameters make a default beat {strength:.3} times as strong as the \
                 published ones do: about {:.4} kPa; tension_scale = \"own-peak\" scales it to {} kPa",
                strength * setup.simulation.peak_tension,
                setup.simulation.peak_tension
            ));
        }
        warnings
    }

    /// Runs to the end or to the first thing that goes wrong; `observe` is called at each recorded
    /// sample and stops the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Finished {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`Ready::run`], for an observer that also hears which part of the work begins.
    pub fn run_observed(&self, observer: &mut dyn Observer) -> Finished {
        match self {
            Self::InTime(prepared) => prepared.run_observed(observer).into(),
            Self::AlongPath(prepared) => prepared.run_observed(observer).into(),
        }
    }
}

impl From<Outcome> for Finished {
    fn from(Outcome { recording, stop, time_step, steps, limit }: Outcome) -> Self {
        let effort =
            Effort::Verlet { time_step_ms: time_step, stability_limit_ms: limit.time_step, steps };
        Self { recording, stop, effort }
    }
}

impl From<QuasiStaticOutcome> for Finished {
    fn from(outcome: QuasiStaticOutcome) -> Self {
        let effort = Effort::QuasiStatic {
            load_steps: outcome.load_steps,
            newton_iterations: outcome.newton_iterations,
            factorisations: outcome.factorisations,
            interpolation_error_um: outcome.error,
            delay_ms: outcome.delay,
        };
        Self { recording: outcome.recording, stop: outcome.stop, effort }
    }
}
