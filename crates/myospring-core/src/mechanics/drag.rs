//! Viscous drag: `f = -gamma m v` on each mass, the damping term of `coelho_2021`, Eq. (10).
//!
//! The rate `gamma` (1/ms) is the same for all masses, so every vibration decays with `gamma/2` and
//! a contraction lags its equilibrium by about `gamma/omega^2`. The slowest vibration of a free
//! cell, period `T`, has the damping ratio `gamma T / (4 pi)`: [`Drag::of_slowest_mode`] inverts
//! this relation. Integrators treat the drag implicitly ([`crate::integrate::verlet`]), so it does
//! not limit the time step.

use super::force::{Configuration, Force};
use super::stiffness::StiffnessMatrix;
use super::vectors::Vectors;
use std::f64::consts::PI;

/// Drag proportional to mass and velocity.
#[derive(Debug, Clone, PartialEq)]
pub struct Drag {
    /// Rate gamma, 1/ms.
    pub rate: f64,
    /// Masses, ug.
    pub masses: Vec<f64>,
}

impl Drag {
    /// The drag that gives a mode of this period (ms) this damping ratio.
    pub fn of_slowest_mode(period: f64, ratio: f64, masses: &[f64]) -> Self {
        Self { rate: 4.0 * PI * ratio / period, masses: masses.to_vec() }
    }
}

impl<const D: usize> Force<D> for Drag {
    fn name(&self) -> &'static str {
        "drag"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        for (force, velocity) in forces.iter_mut().zip(at.velocities) {
            for (node, mass) in self.masses.iter().enumerate() {
                force[node] -= self.rate * mass * velocity[node];
            }
        }
    }

    fn energy(&self, _at: &Configuration<'_, D>) -> Option<f64> {
        Some(0.0)
    }

    fn dissipation(&self, at: &Configuration<'_, D>) -> f64 {
        let square = |node: usize| at.velocities.iter().map(|v| v[node] * v[node]).sum::<f64>();
        self.masses.iter().enumerate().map(|(node, mass)| self.rate * mass * square(node)).sum()
    }

    /// Adds nothing: at zero velocity there is no force.
    fn add_stiffness(
        &self,
        _at: &Configuration<'_, D>,
        _stiffness: &mut StiffnessMatrix<D>,
    ) -> bool {
        true
    }

    fn is_internal(&self) -> bool {
        false
    }
}
