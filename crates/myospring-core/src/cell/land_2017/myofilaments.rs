//! The six equations of `land_2017`.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::parameters::parameters;
use crate::cell::description::{ModelError, StateVariable, required};
use crate::cell::number::Number;
use crate::parameter::ParameterSet;
use std::borrow::Cow;

/// Number of state variables; their order is that of [`states`].
pub const STATES: usize = 6;

/// Number of constants in [`Myofilaments`].
pub(in crate::cell) const NUMBERS: usize = 19;

/// Stretch beyond which overlap and calcium affinity are constant.
const LONGEST: f64 = 1.2;
/// Stretch below which thin filaments overlap twice.
const DOUBLE_OVERLAP: f64 = 0.87;
/// Upper bound of `C^(-n_Tm/2)`, which diverges as calcium leaves troponin.
const MOST_BLOCKING: f64 = 100.0;
/// Part of strongly bound crossbridges at which the published distortion was measured.
const REFERENCE_STRONG: f64 = 0.25;

/// The state variables with these initial values.
pub fn states(start: [f64; STATES]) -> Vec<StateVariable> {
    const NAMES: [(&str, &str); STATES] = [
        ("XS", "part of crossbridges bound strongly"),
        ("XW", "part of crossbridges bound weakly"),
        ("CaTRPN", "part of troponin with calcium bound"),
        ("TmB", "part of binding sites blocked by tropomyosin"),
        ("zeta_s", "distortion of strongly bound crossbridges"),
        ("zeta_w", "distortion of weakly bound crossbridges"),
    ];
    let state = |((name, meaning), start): (&(&'static str, &'static str), f64)| StateVariable {
        name: Cow::Borrowed(*name),
        unit: Cow::Borrowed(""),
        start,
        meaning: Cow::Borrowed(*meaning),
    };
    NAMES.iter().zip(start).map(state).collect()
}

/// The myofilaments of `land_2017` as functions of their state, calcium, stretch and its rate.
///
/// States are in the order of [`states`]; calcium is in uM, rates are per ms.
///
/// # Example
/// ```
/// use myospring::cell::land_2017::Myofilaments;
/// let myofilaments = Myofilaments::published();
/// let held = |stretch| myofilaments.tension(&myofilaments.steady(100.0, stretch), stretch);
/// // Full activation at resting length and 10 % longer.
/// assert!((held(1.0) - 107.3).abs() < 0.1 && (held(1.1) - 132.0).abs() < 0.1);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Myofilaments<C = f64> {
    k_trpn: C,
    n_trpn: C,
    ca50_ref: C,
    k_u: C,
    n_tm: C,
    k_uw: C,
    k_ws: C,
    r_s: C,
    gamma_s: C,
    gamma_w: C,
    beta_0: C,
    beta_1: C,
    t_ref: C,
    // Derived constants.
    k_b: C,
    k_wu: C,
    k_su: C,
    a: C,
    c_s: C,
    c_w: C,
}

impl Myofilaments {
    /// The myofilaments with the published parameters ([`parameters`]).
    pub fn published() -> Self {
        match Self::new("land_2017", &parameters()) {
            Ok(myofilaments) => myofilaments,
            Err(error) => unreachable!("published set: {error}"),
        }
    }

    /// Reads the constants by name.
    ///
    /// # Errors
    /// A parameter is missing, or no crossbridges would be unbound.
    pub fn new(model: &str, parameters: &ParameterSet) -> Result<Self, ModelError> {
        let read = |name| required(model, parameters, name);
        let [k_u, n_tm, trpn50] = [read("k_u")?, read("n_Tm")?, read("TRPN50")?];
        let [k_uw, k_ws, r_w, r_s] = [read("k_uw")?, read("k_ws")?, read("r_w")?, read("r_s")?];
        let [phi, a_tot] = [read("phi")?, read("A_tot")?];
        let weak = (1.0 - r_s) * r_w;
        let unbound = 1.0 - r_s - weak;
        // k_wu = k_uw (1/r_w - 1) - k_ws
        let k_wu = k_uw * (1.0 / r_w - 1.0) - k_ws;
        if k_wu < 0.0 {
            let most = k_uw * (1.0 / r_w - 1.0);
            return Err(ModelError::Contradiction {
                model: model.to_owned(),
                reason: format!(
                    "k_ws = {k_ws} 1/ms must be at most k_uw (1/r_w - 1) = {most} 1/ms, or weakly bound \
                     crossbridges would let go at a rate below 0"
                ),
            });
        }
        Ok(Self {
            k_trpn: read("k_TRPN")?,
            n_trpn: read("n_TRPN")?,
            ca50_ref: read("Ca50_ref")?,
            k_u,
            n_tm,
            k_uw,
            k_ws,
            r_s,
            gamma_s: read("gamma_s")?,
            gamma_w: read("gamma_w")?,
            beta_0: read("beta_0")?,
            beta_1: read("beta_1")?,
            t_ref: read("T_ref")?,
            // k_b = k_u TRPN50^n_Tm / (1 - r_s - (1 - r_s) r_w)
            k_b: k_u * trpn50.powf(n_tm) / unbound,
            k_wu,
            // k_su = k_ws r_w (1/r_s - 1)
            k_su: k_ws * r_w * (1.0 / r_s - 1.0),
            // A = 0.25 A_tot / ((1 - r_s) r_w + r_s) r_s / 0.25
            a: REFERENCE_STRONG * a_tot / (weak + r_s) * (r_s / REFERENCE_STRONG),
            // c_w = phi k_uw (1 - r_s)(1 - r_w) / ((1 - r_s) r_w), c_s = phi k_ws (1 - r_s) r_w / r_s
            c_w: phi * k_uw * unbound / weak,
            c_s: phi * k_ws * weak / r_s,
        })
    }

