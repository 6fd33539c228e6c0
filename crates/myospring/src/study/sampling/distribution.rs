//! Distributions of parameter values.

use super::error::SamplingError;
use serde::{Deserialize, Serialize};
use statrs::distribution::{ContinuousCDF, Normal};

/// Ends of a grid on a distribution without ends: 95 % of its values lie within.
const ENDS: [f64; 2] = [0.025, 0.975];

/// The distribution of a parameter.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(tag = "distribution", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Distribution {
    /// A constant.
    Fixed {
        /// Its value.
        value: f64,
    },
    /// Every value from `low` to `high` is equally likely.
    Uniform {
        /// Least.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// Every factor is equally likely: the logarithm is uniform.
    LogUniform {
        /// Least, above 0.
        low: f64,
        /// Largest.
        high: f64,
    },
    /// The normal distribution.
    Normal {
        /// Its mean.
        mean: f64,
        /// Its standard deviation.
        standard_deviation: f64,
    },
    /// The logarithm is normal.
    Lognormal {
        /// Half of the values lie below it.
        median: f64,
        /// Standard deviation of the natural logarithm: 0.1 is about 10 %.
        log_standard_deviation: f64,
    },
}

impl Distribution {
    /// Whether it has one value only.
    pub fn is_fixed(&self) -> bool {
        matches!(self, Self::Fixed { .. })
    }

    /// Checks its numbers.
    ///
    /// # Errors
    /// Which number, and what it must be.
    pub fn check(&self) -> Result<(), SamplingError> {
        let finite = "finite numbers";
        let checks: &[(&str, &str, f64, bool, &str)] = match *self {
            Self::Fixed { value } => &[("fixed", "value", value, value.is_finite(), finite)],
            Self::Uniform { low, high } => &[
                ("uniform", "low", low, low.is_finite(), finite),
                ("uniform", "high", high, high.is_finite() && high > low, "high above low"),
            ],
            Self::LogUniform { low, high } => &[
                ("log-uniform", "low", low, low.is_finite() && low > 0.0, "low above 0"),
                ("log-uniform", "high", high, high.is_finite() && high > low, "high above low"),
            ],
            Self::Normal { mean, standard_deviation: sd } => &[
                ("normal", "mean", mean, mean.is_finite(), finite),
                ("normal", "standard_deviation", sd, sd.is_finite() && sd > 0.0, "it above 0"),
            ],
            Self::Lognormal { median, log_standard_deviation: sd } => &[
                ("lognormal", "median", median, median.is_finite() && median > 0.0, "it above 0"),
                (
                    "lognormal",
                    "log_standard_deviation",
                    sd,
                    sd.is_finite() && sd > 0.0,
                    "it above 0",
                ),
            ],
        };
        let wrong = checks.iter().find(|(.., fine, _)| !fine);
        wrong.map_or(Ok(()), |&(kind, what, value, _, must)| {
            Err(SamplingError::Distribution { kind, what, value, must })
        })
    }

    /// The distribution of the same values times `factor`.
    #[must_use]
    pub fn times(self, factor: f64) -> Self {
        match self {
            Self::Fixed { value } => Self::Fixed { value: factor * value },
            Self::Uniform { low, high } => {
                let ends = [factor * low, factor * high];
                Self::Uniform { low: ends[0].min(ends[1]), high: ends[0].max(ends[1]) }
            }
            Self::LogUniform { low, high } => {
                Self::LogUniform { low: factor * low, high: factor * high }
            }
            Self::Normal { mean, standard_deviation } => Self::Normal {
                mean: factor * mean,
                standard_deviation: factor.abs() * standard_deviation,
            },
            Self::Lognormal { median, log_standard_deviation } => {
                Self::Lognormal { median: factor * median, log_standard_deviation }
            }
        }
    }

    /// The quantile of the probability `place`. At 0 and 1 of an unbounded distribution, that of
    /// 2.5 and 97.5 %.
    pub fn quantile(&self, place: f64) -> f64 {
        let normal = || {
            let place = if place <= 0.0 {
                ENDS[0]
            } else if place >= 1.0 {
                ENDS[1]
            } else {
                place
            };
            Normal::standard().inverse_cdf(place)
        };
        match *self {
            Self::Fixed { value } => value,
            Self::Uniform { low, high } => low + place * (high - low),
            Self::LogUniform { low, high } => low * (place * (high / low).ln()).exp(),
            Self::Normal { mean, standard_deviation } => mean + standard_deviation * normal(),
            Self::Lognormal { median, log_standard_deviation } => {
                median * (log_standard_deviation * normal()).exp()
            }
        }
    }
}
