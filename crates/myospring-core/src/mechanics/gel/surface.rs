//! The surface of a gel.

use crate::mechanics::vectors::Vectors;

/// Displacements of the surface of a gel, on the lattice of the cell and around it.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Distance between places, um.
    pub spacing: f64,
    /// The place in the lower left corner, um.
    pub origin: [f64; 2],
    /// Columns and rows.
    pub shape: [usize; 2],
    /// Along x and y, um, row by row from the lowest.
    pub displacements: Vectors,
}

impl Surface {
    /// Where a place is, um.
    pub fn place(&self, place: usize) -> [f64; 2] {
        let columns = self.shape[0];
        [(0, place % columns), (1, place / columns)]
            .map(|(axis, index)| self.origin[axis] + index as f64 * self.spacing)
    }

    /// Whether each place (um) lies in a region.
    pub fn within(&self, region: impl Fn([f64; 2]) -> bool) -> Vec<bool> {
        (0..self.shape[0] * self.shape[1]).map(|place| region(self.place(place))).collect()
    }
}
