//! The minimal ventricular model, Eqs. (18)-(31), driving the tension of Eqs. (32)-(35).
//!
//! Six variables: `u` (potential), `v`, `w`, `s` (gates), `Ta_i`, `Ta` (tension). The equations are
//! those of `bueno_orovio_2008` as printed in `coelho_2021`, with the sign of (24) as in the
//! former: `J_si = -H(u - theta_w) w s / tau_si`. `H` is the Heaviside step with `H(0) = 1/2`.
//!
//! # Rest can be a sliding mode
//! The right-hand side jumps at `u = theta_w`. In `coelho_2021` the potential rises below it (the
//! reversal potential `u_o` is far above) and falls above it, so the resting cell slides along `u =
//! theta_w` with a mixture of both sides' rates. A fixed step hops across the threshold every few
//! steps: `u` jitters by at most one step's fall, `step / tau_so1` (0.0002 at 0.005 ms), while the
//! time spent on either side, and with it every gate, is right to first order in the step. The
//! jitter is harmless. [`adaptive`](super::adaptive) holds `u` on the threshold instead, in a few
//! long steps.
//!
//! # Parameters that cannot act
//! `tau_o1`, `tau_o2` count only below `theta_w` and `theta_o` decides between them, so in
//! `coelho_2021`, where `theta_o` lies far above `theta_w`, the values of `theta_o`, `tau_o2` and
//! `w_inf_star` have no effect.

mod electrical;
mod together;

pub use electrical::Electrical;
pub(super) use electrical::rows;

use super::cell_model::{Adaptive, CellModel, InFits, SideBySide, Together};
use super::description::{
    Input, KnownDeparture, ModelError, StateVariable, Stimulation, TensionKind,
};
use super::pacing::Stimulus;
use super::settings::{CellMethod, SolverSettings};
use super::tension::Tension;
use crate::parameter::ParameterSet;
use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;

/// Name and other data, except parameters, of a published version of the minimal model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Identity {
    /// Name in a run file.
    pub name: &'static str,
    /// Description in one line.
    pub description: &'static str,
    /// Keys in `references.bib`.
    pub citations: &'static [&'static str],
    /// The stimulus that its authors used.
    pub stimulus: Stimulus,
    /// Slope and offset of the membrane potential, `V_mV = slope u + offset`, both mV, if defined.
    pub millivolts: Option<(f64, f64)>,
    /// Peak of `Ta` of one default beat of the published parameters, converged.
    pub peak_tension: f64,
    /// Highest `u` in the authors' own program, and time of its first stimulus, ms, if known.
    pub in_authors_program: Option<[f64; 2]>,
    /// Largest shortening rate divided by peak shortening of a free cell with the published
    /// parameters, 1/s, and a remark on it.
    pub pace: (f64, &'static str),
}

/// Groups of states in the authors' step: `u, v, w, s | Ta_i | Ta`.
const STAGGERED_GROUPS: &[usize] = &[4, 5];

/// Names and meanings; all are pure numbers.
pub(super) static STATES: [StateVariable; 6] = {
    const fn variable(place: usize, name: &'static str, meaning: &'static str) -> StateVariable {
        StateVariable {
            name: Cow::Borrowed(name),
            unit: Cow::Borrowed(""),
            start: MinimalModel::INITIAL_STATE[place],
            meaning: Cow::Borrowed(meaning),
        }
    }
    [
        variable(0, "u", "potential"),
        variable(1, "v", "gate of the fast inward current"),
        variable(2, "w", "gate of the slow inward current"),
        variable(3, "s", "activation of the slow inward current"),
        variable(4, "Ta_i", "precursor of the active tension"),
        variable(5, "Ta", "active tension"),
    ]
};

/// The minimal model with tension: six equations, 28 + 7 parameters.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, coelho_2021, minimal::MinimalModel};
///
/// let mut parameters = coelho_2021::parameters();
/// parameters.set("tau_si", 1.9)?;
/// let model = MinimalModel::new(coelho_2021::IDENTITY, parameters)?;
/// assert_eq!(model.state_names(), ["u", "v", "w", "s", "Ta_i", "Ta"]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct MinimalModel {
    identity: Identity,
    parameters: ParameterSet,
    electrical: Electrical,
    tension: Tension,
}

