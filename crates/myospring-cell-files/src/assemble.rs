//! A draft to equations: order, start, singularities, roles, what is no longer needed.

use crate::draft::{Draft, DraftVariable, Kind, Problem, Term};
use crate::emit::{Emission, Item, StimulusAt};
use crate::reading::Choices;
use crate::roles::{self, Chosen};
use crate::unit::Unit;
use crate::{removable, stimulus};
use myospring_core::cell::equations::{
    CalciumRole, Constant, Equations, Intermediate, PotentialRole, Roles, Source, State,
    StimulusRole, TensionRole, Variable,
};
use std::path::Path;

/// Makes the equations of a draft.
pub(crate) fn assemble(
    file: &str,
    mut draft: Draft,
    choices: &Choices,
) -> Result<Equations, Problem> {
    if draft.states.is_empty() {
        return Err(Problem::new("the model has no state: nothing changes in time"));
    }
    let start = start(&draft)?;
    let values = values(&draft, &start)?;
    removable::remove(&mut draft, &values)?;
    let chosen = roles::find(&draft, choices)?;
    let found = stimulus::find(&draft, chosen.stimulus, &start, chosen.potential.1)?;
    let kept = kept(&draft, found.at);
    let mut emission = Emission::new(&draft, found.at, &|index| kept[index]);
    let mut states = Vec::new();
    for (&index, &start) in draft.states.iter().zip(&start) {
        let rate = emission.rate_per_ms(index)?;
        let (name, unit, meaning, place) = about(&draft.variables[index]);
        states.push(State { name, unit, start, rate, meaning, place });
    }
    for index in 0..draft.variables.len() {
        let replaced = matches!(found.at, StimulusAt::Variable(own, _) if own == index);
        if kept[index] || replaced {
            emission.add(Item::Value(index))?;
        }
    }
    let (constants, intermediates) = variables(&draft, &emission);
    let equations = Equations {
        name: stem(file),
        description: if draft.title.is_empty() { stem(file) } else { draft.title.clone() },
        source: Source {
            file: file.to_owned(),
            format: draft.format.clone(),
            citation: draft.citation.clone(),
        },
        roles: assigned(&draft, &chosen, found, &emission)?,
        constants,
        states,
        intermediates,
        nodes: emission.nodes,
        notes: draft.notes.clone(),
    };
    finite(&draft, &equations)?;
    Ok(equations)
}

fn stem(file: &str) -> String {
    Path::new(file)
        .file_stem()
        .map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
}

fn about(
    variable: &DraftVariable,
) -> (String, String, String, myospring_core::cell::equations::Place) {
    let unit = variable.unit.map_or_else(String::new, Unit::text);
    (variable.name.clone(), unit, variable.meaning.clone(), variable.place.clone())
}

/// The values of the states at the start.
fn start(draft: &Draft) -> Result<Vec<f64>, Problem> {
    let unknown = vec![f64::NAN; draft.states.len()];
    let mut emission = Emission::new(draft, StimulusAt::Nowhere, &|_| true);
    let mut places = Vec::new();
    for &index in &draft.states {
        let variable = &draft.variables[index];
        let Kind::State { start, .. } = variable.kind else { continue };
        for need in emission.needs_of(start) {
            emission.add(need)?;
        }
        places.push((emission.term(start)?, variable));
    }
    let values = emission.values(&unknown, 0.0, 0.0);
    let value =
        |(place, variable): (myospring_core::cell::equations::Expression, &DraftVariable)| {
            let value: f64 = values[place.index()];
            if value.is_finite() {
                return Ok(value);
            }
            let reason = format!("the initial value of {} is not a finite number", variable.name);
            Err(Problem::of(variable, reason))
        };
    places.into_iter().map(value).collect()
}

/// The values of all variables at the start.
fn values(draft: &Draft, start: &[f64]) -> Result<Vec<f64>, Problem> {
    let mut emission = Emission::new(draft, StimulusAt::Nowhere, &|_| true);
    for index in 0..draft.variables.len() {
        emission.add(Item::Value(index))?;
    }
    for &index in &draft.states {
        emission.add(Item::Rate(index))?;
    }
    let all = emission.values(start, 0.0, 0.0);
    let mut values = vec![0.0; draft.variables.len()];
    for &(index, place) in &emission.intermediates {
        values[index] = all[place.index()];
    }
    for (&index, &start) in draft.states.iter().zip(start) {
        values[index] = start;
    }
    for index in 0..draft.variables.len() {
        values[index] = draft.number(index).unwrap_or(values[index]);
    }
    Ok(values)
}

