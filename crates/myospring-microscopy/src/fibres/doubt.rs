//! Lengths of sarcomeres that are not to be relied on.
//!
//! Stripes are looked for at the periods that sarcomeres have. Near an end of that band a period may be one beyond it,
//! seen as far as the band reaches; and a length that few places of a cell gave may be that of few sarcomeres, or of none.

use serde::{Serialize, Serializer};
use std::fmt;

/// Part of an end of the band within which a length is doubtful.
const NEAR: f64 = 0.1;
/// Part of a cell that says how long its sarcomeres are, at least.
const LEAST_SHARE: f64 = 0.1;

/// The periods that are looked for, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Band {
    pub(super) shortest_um: f64,
    pub(super) longest_um: f64,
}

impl Band {
    /// Whether it holds a period, um.
    pub(super) fn contains(&self, period_um: f64) -> bool {
        (self.shortest_um..=self.longest_um).contains(&period_um)
    }

    /// What makes a length doubtful that was read in a part of a cell, if something does.
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
    /// It is near the shortest period that is looked for.
    NearShortest {
        /// That period, um.
        end_um: f64,
    },
    /// It is near the longest period that is looked for.
    NearLongest {
        /// That period, um.
        end_um: f64,
    },
    /// Few places of the cell gave it.
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
                "within a tenth of {end_um:.2} um, the shortest that is looked for: the true length may be below"
            ),
            Self::NearLongest { end_um } => write!(
                f,
                "within a tenth of {end_um:.2} um, the longest that is looked for: the true length may be above"
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
