//! A cell model from equations as data: what a model file becomes.
//!
//! [`EquationModel`] is a [`CellModel`] like any other: its parameters are the constants of the
//! equations, its outputs their other variables. The equations are compiled once
//! (module `tape`); the Jacobian is exact. A model with calcium can take the myofilaments of
//! `land_2017` ([`EquationModel::with_myofilaments`]), which give it tension in kPa.
//!
//! # Example
//! A membrane that relaxes to -80 mV within 10 ms:
//! ```
//! use myospring::cell::{CellModel, equation_model::{EquationModel, example}};
//! let model = EquationModel::new(example::decay())?;
//! let mut rates = [0.0];
//! model.derivatives(&[-70.0], &myospring::cell::Input::REST, &mut rates);
//! assert_eq!(rates, [-1.0]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod build;
mod describe;
pub mod example;
mod graphs;
mod jumps;
#[cfg(test)]
mod tests;

use super::cell_model::{CellModel, Filaments, InFits, SideBySide};
use super::description::{
    Gate, Input, ModelError, Output, StateVariable, Stimulation, TensionKind,
};
use super::equations::Equations;
use super::land_2017::{self, Myofilaments};
use super::settings::{CellMethod, SolverSettings};
use super::tape::{Compiled, OnTape, Outside};
use crate::parameter::ParameterSet;
use describe::Names;
use std::sync::Arc;

/// A cell model from equations as data.
#[derive(Debug, Clone)]
pub struct EquationModel {
    shared: Arc<Shared>,
    parameters: ParameterSet,
    compiled: Compiled,
    myofilaments: Option<Myofilaments>,
    states: Arc<[StateVariable]>,
    stimulation: Stimulation,
}

/// What does not depend on the values of parameters.
#[derive(Debug)]
struct Shared {
    equations: Equations,
    name: String,
    description: String,
    names: Names,
    outputs: Vec<Output>,
    recorded: Vec<usize>,
    /// Where potential, calcium and tension are read, with factors to mV, uM and kPa.
    millivolts: Option<(Reading, f64)>,
    micromolar: Option<(Reading, f64)>,
    kilopascals: Option<(Reading, f64)>,
    tension: TensionKind,
    jumps: bool,
}

/// Where a variable is read.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Reading {
    /// A state, by index.
    State(usize),
    /// An observed value, by index.
    Observed(usize),
    /// A parameter, by index.
    Parameter(usize),
}

fn outside(input: &Input) -> Outside {
    let Input { stimulus, stretch, stretch_rate, time_ms, .. } = *input;
    Outside { stimulus, time_ms, stretch, stretch_rate }
}

impl EquationModel {
    /// The equations from which it was made.
    pub fn equations(&self) -> &Equations {
        &self.shared.equations
    }

    /// Whether it has the myofilaments of `land_2017`.
    pub fn has_myofilaments(&self) -> bool {
        self.myofilaments.is_some()
    }

    fn observe(&self, state: &[f64], input: &Input) -> Vec<f64> {
        self.compiled.program.observe(&self.compiled.fixed, state, &outside(input))
    }

    fn read(&self, reading: Reading, state: &[f64], input: &Input) -> f64 {
        match reading {
            Reading::State(index) => state[index],
            Reading::Observed(index) => self.observe(state, input)[index],
            Reading::Parameter(index) => self.parameters.rows()[index].value,
        }
    }

    /// Index of the first state of the myofilaments.
    fn first_filament(&self) -> usize {
        self.shared.equations.states.len()
    }
}

impl CellModel for EquationModel {
    fn name(&self) -> &str {
        &self.shared.name
    }

    fn description(&self) -> &str {
        &self.shared.description
    }

    fn citations(&self) -> Vec<&str> {
        if self.has_myofilaments() { vec!["land_2017", "margara_2021"] } else { Vec::new() }
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(self.rebuilt(parameters)?))
    }

    fn states(&self) -> &[StateVariable] {
        &self.states
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        let Compiled { program, fixed, .. } = &self.compiled;
        program.write_rates(fixed, state, &outside(input), rates);
    }

    fn jacobian(&self, state: &[f64], input: &Input, jacobian: &mut [f64]) -> bool {
        let Compiled { program, fixed, .. } = &self.compiled;
        program.write_jacobian(fixed, state, &outside(input), jacobian);
        true
    }

    fn stimulation(&self) -> Stimulation {
        self.stimulation.clone()
    }

    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[self.shared.equations.roles.potential.state])
    }

    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        let (reading, factor) = self.shared.millivolts?;
        Some(factor * self.read(reading, state, &Input::REST))
    }

    fn calcium_um(&self, state: &[f64], input: &Input) -> Option<f64> {
        let (reading, factor) = self.shared.micromolar?;
        Some(factor * self.read(reading, state, input))
    }

    fn tension(&self, state: &[f64], input: &Input) -> f64 {
        if let Some(myofilaments) = &self.myofilaments {
            let first = self.first_filament();
            let six = std::array::from_fn(|k| state[first + k]);
            return myofilaments.tension(&six, input.stretch);
        }
        let tension = self.shared.kilopascals;
        tension.map_or(0.0, |(reading, factor)| factor * self.read(reading, state, input))
    }

    fn tension_kind(&self) -> TensionKind {
        self.shared.tension
    }

    fn outputs(&self) -> &[Output] {
        &self.shared.outputs
    }

    fn write_outputs(&self, state: &[f64], input: &Input, values: &mut [f64]) {
        let observed = self.observe(state, input);
        for (value, observed) in values.iter_mut().zip(observed) {
            *value = observed;
        }
    }

    fn recorded_states(&self) -> &[usize] {
        &self.shared.recorded
    }

    fn gates(&self) -> &[usize] {
        self.compiled.program.gates()
    }

    fn write_gates(&self, state: &[f64], input: &Input, gates: &mut [Gate]) {
        let Compiled { program, fixed, .. } = &self.compiled;
        let rates = program.gate_rates(fixed, state, &outside(input));
        for ((gate, place), [rate, slope]) in gates.iter_mut().zip(program.gates()).zip(rates) {
            // dx/dt = a - b x with b = -slope: x_inf = x - rate / slope
            let steady_state = state[*place] - rate / slope;
            *gate = Gate { steady_state, time_constant_ms: -1.0 / slope };
        }
    }

    fn jumps(&self) -> bool {
        self.shared.jumps
    }

    fn feels_stretch(&self) -> bool {
        self.has_myofilaments()
    }

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        // Lanes have no clock.
        (!self.shared.jumps && !self.compiled.program.follows_time()).then_some(self)
    }

    fn equations_read(&self) -> Option<&Equations> {
        Some(&self.shared.equations)
    }

    fn filaments(&self) -> Option<Filaments<'_>> {
        let equations = self.myofilaments.as_ref()?;
        Some(Filaments { equations, first: self.first_filament(), calcium: None })
    }

    fn in_fits(&self) -> InFits<'_> {
        if self.has_myofilaments() { land_2017::IN_FITS } else { InFits::default() }
    }

    fn usual_settings(&self) -> SolverSettings {
        if self.shared.jumps {
            SolverSettings::of(CellMethod::RungeKutta4)
        } else {
            SolverSettings::of(CellMethod::Stiff)
        }
    }
}

impl OnTape for EquationModel {
    fn compiled(&self) -> Compiled {
        self.compiled.clone()
    }
}
