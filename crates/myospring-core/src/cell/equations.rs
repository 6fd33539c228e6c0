//! Equations of a cell model as data: what the reader of a model file makes, and what becomes a
//! [`CellModel`](super::CellModel).
//!
//! [`Equations`] has constants, states with their rates, and intermediate variables. All
//! expressions are nodes of one [`Nodes`] list, ordered so that one pass from first to last
//! evaluates everything: [`Equations::evaluate`] is that pass, plain and slow. It is the reference
//! for every faster form.
//!
//! Time is in ms and rates are per ms, whatever the file has. Values of states and constants stay
//! in the units of the file; [`Roles`] has the factors to mV, uM and kPa.
//!
//! # Example
//! One state that decays, `dx/dt = -k x`:
//! ```
//! use myospring::cell::equations::{BinaryOperation, Constant, Node, Nodes, State, UnaryOperation};
//!
//! let mut nodes = Nodes::default();
//! let (k, x) = (nodes.push(Node::Constant(0))?, nodes.push(Node::State(0))?);
//! let product = nodes.push(Node::Binary(BinaryOperation::Multiply, k, x))?;
//! let rate = nodes.push(Node::Unary(UnaryOperation::Negative, product))?;
//! let mut values = Vec::new();
//! nodes.evaluate(&[0.5], &[2.0], 0.0, 0.0, &[], &mut values);
//! assert_eq!(values[rate.index()], -1.0);
//! # Ok::<(), myospring::cell::equations::TooManyNodes>(())
//! ```

mod node;
mod roles;

pub use node::{
    BinaryOperation, Expression, MOST_NODES, Node, Nodes, TooManyNodes, UnaryOperation,
};
pub use roles::{
    CalciumRole, DefaultStimulus, Found, PotentialRole, Roles, StimulusRole, TensionRole,
};

use std::fmt;

/// The equations of one cell model.
///
/// The reader guarantees: indices in range; names unique among constants, states and intermediates
/// together; every rate finite at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct Equations {
    /// Name of the model: the file's name without its ending.
    pub name: String,
    /// Title of the model, in one line; the file's own where it has one.
    pub description: String,
    /// Where the equations come from.
    pub source: Source,
    /// The numbers of the file that may be set, as parameters.
    pub constants: Vec<Constant>,
    /// The states, in the order of the file.
    pub states: Vec<State>,
    /// All other variables, each after those that it needs.
    pub intermediates: Vec<Intermediate>,
    /// Nodes of all expressions.
    pub nodes: Nodes,
    /// What is potential, stimulus, calcium and tension.
    pub roles: Roles,
    /// What the reader left out or assumed, a sentence each.
    pub notes: Vec<String>,
}

/// Where equations come from.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Source {
    /// The file as the user named it.
    pub file: String,
    /// Its format: `CellML 1.0`, `Myokit`.
    pub format: String,
    /// Papers and authors that the file names, as it writes them; empty if it names none.
    pub citation: String,
}

/// Where a variable is defined in its file.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Place {
    /// The file, if not the main one.
    pub file: Option<String>,
    /// Line of its definition, from 1.
    pub line: usize,
}

/// A number of the file: a parameter of the model.
#[derive(Debug, Clone, PartialEq)]
pub struct Constant {
    /// Component and variable, `membrane.Cm`.
    pub name: String,
    /// Its unit as text, `uA/cm^2`; empty for a pure number.
    pub unit: String,
    /// Its value in the file.
    pub value: f64,
    /// Its meaning, if the file states it.
    pub meaning: String,
    /// Where it is defined.
    pub place: Place,
}

/// A state variable and its rate.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    /// Component and variable, `membrane.V`.
    pub name: String,
    /// Its unit as text; empty for a pure number.
    pub unit: String,
    /// Its value at the start, in that unit.
    pub start: f64,
    /// Its rate of change, in its unit per ms.
    pub rate: Expression,
    /// Its meaning, if the file states it.
    pub meaning: String,
    /// Where it is defined.
    pub place: Place,
}

