//! I_NaCa, I_NaK, the calcium pump and the background of calcium, chloride.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::membrane::{Chlorides, F_OVER_RT, Membrane};
use super::parameters::Parameters;
use super::state::State;
use crate::cell::number::{Number, inlined};

/// Currents, A/F.
#[derive(Debug, Clone, Copy)]
pub(super) struct Exchange<T> {
    pub(super) na_ca_i: T,
    pub(super) na_ca_ss: T,
    pub(super) na_k: T,
    pub(super) ca_pump: T,
    pub(super) ca_background: T,
    pub(super) cl_ca: T,
    pub(super) cl_background: T,
}

impl<T: Number> Exchange<T> {
    #[inline(always)]
    pub(super) fn new(
        p: &Parameters<T>,
        s: &State<T>,
        m: &Membrane<T>,
        chloride: &Chlorides<T>,
    ) -> Self {
        let (gamma_i, gamma_o) = ((m.activity_i * 4.0).exp(), (m.activity_o * 4.0).exp());
        let reversal = inlined(
            #[inline(always)]
            |inside: T| (inside / p.cl_o).ln() / F_OVER_RT,
        );
        Self {
            na_ca_i: p.f_naca_ss.rest() * p.g_naca * sodium_calcium(p, m, s.na_i, s.ca_i),
            na_ca_ss: p.f_naca_ss * p.g_naca * sodium_calcium(p, m, s.na_ss, s.ca_ss),
            na_k: p.p_nak * sodium_potassium(p, s, m),
            ca_pump: p.g_pca * s.ca_i / (s.ca_i + 5e-4),
            ca_background: p.p_cab * m.goldman_2(gamma_i * s.ca_i, gamma_o * p.ca_o),
            // G_ClCa / (1 + 0.1 / Ca_ss) (v - E_Cl)
            cl_ca: p.g_clca * s.ca_ss / (s.ca_ss + 0.1) * (m.v - reversal(chloride.ss)),
            cl_background: p.g_clb * (m.v - reversal(chloride.i)),
        }
    }
}

/// `J_Na + 2 J_Ca` of the exchanger, times its activation by calcium: the six states of the model of
/// `o_hara_2011` at equilibrium.
#[inline(always)]
fn sodium_calcium<T: Number>(p: &Parameters<T>, m: &Membrane<T>, na: T, ca: T) -> T {
    const K_NA: [f64; 3] = [15.0, 5.0, 88.12];
    const ASYMMETRY: f64 = 12.5;
    const W_NA: f64 = 6e4;
    const W_CA: f64 = 6e4;
    const W_NACA: f64 = 5e3;
    const ON: f64 = 1.5e6;
    const OFF: f64 = 5e3;
    let h_ca = (m.x * 0.167).exp();
    let h_na = (m.x * 0.5224).exp();
    let h_1 = na / K_NA[2] * (h_na + 1.0) + 1.0;
    let h_2 = na * h_na / (h_1 * K_NA[2]);
    let h_4 = na / K_NA[0] * (na / K_NA[1] + 1.0) + 1.0;
    let h_5 = na.square() / (h_4 * (K_NA[0] * K_NA[1]));
    let h_7 = p.na_o / K_NA[2] * (h_na.inverse() + 1.0) + 1.0;
    let h_8 = p.na_o / (h_na * h_7 * K_NA[2]);
    let h_10 = p.na_o / K_NA[0] * (p.na_o / K_NA[1] + 1.0) + (ASYMMETRY + 1.0);
    let h_11 = p.na_o.square() / (h_10 * (K_NA[0] * K_NA[1]));
    let k_1 = p.ca_o * ON / h_10;
    let k_2 = T::of(OFF);
    let k_3_pp = h_8 * W_NACA;
    let k_3 = T::of(W_CA) / h_7 + k_3_pp;
    let k_4_pp = h_2 * W_NACA;
    let k_4 = T::of(W_CA) / (h_1 * h_ca) + k_4_pp;
    let k_5 = T::of(OFF);
    let k_6 = ca * ON / h_4;
    let k_7 = h_5 * h_2 * W_NA;
    let k_8 = h_8 * h_11 * W_NA;
    let x_1 = k_2 * k_4 * (k_7 + k_6) + k_5 * k_7 * (k_2 + k_3);
    let x_2 = k_1 * k_7 * (k_4 + k_5) + k_4 * k_6 * (k_1 + k_8);
    let x_3 = k_1 * k_3 * (k_7 + k_6) + k_8 * k_6 * (k_2 + k_3);
    let x_4 = k_2 * k_8 * (k_4 + k_5) + k_3 * k_5 * (k_1 + k_8);
    // With the states E = x / (x_1 + x_2 + x_3 + x_4)
    let j_na = (x_4 * k_7 - x_1 * k_8) * 3.0 + x_3 * k_4_pp - x_2 * k_3_pp;
    let j_ca = x_2 * k_2 - x_1 * k_1;
    // 1 / (1 + (K / Ca)^2) with 0.15 uM
    let active = ((T::of(1.5e-4) / ca).square() + 1.0).inverse();
    active * (j_na + j_ca * 2.0) / (x_1 + x_2 + x_3 + x_4)
}

