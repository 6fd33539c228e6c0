//! The five published sets of the minimal ventricular model: `bueno_orovio_2008`, Table 1.
//!
//! The original has no tension; here each set drives the tension of `coelho_2021`, whose `u_peak`
//! is the highest `u` of a paced beat of that set. Membrane potential: `V_mV = 85.7 u - 84`.

use super::minimal::{self, Identity, MinimalModel};
use super::pacing::Stimulus;
use super::tension;
use crate::parameter::ParameterSet;

/// Which of the five sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Epicardial cell.
    Epi,
    /// Endocardial cell.
    Endo,
    /// Midmyocardial cell.
    M,
    /// Fitted to the model of Priebe and Beuckelmann.
    Pb,
    /// Fitted to the model of ten Tusscher, Noble, Noble and Panfilov.
    Tnnp,
}

/// Columns: epi, endo, m, pb, tnnp.
const TABLE: [(&str, [f64; 5]); 28] = [
    ("u_o", [0.0; 5]),
    ("u_u", [1.55, 1.56, 1.61, 1.45, 1.58]),
    ("theta_v", [0.3, 0.3, 0.3, 0.35, 0.3]),
    ("theta_w", [0.13, 0.13, 0.13, 0.13, 0.015]),
    ("theta_v_minus", [0.006, 0.2, 0.1, 0.175, 0.015]),
    ("theta_o", [0.006, 0.006, 0.005, 0.006, 0.006]),
    ("tau_v1_minus", [60.0, 75.0, 80.0, 10.0, 60.0]),
    ("tau_v2_minus", [1150.0, 10.0, 1.4506, 1150.0, 1150.0]),
    ("tau_v_plus", [1.4506; 5]),
    ("tau_w1_minus", [60.0, 6.0, 70.0, 140.0, 70.0]),
    ("tau_w2_minus", [15.0, 140.0, 8.0, 6.25, 20.0]),
    ("k_w_minus", [65.0, 200.0, 200.0, 65.0, 65.0]),
    ("u_w_minus", [0.03, 0.016, 0.016, 0.015, 0.03]),
    ("tau_w_plus", [200.0, 280.0, 280.0, 326.0, 280.0]),
    ("tau_fi", [0.11, 0.1, 0.078, 0.105, 0.11]),
    ("tau_o1", [400.0, 470.0, 410.0, 400.0, 6.0]),
    ("tau_o2", [6.0, 6.0, 7.0, 6.0, 6.0]),
    ("tau_so1", [30.0181, 40.0, 91.0, 30.0181, 43.0]),
    ("tau_so2", [0.9957, 1.2, 0.8, 0.9957, 0.2]),
    ("k_so", [2.0458, 2.0, 2.1, 2.0458, 2.0]),
    ("u_so", [0.65, 0.65, 0.6, 0.65, 0.65]),
    ("tau_s1", [2.7342; 5]),
    ("tau_s2", [16.0, 2.0, 4.0, 16.0, 3.0]),
    ("k_s", [2.0994; 5]),
    ("u_s", [0.9087; 5]),
    ("tau_si", [1.8875, 2.9013, 3.3849, 1.8875, 2.8723]),
    ("tau_winf", [0.07, 0.0273, 0.01, 0.175, 0.07]),
    ("w_inf_star", [0.94, 0.78, 0.5, 0.9, 0.94]),
];

/// Highest `u` of a beat, in the same order.
const U_PEAK: [f64; 5] = [1.464, 1.506, 1.552, 1.370, 1.487];

/// Peak of `Ta` of one default beat, converged, in the same order.
const TA_PEAK: [f64; 5] =
    [0.046_521_426_1, 0.316_235_579, 0.227_489_854, 2.069_258_74, 0.074_153_897_7];

/// Largest shortening rate over the peak of shortening of a free cell, 1/s, in the same order.
const PACE: [f64; 5] = [107.2, 33.8, 34.3, 14.7, 83.4];

/// All 35 parameters of one set.
pub fn parameters(variant: Variant) -> ParameterSet {
    let column = variant as usize;
    let values = TABLE.map(|(name, row)| (name, row[column], "bueno_orovio_2008, Table 1"));
    let mut rows = minimal::rows(&values);
    rows.extend(tension::rows(0.0, U_PEAK[column], "highest u of a beat of this set"));
    ParameterSet::new(rows)
}

/// Name, papers, stimulus (0.5/ms for 1 ms) and peak of tension of one set.
pub const fn identity(variant: Variant) -> Identity {
    let (name, description) = match variant {
        Variant::Epi => {
            ("bueno_orovio_2008_epi", "Human ventricular epicardial cell, minimal model")
        }
        Variant::Endo => {
            ("bueno_orovio_2008_endo", "Human ventricular endocardial cell, minimal model")
        }
        Variant::M => ("bueno_orovio_2008_m", "Human midmyocardial cell, minimal model"),
        Variant::Pb => (
            "bueno_orovio_2008_pb",
            "Minimal model fitted to the ventricular cell of Priebe and Beuckelmann",
        ),
        Variant::Tnnp => {
            ("bueno_orovio_2008_tnnp", "Minimal model fitted to the cell of ten Tusscher et al.")
        }
    };
    Identity {
        name,
        description,
        citations: &["bueno_orovio_2008", "coelho_2021", "silva_2020"],
        stimulus: Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 },
        millivolts: Some((85.7, -84.0)),
        peak_tension: TA_PEAK[variant as usize],
        in_authors_program: None,
        pace: (
            PACE[variant as usize],
            "Driven by this action potential, the paper's tension curve rises faster than measured cells",
        ),
    }
}

/// The model of one set.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, bueno_orovio_2008::{Variant, model}};
/// let epi = model(Variant::Epi);
/// assert_eq!(epi.membrane_potential_mv(&epi.initial_state()), Some(-84.0));
/// ```
pub fn model(variant: Variant) -> MinimalModel {
    MinimalModel::published(identity(variant), parameters(variant))
}
