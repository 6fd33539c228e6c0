//! Displacements with a stiffness near one whose factor is known.
//!
//! The method of conjugate gradients (`hestenes_1952`) with that factor as its preconditioner: the nearer both are, the fewer rounds. Where
//! a factor is costly, some rounds take less time than another one.

use super::factor::Factor;
use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::{Vectors, add_scaled, product, zeros};

/// Rounds after which another factor is better, and by what part at least the rest falls in each, but for the first ones.
const ROUNDS: i32 = 12;
const FALL: f64 = 1.0 / 3.0;
const NEAR: f64 = 4.0;

/// Displacements (um) under forces (nN) up to `tolerance`, a part of them; `None` if the factor is too far from the stiffness, or that is
/// not positive definite in a direction that was met.
pub(super) fn solve<const D: usize>(
    factor: &mut Factor<'_, D>,
    stiffness: &StiffnessMatrix<D>,
    forces: &Vectors<D>,
    tolerance: f64,
) -> Option<Vectors<D>> {
    let mut moved = zeros::<D>(forces[0].len());
    let mut left = forces.clone();
    factor.hold(&mut left);
    let mut next = factor.solve(&left);
    let mut direction = next.clone();
    let first = product(&left, &next);
    let mut size = first;
    for round in 0..ROUNDS {
        // Both are squares in the norm of the factor.
        if size <= tolerance * tolerance * first {
            return Some(moved);
        }
        let near = NEAR * FALL.powi(round);
        if size.is_nan() || size > near * near * first {
            return None;
        }
        let mut pulled = stiffness.times(&direction);
        factor.hold(&mut pulled);
        let bent = product(&direction, &pulled);
        if bent.is_nan() || bent <= 0.0 {
            return None;
        }
        let step = size / bent;
        add_scaled(&mut moved, step, &direction);
        add_scaled(&mut left, -step, &pulled);
        next = factor.solve(&left);
        let was = std::mem::replace(&mut size, product(&left, &next));
        for (axis, next) in direction.iter_mut().zip(&next) {
            for (value, next) in axis.iter_mut().zip(next) {
                *value = next + size / was * *value;
            }
        }
    }
    None
}
