//! Laws as data: coefficients of a law on a lattice, for the fused kernel.
//!
//! A law only provides its coefficients; the kernel determines whether they fit a lattice, and
//! their positions.

/// A spring without rest length from a node to a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Anchor<const D: usize = 2> {
    /// The node.
    pub node: usize,
    /// The place, um.
    pub place: [f64; D],
    /// Stiffness, nN/um.
    pub stiffness: f64,
}

/// The coefficients of a law on a mesh with `D` axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LatticeLaw<'a, const D: usize = 2> {
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
    /// The energy `(kappa/2)(V - V0)^2/V0` of groups of equally many consecutive simplices, `V = sum w_i V_i`.
    Volumes {
        /// The corners of all simplices, one after the other.
        corners: &'a [u32],
        /// `w_i` of each simplex.
        weights: &'a [f64],
        /// kappa, kPa.
        stiffness: f64,
        /// V0 of each group, um^3.
        rest: &'a [f64],
    },
    /// Springs without rest length whose stiffness (nN/um) is the uniform tension (kPa) times a
    /// weight; both lists run over the springs.
    Tension {
        /// The ends of each.
        nodes: &'a [[u32; 2]],
        /// Weight, um.
        weights: &'a [f64],
    },
    /// Springs without rest length from nodes to their resting positions.
    Anchors(&'a [Anchor<D>]),
}
