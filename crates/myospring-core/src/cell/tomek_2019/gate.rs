//! A voltage-dependent gate: `dx/dt = (x_inf - x) / tau`.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use crate::cell::number::Number;

/// Steady state and rate of a gate.
#[derive(Debug, Clone, Copy)]
pub(super) struct Moving<T> {
    pub(super) steady_state: T,
    /// `1 / tau`, 1/ms.
    pub(super) rate: T,
}

impl<T: Number> Moving<T> {
    #[inline(always)]
    pub(super) fn new(steady_state: T, rate: T) -> Self {
        Self { steady_state, rate }
    }

    /// From a time constant, ms.
    #[inline(always)]
    pub(super) fn within(steady_state: T, time_constant: T) -> Self {
        Self { steady_state, rate: time_constant.inverse() }
    }
}
