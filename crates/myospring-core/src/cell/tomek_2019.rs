//! The human ventricular cell ToR-ORd: `tomek_2019`, endo, epi and mid.
//!
//! Membrane, sodium, potassium and calcium with their stores, and CaM kinase. Equations and values follow the paper
//! and the code that its authors publish (<https://github.com/jtmff/torord>), which later moved chloride, too.
//!
//! The equations are generic over the type of number, with one file per group of currents; the
//! Jacobian comes from them by forward differentiation, and the tape with which many cells are
//! integrated side by side by recording them.
#![allow(clippy::doc_markdown, reason = "currents and gates have the names of the paper")]

mod calcium;
mod calcium_channel;
mod compiled;
mod equations;
mod exchange;
mod gate;
mod membrane;
mod parameters;
mod potassium;
mod rates;
mod sodium;
mod start;
mod state;
mod table;

use super::cell_model::{CellModel, Filaments, InFits, SideBySide};
use super::description::{
    Gate, Input, ModelError, Moved, Output, StateVariable, Stimulation, TensionKind,
};
use super::land_2017::{self, Myofilaments};
use super::pacing::Stimulus;
use super::settings::{CellMethod, SolverSettings};
use super::tape::{Compiled, OnTape};
use crate::parameter::ParameterSet;
use equations::{BEHIND, Constants, Form, GATES, Outside, Parts, derivatives};
use gate::Moving;
use membrane::PER_CURRENT_I;
use std::sync::{Arc, LazyLock};

/// Layer of the ventricular wall.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layer {
    /// Inner wall.
    Endo,
    /// Outer wall.
    Epi,
    /// Between them.
    Mid,
}

impl Layer {
    /// All layers.
    pub const ALL: [Self; 3] = [Self::Endo, Self::Epi, Self::Mid];
}

/// Form of the model.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// As in the paper: 43 states, chloride is constant.
    Published,
    /// Dynamic chloride: 45 states.
    MovingChloride,
    /// With the myofilaments of `land_2017`, which generate tension, depend on stretch and bind
    /// calcium to troponin: 49 states (`margara_2021`).
    Land,
}

/// The ToR-ORd model with its parameters.
#[derive(Debug, Clone)]
pub struct TomekModel {
    layer: Layer,
    variant: Variant,
    constants: Constants<f64>,
    parameters: ParameterSet,
}

/// Index of cytosolic calcium, mM.
const CALCIUM: usize = 5;

/// Recovery of I_CaL, which is faster with dynamic chloride, ms.
const TAU_J_CA: [f64; 3] = [75.0, 72.5, 75.0];

const NAMES: [[&str; 3]; 3] = [
    ["tor_ord_endo", "tor_ord_epi", "tor_ord_mid"],
    ["tor_ord_dyn_cl_endo", "tor_ord_dyn_cl_epi", "tor_ord_dyn_cl_mid"],
    ["tor_ord_land", "tor_ord_land_epi", "tor_ord_land_mid"],
];
const DESCRIPTIONS: [[&str; 3]; 3] = [
    [
        "Human ventricular endocardial cell ToR-ORd: potential and calcium, no tension",
        "Human ventricular epicardial cell ToR-ORd: potential and calcium, no tension",
        "Human midmyocardial cell ToR-ORd: potential and calcium, no tension",
    ],
    [
        "Human ventricular endocardial cell ToR-ORd with dynamic chloride, no tension",
        "Human ventricular epicardial cell ToR-ORd with dynamic chloride, no tension",
        "Human midmyocardial cell ToR-ORd with dynamic chloride, no tension",
    ],
    [
        "Human ventricular endocardial cell: calcium, myofilaments that depend on length and speed",
        "Human ventricular epicardial cell: calcium, myofilaments that depend on length and speed",
        "Human midmyocardial cell: calcium, myofilaments that depend on length and speed",
    ],
];

/// The published parameters.
pub fn parameters(layer: Layer, variant: Variant) -> ParameterSet {
    let mut rows = parameters::rows(layer as usize, TAU_J_CA[variant as usize]);
    if variant == Variant::Land {
        rows.extend(land_2017::rows());
    }
    let mut set = ParameterSet::new(rows);
    if (layer, variant) == (Layer::Mid, Variant::Land)
        && let Err(error) = set.set("P_Ca", parameters::P_CA_MID_LAND)
    {
        unreachable!("published set: {error}");
    }
    set
}

