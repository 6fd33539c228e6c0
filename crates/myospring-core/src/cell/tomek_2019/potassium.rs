//! I_to, I_Kr, I_Ks, I_K1, and the potassium currents of the background and of ATP.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::gate::Moving;
use super::membrane::{F_OVER_RT, Membrane};
use super::parameters::Parameters;
use super::state::{Gates, State};
use crate::cell::number::{Number, inlined};

/// Steady states and rates of the gates of I_to: a, i_F, i_S, a_p, i_F_p, i_S_p.
#[inline(always)]
pub(super) fn transient_gates<T: Number>(p: &Parameters<T>, v: T) -> [Moving<T>; 6] {
    let [a_inf, a_p_inf] = [v.boltzmann(14.34, -14.82), v.boltzmann(24.34, -14.82)];
    // tau_a = 1.0515 / (1 / (1.2089 (1 + exp(-(v - 18.4099) / 29.3814))) + 3.5 / (1 + exp((v + 100) / 29.3814)))
    let rate_a =
        (v.boltzmann(18.4099, -29.3814) / 1.2089 + v.boltzmann(-100.0, 29.3814) * 3.5) / 1.0515;
    let i_inf = v.boltzmann(-43.94, 5.711);
    // tau_F = 4.562 + 1 / (0.3933 exp(-(v + 100) / 100) + 0.08004 exp((v + 50) / 16.59))
    let fast = (((v + 100.0) / -100.0).exp() * 0.3933 + ((v + 50.0) / 16.59).exp() * 0.08004)
        .inverse()
        + 4.562;
    // tau_S = 23.62 + 1 / (0.001416 exp(-(v + 96.52) / 59.05) + 1.78e-8 exp((v + 114.1) / 8.079))
    let slow = (((v + 96.52) / -59.05).exp() * 0.001416 + ((v + 114.1) / 8.079).exp() * 1.78e-8)
        .inverse()
        + 23.62;
    // In epi both times delta_epi = 1 - 0.95 / (1 + exp((v + 70) / 5))
    let shorter = (p.delta_epi * v.boltzmann(-70.0, 5.0)).rest();
    let (fast, slow) = (fast * shorter, slow * shorter);
    // Phosphorylated: times (1.354 + 1e-4 / (exp((v - 167.4) / 15.89) + exp(-(v - 12.23) / 0.2154)))
    // and (1 - 0.5 / (1 + exp((v + 70) / 20)))
    let develop =
        (((v - 167.4) / 15.89).exp() + ((v - 12.23) / -0.2154).exp()).inverse() * 1e-4 + 1.354;
    let recover = (v.boltzmann(-70.0, 20.0) * 0.5).rest();
    let longer = develop * recover;
    [
        Moving::new(a_inf, rate_a),
        Moving::within(i_inf, fast),
        Moving::within(i_inf, slow),
        Moving::new(a_p_inf, rate_a),
        Moving::within(i_inf, fast * longer),
        Moving::within(i_inf, slow * longer),
    ]
}

/// Steady states and rates of the gates of I_Ks: x_s1, x_s2.
#[inline(always)]
pub(super) fn slow_gates<T: Number>(v: T) -> [Moving<T>; 2] {
    let x_inf = v.boltzmann(-11.6, -8.932);
    // tau_1 = 817.3 + 1 / (2.326e-4 exp((v + 48.28) / 17.8) + 0.001292 exp(-(v + 210) / 230))
    let tau_1 = (((v + 48.28) / 17.8).exp() * 2.326e-4 + ((v + 210.0) / -230.0).exp() * 0.001292)
        .inverse()
        + 817.3;
    // tau_2 = 1 / (0.01 exp((v - 50) / 20) + 0.0193 exp(-(v + 66.54) / 31))
    let rate_2 = ((v - 50.0) / 20.0).exp() * 0.01 + ((v + 66.54) / -31.0).exp() * 0.0193;
    [Moving::within(x_inf, tau_1), Moving::new(x_inf, rate_2)]
}

