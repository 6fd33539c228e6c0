//! Why a metric has no value: a metric is a value or one of these reasons.

use serde::{Serialize, Serializer};

/// Why a metric has no value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Missing {
    /// Nothing that it could be read from was recorded.
    NotRecorded,
    /// There is no pulse.
    NoRise,
    /// The cell does not become shorter than at rest.
    NoShortening,
    /// The pulse does not go through the level that is looked for.
    NotReached,
    /// The curve ends before.
    Cut,
    /// It would come before what it is counted from.
    Before,
    /// It is divided by something that is nothing but rounding or noise.
    TooSmall,
    /// Frames are missing where it would be read.
    Hole,
    /// An artefact lies where it would be read.
    Artefact,
    /// An artefact or missing frames may hide a beat.
    Hidden,
    /// The stimulus raised no action potential.
    NotCaptured,
    /// No beat comes before.
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
            Self::Cut => "the recording ends before",
            Self::Before => "it would come before the time that it is counted from",
            Self::TooSmall => "what it is divided by is too small",
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
