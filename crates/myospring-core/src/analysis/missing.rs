//! Reasons why a metric has no value.

use serde::{Serialize, Serializer};

/// Why a metric has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// The quantity was not recorded.
    NotRecorded,
    /// There is no pulse.
    NoRise,
    /// The cell does not become shorter than at rest.
    NoShortening,
    /// The pulse does not cross the level.
    NotReached,
    /// The curve ends earlier.
    Cut,
    /// The time would come before the one from which it is counted.
    Before,
    /// Its divisor is only rounding error or noise.
    TooSmall,
    /// Frames are missing at that point.
    Hole,
    /// An artefact is at that point.
    Artefact,
    /// An artefact or missing frames may hide a beat.
    Hidden,
    /// The stimulus raised no action potential.
    NotCaptured,
    /// There is no previous beat.
    First,
}

impl Missing {
    /// The reason in words.
    pub const fn words(self) -> &'static str {
        match self {
            Self::NotRecorded => "nothing was recorded there",
            Self::NoRise => "the curve does not rise above its rest",
            Self::NoShortening => "the cell does not shorten",
            Self::NotReached => "the curve does not reach that level within the beat",
            Self::Cut => "the recording ends earlier",
            Self::Before => "it would come before the time that it is counted from",
            Self::TooSmall => "its divisor is too small",
            Self::Hole => "frames are missing there",
            Self::Artefact => "an artefact lies there",
            Self::Hidden => "an artefact or missing frames may hide a beat",
            Self::NotCaptured => "the stimulus raised no action potential",
            Self::First => "no beat comes before",
        }
    }
}

impl Serialize for Missing {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.words())
    }
}

/// A value, or why there is none.
pub type Reading = Result<f64, Missing>;