impl TomekModel {
    /// The model with the published parameters.
    ///
    /// # Example
    /// ```
    /// use myospring::cell::{CellModel, tomek_2019::{Layer, TomekModel, Variant}};
    /// let endo = TomekModel::published(Layer::Endo, Variant::Published);
    /// assert_eq!(endo.states().len(), 43);
    /// ```
    pub fn published(layer: Layer, variant: Variant) -> Self {
        match Self::new(layer, variant, parameters(layer, variant)) {
            Ok(model) => model,
            Err(error) => unreachable!("published set: {error}"),
        }
    }

    /// The model with other parameters.
    ///
    /// # Errors
    /// A parameter is missing.
    pub fn new(
        layer: Layer,
        variant: Variant,
        parameters: ParameterSet,
    ) -> Result<Self, ModelError> {
        let form = match variant {
            Variant::Published => Form::Published,
            Variant::MovingChloride => Form::MovingChloride,
            Variant::Land => Form::Land,
        };
        let name = NAMES[variant as usize][layer as usize];
        let myofilaments = match variant {
            Variant::Land => Myofilaments::new(name, &parameters)?,
            _ => Myofilaments::published(),
        };
        let read = parameters::read(name, &parameters)?;
        let constants = Constants { form, parameters: read, myofilaments };
        Ok(Self { layer, variant, constants, parameters })
    }

    /// Which form of the model it is.
    pub fn variant(&self) -> Variant {
        self.variant
    }

    fn all_states(layer: Layer, variant: Variant) -> Vec<StateVariable> {
        let layer = layer as usize;
        let start = &start::START[3 * variant as usize + layer];
        let rows = state::ROWS.iter().chain(&state::GATES).zip(start);
        let variable = |(&(name, unit, meaning), start): (&state::Row, &f64)| StateVariable {
            name: name.into(),
            unit: unit.into(),
            start: *start,
            meaning: meaning.into(),
        };
        let mut states: Vec<StateVariable> = rows.map(variable).collect();
        match variant {
            Variant::Published => {}
            Variant::MovingChloride => {
                let chloride = state::CHLORIDE.iter().zip(&start::CHLORIDE[layer]);
                states.extend(chloride.map(variable));
            }
            Variant::Land => states.extend(land_2017::states(start::LAND[layer])),
        }
        states
    }

    /// The states of the myofilaments, for a model with myofilaments.
    fn myofilaments(state: &[f64]) -> [f64; land_2017::STATES] {
        std::array::from_fn(|k| state[BEHIND + k])
    }
}

fn outside(input: &Input) -> Outside<f64> {
    let Input { stimulus, stretch, stretch_rate, .. } = *input;
    Outside { stimulus, stretch, stretch_rate }
}

static STATES: LazyLock<[[Vec<StateVariable>; 3]; 3]> = LazyLock::new(|| {
    [Variant::Published, Variant::MovingChloride, Variant::Land]
        .map(|variant| Layer::ALL.map(|layer| TomekModel::all_states(layer, variant)))
});

static OUTPUTS: LazyLock<Vec<Output>> = LazyLock::new(|| {
    let rows = [
        ("Ca_i", "uM", "free calcium in the cytosol"),
        ("I_Na", "A/F", "fast sodium current"),
        ("I_NaL", "A/F", "late sodium current"),
        ("I_to", "A/F", "transient outward potassium current"),
        ("I_CaL", "A/F", "L-type calcium current, of calcium"),
        ("I_Kr", "A/F", "rapid delayed rectifier"),
        ("I_Ks", "A/F", "slow delayed rectifier"),
        ("I_K1", "A/F", "inward rectifier"),
        ("I_NaCa", "A/F", "sodium-calcium exchange"),
        ("I_NaK", "A/F", "sodium-potassium pump"),
        ("J_rel", "mM/ms", "release from the junctional reticulum"),
        ("J_up", "mM/ms", "uptake into the network of the reticulum"),
    ];
    let output = |(name, unit, meaning): (&'static str, &'static str, &'static str)| Output {
        name: name.into(),
        unit: unit.into(),
        meaning: meaning.into(),
    };
    rows.map(output).to_vec()
});

/// Indices of the gates.
static GATE_PLACES: LazyLock<Vec<usize>> = LazyLock::new(|| (GATES..BEHIND).collect());

