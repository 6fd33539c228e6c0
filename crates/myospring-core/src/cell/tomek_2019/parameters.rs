//! Parameters: conductances by cell, the solution outside, CaM kinase, buffers.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::table::table;
use crate::cell::description::{ModelError, required};
use crate::parameter::{Parameter, ParameterSet};

/// Name, unit, values of endo, epi and mid, meaning.
type Row = (&'static str, &'static str, [f64; 3], &'static str);

/// The same in every cell.
const fn all(value: f64) -> [f64; 3] {
    [value; 3]
}

/// A value of endo times the published factors of epi and mid.
const fn by_cell(endo: f64, epi: f64, mid: f64) -> [f64; 3] {
    [endo, endo * epi, endo * mid]
}

table! {
    /// All parameters of the model.
    Parameters, Row, ROWS;
    g_na: ("G_Na", "mS/uF", all(11.7802), "fast sodium current"),
    g_nal: ("G_NaL", "mS/uF", by_cell(0.0279, 0.6, 1.0), "late sodium current"),
    g_to: ("G_to", "mS/uF", by_cell(0.16, 2.0, 2.0), "transient outward current"),
    delta_epi: ("delta_epi", "", [0.0, 0.95, 0.0], "how much faster I_to inactivates at rest"),
    p_ca: ("P_Ca", "cm/s", by_cell(8.3757e-5, 1.2, 2.0), "L-type calcium current"),
    f_cal_ss: ("f_CaL_ss", "", all(0.8), "part of I_CaL in the subspace"),
    tau_j_ca: ("tau_jCa", "ms", all(75.0), "recovery of I_CaL from inactivation by calcium"),
    g_kr: ("G_Kr", "mS/uF", by_cell(0.0321, 1.3, 0.8), "rapid delayed rectifier"),
    g_ks: ("G_Ks", "mS/uF", by_cell(0.0011, 1.4, 1.0), "slow delayed rectifier"),
    g_k1: ("G_K1", "mS/uF", by_cell(0.6992, 1.2, 1.3), "inward rectifier"),
    g_kb: ("G_Kb", "mS/uF", by_cell(0.0189, 0.6, 1.0), "background potassium current"),
    f_katp: ("f_KATP", "", all(0.0), "part of the ATP-sensitive potassium channels that is open"),
    g_naca: ("G_NaCa", "A/F", by_cell(0.0034, 1.1, 1.4), "sodium-calcium exchange"),
    f_naca_ss: ("f_NaCa_ss", "", all(0.35), "part of I_NaCa in the subspace"),
    p_nak: ("P_NaK", "A/F", by_cell(15.4509, 0.9, 0.7), "sodium-potassium pump"),
    p_nab: ("P_Nab", "cm/s", all(1.9239e-9), "background sodium current"),
    p_cab: ("P_Cab", "cm/s", all(5.9194e-8), "background calcium current"),
    g_pca: ("G_pCa", "A/F", all(5e-4), "calcium pump of the membrane"),
    g_clca: ("G_ClCa", "mS/uF", all(0.2843), "chloride current by calcium, in the subspace"),
    g_clb: ("G_Clb", "mS/uF", all(0.00198), "background chloride current"),
    k_rel: ("k_rel", "", all(1.5378), "release from the sarcoplasmic reticulum"),
    a_rel: ("a_rel", "", by_cell(1.0, 1.0, 1.7), "release for an I_CaL, relative to endo"),
    k_up: ("k_up", "", by_cell(1.0, 1.3, 1.0), "SERCA, relative to endo"),
    k_leak: ("k_leak", "", all(1.0), "leak of the sarcoplasmic reticulum, relative to the published one"),
    na_o: ("Na_o", "mM", all(140.0), "sodium outside"),
    ca_o: ("Ca_o", "mM", all(1.8), "calcium outside"),
    k_o: ("K_o", "mM", all(5.0), "potassium outside"),
    cl_o: ("Cl_o", "mM", all(150.0), "chloride outside"),
    cl_i: ("Cl_i", "mM", all(24.0), "chloride in the cytosol, if constant"),
    alpha_camk: ("alpha_CaMK", "1/ms", all(0.05), "trapping of CaM kinase"),
    beta_camk: ("beta_CaMK", "1/ms", all(6.8e-4), "its release"),
    camk_o: ("CaMK_o", "", all(0.05), "part of CaM kinase that calmodulin can bind at rest"),
    k_m_cam: ("K_m_CaM", "mM", all(0.0015), "half binding of calmodulin"),
    k_m_camk: ("K_m_CaMK", "", all(0.15), "half phosphorylation by CaM kinase"),
    cmdn_max: ("cmdn_max", "mM", by_cell(0.05, 1.3, 1.0), "calmodulin in the cytosol"),
    k_m_cmdn: ("K_m_cmdn", "mM", all(0.00238), "its half binding"),
    trpn_max: ("trpn_max", "mM", all(0.07), "troponin"),
    k_m_trpn: ("K_m_trpn", "mM", all(5e-4), "its half binding, without myofilaments"),
    bsr_max: ("BSR_max", "mM", all(0.047), "sites at the reticulum in the subspace"),
    k_m_bsr: ("K_m_BSR", "mM", all(8.7e-4), "their half binding"),
    bsl_max: ("BSL_max", "mM", all(1.124), "sites at the membrane in the subspace"),
    k_m_bsl: ("K_m_BSL", "mM", all(0.0087), "their half binding"),
    csqn_max: ("csqn_max", "mM", all(10.0), "calsequestrin"),
    k_m_csqn: ("K_m_csqn", "mM", all(0.8), "its half binding"),
}

/// Permeability of I_CaL in mid with myofilaments, for which `margara_2021` uses 1.8 times that of
/// endo, not twice, cm/s.
pub(super) const P_CA_MID_LAND: f64 = 1.8 * 8.3757e-5;

/// Parameters that must be above 0.
const POSITIVE: [&str; 15] = [
    "Na_o",
    "Ca_o",
    "K_o",
    "Cl_o",
    "Cl_i",
    "tau_jCa",
    "K_m_CaM",
    "K_m_CaMK",
    "K_m_cmdn",
    "K_m_trpn",
    "K_m_BSR",
    "K_m_BSL",
    "K_m_csqn",
    "alpha_CaMK",
    "beta_CaMK",
];
/// Parameters that are fractions.
const PARTS: [&str; 5] = ["delta_epi", "f_CaL_ss", "f_KATP", "f_NaCa_ss", "CaMK_o"];
const CELLS: [&str; 3] = ["endo", "epi", "mid"];

/// The rows of one cell (0 endo, 1 epi, 2 mid).
pub(super) fn rows(cell: usize, tau_j_ca: f64) -> Vec<Parameter> {
    let row = |&(name, unit, values, meaning): &Row| {
        let value = if name == "tau_jCa" { tau_j_ca } else { values[cell] };
        let minimum = if POSITIVE.contains(&name) { 1e-3 * value } else { 0.0 };
        let maximum = if PARTS.contains(&name) { 1.0 } else { 100.0 * values[cell].max(1e-9) };
        let source = if values[0] == values[cell] {
            "tomek_2019, code of the authors".to_owned()
        } else {
            format!("tomek_2019, code of the authors, {}", CELLS[cell])
        };
        Parameter::new(name, value, unit, [minimum, maximum], meaning, source)
    };
    ROWS.iter().map(row).collect()
}

/// The values of a model's set.
pub(super) fn read(model: &str, set: &ParameterSet) -> Result<Parameters<f64>, ModelError> {
    let values = ROWS.iter().map(|row| required(model, set, row.0));
    let mut values = values.collect::<Result<Vec<f64>, _>>()?.into_iter();
    Ok(Parameters::take(&mut || values.next().unwrap_or(f64::NAN)))
}
