//! The quantity that a curve of a beating cell shows, and its direction in a beat.

use serde::Serialize;
use std::fmt;

/// The quantity of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Kind {
    /// Length of the cell, um or pixels; falls in a beat.
    Length,
    /// Mean length of its sarcomeres, um or pixels; falls in a beat.
    SarcomereLength,
    /// Length divided by a reference length, such as that at rest or the mean, or a stretch; falls
    /// in a beat.
    NormalisedLength,
    /// Shortening, % of the length at rest; rises in a beat.
    Shortening,
    /// Motion of any unit, such as `MUSCLEMOTION`'s amplitude or a displacement; rises in a beat.
    Contraction,
    /// Force, nN; rises in a beat.
    Force,
    /// Active tension, force over cross-section, kPa; rises in a beat.
    Tension,
    /// Contractile moment of tractions on a gel, fJ (nN um); rises in a beat.
    Moment,
    /// Concentration of calcium, uM; rises in a beat.
    Calcium,
    /// Ratio of two fluorescences that rises with calcium.
    CalciumRatio,
    /// Fluorescence of a dye that brightens with calcium, in any unit.
    Fluorescence,
    /// Membrane potential, mV; rises in a beat.
    Potential,
    /// Not stated: it may rise or fall in a beat.
    Unknown,
}

/// The group of metrics that apply to a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Family {
    /// Lengths, shortening and other motion.
    Contraction,
    /// Force, tension and contractile moment.
    Tension,
    /// Calcium and its fluorescence.
    Calcium,
    /// Membrane potential.
    ActionPotential,
}

impl Kind {
    /// All kinds.
    pub const ALL: [Self; 13] = [
        Self::Length,
        Self::SarcomereLength,
        Self::NormalisedLength,
        Self::Shortening,
        Self::Contraction,
        Self::Force,
        Self::Tension,
        Self::Moment,
        Self::Calcium,
        Self::CalciumRatio,
        Self::Fluorescence,
        Self::Potential,
        Self::Unknown,
    ];

    /// Its name in options: `sarcomere-length`.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Length => "length",
            Self::SarcomereLength => "sarcomere-length",
            Self::NormalisedLength => "normalised-length",
            Self::Shortening => "shortening",
            Self::Contraction => "contraction",
            Self::Force => "force",
            Self::Tension => "tension",
            Self::Moment => "moment",
            Self::Calcium => "calcium",
            Self::CalciumRatio => "calcium-ratio",
            Self::Fluorescence => "fluorescence",
            Self::Potential => "potential",
            Self::Unknown => "unknown",
        }
    }

    /// The kind with a name, in upper or lower case, with hyphens, underscores or spaces.
    ///
    /// # Example
    /// ```
    /// use myospring::analysis::kind::Kind;
    /// assert_eq!(Kind::of_word("Sarcomere_length"), Some(Kind::SarcomereLength));
    /// ```
    pub fn of_word(word: &str) -> Option<Self> {
        let word = word.trim().to_lowercase().replace(['_', ' '], "-");
        Self::ALL.into_iter().find(|kind| kind.word() == word)
    }

    /// Its name in a sentence.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Length => "length of the cell",
            Self::SarcomereLength => "sarcomere length",
            Self::NormalisedLength => "normalised length",
            Self::Shortening => "shortening",
            Self::Contraction => "contraction",
            Self::Force => "force",
            Self::Tension => "tension",
            Self::Moment => "contractile moment",
            Self::Calcium => "calcium",
            Self::CalciumRatio => "calcium ratio",
            Self::Fluorescence => "fluorescence",
            Self::Potential => "membrane potential",
            Self::Unknown => "curve of unknown kind",
        }
    }

    /// Whether it rises in a beat; `None` if that is not known.
    pub const fn rises(self) -> Option<bool> {
        match self {
            Self::Length | Self::SarcomereLength | Self::NormalisedLength => Some(false),
            Self::Unknown => None,
            _ => Some(true),
        }
    }

    /// Whether it is a length with a meaningful zero, unlike a fluorescence over an unknown
    /// background.
    pub const fn is_length(self) -> bool {
        matches!(self, Self::Length | Self::SarcomereLength | Self::NormalisedLength)
    }

    /// The group of metrics that apply to it.
    pub const fn family(self) -> Family {
        match self {
            Self::Force | Self::Tension | Self::Moment => Family::Tension,
            Self::Calcium | Self::CalciumRatio | Self::Fluorescence => Family::Calcium,
            Self::Potential => Family::ActionPotential,
            _ => Family::Contraction,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(self.name())
    }
}
