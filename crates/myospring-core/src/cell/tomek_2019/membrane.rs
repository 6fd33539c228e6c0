//! Shared quantities of the currents: physical constants, the cell's geometry, reversal potentials,
//! the Goldman equation.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::parameters::Parameters;
use super::state::State;
use crate::cell::number::{Number, inlined};

/// Gas constant, mJ/(mol K); temperature, K; Faraday's constant, C/mol.
const R: f64 = 8314.0;
const T: f64 = 310.0;
pub(super) const F: f64 = 96485.0;
/// `F / (R T)`, 1/mV.
pub(super) const F_OVER_RT: f64 = F / (R * T);

/// A cylinder of 100 um by 22 um, volumes in ul, capacitance as area in cm^2.
const LENGTH_CM: f64 = 0.01;
const RADIUS_CM: f64 = 0.0011;
#[allow(clippy::approx_constant, reason = "as the paper's volumes have it")]
const PI: f64 = 3.14;
const CELL: f64 = 1000.0 * PI * RADIUS_CM * RADIUS_CM * LENGTH_CM;
const CAPACITANCE: f64 =
    2.0 * (2.0 * PI * RADIUS_CM * RADIUS_CM + 2.0 * PI * RADIUS_CM * LENGTH_CM);
const CYTOSOL: f64 = 0.68 * CELL;
const NETWORK: f64 = 0.0552 * CELL;
const JUNCTION: f64 = 0.0048 * CELL;
const SUBSPACE: f64 = 0.02 * CELL;
/// Rate of a concentration due to a current of 1 A/F of single charges, mM/ms.
pub(super) const PER_CURRENT_I: f64 = CAPACITANCE / (F * CYTOSOL);
pub(super) const PER_CURRENT_SS: f64 = CAPACITANCE / (F * SUBSPACE);
/// Ratios of volumes.
pub(super) const NETWORK_OVER_CYTOSOL: f64 = NETWORK / CYTOSOL;
pub(super) const SUBSPACE_OVER_CYTOSOL: f64 = SUBSPACE / CYTOSOL;
pub(super) const JUNCTION_OVER_SUBSPACE: f64 = JUNCTION / SUBSPACE;
pub(super) const JUNCTION_OVER_NETWORK: f64 = JUNCTION / NETWORK;

/// Permeability of the channels of I_Ks for sodium relative to that for potassium.
const SODIUM_THROUGH_KS: f64 = 0.01833;

/// Permittivity of water at 37 degrees, relative to that of vacuum.
const DIELECTRIC: f64 = 74.0;

/// Functions of potential and concentrations that all currents share.
#[derive(Debug, Clone, Copy)]
pub(super) struct Membrane<T> {
    pub(super) v: T,
    /// `v F / (R T)`, and its exponential.
    pub(super) x: T,
    pub(super) exp_x: T,
    /// Reversal potentials, mV.
    pub(super) e_na: T,
    pub(super) e_k: T,
    pub(super) e_ks: T,
    /// Part of each channel that CaM kinase has phosphorylated.
    pub(super) phosphorylated: T,
    /// `ln` of the activity coefficient of a single charge in cytosol, subspace, and outside.
    pub(super) activity_i: T,
    pub(super) activity_ss: T,
    pub(super) activity_o: T,
}

/// Chloride in cytosol and subspace, mM.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chlorides<T> {
    pub(super) i: T,
    pub(super) ss: T,
}

/// CaM kinase that calmodulin has bound: `CaMK_b = CaMK_o (1 - CaMK_t) / (1 + K_m_CaM / Ca_ss)`.
#[inline(always)]
pub(super) fn bound_kinase<T: Number>(p: &Parameters<T>, s: &State<T>) -> T {
    p.camk_o * s.camk_t.rest() / (p.k_m_cam / s.ca_ss + 1.0)
}

impl<T: Number> Membrane<T> {
    #[inline(always)]
    pub(super) fn new(p: &Parameters<T>, s: &State<T>, chloride: &Chlorides<T>) -> Self {
        let x = s.v * F_OVER_RT;
        // E = R T / F ln(outside / inside)
        let nernst = inlined(
            #[inline(always)]
            |outside: T, inside: T| (outside / inside).ln() / F_OVER_RT,
        );
        let sodium = inlined(
            #[inline(always)]
            |c: T| c * SODIUM_THROUGH_KS,
        );
        // Ionic strength, and ln(gamma) = -A (sqrt(I) / (1 + sqrt(I)) - 0.3 I): Davies' equation
        let activity = inlined(
            #[inline(always)]
            |na: T, k: T, cl: T, ca: T| {
                let strength = (na + k + cl + ca * 4.0) * (0.5 / 1000.0);
                let root = strength.sqrt();
                let a = 1.82e6 * (DIELECTRIC * self::T).powf(-1.5);
                (root / (root + 1.0) - strength * 0.3) * -a
            },
        );
        let active = bound_kinase(p, s) + s.camk_t;
        Self {
            v: s.v,
            x,
            exp_x: x.exp(),
            e_na: nernst(p.na_o, s.na_i),
            e_k: nernst(p.k_o, s.k_i),
            e_ks: nernst(p.k_o + sodium(p.na_o), s.k_i + sodium(s.na_i)),
            // 1 / (1 + K_m_CaMK / CaMK_a)
            phosphorylated: (p.k_m_camk / active + 1.0).inverse(),
            activity_i: activity(s.na_i, s.k_i, chloride.i, s.ca_i),
            activity_ss: activity(s.na_ss, s.k_ss, chloride.ss, s.ca_ss),
            activity_o: activity(p.na_o, p.k_o, p.cl_o, p.ca_o),
        }
    }

    /// Goldman's equation for ions of one charge without the permeability, C/ml: `v F^2 / (R T)
    /// (inside exp(x) - outside) / (exp(x) - 1)`.
    #[inline(always)]
    pub(super) fn goldman_1(&self, inside: T, outside: T) -> T {
        (inside * self.exp_x - outside) * relative(self.x, self.exp_x) * F
    }

    /// The same for two charges: `4 v F^2 / (R T) (inside exp(2 x) - outside) / (exp(2 x) - 1)`.
    #[inline(always)]
    pub(super) fn goldman_2(&self, inside: T, outside: T) -> T {
        let exp_2x = self.exp_x.square();
        (inside * exp_2x - outside) * relative(self.x * 2.0, exp_2x) * (2.0 * F)
    }

    /// Mean of the plain and the phosphorylated value, weighted by their parts.
    #[inline(always)]
    pub(super) fn mixed(&self, plain: T, phosphorylated: T) -> T {
        plain + (phosphorylated - plain) * self.phosphorylated
    }
}

/// `x / (exp(x) - 1)`, also valid at `x` = 0.
#[inline(always)]
fn relative<T: Number>(x: T, exp_x: T) -> T {
    // At the border, the first omitted term is 3e-23, and the quotient is accurate to 1e-13.
    let square = x.square();
    let series = -x * 0.5 + square / 12.0 - square.square() / 720.0 + 1.0;
    square.at_least(1e-6, x / (exp_x - 1.0), series)
}