impl MinimalModel {
    /// Builds the model; every parameter is looked up once.
    ///
    /// # Errors
    /// A parameter is missing, or `u_peak` is not above `u_rest`.
    pub fn new(identity: Identity, parameters: ParameterSet) -> Result<Self, ModelError> {
        Ok(Self {
            identity,
            electrical: Electrical::new(identity.name, &parameters)?,
            tension: Tension::new(identity.name, &parameters)?,
            parameters,
        })
    }

    /// The model of a complete parameter set of this crate.
    pub(super) fn published(identity: Identity, parameters: ParameterSet) -> Self {
        match Self::new(identity, parameters) {
            Ok(model) => model,
            Err(error) => unreachable!("published set: {error}"),
        }
    }

    pub(super) const INITIAL_STATE: [f64; 6] = [0.0, 1.0, 1.0, 0.0, 0.0, 0.0];

    /// Its name and other data.
    pub fn identity(&self) -> &Identity {
        &self.identity
    }

    /// The electrical half of the model.
    pub fn electrical_constants(&self) -> &Electrical {
        &self.electrical
    }

    /// The tension half of the model.
    pub fn tension_constants(&self) -> &Tension {
        &self.tension
    }
}

impl CellModel for MinimalModel {
    fn name(&self) -> &str {
        self.identity.name
    }

    fn description(&self) -> &str {
        self.identity.description
    }

    fn citations(&self) -> Vec<&str> {
        self.identity.citations.to_vec()
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self::new(self.identity, parameters)?))
    }

    fn states(&self) -> &[StateVariable] {
        &STATES
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        let &[u, v, w, s, ta_i, ta] = state else {
            unreachable!("the minimal model has six state variables, not {}", state.len());
        };
        let electrical = self.electrical.rates(u, v, w, s);
        rates[..4].copy_from_slice(&electrical);
        rates[0] += input.stimulus;
        rates[4..].copy_from_slice(&self.tension.rates(u, ta_i, ta));
    }

    fn stimulation(&self) -> Stimulation {
        Stimulation::of_first_state(self.identity.stimulus)
    }

    /// Adaptive steps, cut where the equations jump.
    fn usual_settings(&self) -> SolverSettings {
        SolverSettings::of(CellMethod::Adaptive)
    }

    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }

    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        self.identity.millivolts.map(|(slope, offset)| slope * state[0] + offset)
    }

    /// At least 0, as the exact tension is: adaptive steps may make the state slightly negative.
    fn tension(&self, state: &[f64], _input: &Input) -> f64 {
        // NaN stays.
        if state[5] < 0.0 { 0.0 } else { state[5] }
    }

    fn tension_kind(&self) -> TensionKind {
        TensionKind::Relative { published_peak: self.identity.peak_tension }
    }

    fn in_authors_program(&self) -> Option<(Arc<dyn CellModel>, f64)> {
        let [u_peak, start_ms] = self.identity.in_authors_program?;
        let mut parameters = self.parameters.clone();
        parameters.set("u_peak", u_peak).ok()?;
        Some((self.with_parameters(parameters).ok()?, start_ms))
    }

    fn staggered_groups(&self) -> &'static [usize] {
        STAGGERED_GROUPS
    }

    fn jumps(&self) -> bool {
        true
    }

    fn adaptive(&self) -> Option<&dyn Adaptive> {
        Some(self)
    }

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        Some(self)
    }

    fn together(&self) -> Option<&dyn Together> {
        Some(self)
    }

    fn tension_of_potential(&self) -> Option<&Tension> {
        Some(&self.tension)
    }

    fn is_same_as(&self, other: &dyn CellModel) -> bool {
        let other: &dyn Any = other;
        other.downcast_ref() == Some(self)
    }

    fn in_fits(&self) -> InFits<'_> {
        InFits { strength: None, usual: &["c_0"], not_together: &[] }
    }

    fn lumps_currents(&self) -> bool {
        true
    }

    fn known_departure(&self) -> Option<KnownDeparture> {
        let (shortening_rate_over_peak, fact) = self.identity.pace;
        let instead = Cow::Borrowed("land_2017");
        Some(KnownDeparture { shortening_rate_over_peak, fact: Cow::Borrowed(fact), instead })
    }
}
