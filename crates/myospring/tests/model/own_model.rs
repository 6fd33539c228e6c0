//! A cell model that the library does not know runs end to end: alone by every method, and in a cell.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

#[path = "../common/own_cell.rs"]
mod own_cell;

use myospring::cell::adaptive::{self, AdaptiveIntegrator};
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{self, CellMethod, SolveError, SolverSettings, solve};
use myospring::cell::toy::ToyModel;
use myospring::cell::trace::CellTrace;
use myospring::cell::{
    CellModel, Input, ModelError, Moved, StateVariable, Stimulation, TensionKind, coelho_2021,
};
use myospring::integrate::Method as Way;
use myospring::integrate::quasi_static::Tolerance;
use myospring::integrate::verlet::Integrator;
use myospring::mesh::lattice;
use myospring::parameter::ParameterSet;
use myospring::simulation::Simulation;
use myospring::testing::cell_model::{check_cell_model, check_cell_model_with};
use myospring::units::Dimension;
use own_cell::OwnCell;
use std::sync::Arc;

fn beat(model: &OwnCell, settings: SolverSettings) -> CellTrace {
    solve(model, Protocol::once(model.default_stimulus()), settings, 600.0, 1.0).unwrap()
}

fn exact(model: &OwnCell) -> CellTrace {
    beat(model, SolverSettings { tolerance: 1e-9, ..SolverSettings::of(CellMethod::Stiff) })
}

/// Largest difference of a column from another course of it, over its range.
fn difference(name: &str, a: &CellTrace, b: &CellTrace) -> f64 {
    let [a, b] = [a, b].map(|trace| trace.variable(name).unwrap());
    let low = b.iter().copied().fold(f64::MAX, f64::min);
    let high = b.iter().copied().fold(f64::MIN, f64::max);
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / (high - low)
}

fn largest_difference(a: &CellTrace, b: &CellTrace) -> f64 {
    let names = b.state_names.iter().chain(&b.output_names);
    names.map(|name| difference(name, a, b)).fold(0.0, f64::max)
}

#[test]
fn models_made_at_run_time_hold_to_the_promises() {
    check_cell_model(own_cell::mild());
    check_cell_model(own_cell::mild().without_jacobian());
    let stiff: Arc<dyn CellModel> = Arc::new(own_cell::stiff());
    assert_eq!(stiff.states().len(), 40);
    check_cell_model_with(&stiff, SolverSettings::of(CellMethod::Stiff));
}

#[test]
fn what_the_model_says_of_itself_is_in_units_that_are_read() {
    let model = own_cell::stiff();
    let states = model.states().iter().map(|state| &state.unit);
    let outputs = model.outputs().iter().map(|output| &output.unit);
    for unit in states.chain(outputs) {
        assert!(Dimension::of_unit(unit).is_some(), "`{unit}`");
    }
    let unit = |name: &str| {
        let rows = model.parameters().rows();
        Dimension::of_unit(&rows.iter().find(|row| row.name == name).unwrap().unit)
    };
    assert_eq!(unit("g_s"), Some(Dimension::ConductanceDensity));
    assert_eq!(unit("B_tot"), Some(Dimension::Concentration));
    assert_eq!(
        Dimension::of_unit(&model.stimulation().current_unit),
        Some(Dimension::CurrentDensity)
    );
}

#[test]
fn every_method_that_fits_gives_the_same_beat() {
    let model = own_cell::mild();
    let exact = exact(&model);
    // The peak of the action potential, and a transient of calcium that comes back.
    assert!((20.0..40.0).contains(&exact.peak_potential().unwrap().value));
    let calcium = exact.variable("Ca_mean").unwrap();
    let largest = calcium.iter().copied().fold(0.0, f64::max);
    assert!(largest > 20.0 * calcium[0] && calcium[600] < 0.1 * largest, "{largest} uM");
    for (method, bound) in [
        (CellMethod::RungeKutta4, 1e-6),
        (CellMethod::Stiff, 1e-4),
        // Order 1: late by part of a step, at 200 mV/ms on the way up.
        (CellMethod::ForwardEuler, 0.02),
        (CellMethod::RushLarsen, 0.02),
    ] {
        let trace = beat(&model, SolverSettings::of(method));
        let off = largest_difference(&trace, &exact);
        assert!(off < bound, "{method}: {off:e}");
        assert!((trace.peak_tension().unwrap().value / 59.899 - 1.0).abs() < 1e-3, "{method}");
    }
}

