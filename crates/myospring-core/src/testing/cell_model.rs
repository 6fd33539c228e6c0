//! The conformance suite of cell models.

use crate::analysis::bands::{self, BandPosition};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::{Protocol, Stimulus};
use crate::cell::solve::{SolveError, SolverSettings, reference_beat, solve};
use crate::cell::{self, CellModel, Gate, Input, KnownDeparture, TensionKind, is_as_published};
use std::sync::Arc;

/// Checks everything that [`CellModel`] promises, by one default beat with the default settings and at
/// states along it.
///
/// # Panics
/// At the first broken promise, with the model's name and what is wrong.
///
/// # Example
/// ```
/// use myospring::{cell::toy::ToyModel, testing::cell_model::check_cell_model};
/// check_cell_model(ToyModel::published());
/// ```
pub fn check_cell_model(model: impl CellModel) {
    let model: Arc<dyn CellModel> = Arc::new(model);
    check_cell_model_with(&model, SolverSettings::default());
}

/// As [`check_cell_model`], for a model that needs other numerical settings.
///
/// # Panics
/// At the first broken promise, with the model's name and what is wrong.
pub fn check_cell_model_with(model: &Arc<dyn CellModel>, settings: SolverSettings) {
    check_description(&**model);
    check_parameters(&**model);
    check_states(&**model);
    check_stimulation(&**model);
    let protocol = Protocol::once(model.default_stimulus());
    let trace = match solve(&**model, protocol, settings, 600.0, 10.0) {
        Ok(trace) => trace,
        Err(error) => panic!("{}: the default beat fails: {error}", model.name()),
    };
    for sample in 0..trace.time_ms.len() {
        let state: Vec<f64> = trace.states.iter().map(|column| column[sample]).collect();
        check_derivatives(&**model, &state);
        check_gates(&**model, &state);
        check_jacobian(&**model, &state);
        check_outputs(&**model, &state);
    }
    check_beat(&**model, settings);
    check_pieces(model, settings);
}

/// The name is valid in a run file; title and papers are present.
fn check_description(model: &dyn CellModel) {
    let name = model.name();
    let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
    assert!(!name.is_empty() && name.chars().all(plain), "`{name}` is not author_year in ASCII");
    let description = model.description();
    assert!(!description.trim().is_empty(), "{name}: no description");
    assert!(!description.contains('\n'), "{name}: the description is longer than one line");
    if let Some(KnownDeparture { shortening_rate_over_peak: rate, fact, instead }) =
        model.known_departure()
    {
        let band = bands::band("shortening_rate_over_peak");
        assert!(
            band.is_some_and(|band| band.place(rate) != BandPosition::In),
            "{name}: {rate} 1/s lies within the band, so there is nothing to be said of it"
        );
        assert!(!fact.trim().is_empty() && !fact.ends_with('.'), "{name}: `{fact}`");
        let other = cell::model(&instead).ok().and_then(|model| model.known_departure());
        assert!(other.is_none(), "{name}: `{instead}` departs, too");
    }
    for key in model.citations() {
        assert!(!key.is_empty() && key.chars().all(plain), "{name}: `{key}` is no citation key");
    }
}