    /// Rates of the six states, 1/ms, at a calcium in uM, a stretch (length over resting length)
    /// and its rate in 1/ms. The third is the rate of calcium binding to troponin (as a part of
    /// troponin), which a cell's calcium balance must subtract.
    pub fn rates(
        &self,
        state: &[f64; STATES],
        calcium_um: f64,
        stretch: f64,
        stretch_rate: f64,
    ) -> [f64; STATES] {
        self.rates_of(state, calcium_um, stretch, stretch_rate)
    }

    /// Active tension at a stretch, kPa.
    pub fn tension(&self, state: &[f64; STATES], stretch: f64) -> f64 {
        // Ta = h(lambda) T_ref / r_s ((zeta_s + 1) XS + zeta_w XW)
        let [xs, xw, _, _, zeta_s, zeta_w] = *state;
        self.overlap(stretch) * self.t_ref / self.r_s * ((zeta_s + 1.0) * xs + zeta_w * xw)
    }

    /// Derivative of the tension with respect to an instantaneous stretch, kPa: through the overlap
    /// and the full distortion of the crossbridges ([`Myofilaments::distortion_per_stretch`]).
    pub fn instantaneous_stiffness(&self, state: &[f64; STATES], stretch: f64) -> f64 {
        let [xs, xw, _, _, zeta_s, zeta_w] = *state;
        let bound = (zeta_s + 1.0) * xs + zeta_w * xw;
        let distorted = self.overlap(stretch) * self.a * (xs + xw);
        self.t_ref / self.r_s * (self.overlap_slope(stretch) * bound + distorted)
    }

    /// Distortion of the crossbridges per instantaneous change of stretch: `A`.
    pub fn distortion_per_stretch(&self) -> f64 {
        self.a
    }

    /// The steady state at constant calcium (uM) and stretch.
    pub fn steady(&self, calcium_um: f64, stretch: f64) -> [f64; STATES] {
        let binding = self.binding(calcium_um, stretch);
        let c = binding / (1.0 + binding);
        let [block, free] = self.blocking(c);
        // Parts of the crossbridges relative to those unbound; without calcium all sites are
        // blocked.
        let weak = self.k_uw / (self.k_wu + self.k_ws);
        let strong = weak * self.k_ws / self.k_su;
        let unbound = free / (free * (1.0 + weak + strong) + block);
        let blocked = block / (free * (1.0 + weak + strong) + block);
        [strong * unbound, weak * unbound, c, blocked, 0.0, 0.0]
    }

    /// `h(lambda) = max(0, 1 + beta_0 (lambda + min(0.87, lambda) - 1.87))`, with lambda at most 1.2.
    fn overlap(&self, stretch: f64) -> f64 {
        let length = stretch.min(LONGEST);
        let both = length + length.min(DOUBLE_OVERLAP) - 1.0 - DOUBLE_OVERLAP;
        (1.0 + self.beta_0 * both).max(0.0)
    }

    fn overlap_slope(&self, stretch: f64) -> f64 {
        if stretch > LONGEST || self.overlap(stretch) == 0.0 {
            0.0
        } else if stretch > DOUBLE_OVERLAP {
            self.beta_0
        } else {
            2.0 * self.beta_0
        }
    }
}

impl<C: Copy> Myofilaments<C> {
    /// These constants as an array, in an internal order.
    #[inline(always)]
    pub(in crate::cell) fn numbers(&self) -> [C; NUMBERS] {
        let Self { k_trpn, n_trpn, ca50_ref, k_u, n_tm, k_uw, k_ws, r_s, gamma_s, gamma_w, .. } =
            *self;
        let Self { beta_0, beta_1, t_ref, k_b, k_wu, k_su, a, c_s, c_w, .. } = *self;
        [
            k_trpn, n_trpn, ca50_ref, k_u, n_tm, k_uw, k_ws, r_s, gamma_s, gamma_w, beta_0, beta_1,
            t_ref, k_b, k_wu, k_su, a, c_s, c_w,
        ]
    }