#[test]
fn gates_of_their_own_let_rush_larsen_step_where_euler_cannot() {
    let model = own_cell::mild();
    let exact = exact(&model);
    let run = |method, step_ms| {
        let settings = SolverSettings { step_ms, ..SolverSettings::of(method) };
        solve(&model, Protocol::once(model.default_stimulus()), settings, 600.0, 1.0)
    };
    let off = |step_ms| difference("V", &run(CellMethod::RushLarsen, step_ms).unwrap(), &exact);
    let order = (off(0.005) / off(0.0025)).log2();
    assert!((order - 1.0).abs() < 0.06, "{order}");
    // m takes 0.012 ms at rest: forward Euler is unstable from 0.025 ms on.
    assert!(off(0.04) < 0.15, "{}", off(0.04));
    let euler = run(CellMethod::ForwardEuler, 0.04).map(|trace| difference("V", &trace, &exact));
    assert!(euler.as_ref().map_or(true, |off| *off > 1.0), "{euler:?}");
}

#[test]
fn forty_stiff_states_need_stiff_steps_and_get_them_as_exact_as_asked() {
    let model = own_cell::stiff();
    let fixed = solve(
        &model,
        Protocol::once(model.default_stimulus()),
        SolverSettings::default(),
        600.0,
        1.0,
    );
    assert!(matches!(fixed, Err(SolveError::NotFinite { .. })));
    let exact = exact(&model);
    for tolerance in [1e-3, 1e-4, 1e-5, 1e-6, 1e-7] {
        let settings = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
        // Measured: 0.6 to 1.9 times the tolerance.
        let off = largest_difference(&beat(&model, settings), &exact);
        assert!(off < 5.0 * tolerance, "{tolerance:e}: {off:e}");
        let by_differences = beat(&model.clone().without_jacobian(), settings);
        let off = largest_difference(&by_differences, &exact);
        assert!(off < 5.0 * tolerance, "{tolerance:e}, by differences: {off:e}");
    }
}

#[test]
fn a_cell_that_no_stiff_step_takes_further_is_named_with_its_state_and_time() {
    let model = own_cell::mild();
    let protocol = Protocol::once(Stimulus::Jump { amplitude: 1e200 });
    let error =
        solve(&model, protocol, SolverSettings::of(CellMethod::Stiff), 100.0, 1.0).unwrap_err();
    assert!(matches!(error, SolveError::Stalled { .. }), "{error}");
    assert!(error.to_string().contains("`own_1` cannot be integrated beyond 50 ms"), "{error}");
}

#[test]
fn adaptive_steps_by_name_are_those_of_the_adaptive_integrator() {
    let model = coelho_2021::model();
    let protocol = Protocol::once(model.default_stimulus());
    let own = adaptive::AdaptiveSettings::default();
    let mut alone = AdaptiveIntegrator::new(&model, protocol, own).unwrap();
    let settings = SolverSettings::of(CellMethod::Adaptive);
    let mut cell = CellIntegrator::new(Arc::new(model), protocol, settings).unwrap();
    for time in [0.3, 49.0, 50.0, 51.7, 170.0, 600.0] {
        alone.advance_to(time).unwrap();
        cell.advance_to(time, 0.9, 0.0).unwrap();
        assert_eq!((cell.time(), cell.state()), (time, alone.state()));
    }
}

#[test]
fn a_method_that_the_model_is_not_made_for_is_refused_with_what_serves_instead() {
    let refusal = |model: Arc<dyn CellModel>, method| {
        let settings = SolverSettings::of(method);
        CellIntegrator::new(model, Protocol::rest(), settings).err().unwrap().to_string()
    };
    let own = || Arc::new(own_cell::mild());
    for (message, parts) in [
        (refusal(own(), CellMethod::Adaptive), ["`own_1`", "`adaptive`", "the minimal model only"]),
        (refusal(own(), CellMethod::StaggeredEuler), ["`own_1`", "`staggered-euler`", "`stiff`"]),
        (
            refusal(Arc::new(ToyModel::published()), CellMethod::RushLarsen),
            ["`toy_alpha`", "`rush-larsen`", "names its gates"],
        ),
        (
            refusal(Arc::new(coelho_2021::model()), CellMethod::Stiff),
            ["`coelho_2021`", "where equations jump", "take `adaptive`"],
        ),
    ] {
        for part in parts {
            assert!(message.contains(part), "{message}");
        }
    }
}

#[test]
fn a_jump_moves_every_state_of_the_stimulus_in_proportion() {
    let model = own_cell::mild();
    let protocol = Protocol { start_ms: 0.0, ..Protocol::once(Stimulus::Jump { amplitude: 20.0 }) };
    for method in [CellMethod::RungeKutta4, CellMethod::Stiff] {
        let own: Arc<dyn CellModel> = Arc::new(model.clone());
        let cell = CellIntegrator::new(own, protocol, SolverSettings::of(method)).unwrap();
        let mut expected = model.initial_state();
        expected[0] += 20.0;
        assert_eq!(cell.state(), expected, "{method}");
        let two: Arc<dyn CellModel> = Arc::new(follower());
        let cell = CellIntegrator::new(two, protocol, SolverSettings::of(method)).unwrap();
        assert_eq!(cell.state(), [21.0, -5.0], "{method}");
    }
}

