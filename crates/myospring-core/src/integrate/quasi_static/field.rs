//! Single equilibria under tensions that are not uniform.

use super::equilibrium::{Kept, Solver};
use super::{PathError, Tolerance, check_forces, ending, extent};
use crate::interruption::Interruption;
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
    pub(super) solver: Solver<'a, D>,
    tolerance: f64,
    /// Iterations of Newton's method so far.
    pub newton_iterations: usize,
}

impl<'a, const D: usize> Equilibrium<'a, D> {
    /// A solver for a body under a system of forces; its positions define mass centre and
    /// orientation.
    ///
    /// # Errors
    /// Unsupported forces, see [`PathError`].
    pub fn new(
        system: &'a System<D>,
        body: &'a Body<D>,
        tolerance: Tolerance,
    ) -> Result<Self, PathError> {
        Self::new_interruptible(system, body, tolerance, &Interruption::default())
    }

    /// Like [`Equilibrium::new`], with searches that can be interrupted.
    ///
    /// # Errors
    /// As [`Equilibrium::new`].
    pub fn new_interruptible(
        system: &'a System<D>,
        body: &'a Body<D>,
        tolerance: Tolerance,
        interruption: &Interruption,
    ) -> Result<Self, PathError> {
        let kept = Kept::new(system, body, check_forces(system, body, interruption)?);
        let solver = Solver::continued(system, body, Some(kept), interruption);
        let tolerance = tolerance.equilibrium * extent(body);
        Ok(Self { solver, tolerance, newton_iterations: 0 })
    }

    /// Positions at rest near a guess, um. That they are stable is shown at least at each tenth, by a factor of the stiffness; at the others by
    /// corrections that fall.
    ///
    /// # Errors
    /// [`PathError::Unstable`], [`PathError::Lost`] or [`PathError::TooLarge`] if there is none near it;
    /// [`PathError::Interrupted`].
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

    /// Prepares [`Equilibrium::response`] for the body at these positions under this tension.
    ///
    /// # Errors
    /// [`PathError::Unstable`] or [`PathError::TooLarge`] if the stiffness is not positive
    /// definite, or does not fit into memory.
    pub fn linearise(
        &mut self,
        positions: &Vectors<D>,
        tension: Tension<'_>,
    ) -> Result<(), PathError> {
        self.solver
            .factorise(positions, tension)
            .map_err(|failure| ending(failure, self.solver.body(), [tension.highest(); 2], None))
    }

    /// Displacement of each node under small forces (nN), um, for the linearised body. The forces
    /// on a free body must have no resultant; two of its nodes stay in place.
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::{Equilibrium, Tolerance};
    /// use myospring::mechanics::active::ActiveLaw;
    /// use myospring::mechanics::material::{assemble, default_material};
    /// use myospring::mechanics::support::SupportKind;
    /// use myospring::mechanics::zeros;
    /// use myospring::mesh::lattice;
    ///
    /// let strip = lattice::rectangle(20, 4, 5.0)?;
    /// let fibres = vec![[1.0, 0.0]; strip.simplices.len()];
    /// let (support, axis) = (SupportKind::MassCentre, [1.0, 0.0]);
    /// let (body, system) = assemble(&strip, &default_material(), ActiveLaw::Fibre, &fibres, support, axis, 100.0);
    /// let mut equilibrium = Equilibrium::new(&system, &body, Tolerance::default())?;
    /// equilibrium.linearise(&body.positions, 0.0.into())?;
    /// // One kPa along the fibres.
    /// let mut forces = zeros(strip.len());
    /// system.active[0].add_forces(&body.configuration(1.0), &mut forces);
    /// let [x, _] = equilibrium.response(&forces);
    /// // A hundredth of it moves the body a hundredth as far.
    /// let moved = equilibrium.find(&body.positions, 0.01.into())?;
    /// let way = moved[0][20] - moved[0][0] - 100.0;
    /// assert!(way < 0.0 && (100.0 * way / (x[20] - x[0]) - 1.0).abs() < 1e-3);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn response(&mut self, forces: &Vectors<D>) -> Vectors<D> {
        self.solver.response(forces)
    }

    /// Number of factorised matrices so far.
    pub fn factorisations(&self) -> usize {
        self.solver.factorisations
    }
}