/// Rates of the channel of I_Kr, 1/ms: C0, C1, C2, O, I.
#[inline(always)]
pub(super) fn rapid_rates<T: Number>(s: &State<T>) -> [T; 5] {
    let e = inlined(
        #[inline(always)]
        |slope: f64| (s.v * (slope * F_OVER_RT)).exp(),
    );
    let (alpha, beta) = (e(0.299) * 0.1161, e(-1.604) * 0.2442);
    let (alpha_1, beta_1) = (1.25 * 0.1235, 0.1911);
    let (alpha_2, beta_2) = (e(0.971) * 0.0578, e(-1.062) * 0.349e-3);
    let (alpha_i, beta_i) = (e(0.5953) * 0.2533, e(-0.8209) * (1.25 * 0.0522));
    let alpha_c2_i = e(1.525) * 0.52e-4;
    // Detailed balance: beta_I_C2 = beta_2 beta_i alpha_C2_I / (alpha_2 alpha_i)
    let beta_i_c2 = beta_2 * beta_i * alpha_c2_i / (alpha_2 * alpha_i);
    let c0_c1 = s.c0 * alpha - s.c1 * beta;
    let c1_c2 = s.c1 * alpha_1 - s.c2 * beta_1;
    let c2_o = s.c2 * alpha_2 - s.o * beta_2;
    let o_i = s.o * alpha_i - s.i * beta_i;
    let c2_i = s.c2 * alpha_c2_i - s.i * beta_i_c2;
    [-c0_c1, c0_c1 - c1_c2, c1_c2 - c2_o - c2_i, c2_o - o_i, o_i + c2_i]
}

/// Currents, A/F.
#[derive(Debug, Clone, Copy)]
pub(super) struct Potassium<T> {
    pub(super) transient: T,
    pub(super) rapid: T,
    pub(super) slow: T,
    pub(super) inward: T,
    pub(super) background: T,
    pub(super) by_atp: T,
}

impl<T: Number> Potassium<T> {
    #[inline(always)]
    pub(super) fn new(p: &Parameters<T>, s: &State<T>, g: &Gates<T>, m: &Membrane<T>) -> Self {
        let drive = m.v - m.e_k;
        let root = (p.k_o / 5.0).sqrt();
        // i = A_F i_F + (1 - A_F) i_S with A_F = 1 / (1 + exp((v - 213.6) / 151.2))
        let part = m.v.boltzmann(213.6, 151.2);
        let i = g.i_s + (g.i_f - g.i_s) * part;
        let i_p = g.i_s_p + (g.i_f_p - g.i_s_p) * part;
        // K_Ca = 1 + 0.6 / (1 + (3.8e-5 / Ca_i)^1.4)
        let by_calcium = ((T::of(3.8e-5) / s.ca_i).power(1.4) + 1.0).inverse() * 0.6 + 1.0;
        // a / (a + b) of the inward rectifier, by v - E_K
        let a = drive.boltzmann(49.934, 1.0 / 0.1217) * 4.094;
        let b = (((drive - 3.257) * 0.0674).exp() * 15.72 + ((drive - 594.31) * 0.0618).exp())
            * drive.boltzmann(-14.207, -1.0 / 0.1629);
        // G_KATP (K_o / 5)^0.24 / (1 + (ATP / 0.25)^2) with 2 mM of ATP
        let by_atp = (p.k_o / 5.0).power(0.24) * (4.3195 / 65.0);
        Self {
            transient: p.g_to * drive * m.mixed(g.a * i, g.a_p * i_p),
            rapid: p.g_kr * root * s.o * drive,
            slow: p.g_ks * by_calcium * g.x_s1 * g.x_s2 * (m.v - m.e_ks),
            inward: p.g_k1 * root * a / (a + b) * drive,
            background: p.g_kb * m.v.boltzmann(10.8968, -23.9871) * drive,
            by_atp: p.f_katp * by_atp * drive,
        }
    }
}
