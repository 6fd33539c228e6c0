//! The smooth pieces of the minimal model, and sliding along a switch between two of them.
//!
//! The Heaviside steps of Eqs. (18)-(35) cut the states into regions: intervals of `u` between
//! thresholds, and for `V > x_2` two sides of `Ta_i = x_3`. Within a region every Heaviside step is
//! a constant, so the same formula serves all regions with different constants ([`Branch`]).
//! Switches without effect are left out: `theta_v_minus` above `theta_v` and `theta_o` above
//! `theta_w`.
#![allow(clippy::inline_always, reason = "functions called in vectorised loops must be inlined")]

use crate::cell::exponential::exp;
use crate::cell::minimal::Electrical;
use crate::cell::tension::Tension;
use std::f64::consts::PI;

/// `u`, `v`, `w`, `s`, `Ta_i`, `Ta`.
pub(in crate::cell) type State = [f64; 6];

/// Largest argument of the sigmoids' exponentials, where the sigmoids are 0 or 1.
const SATURATED: f64 = 300.0;

/// Defines a struct of numbers that can be stored as an array.
macro_rules! numbers {
    ($(#[$doc:meta])* $name:ident { $($(#[$field_doc:meta])* $field:ident,)* }) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Default)]
        pub(super) struct $name {
            $($(#[$field_doc])* pub(super) $field: f64,)*
        }

        impl $name {
            /// Number of fields.
            pub(super) const LEN: usize = [$(stringify!($field)),*].len();

            /// Its values as an array, in the order of the fields.
            #[inline(always)]
            pub(super) fn to_array(self) -> [f64; Self::LEN] {
                [$(self.$field),*]
            }

            /// From such an array.
            #[inline(always)]
            pub(super) fn from_array(numbers: [f64; Self::LEN]) -> Self {
                let [$($field),*] = numbers;
                Self { $($field),* }
            }
        }
    };
}

numbers! {
    /// The constants of one region; a constant that is multiplied by a Heaviside step of 0 is 0.
    Branch {
        /// Stimulus, 1/ms.
        stimulus,
        /// `H(u - theta_v) / tau_fi`.
        fast_inward,
        theta_v,
        u_u,
        /// `H(u - theta_w) / tau_si`.
        slow_inward,
        /// `(1 - H(u - theta_w)) / tau_o`.
        outward,
        u_o,
        /// `H(u - theta_w)`: weight of `1 / tau` in `du/dt`.
        above,
        /// `2 k_so` above `theta_w`, else `2 k_w^-`: the sigmoid time constant `tau` of this side.
        tau_slope,
        tau_middle,
        tau_1,
        tau_2,
        /// `w_inf = w_inf_0 + w_inf_1 u`.
        w_inf_0,
        w_inf_1,
        /// `H(u - theta_w) / tau_w^+`.
        w_closing,
        /// `1 - H(u - theta_w)`: weight of `1 / tau` in `dw/dt`.
        below,
        v_inf,
        v_rate,
        /// `2 k_s`.
        s_slope,
        s_middle,
        s_rate,
        c_0,
        bell_height,
        bell_centre,
        /// `1 / (sqrt(2) sigma (u_peak - u_rest))`.
        bell_scale,
        epsilon_1,
    }
}

numbers! {
    /// A branch at fixed `u`: everything that depends only on `u` is evaluated.
    Side {
        /// `du/dt = drive + drive_v v + drive_ws w s`.
        drive,
        drive_v,
        drive_ws,
        v_inf,
        v_rate,
        w_inf,
        w_rate,
        s_inf,
        s_rate,
        bell,
        c_0,
        epsilon_1,
    }
}

/// A smooth right-hand side.
pub(super) trait Field {
    /// d(state)/dt, 1/ms.
    fn rates(&self, state: &State) -> State;
}

impl Branch {
    /// A branch whose rates are all 0.
    pub(super) fn asleep() -> Self {
        Self { tau_1: 1.0, ..Self::default() }
    }

    /// Evaluates everything that depends only on `u`.
    ///
    /// The two sigmoids share one division: `1 / tau = (1 + e) / (tau_1 + tau_2 e)` with
    /// `e = exp(2 k (u - u_k))`, because `(1 + tanh(x)) / 2 = e / (1 + e)`, and likewise `s_inf`.
    #[inline(always)]
    pub(super) fn at(&self, u: f64) -> Side {
        let e_tau = exp(saturated(self.tau_slope * (u - self.tau_middle)));
        let e_s = exp(saturated(self.s_slope * (u - self.s_middle)));
        let z = (u - self.bell_centre) * self.bell_scale;
        let (tau, s) = (self.tau_1 + self.tau_2 * e_tau, 1.0 + e_s);
        let inverse = 1.0 / (tau * s);
        let per_tau = (1.0 + e_tau) * s * inverse;
        Side {
            // (23) J_so = (u - u_o) (1 - H(u - theta_w)) / tau_o + H(u - theta_w) / tau_so
            drive: self.stimulus - self.outward * (u - self.u_o) - self.above * per_tau,
            // (22) J_fi = -v H(u - theta_v) (u - theta_v) (u_u - u) / tau_fi
            drive_v: self.fast_inward * (u - self.theta_v) * (self.u_u - u),
            // (24) J_si = -H(u - theta_w) w s / tau_si
            drive_ws: self.slow_inward,
            v_inf: self.v_inf,
            v_rate: self.v_rate,
            w_inf: self.w_inf_0 + self.w_inf_1 * u,
            w_rate: self.w_closing + self.below * per_tau,
            s_inf: e_s * tau * inverse,
            s_rate: self.s_rate,
            // (34) k(V) = exp(-((V - 1) / sigma)^2 / 2) / (sigma sqrt(2 pi))
            bell: self.bell_height * exp(-(z * z)),
            c_0: self.c_0,
            epsilon_1: self.epsilon_1,
        }
    }
}

#[inline(always)]
fn saturated(x: f64) -> f64 {
    let x = if x > -SATURATED { x } else { -SATURATED };
    if x < SATURATED { x } else { SATURATED }
}

impl Side {
    /// (18) `du/dt = -(J_fi + J_so + J_si)` and stimulus.
    #[inline(always)]
    pub(super) fn u_rate(&self, &[_, v, w, s, ..]: &State) -> f64 {
        self.drive + self.drive_v * v + self.drive_ws * (w * s)
    }
}

impl Field for Branch {
    #[inline(always)]
    fn rates(&self, state: &State) -> State {
        self.at(state[0]).rates(state)
    }
}

impl Field for Side {
    /// Eqs. (18)-(21), (32), (33).
    #[inline(always)]
    fn rates(&self, state: &State) -> State {
        let &[_, v, w, s, ta_i, ta] = state;
        [
            self.u_rate(state),
            (self.v_inf - v) * self.v_rate,
            (self.w_inf - w) * self.w_rate,
            (self.s_inf - s) * self.s_rate,
            self.c_0 * (self.bell - ta_i),
            self.epsilon_1 * (ta_i - ta),
        ]
    }
}

/// Sliding along a switch at fixed `u`: `du/dt` points to the switch from both sides.
///
/// `filippov_1988`: the rates are the mixture of both sides' that keeps `u` on the
/// switch, `f = f_below + lambda (f_above - f_below)` with `lambda = f_below,u / (f_below,u -
/// f_above,u)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Sliding {
    pub(super) below: Side,
    pub(super) above: Side,
}

impl Sliding {
    /// How strongly each side holds the state on the switch, 1/ms. The state leaves upwards if the
    /// first is not above 0, downwards if the second is not.
    #[inline(always)]
    pub(super) fn holds(&self, state: &State) -> [f64; 2] {
        [-self.above.u_rate(state), self.below.u_rate(state)]
    }
}

impl Field for Sliding {
    #[inline(always)]
    fn rates(&self, state: &State) -> State {
        let (below, above) = (self.below.rates(state), self.above.rates(state));
        let lambda = below[0] / (below[0] - above[0]);
        let mixed = |i: usize| below[i] + lambda * (above[i] - below[i]);
        [0.0, mixed(1), mixed(2), mixed(3), mixed(4), mixed(5)]
    }
}

/// The constants of one cell, and its thresholds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::cell) struct Pieces {
    electrical: Electrical,
    tension: Tension,
    thresholds: [f64; 5],
    count: usize,
}

impl Pieces {
    pub(in crate::cell) fn new(electrical: Electrical, tension: Tension) -> Self {
        let Electrical { theta_v, theta_w, theta_v_minus, theta_o, .. } = electrical;
        let theta_tension = tension.u_rest + tension.x_2 * (tension.u_peak - tension.u_rest);
        let mut thresholds = [f64::INFINITY; 5];
        let acts = [
            (theta_v, true),
            (theta_w, true),
            (theta_v_minus, theta_v_minus < theta_v),
            (theta_o, theta_o < theta_w),
            (theta_tension, true),
        ];
        let mut count = 0;
        for (threshold, acts) in acts {
            if acts && !thresholds[..count].contains(&threshold) {
                thresholds[count] = threshold;
                count += 1;
            }
        }
        thresholds[..count].sort_by(f64::total_cmp);
        Self { electrical, tension, thresholds, count }
    }

    /// The thresholds of `u` in rising order; region `k` lies above `k` of them.
    pub(super) fn thresholds(&self) -> &[f64] {
        &self.thresholds[..self.count]
    }

    /// Lower and upper end of a region.
    pub(super) fn interval(&self, region: usize) -> [f64; 2] {
        let lower = if region == 0 { f64::NEG_INFINITY } else { self.thresholds[region - 1] };
        let upper = if region == self.count { f64::INFINITY } else { self.thresholds[region] };
        [lower, upper]
    }

    /// `x_3`, where `Ta_i` switches the rate of `Ta` in regions above `V = x_2`.
    pub(super) fn onset(&self) -> f64 {
        self.tension.x_3
    }

    /// Whether `V > x_2` in a region, so that `Ta_i` switches there.
    pub(super) fn switches_tension(&self, region: usize) -> bool {
        let Tension { u_rest, u_peak, x_2, .. } = self.tension;
        self.interval(region)[0] >= u_rest + x_2 * (u_peak - u_rest)
    }

    /// The constants of a region; `delayed` says that `Ta_i < x_3`.
    pub(super) fn branch(&self, region: usize, delayed: bool, stimulus: f64) -> Branch {
        let e = &self.electrical;
        let t = &self.tension;
        let lower = self.interval(region)[0];
        let [h_v, h_w, h_v_minus, h_o] =
            [e.theta_v, e.theta_w, e.theta_v_minus, e.theta_o].map(|theta| lower >= theta);
        let one_if = |condition: bool| if condition { 1.0 } else { 0.0 };
        let delayed = delayed && self.switches_tension(region);
        // (26) tau_w^- counts below theta_w, (27) tau_so above.
        let (tau_slope, tau_middle, tau_1, tau_2) = if h_w {
            (2.0 * e.k_so, e.u_so, e.tau_so1, e.tau_so2)
        } else {
            (2.0 * e.k_w_minus, e.u_w_minus, e.tau_w1_minus, e.tau_w2_minus)
        };
        // (31) w_inf = (1 - H(u - theta_o)) (1 - u / tau_winf) + H(u - theta_o) w_inf^*
        let (w_inf_0, w_inf_1) = match (h_w, h_o) {
            (true, _) => (0.0, 0.0),
            (false, true) => (e.w_inf_star, 0.0),
            (false, false) => (1.0, -1.0 / e.tau_winf),
        };
        let v_minus = if h_v_minus { (0.0, e.tau_v2_minus) } else { (1.0, e.tau_v1_minus) };
        let (v_inf, tau_v) = if h_v { (0.0, e.tau_v_plus) } else { v_minus };
        Branch {
            stimulus,
            fast_inward: one_if(h_v) / e.tau_fi,
            theta_v: e.theta_v,
            u_u: e.u_u,
            slow_inward: one_if(h_w) / e.tau_si,
            outward: one_if(!h_w) / if h_o { e.tau_o2 } else { e.tau_o1 },
            u_o: e.u_o,
            above: one_if(h_w),
            tau_slope,
            tau_middle,
            tau_1,
            tau_2,
            w_inf_0,
            w_inf_1,
            w_closing: one_if(h_w) / e.tau_w_plus,
            below: one_if(!h_w),
            v_inf,
            v_rate: 1.0 / tau_v,
            s_slope: 2.0 * e.k_s,
            s_middle: e.u_s,
            s_rate: 1.0 / if h_w { e.tau_s2 } else { e.tau_s1 },
            c_0: t.c_0,
            bell_height: 1.0 / (t.sigma * (2.0 * PI).sqrt()),
            bell_centre: t.u_peak,
            bell_scale: 1.0 / (std::f64::consts::SQRT_2 * t.sigma * (t.u_peak - t.u_rest)),
            epsilon_1: if delayed { t.x_1 } else { t.c_0 },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::bueno_orovio_2008::{self, Variant};
    use crate::cell::cell_model::CellModel as _;
    use crate::cell::coelho_2021;
    use crate::cell::description::Input;
    use crate::cell::minimal::MinimalModel;

    fn models() -> Vec<MinimalModel> {
        let sets = [Variant::Epi, Variant::Endo, Variant::M, Variant::Pb, Variant::Tnnp];
        sets.map(bueno_orovio_2008::model).into_iter().chain([coelho_2021::model()]).collect()
    }

    fn pieces(model: &MinimalModel) -> Pieces {
        Pieces::new(*model.electrical_constants(), *model.tension_constants())
    }

    #[test]
    fn every_branch_has_the_rates_of_the_equations_inside_its_region() {
        for model in models() {
            let pieces = pieces(&model);
            for step in 0..4000_u32 {
                // Weyl sequences: evenly spread, the same everywhere.
                let x = |golden: f64| (f64::from(step) * golden).fract();
                let u = 1.9 * x(0.618_033_988_7) - 0.3;
                let state =
                    [u, x(0.754_877_666), x(0.569_840_29), x(0.819_172_5), x(0.671_043), x(0.55)];
                let stimulus = 0.5 * x(0.31);
                let region = pieces.thresholds().iter().filter(|theta| **theta < u).count();
                let delayed = state[4] < pieces.onset();
                let rates = pieces.branch(region, delayed, stimulus).rates(&state);
                let mut expected = [0.0; 6];
                model.derivatives(&state, &Input { stimulus, ..Input::REST }, &mut expected);
                for k in 0..6 {
                    // Rounding of the terms, of which the fast inward current is the largest.
                    let bound = 1e-13 * (1.0 + expected[k].abs());
                    let difference = (rates[k] - expected[k]).abs();
                    assert!(difference < bound, "{} {k} at {u}: {difference:e}", model.name());
                }
            }
        }
    }

    #[test]
    fn switches_that_cannot_act_are_left_out() {
        let count = |model: MinimalModel| pieces(&model).thresholds().len();
        // coelho_2021: theta_v, theta_w and V = x_2; theta_o and theta_v_minus lie too high.
        assert_eq!(count(coelho_2021::model()), 3);
        assert_eq!(count(bueno_orovio_2008::model(Variant::Endo)), 5);
        // tnnp: theta_v_minus = theta_w.
        assert_eq!(count(bueno_orovio_2008::model(Variant::Tnnp)), 4);
        // epi: theta_v_minus = theta_o.
        assert_eq!(count(bueno_orovio_2008::model(Variant::Epi)), 4);
    }

    #[test]
    fn sliding_is_the_mixture_that_keeps_the_potential() {
        let model = coelho_2021::model();
        let u = pieces(&model).thresholds()[0];
        let [below, above] = [0, 1].map(|region| pieces(&model).branch(region, true, 0.0).at(u));
        let sliding = Sliding { below, above };
        let state = [u, 0.9, 0.8, 0.02, 0.01, 0.005];
        let (f_below, f_above, mixed) =
            (below.rates(&state), above.rates(&state), sliding.rates(&state));
        assert!(sliding.holds(&state).iter().all(|held| *held > 0.0));
        let lambda = (mixed[2] - f_below[2]) / (f_above[2] - f_below[2]);
        assert!((f_below[0] + lambda * (f_above[0] - f_below[0])).abs() < 1e-14);
        assert_eq!(mixed[0], 0.0);
    }
}
