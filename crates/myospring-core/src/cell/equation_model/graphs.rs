//! Equations as a graph, with or without the myofilaments of `land_2017`.

use crate::cell::equations::{
    BinaryOperation, Equations, Expression, Node, UnaryOperation, Variable,
};
use crate::cell::land_2017::{Myofilaments, NUMBERS, STATES};
use crate::cell::tape::Traced;
use crate::cell::tape::graph::{Graph, Id, One, Outer, Two};
use std::cell::RefCell;

/// The graph of some equations, and where their expressions are in it.
pub(super) struct Graphs {
    pub(super) graph: Graph,
    /// The place of each node.
    nodes: Vec<Id>,
    pub(super) rates: Vec<Id>,
    constants: Vec<Id>,
    states: Vec<Id>,
    intermediates: Vec<Expression>,
}

impl Graphs {
    pub(super) fn of(equations: &Equations, myofilaments: bool) -> Self {
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
