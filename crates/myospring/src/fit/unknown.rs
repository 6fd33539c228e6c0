//! The unknowns of a fit.

use std::fmt;

/// Default bounds, as a factor on the run's value.
const USUAL: f64 = 4.0;

/// An unknown of the cell.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Unknown {
    /// Peak of the active tension over stiffness: a free cell shortens by their ratio.
    TensionOverStiffness,
    /// Every elastic constant of the cell, by its Young's modulus; only with a known load.
    YoungModulus,
    /// Peak of the active tension: the product of the two, which is reported where both are sought.
    PeakTension,
    /// A parameter of the cell model.
    Parameter(String),
}

impl Unknown {
    /// By the name that options and run files use.
    pub fn named(name: &str) -> Self {
        match name {
            "tension_over_stiffness" => Self::TensionOverStiffness,
            "young_modulus" => Self::YoungModulus,
            name => Self::Parameter(name.to_owned()),
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        match self {
            Self::TensionOverStiffness => "tension_over_stiffness",
            Self::YoungModulus => "young_modulus",
            Self::PeakTension => "peak_tension",
            Self::Parameter(name) => name,
        }
    }

    /// Default bounds, as factors on the run's value.
    pub(super) fn usual(&self) -> [f64; 2] {
        match self {
            // A wide range: on gels it is a hundredth of that of free cells.
            Self::TensionOverStiffness | Self::PeakTension => [1e-4, 1e4],
            Self::YoungModulus => super::table::STIFFNESS_BOUNDS,
            Self::Parameter(_) => [1.0 / USUAL, USUAL],
        }
    }
}

impl fmt::Display for Unknown {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}

/// A cell with some of its numbers changed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Physics<'a> {
    /// Factor on the peak of tension, over stiffness.
    pub(super) tension: f64,
    /// Factor on every elastic constant.
    pub(super) stiffness: f64,
    /// Values of the fitted parameters, in their order.
    pub(super) parameters: &'a [f64],
}