/// Rows are complete, in range, and rebuild the same model; a foreign set is refused.
fn check_parameters(model: &dyn CellModel) {
    let name = model.name();
    for row in model.parameters().rows() {
        let parameter = &*row.name;
        assert!(
            (row.minimum..=row.maximum).contains(&row.value),
            "{name}: {parameter} = {} is outside {} to {}",
            row.value,
            row.minimum,
            row.maximum
        );
        assert!(!row.meaning.is_empty(), "{name}: {parameter} has no meaning");
        assert!(!row.source.is_empty(), "{name}: {parameter} has no source");
        let mut set = model.parameters().clone();
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(set.set(parameter, bad).is_err(), "{name}: {parameter} accepts {bad}");
        }
        let other = if row.value == row.minimum { row.maximum } else { row.minimum };
        if set.set(parameter, other).is_ok()
            && let Ok(changed) = model.with_parameters(set)
        {
            let is_same = model.is_same_as(&*changed) || changed.is_same_as(model);
            assert!(!is_same, "{name}: is the same with another {parameter}");
        }
    }
    if !model.parameters().rows().is_empty() {
        let empty = crate::parameter::ParameterSet::new(Vec::new());
        assert!(model.with_parameters(empty).is_err(), "{name}: is built without its parameters");
    }
    let rebuilt = match model.with_parameters(model.parameters().clone()) {
        Ok(rebuilt) => rebuilt,
        Err(error) => panic!("{name}: its own parameters do not rebuild it: {error}"),
    };
    assert_eq!(rebuilt.name(), name, "the rebuilt model has another name");
    assert_eq!(rebuilt.parameters(), model.parameters(), "{name}: rebuilding changes parameters");
    assert_eq!(rebuilt.initial_state(), model.initial_state(), "{name}: rebuilding changes state");
    let state = model.initial_state();
    assert_eq!(
        rates(rebuilt.as_ref(), &state, 0.0),
        rates(model, &state, 0.0),
        "{name}: rebuilding changes the rates"
    );
}

/// Names differ, of states and outputs together; the initial state is finite, and every state has a
/// meaning.
fn check_states(model: &dyn CellModel) {
    let name = model.name();
    let states = model.states().iter().map(|state| (&state.name, &state.unit, &state.meaning));
    let outputs =
        model.outputs().iter().map(|output| (&output.name, &output.unit, &output.meaning));
    let all: Vec<_> = states.chain(outputs).collect();
    for (i, (variable, unit, meaning)) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|row| row.0 != *variable), "{name}: `{variable}` stands twice");
        let plain = |c: char| c.is_ascii_alphanumeric() || c == '_';
        assert!(
            !variable.is_empty() && variable.chars().all(plain),
            "{name}: `{variable}` is no name"
        );
        assert_eq!(unit.trim(), **unit, "{name}: the unit of {variable} has space around it");
        assert!(!meaning.trim().is_empty(), "{name}: {variable} has no meaning");
    }
    for state in model.states() {
        assert!(state.start.is_finite(), "{name}: initial {} = {}", state.name, state.start);
    }
}

/// The stimulus acts on existing states, the potential among them, and gives a valid protocol.
fn check_stimulation(model: &dyn CellModel) {
    let name = model.name();
    let stimulation = model.stimulation();
    if let Err(error) = Protocol::once(stimulation.default).validate() {
        panic!("{name}: its own stimulus cannot be given: {error}");
    }
    assert!(!stimulation.current_unit.is_empty(), "{name}: the stimulus current has no unit");
    let states = model.states().len();
    for (i, moved) in stimulation.moves.iter().enumerate() {
        let (place, weight) = (moved.state, moved.weight);
        assert!(place < states, "{name}: the stimulus moves state {place} of {states}");
        assert!(weight.is_finite() && weight != 0.0, "{name}: it moves state {place} by {weight}");
        let before = &stimulation.moves[..i];
        assert!(before.iter().all(|other| other.state != place), "{name}: it moves {place} twice");
    }
    // A jump of the first of these states is a jump of the potential.
    let mut state = model.initial_state();
    let (first, before) = match (stimulation.moves.first(), model.potential(&state)) {
        (Some(first), Some(before)) => (first, before),
        (None, None) => return,
        (Some(_), None) => panic!("{name}: the stimulus moves a potential that there is not"),
        (None, Some(_)) => panic!("{name}: the stimulus moves nothing"),
    };
    state[first.state] += 0.25;
    let by = model.potential(&state).map_or(f64::NAN, |after| after - before);
    // Rounding of a potential in mV.
    assert!((by - 0.25).abs() < 1e-12 * (1.0 + before.abs()), "{name}: 0.25 moves it by {by}");
}

/// Rates at `state`, written over invalid values.
fn rates(model: &dyn CellModel, state: &[f64], stimulus: f64) -> Vec<f64> {
    let mut rates = vec![f64::NAN; state.len()];
    model.derivatives(state, &Input { stimulus, ..Input::REST }, &mut rates);
    rates
}