impl CellModel for TomekModel {
    fn name(&self) -> &'static str {
        NAMES[self.variant as usize][self.layer as usize]
    }

    fn description(&self) -> &'static str {
        DESCRIPTIONS[self.variant as usize][self.layer as usize]
    }

    fn citations(&self) -> Vec<&str> {
        match self.variant {
            Variant::Land => vec!["tomek_2019", "margara_2021", "land_2017", "o_hara_2011"],
            _ => vec!["tomek_2019", "o_hara_2011"],
        }
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self::new(self.layer, self.variant, parameters)?))
    }

    fn states(&self) -> &[StateVariable] {
        &STATES[self.variant as usize][self.layer as usize]
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        derivatives(&self.constants, state, &outside(input), rates);
    }

    fn stimulation(&self) -> Stimulation {
        Stimulation {
            default: Stimulus::Pulse { amplitude: 53.0, duration_ms: 1.0 },
            current_unit: "A/F".into(),
            // The stimulus current is carried by potassium.
            moves: vec![Moved { state: 0, weight: 1.0 }, Moved { state: 3, weight: PER_CURRENT_I }]
                .into(),
        }
    }

    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }

    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }

    fn tension(&self, state: &[f64], input: &Input) -> f64 {
        if self.variant != Variant::Land {
            return 0.0;
        }
        self.constants.myofilaments.tension(&Self::myofilaments(state), input.stretch)
    }

    fn tension_kind(&self) -> TensionKind {
        match self.variant {
            Variant::Land => TensionKind::Kilopascal,
            _ => TensionKind::None,
        }
    }

    fn outputs(&self) -> &[Output] {
        &OUTPUTS
    }

    fn write_outputs(&self, state: &[f64], _input: &Input, values: &mut [f64]) {
        let parts = Parts::of(self.constants.form, state);
        let flows = parts.flows(&self.constants.parameters);
        let (sodium, potassium) = (flows.sodium, flows.potassium);
        let (calcium, exchange) = (flows.calcium_channel, flows.exchange);
        values.copy_from_slice(&[
            1e3 * parts.state.ca_i,
            sodium.fast,
            sodium.late,
            potassium.transient,
            calcium.ca_i + calcium.ca_ss,
            potassium.rapid,
            potassium.slow,
            potassium.inward,
            exchange.na_ca_i + exchange.na_ca_ss,
            exchange.na_k,
            flows.fluxes.release,
            flows.fluxes.uptake,
        ]);
    }

    fn calcium_um(&self, state: &[f64], _input: &Input) -> Option<f64> {
        Some(1e3 * state[CALCIUM])
    }

    fn side_by_side(&self) -> Option<&dyn SideBySide> {
        Some(self)
    }

    fn filaments(&self) -> Option<Filaments<'_>> {
        let equations = &self.constants.myofilaments;
        let pull = self.variant == Variant::Land;
        pull.then_some(Filaments { equations, first: BEHIND, calcium: None })
    }

    fn in_fits(&self) -> InFits<'_> {
        match self.variant {
            Variant::Land => land_2017::IN_FITS,
            _ => InFits::default(),
        }
    }

    fn gates(&self) -> &[usize] {
        &GATE_PLACES
    }

    fn write_gates(&self, state: &[f64], _input: &Input, gates: &mut [Gate]) {
        let mut places = gates.iter_mut();
        rates::gates(&self.constants.parameters, state[0]).give(&mut |gate: Moving<f64>| {
            if let Some(place) = places.next() {
                *place =
                    Gate { steady_state: gate.steady_state, time_constant_ms: 1.0 / gate.rate };
            }
        });
    }

    fn jacobian(&self, state: &[f64], input: &Input, jacobian: &mut [f64]) -> bool {
        equations::jacobian(&self.constants, state, &outside(input), jacobian);
        true
    }

    fn recorded_states(&self) -> &[usize] {
        // The potential is always recorded.
        static ALL: LazyLock<Vec<usize>> = LazyLock::new(|| (1..Form::Land.len()).collect());
        &ALL[..self.constants.form.len() - 1]
    }

    fn usual_settings(&self) -> SolverSettings {
        SolverSettings::of(CellMethod::Stiff)
    }

    fn longest_rest_ms(&self) -> f64 {
        // Measured human muscle is 2.2 times as strong after 120 s of rest, but the model falls to
        // 0.15 of its strength.
        5000.0
    }

    fn feels_stretch(&self) -> bool {
        self.variant == Variant::Land
    }
}

impl OnTape for TomekModel {
    fn compiled(&self) -> Compiled {
        compiled::compiled(&self.constants, CALCIUM)
    }
}
