//! Active tension from the action potential: Eqs. (32)-(35) of `coelho_2021`, after `silva_2020`.
//!
//! Two variables follow the normalised potential `V = (u - u_rest) / (u_peak - u_rest)`, which is
//! not clamped. The authors normalise by the extremes of the whole run, which needs the future;
//! here both are constants of the model. `k(V)` is a narrow bell around `V = 1`, so tension depends
//! on them sharply: `u_peak` lower by 0.003 % raises the peak of `Ta` by about 0.09 %. So changing
//! `u_peak`, or the height of the upstroke, changes the strength of the cell.

pub mod lag;
mod step;
pub mod train;

pub use step::Rates;

use super::description::{ModelError, required};
use super::exponential;
use crate::parameter::{Parameter, ParameterSet};
use std::f64::consts::PI;

/// Name, unit, smallest, largest, meaning of each tension parameter.
type Row = (&'static str, &'static str, [f64; 2], &'static str);

const ROWS: [Row; 7] = [
    ("c_0", "1/ms", [1e-6, 10.0], "rate of both tension variables"),
    ("x_1", "1/ms", [0.0, 10.0], "rate of Ta while V > x_2 and Ta_i < x_3"),
    ("x_2", "", [-10.0, 10.0], "normalised potential above which the onset of Ta is delayed"),
    ("x_3", "", [0.0, 100.0], "Ta_i below which the onset of Ta is delayed"),
    ("sigma", "", [1e-3, 10.0], "width of the bell k(V)"),
    ("u_rest", "", [-10.0, 10.0], "potential u at which V = 0"),
    ("u_peak", "", [-10.0, 10.0], "potential u at which V = 1"),
];

/// Rows for a model that drives the published tension equations.
///
/// `u_rest` and `u_peak` are the potential at rest and at the peak of a beat, with their source.
pub(super) fn rows(u_rest: f64, u_peak: f64, source: &'static str) -> Vec<Parameter> {
    const TABLE: &str = "coelho_2021, Table 1";
    let values = [
        (0.0166016, TABLE),
        (0.0001, TABLE),
        (0.78, TABLE),
        (0.2925, TABLE),
        (0.046875, "coelho_2021, the first author's public source code (missing in Table 1)"),
        (u_rest, source),
        (u_peak, source),
    ];
    ROWS.iter()
        .zip(values)
        .map(|(&(name, unit, range, meaning), (value, source))| {
            Parameter::new(name, value, unit, range, meaning, source)
        })
        .collect()
}

/// The constants of Eqs. (32)-(35), read once from a parameter set.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tension {
    pub(super) c_0: f64,
    pub(super) x_1: f64,
    pub(super) x_2: f64,
    pub(super) x_3: f64,
    pub(super) sigma: f64,
    pub(super) u_rest: f64,
    pub(super) u_peak: f64,
}

impl Tension {
    /// Reads the constants by name.
    ///
    /// # Errors
    /// A parameter is missing, or `u_peak` is not above `u_rest`.
    pub fn new(model: &str, parameters: &ParameterSet) -> Result<Self, ModelError> {
        let read = |name| required(model, parameters, name);
        let (u_rest, u_peak) = (read("u_rest")?, read("u_peak")?);
        if u_peak <= u_rest {
            return Err(ModelError::Contradiction {
                model: model.to_owned(),
                reason: format!("u_peak = {u_peak} must be above u_rest = {u_rest}"),
            });
        }
        Ok(Self {
            c_0: read("c_0")?,
            x_1: read("x_1")?,
            x_2: read("x_2")?,
            x_3: read("x_3")?,
            sigma: read("sigma")?,
            u_rest,
            u_peak,
        })
    }

    /// The potential that drives tension, `V = (u - u_rest) / (u_peak - u_rest)`; not clamped.
    pub fn normalised_potential(&self, u: f64) -> f64 {
        (u - self.u_rest) / (self.u_peak - self.u_rest)
    }

    /// `x_2`: the normalised potential above which the onset of `Ta` is delayed.
    pub fn delayed_above(&self) -> f64 {
        self.x_2
    }

    /// `d(Ta_i)/dt` and `d(Ta)/dt`, 1/ms, from potential `u` and both tension variables.
    ///
    /// Source: `coelho_2021`, Eqs. (32)-(35).
    #[inline(always)]
    #[allow(
        clippy::inline_always,
        reason = "a call in a vectorised loop would lose the vector units"
    )]
    pub fn rates(&self, u: f64, ta_i: f64, ta: f64) -> [f64; 2] {
        let Self { c_0, x_1, x_2, x_3, sigma, u_rest, u_peak } = *self;
        // A loop over cells makes the quotients of constants once.
        let v = (u - u_rest) * (1.0 / (u_peak - u_rest));
        // (34) k(V) = exp(-((V - 1) / sigma)^2 / 2) / (sigma sqrt(2 pi))
        let z = (v - 1.0) * (1.0 / sigma);
        let k = exponential::exp(-0.5 * z * z) * (1.0 / (sigma * (2.0 * PI).sqrt()));
        // (35) epsilon_1 = x_1 if V > x_2 and Ta_i < x_3, else c_0
        let epsilon_1 = if v > x_2 && ta_i < x_3 { x_1 } else { c_0 };
        // (32) d(Ta_i)/dt = c_0 (k(V) - Ta_i)
        let ta_i_rate = c_0 * (k - ta_i);
        // (33) d(Ta)/dt = epsilon_1 (Ta_i - Ta)
        let ta_rate = epsilon_1 * (ta_i - ta);
        [ta_i_rate, ta_rate]
    }
}