/// Every rate is written, finite and repeatable; a stimulus adds its weights and nothing else; stretch acts
/// only on a model that says so.
fn check_derivatives(model: &dyn CellModel, state: &[f64]) {
    let name = model.name();
    let resting = rates(model, state, 0.0);
    for (variable, rate) in model.state_names().iter().zip(&resting) {
        assert!(rate.is_finite(), "{name}: rate of {variable} is {rate} at {state:?}");
    }
    assert_eq!(resting, rates(model, state, 0.0), "{name}: rates differ from call to call");
    if let Some(mv) = model.membrane_potential_mv(state) {
        assert!(mv.is_finite(), "{name}: membrane potential {mv} mV");
    }

    let stimulation = model.stimulation();
    let stimulus = match stimulation.default {
        Stimulus::Jump { .. } => 0.5,
        Stimulus::Pulse { amplitude, .. } => amplitude,
    };
    let stimulated = rates(model, state, stimulus);
    for i in 0..state.len() {
        let moved = stimulation.moves.iter().find(|moved| moved.state == i);
        let by = moved.map_or(0.0, |moved| moved.weight * stimulus);
        let expected = resting[i] + by;
        // The stimulus may be in the middle of a sum of currents.
        let bound = 16.0 * f64::EPSILON * (resting[i].abs() + by.abs());
        assert!(
            (stimulated[i] - expected).abs() <= bound,
            "{name}: a stimulus of {stimulus} {} turns the rate of {} from {} to {}",
            stimulation.current_unit,
            model.state_names()[i],
            resting[i],
            stimulated[i]
        );
    }

    if !model.feels_stretch() {
        let stretched = Input { stretch: 0.9, stretch_rate: -1e-3, ..Input::REST };
        let mut rates = vec![f64::NAN; state.len()];
        model.derivatives(state, &stretched, &mut rates);
        assert_eq!(rates, resting, "{name}: feels a stretch that it does not own up to");
    }
}

/// The rate of a gate is `(steady state - x) / time constant`.
fn check_gates(model: &dyn CellModel, state: &[f64]) {
    let name = model.name();
    let places = model.gates();
    if places.is_empty() {
        return;
    }
    let mut gates = vec![Gate { steady_state: f64::NAN, time_constant_ms: f64::NAN }; places.len()];
    model.write_gates(state, &Input::REST, &mut gates);
    let rates = rates(model, state, 0.0);
    for (&place, gate) in places.iter().zip(&gates) {
        let Gate { steady_state, time_constant_ms } = *gate;
        let variable = model.state_names()[place];
        assert!(time_constant_ms > 0.0, "{name}: {variable} takes {time_constant_ms} ms");
        let rate = (steady_state - state[place]) / time_constant_ms;
        // The difference of two numbers, each rounded in its own way.
        let bound = 1e-12 * (steady_state.abs() + state[place].abs()) / time_constant_ms;
        assert!(
            (rates[place] - rate).abs() <= bound,
            "{name}: as a gate {variable} has the rate {rate}, by its equation {}",
            rates[place]
        );
    }
}

/// The Jacobian, where there is one, is that of the rates.
fn check_jacobian(model: &dyn CellModel, state: &[f64]) {
    let name = model.name();
    let states = state.len();
    let mut jacobian = vec![f64::NAN; states * states];
    if !model.jacobian(state, &Input::REST, &mut jacobian) {
        return;
    }
    for column in 0..states {
        let by = 1e-6 * (1e-3 + state[column].abs());
        let moved = |sign: f64| {
            let mut moved = state.to_vec();
            moved[column] += sign * by;
            (moved[column], rates(model, &moved, 0.0))
        };
        let ((upper, above), (lower, below)) = (moved(1.0), moved(-1.0));
        for row in 0..states {
            let difference = (above[row] - below[row]) / (upper - lower);
            let entry = jacobian[row * states + column];
            // Rounding of rates whose terms, up to a thousand times as large, cancel; and the third derivative.
            let rounding = 1e-13 * (1.0 + above[row].abs() + below[row].abs()) / by;
            let bound = 1e-5 * (entry.abs() + difference.abs()) + rounding;
            let [of, by] = [row, column].map(|place| model.state_names()[place]);
            assert!(
                (entry - difference).abs() <= bound,
                "{name}: d(rate of {of}) / d {by} is {entry}, by differences {difference}"
            );
        }
    }
}