/// Which variables the equations need once the stimulus is in place: not those that only made the
/// stimulus of the file.
fn kept(draft: &Draft, at: StimulusAt) -> Vec<bool> {
    let count = draft.variables.len();
    let StimulusAt::Variable(stimulus, _) = at else { return vec![true; count] };
    let mut seen = vec![false; draft.terms.0.len()];
    let mut below = vec![false; count];
    reach(draft, stimulus, &mut seen, &mut below);
    let mut kept: Vec<bool> = below.iter().map(|&is_below| !is_below).collect();
    let mut seen = vec![false; draft.terms.0.len()];
    for index in 0..count {
        let is_state = matches!(draft.variables[index].kind, Kind::State { .. });
        if index != stimulus && (is_state || !below[index]) {
            let mut needed = vec![false; count];
            needed[stimulus] = true;
            reach(draft, index, &mut seen, &mut needed);
            needed
                .iter()
                .enumerate()
                .filter(|&(_, &yes)| yes)
                .for_each(|(other, _)| kept[other] = true);
        }
    }
    kept[stimulus] = false;
    kept
}

/// Marks a variable and all that it needs; what is marked already is not followed.
fn reach(draft: &Draft, index: usize, seen: &mut [bool], marked: &mut [bool]) {
    let mut open = vec![index];
    while let Some(index) = open.pop() {
        if std::mem::replace(&mut marked[index], true) {
            continue;
        }
        let root = match draft.variables[index].kind {
            Kind::Value(root) | Kind::State { rate: root, .. } => root,
            Kind::Time => continue,
        };
        for id in draft.operands_first(root, seen) {
            if let Term::Variable(other) | Term::Rate(other) = draft.terms.0[id] {
                open.push(other);
            }
        }
    }
}

fn variables(draft: &Draft, emission: &Emission<'_>) -> (Vec<Constant>, Vec<Intermediate>) {
    let constant = |&index: &usize| {
        let (name, unit, meaning, place) = about(&draft.variables[index]);
        let value = draft.number(index).unwrap_or(f64::NAN);
        Constant { name, unit, value, meaning, place }
    };
    let intermediate = |&(index, value): &(usize, _)| {
        let (name, unit, meaning, place) = about(&draft.variables[index]);
        Intermediate { name, unit, value, meaning, place }
    };
    (
        emission.constants.iter().map(constant).collect(),
        emission.intermediates.iter().map(intermediate).collect(),
    )
}

fn assigned(
    draft: &Draft,
    chosen: &Chosen,
    found: stimulus::FoundStimulus,
    emission: &Emission<'_>,
) -> Result<Roles, Problem> {
    let place = |all: &[usize], index: usize| all.iter().position(|&own| own == index);
    let variable = |index: usize| {
        let intermediate = || emission.intermediates.iter().position(|&(own, _)| own == index);
        place(&draft.states, index)
            .map(Variable::State)
            .or_else(|| place(&emission.constants, index).map(Variable::Constant))
            .or_else(|| intermediate().map(Variable::Intermediate))
            .ok_or_else(|| {
                Problem::of(
                    &draft.variables[index],
                    "time or the stimulus cannot have another role",
                )
            })
    };
    let factor = |index: usize, unit: Unit, per: f64| {
        draft.variables[index].unit.and_then(|own| own.in_units_of(unit)).map(|factor| factor * per)
    };
    let (potential, state, how) = &chosen.potential;
    let millivolts = match factor(*potential, Unit::VOLT, 1e3) {
        Some(factor) => Some((variable(*potential)?, factor)),
        None => None,
    };
    let calcium = match &chosen.calcium {
        None => None,
        Some((index, found)) => {
            let Some(micromolar) = factor(*index, Unit::MOLES_PER_VOLUME, 1e3) else {
                let own = &draft.variables[*index];
                return Err(Problem::of(
                    own,
                    format!("{} is calcium, but its unit is no concentration", own.name),
                ));
            };
            Some(CalciumRole { variable: variable(*index)?, micromolar, found: found.clone() })
        }
    };
    let tension = match &chosen.tension {
        None => None,
        Some((index, found)) => Some(TensionRole {
            variable: variable(*index)?,
            kilopascals: factor(*index, Unit::PASCAL, 1e-3),
            found: found.clone(),
        }),
    };
    let own = match found.at {
        StimulusAt::Variable(index, _) => Some(&draft.variables[index]),
        _ => None,
    };
    let unit = if let Some(own) = own {
        own.unit.map_or_else(String::new, Unit::text)
    } else {
        let unit = draft.variables[*state].unit.map_or_else(String::new, Unit::text);
        format!("{}/ms", if unit.is_empty() { "1" } else { &unit })
    };
    Ok(Roles {
        potential: PotentialRole {
            state: place(&draft.states, *state).unwrap_or(0),
            millivolts,
            found: how.clone(),
        },
        stimulus: StimulusRole {
            name: own.map(|own| own.name.clone()),
            unit,
            default: found.default,
            found: found.found,
        },
        calcium,
        tension,
    })
}

/// Refuses a model with a rate that is no number at the start.
fn finite(draft: &Draft, equations: &Equations) -> Result<(), Problem> {
    let rates =
        equations.evaluate(&equations.constant_values(), &equations.start(), 0.0, 0.0).rates();
    for (&index, rate) in draft.states.iter().zip(rates) {
        if !rate.is_finite() {
            let own = &draft.variables[index];
            return Err(Problem::of(
                own,
                format!("the rate of {} is not a finite number at the start", own.name),
            ));
        }
    }
    Ok(())
}
