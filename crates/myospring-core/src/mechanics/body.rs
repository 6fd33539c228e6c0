//! Moving point masses.

use super::force::Configuration;
use super::tension::Tension;
use super::vectors::{Vectors, sum, zeros};
use crate::mesh::Mesh;

/// Moving point masses.
#[derive(Debug, Clone, PartialEq)]
pub struct Body<const D: usize = 2> {
    /// Positions, um.
    pub positions: Vectors<D>,
    /// Velocities, um/ms.
    pub velocities: Vectors<D>,
    /// Masses, ug.
    pub masses: Vec<f64>,
}

impl<const D: usize> Body<D> {
    /// A body at rest in the mesh's points; each mass is `density * thickness * area`. With three
    /// axes, areas are volumes and the thickness is 1 (dimensionless).
    pub fn at_rest<const N: usize>(mesh: &Mesh<D, N>, density: f64, thickness: f64) -> Self {
        Self {
            positions: mesh.points.clone(),
            velocities: zeros(mesh.areas.len()),
            masses: mesh.areas.iter().map(|area| density * thickness * area).collect(),
        }
    }

    /// Number of masses.
    pub fn len(&self) -> usize {
        self.masses.len()
    }

    /// Whether there are no masses.
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty()
    }

    /// Kinetic energy, fJ: sum of m v^2 / 2.
    pub fn kinetic_energy(&self) -> f64 {
        let square = |node: usize| self.velocities.iter().map(|v| v[node] * v[node]).sum::<f64>();
        sum(self.len(), |node| 0.5 * self.masses[node] * square(node))
    }

    /// Mass centre, um: sum of m x over sum of m.
    pub fn mass_centre(&self) -> [f64; D] {
        let total = sum(self.len(), |node| self.masses[node]);
        std::array::from_fn(|axis| {
            let at = &self.positions[axis];
            sum(self.len(), |node| self.masses[node] * at[node]) / total
        })
    }

    /// Linear momentum, ug um/ms: sum of m v.
    pub fn momentum(&self) -> [f64; D] {
        std::array::from_fn(|axis| {
            let velocity = &self.velocities[axis];
            sum(self.len(), |node| self.masses[node] * velocity[node])
        })
    }

    /// Angular momentum about the origin in the plane of two axes, ug um^2/ms: sum of m (`x v_y` - `y v_x`).
    pub fn angular_momentum_in(&self, plane: [usize; 2]) -> f64 {
        let ([x, y], [vx, vy]) =
            (plane.map(|axis| &self.positions[axis]), plane.map(|axis| &self.velocities[axis]));
        sum(self.len(), |i| self.masses[i] * (x[i] * vy[i] - y[i] * vx[i]))
    }

    /// The configuration at which forces are evaluated, under an active tension (a number is a
    /// uniform one in kPa).
    pub fn configuration<'a>(&'a self, tension: impl Into<Tension<'a>>) -> Configuration<'a, D> {
        Configuration {
            positions: &self.positions,
            velocities: &self.velocities,
            tension: tension.into(),
        }
    }
}

impl Body {
    /// Angular momentum of a flat body about the origin, ug um^2/ms: sum of m (`x v_y` - `y v_x`).
    pub fn angular_momentum(&self) -> f64 {
        self.angular_momentum_in([0, 1])
    }
}
