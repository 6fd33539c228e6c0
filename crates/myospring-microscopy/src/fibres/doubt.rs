//! Sarcomere lengths that are unreliable.
//!
//! Stripes are searched at the periods of sarcomeres. A period near an end of that band may in
//! truth lie beyond it. A length read at few places of a cell may not represent its sarcomeres, or
//! may be chance.

use serde::{Serialize, Serializer};
use std::fmt;

/// A length within this relative distance from an end of the band is doubtful.
const NEAR: f64 = 0.1;
/// Least part of a cell in which the length must be read.
const LEAST_SHARE: f64 = 0.1;

/// The periods that are searched, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Band {
    pub(super) shortest_um: f64,
    pub(super) longest_um: f64,
}

impl Band {
    /// Whether the band contains a period, um.
    pub(super) fn contains(&self, period_um: f64) -> bool {
        (self.shortest_um..=self.longest_um).contains(&period_um)
    }

    /// Why a length is doubtful that was read in the part `share` of a cell; `None` if it is not.
    pub(super) fn doubt(&self, length_um: f64, share: f64) -> Option<SarcomereDoubt> {
        let Self { shortest_um, longest_um } = *self;
        if length_um < (1.0 + NEAR) * shortest_um {
            Some(SarcomereDoubt::NearShortest { end_um: shortest_um })
        } else if length_um > (1.0 - NEAR) * longest_um {
            Some(SarcomereDoubt::NearLongest { end_um: longest_um })
        } else if share < LEAST_SHARE {
            Some(SarcomereDoubt::FewPlaces { share_pct: 100.0 * share })
        } else {
            None
        }
    }
}

/// Why the length of sarcomeres is doubtful.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SarcomereDoubt {
    /// It is near the shortest period that is searched.
    NearShortest {
        /// That period, um.
        end_um: f64,
    },
    /// It is near the longest period that is searched.
    NearLongest {
        /// That period, um.
        end_um: f64,
    },
    /// It was read in a small part of the cell.
    FewPlaces {
        /// Part of the cell, %.
        share_pct: f64,
    },
}

impl fmt::Display for SarcomereDoubt {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NearShortest { end_um } => write!(
                f,
                "within a tenth of {end_um:.2} um, the shortest that is searched: the true length may be below"
            ),
            Self::NearLongest { end_um } => write!(
                f,
                "within a tenth of {end_um:.2} um, the longest that is searched: the true length may be above"
            ),
            Self::FewPlaces { share_pct } => write!(f, "read in only {share_pct:.1} % of the cell"),
        }
    }
}

impl Serialize for SarcomereDoubt {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}
