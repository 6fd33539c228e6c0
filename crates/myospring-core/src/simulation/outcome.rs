//! What came of a run, and what it took.

use super::StopReason;
use crate::analysis::beat::Beats;
use crate::integrate::engine::EngineUsed;
use crate::recording::Recording;
use serde::{Deserialize, Serialize};

/// What came of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// All that was recorded, up to the stop.
    pub recording: Recording,
    /// Why it stopped early, if it did.
    pub stop: Option<StopReason>,
    /// What it took.
    pub effort: Effort,
    /// What moved the masses, if they were moved in time.
    pub engine: Option<EngineUsed>,
    /// Times of the stimuli that fall within the run, ms.
    pub stimulus_times_ms: Vec<f64>,
    /// The last of them where that is an extra one, S2.
    pub s2_ms: Option<f64>,
}

impl Outcome {
    /// What the beats amount to: tension, contraction, width and area, action potential of each, where the
    /// energy went, and the bands of what is known.
    pub fn beats(&self) -> Beats {
        Beats::of(&self.recording, &self.stimulus_times_ms, self.s2_ms)
    }
}

/// What a run took, for the record.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
    /// In time, by a stepper from outside.
    OwnStepper {
        /// Mechanical time step, ms.
        time_step_ms: f64,
        /// Largest time step with which Verlet's method is stable, ms.
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
        /// Matrices factorised: one for each iteration, those of steps that found no rest included.
        factorisations: usize,
        /// Largest estimated error of a position, um.
        interpolation_error_um: f64,
        /// Time by which a motion with the same dampings lags behind, ms.
        delay_ms: f64,
    },
    /// From equilibrium to equilibrium.
    #[serde(rename = "quasi-static-field")]
    Field {
        /// Equilibria that were solved.
        equilibria: usize,
        /// Iterations of Newton's method.
        newton_iterations: usize,
        /// Matrices factorised.
        factorisations: usize,
    },
}

impl Effort {
    /// The mechanical time step, ms, where there is one.
    pub fn time_step(&self) -> Option<f64> {
        match *self {
            Self::Verlet { time_step_ms, .. } | Self::OwnStepper { time_step_ms, .. } => {
                Some(time_step_ms)
            }
            Self::QuasiStatic { .. } | Self::Field { .. } => None,
        }
    }
}