    /// The myofilaments from constants in that order.
    #[inline(always)]
    pub(in crate::cell) fn of_numbers(numbers: [C; NUMBERS]) -> Self {
        let [k_trpn, n_trpn, ca50_ref, k_u, n_tm, k_uw, k_ws, r_s, gamma_s, gamma_w, ..] = numbers;
        let [.., beta_0, beta_1, t_ref, k_b, k_wu, k_su, a, c_s, c_w] = numbers;
        #[rustfmt::skip]
        let all = Self {
            k_trpn, n_trpn, ca50_ref, k_u, n_tm, k_uw, k_ws, r_s, gamma_s, gamma_w, beta_0, beta_1,
            t_ref, k_b, k_wu, k_su, a, c_s, c_w,
        };
        all
    }
}

impl<C: Number> Myofilaments<C> {
    /// [`Myofilaments::rates`] for any number type with these constants.
    #[inline(always)]
    pub(in crate::cell) fn rates_of<T: Number<Constant = C>>(
        &self,
        state: &[T; STATES],
        calcium_um: T,
        stretch: C,
        stretch_rate: C,
    ) -> [T; STATES] {
        let of = T::constant;
        let [xs, xw, c, b, zeta_s, zeta_w] = *state;
        let xu = -b - xw - xs + 1.0;
        // dXS/dt = k_ws XW - k_su XS - gamma_s g(zeta_s) XS
        let torn = zeta_s.positive() + (-zeta_s - 1.0).positive();
        let strong = of(self.k_ws) * xw - of(self.k_su) * xs - of(self.gamma_s) * torn * xs;
        // dXW/dt = k_uw XU - k_wu XW - k_ws XW - gamma_w |zeta_w| XW
        let torn = zeta_w.magnitude();
        let weak =
            of(self.k_uw) * xu - of(self.k_wu + self.k_ws) * xw - of(self.gamma_w) * torn * xw;
        // dC/dt = k_TRPN ((Ca/Ca50)^n_TRPN (1 - C) - C)
        let binding = self.binding(calcium_um, stretch);
        let troponin = of(self.k_trpn) * (binding * c.rest() - c);
        // dB/dt = k_b min(100, C^(-n_Tm/2)) XU - k_u C^(n_Tm/2) B
        let [block, free] = self.blocking(c);
        let blocked = block * xu - free * b;
        // d zeta/dt = A d lambda/dt - c zeta
        let pulled = of(self.a * stretch_rate);
        let [zeta_s, zeta_w] = [of(self.c_s) * zeta_s, of(self.c_w) * zeta_w];
        [strong, weak, troponin, blocked, pulled - zeta_s, pulled - zeta_w]
    }

    /// `(Ca/Ca50(lambda))^n_TRPN`, with `Ca50 = Ca50_ref + beta_1 min(0.2, lambda - 1)`.
    #[inline(always)]
    fn binding<T: Number<Constant = C>>(&self, calcium_um: T, stretch: C) -> T {
        let longest = stretch.at_least(LONGEST, C::of(LONGEST), stretch);
        let ca50 = self.ca50_ref + self.beta_1 * (longest - 1.0);
        ((calcium_um / T::constant(ca50)).ln() * T::constant(self.n_trpn)).exp()
    }

