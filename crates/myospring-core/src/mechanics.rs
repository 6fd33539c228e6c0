//! Mechanics: point masses and the forces between them.
//!
//! A [`Force`] adds its vectors to a sum; one law stands in one file. Units: um, ms, ug, nN, kPa,
//! fJ. Sign convention: the vector added to a node is the force that acts **on** that node.
//!
//! | file | law | source |
//! |---|---|---|
//! | [`spring`] | Hooke springs and axial dashpots | `coelho_2021`, Eqs (7)-(9), (11) |
//! | [`area`] | area preservation | `coelho_2021`, Eqs (12)-(13), and an energy |
//! | [`active`] | active tension along the fibre or at the ends | `coelho_2021`, section 3 |
//! | [`drag`] | viscous drag | `coelho_2021`, Eq. (10) |
//! | [`support`] | what holds the cell | `coelho_2021`, section 2.1 |
//! | [`anchor`] | supports that give way: elastic bed, spring-held ends | `edwards_schwarz_2011` |
//! | [`stability`] | the largest stable time step | |
//! | [`stiffness`] | the tangent stiffness, for equilibria | |
//! | [`stencil`] | all forces of a lattice and their steps at once, fast | |

pub mod active;
pub mod anchor;
pub mod area;
pub mod drag;
pub mod material;
mod runs;
pub mod spring;
pub mod stability;
pub mod stencil;
pub mod stiffness;
pub mod support;

use crate::mesh::Mesh;
use stencil::LatticeTerms;
use stiffness::StiffnessMatrix;

/// One vector per node, by axis: `vectors[axis][node]`.
pub type Vectors = [Vec<f64>; 2];

/// Vectors of length zero for `count` nodes.
pub fn zeros(count: usize) -> Vectors {
    [vec![0.0; count], vec![0.0; count]]
}

/// Moving point masses.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Positions, um.
    pub positions: Vectors,
    /// Velocities, um/ms.
    pub velocities: Vectors,
    /// Masses, ug.
    pub masses: Vec<f64>,
}

impl Body {
    /// A body at rest in the mesh's points; each mass is `density * thickness * area`.
    pub fn at_rest(mesh: &Mesh, density: f64, thickness: f64) -> Self {
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

    /// Whether there is no mass.
    pub fn is_empty(&self) -> bool {
        self.masses.is_empty()
    }

    /// Kinetic energy, fJ: sum of m v^2 / 2.
    pub fn kinetic_energy(&self) -> f64 {
        let square = |node: usize| self.velocities.iter().map(|v| v[node] * v[node]).sum::<f64>();
        self.masses.iter().enumerate().map(|(node, mass)| 0.5 * mass * square(node)).sum()
    }

    /// Mass centre, um: sum of m x over sum of m.
    pub fn mass_centre(&self) -> [f64; 2] {
        let total: f64 = self.masses.iter().sum();
        [0, 1].map(|axis| dot(&self.masses, &self.positions[axis]) / total)
    }

    /// Linear momentum, ug um/ms: sum of m v.
    pub fn momentum(&self) -> [f64; 2] {
        [0, 1].map(|axis| dot(&self.masses, &self.velocities[axis]))
    }

    /// Angular momentum about the origin, ug um^2/ms: sum of m (`x v_y` - `y v_x`).
    pub fn angular_momentum(&self) -> f64 {
        let ([x, y], [vx, vy]) = (&self.positions, &self.velocities);
        (0..self.len()).map(|i| self.masses[i] * (x[i] * vy[i] - y[i] * vx[i])).sum()
    }

    /// What forces are evaluated at, under an active tension in kPa.
    pub fn configuration(&self, tension: f64) -> Configuration<'_> {
        Configuration { positions: &self.positions, velocities: &self.velocities, tension }
    }
}

/// What a force depends on.
#[derive(Debug, Clone, Copy)]
pub struct Configuration<'a> {
    /// Positions, um.
    pub positions: &'a Vectors,
    /// Velocities, um/ms.
    pub velocities: &'a Vectors,
    /// Active tension, kPa.
    pub tension: f64,
}

/// A law that puts forces on nodes.
pub trait Force: Send + Sync {
    /// Its name in messages and records.
    fn name(&self) -> &'static str;

    /// Adds to `forces` the force on each node, nN.
    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors);

    /// Potential energy, fJ, of which the force at zero velocity and fixed tension is minus the
    /// gradient; `None` if there is no such energy.
    fn energy(&self, at: &Configuration<'_>) -> Option<f64>;

    /// Rate at which velocity-dependent parts take energy, fJ/ms; never negative.
    fn dissipation(&self, _at: &Configuration<'_>) -> f64 {
        0.0
    }

    /// Adds the tangent stiffness, nN/um: minus the derivative of the force at zero velocity and
    /// fixed tension, which is the second derivative of the energy.
    ///
    /// Optional: returns whether the force has one, and adds nothing if not. Equilibria are solved
    /// with it (`integrate::quasi_static`); motion in time does without.
    fn add_stiffness(&self, _at: &Configuration<'_>, _stiffness: &mut StiffnessMatrix) -> bool {
        false
    }

    /// Adds the law's coefficients to those of a lattice, for the fused kernel ([`stencil`]).
    ///
    /// Optional: returns whether the law has its place there; if not, plain loops do the work and
    /// what was added is not used.
    fn add_to_lattice(&self, _terms: &mut LatticeTerms) -> bool {
        false
    }

    /// Whether the forces come in equal and opposite pairs along the line between nodes or in
    /// other sets without resultant force and torque, so that both momenta are conserved.
    fn is_internal(&self) -> bool;
}

/// All forces on a body, what holds it and what slows it.
pub struct System {
    /// Forces that store or take energy: springs, area law, elastic supports.
    pub passive: Vec<Box<dyn Force>>,
    /// Forces that the active tension drives.
    pub active: Vec<Box<dyn Force>>,
    /// Drag; integrators treat it on its own, implicitly.
    pub drag: drag::Drag,
    /// What holds the body.
    pub support: support::Support,
}

impl System {
    /// Overwrites `forces` with the sum of all but the drag, before the support acts.
    pub fn sum_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        for axis in forces.iter_mut() {
            axis.fill(0.0);
        }
        for force in self.passive.iter().chain(&self.active) {
            force.add_forces(at, forces);
        }
    }

    /// Takes from the forces what the support bears.
    ///
    /// A mass centre at rest stays at rest by itself when all forces are internal: then there is
    /// nothing to take but rounding, and the sums over all masses are spared.
    pub fn constrain(&self, positions: &Vectors, masses: &[f64], forces: &mut Vectors) {
        let stays = self.support == support::Support::MassCentre
            && self.passive.iter().chain(&self.active).all(|force| force.is_internal());
        if !stays {
            self.support.constrain(positions, masses, forces);
        }
    }

    /// Energy stored in the passive forces, fJ; those without an energy count nothing.
    pub fn elastic_energy(&self, at: &Configuration<'_>) -> f64 {
        self.passive.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// Energy of the active forces at fixed tension, fJ; its drop is the work that they do.
    pub fn active_energy(&self, at: &Configuration<'_>) -> f64 {
        self.active.iter().filter_map(|force| force.energy(at)).sum()
    }

    /// Rate at which dashpots and drag take energy, fJ/ms.
    pub fn dissipation(&self, at: &Configuration<'_>) -> f64 {
        let forces = self.passive.iter().chain(&self.active);
        forces.map(|force| force.dissipation(at)).sum::<f64>() + self.drag.dissipation(at)
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
