//! Displacements with a stiffness near one whose factor is known.
//!
//! The method of conjugate gradients (`hestenes_1952`) with that factor as its preconditioner: the nearer both are, the fewer rounds. Where
//! a factor is costly, some rounds take less time than another one.

use super::factor::Factor;
use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::{Vectors, add_scaled, largest, product, zeros};

/// Most rounds with a rounded factor of the stiffness itself.
const MOST_ROUNDS: i32 = 60;

/// Rounds after which another factor is better, and by what part at least the rest falls in each, but for the first ones.
const ROUNDS: i32 = 15;
const FALL: f64 = 1.0 / 3.0;
const NEAR: f64 = 30.0;

/// How long displacements are improved.
#[derive(Clone, Copy)]
struct Patience {
    rounds: i32,
    near: f64,
}

impl Patience {
    const NEARBY: Self = Self { rounds: ROUNDS, near: NEAR };
    const OWN: Self = Self { rounds: MOST_ROUNDS, near: f64::INFINITY };
}

/// Displacements, um, and how well they agree with the forces.
pub(super) enum Nearby<const D: usize> {
    /// Up to the tolerance.
    Solved(Vectors<D>),
    /// The factor is too far from the stiffness; how far it came.
    Slow(Vectors<D>),
    /// The stiffness is not positive definite; the energy falls in this direction.
    Indefinite(Vectors<D>),
}

impl<const D: usize> Nearby<D> {
    pub(super) fn solved(self) -> Option<Vectors<D>> {
        match self {
            Self::Solved(moved) => Some(moved),
            Self::Slow(_) | Self::Indefinite(_) => None,
        }
    }
}

/// Displacements (um) under forces (nN) up to `tolerance`, a part of them; not that well if they are below `small`, um.
pub(super) fn solve<const D: usize>(
    factor: &Factor<D>,
    stiffness: &StiffnessMatrix<D>,
    forces: &Vectors<D>,
    tolerance: f64,
    small: f64,
) -> Nearby<D> {
    let enough = |first: f64| tolerance * tolerance * first;
    let start = (zeros(forces[0].len()), forces.clone());
    improve(factor, stiffness, start, enough, small, Patience::NEARBY)
}

/// Displacements (um) under forces (nN) by the factor of this stiffness, which is rounded, up to `tolerance`, a part of them.
pub(super) fn solve_by_rounded<const D: usize>(
    factor: &Factor<D>,
    stiffness: &StiffnessMatrix<D>,
    forces: &Vectors<D>,
    tolerance: f64,
) -> Vectors<D> {
    let enough = |first: f64| tolerance * tolerance * first;
    let start = (zeros(forces[0].len()), forces.clone());
    match improve(factor, stiffness, start, enough, 0.0, Patience::OWN) {
        Nearby::Solved(moved) | Nearby::Slow(moved) => moved,
        // A stiffness with a factor is positive definite, but for rounding.
        Nearby::Indefinite(_) => factor.solve(forces),
    }
}

/// As [`solve`], from displacements that are nearly right: they differ at the end by `tolerance`, a part of them.
pub(super) fn solve_from<const D: usize>(
    factor: &Factor<D>,
    stiffness: &StiffnessMatrix<D>,
    forces: &Vectors<D>,
    guess: &Vectors<D>,
    tolerance: f64,
) -> Nearby<D> {
    let mut left = forces.clone();
    add_scaled(&mut left, -1.0, &stiffness.times(guess));
    let whole = product(forces, guess).abs();
    let enough = |_| tolerance * tolerance * whole;
    improve(factor, stiffness, (guess.clone(), left), enough, 0.0, Patience::NEARBY)
}

/// Adds to displacements what the forces that are left move, until twice the energy of that is as small as `enough` says, given what it was.
fn improve<const D: usize>(
    factor: &Factor<D>,
    stiffness: &StiffnessMatrix<D>,
    (mut moved, mut left): (Vectors<D>, Vectors<D>),
    enough: impl Fn(f64) -> f64,
    small: f64,
    patience: Patience,
) -> Nearby<D> {
    factor.hold(&mut left);
    let mut next = factor.solve(&left);
    let mut direction = next.clone();
    let first = product(&left, &next);
    let mut size = first;
    let enough = enough(first);
    for round in 0..patience.rounds {
        // Both are squares in the norm of the factor.
        if !size.is_finite() {
            return Nearby::Slow(next);
        }
        if size <= enough {
            return Nearby::Solved(moved);
        }
        let near = patience.near * FALL.powi(round);
        if size > near * near * first {
            break;
        }
        let mut pulled = stiffness.times(&direction);
        factor.hold(&mut pulled);
        let bent = product(&direction, &pulled);
        if bent.is_nan() || bent <= 0.0 {
            return Nearby::Indefinite(if round == 0 { direction } else { moved });
        }
        let step = size / bent;
        add_scaled(&mut moved, step, &direction);
        if round == 0 && step * largest(&direction) <= small {
            return Nearby::Solved(moved);
        }
        add_scaled(&mut left, -step, &pulled);
        next = factor.solve(&left);
        let was = std::mem::replace(&mut size, product(&left, &next));
        for (axis, next) in direction.iter_mut().zip(&next) {
            for (value, next) in axis.iter_mut().zip(next) {
                *value = next + size / was * *value;
            }
        }
    }
    Nearby::Slow(moved)
}
