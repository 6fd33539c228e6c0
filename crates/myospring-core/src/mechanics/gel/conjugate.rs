//! Conjugate gradients.

use crate::mechanics::vectors::{Vectors, add_scaled, product, zeros};

/// Solves `A x = b` from 0 with a symmetric positive definite `A`, which `times` multiplies by, until the residual is
/// `enough` of `b` or after `rounds`; `improved` multiplies by the preconditioner.
pub(super) fn solve<const D: usize>(
    right: &Vectors<D>,
    times: impl Fn(&Vectors<D>) -> Vectors<D>,
    improved: impl Fn(&Vectors<D>) -> Vectors<D>,
    enough: f64,
    rounds: usize,
) -> Vectors<D> {
    let mut solution = zeros(right[0].len());
    let mut rest = right.clone();
    let enough = enough * product(right, right).sqrt();
    let mut direction = improved(&rest);
    let mut drop = product(&rest, &direction);
    for _ in 0..rounds {
        if product(&rest, &rest).sqrt() <= enough {
            break;
        }
        let image = times(&direction);
        let step = drop / product(&direction, &image);
        add_scaled(&mut solution, step, &direction);
        add_scaled(&mut rest, -step, &image);
        let better = improved(&rest);
        let before = std::mem::replace(&mut drop, product(&rest, &better));
        for (direction, better) in direction.iter_mut().flatten().zip(better.iter().flatten()) {
            *direction = better + drop / before * *direction;
        }
    }
    solution
}