#[test]
fn its_tension_in_kilopascal_drives_a_cell_as_it_is() {
    let model = own_cell::stiff();
    let own = solve::reference_beat(&model, SolverSettings::of(CellMethod::Stiff)).unwrap();
    let mut simulation = Simulation {
        protocol: Protocol::once(model.default_stimulus()),
        cell: Arc::new(model.clone()),
        peak_tension: 20.0,
        ..Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap())
    };
    simulation.numerics.cell = Some(SolverSettings::of(CellMethod::Stiff));
    let outcome = simulation.prepare().unwrap().run(|_| true);
    assert_eq!(outcome.stop, None);
    let samples = &outcome.recording.samples;
    let largest = samples.iter().map(|sample| sample.ta_kpa).fold(0.0, f64::max);
    // Samples each 0.5 ms miss a flat peak by less.
    assert!((largest / own.peak_tension - 1.0).abs() < 1e-4, "{largest} kPa");
    let shortening = samples.iter().map(|sample| sample.shortening_pct).fold(0.0, f64::max);
    assert!(shortening > 10.0, "{shortening} %");
    assert!(samples.iter().all(|sample| sample.vm_mv == sample.u));
}

/// A model that feels, made of its states and two functions.
struct Feeling {
    parameters: ParameterSet,
    states: Vec<StateVariable>,
    stimulation: Stimulation,
    rates: fn(&[f64], &Input, &mut [f64]),
    tension: fn(&[f64]) -> f64,
}

impl Feeling {
    fn new(
        states: &[(&'static str, f64)],
        rates: fn(&[f64], &Input, &mut [f64]),
        tension: fn(&[f64]) -> f64,
    ) -> Self {
        let state = |&(name, start): &(&'static str, f64)| StateVariable {
            name: name.into(),
            unit: "".into(),
            start,
            meaning: "what follows from what it felt".into(),
        };
        Self {
            parameters: ParameterSet::new(Vec::new()),
            states: states.iter().map(state).collect(),
            stimulation: Stimulation::of_first_state(Stimulus::Jump { amplitude: 0.0 }),
            rates,
            tension,
        }
    }
}

impl CellModel for Feeling {
    fn name(&self) -> &'static str {
        "feeling"
    }
    fn description(&self) -> &'static str {
        "follows what it feels"
    }
    fn parameters(&self) -> &ParameterSet {
        &self.parameters
    }
    fn with_parameters(&self, parameters: ParameterSet) -> Result<Arc<dyn CellModel>, ModelError> {
        Ok(Arc::new(Self {
            parameters,
            states: self.states.clone(),
            stimulation: self.stimulation.clone(),
            ..*self
        }))
    }
    fn states(&self) -> &[StateVariable] {
        &self.states
    }
    fn derivatives(&self, state: &[f64], input: &Input, rates: &mut [f64]) {
        (self.rates)(state, input, rates);
    }
    fn stimulation(&self) -> Stimulation {
        self.stimulation.clone()
    }
    fn potential(&self, state: &[f64]) -> Option<f64> {
        Some(state[0])
    }
    fn membrane_potential_mv(&self, _: &[f64]) -> Option<f64> {
        None
    }
    fn tension(&self, state: &[f64], _input: &Input) -> f64 {
        (self.tension)(state)
    }
    fn tension_kind(&self) -> TensionKind {
        TensionKind::Kilopascal
    }
    fn feels_stretch(&self) -> bool {
        true
    }
}

/// How long a follower takes to follow, ms.
const FOLLOWING_MS: f64 = 7.0;

/// A state that follows the stretch and one that follows its rate: both exact in closed form.
fn follower() -> Feeling {
    let rates = |state: &[f64], input: &Input, rates: &mut [f64]| {
        rates[0] = (input.stretch - state[0]) / FOLLOWING_MS + 4.0 * input.stimulus;
        rates[1] = (input.stretch_rate - state[1]) / FOLLOWING_MS - input.stimulus;
    };
    let moves = vec![Moved { state: 0, weight: 4.0 }, Moved { state: 1, weight: -1.0 }];
    Feeling {
        stimulation: Stimulation {
            default: Stimulus::Jump { amplitude: 0.0 },
            current_unit: "1/ms".into(),
            moves: moves.into(),
        },
        ..Feeling::new(&[("stretch", 1.0), ("rate", 0.0)], rates, |_| 0.0)
    }
}

