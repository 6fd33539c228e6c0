//! All currents and fluxes at one time, and the resulting rates of change.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::calcium::{Fluxes, buffered, release_rates};
use super::calcium_channel::{self, CalciumChannel, mode_rates};
use super::exchange::Exchange;
use super::gate::Moving;
use super::membrane::{
    Chlorides, JUNCTION_OVER_NETWORK, JUNCTION_OVER_SUBSPACE, Membrane, NETWORK_OVER_CYTOSOL,
    PER_CURRENT_I, PER_CURRENT_SS, SUBSPACE_OVER_CYTOSOL, bound_kinase,
};
use super::parameters::Parameters;
use super::potassium::{self, Potassium, rapid_rates};
use super::sodium::{self, Sodium};
use super::state::{Chloride, Gates, State};
use crate::cell::number::{Number, inlined};

/// Diffusion time of ions other than calcium from the subspace to the cytosol, ms.
const DIFFUSION_MS: f64 = 2.0;

/// All currents and fluxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Flows<T> {
    pub(super) sodium: Sodium<T>,
    pub(super) potassium: Potassium<T>,
    pub(super) calcium_channel: CalciumChannel<T>,
    pub(super) exchange: Exchange<T>,
    pub(super) fluxes: Fluxes<T>,
}

impl<T: Number> Flows<T> {
    #[inline(always)]
    pub(super) fn new(
        p: &Parameters<T>,
        s: &State<T>,
        g: &Gates<T>,
        chloride: &Chlorides<T>,
    ) -> Self {
        let m = Membrane::new(p, s, chloride);
        Self {
            sodium: Sodium::new(p, s, g, &m),
            potassium: Potassium::new(p, s, g, &m),
            calcium_channel: CalciumChannel::new(p, s, g, &m),
            exchange: Exchange::new(p, s, &m, chloride),
            fluxes: Fluxes::new(p, s, &m),
        }
    }
}

/// Rates of the state, per ms; `stimulus` in A/F, inward. With myofilaments, `bound` is the rate of
/// the part of troponin with calcium; otherwise troponin is a buffer at equilibrium.
#[inline(always)]
pub(super) fn rates<T: Number>(
    p: &Parameters<T>,
    s: &State<T>,
    g: &Gates<T>,
    flows: &Flows<T>,
    stimulus: T,
    bound: Option<T>,
) -> State<T> {
    let Flows { sodium, potassium: k, calcium_channel: cal, exchange: x, fluxes } = flows;
    let outward = k.transient + k.rapid + k.slow + k.inward + k.background + k.by_atp;
    let inward = sodium.fast + sodium.late + sodium.background + cal.sum();
    let pumps = x.na_ca_i + x.na_ca_ss + x.na_k + x.ca_pump + x.ca_background;
    let diffused = inlined(
        #[inline(always)]
        |ss: T, i: T| (ss - i) / DIFFUSION_MS,
    );
    let (na, potassium) = (diffused(s.na_ss, s.na_i), diffused(s.k_ss, s.k_i));

    let sodium_i =
        sodium.fast + sodium.late + sodium.background + x.na_ca_i * 3.0 + cal.na_i + x.na_k * 3.0;
    let potassium_i = outward - stimulus - x.na_k * 2.0 + cal.k_i;
    let calcium_i = cal.ca_i + x.ca_pump + x.ca_background - x.na_ca_i * 2.0;
    let calcium_ss = cal.ca_ss - x.na_ca_ss * 2.0;

    // beta = 1 / (1 + sum of buffers); troponin of the myofilaments takes what it binds
    let free_i = -(calcium_i * (0.5 * PER_CURRENT_I)) - fluxes.uptake * NETWORK_OVER_CYTOSOL
        + fluxes.diffusion * SUBSPACE_OVER_CYTOSOL;
    let calmodulin = buffered(p.cmdn_max, p.k_m_cmdn, s.ca_i) + 1.0;
    let ca_i = match bound {
        Some(bound) => (free_i - bound * p.trpn_max) / calmodulin,
        None => free_i / (calmodulin + buffered(p.trpn_max, p.k_m_trpn, s.ca_i)),
    };
    let free_ss = -(calcium_ss * (0.5 * PER_CURRENT_SS)) + fluxes.release * JUNCTION_OVER_SUBSPACE
        - fluxes.diffusion;
    let sites = buffered(p.bsr_max, p.k_m_bsr, s.ca_ss) + buffered(p.bsl_max, p.k_m_bsl, s.ca_ss);
    let csqn = buffered(p.csqn_max, p.k_m_csqn, s.ca_jsr);

    let camk_b = bound_kinase(p, s);
    let [j_rel_np, j_rel_p] = release_rates(p, s, cal.ca_ss);
    let [n_ss, n_i] = mode_rates(s, g);
    let [c0, c1, c2, o, i] = rapid_rates(s);
    State {
        v: stimulus - (inward + outward + pumps + x.cl_ca + x.cl_background),
        na_i: -(sodium_i * PER_CURRENT_I) + na * SUBSPACE_OVER_CYTOSOL,
        na_ss: -((cal.na_ss + x.na_ca_ss * 3.0) * PER_CURRENT_SS) - na,
        k_i: -(potassium_i * PER_CURRENT_I) + potassium * SUBSPACE_OVER_CYTOSOL,
        k_ss: -(cal.k_ss * PER_CURRENT_SS) - potassium,
        ca_i,
        ca_ss: free_ss / (sites + 1.0),
        ca_nsr: fluxes.uptake - fluxes.transfer * JUNCTION_OVER_NETWORK,
        ca_jsr: (fluxes.transfer - fluxes.release) / (csqn + 1.0),
        // alpha CaMK_b (CaMK_b + CaMK_t) - beta CaMK_t
        camk_t: p.alpha_camk * camk_b * (camk_b + s.camk_t) - p.beta_camk * s.camk_t,
        j_rel_np,
        j_rel_p,
        n_ss,
        n_i,
        c0,
        c1,
        c2,
        o,
        i,
    }
}

/// Rates of dynamic chloride, mM/ms.
#[inline(always)]
pub(super) fn chloride_rates<T: Number>(c: &Chloride<T>, x: &Exchange<T>) -> Chloride<T> {
    let diffused = (c.cl_ss - c.cl_i) / DIFFUSION_MS;
    Chloride {
        cl_i: x.cl_background * PER_CURRENT_I + diffused * SUBSPACE_OVER_CYTOSOL,
        cl_ss: x.cl_ca * PER_CURRENT_SS - diffused,
    }
}

/// Steady states and rates of all gates.
#[inline(always)]
pub(super) fn gates<T: Number>(p: &Parameters<T>, v: T) -> Gates<Moving<T>> {
    let [m, h, j, h_p, j_p, m_l, h_l, h_l_p] = sodium::gates(v);
    let [a, i_f, i_s, a_p, i_f_p, i_s_p] = potassium::transient_gates(p, v);
    let [d, f_f, f_s, f_ca_f, f_ca_s, j_ca, f_f_p, f_ca_f_p] = calcium_channel::gates(p, v);
    let [x_s1, x_s2] = potassium::slow_gates(v);
    Gates {
        m,
        h,
        j,
        h_p,
        j_p,
        m_l,
        h_l,
        h_l_p,
        a,
        i_f,
        i_s,
        a_p,
        i_f_p,
        i_s_p,
        d,
        f_f,
        f_s,
        f_ca_f,
        f_ca_s,
        j_ca,
        f_f_p,
        f_ca_f_p,
        x_s1,
        x_s2,
    }
}
