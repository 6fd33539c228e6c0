//! I_Na, I_NaL and the background current of sodium.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::gate::Moving;
use super::membrane::Membrane;
use super::parameters::Parameters;
use super::state::{Gates, State};
use crate::cell::number::{Number, inlined};

/// Steady states and rates of the gates of both currents: m, h, j, h_p, j_p, m_L, h_L, h_L_p.
#[inline(always)]
pub(super) fn gates<T: Number>(v: T) -> [Moving<T>; 8] {
    // m_inf = 1 / (1 + exp(-(v + 56.86) / 9.03))^2
    let m_inf = v.boltzmann(-56.86, -9.03).square();
    // tau_m = 0.1292 exp(-((v + 45.79) / 15.54)^2) + 0.06487 exp(-((v - 4.823) / 51.12)^2)
    let bell = inlined(
        #[inline(always)]
        |centre: f64, width: f64| (-((v - centre) / width).square()).exp(),
    );
    let tau_m = bell(-45.79, 15.54) * 0.1292 + bell(4.823, 51.12) * 0.06487;

    // Below -40 mV: a_h = 0.057 exp(-(v + 80) / 6.8), b_h = 2.7 exp(0.079 v) + 3.1e5 exp(0.3485 v);
    // from there on a_h = 0, b_h = 0.77 / (0.13 (1 + exp(-(v + 10.66) / 11.1)))
    let low =
        ((v + 80.0) / -6.8).exp() * 0.057 + (v * 0.079).exp() * 2.7 + (v * 0.3485).exp() * 3.1e5;
    let high = v.boltzmann(-10.66, -11.1) * (0.77 / 0.13);
    let rate_h = v.at_least(-40.0, high, low);
    // h_inf = 1 / (1 + exp((v + 71.55) / 7.43))^2, 6 mV lower where phosphorylated
    let h_inf = v.boltzmann(-71.55, 7.43).square();
    let h_p_inf = v.boltzmann(-77.55, 7.43).square();

    // Below -40 mV: a_j = (-2.5428e4 exp(0.2444 v) - 6.948e-6 exp(-0.04391 v)) (v + 37.78)
    // / (1 + exp(0.311 (v + 79.23))), b_j = 0.02424 exp(-0.01052 v) / (1 + exp(-0.1378 (v + 40.14)));
    // from there on a_j = 0, b_j = 0.6 exp(0.057 v) / (1 + exp(-0.1 (v + 32)))
    let a_j = ((v * 0.2444).exp() * -2.5428e4 - (v * -0.04391).exp() * 6.948e-6)
        * (v + 37.78)
        * v.boltzmann(-79.23, 1.0 / 0.311);
    let low = a_j + (v * -0.01052).exp() * 0.02424 * v.boltzmann(-40.14, -1.0 / 0.1378);
    let high = (v * 0.057).exp() * 0.6 * v.boltzmann(-32.0, -1.0 / 0.1);
    let rate_j = v.at_least(-40.0, high, low);

    // m_L_inf = 1 / (1 + exp(-(v + 42.85) / 5.264)), h_L_inf = 1 / (1 + exp((v + 87.61) / 7.488))
    let m_l_inf = v.boltzmann(-42.85, -5.264);
    let [h_l_inf, h_l_p_inf] = [v.boltzmann(-87.61, 7.488), v.boltzmann(-93.81, 7.488)];
    let rate_m = tau_m.inverse();
    [
        Moving::new(m_inf, rate_m),
        Moving::new(h_inf, rate_h),
        Moving::new(h_inf, rate_j),
        Moving::new(h_p_inf, rate_h),
        Moving::new(h_inf, rate_j / 1.46),
        Moving::new(m_l_inf, rate_m),
        Moving::new(h_l_inf, T::of(1.0 / 200.0)),
        Moving::new(h_l_p_inf, T::of(1.0 / 600.0)),
    ]
}

/// Currents, A/F.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sodium<T> {
    pub(super) fast: T,
    pub(super) late: T,
    pub(super) background: T,
}

impl<T: Number> Sodium<T> {
    #[inline(always)]
    pub(super) fn new(p: &Parameters<T>, s: &State<T>, g: &Gates<T>, m: &Membrane<T>) -> Self {
        let drive = m.v - m.e_na;
        Self {
            // I_Na = G_Na (v - E_Na) m^3 ((1 - f) h j + f h_p j_p)
            fast: p.g_na * drive * g.m.cube() * m.mixed(g.h * g.j, g.h_p * g.j_p),
            // I_NaL = G_NaL (v - E_Na) m_L ((1 - f) h_L + f h_L_p)
            late: p.g_nal * drive * g.m_l * m.mixed(g.h_l, g.h_l_p),
            background: p.p_nab * m.goldman_1(s.na_i, p.na_o),
        }
    }
}
