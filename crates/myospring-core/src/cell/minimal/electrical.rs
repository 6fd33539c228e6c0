//! The electrical half of the minimal model: Eqs. (18)-(31) and their 28 parameters.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use crate::cell::description::{ModelError, required};
use crate::cell::exponential;
use crate::parameter::{Parameter, ParameterSet};

/// Heaviside step with `H(0) = 1/2`.
#[inline(always)]
fn heaviside(x: f64) -> f64 {
    let at_or_below = if x < 0.0 { 0.0 } else { 0.5 };
    if x > 0.0 { 1.0 } else { at_or_below }
}

/// `(1 + tanh(x)) / 2`, as `1 / (1 + exp(-2 x))`, which is the same and takes half the time.
#[inline(always)]
fn rise(x: f64) -> f64 {
    1.0 / (1.0 + exponential::exp(-2.0 * x))
}

/// `1 / ((1 - H(x)) first + H(x) second)`. None of the three divisions depends on `x`, so a loop over cells makes them once.
#[inline(always)]
fn one_over_step(x: f64, first: f64, second: f64) -> f64 {
    let at_or_below = if x < 0.0 { 1.0 / first } else { 1.0 / (0.5 * (first + second)) };
    if x > 0.0 { 1.0 / second } else { at_or_below }
}

/// `1 / (first + (second - first) (1 + tanh(x)) / 2)` with one division: `(1 + e) / (first e + second)` with `e = exp(-2 x)`.
#[inline(always)]
fn one_over_rise(x: f64, first: f64, second: f64) -> f64 {
    // A larger exponent changes nothing, and its exponential times a time constant could overflow.
    let exponent = if x > -150.0 { -2.0 * x } else { 300.0 };
    let e = exponential::exp(exponent);
    (1.0 + e) / (first * e + second)
}

/// Kind of quantity, for unit and range.
#[derive(Clone, Copy)]
enum Kind {
    /// A value of `u` or of a gate.
    Level,
    /// A time constant, ms.
    Time,
    /// A steepness against `u`.
    Slope,
    /// A pure number that divides.
    Divisor,
}

impl Kind {
    const fn unit_and_range(self) -> (&'static str, [f64; 2]) {
        match self {
            Self::Level => ("", [-10.0, 10.0]),
            Self::Time => ("ms", [1e-3, 1e6]),
            Self::Slope => ("", [0.0, 1e4]),
            Self::Divisor => ("", [1e-6, 1e3]),
        }
    }
}

/// Makes the struct of constants, the table of rows and the reader from one list of names.
macro_rules! electrical {
    ($($name:ident, $kind:ident, $meaning:literal;)*) => {
        /// The constants of Eqs. (18)-(31), read once from a parameter set.
        #[derive(Debug, Clone, Copy, PartialEq)]
        pub struct Electrical {
            $(pub(in crate::cell) $name: f64,)*
        }

        const ROWS: &[(&str, Kind, &str)] = &[$((stringify!($name), Kind::$kind, $meaning),)*];

        impl Electrical {
            /// Reads the constants by name.
            ///
            /// # Errors
            /// A parameter is missing.
            pub fn new(model: &str, parameters: &ParameterSet) -> Result<Self, ModelError> {
                Ok(Self {
                    $($name: required(model, parameters, stringify!($name))?,)*
                })
            }
        }
    };
}

