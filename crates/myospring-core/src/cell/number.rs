//! Number types for equations that are written once: plain numbers, and numbers with derivatives.
//!
//! A model that is generic over [`Number`] gives its rates (`f64`) and its Jacobian ([`Dual`]:
//! forward differentiation, exact to rounding).
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]
#![allow(clippy::suspicious_arithmetic_impl, reason = "rules of differentiation")]

use super::exponential;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number.
pub trait Number:
    Copy
    + Neg<Output = Self>
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Add<f64, Output = Self>
    + Sub<f64, Output = Self>
    + Mul<f64, Output = Self>
    + Div<f64, Output = Self>
{
    /// The type of constants.
    type Constant: Number;
    /// Converts a constant to a number.
    fn constant(value: Self::Constant) -> Self;
    /// Converts a plain number.
    fn of(value: f64) -> Self;
    /// `e^x`; `x` is held between -708 and 709.
    fn exp(self) -> Self;
    /// Natural logarithm.
    fn ln(self) -> Self;
    /// Square root.
    fn sqrt(self) -> Self;
    /// `1/x`.
    fn inverse(self) -> Self;
    /// `|x|`; its derivative at 0 is 0, the mean of both sides.
    fn magnitude(self) -> Self;
    /// `then` if this number is at least the bound, else `otherwise`.
    fn at_least(self, bound: f64, then: Self, otherwise: Self) -> Self;

    /// `x^2`.
    #[inline(always)]
    fn square(self) -> Self {
        self * self
    }
    /// `x` if it is positive, else 0.
    #[inline(always)]
    fn positive(self) -> Self {
        (self + self.magnitude()) * 0.5
    }
    /// `x^3`.
    #[inline(always)]
    fn cube(self) -> Self {
        self * self * self
    }
    /// `x^p` of a positive number.
    #[inline(always)]
    fn power(self, exponent: f64) -> Self {
        (self.ln() * exponent).exp()
    }
    /// `1 - x`.
    #[inline(always)]
    fn rest(self) -> Self {
        -self + 1.0
    }
    /// `1 / (1 + exp((x - half) / slope))`: decreases from 1 to 0 if the slope is positive.
    #[inline(always)]
    fn boltzmann(self, half: f64, slope: f64) -> Self {
        (((self - half) * (1.0 / slope)).exp() + 1.0).inverse()
    }
}

/// Returns a closure unchanged; the attribute on its argument inlines it, as vectorised loops need.
#[inline(always)]
pub(super) fn inlined<F>(closure: F) -> F {
    closure
}

impl Number for f64 {
    type Constant = Self;
    #[inline(always)]
    fn constant(value: Self) -> Self {
        value
    }
    #[inline(always)]
    fn of(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn exp(self) -> Self {
        exponential::exp(self)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        exponential::ln(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }
    #[inline(always)]
    fn inverse(self) -> Self {
        1.0 / self
    }
    #[inline(always)]
    fn magnitude(self) -> Self {
        self.abs()
    }
    #[inline(always)]
    fn at_least(self, bound: f64, then: Self, otherwise: Self) -> Self {
        if self >= bound { then } else { otherwise }
    }
}

/// A number with its derivatives in some directions.
#[derive(Debug, Clone, Copy)]
pub(super) struct Dual<B, const K: usize> {
    pub(super) value: B,
    pub(super) slopes: [B; K],
}

impl<B: Number, const K: usize> Dual<B, K> {
    /// The independent variable of one direction.
    #[inline(always)]
    pub(super) fn variable(value: B, direction: usize) -> Self {
        let slope = |k| B::of(if k == direction { 1.0 } else { 0.0 });
        Self { value, slopes: std::array::from_fn(slope) }
    }
    /// Applies a function with this value and derivative (chain rule).
    #[inline(always)]
    fn through(self, value: B, slope: B) -> Self {
        Self { value, slopes: std::array::from_fn(|k| self.slopes[k] * slope) }
    }
}

impl<B: Number, const K: usize> Number for Dual<B, K> {
    type Constant = B;
    #[inline(always)]
    fn constant(value: B) -> Self {
        Self { value, slopes: [B::of(0.0); K] }
    }
    #[inline(always)]
    fn of(value: f64) -> Self {
        Self::constant(B::of(value))
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let value = self.value.exp();
        self.through(value, value)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.through(self.value.ln(), self.value.inverse())
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let value = self.value.sqrt();
        self.through(value, value.inverse() * 0.5)
    }
    #[inline(always)]
    fn inverse(self) -> Self {
        let value = self.value.inverse();
        self.through(value, -(value * value))
    }
    #[inline(always)]
    fn magnitude(self) -> Self {
        let (plus, minus) = (B::of(1.0), B::of(-1.0));
        let twice =
            self.value.at_least(0.0, plus, minus) + (-self.value).at_least(0.0, minus, plus);
        self.through(self.value.magnitude(), twice * 0.5)
    }
    #[inline(always)]
    fn at_least(self, bound: f64, then: Self, otherwise: Self) -> Self {
        let choose = |a: B, b: B| self.value.at_least(bound, a, b);
        Self {
            value: choose(then.value, otherwise.value),
            slopes: std::array::from_fn(|k| choose(then.slopes[k], otherwise.slopes[k])),
        }
    }
}

impl<B: Number, const K: usize> Neg for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self { value: -self.value, slopes: std::array::from_fn(|k| -self.slopes[k]) }
    }
}

