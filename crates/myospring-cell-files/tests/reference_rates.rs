//! Rates of published models at the start, compared with Myokit's.
//!
//! Skipped where the files are absent: `../shared/data/cell-models`, or `MYOSPRING_SHARED_DATA`.

#[path = "../../myospring/tests/common/sample.rs"]
mod sample;
#[path = "../../myospring/tests/common/skipped.rs"]
mod skipped;

use myospring_cell_files::{Choices, open};
use myospring_core::cell::equation_model::EquationModel;
use myospring_core::cell::{CellModel, Input};
use sample::Sample;
use skipped::shared_data;

#[test]
fn rates_of_published_models_are_those_of_myokit() {
    let Some(folder) = shared_data("cell-models") else { return };
    let text = std::fs::read_to_string(folder.join("rates.json")).unwrap();
    let all: serde_json::Value =
        serde_json::from_str(&text.replace("-Infinity", "null").replace("NaN", "null")).unwrap();
    let mut wrong = Vec::new();
    for (file, own) in all.as_object().unwrap() {
        match open(&folder.join(file), &Choices::default()) {
            // Myokit has an infinite rate there, too.
            Err(error)
                if error.reason.contains("is not a finite number at the start")
                    && own["rates"].to_string().contains("null") =>
            {
                println!("refused: {error}");
            }
            Err(error) => wrong.push(error.to_string()),
            Ok(equations) => {
                // The reference has the file's own stimulus where that starts at 0 ms.
                let amplitude = equations.roles.stimulus.default.amplitude;
                let difference =
                    difference(&equations, own, 0.0).min(difference(&equations, own, amplitude));
                println!(
                    "{file}: {difference:.1e} {:?} {:?} {:?}",
                    equations.roles.stimulus, equations.roles.potential, equations.roles.calcium
                );
                if difference.is_nan() || difference > 1e-9 {
                    wrong.push(format!("{file}: {difference:.1e}"));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[allow(clippy::unwrap_used)]
/// The largest difference of rates, relative to the larger of rate and state.
fn difference(
    equations: &myospring_core::cell::equations::Equations,
    own: &serde_json::Value,
    stimulus: f64,
) -> f64 {
    let numbers = |key: &str| -> Vec<f64> {
        own[key]
            .as_array()
            .unwrap()
            .iter()
            .map(|value| value.as_f64().unwrap_or(f64::NAN))
            .collect()
    };
    let per_ms = if own["time_unit"] == "[s]" { 1e-3 } else { 1.0 };
    let rates =
        equations.evaluate(&equations.constant_values(), &equations.start(), 0.0, stimulus).rates();
    let (names, start) = (own["states"].as_array().unwrap(), numbers("start"));
    assert_eq!(names.len(), rates.len());
    let mut largest = 0.0_f64;
    for (index, rate) in numbers("rates").iter().enumerate() {
        let place = equations.states.iter().position(|state| names[index] == *state.name);
        let place = place.unwrap_or_else(|| panic!("no state {}", names[index]));
        assert_eq!(equations.states[place].start, start[index], "{}", names[index]);
        // Myokit has no number there: a removable singularity of the file.
        if rate.is_nan() {
            assert!(rates[place].is_finite(), "{}", names[index]);
            continue;
        }
        let scale = (rate * per_ms).abs().max(start[index].abs()).max(1e-300);
        let own = (rates[place] - rate * per_ms).abs() / scale;
        largest = if own.is_nan() { own } else { largest.max(own) };
    }
    largest
}

/// Every published model at hand, compiled, against the plain evaluation of its equations: at the start and at states near
/// it, with and without a stimulus. The tape's own exponential and logarithm differ by some units of the last place, which
/// differences of large currents enlarge.
#[test]
fn compiled_models_have_the_rates_of_their_equations_and_an_exact_jacobian() {
    let Some(folder) = shared_data("cell-models") else { return };
    let text = std::fs::read_to_string(folder.join("rates.json")).unwrap();
    let all: serde_json::Value =
        serde_json::from_str(&text.replace("-Infinity", "null").replace("NaN", "null")).unwrap();
    let mut tried = 0;
    let mut sample = Sample::one_in(4);
    for file in all.as_object().unwrap().keys() {
        if sample.leaves_out() {
            continue;
        }
        let Ok(equations) = open(&folder.join(file), &Choices::default()) else { continue };
        let model = EquationModel::new(equations.clone()).unwrap();
        let amplitude = equations.roles.stimulus.default.amplitude;
        for (shift, stimulus) in [(0.0, 0.0), (1e-3, 0.0), (-2e-3, amplitude)] {
            let state: Vec<f64> = equations.start().iter().map(|own| own * (1.0 + shift)).collect();
            let input = Input { stimulus, ..Input::REST };
            let mut rates = vec![0.0; state.len()];
            model.derivatives(&state, &input, &mut rates);
            let plain =
                equations.evaluate(&equations.constant_values(), &state, 0.0, stimulus).rates();
            for ((own, plain), (value, of)) in
                rates.iter().zip(&plain).zip(state.iter().zip(&equations.states))
            {
                let scale = plain.abs().max(value.abs()).max(1e-300);
                let error = (own - plain).abs() / scale;
                assert!(error < 1e-9, "{file}: {} has {own}, not {plain}", of.name);
            }
        }
        compare_jacobian(file, &model, &equations.start());
        tried += 1;
    }
    let all = std::env::var_os("MYOSPRING_ALL_CASES").is_some();
    assert!(tried >= if all { 38 } else { 9 }, "{tried} models");
}

/// Central differences of the rates. A column is compared relative to its largest element, since a difference quotient
/// carries the rounding of the largest currents.
fn compare_jacobian(file: &str, model: &EquationModel, state: &[f64]) {
    let count = state.len();
    let mut jacobian = vec![0.0; count * count];
    assert!(model.jacobian(state, &Input::REST, &mut jacobian));
    let rates = |moved: &[f64]| {
        let mut rates = vec![0.0; count];
        model.derivatives(moved, &Input::REST, &mut rates);
        rates
    };
    let mut far = 0;
    for j in 0..count {
        let step = 1e-6 * state[j].abs().max(1e-6);
        let mut moved = state.to_vec();
        moved[j] = state[j] + step;
        let above = rates(&moved);
        moved[j] = state[j] - step;
        let below = rates(&moved);
        let column: Vec<f64> = (0..count).map(|i| jacobian[i * count + j]).collect();
        let largest = column.iter().fold(1e-12_f64, |most, own| most.max(own.abs()));
        let differs = (0..count).any(|i| {
            let slope = (above[i] - below[i]) / (2.0 * step);
            // What the rounding of the rates makes of a quotient.
            let rounding = 1e-14 * above[i].abs().max(below[i].abs()) / step;
            (slope - column[i]).abs() > 1e-4 * largest + 10.0 * rounding
        });
        far += usize::from(differs && column.iter().all(|own| own.is_finite()));
        assert!(column.iter().all(|own| own.is_finite()), "{file}: column {j}");
    }
    // At a state where a piece of a rate begins, both sides differ.
    assert!(far * 10 <= count, "{file}: {far} of {count} columns differ from difference quotients");
}
