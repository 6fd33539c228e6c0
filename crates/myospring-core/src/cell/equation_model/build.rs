//! Makes a model from equations: its graph, its compiled form, its numbers.

use super::describe::{self, Names};
use super::{EquationModel, Reading, Shared, jumps};
use crate::cell::description::{
    ModelError, Moved, StateVariable, Stimulation, TensionKind, required,
};
use crate::cell::equations::{
    BinaryOperation, Equations, Expression, Node, UnaryOperation, Variable,
};
use crate::cell::land_2017::{self, Myofilaments, NUMBERS, STATES};
use crate::cell::pacing::Stimulus;
use crate::cell::solve;
use crate::cell::tape::graph::{Graph, Id, One, Outer, Two};
use crate::cell::tape::{Compiled, Program, Traced};
use crate::parameter::ParameterSet;
use std::cell::RefCell;
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
                "it has no calcium that could drive myofilaments; name its calcium variable, or run it without \
                 myofilaments, as a membrane alone"
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
        let unit = if role.unit.is_empty() { "1/ms" } else { &role.unit };
        Ok(Stimulation { default, current_unit: unit.to_owned().into(), moves: moves.into() })
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

/// The graph of some equations, and where their expressions are in it.
pub(super) struct Graphs {
    pub(super) graph: Graph,
    /// The place of each node.
    nodes: Vec<Id>,
    rates: Vec<Id>,
    constants: Vec<Id>,
    states: Vec<Id>,
    intermediates: Vec<Expression>,
}

impl Graphs {
    fn of(equations: &Equations, myofilaments: bool) -> Self {
        let mut graph = Graph::default();
        let constants = (0..equations.constants.len()).map(|index| graph.given(index)).collect();
        let states = (0..equations.states.len()).map(|index| graph.state(index)).collect();
        let intermediates = equations.intermediates.iter().map(|own| own.value).collect();
        let mut built =
            Self { graph, nodes: Vec::new(), rates: Vec::new(), constants, states, intermediates };
        for (_, node) in equations.nodes.iter() {
            let id = built.translated(node);
            built.nodes.push(id);
        }
        let rates = equations.states.iter().map(|state| built.nodes[state.rate.index()]).collect();
        built.rates = rates;
        if myofilaments {
            built.add_myofilaments(equations);
        }
        built
    }

    /// The place of a variable.
    pub(super) fn of_variable(&self, variable: Variable) -> Id {
        match variable {
            Variable::Constant(index) => self.constants[index],
            Variable::State(index) => self.states[index],
            Variable::Intermediate(index) => self.nodes[self.intermediates[index].index()],
        }
    }

    fn translated(&mut self, node: Node) -> Id {
        let of = |expression: Expression| self.nodes[expression.index()];
        match node {
            Node::Number(number) => self.graph.literal(number),
            Node::Time => self.graph.outer(Outer::Time),
            Node::Stimulus => self.graph.outer(Outer::Stimulus),
            Node::Constant(index) => self.constants[index as usize],
            Node::State(index) => self.states[index as usize],
            Node::Intermediate(index) => of(self.intermediates[index as usize]),
            Node::Unary(operation, a) => {
                let a = of(a);
                self.unary(operation, a)
            }
            Node::Binary(operation, a, b) => {
                let (a, b) = (of(a), of(b));
                self.binary(operation, a, b)
            }
            Node::Select(condition, then, otherwise) => {
                let (condition, then, otherwise) = (of(condition), of(then), of(otherwise));
                self.graph.select(condition, then, otherwise)
            }
        }
    }

