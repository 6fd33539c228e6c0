//! Rates of published models at the start, compared with Myokit's.
//!
//! Skipped where the files are absent: `../shared/data/cell-models`, or `MYOSPRING_SHARED_DATA`.

use myospring_cell_files::{Choices, open};
use std::path::PathBuf;

fn data() -> Option<PathBuf> {
    let root = std::env::var_os("MYOSPRING_SHARED_DATA").map_or_else(
        || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let folder = root.join("cell-models");
    folder.join("rates.json").exists().then_some(folder)
}

#[test]
fn rates_of_published_models_are_those_of_myokit() {
    let Some(folder) = data() else {
        println!("skipped: no shared data");
        return;
    };
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
