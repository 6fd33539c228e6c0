//! Makes a model from equations: its graph, its compiled form, its numbers.

use super::describe::{self, Names};
use super::graphs::Graphs;
use super::{EquationModel, Reading, Shared, jumps};
use crate::cell::description::{
    ModelError, Moved, StateVariable, Stimulation, TensionKind, required,
};
use crate::cell::equations::{Equations, Variable};
use crate::cell::land_2017::{self, Myofilaments, STATES};
use crate::cell::pacing::Stimulus;
use crate::cell::solve;
use crate::cell::tape::graph::Id;
use crate::cell::tape::{Compiled, Program};
use crate::parameter::ParameterSet;
use std::sync::Arc;

impl EquationModel {
    /// The model of these equations, with tension if they have it.
    ///
    /// # Errors
    /// A stimulus that does not act on the potential, or not in proportion to its strength.
    pub fn new(equations: Equations) -> Result<Self, ModelError> {
        Self::build(equations, false)
    }

    /// The same with the myofilaments of `land_2017`, driven by the calcium of the equations. Their
    /// parameters follow those of the equations, their six states come last; they start in their
    /// steady state. A tension of the equations' own is left out. Calcium does not depend on the
    /// myofilaments.
    ///
    /// # Errors
    /// Also equations without calcium.
    pub fn with_myofilaments(equations: Equations) -> Result<Self, ModelError> {
        Self::build(equations, true)
    }

    fn build(equations: Equations, myofilaments: bool) -> Result<Self, ModelError> {
        let names = Names::new(&equations, myofilaments);
        let contradiction = |reason: String| ModelError::Contradiction {
            model: equations.source.file.clone(),
            reason,
        };
        if myofilaments && equations.roles.calcium.is_none() {
            return Err(contradiction(
                "it has no calcium that could drive myofilaments; name its calcium variable (calcium=component.variable), or run it \
                 without myofilaments, as a membrane alone"
                    .to_owned(),
            ));
        }
        let built = Graphs::of(&equations, myofilaments);
        let (observed, outputs) = describe::outputs(&equations, &names, &built);
        let observed_ids: Vec<Id> = observed.iter().map(|own| built.of_variable(*own)).collect();
        let potential = equations.roles.potential.state;
        let program =
            Arc::new(Program::new(built.graph, &built.rates, &observed_ids, Some(potential)));
        let shared = shared(equations, names, &observed, outputs, myofilaments);
        let parameters = describe::parameters(&shared.equations, &shared.names, myofilaments);
        let seen = seen(&shared, myofilaments);
        let compiled = Compiled { program, fixed: Vec::new(), seen: seen.into() };
        let empty = Self {
            shared: Arc::new(shared),
            parameters: ParameterSet::new(Vec::new()),
            compiled,
            myofilaments: myofilaments.then(Myofilaments::published),
            states: Arc::new([]),
            stimulation: Stimulation::of_first_state(Stimulus::Jump { amplitude: 0.0 }),
        };
        Ok(empty.rebuilt(parameters)?.with_published_peak())
    }

    /// The same equations with other values.
    pub(super) fn rebuilt(&self, parameters: ParameterSet) -> Result<Self, ModelError> {
        let shared = &self.shared;
        let equations = &shared.equations;
        let read = |name: &String| required(&shared.name, &parameters, name);
        let constants: Vec<f64> =
            shared.names.constants.iter().map(read).collect::<Result<_, _>>()?;
        let mut given = constants.clone();
        let mut states = describe::states(equations, &shared.names);
        let mut myofilaments = None;
        if self.has_myofilaments() {
            let read = Myofilaments::new(&shared.name, &parameters)?;
            given.extend(read.numbers());
            let calcium = calcium_at_start(equations, &constants);
            states.extend(land_2017::states(read.steady(calcium, 1.0)));
            myofilaments = Some(read);
        }
        let mut compiled = self.compiled.clone();
        compiled.fixed = compiled.program.fixed(&given);
        let stimulation = self.stimulation_with(&given)?;
        let states: Arc<[StateVariable]> = states.into();
        Ok(Self {
            shared: Arc::clone(shared),
            parameters,
            compiled,
            myofilaments,
            states,
            stimulation,
        })
    }

