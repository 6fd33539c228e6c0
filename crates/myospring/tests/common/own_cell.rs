//! A cell model that somebody wrote outside the library: membrane, calcium in a row of compartments with
//! buffers, and a tension in kPa. States, names and parameters are made when the program runs.
//!
//! Membrane: `G. W. Beeler and H. Reuter, J. Physiol. 268:177-210, 1977`, Eqs. (1)-(9) and Table 1, with 1 uF/cm^2,
//! so that their uA/cm^2 are A/F. Their calcium is that of the first compartment, here in uM; buffers,
//! diffusion and tension are made up to be stiff: by the defaults of 16 compartments the fastest rate is some
//! 10^4/ms, the slowest 10^-3/ms.
#![allow(dead_code, reason = "each program uses a part")]

use myospring::cell::pacing::Stimulus;
use myospring::cell::{
    CellModel, Gate, InFits, Input, ModelError, Moved, Output, StateVariable, Stimulation,
    TensionKind, required,
};
use myospring::parameter::{Parameter, ParameterSet};
use std::sync::Arc;

/// Name, `C_1` to `C_7` of opening and closing: `(C1 exp(C2 (V + C3)) + C4 (V + C5)) / (exp(C6 (V + C3)) + C7)`.
const GATES: [(&str, f64, [f64; 7], [f64; 7]); 6] = [
    (
        "m",
        0.011,
        [0.0, 0.0, 47.0, -1.0, 47.0, -0.1, -1.0],
        [40.0, -0.056, 72.0, 0.0, 0.0, 0.0, 0.0],
    ),
    ("h", 0.988, [0.126, -0.25, 77.0, 0.0, 0.0, 0.0, 0.0], [1.7, 0.0, 22.5, 0.0, 0.0, -0.082, 1.0]),
    ("j", 0.975, [0.055, -0.25, 78.0, 0.0, 0.0, -0.2, 1.0], [0.3, 0.0, 32.0, 0.0, 0.0, -0.1, 1.0]),
    (
        "d",
        0.003,
        [0.095, -0.01, -5.0, 0.0, 0.0, -0.072, 1.0],
        [0.07, -0.017, 44.0, 0.0, 0.0, 0.05, 1.0],
    ),
    (
        "f",
        0.994,
        [0.012, -0.008, 28.0, 0.0, 0.0, 0.15, 1.0],
        [0.0065, -0.02, 30.0, 0.0, 0.0, -0.2, 1.0],
    ),
    (
        "x1",
        0.0057,
        [0.0005, 0.083, 50.0, 0.0, 0.0, 0.057, 1.0],
        [0.0013, -0.06, 20.0, 0.0, 0.0, -0.04, 1.0],
    ),
];
const V: usize = 0;
const M: usize = 1;
const H: usize = 2;
const J: usize = 3;
const D: usize = 4;
const F: usize = 5;
const X1: usize = 6;
/// The first compartment.
const CA: usize = 7;

/// Calcium at rest, uM.
const RESTING_CALCIUM: f64 = 0.1;
/// Calcium per charge, uM/ms for 1 A/F, and its removal, 1/ms.
const CALCIUM_PER_CURRENT: f64 = 0.1;
const REMOVAL: f64 = 0.07;
/// Calcium of half activation, uM, steepness, and the time that tension takes, ms.
const HALF_CALCIUM: f64 = 1.0;
const STEEPNESS: i32 = 4;
const TENSION_TIME_MS: f64 = 30.0;

/// The model.
#[derive(Clone)]
pub(crate) struct OwnCell {
    name: String,
    parameters: ParameterSet,
    states: Vec<StateVariable>,
    outputs: Vec<Output>,
    gates: Vec<usize>,
    compartments: usize,
    with_jacobian: bool,
    slow_inward: f64,
    buffer: f64,
    binding: f64,
    release: f64,
    diffusion: f64,
    strongest: f64,
    /// The peak of its tension over `T_max`, where that is relative.
    relative_to: Option<f64>,
}

