//! The outcome of a run, and the work it took.

use super::StopReason;
use crate::analysis::beats::Beats;
use crate::analysis::wave::WaveMap;
use crate::integrate::engine::EngineUsed;
use crate::recording::Recording;
use serde::{Deserialize, Serialize};

/// The outcome of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// All that was recorded, up to the stop.
    pub recording: Recording,
    /// Why it stopped early, if it did.
    pub stop: Option<StopReason>,
    /// The work it took.
    pub effort: Effort,
    /// The engine, if the run was in time.
    pub engine: Option<EngineUsed>,
    /// Times of the stimuli that fall within the run, ms.
    pub stimulus_times_ms: Vec<f64>,
    /// The last of them where that is an extra one, S2.
    pub s2_ms: Option<f64>,
}

impl Outcome {
    /// The metrics of the beats: tension, contraction, width, area and action potential of each,
    /// the energy balance, and bands of measured cells.
    pub fn beats(&self) -> Beats {
        Beats::of(&self.recording, &self.stimulus_times_ms, self.s2_ms)
    }

    /// How the beat that represents the run spread over a tissue; `None` of a single cell.
    pub fn wave_map(&self) -> Option<WaveMap> {
        let wave = self.recording.wave.as_ref()?;
        let stimulus_ms = self.beats().usual()?.stimulus_ms;
        let next_ms = self.stimulus_times_ms.iter().copied().find(|time| *time > stimulus_ms);
        Some(WaveMap::of(wave, [stimulus_ms, next_ms.unwrap_or(f64::INFINITY)]))
    }
}

/// The work that a run took.
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
        /// Period of the slowest vibration, ms, which the numerical mass sets.
        #[serde(default)]
        slowest_period_ms: Option<f64>,
        /// By how much the shortening is off that of the equilibria at most, as estimated, % of its peak; `None` if the tension
        /// differs from place to place, or dashpots are stronger than those of the default material.
        #[serde(default)]
        lag_pct: Option<f64>,
    },
    /// In time, by a custom stepper.
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
        /// Matrices factorised: one for each iteration, including those of steps that did not
        /// converge.
        factorisations: usize,
        /// Largest estimated error of a position, um.
        interpolation_error_um: f64,
        /// Time by which a run in time with the same damping lags, ms.
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
