//! What ties many nodes to each other through a body that is not part of the mesh, such as a gel.

use super::vectors::Vectors;

/// A linear elastic body to which nodes are attached: it is known by how far forces move them, a matrix without zeros.
pub trait Compliance<const D: usize = 2>: Send + Sync {
    /// The nodes that are attached, in ascending order; vectors below have one entry for each.
    fn nodes(&self) -> &[usize];

    /// How far each attached node is from where it is without force, um.
    fn displacements(&self, positions: &Vectors<D>) -> Vectors<D>;

    /// The forces on the body (nN) that move the attached nodes so far (um).
    fn forces(&self, displacements: &Vectors<D>) -> Vectors<D>;

    /// As [`Compliance::forces`], for displacements of all nodes of the mesh.
    fn forces_of(&self, displacements: &Vectors<D>) -> Vectors<D> {
        let of = |axis: &Vec<f64>| self.nodes().iter().map(|&node| axis[node]).collect();
        self.forces(&displacements.each_ref().map(of))
    }

    /// How far these forces on the body (nN) move the attached nodes, um.
    fn displaced(&self, forces: &Vectors<D>) -> Vectors<D>;

    /// Forces (nN) under displacements (um) of springs that are like the body: the stiffness that
    /// [`Force::add_stiffness`](super::Force::add_stiffness) adds in its place.
    fn likeness(&self, displacements: &Vectors<D>) -> Vectors<D>;
}
