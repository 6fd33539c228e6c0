//! The state variables.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::table::table;

/// Name, unit, meaning.
pub(super) type Row = (&'static str, &'static str, &'static str);

table! {
    /// The states of all forms of the model.
    State, Row, ROWS;
    v: ("v", "mV", "membrane potential"),
    na_i: ("Na_i", "mM", "sodium in the cytosol"),
    na_ss: ("Na_ss", "mM", "sodium in the junctional subspace"),
    k_i: ("K_i", "mM", "potassium in the cytosol"),
    k_ss: ("K_ss", "mM", "potassium in the junctional subspace"),
    ca_i: ("Ca_cyt", "mM", "free calcium in the cytosol"),
    ca_ss: ("Ca_ss", "mM", "free calcium in the junctional subspace"),
    ca_nsr: ("Ca_nsr", "mM", "calcium in the network of the sarcoplasmic reticulum"),
    ca_jsr: ("Ca_jsr", "mM", "calcium in the junctional sarcoplasmic reticulum"),
    camk_t: ("CaMK_t", "", "CaM kinase that is trapped"),
    j_rel_np: ("J_rel_np", "mM/ms", "release by receptors that are not phosphorylated"),
    j_rel_p: ("J_rel_p", "mM/ms", "release by phosphorylated receptors"),
    n_ss: ("n_ss", "", "I_CaL in the subspace: calcium-dependent mode"),
    n_i: ("n_i", "", "I_CaL in the cytosol: calcium-dependent mode"),
    c0: ("C0", "", "I_Kr: first closed state"),
    c1: ("C1", "", "I_Kr: second closed state"),
    c2: ("C2", "", "I_Kr: third closed state"),
    o: ("O", "", "I_Kr: open"),
    i: ("I", "", "I_Kr: inactivated"),
}

table! {
    /// Gates that depend only on the potential.
    Gates, Row, GATES;
    m: ("m", "", "I_Na: activation"),
    h: ("h", "", "I_Na: fast inactivation"),
    j: ("j", "", "I_Na: slow inactivation"),
    h_p: ("h_p", "", "I_Na: fast inactivation, phosphorylated"),
    j_p: ("j_p", "", "I_Na: slow inactivation, phosphorylated"),
    m_l: ("m_L", "", "I_NaL: activation"),
    h_l: ("h_L", "", "I_NaL: inactivation"),
    h_l_p: ("h_L_p", "", "I_NaL: inactivation, phosphorylated"),
    a: ("a", "", "I_to: activation"),
    i_f: ("i_F", "", "I_to: fast inactivation"),
    i_s: ("i_S", "", "I_to: slow inactivation"),
    a_p: ("a_p", "", "I_to: activation, phosphorylated"),
    i_f_p: ("i_F_p", "", "I_to: fast inactivation, phosphorylated"),
    i_s_p: ("i_S_p", "", "I_to: slow inactivation, phosphorylated"),
    d: ("d", "", "I_CaL: activation"),
    f_f: ("f_f", "", "I_CaL: fast inactivation by the potential"),
    f_s: ("f_s", "", "I_CaL: slow inactivation by the potential"),
    f_ca_f: ("f_Ca_f", "", "I_CaL: fast inactivation in the calcium-dependent mode"),
    f_ca_s: ("f_Ca_s", "", "I_CaL: slow inactivation in the calcium-dependent mode"),
    j_ca: ("j_Ca", "", "I_CaL: recovery from inactivation by calcium"),
    f_f_p: ("f_f_p", "", "I_CaL: fast inactivation, phosphorylated"),
    f_ca_f_p: ("f_Ca_f_p", "", "I_CaL: fast inactivation by calcium, phosphorylated"),
    x_s1: ("x_s1", "", "I_Ks: activation"),
    x_s2: ("x_s2", "", "I_Ks: second activation"),
}

table! {
    /// Dynamic chloride.
    Chloride, Row, CHLORIDE;
    cl_i: ("Cl_i", "mM", "chloride in the cytosol"),
    cl_ss: ("Cl_ss", "mM", "chloride in the junctional subspace"),
}