/// Its parameters; `binding` in 1/(uM ms).
pub(crate) fn parameters(binding: f64) -> ParameterSet {
    let row = |name, value, unit, meaning| {
        Parameter::new(name, value, unit, [0.0, 1e6], meaning, "made up")
    };
    ParameterSet::new(vec![
        row("g_s", 0.09, "mS/uF", "conductance of the slow inward current"),
        row("B_tot", 30.0, "uM", "buffer in each compartment"),
        row("k_on", binding, "1/(uM ms)", "binding of calcium to the buffer"),
        row("k_off", 3.0 * binding, "1/ms", "its release"),
        row("k_d", 30.0, "1/ms", "exchange between neighbouring compartments"),
        row("T_max", 60.0, "kPa", "tension at full activation"),
    ])
}

/// 10 states, mild enough for fixed steps.
pub(crate) fn mild() -> OwnCell {
    OwnCell::new(1, parameters(0.1)).unwrap_or_else(|error| panic!("{error}"))
}

/// 40 states, too stiff for fixed steps.
pub(crate) fn stiff() -> OwnCell {
    OwnCell::new(16, parameters(300.0)).unwrap_or_else(|error| panic!("{error}"))
}

impl OwnCell {
    pub(crate) fn new(compartments: usize, parameters: ParameterSet) -> Result<Self, ModelError> {
        let name = format!("own_{compartments}");
        let read = |of: &str| required(&name, &parameters, of);
        let (buffer, binding, release) = (read("B_tot")?, read("k_on")?, read("k_off")?);
        let bound = buffer * RESTING_CALCIUM / (RESTING_CALCIUM + release / binding);
        let variable = |name: String, unit: &'static str, start, meaning: String| StateVariable {
            name: name.into(),
            unit: unit.into(),
            start,
            meaning: meaning.into(),
        };
        let mut states = vec![variable("V".into(), "mV", -84.57, "membrane potential".into())];
        for (gate, start, ..) in GATES {
            states.push(variable(gate.into(), "", start, format!("gate {gate}")));
        }
        for k in 1..=compartments {
            let meaning = format!("free calcium in compartment {k}");
            states.push(variable(format!("Ca_{k}"), "uM", RESTING_CALCIUM, meaning));
        }
        for k in 1..=compartments {
            let meaning = format!("bound calcium in compartment {k}");
            states.push(variable(format!("B_{k}"), "uM", bound, meaning));
        }
        let active = activation(RESTING_CALCIUM);
        states.push(variable("A".into(), "", active, "activation of tension".into()));
        let output = |name: &'static str, unit: &'static str, meaning: &'static str| Output {
            name: name.into(),
            unit: unit.into(),
            meaning: meaning.into(),
        };
        Ok(Self {
            outputs: vec![
                output("Ca_mean", "uM", "mean free calcium"),
                output("I_s", "A/F", "slow inward current"),
            ],
            gates: (M..=X1).chain([CA + 2 * compartments]).collect(),
            compartments,
            with_jacobian: true,
            slow_inward: read("g_s")?,
            buffer,
            binding,
            release,
            diffusion: read("k_d")?,
            strongest: read("T_max")?,
            relative_to: None,
            states,
            name,
            parameters,
        })
    }

    /// The same without a Jacobian of its own.
    pub(crate) fn without_jacobian(self) -> Self {
        Self { with_jacobian: false, ..self }
    }

    /// The same with a relative tension, of which this is the peak of a default beat.
    pub(crate) fn relative(self, published_peak: f64) -> Self {
        Self { relative_to: Some(published_peak), ..self }
    }

    fn slow_inward_current(&self, state: &[f64]) -> f64 {
        // E_s = -82.3 - 13.0287 ln([Ca] in mol/l)
        let reversal = -82.3 - 13.0287 * (1e-6 * state[CA]).ln();
        self.slow_inward * state[D] * state[F] * (state[V] - reversal)
    }

    /// What flows from free to bound calcium in a compartment, uM/ms.
    fn bound(&self, free: f64, bound: f64) -> f64 {
        self.binding * free * (self.buffer - bound) - self.release * bound
    }
}

fn activation(calcium: f64) -> f64 {
    let part = (calcium / HALF_CALCIUM).powi(STEEPNESS);
    part / (1.0 + part)
}