    /// Rates at which sites are blocked and set free with a part `c` of troponin filled, 1/ms.
    #[inline(always)]
    fn blocking<T: Number<Constant = C>>(&self, c: T) -> [T; 2] {
        let power = (c.positive().ln() * T::constant(self.n_tm * 0.5)).exp();
        let most = T::of(MOST_BLOCKING);
        let times = power.at_least(1.0 / MOST_BLOCKING, power.inverse(), most);
        [T::constant(self.k_b) * times, T::constant(self.k_u) * power]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A state in which every term counts.
    const SOMEWHERE: [f64; STATES] = [0.03, 0.05, 0.4, 0.8, 0.1, -0.2];

    #[test]
    fn rates_and_tension_are_those_of_an_independent_program() {
        let myofilaments = Myofilaments::published();
        let rates = myofilaments.rates(&SOMEWHERE, 0.4, 0.95, -2e-4);
        let expected =
            [3.45e-5, 6.59e-3, -0.028_780_131_48, -0.004_595_447_061, -0.006_014, 0.079_172];
        for (rate, expected) in rates.iter().zip(expected) {
            // Half of the last digit printed.
            assert!((rate - expected).abs() < 5e-12, "{rates:?}");
        }
        let tension = myofilaments.tension(&SOMEWHERE, 0.95);
        assert!((tension - 9.7704).abs() < 5e-5, "{tension} kPa");
    }

    #[test]
    fn steady_tension_follows_calcium_as_in_an_independent_program_at_three_lengths() {
        let myofilaments = Myofilaments::published();
        for (stretch, most, half, hill) in
            [(0.9, 82.63, 0.7097, 3.06), (1.0, 107.32, 0.5469, 3.04), (1.1, 132.02, 0.3836, 3.04)]
        {
            let held =
                |calcium| myofilaments.tension(&myofilaments.steady(calcium, stretch), stretch);
            let highest = held(30.0);
            let calcium_at = |part: f64| {
                let (mut low, mut high): (f64, f64) = (1e-3, 30.0);
                for _ in 0..100 {
                    let middle = 0.5 * (low + high);
                    if held(middle) < part * highest { low = middle } else { high = middle }
                }
                low
            };
            assert!((highest - most).abs() < 5e-3, "{stretch}: {highest} kPa");
            // That program read both off a grid of calcium; a third agrees with it to 0.1 % and 0.04.
            let found = calcium_at(0.5);
            assert!((found / half - 1.0).abs() < 1e-3, "{stretch}: {found} uM");
            let found = 9_f64.ln() / (calcium_at(0.75) / calcium_at(0.25)).ln();
            assert!((found - hill).abs() < 0.03, "{stretch}: {found}");
        }
    }

    #[test]
    fn the_steady_state_stays() {
        let myofilaments = Myofilaments::published();
        for calcium in [0.0, 1e-3, 0.07, 0.6, 10.0] {
            let state = myofilaments.steady(calcium, 1.05);
            let rates = myofilaments.rates(&state, calcium, 1.05, 0.0);
            // Rounding of rates of up to 15 per ms.
            assert!(rates.iter().all(|rate| rate.abs() < 1e-14), "{calcium} uM: {rates:?}");
        }
    }

    /// Tension at resting length while it changes at a steady rate, lengths per s.
    fn moving(myofilaments: &Myofilaments, calcium: f64, rate_per_s: f64) -> f64 {
        let mut state = myofilaments.steady(calcium, 1.0);
        let step = 0.5;
        for _ in 0..8000 {
            let rates =
                |state: &[f64; STATES]| myofilaments.rates(state, calcium, 1.0, 1e-3 * rate_per_s);
            let first = rates(&state);
            let middle = std::array::from_fn(|i| state[i] + 0.5 * step * first[i]);
            let second = rates(&middle);
            state = std::array::from_fn(|i| state[i] + step * second[i]);
        }
        myofilaments.tension(&state, 1.0)
    }

    #[test]
    fn tension_falls_with_the_rate_of_shortening_as_published() {
        let myofilaments = Myofilaments::published();
        let still = moving(&myofilaments, 1.0, 0.0);
        for (rate, part) in [(0.1, 0.967), (0.5, 0.839), (1.0, 0.684), (2.0, 0.393), (3.0, 0.125)] {
            let found = moving(&myofilaments, 1.0, -rate) / still;
            assert!((found - part).abs() < 5e-4, "{rate} lengths/s: {found}");
        }
        for calcium in [0.6, 1.0, 3.0] {
            let (mut slow, mut fast) = (3.0, 4.0);
            for _ in 0..20 {
                let middle = 0.5 * (slow + fast);
                if moving(&myofilaments, calcium, -middle) > 0.0 {
                    slow = middle;
                } else {
                    fast = middle;
                }
            }
            assert!((slow - 3.495).abs() < 5e-4, "{calcium} uM: {slow} lengths/s");
        }
    }

    #[test]
    fn instantaneous_stiffness_is_the_difference_that_a_jump_makes() {
        let myofilaments = Myofilaments::published();
        for stretch in [0.5, 0.8, 0.95, 1.1, 1.3] {
            let after = |by: f64| {
                let mut state = SOMEWHERE;
                for zeta in [4, 5] {
                    state[zeta] += myofilaments.distortion_per_stretch() * by;
                }
                myofilaments.tension(&state, stretch + by)
            };
            let difference = (after(1e-6) - after(-1e-6)) / 2e-6;
            let found = myofilaments.instantaneous_stiffness(&SOMEWHERE, stretch);
            assert!((found - difference).abs() < 1e-6 * (1.0 + difference), "{stretch}");
        }
    }

    #[test]
    fn rates_that_contradict_each_other_are_refused() {
        let mut set = parameters();
        set.set("k_ws", 0.2).unwrap();
        let error = Myofilaments::new("land_2017", &set).unwrap_err().to_string();
        assert!(
            error.contains("k_ws = 0.2 1/ms must be at most k_uw (1/r_w - 1) = 0.182"),
            "{error}"
        );
    }
}
