//! The ways in which a lattice can be moved; every check of motions runs over all of them.

use crate::check::Failure;
use myospring::integrate::fused::FusedMotion;
use myospring::integrate::stencil::Units;
use myospring::integrate::stepper::Stepper;
use myospring::integrate::verlet::{Integrator, Motion};
use myospring::mechanics::{Body, System};
use myospring::mesh::Mesh;

/// What makes the steps.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Engine {
    /// The sum of the forces, one law after the other.
    Plain(Integrator),
    /// The fused kernel of lattices, on so many threads.
    Fused(usize),
}

impl Engine {
    /// All of them.
    pub const ALL: [Self; 4] = [
        Self::Plain(Integrator::StoermerVerlet),
        Self::Plain(Integrator::VelocityVerlet),
        Self::Fused(1),
        Self::Fused(2),
    ];

    /// Its name in the table.
    pub fn name(self) -> String {
        match self {
            Self::Plain(Integrator::StoermerVerlet) => "Stoermer-Verlet, plain loops".to_owned(),
            Self::Plain(Integrator::VelocityVerlet) => "velocity Verlet, plain loops".to_owned(),
            Self::Fused(1) => "fused kernel, 1 thread".to_owned(),
            Self::Fused(threads) => format!("fused kernel, at most {threads} threads"),
        }
    }

    /// A body about to move.
    ///
    /// # Errors
    /// The fused kernel does not take this mesh or these forces.
    pub fn motion<'a, const D: usize, const N: usize>(
        self,
        mesh: &Mesh<D, N>,
        system: &'a System<D>,
        body: Body<D>,
        step: f64,
    ) -> Result<Box<dyn Stepper<D> + 'a>, Failure> {
        Ok(match self {
            Self::Plain(integrator) => Box::new(Motion::new(system, body, integrator, step)),
            Self::Fused(threads) => {
                let lattice = mesh.lattice.as_ref().ok_or("the mesh is no lattice")?;
                Box::new(FusedMotion::new(system, body, lattice, step, threads, Units::best())?)
            }
        })
    }
}