/// A rate of a gate, 1/ms, and its slope, 1/(ms mV).
fn rate([c1, c2, c3, c4, c5, c6, c7]: [f64; 7], v: f64) -> [f64; 2] {
    let rising = c1 * (c2 * (v + c3)).exp();
    let (above, above_slope) = (rising + c4 * (v + c5), rising * c2 + c4);
    let growing = (c6 * (v + c3)).exp();
    let (below, below_slope) = (growing + c7, c6 * growing);
    if below.abs() < 1e-7 {
        // 0 / 0 at V = -c3, only for m: -x / (exp(-0.1 x) - 1) = 10 + x / 2 + ...
        return [c4 / c6 - c4 * (v + c5) / 2.0, -c4 / 2.0];
    }
    [above / below, (above_slope * below - above * below_slope) / (below * below)]
}

/// Outward currents of potassium without and with gate `x1` = 1, A/F, and their slopes.
fn potassium(v: f64) -> [[f64; 2]; 2] {
    let e = |slope: f64, at: f64| (slope * (v + at)).exp();
    let (above, below) = (4.0 * (e(0.04, 85.0) - 1.0), e(0.08, 53.0) + e(0.04, 53.0));
    let (above_slope, below_slope) =
        (0.16 * e(0.04, 85.0), 0.08 * e(0.08, 53.0) + 0.04 * e(0.04, 53.0));
    let x = v + 23.0;
    let (leak, leak_slope) = if x.abs() < 1e-5 {
        // x / (1 - exp(-0.04 x)) = 25 + x / 2 + ...
        (5.0 + 0.1 * x, 0.1)
    } else {
        let rest = 1.0 - (-0.04 * x).exp();
        (0.2 * x / rest, 0.2 * (rest - x * 0.04 * (-0.04 * x).exp()) / (rest * rest))
    };
    let slope = (above_slope * below - above * below_slope) / (below * below);
    [
        [0.35 * (above / below + leak), 0.35 * (slope + leak_slope)],
        [0.8 * (e(0.04, 77.0) - 1.0) / e(0.04, 35.0), 0.8 * 0.04 / e(0.04, 35.0)],
    ]
}

impl CellModel for OwnCell {
    fn name(&self) -> &str {
        &self.name
    }