/// `J_Na + J_K` of the pump: the model of Smith and Crampin as in `o_hara_2011`.
#[inline(always)]
fn sodium_potassium<T: Number>(p: &Parameters<T>, s: &State<T>, m: &Membrane<T>) -> T {
    const DELTA: f64 = -0.155;
    const ATP: f64 = 9.8 / 1.698e-7;
    const ADP: f64 = 0.05;
    const HYDROGEN: f64 = 1e-7;
    const K_K_I: f64 = 0.5;
    const K_K_O: f64 = 0.3582;
    let na_i = s.na_i / ((m.x * (DELTA / 3.0)).exp() * 9.073);
    let na_o = p.na_o / ((m.x * ((1.0 - DELTA) / 3.0)).exp() * 27.78);
    let phosphate = (s.na_i / 224.0 + s.k_i / 292.0 + (1.0 + HYDROGEN / 1.698e-7)).inverse() * 4.2;
    let squared = inlined(
        #[inline(always)]
        |k: T, half: f64| (k / half).square(),
    );
    let inside = ((na_i + 1.0).cube() + (s.k_i / K_K_I + 1.0).square() - 1.0).inverse();
    let outside = ((na_o + 1.0).cube() + (p.k_o / K_K_O + 1.0).square() - 1.0).inverse();
    let a_1 = na_i.cube() * inside * 949.5;
    let b_1 = T::of(182.4 * ADP);
    let a_2 = T::of(687.2);
    let b_2 = na_o.cube() * outside * 39.4;
    let a_3 = squared(p.k_o, K_K_O) * outside * 1899.0;
    let b_3 = phosphate * (79300.0 * HYDROGEN / (1.0 + ATP));
    let a_4 = T::of(639.0 * ATP / (1.0 + ATP));
    let b_4 = squared(s.k_i, K_K_I) * inside * 40.0;
    let x_1 = a_4 * a_1 * a_2 + b_2 * b_4 * b_3 + a_2 * b_4 * b_3 + b_3 * a_1 * a_2;
    let x_2 = b_2 * b_1 * b_4 + a_1 * a_2 * a_3 + a_3 * b_1 * b_4 + a_2 * a_3 * b_4;
    let x_3 = a_2 * a_3 * a_4 + b_3 * b_2 * b_1 + b_2 * b_1 * a_4 + a_3 * a_4 * b_1;
    let x_4 = b_4 * b_3 * b_2 + a_3 * a_4 * a_1 + b_2 * a_4 * a_1 + b_3 * b_2 * a_1;
    // 3 (E_1 a_3 - E_2 b_3) + 2 (E_4 b_1 - E_3 a_1)
    ((x_1 * a_3 - x_2 * b_3) * 3.0 + (x_4 * b_1 - x_3 * a_1) * 2.0) / (x_1 + x_2 + x_3 + x_4)
}