impl<B: Number, const K: usize> Add for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|k| self.slopes[k] + other.slopes[k]);
        Self { value: self.value + other.value, slopes }
    }
}

impl<B: Number, const K: usize> Sub for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        let slopes = std::array::from_fn(|k| self.slopes[k] - other.slopes[k]);
        Self { value: self.value - other.value, slopes }
    }
}

impl<B: Number, const K: usize> Mul for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (a, b) = (self.value, other.value);
        let slopes = std::array::from_fn(|k| self.slopes[k] * b + other.slopes[k] * a);
        Self { value: a * b, slopes }
    }
}

impl<B: Number, const K: usize> Div for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        // (a / b)' = (a' - (a / b) b') / b
        let inverse = other.value.inverse();
        let value = self.value * inverse;
        let slopes = std::array::from_fn(|k| (self.slopes[k] - value * other.slopes[k]) * inverse);
        Self { value, slopes }
    }
}

impl<B: Number, const K: usize> Add<f64> for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: f64) -> Self {
        Self { value: self.value + other, ..self }
    }
}

impl<B: Number, const K: usize> Sub<f64> for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: f64) -> Self {
        Self { value: self.value - other, ..self }
    }
}

impl<B: Number, const K: usize> Mul<f64> for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: f64) -> Self {
        Self { value: self.value * other, slopes: std::array::from_fn(|k| self.slopes[k] * other) }
    }
}

impl<B: Number, const K: usize> Div<f64> for Dual<B, K> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: f64) -> Self {
        self * (1.0 / other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Something of everything.
    fn function<T: Number>(x: T, y: T) -> T {
        let first = (x * y - 0.3).exp() / (y.sqrt() + 2.0) + (x + 3.0).ln() * 0.5;
        let second = (x - y).at_least(0.0, x.square() - y, y.cube() * 2.0 - x);
        first + (x - y).magnitude() * y.positive() + second.boltzmann(0.2, -1.7) * y.power(1.4)
            - (-x + 4.0).inverse() / 3.0
    }

    #[test]
    fn derivatives_are_those_of_differences() {
        for [x, y] in [[0.7, 0.4], [0.2, 1.3], [-1.1, 2.0]] {
            let dual = function(Dual::<f64, 2>::variable(x, 0), Dual::variable(y, 1));
            let h = 1e-5;
            let by = [
                (function(x + h, y) - function(x - h, y)) / (2.0 * h),
                (function(x, y + h) - function(x, y - h)) / (2.0 * h),
            ];
            for (slope, by) in dual.slopes.iter().zip(by) {
                // The third derivative times h^2, and rounding over h.
                assert!((slope - by).abs() < 1e-8 * (1.0 + by.abs()), "{slope} {by}");
            }
            // The quotient is another operation than the product with the inverse.
            assert!((dual.value - function(x, y)).abs() < 1e-14);
        }
    }
}
