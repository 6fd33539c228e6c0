//! Laws as data: what a law puts on a flat lattice, for a kernel that sweeps it.
//!
//! A law only says what its coefficients are; whether they fit a lattice, and where they go, is for the
//! kernel to find out.

/// A spring of no length from a node to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor<const D: usize = 2> {
    /// The node.
    pub node: usize,
    /// The place, um.
    pub place: [f64; D],
    /// nN/um.
    pub stiffness: f64,
}

/// The coefficients of a law on a flat mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LatticeLaw<'a> {
    /// Springs with axial dashpots; all lists run over the springs.
    Springs {
        /// The ends of each.
        nodes: &'a [[u32; 2]],
        /// Stiffness, nN/um.
        stiffness: &'a [f64],
        /// Rest length, um.
        rest_length: &'a [f64],
        /// Dashpot coefficient, nN ms/um.
        damping: &'a [f64],
    },
    /// The energy `(kappa/2)(A - A0)^2` of triangles; all lists run over the triangles.
    Areas {
        /// The corners of each.
        nodes: &'a [[u32; 3]],
        /// kappa, nN/um^3.
        stiffness: &'a [f64],
        /// A0, um^2.
        rest_area: &'a [f64],
    },
    /// Springs of no rest length whose stiffness (nN/um) is the uniform tension (kPa) times a weight; both
    /// lists run over the springs.
    Tension {
        /// The ends of each.
        nodes: &'a [[u32; 2]],
        /// Weight, um.
        weights: &'a [f64],
    },
    /// Springs of no length from nodes to their places of rest.
    Anchors(&'a [Anchor]),
}
