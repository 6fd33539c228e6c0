//! A number type that records what is done with it, so that equations written once in Rust become
//! operations of a graph, too.
#![allow(clippy::inline_always, reason = "as the other number types")]

use super::graph::{Graph, Id, One, Two};
use crate::cell::number::Number;
use std::cell::RefCell;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A plain number, or a value of a graph.
#[derive(Debug, Clone, Copy)]
pub(in crate::cell) enum Traced<'g> {
    Plain(f64),
    Recorded(&'g RefCell<Graph>, Id),
}

impl<'g> Traced<'g> {
    /// Its place in a graph.
    pub(in crate::cell) fn id(self, graph: &'g RefCell<Graph>) -> Id {
        match self {
            Self::Plain(number) => graph.borrow_mut().literal(number),
            Self::Recorded(_, id) => id,
        }
    }

    fn one(self, one: One) -> Self {
        match self {
            Self::Plain(number) => Self::Plain(super::values::one(one, number)),
            Self::Recorded(graph, id) => Self::Recorded(graph, graph.borrow_mut().one(one, id)),
        }
    }

    fn two(self, two: Two, other: Self) -> Self {
        let graph = match (self, other) {
            (Self::Plain(a), Self::Plain(b)) => return Self::Plain(super::values::two(two, a, b)),
            (Self::Recorded(graph, _), _) | (_, Self::Recorded(graph, _)) => graph,
        };
        let (a, b) = (self.id(graph), other.id(graph));
        Self::Recorded(graph, graph.borrow_mut().two(two, a, b))
    }
}

impl Number for Traced<'_> {
    type Constant = Self;
    fn constant(value: Self) -> Self {
        value
    }
    fn of(value: f64) -> Self {
        Self::Plain(value)
    }
    fn exp(self) -> Self {
        self.one(One::Exponential)
    }
    fn ln(self) -> Self {
        self.one(One::Logarithm)
    }
    fn sqrt(self) -> Self {
        self.one(One::SquareRoot)
    }
    fn inverse(self) -> Self {
        self.one(One::Inverse)
    }
    fn magnitude(self) -> Self {
        self.one(One::Absolute)
    }
    fn at_least(self, bound: f64, then: Self, otherwise: Self) -> Self {
        let condition = Self::Plain(bound).two(Two::LessOrEqual, self);
        match condition {
            Self::Plain(0.0) => otherwise,
            Self::Plain(_) => then,
            Self::Recorded(graph, condition) => {
                let (then, otherwise) = (then.id(graph), otherwise.id(graph));
                Self::Recorded(graph, graph.borrow_mut().select(condition, then, otherwise))
            }
        }
    }
}

impl Neg for Traced<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        self.one(One::Negative)
    }
}

macro_rules! operator {
    ($($trait:ident, $method:ident, $two:ident;)*) => {$(
        impl $trait for Traced<'_> {
            type Output = Self;
            fn $method(self, other: Self) -> Self {
                self.two(Two::$two, other)
            }
        }
        impl $trait<f64> for Traced<'_> {
            type Output = Self;
            fn $method(self, other: f64) -> Self {
                self.two(Two::$two, Self::Plain(other))
            }
        }
    )*};
}
operator! {
    Add, add, Add;
    Sub, sub, Subtract;
    Mul, mul, Multiply;
    Div, div, Divide;
}
