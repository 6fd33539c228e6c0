//! The value of each operation: one function for a single number and for every lane.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use crate::cell::exponential;

/// Added to a number below 2^51, leaves the nearest whole number.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// An operation on one number.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::cell) enum One {
    Negative,
    Absolute,
    Exponential,
    Logarithm,
    SquareRoot,
    Inverse,
    Not,
    Floor,
    Ceiling,
    Sine,
    Cosine,
    Tangent,
    ArcSine,
    ArcCosine,
    ArcTangent,
    HyperbolicSine,
    HyperbolicCosine,
    HyperbolicTangent,
    AreaSine,
    AreaCosine,
    AreaTangent,
}

/// An operation on two numbers. Conditions are 1 or 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(in crate::cell) enum Two {
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    Minimum,
    Maximum,
    Less,
    LessOrEqual,
    Equal,
    NotEqual,
    And,
    Or,
}

#[inline(always)]
pub(super) fn truth(condition: bool) -> f64 {
    if condition { 1.0 } else { 0.0 }
}

/// `e^x`; NaN stays NaN.
#[inline(always)]
pub(super) fn exponential(x: f64) -> f64 {
    let value = exponential::exp(x);
    if x.is_nan() { x } else { value }
}

/// `a^b`, also of a negative number where `b` is whole.
#[inline(always)]
#[allow(clippy::float_cmp, reason = "whether a number is whole")]
pub(super) fn power(a: f64, b: f64) -> f64 {
    let size = exponential(b * exponential::ln(a.abs()));
    let whole = (b + ROUNDER) - ROUNDER == b;
    let half = 0.5 * b;
    let odd = (half + ROUNDER) - ROUNDER != half;
    let negative = if whole { if odd { -size } else { size } } else { f64::NAN };
    let value = if a < 0.0 { negative } else { size };
    let value = if a.is_nan() { a } else { value };
    if b == 0.0 { 1.0 } else { value }
}

/// The value of an operation on one number.
#[inline(always)]
pub(super) fn one(one: One, x: f64) -> f64 {
    match one {
        One::Negative => -x,
        One::Absolute => x.abs(),
        One::Exponential => exponential(x),
        One::Logarithm => exponential::ln(x),
        One::SquareRoot => x.sqrt(),
        One::Inverse => 1.0 / x,
        One::Not => truth(x == 0.0),
        One::Floor => x.floor(),
        One::Ceiling => x.ceil(),
        One::Sine => x.sin(),
        One::Cosine => x.cos(),
        One::Tangent => x.tan(),
        One::ArcSine => x.asin(),
        One::ArcCosine => x.acos(),
        One::ArcTangent => x.atan(),
        One::HyperbolicSine => x.sinh(),
        One::HyperbolicCosine => x.cosh(),
        One::HyperbolicTangent => x.tanh(),
        One::AreaSine => x.asinh(),
        One::AreaCosine => x.acosh(),
        One::AreaTangent => x.atanh(),
    }
}

/// The value of an operation on two numbers.
#[inline(always)]
#[allow(clippy::float_cmp, reason = "the operation of a model's equations")]
#[allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]
pub(super) fn two(two: Two, a: f64, b: f64) -> f64 {
    match two {
        Two::Add => a + b,
        Two::Subtract => a - b,
        Two::Multiply => a * b,
        Two::Divide => a / b,
        Two::Power => power(a, b),
        Two::Minimum => {
            let smaller = if a < b { a } else { b };
            if b.is_nan() { a } else { smaller }
        }
        Two::Maximum => {
            let larger = if a > b { a } else { b };
            if b.is_nan() { a } else { larger }
        }
        Two::Less => truth(a < b),
        Two::LessOrEqual => truth(a <= b),
        Two::Equal => truth(a == b),
        Two::NotEqual => truth(a != b),
        Two::And => truth((a != 0.0) & (b != 0.0)),
        Two::Or => truth((a != 0.0) | (b != 0.0)),
    }
}