#[test]
fn a_model_that_feels_feels_each_stretch_exactly_as_long_as_it_lasts() {
    let felt = [(3.0, 0.9, -0.01), (3.1, 0.8, 0.5), (20.0, 1.1, 0.0), (20.25, 1.0, -2.0)];
    for method in [CellMethod::RungeKutta4, CellMethod::Stiff] {
        let settings = SolverSettings { tolerance: 1e-9, ..SolverSettings::of(method) };
        let model: Arc<dyn CellModel> = Arc::new(follower());
        let mut cell = CellIntegrator::new(model, Protocol::rest(), settings).unwrap();
        let (mut expected, mut before) = ([1.0, 0.0], 0.0);
        for (time, stretch, rate) in felt {
            // A trial leaves no trace.
            let mut trial = cell.clone();
            trial.advance_to(time + 1.0, 0.5, 3.0).unwrap();
            cell.advance_to(time, stretch, rate).unwrap();
            let left = f64::exp(-(time - before) / FOLLOWING_MS);
            for (value, goal) in expected.iter_mut().zip([stretch, rate]) {
                *value = goal + (*value - goal) * left;
            }
            before = time;
            assert_eq!(cell.time(), time);
            for (value, expected) in cell.state().iter().zip(expected) {
                assert!((value - expected).abs() < 1e-9, "{method} at {time}: {value}, {expected}");
            }
        }
    }
}

/// What the muscle pulls by at its first length, kPa.
const STRONGEST_KPA: f64 = 30.0;
/// Twice as stiff as the cell is without it: exchange with the last stretch would be unstable.
const STIFFNESS_KPA: f64 = 600.0;

/// A muscle that pulls more where it is longer and less while it shortens, with 5 ms of delay:
/// `dTa/dt = (T0 + k (stretch - 1) + c dstretch/dt - Ta)/tau`, in kPa.
fn muscle() -> Feeling {
    const VISCOSITY_KPA_MS: f64 = 2000.0;
    const DELAY_MS: f64 = 5.0;
    let rates = |state: &[f64], input: &Input, rates: &mut [f64]| {
        let wanted = STRONGEST_KPA
            + STIFFNESS_KPA * (input.stretch - 1.0)
            + VISCOSITY_KPA_MS * input.stretch_rate;
        rates[0] = (wanted - state[0]) / DELAY_MS;
    };
    Feeling::new(&[("Ta", 0.0)], rates, |state| state[0])
}

#[test]
fn a_cell_model_that_feels_its_stretch_settles_where_its_law_and_the_mesh_agree() {
    let mesh = lattice::rectangle(12, 3, 5.0).unwrap();
    let curve = |method: Way, exchange: f64| {
        let mut simulation = Simulation {
            cell: Arc::new(muscle()),
            protocol: Protocol::rest(),
            duration: 100.0,
            ..Simulation::new(mesh.clone())
        };
        simulation.numerics.method = method;
        simulation.numerics.exchange_interval = exchange;
        simulation.numerics.output_interval = 1.0;
        let outcome = simulation.build().unwrap().run(|_| true);
        assert_eq!(outcome.stop, None);
        outcome.recording.samples
    };
    let rest = |tension: f64| {
        let equilibria =
            Simulation::new(mesh.clone()).equilibria(&[30.0], Tolerance::default()).unwrap();
        equilibria.follow(&[[0.0, tension]]).unwrap()[0].shortening_pct
    };
    let fine = curve(Way::QuasiStatic, 0.05);
    for (method, exchange) in [
        (Way::QuasiStatic, 1.0),
        (Way::QuasiStatic, 0.25),
        (Way::Verlet(Integrator::StoermerVerlet), 0.25),
    ] {
        let samples = curve(method, exchange);
        let end = samples.last().unwrap();
        // At rest: the law of the muscle, and that of the mesh.
        let law = STRONGEST_KPA - STIFFNESS_KPA * end.shortening_pct / 100.0;
        assert!((end.ta_kpa - law).abs() < 1e-3, "{method:?}, {exchange} ms: {} {law}", end.ta_kpa);
        assert!((rest(end.ta_kpa) - end.shortening_pct).abs() < 1e-3, "{method:?}, {exchange} ms");
        // On the way: first order in the interval, without a swing.
        for (a, b) in samples.iter().zip(&fine) {
            let off = (a.shortening_pct - b.shortening_pct).abs() / end.shortening_pct;
            assert!(
                off < 0.06 * exchange.max(0.25),
                "{method:?}, {exchange} ms: {off} at {}",
                a.t_ms
            );
        }
        let swings =
            samples.windows(2).filter(|p| p[1].shortening_pct < p[0].shortening_pct - 1e-3);
        assert_eq!(swings.count(), 0, "{method:?}, {exchange} ms");
    }
}