    fn unary(&mut self, operation: UnaryOperation, a: Id) -> Id {
        let one = match operation {
            UnaryOperation::Negative => One::Negative,
            UnaryOperation::Not => One::Not,
            UnaryOperation::Absolute => One::Absolute,
            UnaryOperation::Exponential => One::Exponential,
            UnaryOperation::Logarithm => One::Logarithm,
            UnaryOperation::Logarithm10 => {
                let natural = self.graph.one(One::Logarithm, a);
                let factor = self.graph.literal(std::f64::consts::LOG10_E);
                return self.graph.two(Two::Multiply, natural, factor);
            }
            UnaryOperation::SquareRoot => One::SquareRoot,
            UnaryOperation::Floor => One::Floor,
            UnaryOperation::Ceiling => One::Ceiling,
            UnaryOperation::Sine => One::Sine,
            UnaryOperation::Cosine => One::Cosine,
            UnaryOperation::Tangent => One::Tangent,
            UnaryOperation::ArcSine => One::ArcSine,
            UnaryOperation::ArcCosine => One::ArcCosine,
            UnaryOperation::ArcTangent => One::ArcTangent,
            UnaryOperation::HyperbolicSine => One::HyperbolicSine,
            UnaryOperation::HyperbolicCosine => One::HyperbolicCosine,
            UnaryOperation::HyperbolicTangent => One::HyperbolicTangent,
            UnaryOperation::AreaSine => One::AreaSine,
            UnaryOperation::AreaCosine => One::AreaCosine,
            UnaryOperation::AreaTangent => One::AreaTangent,
        };
        self.graph.one(one, a)
    }

    fn binary(&mut self, operation: BinaryOperation, a: Id, b: Id) -> Id {
        let graph = &mut self.graph;
        match operation {
            BinaryOperation::Add => graph.two(Two::Add, a, b),
            BinaryOperation::Subtract => graph.two(Two::Subtract, a, b),
            BinaryOperation::Multiply => graph.two(Two::Multiply, a, b),
            BinaryOperation::Divide => graph.two(Two::Divide, a, b),
            BinaryOperation::Power => graph.two(Two::Power, a, b),
            BinaryOperation::Minimum => graph.two(Two::Minimum, a, b),
            BinaryOperation::Maximum => graph.two(Two::Maximum, a, b),
            BinaryOperation::Remainder => {
                let part = graph.two(Two::Divide, a, b);
                let whole = graph.one(One::Floor, part);
                let taken = graph.two(Two::Multiply, b, whole);
                graph.two(Two::Subtract, a, taken)
            }
            BinaryOperation::Less => graph.two(Two::Less, a, b),
            BinaryOperation::LessOrEqual => graph.two(Two::LessOrEqual, a, b),
            BinaryOperation::Greater => graph.two(Two::Less, b, a),
            BinaryOperation::GreaterOrEqual => graph.two(Two::LessOrEqual, b, a),
            BinaryOperation::Equal => graph.two(Two::Equal, a, b),
            BinaryOperation::NotEqual => graph.two(Two::NotEqual, a, b),
            BinaryOperation::And => graph.two(Two::And, a, b),
            BinaryOperation::Or => graph.two(Two::Or, a, b),
        }
    }

    /// Adds the rates of the six states of the myofilaments, which follow those of the equations;
    /// their numbers follow the constants.
    fn add_myofilaments(&mut self, equations: &Equations) {
        let Some(role) = &equations.roles.calcium else { return };
        let (calcium, constants, states) =
            (self.of_variable(role.variable), self.constants.len(), self.states.len());
        let graph = RefCell::new(std::mem::take(&mut self.graph));
        let recorded = |id: Id| Traced::Recorded(&graph, id);
        let numbers: [Traced<'_>; NUMBERS] =
            std::array::from_fn(|k| recorded(graph.borrow_mut().given(constants + k)));
        let state: [Traced<'_>; STATES] =
            std::array::from_fn(|k| recorded(graph.borrow_mut().state(states + k)));
        let [stretch, rate] = [Outer::Stretch, Outer::StretchRate]
            .map(|outer| recorded(graph.borrow_mut().outer(outer)));
        let calcium = recorded(calcium) * role.micromolar;
        let myofilaments = Myofilaments::of_numbers(numbers);
        let rates = myofilaments.rates_of(&state, calcium, stretch, rate);
        self.rates.extend(rates.map(|rate| rate.id(&graph)));
        self.graph = graph.into_inner();
    }
}