/// Outputs are written and finite.
fn check_outputs(model: &dyn CellModel, state: &[f64]) {
    let mut values = vec![f64::NAN; model.outputs().len()];
    model.write_outputs(state, &Input::REST, &mut values);
    for (output, value) in model.outputs().iter().zip(values) {
        assert!(value.is_finite(), "{}: output {} is {value}", model.name(), output.name);
    }
}

/// The default beat raises a peak of tension above rest, and the settings are converged.
fn check_beat(model: &(dyn CellModel + 'static), settings: SolverSettings) {
    let name = model.name();
    if model.tension_kind() == TensionKind::None {
        let error = reference_beat(model, settings).err();
        assert!(matches!(error, Some(SolveError::NoTension { .. })), "{name}: {error:?}");
        return;
    }
    let beat = match reference_beat(model, settings) {
        Ok(beat) => beat,
        Err(error) => panic!("{name}: {error}"),
    };
    if let TensionKind::Relative { published_peak } = model.tension_kind() {
        assert!(
            published_peak.is_finite() && published_peak > 0.0,
            "{name}: the peak of tension of its published parameters is {published_peak}"
        );
        // Tolerance for finer steps, see below.
        let off = (beat.peak_tension / published_peak - 1.0).abs();
        assert!(
            !is_as_published(model) || off < 5e-3,
            "{name}: its published parameters give a peak of {}, not {published_peak}",
            beat.peak_tension
        );
    }
    let rest = model.tension(&model.initial_state(), &Input::REST);
    assert!(rest.abs() < 0.01 * beat.peak_tension, "{name}: tension {rest} at rest");
    assert!(
        beat.peak_time_ms > Protocol::DEFAULT_START_MS,
        "{name}: tension peaks at {} ms, before the stimulus",
        beat.peak_time_ms
    );
    let protocol = Protocol::once(model.default_stimulus());
    let SolverSettings { method, step_ms, tolerance } = settings;
    let finer = SolverSettings { method, step_ms: step_ms / 2.0, tolerance: tolerance / 10.0 };
    let fine = solve(model, protocol, finer, 600.0, 0.1).ok().and_then(|t| t.peak_tension());
    let Some(fine) = fine else { panic!("{name}: the default beat fails at half the step") };
    // Thresholds reduce the method to order 1. A tension that depends on the height of the upstroke
    // changes by 0.3 % (measured), a wrong step or a stiff model changes it far more.
    let change = (fine.value / beat.peak_tension - 1.0).abs();
    assert!(change < 5e-3, "{name}: finer steps change the peak of tension by {change:e}");
}

/// Many short advances and one long one reach the same bits.
fn check_pieces(model: &Arc<dyn CellModel>, settings: SolverSettings) {
    let name = model.name();
    if model.feels_stretch() && settings.method.chooses_steps() {
        return;
    }
    let protocol = Protocol::once(model.default_stimulus());
    let run = |stops: u32| {
        let mut cell = match CellIntegrator::new(Arc::clone(model), protocol, settings) {
            Ok(cell) => cell,
            Err(error) => panic!("{name}: {error}"),
        };
        for stop in 1..=stops {
            let time_ms = 100.0 * f64::from(stop) / f64::from(stops);
            if let Err(error) = cell.advance_to(time_ms, 1.0, 0.0) {
                panic!("{name}: {error}");
            }
        }
        cell.state().to_vec()
    };
    assert_eq!(run(1), run(1000), "{name}: the way depends on how often it is looked at");
}

#[cfg(test)]
mod tests {
    #[test]
    fn every_listed_model_holds_to_its_promises() {
        for model in crate::cell::models() {
            super::check_cell_model_with(&model, model.usual_settings());
        }
    }
}
