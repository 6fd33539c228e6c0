//! The cell of the paper: `coelho_2021`.
//!
//! # Numbers, and how far the default settings are from them
//! One beat, u jumps by 0.325 at 50 ms exactly, `u_peak` = 1.1341 (shipped: 1.13407, which raises
//! tension by 0.09 % and changes nothing else). Converged: an independent program with Runge-Kutta
//! 4 and 0.0002 ms. Levels of the action potential are fractions of its peak, APD counts from 50
//! ms, tension rises and falls are fractions of its peak.
//!
//! | | converged | default, 0.005 ms | authors, 0.05 ms |
//! |---|---|---|---|
//! | u max, at | 1.13407, 51.989 ms | 1.13405, 51.99 ms | 1.13521, 51.90 ms |
//! | APD90 / 50 / 30, ms | 273.671 / 245.009 / 201.268 | 273.676 / 245.015 / 201.276 | 273.75 / 245.00 / 201.05 |
//! | Ta max, at | 0.90095, 171.560 ms | 0.90112, 171.563 ms | 0.8692, 171.75 ms |
//!
//! Peak of Ta by step of Runge-Kutta 4, against converged: 0.02 ms +0.040 %, 0.01 ms +0.051 %,
//! 0.005 ms +0.019 %, 0.0025 ms +0.009 %, 0.001 ms +0.003 %: order 1, because the equations jump at
//! thresholds and rest is a sliding mode (module [`minimal`]).
//!
//! # The authors' column
//! [`authors_model`], [`authors_protocol`] and [`authors_step`] give the authors' run, to every digit
//! of the 20 numbers in the test `cell_coelho_2021`. They sample on the 0.05 ms grid: an
//! action potential ends at the last sample at or above the level, tension rises or falls at the
//! first sample past it. Their stimulus falls one step before 50 ms; V is u over the highest u of the
//! whole run, which needs the future. Both shift times and tension a little against ours.

use super::minimal::{self, Identity, MinimalModel};
use super::pacing::{Protocol, Stimulus};
use super::settings::{CellMethod, SolverSettings};
use super::tension;
use crate::parameter::ParameterSet;

/// Name, papers, stimulus and peak of tension.
pub const IDENTITY: Identity = Identity {
    name: "coelho_2021",
    description: "Human ventricular myocyte with active tension, as in Coelho et al. 2021",
    citations: &["coelho_2021", "bueno_orovio_2008", "silva_2020"],
    stimulus: Stimulus::Jump { amplitude: 0.325 },
    millivolts: None,
    peak_tension: 0.901_736_458,
    in_authors_program: Some([AUTHORS_PEAK, AUTHORS_START_MS]),
    pace: (16.6, "The paper's tension curve rises faster than measured cells"),
};

/// Name, value, and the place where the value is printed.
const TABLE: [(&str, f64, &str); 28] = [
    ("u_o", 0.529297, "coelho_2021, Table 1"),
    ("u_u", 1.74316, "coelho_2021, the first author's public source code (missing in Table 1)"),
    ("theta_v", 0.0673828, "coelho_2021, Table 1"),
    ("theta_w", 0.00195313, "coelho_2021, Table 1"),
    ("theta_v_minus", 0.0976563, "coelho_2021, Table 1"),
    ("theta_o", 0.932618, "coelho_2021, Table 1"),
    ("tau_v1_minus", 57.7148, "coelho_2021, Table 1"),
    ("tau_v2_minus", 1101.56, "coelho_2021, Table 1 under tau_v^+"),
    ("tau_v_plus", 1.96973, "coelho_2021, Table 1 under tau_w1^-"),
    ("tau_w1_minus", 62.9688, "coelho_2021, Table 1 under tau_w2^-"),
    (
        "tau_w2_minus",
        13.9648,
        "coelho_2021, the first author's public source code (missing in Table 1)",
    ),
    ("k_w_minus", 58.0469, "coelho_2021, Table 1 under u_w^-"),
    ("u_w_minus", 0.59668, "coelho_2021, Table 1 under tau_w^+"),
    ("tau_w_plus", 273.633, "coelho_2021, Table 1 under tau_fi"),
    ("tau_fi", 0.644532, "coelho_2021, Table 1 under tau_o1"),
    ("tau_o1", 477.344, "coelho_2021, Table 1 under tau_o2"),
    ("tau_o2", 14.1992, "coelho_2021, Table 1 under tau_so1"),
    ("tau_so1", 25.4492, "coelho_2021, Table 1 under tau_so2"),
    ("tau_so2", 0.253711, "coelho_2021, Table 1 under k_so"),
    ("k_so", 2.49609, "coelho_2021, the first author's public source code (missing in Table 1)"),
    ("u_so", 0.657227, "coelho_2021, the first author's public source code (missing in Table 1)"),
    ("tau_s1", 2.36621, "coelho_2021, Table 1"),
    ("tau_s2", 11.4453, "coelho_2021, Table 1"),
    ("k_s", 2.25586, "coelho_2021, Table 1"),
    ("u_s", 0.903321, "coelho_2021, Table 1"),
    ("tau_si", 1.76816, "coelho_2021, Table 1"),
    ("tau_winf", 0.785157, "coelho_2021, Table 1"),
    ("w_inf_star", 0.500977, "coelho_2021, Table 1"),
];

/// All 35 parameters; the source of each names its place in the paper.
pub fn parameters() -> ParameterSet {
    let mut rows = minimal::rows(&TABLE);
    rows.extend(tension::rows(0.0, 1.13407, "converged peak of u of one default beat"));
    ParameterSet::new(rows)
}

/// The model with these parameters.
///
/// # Example
/// ```
/// use myospring::cell::coelho_2021;
/// use myospring::cell::solve::{SolverSettings, reference_beat};
/// let beat = reference_beat(&coelho_2021::model(), SolverSettings::default())?;
/// assert!((beat.peak_time_ms - 171.56).abs() < 0.1); // "around 170 ms"
/// # Ok::<(), myospring::cell::solve::SolveError>(())
/// ```
pub fn model() -> MinimalModel {
    MinimalModel::published(IDENTITY, parameters())
}

/// The authors' time stepping: staggered forward Euler with 0.05 ms.
///
/// First `u, v, w, s` from their old values, then `Ta_i` from the new `u`, then `Ta` from the new
/// `u` and `Ta_i`. This step is not converged for the tension: its peak is 3.6 % low and its onset
/// 20 ms late.
pub const fn authors_step() -> SolverSettings {
    SolverSettings { step_ms: 0.05, ..SolverSettings::of(CellMethod::StaggeredEuler) }
}

/// The authors' stimulus falls before the step that ends at 50 ms.
const AUTHORS_START_MS: f64 = 49.95;
/// Highest `u` of the authors' own run.
const AUTHORS_PEAK: f64 = 1.135211;

/// The authors' stimulus, at 49.95 ms.
pub const fn authors_protocol() -> Protocol {
    Protocol { start_ms: AUTHORS_START_MS, ..Protocol::once(IDENTITY.stimulus) }
}

/// The model with `V` normalised by the highest `u` of the authors' own run, as they do.
pub fn authors_model() -> MinimalModel {
    let mut rows = minimal::rows(&TABLE);
    rows.extend(tension::rows(0.0, AUTHORS_PEAK, "highest u of a run with the authors' step"));
    MinimalModel::published(IDENTITY, ParameterSet::new(rows))
}
