//! Cell models: a stimulus becomes an action potential and active tension.

use crate::parameter::ParameterSet;

/// What acts on a cell from outside at one instant.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Input {
    /// Stimulus current as a rate of the model's potential variable, 1/ms.
    pub stimulus: f64,
    /// Stretch of the cell along its fibre, length over resting length; 1 at rest.
    pub stretch: f64,
}

/// A cell model: ordinary differential equations from stimulus to active tension.
pub trait CellModel: Send + Sync {
    /// Name as chosen in a run file: `coelho_2021`.
    fn name(&self) -> &'static str;
    /// One line for people.
    fn description(&self) -> &'static str;
    /// Keys in `references.bib` of the papers to cite.
    fn citations(&self) -> &'static [&'static str];
    /// The parameters with unit, range and source.
    fn parameters(&self) -> &ParameterSet;
    /// Names of the state variables, in the order of the state vector.
    fn state_names(&self) -> &'static [&'static str];
    /// The state at rest, before any stimulus.
    fn initial_state(&self) -> Vec<f64>;
    /// Writes d(state)/dt, 1/ms, into `rates`.
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]);
    /// Adds an instantaneous jump to the potential variable.
    fn jump(&self, state: &mut [f64], amplitude: f64);
    /// The potential variable, dimensionless.
    fn potential(&self, state: &[f64]) -> f64;
    /// Membrane potential, mV, where the model defines it.
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64>;
    /// Active tension, dimensionless, before scaling to kPa.
    fn tension(&self, state: &[f64]) -> f64;
}
