//! I_CaL with its currents of sodium and potassium, in the subspace and at the cytosol.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::gate::Moving;
use super::membrane::Membrane;
use super::parameters::Parameters;
use super::state::{Gates, State};
use crate::cell::number::{Number, inlined};

/// Permeability for sodium and for potassium relative to that for calcium.
const SODIUM: f64 = 0.00125;
const POTASSIUM: f64 = 3.574e-4;

/// Steady states and rates of the gates: d, f_f, f_s, f_Ca_f, f_Ca_s, j_Ca, f_f_p, f_Ca_f_p.
#[inline(always)]
pub(super) fn gates<T: Number>(p: &Parameters<T>, v: T) -> [Moving<T>; 8] {
    // d_inf = 1.0763 exp(-1.007 exp(-0.0829 v)), not above 1
    let d_inf = ((v * -0.0829).exp() * -1.007).exp() * 1.0763;
    let d_inf = v.at_least(31.4978, T::of(1.0), d_inf);
    // tau_d = 0.6 + 1 / (exp(-0.05 (v + 6)) + exp(0.09 (v + 14)))
    let both = inlined(
        #[inline(always)]
        |low: T, high: T| (low.exp() + high.exp()).inverse(),
    );
    let tau_d = both((v + 6.0) * -0.05, (v + 14.0) * 0.09) + 0.6;
    let f_inf = v.boltzmann(-19.58, 3.696);
    // 7 + 1 / (0.0045 exp(-(v + 20) / 10) + 0.0045 exp((v + 20) / 10))
    let tau_f = both((v + 20.0) / -10.0, (v + 20.0) / 10.0) / 0.0045 + 7.0;
    // 1000 + 1 / (3.5e-5 exp(-(v + 5) / 4) + 3.5e-5 exp((v + 5) / 6))
    let tau_s = both((v + 5.0) / -4.0, (v + 5.0) / 6.0) / 3.5e-5 + 1000.0;
    // 7 + 1 / (0.04 exp(-(v - 4) / 7) + 0.04 exp((v - 4) / 7))
    let tau_ca_f = both((v - 4.0) / -7.0, (v - 4.0) / 7.0) / 0.04 + 7.0;
    // 100 + 1 / (1.2e-4 exp(-v / 3) + 1.2e-4 exp(v / 7))
    let tau_ca_s = both(v / -3.0, v / 7.0) / 1.2e-4 + 100.0;
    let j_inf = v.boltzmann(-18.08, 2.7916);
    [
        Moving::within(d_inf, tau_d),
        Moving::within(f_inf, tau_f),
        Moving::within(f_inf, tau_s),
        Moving::within(f_inf, tau_ca_f),
        Moving::within(f_inf, tau_ca_s),
        Moving::within(j_inf, p.tau_j_ca),
        Moving::within(f_inf, tau_f * 2.5),
        Moving::within(f_inf, tau_ca_f * 2.5),
    ]
}

/// Rates of the calcium-dependent mode, subspace and cytosol, 1/ms.
#[inline(always)]
pub(super) fn mode_rates<T: Number>(s: &State<T>, g: &Gates<T>) -> [T; 2] {
    // dn/dt = 500 alpha - j_Ca n, alpha = 1 / (500 / j_Ca + (1 + 0.002 / Ca)^4)
    let rate = inlined(
        #[inline(always)]
        |n: T, calcium: T| {
            let bound = (T::of(0.002) / calcium + 1.0).square().square();
            (T::of(500.0) / g.j_ca + bound).inverse() * 500.0 - g.j_ca * n
        },
    );
    [rate(s.n_ss, s.ca_ss), rate(s.n_i, s.ca_i)]
}

/// Currents, A/F: of calcium, sodium and potassium.
#[derive(Debug, Clone, Copy)]
pub(super) struct CalciumChannel<T> {
    pub(super) ca_i: T,
    pub(super) na_i: T,
    pub(super) k_i: T,
    pub(super) ca_ss: T,
    pub(super) na_ss: T,
    pub(super) k_ss: T,
}

impl<T: Number> CalciumChannel<T> {
    #[inline(always)]
    pub(super) fn new(p: &Parameters<T>, s: &State<T>, g: &Gates<T>, m: &Membrane<T>) -> Self {
        let f = inlined(
            #[inline(always)]
            |fast: T| g.f_s * 0.4 + fast * 0.6,
        );
        // A_Ca_f = 0.3 + 0.6 / (1 + exp((v - 10) / 10))
        let part = m.v.boltzmann(10.0, 10.0) * 0.6 + 0.3;
        let f_ca = inlined(
            #[inline(always)]
            |fast: T| (g.f_ca_s + (fast - g.f_ca_s) * part) * g.j_ca,
        );
        // d (f (1 - n) + j_Ca f_Ca n), phosphorylated 1.1 times as permeable
        let open = inlined(
            #[inline(always)]
            |n: T| {
                let plain = f(g.f_f) * n.rest() + f_ca(g.f_ca_f) * n;
                let phosphorylated = f(g.f_f_p) * n.rest() + f_ca(g.f_ca_f_p) * n;
                p.p_ca * g.d * m.mixed(plain, phosphorylated * 1.1)
            },
        );
        let (single_i, single_ss) = (m.activity_i.exp(), m.activity_ss.exp());
        let single_o = m.activity_o.exp();
        let double = inlined(
            #[inline(always)]
            |single: T| single.square().square(),
        );
        let (double_i, double_ss, double_o) =
            (double(single_i), double(single_ss), double(single_o));
        let at = inlined(
            #[inline(always)]
            |open: T, single: T, double: T, ca: T, na: T, k: T| {
                [
                    open * m.goldman_2(double * ca, double_o * p.ca_o),
                    open * m.goldman_1(single * na, single_o * p.na_o) * SODIUM,
                    open * m.goldman_1(single * k, single_o * p.k_o) * POTASSIUM,
                ]
            },
        );
        let open_ss = open(s.n_ss) * p.f_cal_ss;
        let open_i = open(s.n_i) * p.f_cal_ss.rest();
        let [ca_i, na_i, k_i] = at(open_i, single_i, double_i, s.ca_i, s.na_i, s.k_i);
        let [ca_ss, na_ss, k_ss] = at(open_ss, single_ss, double_ss, s.ca_ss, s.na_ss, s.k_ss);
        Self { ca_i, na_i, k_i, ca_ss, na_ss, k_ss }
    }

    /// Their sum.
    #[inline(always)]
    pub(super) fn sum(&self) -> T {
        self.ca_i + self.na_i + self.k_i + self.ca_ss + self.na_ss + self.k_ss
    }
}
