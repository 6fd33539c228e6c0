//! Equations as a graph in which every operation stands once.

use super::values;
use std::collections::HashMap;

pub(in crate::cell) use super::values::{One, Two};

/// A place in a [`Graph`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(in crate::cell) struct Id(u32);

impl Id {
    pub(super) fn index(self) -> usize {
        self.0 as usize
    }
}

/// What changes from step to step besides the states.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::cell) enum Outer {
    /// The stimulus current.
    Stimulus,
    /// Time, ms.
    Time,
    /// Length over resting length.
    Stretch,
    /// Its rate, 1/ms.
    StretchRate,
}

impl Outer {
    pub(super) const ALL: [Self; 4] =
        [Self::Stimulus, Self::Time, Self::Stretch, Self::StretchRate];
}

/// One operation or value.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::cell) enum Operation {
    /// A number, by its bits.
    Literal(u64),
    /// A number of the cell that does not change while it is integrated, by index.
    Given(u32),
    /// A state, by index.
    State(u32),
    Outer(Outer),
    One(One, Id),
    Two(Two, Id, Id),
    /// The second where the first is not 0, else the third.
    Select(Id, Id, Id),
}

impl Operation {
    pub(super) fn operands(self) -> impl Iterator<Item = Id> {
        let operands = match self {
            Self::One(_, a) => [Some(a), None, None],
            Self::Two(_, a, b) => [Some(a), Some(b), None],
            Self::Select(a, b, c) => [Some(a), Some(b), Some(c)],
            _ => [None; 3],
        };
        operands.into_iter().flatten()
    }
}

/// The largest whole or half exponent that becomes multiplications.
const LARGEST_POWER: f64 = 32.0;

/// Operations, each once, operands before those that need them.
#[derive(Debug, Clone, Default)]
pub(in crate::cell) struct Graph {
    operations: Vec<Operation>,
    places: HashMap<Operation, Id>,
    /// Whether an operation depends on states or [`Outer`] values, not only on the cell's numbers.
    moving: Vec<bool>,
}

impl Graph {
    pub(super) fn len(&self) -> usize {
        self.operations.len()
    }

    pub(super) fn operation(&self, id: Id) -> Operation {
        self.operations[id.index()]
    }

    pub(super) fn ids(&self) -> impl Iterator<Item = Id> + use<> {
        (0..self.operations.len() as u32).map(Id)
    }

    /// Whether a value changes while a cell is integrated.
    pub(in crate::cell) fn moves(&self, id: Id) -> bool {
        self.moving[id.index()]
    }

    fn push(&mut self, operation: Operation) -> Id {
        if let Some(&id) = self.places.get(&operation) {
            return id;
        }
        let id = Id(self.operations.len() as u32);
        let own = matches!(operation, Operation::State(_) | Operation::Outer(_));
        self.moving.push(own || operation.operands().any(|operand| self.moves(operand)));
        self.operations.push(operation);
        self.places.insert(operation, id);
        id
    }

    pub(in crate::cell) fn literal(&mut self, value: f64) -> Id {
        self.push(Operation::Literal(value.to_bits()))
    }

    pub(in crate::cell) fn given(&mut self, index: usize) -> Id {
        self.push(Operation::Given(index as u32))
    }

    pub(in crate::cell) fn state(&mut self, index: usize) -> Id {
        self.push(Operation::State(index as u32))
    }

    pub(in crate::cell) fn outer(&mut self, outer: Outer) -> Id {
        self.push(Operation::Outer(outer))
    }

    /// The number of a literal.
    pub(super) fn number(&self, id: Id) -> Option<f64> {
        match self.operation(id) {
            Operation::Literal(bits) => Some(f64::from_bits(bits)),
            _ => None,
        }
    }

    fn is(&self, id: Id, number: f64) -> bool {
        self.number(id) == Some(number)
    }

    pub(in crate::cell) fn one(&mut self, one: One, a: Id) -> Id {
        if let Some(number) = self.number(a) {
            return self.literal(values::one(one, number));
        }
        match (one, self.operation(a)) {
            (One::Negative, Operation::One(One::Negative, b))
            | (One::Inverse, Operation::One(One::Inverse, b)) => b,
            _ => self.push(Operation::One(one, a)),
        }
    }

    pub(in crate::cell) fn two(&mut self, two: Two, a: Id, b: Id) -> Id {
        if let (Some(left), Some(right)) = (self.number(a), self.number(b)) {
            return self.literal(values::two(two, left, right));
        }
        match two {
            Two::Add if self.is(a, 0.0) => b,
            Two::Add | Two::Subtract if self.is(b, 0.0) => a,
            Two::Subtract if self.is(a, 0.0) => self.one(One::Negative, b),
            Two::Multiply if self.is(a, 1.0) => b,
            Two::Multiply | Two::Divide if self.is(b, 1.0) => a,
            Two::Multiply if self.is(a, -1.0) => self.one(One::Negative, b),
            Two::Multiply if self.is(b, -1.0) => self.one(One::Negative, a),
            Two::Divide if self.is(a, 1.0) => self.one(One::Inverse, b),
            // One division per cell instead of one per step.
            Two::Divide if self.moves(a) && !self.moves(b) => {
                let inverse = self.one(One::Inverse, b);
                self.two(Two::Multiply, a, inverse)
            }
            Two::Power => self.power(a, b),
            Two::Add | Two::Multiply if b < a => self.push(Operation::Two(two, b, a)),
            _ => self.push(Operation::Two(two, a, b)),
        }
    }

    /// `a^b`: by multiplications and a root where the exponent is a small whole or half number, by
    /// an exponential where the base is one.
    fn power(&mut self, a: Id, b: Id) -> Id {
        if let Some(exponent) = self.number(b) {
            let twice = 2.0 * exponent;
            if twice.fract() == 0.0 && exponent.abs() <= LARGEST_POWER {
                return self.multiplied(a, twice as i32);
            }
        }
        if let Some(base) = self.number(a)
            && base > 0.0
        {
            let logarithm = self.literal(base.ln());
            let exponent = self.two(Two::Multiply, b, logarithm);
            return self.one(One::Exponential, exponent);
        }
        self.push(Operation::Two(Two::Power, a, b))
    }

    /// `a^(halves / 2)`.
    fn multiplied(&mut self, a: Id, halves: i32) -> Id {
        let positive = halves.unsigned_abs();
        let mut product = None;
        if positive % 2 == 1 {
            product = Some(self.one(One::SquareRoot, a));
        }
        let (mut rest, mut square) = (positive / 2, a);
        while rest > 0 {
            if rest % 2 == 1 {
                product = Some(match product {
                    Some(product) => self.two(Two::Multiply, product, square),
                    None => square,
                });
            }
            rest /= 2;
            if rest > 0 {
                square = self.two(Two::Multiply, square, square);
            }
        }
        let product = product.unwrap_or_else(|| self.literal(1.0));
        if halves < 0 { self.one(One::Inverse, product) } else { product }
    }

    pub(in crate::cell) fn select(&mut self, condition: Id, then: Id, otherwise: Id) -> Id {
        match self.number(condition) {
            Some(0.0) => otherwise,
            Some(_) => then,
            None if then == otherwise => then,
            None => self.push(Operation::Select(condition, then, otherwise)),
        }
    }
}