    /// Its stimulus, from how the rates depend on it.
    fn stimulation_with(&self, given: &[f64]) -> Result<Stimulation, ModelError> {
        let equations = &self.shared.equations;
        let (role, potential) = (&equations.roles.stimulus, equations.roles.potential.state);
        let name = |state: usize| &equations.states[state].name;
        let wrong = |reason: String| ModelError::Contradiction {
            model: equations.source.file.clone(),
            reason,
        };
        let mut moves = Vec::new();
        for (state, weight) in self.compiled.program.moved(given) {
            let Some(weight) = weight else {
                return Err(wrong(format!(
                    "the effect of the stimulus on {} depends on the state of the cell; name the stimulus current",
                    name(state)
                )));
            };
            if weight != 0.0 {
                moves.push(Moved { state, weight });
            }
        }
        moves.sort_by_key(|moved| (moved.state != potential, moved.state));
        if moves.first().map(|moved| moved.state) != Some(potential) {
            return Err(wrong(format!(
                "the stimulus does not change {}; name the stimulus current",
                name(potential)
            )));
        }
        let default = Stimulus::Pulse {
            amplitude: role.default.amplitude,
            duration_ms: role.default.duration_ms,
        };
        // A stimulus without a unit that is as large as the rate has the unit of the rate.
        let of_rate = moves.first().is_some_and(|moved| moved.weight.abs() == 1.0);
        let unit = match (role.unit.as_str(), equations.states[potential].unit.as_str()) {
            ("", "") => "1/ms".to_owned(),
            ("", unit) if of_rate => format!("{unit}/ms"),
            ("", _) => "1/ms".to_owned(),
            (unit, _) => unit.to_owned(),
        };
        Ok(Stimulation { default, current_unit: unit.into(), moves: moves.into() })
    }

    /// Finds the peak of a relative tension, to which a run scales it; a tension without a peak is
    /// none.
    fn with_published_peak(mut self) -> Self {
        if !matches!(self.shared.tension, TensionKind::Relative { .. }) {
            return self;
        }
        let beat = solve::reference_beat(&self, crate::cell::CellModel::usual_settings(&self));
        if let Some(shared) = Arc::get_mut(&mut self.shared) {
            shared.tension = match beat {
                Ok(beat) => TensionKind::Relative { published_peak: beat.peak_tension },
                Err(_) => TensionKind::None,
            };
        }
        self
    }
}

/// Free calcium at the start, uM.
fn calcium_at_start(equations: &Equations, constants: &[f64]) -> f64 {
    let calcium = equations.roles.calcium.as_ref();
    let start = equations.evaluate(constants, &equations.start(), 0.0, 0.0);
    calcium.map_or(0.0, |role| role.micromolar * start.variable(role.variable))
}

/// What does not depend on values.
fn shared(
    equations: Equations,
    names: Names,
    observed: &[Variable],
    outputs: Vec<crate::cell::description::Output>,
    myofilaments: bool,
) -> Shared {
    let reading = |variable: Variable| match variable {
        Variable::State(index) => Some(Reading::State(index)),
        Variable::Constant(index) => Some(Reading::Parameter(index)),
        Variable::Intermediate(_) => {
            observed.iter().position(|own| *own == variable).map(Reading::Observed)
        }
    };
    let roles = &equations.roles;
    let read = |role: Option<(Variable, f64)>| {
        role.and_then(|(variable, factor)| Some((reading(variable)?, factor)))
    };
    let millivolts = read(roles.potential.millivolts);
    let micromolar = read(roles.calcium.as_ref().map(|role| (role.variable, role.micromolar)));
    let own = roles.tension.as_ref().filter(|_| !myofilaments);
    let kilopascals = read(own.map(|role| (role.variable, role.kilopascals.unwrap_or(1.0))));
    let tension = match own {
        _ if myofilaments => TensionKind::Kilopascal,
        None => TensionKind::None,
        Some(role) if role.kilopascals.is_some() => TensionKind::Kilopascal,
        Some(_) => TensionKind::Relative { published_peak: 1.0 },
    };
    let states = equations.states.len() + if myofilaments { STATES } else { 0 };
    let recorded = (0..states).filter(|state| *state != roles.potential.state).collect();
    let jumps = jumps::slides(&equations, roles.potential.state);
    let (name, description) = describe::title(&equations, myofilaments);
    Shared {
        equations,
        name,
        description,
        names,
        outputs,
        recorded,
        millivolts,
        micromolar,
        kilopascals,
        tension,
        jumps,
    }
}

/// The states from which potential, calcium and tension follow.
fn seen(shared: &Shared, myofilaments: bool) -> Vec<usize> {
    let roles = [shared.millivolts, shared.micromolar, shared.kilopascals];
    let count = shared.equations.states.len();
    let mut seen = vec![shared.equations.roles.potential.state];
    for (reading, _) in roles.into_iter().flatten() {
        match reading {
            Reading::State(index) => seen.push(index),
            Reading::Observed(_) => seen.extend(0..count),
            Reading::Parameter(_) => {}
        }
    }
    if myofilaments {
        seen.extend(count..count + STATES);
    }
    seen.sort_unstable();
    seen.dedup();
    seen
}
