//! Evaluation of a tape over one number a row, or over lanes.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use super::compile::{Code, Instruction, Run, Tape};
use super::graph::{One, Two};
use super::values;
use crate::cell::number::inlined;

impl Tape {
    /// Computes its values from the inputs in the first rows.
    #[inline(always)]
    pub(super) fn evaluate<const N: usize>(&self, rows: &mut [[f64; N]]) {
        for Run { code, instructions } in &self.runs {
            match code {
                Code::One(one) => evaluate_one(*one, instructions, rows),
                Code::Two(two) => evaluate_two(*two, instructions, rows),
                Code::Select => {
                    for &Instruction { to, from: [a, b, c] } in instructions {
                        let [a, b, c] = [a, b, c].map(|row| rows[row as usize]);
                        rows[to as usize] =
                            std::array::from_fn(
                                |lane| {
                                    if a[lane] == 0.0 { c[lane] } else { b[lane] }
                                },
                            );
                    }
                }
            }
        }
    }
}

#[inline(always)]
fn each_one<const N: usize>(
    instructions: &[Instruction],
    rows: &mut [[f64; N]],
    of: impl Fn(f64) -> f64,
) {
    for &Instruction { to, from: [a, ..] } in instructions {
        let a = rows[a as usize];
        let mut value = [0.0; N];
        for lane in 0..N {
            value[lane] = of(a[lane]);
        }
        rows[to as usize] = value;
    }
}

#[inline(always)]
fn each_two<const N: usize>(
    instructions: &[Instruction],
    rows: &mut [[f64; N]],
    of: impl Fn(f64, f64) -> f64,
) {
    for &Instruction { to, from: [a, b, _] } in instructions {
        let (a, b) = (rows[a as usize], rows[b as usize]);
        let mut value = [0.0; N];
        for lane in 0..N {
            value[lane] = of(a[lane], b[lane]);
        }
        rows[to as usize] = value;
    }
}

/// A loop of its own for each operation named, and one for all others.
macro_rules! each {
    ($operation:expr, $kind:ident, [$($name:ident),*], $loop:ident) => {
        match $operation {
            $($kind::$name => $loop!($kind::$name),)*
            #[allow(unreachable_patterns, reason = "some lists are complete")]
            other => $loop!(other),
        }
    };
}

#[inline(always)]
fn evaluate_one<const N: usize>(one: One, instructions: &[Instruction], rows: &mut [[f64; N]]) {
    macro_rules! run {
        ($one:expr) => {
            each_one(
                instructions,
                rows,
                inlined(
                    #[inline(always)]
                    |x| values::one($one, x),
                ),
            )
        };
    }
    each!(one, One, [Negative, Absolute, Exponential, Logarithm, SquareRoot, Inverse, Not], run);
}

#[inline(always)]
fn evaluate_two<const N: usize>(two: Two, instructions: &[Instruction], rows: &mut [[f64; N]]) {
    macro_rules! run {
        ($two:expr) => {
            each_two(
                instructions,
                rows,
                inlined(
                    #[inline(always)]
                    |a, b| values::two($two, a, b),
                ),
            )
        };
    }
    each!(
        two,
        Two,
        [
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
            Or
        ],
        run
    );
}
