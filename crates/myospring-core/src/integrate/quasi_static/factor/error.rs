//! Why a stiffness has no factor.

use crate::interruption::Interrupted;

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in super::super) enum FactorError {
    /// The stiffness is not positive definite.
    Indefinite,
    /// The factor does not fit into memory, or has too many entries to be numbered.
    TooLarge,
    /// It was interrupted.
    Interrupted,
}

impl From<Interrupted> for FactorError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}
