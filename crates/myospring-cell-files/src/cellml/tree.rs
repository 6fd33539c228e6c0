//! Components and variables of a CellML model, before connections are followed.

use crate::unit::Unit;
use myospring_core::cell::equations::{BinaryOperation, UnaryOperation};
use std::collections::HashMap;

/// A model with everything that it imports.
#[derive(Debug, Default, Clone)]
pub(super) struct Model {
    pub(super) format: String,
    pub(super) title: String,
    pub(super) citation: String,
    pub(super) components: Vec<Component>,
    /// Pairs of variables that are one, each as component and variable, with the line.
    pub(super) connections: Vec<Connection>,
    /// Parents of encapsulated components.
    pub(super) parents: HashMap<String, String>,
    pub(super) units: HashMap<String, Unit>,
    pub(super) notes: Vec<String>,
}

#[derive(Debug, Clone)]
pub(super) struct Connection {
    pub(super) ends: [(String, String); 2],
    pub(super) line: usize,
    pub(super) file: Option<String>,
}

#[derive(Debug, Default, Clone)]
pub(super) struct Component {
    pub(super) name: String,
    pub(super) file: Option<String>,
    pub(super) variables: Vec<ModelVariable>,
    pub(super) equations: Vec<Equation>,
}

#[derive(Debug, Clone)]
pub(super) struct ModelVariable {
    pub(super) name: String,
    pub(super) unit: Unit,
    pub(super) initial: Option<String>,
    pub(super) line: usize,
    pub(super) tags: Vec<String>,
    /// Whether an interface says that its value comes from elsewhere.
    pub(super) comes_in: bool,
}

/// `left = right`, or `d left/d time = right`.
#[derive(Debug, Clone)]
pub(super) struct Equation {
    pub(super) left: String,
    /// The variable by which `left` is derived.
    pub(super) by: Option<String>,
    pub(super) right: Formula,
    pub(super) line: usize,
}

/// One operation of a formula; operands are earlier places of its list.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Step {
    Number(f64),
    /// A variable of the component, by place in the formula's names.
    Variable(usize),
    /// Its derivative by time.
    Rate(usize),
    Unary(UnaryOperation, usize),
    Binary(BinaryOperation, usize, usize),
    Select(usize, usize, usize),
}

/// An expression of one component: the last step is its value.
#[derive(Debug, Clone, Default)]
pub(super) struct Formula {
    pub(super) steps: Vec<Step>,
    pub(super) names: Vec<String>,
}