electrical! {
    u_o, Level, "reversal potential of the outward current below theta_w";
    u_u, Level, "upper zero of the fast inward current";
    theta_v, Level, "threshold of the fast inward current";
    theta_w, Level, "threshold of the slow inward current and of repolarisation";
    theta_v_minus, Level, "threshold of v's recovery";
    theta_o, Level, "threshold of the resting outward current and of w's recovery";
    tau_v1_minus, Time, "time constant of v opening below theta_v_minus";
    tau_v2_minus, Time, "time constant of v above theta_v_minus";
    tau_v_plus, Time, "time constant of v closing";
    tau_w1_minus, Time, "time constant of w opening, low u";
    tau_w2_minus, Time, "time constant of w opening, high u";
    k_w_minus, Slope, "steepness between tau_w1_minus and tau_w2_minus";
    u_w_minus, Level, "u half way between tau_w1_minus and tau_w2_minus";
    tau_w_plus, Time, "time constant of w closing";
    tau_fi, Time, "time constant of the fast inward current";
    tau_o1, Time, "time constant of the outward current below theta_o";
    tau_o2, Time, "time constant of the outward current above theta_o";
    tau_so1, Time, "time constant of repolarisation, low u";
    tau_so2, Time, "time constant of repolarisation, high u";
    k_so, Slope, "steepness between tau_so1 and tau_so2";
    u_so, Level, "u half way between tau_so1 and tau_so2";
    tau_s1, Time, "time constant of s below theta_w";
    tau_s2, Time, "time constant of s above theta_w";
    k_s, Slope, "steepness of the steady state of s";
    u_s, Level, "u at which the steady state of s is 1/2";
    tau_si, Time, "time constant of the slow inward current";
    tau_winf, Divisor, "slope of the steady state of w below theta_o";
    w_inf_star, Level, "steady state of w above theta_o";
}

/// The 28 rows from values in the order of the table above; each value carries its name.
///
/// # Panics
/// If the names differ from the table: a slip in our data, not in any input.
pub(in crate::cell) fn rows(values: &[(&'static str, f64, &'static str)]) -> Vec<Parameter> {
    assert_eq!(values.len(), ROWS.len(), "number of electrical parameters");
    ROWS.iter()
        .zip(values)
        .map(|(&(name, kind, meaning), &(given, value, source))| {
            assert_eq!(name, given, "order of electrical parameters");
            let (unit, range) = kind.unit_and_range();
            Parameter::new(name, value, unit, range, meaning, source)
        })
        .collect()
}

impl Electrical {
    /// `du/dt`, `dv/dt`, `dw/dt`, `ds/dt`, 1/ms, without stimulus.
    ///
    /// Source: `bueno_orovio_2008`, printed as `coelho_2021`, Eqs. (18)-(31). A loop over cells makes the quotients of constants once.
    #[inline(always)]
    pub fn rates(&self, u: f64, v: f64, w: f64, s: f64) -> [f64; 4] {
        let Self { u_o, u_u, theta_v, theta_w, theta_v_minus, theta_o, .. } = *self;
        let Self { tau_v1_minus, tau_v2_minus, tau_v_plus, .. } = *self;
        let Self { tau_w1_minus, tau_w2_minus, k_w_minus, u_w_minus, tau_w_plus, .. } = *self;
        let Self { tau_fi, tau_o1, tau_o2, tau_so1, tau_so2, k_so, u_so, .. } = *self;
        let Self { tau_s1, tau_s2, k_s, u_s, tau_si, tau_winf, w_inf_star, .. } = *self;

        let h_v = heaviside(u - theta_v);
        let h_w = heaviside(u - theta_w);
        let h_o = heaviside(u - theta_o);

        // (25) tau_v^- = (1 - H(u - theta_v^-)) tau_v1^- + H(u - theta_v^-) tau_v2^-
        let per_tau_v_minus = one_over_step(u - theta_v_minus, tau_v1_minus, tau_v2_minus);
        // (28) tau_s = (1 - H(u - theta_w)) tau_s1 + H(u - theta_w) tau_s2
        let per_tau_s = one_over_step(u - theta_w, tau_s1, tau_s2);
        // (30) v_inf = 1 if u < theta_v^-, else 0
        let v_inf = if u < theta_v_minus { 1.0 } else { 0.0 };

        // (22) J_fi = -v H(u - theta_v) (u - theta_v) (u_u - u) / tau_fi
        let j_fi = -v * h_v * (u - theta_v) * (u_u - u) * (1.0 / tau_fi);
        // (26) tau_w^- = tau_w1^- + (tau_w2^- - tau_w1^-) (1 + tanh(k_w^- (u - u_w^-))) / 2
        let per_tau_w_minus =
            one_over_rise(k_w_minus * (u - u_w_minus), tau_w1_minus, tau_w2_minus);
        // (29) tau_o = (1 - H(u - theta_o)) tau_o1 + H(u - theta_o) tau_o2
        let per_tau_o = one_over_step(u - theta_o, tau_o1, tau_o2);
        // (31) w_inf = (1 - H(u - theta_o)) (1 - u / tau_winf) + H(u - theta_o) w_inf^*
        let w_inf = (1.0 - h_o) * (1.0 - u * (1.0 / tau_winf)) + h_o * w_inf_star;
        // (27) tau_so = tau_so1 + (tau_so2 - tau_so1) (1 + tanh(k_so (u - u_so))) / 2
        let per_tau_so = one_over_rise(k_so * (u - u_so), tau_so1, tau_so2);
        // (23) J_so = (u - u_o) (1 - H(u - theta_w)) / tau_o + H(u - theta_w) / tau_so
        let j_so = (u - u_o) * (1.0 - h_w) * per_tau_o + h_w * per_tau_so;
        // (24) J_si = -H(u - theta_w) w s / tau_si
        let j_si = -h_w * w * s * (1.0 / tau_si);
        // (20) dw/dt = (1 - H(u - theta_w)) (w_inf - w) / tau_w^- - H(u - theta_w) w / tau_w^+
        let w_rate = (1.0 - h_w) * (w_inf - w) * per_tau_w_minus - h_w * w * (1.0 / tau_w_plus);

        // (18) du/dt = -(J_fi + J_so + J_si)
        let u_rate = -(j_fi + j_so + j_si);
        // (19) dv/dt = (1 - H(u - theta_v)) (v_inf - v) / tau_v^- - H(u - theta_v) v / tau_v^+
        let v_rate = (1.0 - h_v) * (v_inf - v) * per_tau_v_minus - h_v * v * (1.0 / tau_v_plus);
        // (21) ds/dt = ((1 + tanh(k_s (u - u_s))) / 2 - s) / tau_s
        let s_rate = (rise(k_s * (u - u_s)) - s) * per_tau_s;
        [u_rate, v_rate, w_rate, s_rate]
    }
}