/// A variable that follows from constants, states, time and stimulus, such as a current.
#[derive(Debug, Clone, PartialEq)]
pub struct Intermediate {
    /// Component and variable, `ina.INa`.
    pub name: String,
    /// Its unit as text; empty for a pure number.
    pub unit: String,
    /// Its value.
    pub value: Expression,
    /// Its meaning, if the file states it.
    pub meaning: String,
    /// Where it is defined.
    pub place: Place,
}

/// A reference to a variable of [`Equations`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Variable {
    /// A constant, by index.
    Constant(usize),
    /// A state, by index.
    State(usize),
    /// An intermediate, by index.
    Intermediate(usize),
}

impl Equations {
    /// The variable of a name, `membrane.V`.
    pub fn find(&self, name: &str) -> Option<Variable> {
        let state = self.states.iter().position(|own| own.name == name).map(Variable::State);
        let constant = || self.constants.iter().position(|own| own.name == name);
        let intermediate = || self.intermediates.iter().position(|own| own.name == name);
        state
            .or_else(|| constant().map(Variable::Constant))
            .or_else(|| intermediate().map(Variable::Intermediate))
    }

    /// Name, unit and place of a variable.
    ///
    /// # Panics
    /// If the index is not one of these equations.
    pub fn about(&self, variable: Variable) -> (&str, &str, &Place) {
        match variable {
            Variable::Constant(index) => {
                let own = &self.constants[index];
                (&own.name, &own.unit, &own.place)
            }
            Variable::State(index) => {
                let own = &self.states[index];
                (&own.name, &own.unit, &own.place)
            }
            Variable::Intermediate(index) => {
                let own = &self.intermediates[index];
                (&own.name, &own.unit, &own.place)
            }
        }
    }

    /// A variable for messages: `membrane.V (paci-2020.mmt, line 44)`.
    pub fn display(&self, variable: Variable) -> impl fmt::Display {
        let (name, _, place) = self.about(variable);
        let file = place.file.as_deref().unwrap_or(&self.source.file);
        format!("{name} ({file}, line {})", place.line)
    }

    /// The values of the constants in the file, in their order.
    pub fn constant_values(&self) -> Vec<f64> {
        self.constants.iter().map(|constant| constant.value).collect()
    }

    /// The values of the states at the start, in their order.
    pub fn start(&self) -> Vec<f64> {
        self.states.iter().map(|state| state.start).collect()
    }

    /// Evaluates every node in order, without optimisation: values and rates for tests, and the
    /// reference for faster forms. The value of an expression is at its
    /// [`index`](Expression::index); see also [`Evaluated`].
    pub fn evaluate(
        &self,
        constants: &[f64],
        states: &[f64],
        time_ms: f64,
        stimulus: f64,
    ) -> Evaluated<'_> {
        let roots: Vec<Expression> = self.intermediates.iter().map(|own| own.value).collect();
        let mut values = Vec::new();
        self.nodes.evaluate(constants, states, time_ms, stimulus, &roots, &mut values);
        Evaluated {
            equations: self,
            values,
            constants: constants.to_vec(),
            states: states.to_vec(),
        }
    }
}

/// The values of all nodes at one state and time.
#[derive(Debug, Clone)]
pub struct Evaluated<'a> {
    equations: &'a Equations,
    values: Vec<f64>,
    constants: Vec<f64>,
    states: Vec<f64>,
}

impl Evaluated<'_> {
    /// The value of an expression.
    pub fn expression(&self, expression: Expression) -> f64 {
        self.values[expression.index()]
    }

    /// The value of a variable, in its unit.
    pub fn variable(&self, variable: Variable) -> f64 {
        match variable {
            Variable::Constant(index) => self.constants[index],
            Variable::State(index) => self.states[index],
            Variable::Intermediate(index) => {
                self.expression(self.equations.intermediates[index].value)
            }
        }
    }

    /// The rates of all states, each in its unit per ms.
    pub fn rates(&self) -> Vec<f64> {
        self.equations.states.iter().map(|state| self.expression(state.rate)).collect()
    }
}
