//! `myospring models FILE`: what was found in a CellML or Myokit file, and rates at the start.

use crate::args::ModelsArgs;
use crate::failure::Failure;
use crate::table::aligned;
use myospring::cell::equation_model::EquationModel;
use myospring::cell::equations::{Equations, Variable};
use myospring::cell::solve::SolverSettings;
use myospring::cell::two_ways::two_ways;
use myospring::cell::{CellModel, Input};
use myospring::cell_files;
use myospring::output::json;
use serde::Serialize;
use serde_json::json;
use std::path::Path;

#[derive(Serialize)]
struct Rates<'a> {
    states: Vec<StateAtStart<'a>>,
}

/// A state at the start, and its rate per ms without a stimulus.
#[derive(Serialize)]
struct StateAtStart<'a> {
    name: &'a str,
    unit: &'a str,
    value: f64,
    rate: f64,
}

/// The rates of a listed model at the start, as JSON.
pub(super) fn rates_of(model: &dyn CellModel) -> Result<String, Failure> {
    let start = model.initial_state();
    let mut rates = vec![0.0; start.len()];
    model.derivatives(&start, &Input::REST, &mut rates);
    let states = model.states().iter().zip(rates);
    let states = states.map(|(state, rate)| StateAtStart {
        name: &state.name,
        unit: &state.unit,
        value: state.start,
        rate,
    });
    Ok(json::pretty(&Rates { states: states.collect() })?)
}

/// How long the beat is that is integrated in two ways, ms.
const CHECKED_MS: f64 = 1000.0;

/// How far two ways of integrating a beat lie apart.
pub(super) fn checked(model: &dyn CellModel) -> Result<String, Failure> {
    let checked = two_ways(model, CHECKED_MS).map_err(Failure::new)?;
    let way = |settings: SolverSettings| {
        let SolverSettings { method, step_ms, tolerance } = settings;
        if method.chooses_steps() {
            format!("{} steps with tolerance {tolerance}", method.name())
        } else {
            format!("{} steps of {step_ms} ms", method.name())
        }
    };
    let mut rows =
        vec![["", "largest difference", "of the range", "at"].map(str::to_owned).to_vec()];
    for own in &checked.differences {
        let part = own.largest / own.range;
        rows.push(vec![
            own.name.to_owned(),
            format!("{:.2e} {}", own.largest, own.unit).trim_end().to_owned(),
            if part.is_finite() { format!("{part:.1e}") } else { String::new() },
            format!("{:.1} ms", own.at_ms),
        ]);
    }
    let [usual, other] = checked.ways.map(way);
    let name = model.name();
    Ok(format!(
        "{name}: one beat of {CHECKED_MS} ms by {usual}, and by {other}\n\n{}",
        aligned(&rows, &[1, 2, 3])
    ))
}

/// What was found in a file, or its rates.
pub(super) fn text(args: &ModelsArgs, name: &str) -> Result<String, Failure> {
    let choices = args.variables.clone().unwrap_or_default();
    let equations = cell_files::open(Path::new(name), &choices).map_err(Failure::new)?;
    if args.check {
        return checked(&EquationModel::new(equations).map_err(Failure::new)?);
    }
    if args.json {
        return as_json(&equations);
    }
    if !args.rates {
        return Ok(found(&equations));
    }
    let rates =
        equations.evaluate(&equations.constant_values(), &equations.start(), 0.0, 0.0).rates();
    let states = equations.states.iter().zip(rates);
    let states = states.map(|(state, rate)| StateAtStart {
        name: &state.name,
        unit: &state.unit,
        value: state.start,
        rate,
    });
    Ok(json::pretty(&Rates { states: states.collect() })?)
}

fn as_json(equations: &Equations) -> Result<String, Failure> {
    let roles = roles(equations);
    let roles =
        roles.iter().map(|row| json!({"role": row[0], "variable": row[1], "found": row[2]}));
    let states = equations.states.iter().map(|own| {
        json!({"name": own.name, "unit": own.unit, "start": own.start, "line": own.place.line})
    });
    let parameters = equations.constants.iter().map(|own| {
        json!({"name": own.name, "unit": own.unit, "value": own.value, "meaning": own.meaning, "line": own.place.line})
    });
    Ok(json::pretty(&json!({
        "name": equations.name,
        "description": equations.description,
        "format": equations.source.format,
        "roles": roles.collect::<Vec<_>>(),
        "states": states.collect::<Vec<_>>(),
        "parameters": parameters.collect::<Vec<_>>(),
        "notes": equations.notes,
    }))?)
}

fn found(equations: &Equations) -> String {
    let mut parts = vec![
        format!("{}: {} ({})", equations.name, equations.description, equations.source.format),
        aligned(&roles(equations), &[]),
    ];
    if !equations.notes.is_empty() {
        parts.push(equations.notes.join("\n"));
    }
    let mut states = vec![["state", "start", "unit", "line"].map(str::to_owned).to_vec()];
    for state in &equations.states {
        let line = state.place.line.to_string();
        states.push(vec![state.name.clone(), state.start.to_string(), state.unit.clone(), line]);
    }
    parts.push(aligned(&states, &[1, 3]));
    let header = ["parameter", "value", "unit", "line", "meaning"];
    let mut constants = vec![header.map(str::to_owned).to_vec()];
    for own in &equations.constants {
        let line = own.place.line.to_string();
        constants.push(vec![
            own.name.clone(),
            own.value.to_string(),
            own.unit.clone(),
            line,
            own.meaning.clone(),
        ]);
    }
    parts.push(aligned(&constants, &[1, 3]));
    let parts: Vec<&str> = parts.iter().map(|part| part.trim_end()).collect();
    parts.join("\n\n")
}

/// Potential, stimulus, calcium and tension, each with how it was found.
fn roles(equations: &Equations) -> Vec<Vec<String>> {
    let roles = &equations.roles;
    let row = |role: &str, what: String, how: String| vec![role.to_owned(), what, how];
    let about = |variable: Variable| {
        let (name, unit, _) = equations.about(variable);
        format!("{name} {unit}").trim_end().to_owned()
    };
    let potential =
        roles.potential.millivolts.map_or(Variable::State(roles.potential.state), |own| own.0);
    let stimulus = &roles.stimulus;
    let pulse = &stimulus.default;
    let period = pulse.period_ms.map_or_else(String::new, |period| format!(", each {period} ms"));
    let absent = |advice: &str| ("none".to_owned(), advice.to_owned());
    let calcium = roles.calcium.as_ref().map_or_else(
        || absent("name it with --variables calcium=..., if the model has it"),
        |own| (about(own.variable), own.found.to_string()),
    );
    let tension = roles.tension.as_ref().map_or_else(
        || absent("name it with --variables tension=..., if the model has it"),
        |own| (about(own.variable), own.found.to_string()),
    );
    vec![
        row("potential", about(potential), roles.potential.found.to_string()),
        row(
            "stimulus",
            format!("{} {}", stimulus.name.as_deref().unwrap_or("added"), stimulus.unit),
            stimulus.found.to_string(),
        ),
        row(
            "pulse",
            format!("{} {}, {} ms{period}", pulse.amplitude, stimulus.unit, pulse.duration_ms),
            pulse.found.to_string(),
        ),
        row("calcium", calcium.0, calcium.1),
        row("tension", tension.0, tension.1),
    ]
}
