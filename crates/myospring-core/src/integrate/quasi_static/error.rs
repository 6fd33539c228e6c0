//! Why a path of equilibria cannot start, and why it ends.

use crate::interruption::Interrupted;
use crate::mesh::Place;

/// Where a cell gives way: the node that moves most in its softest deformation at the end of the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WeakPlace {
    /// The node.
    pub node: usize,
    /// Where it is at the last equilibrium.
    pub place: Place,
}

fn words(place: Option<&WeakPlace>) -> String {
    place.map_or_else(String::new, |WeakPlace { node, place }| {
        format!(" near {place} (node {node})")
    })
}

impl From<Interrupted> for PathError {
    fn from(_: Interrupted) -> Self {
        Self::Interrupted
    }
}

/// Why there is no path, or why it ends.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PathError {
    /// A force has no energy, so the shape depends on how it was reached.
    #[error(
        "{force}: this law has no energy, so there is no path of equilibria; use the area law \
         `gradient`, or integrate in time with Verlet's method"
    )]
    NoEnergy {
        /// The force.
        force: &'static str,
    },
    /// A load from outside turns and pushes the body; its work depends on how the body is held.
    #[error(
        "{force}: loads from outside have no path of equilibria here; use tension along the fibre, or \
         integrate in time with Verlet's method"
    )]
    External {
        /// The force.
        force: &'static str,
    },
    /// A force does not provide its stiffness.
    #[error(
        "{force}: this force has no tangent stiffness, which the path of equilibria needs; implement \
         `Force::add_stiffness`, or integrate in time with Verlet's method"
    )]
    NoStiffness {
        /// The force.
        force: &'static str,
    },
    /// Damping delays the shape.
    #[error(
        "drag and dashpots delay the shape by {delay:.2} ms, more than {longest} ms, so it is no \
         function of the tension alone; integrate in time with Verlet's method, or, if they are \
         numerical, lower drag_ratio, damping_ratio or slowest_period, which no equilibrium depends on"
    )]
    Delayed {
        /// The delay, ms.
        delay: f64,
        /// The largest accepted delay, ms.
        longest: f64,
    },
    /// The equilibrium loses its stability.
    #[error(
        "the equilibrium is unstable beyond {tension:.4} kPa (its stiffness is no longer positive \
         definite at {beyond:.4} kPa): the cell buckles or collapses{}; keep the tension below, stiffen \
         the cell, or integrate in time with Verlet's method to see what follows", words(place.as_ref())
    )]
    Unstable {
        /// The last tension with a stable equilibrium, kPa.
        tension: f64,
        /// A tension without, kPa.
        beyond: f64,
        /// Where the cell gives way.
        place: Option<WeakPlace>,
    },
    /// There is no stable shape before the cell pulls.
    #[error(
        "the cell has no stable shape before it pulls{}: its support or its load is too much for it; bring end_stretch \
         nearer to 1, lower the afterload, or raise Young's modulus", words(place.as_ref())
    )]
    AtRest {
        /// Where the cell gives way.
        place: Option<WeakPlace>,
    },
    /// No equilibrium was found.
    #[error(
        "no equilibrium was found beyond {tension:.4} kPa (tried {beyond:.4} kPa): the forces are too \
         strong for this lattice, which gives way{}; lower the tension or the area modulus, or raise \
         Young's modulus", words(place.as_ref())
    )]
    Lost {
        /// The last tension with a stable equilibrium, kPa.
        tension: f64,
        /// The tension tried, kPa.
        beyond: f64,
        /// Where the cell gives way.
        place: Option<WeakPlace>,
    },
    /// The matrix does not fit into memory.
    #[error(
        "the equilibria of {masses} masses take more than {gb:.2} GB of memory beside what is in use, which cannot \
         be had; use a coarser mesh, or integrate in time with Verlet's method"
    )]
    TooLarge {
        /// Number of masses.
        masses: usize,
        /// What it takes at least, GB.
        gb: f64,
    },
    /// It was interrupted.
    #[error("the search for equilibria was interrupted")]
    Interrupted,
    /// The requested tension is not finite.
    #[error("a tension of {tension} kPa has no equilibrium; give a finite one")]
    NotFinite {
        /// The tension, kPa.
        tension: f64,
    },
}
