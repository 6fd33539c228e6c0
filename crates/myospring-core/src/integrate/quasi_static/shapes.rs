//! Shapes as functions of the tension: the result of a path.

use super::tolerance::Tolerance;
use crate::mechanics::{Vectors, add_scaled, zeros};
use std::array::from_fn;

/// The end of one load step.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Knot<const D: usize = 2> {
    /// Tension, kPa.
    pub(super) tension: f64,
    /// Positions, um.
    pub(super) positions: Vectors<D>,
    /// Derivative of the positions with respect to tension, um/kPa.
    pub(super) slope: Vectors<D>,
}

/// Equilibria of one body at every tension between two ends, without the body: what [`super::Path`] finds.
#[derive(Debug, Clone, PartialEq)]
pub struct Shapes<const D: usize = 2> {
    pub(super) tolerance: Tolerance,
    /// The body's largest extent, um.
    pub(super) extent: f64,
    /// From tension 0 downward, and upward; both begin with the body at rest.
    pub(super) branches: [Vec<Knot<D>>; 2],
    /// Length of the next load step on each branch, kPa; 0 if none was made.
    pub(super) steps: [f64; 2],
    pub(super) error: f64,
    pub(super) delay: f64,
    pub(super) newton_iterations: usize,
    pub(super) factorisations: usize,
    /// Branches of which each load step is shown to be stable by its own factor, since several at once were not.
    pub(super) one_by_one: [bool; 2],
}

impl<const D: usize> Shapes<D> {
    /// The lowest and the highest tension of the path, kPa.
    pub fn range(&self) -> [f64; 2] {
        [0, 1].map(|side| self.branches[side][self.branches[side].len() - 1].tension)
    }

    /// The tolerance with which it was solved.
    pub fn tolerance(&self) -> Tolerance {
        self.tolerance
    }

    /// Whether it includes a tension in kPa.
    pub fn reaches(&self, tension: f64) -> bool {
        let [lowest, highest] = self.range();
        (lowest..=highest).contains(&tension)
    }

    /// Tensions at which the equilibrium was solved, kPa, in ascending order.
    ///
    /// Between two of them each coordinate is a cubic polynomial of the tension.
    pub fn tensions(&self) -> Vec<f64> {
        let [down, up] = &self.branches;
        down.iter().rev().chain(&up[1..]).map(|knot| knot.tension).collect()
    }

    /// Positions under a tension in kPa, um; `None` outside [`Shapes::range`].
    pub fn positions(&self, tension: f64) -> Option<Vectors<D>> {
        if !self.reaches(tension) {
            return None;
        }
        let branch = &self.branches[usize::from(tension > 0.0)];
        let after = branch.partition_point(|knot| knot.tension.abs() < tension.abs());
        if branch[after].tension == tension {
            return Some(branch[after].positions.clone());
        }
        let mut positions = zeros(branch[0].positions[0].len());
        interpolate(&branch[after - 1], &branch[after], tension, &mut positions);
        Some(positions)
    }

    /// What depends linearly on the displacements from rest, as a function of the tension: `of` gives it for displacements,
    /// and [`Shapes::positions`] of the result at a tension.
    pub(crate) fn linear(
        &self,
        rest: &Vectors<D>,
        of: impl Fn(&Vectors<D>) -> Vectors<D>,
    ) -> Shapes<D> {
        let knot = |knot: &Knot<D>| {
            let mut moved = knot.positions.clone();
            add_scaled(&mut moved, -1.0, rest);
            Knot { tension: knot.tension, positions: of(&moved), slope: of(&knot.slope) }
        };
        let branches = self.branches.each_ref().map(|branch| branch.iter().map(knot).collect());
        Self { branches, ..self.clone() }
    }

    /// The largest estimated error of an interpolated position, um.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// Time by which drag and dashpots would delay the shape in a motion, ms: the lag of a run in
    /// time behind the path.
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// Number of load steps.
    pub fn load_steps(&self) -> usize {
        self.branches.iter().map(|branch| branch.len() - 1).sum()
    }

    /// Iterations of Newton's method in all accepted and rejected steps that converged.
    pub fn newton_iterations(&self) -> usize {
        self.newton_iterations
    }

    /// Number of factorised matrices, including those of steps that did not converge: one for each iteration, or where they are
    /// costly (thick cells) one for some load steps.
    pub fn factorisations(&self) -> usize {
        self.factorisations
    }
}

/// Hermite's cubic through two knots with their slopes, also outside their range.
pub(super) fn interpolate<const D: usize>(
    from: &Knot<D>,
    to: &Knot<D>,
    tension: f64,
    positions: &mut Vectors<D>,
) {
    let width = to.tension - from.tension;
    let s = (tension - from.tension) / width;
    let end = s * s * (3.0 - 2.0 * s);
    let (leave, arrive) = (width * s * (1.0 - s).powi(2), width * s * s * (s - 1.0));
    for axis in 0..D {
        let (x0, x1) = (&from.positions[axis], &to.positions[axis]);
        let (d0, d1) = (&from.slope[axis], &to.slope[axis]);
        for (node, position) in positions[axis].iter_mut().enumerate() {
            // In this order, a held node keeps its position exactly.
            let moved = end * (x1[node] - x0[node]) + leave * d0[node] + arrive * d1[node];
            *position = x0[node] + moved;
        }
    }
}

/// The knot that this cubic has at a tension.
pub(super) fn between<const D: usize>(from: &Knot<D>, to: &Knot<D>, tension: f64) -> Knot<D> {
    let mut positions = zeros(from.positions[0].len());
    interpolate(from, to, tension, &mut positions);
    let width = to.tension - from.tension;
    let s = (tension - from.tension) / width;
    let [end, leave, arrive] =
        [6.0 * s * (1.0 - s) / width, (1.0 - s) * (1.0 - 3.0 * s), s * (3.0 * s - 2.0)];
    let slope = from_fn(|axis| {
        let ends = from.positions[axis].iter().zip(&to.positions[axis]);
        let slopes = from.slope[axis].iter().zip(&to.slope[axis]);
        ends.zip(slopes)
            .map(|((x0, x1), (d0, d1))| end * (x1 - x0) + leave * d0 + arrive * d1)
            .collect()
    });
    Knot { tension, positions, slope }
}
