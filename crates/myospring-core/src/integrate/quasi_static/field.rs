//! Equilibria under tensions that differ from place to place, one at a time.

use super::equilibrium::Solver;
use super::{PathError, Tolerance, check_forces, ending, extent};
use crate::mechanics::{Body, System, Tension, Vectors};

/// Finds the equilibrium of a body under any tension from a guess near it.
///
/// # Example
/// ```
/// use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
/// use myospring::mechanics::active::ActiveLaw;
/// use myospring::mechanics::material::{assemble, default_material};
/// use myospring::mechanics::Tension;
/// use myospring::mechanics::support::SupportKind;
/// use myospring::mesh::lattice;
///
/// let strip = lattice::rectangle(20, 4, 5.0)?;
/// let fibres = vec![[1.0, 0.0]; strip.simplices.len()];
/// let (body, system) = assemble(
///     &strip, &default_material(), ActiveLaw::Fibre, &fibres, SupportKind::MassCentre, [1.0, 0.0], 100.0,
/// );
/// let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default())?;
/// // 30 kPa in the triangles that stand left of the middle, none in the others.
/// let left = |nodes: [u32; 3]| nodes.iter().all(|&node| strip.points[0][node as usize] <= 50.0);
/// let tensions: Vec<f64> =
///     strip.simplices.iter().map(|triangle| if left(triangle.nodes) { 30.0 } else { 0.0 }).collect();
/// let [x, _] = equilibrium.find(&body.positions, Tension::PerElement(&tensions))?;
/// assert!(x[10] - x[0] < 47.0 && (x[20] - x[10] - 50.0).abs() < 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Equilibrium<'a, const D: usize = 2> {
    solver: Solver<'a, D>,
    tolerance: f64,
    /// Iterations of Newton's method so far.
    pub newton_iterations: usize,
}

impl<'a, const D: usize> Equilibrium<'a, D> {
    /// For a body under a system of forces; its positions are where mass centre and orientation stay.
    ///
    /// # Errors
    /// Forces that have no equilibria of their own.
    pub fn new(
        system: &'a System<D>,
        body: &'a Body<D>,
        tolerance: Tolerance,
    ) -> Result<Self, PathError> {
        check_forces(system, body)?;
        let solver = Solver::new(system, body);
        let tolerance = tolerance.equilibrium * extent(body);
        Ok(Self { solver, tolerance, newton_iterations: 0 })
    }

    /// Positions at rest near a guess, um.
    ///
    /// # Errors
    /// [`PathError::Unstable`], [`PathError::Lost`] or [`PathError::TooLarge`] if there is none near it.
    pub fn find(
        &mut self,
        guess: &Vectors<D>,
        tension: Tension<'_>,
    ) -> Result<Vectors<D>, PathError> {
        match self.solver.settle_in_place(guess, tension, self.tolerance) {
            Ok((positions, corrections)) => {
                self.newton_iterations += corrections.len();
                Ok(positions)
            }
            Err(failure) => {
                let highest = tension.highest();
                Err(ending(failure, self.solver.body(), [highest; 2], None))
            }
        }
    }

    /// Matrices factorised so far.
    pub fn factorisations(&self) -> usize {
        self.solver.factorisations
    }
}
