//! Release, uptake and buffers of calcium.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::membrane::Membrane;
use super::parameters::Parameters;
use super::state::State;
use crate::cell::number::{Number, inlined};

/// Fluxes, mM/ms, each in its own volume.
#[derive(Debug, Clone, Copy)]
pub(super) struct Fluxes<T> {
    pub(super) release: T,
    pub(super) uptake: T,
    /// From the network to the junctional reticulum.
    pub(super) transfer: T,
    /// From subspace to cytosol.
    pub(super) diffusion: T,
}

impl<T: Number> Fluxes<T> {
    #[inline(always)]
    pub(super) fn new(p: &Parameters<T>, s: &State<T>, m: &Membrane<T>) -> Self {
        // J_up = 0.005425 Ca / (Ca + 0.00092), phosphorylated 2.75 times that at 0.00017 less; leak 0.0048825 Ca_nsr / 15
        let pumped = inlined(
            #[inline(always)]
            |half: f64, strength: f64| s.ca_i / (s.ca_i + half) * (0.005425 * strength),
        );
        let leak = p.k_leak * s.ca_nsr * (0.0048825 / 15.0);
        Self {
            release: p.k_rel * m.mixed(s.j_rel_np, s.j_rel_p),
            uptake: p.k_up * m.mixed(pumped(0.00092, 1.0), pumped(0.00092 - 0.00017, 2.75)) - leak,
            transfer: (s.ca_nsr - s.ca_jsr) / 60.0,
            diffusion: (s.ca_ss - s.ca_i) / 0.2,
        }
    }
}

/// Rates of `J_rel_np` and `J_rel_p`, from the calcium current into the subspace.
#[inline(always)]
pub(super) fn release_rates<T: Number>(p: &Parameters<T>, s: &State<T>, i_ca_ss: T) -> [T; 2] {
    // J_inf = 0.5 b (-I_CaL_ss) / (1 + (1.7 / Ca_jsr)^8), tau = b / (1 + 0.0123 / Ca_jsr), at least 1 us
    let loaded = ((T::of(1.7) / s.ca_jsr).square().square().square() + 1.0).inverse();
    let rate = inlined(
        #[inline(always)]
        |b: f64, j: T| {
            let j_inf = p.a_rel * -i_ca_ss * loaded * (0.5 * b);
            let tau = (T::of(0.0123) / s.ca_jsr + 1.0).inverse() * b;
            let tau = tau.at_least(0.001, tau, T::of(0.001));
            (j_inf - j) / tau
        },
    );
    [rate(4.75, s.j_rel_np), rate(1.25 * 4.75, s.j_rel_p)]
}

/// Derivative of the bound calcium of a buffer with respect to calcium: `max K / (K + Ca)^2`.
#[inline(always)]
pub(super) fn buffered<T: Number>(sites: T, half: T, calcium: T) -> T {
    sites * half / (half + calcium).square()
}
