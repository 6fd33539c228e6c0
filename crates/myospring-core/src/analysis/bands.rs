//! Reference bands of metrics.

use serde::Serialize;

/// Reference band of a quantity in unloaded adult ventricular myocytes; it is not a target.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Band {
    /// Name of the metric.
    pub name: &'static str,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
    /// Unit of both ends.
    pub unit: &'static str,
    /// The cells to which it applies.
    pub scope: &'static str,
}

/// Position of a value relative to a band.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum BandPosition {
    /// Lower than its lower end.
    Below,
    /// Between its ends.
    In,
    /// Higher than its upper end.
    Above,
}

impl BandPosition {
    /// In words: `in`, `out, above`.
    pub fn words(self) -> &'static str {
        match self {
            Self::Below => "out, below",
            Self::In => "in",
            Self::Above => "out, above",
        }
    }
}

/// Relative tolerance at the ends of a band, which are known to three digits at most.
const END: f64 = 0.005;

impl Band {
    /// Position of a value relative to this band.
    ///
    /// # Example
    /// ```
    /// use myospring::analysis::bands::{BandPosition, band};
    /// let shortening = band("peak_shortening").unwrap();
    /// assert_eq!([6.9, 9.0, 12.01, 12.1].map(|value| shortening.place(value)),
    ///     [BandPosition::Below, BandPosition::In, BandPosition::In, BandPosition::Above]);
    /// ```
    pub fn place(&self, value: f64) -> BandPosition {
        match value {
            _ if value < self.low - END * self.low.abs() => BandPosition::Below,
            _ if value > self.high + END * self.high.abs() => BandPosition::Above,
            _ => BandPosition::In,
        }
    }
}

/// The reference bands.
pub const BANDS: [Band; 5] = [
    Band {
        name: "peak_shortening",
        low: 7.0,
        high: 12.0,
        unit: "%",
        scope: "unloaded adult ventricular myocytes (guinea pig 8.1 %, rabbit 9.0 %)",
    },
    Band {
        name: "area_change_at_peak",
        low: -5.0,
        high: 0.0,
        unit: "%",
        scope: "projected area at about 10 % shortening",
    },
    Band {
        name: "maximum_shortening_rate",
        low: 0.5,
        high: 1.2,
        unit: "L0/s",
        scope: "unloaded adult ventricular myocytes (guinea pig 0.82, rabbit 0.98 L0/s)",
    },
    Band {
        name: "shortening_rate_over_peak",
        low: 8.0,
        high: 13.0,
        unit: "1/s",
        scope: "unloaded adult ventricular myocytes (guinea pig 10.1, rabbit 10.8 1/s, and a fifth either way)",
    },
    Band {
        name: "time_to_peak_from_stimulus",
        low: 100.0,
        high: 250.0,
        unit: "ms",
        scope: "unloaded adult ventricular myocytes, from the stimulus",
    },
];

/// The reference band of a metric, if there is one.
pub fn band(name: &str) -> Option<&'static Band> {
    BANDS.iter().find(|band| band.name == name)
}
