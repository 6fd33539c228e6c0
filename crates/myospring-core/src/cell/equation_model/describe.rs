//! Names, units and words of a model from equations.

use super::graphs::Graphs;
use crate::cell::description::{Output, StateVariable};
use crate::cell::equations::{Equations, Variable};
use crate::cell::land_2017;
use crate::parameter::{Parameter, ParameterSet};
use std::collections::HashSet;

/// Names of constants, states and intermediates: `membrane_V` for `membrane.V`, each once.
#[derive(Debug)]
pub(super) struct Names {
    pub(super) constants: Vec<String>,
    pub(super) states: Vec<String>,
    pub(super) intermediates: Vec<String>,
}

impl Names {
    pub(super) fn new(equations: &Equations, myofilaments: bool) -> Self {
        let mut taken: HashSet<String> = HashSet::new();
        if myofilaments {
            taken.extend(land_2017::rows().into_iter().map(|row| row.name.into_owned()));
            let states = land_2017::states([0.0; land_2017::STATES]);
            taken.extend(states.into_iter().map(|state| state.name.into_owned()));
        }
        let mut one = |name: &String| {
            let plain = |c: char| if c.is_ascii_alphanumeric() { c } else { '_' };
            let name: String = name.chars().map(plain).collect();
            let numbered = (2..).map(|number| format!("{name}_{number}"));
            let mut all = std::iter::once(name.clone()).chain(numbered);
            let free = all.find(|name| !taken.contains(name)).unwrap_or(name);
            taken.insert(free.clone());
            free
        };
        Self {
            states: equations.states.iter().map(|own| one(&own.name)).collect(),
            constants: equations.constants.iter().map(|own| one(&own.name)).collect(),
            intermediates: equations.intermediates.iter().map(|own| one(&own.name)).collect(),
        }
    }
}

/// Name and description of a model.
pub(super) fn title(equations: &Equations, myofilaments: bool) -> (String, String) {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '_' };
    let name: String = equations.name.chars().map(plain).collect();
    let mut name = if name.is_empty() { "model".to_owned() } else { name };
    let words: Vec<&str> = equations.description.split_whitespace().collect();
    let mut description =
        if words.is_empty() { equations.source.file.clone() } else { words.join(" ") };
    if myofilaments {
        name.push_str("_land_2017");
        description.push_str(", with the myofilaments of Land et al. 2017");
    }
    (name, description)
}

fn meaning(own: &str, name: &str) -> String {
    let words: Vec<&str> = own.split_whitespace().collect();
    if words.is_empty() { format!("`{name}` of the file") } else { words.join(" ") }
}

pub(super) fn states(equations: &Equations, names: &Names) -> Vec<StateVariable> {
    let state = |(own, name): (&crate::cell::equations::State, &String)| StateVariable {
        name: name.clone().into(),
        unit: own.unit.clone().into(),
        start: own.start,
        meaning: meaning(&own.meaning, &own.name).into(),
    };
    equations.states.iter().zip(&names.states).map(state).collect()
}

/// The constants as parameters, and those of the myofilaments.
pub(super) fn parameters(equations: &Equations, names: &Names, myofilaments: bool) -> ParameterSet {
    let rows = equations.constants.iter().zip(&names.constants).map(|(own, name)| {
        let file = own.place.file.as_ref().unwrap_or(&equations.source.file);
        let source = format!("{file}, line {}", own.place.line);
        // The file states no range.
        let range = [-f64::MAX, f64::MAX];
        let meaning = meaning(&own.meaning, &own.name);
        Parameter::new(name.clone(), own.value, own.unit.clone(), range, meaning, source)
    });
    let mut rows: Vec<Parameter> = rows.collect();
    if myofilaments {
        rows.extend(land_2017::rows());
    }
    ParameterSet::new(rows)
}

/// The observed variables and, for the first of them, the outputs: currents and fluxes; then what
/// potential, calcium and tension need.
pub(super) fn outputs(
    equations: &Equations,
    names: &Names,
    graphs: &Graphs,
) -> (Vec<Variable>, Vec<Output>) {
    let (mut observed, mut outputs) = (Vec::new(), Vec::new());
    for (index, own) in equations.intermediates.iter().enumerate() {
        let variable = Variable::Intermediate(index);
        if is_flow(&own.unit) && graphs.graph.moves(graphs.of_variable(variable)) {
            observed.push(variable);
            outputs.push(Output {
                name: names.intermediates[index].clone().into(),
                unit: own.unit.clone().into(),
                meaning: meaning(&own.meaning, &own.name).into(),
            });
        }
    }
    let roles = &equations.roles;
    let needed = [
        roles.potential.millivolts.map(|(variable, _)| variable),
        roles.calcium.as_ref().map(|role| role.variable),
        roles.tension.as_ref().map(|role| role.variable),
    ];
    for variable in needed.into_iter().flatten() {
        if matches!(variable, Variable::Intermediate(_)) && !observed.contains(&variable) {
            observed.push(variable);
        }
    }
    (observed, outputs)
}

/// Whether a unit is one of an electric current or of a concentration per time.
fn is_flow(unit: &str) -> bool {
    let mut symbols = unit.split(|c: char| !c.is_ascii_alphabetic());
    let current = ["A", "mA", "uA", "nA", "pA", "fA"];
    let amount = ["M", "mM", "uM", "nM"];
    let time = ["s", "ms", "us"];
    symbols.clone().any(|symbol| current.contains(&symbol))
        || (symbols.clone().any(|symbol| amount.contains(&symbol))
            && symbols.any(|symbol| time.contains(&symbol)))
}