    fn description(&self) -> &'static str {
        "Membrane of Beeler and Reuter with buffered calcium and a tension, for tests"
    }

    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }

    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        let Self { with_jacobian, relative_to, .. } = *self;
        let new = Self::new(self.compartments, parameters)?;
        Ok(Arc::new(Self { with_jacobian, relative_to, ..new }))
    }

    fn states(&self) -> &[StateVariable] {
        &self.states
    }

    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        let n = self.compartments;
        let v = state[V];
        let [[background, _], [gated, _]] = potassium(v);
        let sodium = (4.0 * state[M].powi(3) * state[H] * state[J] + 0.003) * (v - 50.0);
        let slow = self.slow_inward_current(state);
        rates[V] = input.stimulus - (background + state[X1] * gated + sodium + slow);
        for (k, (_, _, opening, closing)) in GATES.iter().enumerate() {
            let ([opens, _], [closes, _]) = (rate(*opening, v), rate(*closing, v));
            rates[M + k] = opens * (1.0 - state[M + k]) - closes * state[M + k];
        }
        for k in 0..n {
            let free = state[CA + k];
            let flow = self.bound(free, state[CA + n + k]);
            let left = if k > 0 { state[CA + k - 1] - free } else { 0.0 };
            let right = if k + 1 < n { state[CA + k + 1] - free } else { 0.0 };
            rates[CA + k] =
                REMOVAL * (RESTING_CALCIUM - free) - flow + self.diffusion * (left + right);
            rates[CA + n + k] = flow;
        }
        rates[CA] -= CALCIUM_PER_CURRENT * n as f64 * slow;
        let active = CA + 2 * n;
        rates[active] = (activation(state[CA + n - 1]) - state[active]) / TENSION_TIME_MS;
    }

    fn stimulation(&self) -> Stimulation {
        Stimulation {
            default: Stimulus::Pulse { amplitude: 52.0, duration_ms: 1.0 },
            current_unit: "A/F".to_owned().into(),
            moves: vec![Moved { state: V, weight: 1.0 }].into(),
        }
    }

    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[V])
    }

    fn membrane_potential_mv(&self, state: &[f64]) -> Option<f64> {
        Some(state[V])
    }

    fn tension(&self, state: &[f64], _input: &Input) -> f64 {
        let strongest = if self.relative_to.is_some() { 1.0 } else { self.strongest };
        strongest * (state[CA + 2 * self.compartments] - activation(RESTING_CALCIUM))
    }

    fn tension_kind(&self) -> TensionKind {
        match self.relative_to {
            Some(published_peak) => TensionKind::Relative { published_peak },
            None => TensionKind::Kilopascal,
        }
    }

    fn calcium_um(&self, state: &[f64], _input: &Input) -> Option<f64> {
        Some(state[CA])
    }

    fn in_fits(&self) -> InFits<'_> {
        InFits { strength: Some("T_max"), usual: &["g_s"], not_together: &[] }
    }

    fn outputs(&self) -> &[Output] {
        &self.outputs
    }

    fn write_outputs(&self, state: &[f64], _input: &Input, values: &mut [f64]) {
        let n = self.compartments;
        values[0] = state[CA..CA + n].iter().sum::<f64>() / n as f64;
        values[1] = self.slow_inward_current(state);
    }

    fn gates(&self) -> &[usize] {
        &self.gates
    }

    fn write_gates(&self, state: &[f64], _input: &Input, gates: &mut [Gate]) {
        for (gate, (_, _, opening, closing)) in gates.iter_mut().zip(GATES) {
            let ([opens, _], [closes, _]) = (rate(opening, state[V]), rate(closing, state[V]));
            let time_constant_ms = 1.0 / (opens + closes);
            *gate = Gate { steady_state: opens * time_constant_ms, time_constant_ms };
        }
        gates[GATES.len()] = Gate {
            steady_state: activation(state[CA + self.compartments - 1]),
            time_constant_ms: TENSION_TIME_MS,
        };
    }

    fn jacobian(&self, state: &[f64], _input: &Input, jacobian: &mut [f64]) -> bool {
        if !self.with_jacobian {
            return false;
        }
        let (n, size) = (self.compartments, state.len());
        jacobian.fill(0.0);
        let mut set =
            |row: usize, column: usize, value: f64| jacobian[row * size + column] += value;
        let [v, m, h, j] = [V, M, H, J].map(|place| state[place]);
        let [[_, background], [gated, gated_slope]] = potassium(v);
        set(V, V, -(background + state[X1] * gated_slope + 4.0 * m.powi(3) * h * j + 0.003));
        set(V, X1, -gated);
        set(V, M, -12.0 * m * m * h * j * (v - 50.0));
        set(V, H, -4.0 * m.powi(3) * j * (v - 50.0));
        set(V, J, -4.0 * m.powi(3) * h * (v - 50.0));
        let open = self.slow_inward * state[D] * state[F];
        let driving = v + 82.3 + 13.0287 * (1e-6 * state[CA]).ln();
        for (column, slope) in [
            (V, open),
            (D, self.slow_inward * state[F] * driving),
            (F, self.slow_inward * state[D] * driving),
            (CA, open * 13.0287 / state[CA]),
        ] {
            set(V, column, -slope);
            set(CA, column, -CALCIUM_PER_CURRENT * n as f64 * slope);
        }
        for (k, (_, _, opening, closing)) in GATES.iter().enumerate() {
            let (place, x) = (M + k, state[M + k]);
            let ([opens, opens_slope], [closes, closes_slope]) =
                (rate(*opening, v), rate(*closing, v));
            set(place, place, -(opens + closes));
            set(place, V, opens_slope * (1.0 - x) - closes_slope * x);
        }
        for k in 0..n {
            let (free, bound) = (CA + k, CA + n + k);
            let by_free = self.binding * (self.buffer - state[bound]);
            let by_bound = -self.binding * state[free] - self.release;
            set(free, free, -REMOVAL - by_free);
            set(free, bound, -by_bound);
            set(bound, free, by_free);
            set(bound, bound, by_bound);
            for other in [k.checked_sub(1), (k + 1 < n).then_some(k + 1)].into_iter().flatten() {
                set(free, CA + other, self.diffusion);
                set(free, free, -self.diffusion);
            }
        }
        let (active, calcium) = (CA + 2 * n, CA + n - 1);
        let part = (state[calcium] / HALF_CALCIUM).powi(STEEPNESS);
        let slope = f64::from(STEEPNESS) * part / (state[calcium] * (1.0 + part).powi(2));
        set(active, calcium, slope / TENSION_TIME_MS);
        set(active, active, -1.0 / TENSION_TIME_MS);
        true
    }
}
