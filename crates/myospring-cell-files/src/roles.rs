//! Which variable is potential, calcium, tension: by choice, annotation, then usual name and unit.

use crate::draft::{Draft, Kind, Problem, Term};
use crate::reading::Choices;
use crate::unit::Unit;
use myospring_core::cell::equations::Found;

const POTENTIALS: [&str; 12] = [
    "v",
    "vm",
    "v_m",
    "e",
    "em",
    "e_m",
    "v_membrane",
    "membrane_potential",
    "v_ode",
    "u",
    "vmem",
    "potential",
];
const CALCIUMS: [&str; 14] = [
    "cai",
    "ca_i",
    "cain",
    "ca_in",
    "cacyto",
    "ca_cyto",
    "ca_cytosol",
    "ca_c",
    "cac",
    "ca_myo",
    "camyo",
    "cyto_ca",
    "calcium",
    "ca_i_free",
];
const TENSIONS: [&str; 8] =
    ["ta", "t_a", "tension", "active_tension", "tact", "t_act", "activetension", "force_active"];

/// The variables with a role, by index in the draft, and how each was found.
pub(crate) struct Chosen {
    /// The potential, and the state that a stimulus changes.
    pub(crate) potential: (usize, usize, Found),
    pub(crate) calcium: Option<(usize, Found)>,
    pub(crate) tension: Option<(usize, Found)>,
    pub(crate) stimulus: Option<usize>,
}

/// The variable with an annotation.
pub(crate) fn tagged(draft: &Draft, tag: &str) -> Option<usize> {
    draft.variables.iter().position(|variable| variable.tags.iter().any(|own| own == tag))
}

/// The first variable with one of these names, in the order of the names.
pub(crate) fn named(draft: &Draft, names: &[&str], fits: &dyn Fn(usize) -> bool) -> Option<usize> {
    names.iter().find_map(|name| {
        (0..draft.variables.len())
            .find(|&index| draft.variables[index].short().eq_ignore_ascii_case(name) && fits(index))
    })
}

/// Finds all but the stimulus, which needs values.
pub(crate) fn find(draft: &Draft, choices: &Choices) -> Result<Chosen, Problem> {
    let own = |choice: &Option<String>, role: &str| {
        choice.as_ref().map(|name| chosen(draft, name, role)).transpose()
    };
    let potential = potential(draft, own(&choices.potential, "potential")?)?;
    let has_unit = |index: usize, unit: Unit| {
        draft.variables[index].unit.is_some_and(|own| own.same_dimension(unit))
    };
    let tagged_one = |tags: &[&str]| {
        tags.iter().find_map(|tag| {
            tagged(draft, tag).map(|index| (index, Found::Annotation((*tag).to_owned())))
        })
    };
    let is_concentration = |index: usize| has_unit(index, Unit::MOLES_PER_VOLUME);
    let by_choice = |choice: Option<usize>| choice.map(|index| (index, Found::User));
    let calcium = by_choice(own(&choices.calcium, "calcium")?)
        .or_else(|| tagged_one(&["oxmeta cytosolic_calcium_concentration", "label Ca_i"]))
        .or_else(|| named(draft, &CALCIUMS, &is_concentration).map(|index| (index, Found::Name)));
    let tension = by_choice(own(&choices.tension, "tension")?)
        .or_else(|| tagged_one(&["label active_tension"]))
        .or_else(|| {
            named(draft, &TENSIONS, &|index| has_unit(index, Unit::PASCAL))
                .map(|index| (index, Found::Name))
        });
    Ok(Chosen { potential, calcium, tension, stimulus: own(&choices.stimulus, "stimulus")? })
}

fn chosen(draft: &Draft, name: &str, role: &str) -> Result<usize, Problem> {
    let short = |index: &usize| draft.variables[*index].short() == name;
    let exact = draft.variables.iter().position(|variable| variable.name == name);
    let all: Vec<usize> = (0..draft.variables.len()).filter(short).collect();
    if let Some(index) = exact.or(if all.len() == 1 { Some(all[0]) } else { None }) {
        return Ok(index);
    }
    let reason = if all.is_empty() {
        format!(
            "no variable is named `{name}`, which is to be the {role}; the states are: {}",
            states(draft)
        )
    } else {
        let names: Vec<&str> =
            all.iter().map(|&index| draft.variables[index].name.as_str()).collect();
        format!(
            "`{name}`, which is to be the {role}, could be {}; give component and name",
            names.join(", ")
        )
    };
    Err(Problem::new(reason))
}

fn states(draft: &Draft) -> String {
    let names: Vec<&str> =
        draft.states.iter().take(60).map(|&index| draft.variables[index].name.as_str()).collect();
    names.join(", ")
}

fn potential(draft: &Draft, choice: Option<usize>) -> Result<(usize, usize, Found), Problem> {
    let is_voltage = |index: usize| {
        draft.variables[index].unit.is_some_and(|unit| unit.same_dimension(Unit::VOLT))
    };
    let is_state = |index: usize| matches!(draft.variables[index].kind, Kind::State { .. });
    let tagged_one =
        |tag: &str| tagged(draft, tag).map(|index| (index, Found::Annotation(tag.to_owned())));
    let only = || {
        let mut all = draft.states.iter().copied().filter(|&index| is_voltage(index));
        let first = all.next()?;
        let words = "the only state in units of voltage".to_owned();
        all.next().is_none().then_some((first, Found::Reason(words)))
    };
    let found = choice
        .map(|index| (index, Found::User))
        .or_else(|| tagged_one("oxmeta membrane_voltage"))
        .or_else(|| tagged_one("label membrane_potential"))
        .or_else(|| {
            named(draft, &POTENTIALS, &|index| is_state(index) && is_voltage(index))
                .map(|index| (index, Found::Name))
        })
        .or_else(only)
        .or_else(|| named(draft, &POTENTIALS, &is_state).map(|index| (index, Found::Name)));
    let Some((index, found)) = found else {
        let reason = format!(
            "the membrane potential was not found; name it: potential=component.variable. The states are: {}",
            states(draft)
        );
        return Err(Problem::new(reason));
    };
    if is_state(index) {
        return Ok((index, index, found));
    }
    let below = states_of(draft, index);
    let &[state] = below.as_slice() else {
        let variable = &draft.variables[index];
        let reason = format!(
            "{} is the potential, but no state: it depends on {} states, so it is not clear which one a stimulus changes",
            variable.name,
            below.len()
        );
        return Err(Problem::of(variable, reason));
    };
    Ok((index, state, found))
}

/// The states that a variable follows from.
pub(crate) fn states_of(draft: &Draft, index: usize) -> Vec<usize> {
    let mut seen_terms = vec![false; draft.terms.0.len()];
    let mut seen = vec![false; draft.variables.len()];
    let mut open = vec![index];
    let mut found = Vec::new();
    while let Some(index) = open.pop() {
        if std::mem::replace(&mut seen[index], true) {
            continue;
        }
        match draft.variables[index].kind {
            Kind::State { .. } => found.push(index),
            Kind::Time => {}
            Kind::Value(root) => {
                for id in draft.operands_first(root, &mut seen_terms) {
                    if let Term::Variable(other) | Term::Rate(other) = draft.terms.0[id] {
                        open.push(other);
                    }
                }
            }
        }
    }
    found
}
