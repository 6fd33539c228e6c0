//! Why a stiffness has no factor.

use crate::interruption::Interrupted;

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum FactorError {
    /// The stiffness is not positive definite.
    Indefinite,
    /// The factor does not fit into memory, or has too many entries to be numbered.
    TooLarge {
        /// What it takes at least, bytes.
        bytes: usize,
    },
    /// It was interrupted.
    Interrupted,
}

impl FactorError {
    /// Counts memory that is in use already to what it takes.
    pub(super) fn beside(self, used: usize) -> Self {
        match self {
            Self::TooLarge { bytes } => Self::TooLarge { bytes: bytes.saturating_add(used) },
            other => other,
        }
    }
}

impl From<Interrupted> for FactorError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}
