//! A model as a file states it, before sorting: variables that refer to each other by index.

use crate::reading::ReadError;
use crate::unit::Unit;
use myospring_core::cell::equations::{BinaryOperation, Place, UnaryOperation};

/// The most terms of all expressions together.
const MOST_TERMS: usize = 1 << 18;

/// How deep expressions may be nested.
pub(crate) const DEEPEST: usize = 200;

/// What is wrong, and where.
#[derive(Debug, Clone)]
pub(crate) struct Problem {
    pub(crate) file: Option<String>,
    pub(crate) line: Option<usize>,
    pub(crate) component: Option<String>,
    pub(crate) reason: String,
}

impl Problem {
    pub(crate) fn new(reason: impl Into<String>) -> Self {
        Self { file: None, line: None, component: None, reason: reason.into() }
    }

    pub(crate) fn at(line: usize, reason: impl Into<String>) -> Self {
        Self { line: Some(line), ..Self::new(reason) }
    }

    pub(crate) fn of(variable: &DraftVariable, reason: impl Into<String>) -> Self {
        let component = variable.name.split('.').next().map(str::to_owned);
        Self {
            file: variable.place.file.clone(),
            component,
            ..Self::at(variable.place.line, reason)
        }
    }

    pub(crate) fn within(mut self, component: &str) -> Self {
        self.component.get_or_insert_with(|| component.to_owned());
        self
    }

    pub(crate) fn in_file(self, file: &str) -> ReadError {
        ReadError {
            file: self.file.unwrap_or_else(|| file.to_owned()),
            line: self.line,
            component: self.component,
            reason: self.reason,
        }
    }
}

/// A place in the list of terms.
pub(crate) type Id = usize;

/// One operation of an expression.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Term {
    Number(f64),
    /// The value of a variable.
    Variable(usize),
    /// The rate of a state, per unit of time of the file.
    Rate(usize),
    Unary(UnaryOperation, Id),
    Binary(BinaryOperation, Id, Id),
    Select(Id, Id, Id),
}

impl Term {
    pub(crate) fn operands(self) -> impl Iterator<Item = Id> {
        let operands = match self {
            Self::Unary(_, a) => [Some(a), None, None],
            Self::Binary(_, a, b) => [Some(a), Some(b), None],
            Self::Select(a, b, c) => [Some(a), Some(b), Some(c)],
            _ => [None; 3],
        };
        operands.into_iter().flatten()
    }
}

/// The terms of all expressions; each refers only to earlier ones.
#[derive(Debug, Default)]
pub(crate) struct Terms(pub(crate) Vec<Term>);

impl Terms {
    pub(crate) fn push(&mut self, term: Term) -> Result<Id, Problem> {
        if self.0.len() >= MOST_TERMS {
            return Err(Problem::new(format!("the model has more than {MOST_TERMS} operations")));
        }
        self.0.push(term);
        Ok(self.0.len() - 1)
    }

    pub(crate) fn number(&mut self, number: f64) -> Result<Id, Problem> {
        self.push(Term::Number(number))
    }

    pub(crate) fn unary(&mut self, operation: UnaryOperation, a: Id) -> Result<Id, Problem> {
        if let (UnaryOperation::Negative, Term::Number(number)) = (operation, self.0[a]) {
            return self.number(-number);
        }
        self.push(Term::Unary(operation, a))
    }

    pub(crate) fn binary(
        &mut self,
        operation: BinaryOperation,
        a: Id,
        b: Id,
    ) -> Result<Id, Problem> {
        self.push(Term::Binary(operation, a, b))
    }

    /// `factor` times a term, the term itself for 1.
    pub(crate) fn scaled(&mut self, a: Id, factor: f64) -> Result<Id, Problem> {
        if factor == 1.0 {
            return Ok(a);
        }
        let factor = self.number(factor)?;
        self.binary(BinaryOperation::Multiply, a, factor)
    }
}

/// What a variable is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Kind {
    /// The independent variable.
    Time,
    /// A value that follows from others, or a number.
    Value(Id),
    /// A state.
    State { start: Id, rate: Id },
}

/// A variable of the file.
#[derive(Debug, Clone)]
pub(crate) struct DraftVariable {
    pub(crate) name: String,
    pub(crate) unit: Option<Unit>,
    pub(crate) meaning: String,
    pub(crate) place: Place,
    /// Annotations: `membrane_voltage`, `pace`.
    pub(crate) tags: Vec<String>,
    pub(crate) kind: Kind,
}

impl DraftVariable {
    /// The name without its component.
    pub(crate) fn short(&self) -> &str {
        self.name.rsplit('.').next().unwrap_or(&self.name)
    }
}

/// The stimulus of a protocol section, in the time unit of the file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ProtocolPulse {
    pub(crate) level: f64,
    pub(crate) duration: f64,
    pub(crate) period: Option<f64>,
}

/// A model as its file states it.
#[derive(Debug, Default)]
pub(crate) struct Draft {
    pub(crate) format: String,
    pub(crate) title: String,
    pub(crate) citation: String,
    pub(crate) notes: Vec<String>,
    pub(crate) terms: Terms,
    pub(crate) variables: Vec<DraftVariable>,
    /// The states in the order of the state vector.
    pub(crate) states: Vec<usize>,
    pub(crate) protocol: Option<ProtocolPulse>,
    /// ms per unit of time.
    pub(crate) milliseconds: f64,
}

impl Draft {
    /// The number of a variable that is one: a parameter.
    pub(crate) fn number(&self, variable: usize) -> Option<f64> {
        let Kind::Value(id) = self.variables[variable].kind else { return None };
        if let Term::Number(number) = self.terms.0[id] { Some(number) } else { None }
    }

    /// The terms of an expression that are not in `seen` yet, operands first; marks them.
    pub(crate) fn operands_first(&self, root: Id, seen: &mut [bool]) -> Vec<Id> {
        let mut order = Vec::new();
        let mut open = vec![(root, false)];
        while let Some((id, done)) = open.pop() {
            if done {
                order.push(id);
            } else if !std::mem::replace(&mut seen[id], true) {
                open.push((id, true));
                open.extend(self.terms.0[id].operands().map(|operand| (operand, false)));
            }
        }
        order
    }
}
