//! Every number of the one table at its ends: a run is finite, or the message names the setting.

use crate::sample::Sample;
use myospring::interruption::Interruption;
use myospring::run_file::RunFile;
use myospring::settings::{Bounds, Setting, Value, ValueKind, Whole, table};
use myospring::units::{self, Dimension};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

/// Settings of what a mask, a picture, a stack or a table of calcium shows.
const OF_FILES: [&str; 6] = [
    "shape.label",
    "shape.z_step",
    "mechanics.sarcomere_reference",
    "cell.calcium_dissociation",
    "cell.ratio_min",
    "cell.ratio_max",
];

/// How long one run may take; what it has done until then is checked.
const LONGEST: Duration = Duration::from_millis(30);

/// What a setting needs beside it to have a place, and what keeps the mesh small.
fn with_place(setting: &Setting) -> RunFile {
    let mut file = RunFile::default();
    let beside: &[(&str, &str)] = match setting.key {
        "cell.tolerance" => &[("cell.integrator", "adaptive")],
        "stimulus.duration" => &[("stimulus.kind", "pulse"), ("cell.model", "tor_ord_land")],
        "mechanics.end_stiffness" => &[("mechanics.support", "spring-held-ends")],
        "mechanics.afterload" => {
            &[("mechanics.support", "afterloaded-ends"), ("numerics.integrator", "quasi-static")]
        }
        "run.duration" => {
            &[("numerics.frame_interval", "1000 ms"), ("numerics.output_interval", "1000 ms")]
        }
        "mechanics.post_length"
        | "mechanics.post_load_height"
        | "mechanics.post_width"
        | "mechanics.post_thickness"
        | "mechanics.post_modulus" => &[
            ("mechanics.support", "posts"),
            ("mechanics.post_length", "3 mm"),
            ("mechanics.post_width", "1 mm"),
            ("mechanics.post_modulus", "1.6 MPa"),
        ],
        "tissue.velocity_ratio" | "tissue.stretch_conductance" | "tissue.stretch_reversal" => {
            &[("tissue.diffusion", "1 cm^2/s")]
        }
        "mechanics.bed_stiffness" => &[("mechanics.support", "elastic-bed")],
        "mechanics.gel_modulus"
        | "mechanics.gel_poisson"
        | "mechanics.gel_thickness"
        | "mechanics.adhesion"
        | "mechanics.adhesion_stiffness" => {
            &[("mechanics.support", "gel"), ("mechanics.gel_modulus", "10 kPa")]
        }
        "material.poisson_ratio" | "mechanics.helix_angle" => &[("shape.profile", "slab")],
        "mechanics.end_stretch" => &[("mechanics.support", "clamped-ends")],
        _ => &[],
    };
    for (key, value) in beside.iter().chain(&[("shape.spacing", "5 um")]) {
        if *key != setting.key {
            file.set(key, *value).unwrap();
        }
    }
    file
}

fn quantities(bounds: Bounds) -> Vec<Value> {
    let Bounds { dimension, minimum, maximum, .. } = bounds;
    let within = [minimum, maximum, minimum.next_up(), maximum.next_down()];
    let zeros = [0.0, -0.0, 1e-300, 5e-324, 1e300, -1e300, f64::MAX];
    let written = |number| match dimension {
        Dimension::Number => Value::Number(number),
        dimension => Value::Text(units::format(number, dimension)),
    };
    within.into_iter().chain(zeros).map(written).collect()
}

fn extremes(setting: &Setting) -> Vec<Value> {
    match setting.kind {
        ValueKind::Quantity { bounds, .. } => quantities(bounds),
        ValueKind::Whole { bounds: Whole { minimum, maximum, .. }, .. } => {
            [i64::from(minimum), i64::from(maximum), -1, i64::from(u32::MAX) + 1, i64::MAX]
                .map(Value::Whole)
                .into()
        }
        _ => Vec::new(),
    }
}

/// Resolves a run and simulates its beginning; samples that are there must be finite.
fn prepared(file: &RunFile) -> Result<(), String> {
    let mut run = file.resolve().map_err(|error| error.to_string())?;
    let read = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let bytes = run.shape.bytes(read).map_err(|error| error.to_string())?;
    let shaped = run.shape.mesh(&bytes).map_err(|error| error.to_string())?;
    // Pacing to a steady state may take as long as it likes.
    run.steady_state = None;
    let mut made = run.make(shaped, read).map_err(|error| error.to_string())?;
    let start = Instant::now();
    made.simulation.interruption = Interruption::when(move || start.elapsed() > LONGEST);
    let ready = match made.simulation.build() {
        Err(error) if error.to_string().contains("interrupted") => return Ok(()),
        ready => ready.map_err(|error| error.to_string())?,
    };
    let outcome = ready.run(|_progress| start.elapsed() < LONGEST);
    let texts = ready.warnings().into_iter().chain(ready.warnings_after(&outcome));
    for text in texts {
        assert!(!strange(&text), "a warning says {text}");
    }
    for sample in &outcome.recording.samples {
        let numbers = [sample.t_ms, sample.ta_kpa, sample.length_um, sample.area_um2];
        assert!(numbers.iter().all(|number| number.is_finite()), "{sample:?}");
    }
    Ok(())
}

/// Whether a message has a number that is none.
fn strange(message: &str) -> bool {
    message.split(|at: char| !at.is_alphanumeric()).any(|word| ["NaN", "inf"].contains(&word))
}

#[test]
#[ignore = "slow"]
fn a_number_at_its_ends_gives_a_finite_run_or_a_message_that_names_the_setting() {
    let mut faults = Vec::new();
    let mut tried = [0_usize, 0];
    let mut cases = 0;
    let mut sample = Sample::one_in(2);
    for setting in table().filter(|setting| !OF_FILES.contains(&setting.key)) {
        for value in extremes(setting) {
            cases += 1;
            if sample.leaves_out() {
                continue;
            }
            let mut file = with_place(setting);
            let what = format!("{} = {value:?}", setting.key);
            let outcome = file.set(setting.key, value).map_err(|error| error.to_string());
            let outcome = outcome.and_then(|()| {
                catch_unwind(AssertUnwindSafe(|| prepared(&file)))
                    .unwrap_or_else(|_| Err("it panics: inf".to_owned()))
            });
            tried[usize::from(outcome.is_err())] += 1;
            let Err(message) = outcome else { continue };
            let named = message.to_lowercase().replace([' ', '-'], "_").contains(setting.name());
            if !named || strange(&message) {
                faults.push(format!("{what}: {message}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let of_all = tried.map(|count| count * cases / (tried[0] + tried[1]));
    assert!(of_all[0] > 100 && of_all[1] > 100, "{tried:?} runs and refusals of {cases}");
}