#[cfg(test)]
mod tests {
    use super::{heaviside, one_over_rise, one_over_step, rise};

    #[test]
    #[allow(clippy::manual_midpoint, reason = "as the paper writes it")]
    fn a_rise_is_that_of_the_paper() {
        for x in [-800.0, -20.0, -1.0, -1e-9, 0.0, 0.3, 2.0, 20.0, 800.0f64] {
            let printed = (1.0 + x.tanh()) / 2.0;
            assert!((rise(x) - printed).abs() <= f64::EPSILON, "{x}: {} {printed}", rise(x));
        }
    }

    #[test]
    #[allow(clippy::manual_midpoint, reason = "as the paper writes it")]
    fn time_constants_are_those_of_the_paper() {
        for (first, second) in [(60.0, 15.0), (6.0, 6.0), (1e-3, 1e6), (1e6, 1e-3)] {
            for x in [-1e5, -800.0, -151.0, -20.0, -1.0, 0.0, 0.3, 2.0, 20.0, 800.0, 1e5f64] {
                let risen = first + (second - first) * (1.0 + x.tanh()) / 2.0;
                let off = one_over_rise(x, first, second) * risen - 1.0;
                // Printed so, small time constants are differences of large ones.
                let rounding = 4.0 * f64::EPSILON * first.max(second) / risen;
                assert!(off.abs() <= rounding, "{x} {first} {second}: {off}");
                let stepped = (1.0 - heaviside(x)) * first + heaviside(x) * second;
                assert_eq!(one_over_step(x, first, second), 1.0 / stepped);
            }
        }
    }

    #[test]
    fn the_step_is_one_half_at_zero() {
        assert_eq!(
            [heaviside(-1e-300), heaviside(0.0), heaviside(-0.0), heaviside(1e-300)],
            [0.0, 0.5, 0.5, 1.0]
        );
    }
}
