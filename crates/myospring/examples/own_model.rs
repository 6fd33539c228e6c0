//! A cell model of one's own, as docs/tutorials/own-model.md goes through it.
#![allow(clippy::print_stdout, reason = "an example talks")]

use myospring::cell::{Input, ModelError, StateVariable, Stimulation, TensionKind, required};
use myospring::parameter::{Parameter, ParameterSet};
use myospring::prelude::*;
use std::sync::Arc;

// tutorial: the model
/// The two equations of Aliev and Panfilov (1996), 12.9 ms for their unit of time, and a tension that follows the potential.
struct AlievPanfilov {
    parameters: ParameterSet,
    states: [StateVariable; 3],
    rate: f64,
    strongest: f64,
}

impl AlievPanfilov {
    fn new(parameters: ParameterSet) -> Result<Self, ModelError> {
        let read = |name| required("aliev_panfilov", &parameters, name);
        let state = |name: &'static str, unit: &'static str, meaning: &'static str| StateVariable {
            name: name.into(),
            unit: unit.into(),
            start: 0.0,
            meaning: meaning.into(),
        };
        Ok(Self {
            rate: read("r")?,
            strongest: read("T_max")?,
            states: [
                state("u", "", "potential"),
                state("v", "", "recovery"),
                state("Ta", "kPa", "active tension"),
            ],
            parameters,
        })
    }

    fn published() -> ParameterSet {
        let row = |name, value, unit, meaning| {
            Parameter::new(name, value, unit, [0.0, 1000.0], meaning, "made up for the tutorial")
        };
        ParameterSet::new(vec![
            row("r", 0.01, "1/ms", "rate of the tension"),
            row("T_max", 60.0, "kPa", "tension that a lasting action potential reaches"),
        ])
    }
}
// tutorial: end

// tutorial: the trait
impl CellModel for AlievPanfilov {
    fn name(&self) -> &'static str {
        "aliev_panfilov"
    }
    fn description(&self) -> &'static str {
        "Two variables of Aliev and Panfilov with a tension"
    }
    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }
    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self::new(parameters)?))
    }
    fn states(&self) -> &[StateVariable] {
        &self.states
    }
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        let &[u, v, tension] = state else { return };
        let recovery = 0.002 + 0.2 * v / (u + 0.3);
        rates[0] = (-8.0 * u * (u - 0.15) * (u - 1.0) - u * v) / 12.9 + input.stimulus;
        rates[1] = recovery * (-v - 8.0 * u * (u - 0.15 - 1.0)) / 12.9;
        rates[2] = self.rate * (self.strongest * u - tension);
    }
    fn stimulation(&self) -> Stimulation {
        Stimulation::of_first_state(Stimulus::Pulse { amplitude: 0.3, duration_ms: 2.0 })
    }
    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }
    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        Some(100.0 * state[0] - 80.0)
    }
    fn tension(&self, state: &[f64], _input: &Input) -> f64 {
        state[2]
    }
    fn tension_kind(&self) -> TensionKind {
        TensionKind::Kilopascal
    }
}
// tutorial: end

// tutorial: the beat
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model: Arc<dyn CellModel> = Arc::new(AlievPanfilov::new(AlievPanfilov::published())?);
    let mut simulation = Simulation::new(built_in::adult_ventricular_mesh());
    simulation.protocol = Protocol::once(model.stimulation().default);
    simulation.cell = model;
    simulation.numerics.method = Method::QuasiStatic;
    let beats = simulation.build()?.run(|_| true).beats();
    for metric in ["peak_tension", "peak_shortening", "action_potential_duration_90"] {
        println!("{metric}: {:.1}", beats[0].value(metric).unwrap_or(f64::NAN));
    }
    Ok(())
}
// tutorial: end
