//! A block of cubes: a simple thick cell, for tests and for laws with three axes.
//!
//! Each cube is divided into five tetrahedra in both possible ways, by its even and by its odd
//! corners; all ten have weight 1/2, so no direction is preferred, and their edges are exactly the
//! springs. Each cube contributes a quarter of the stiffness of its 12 sides and half of its 12
//! face diagonals. With equal stiffness `k = (2/5) E h` of all springs this is an isotropic solid
//! with Young's modulus `E` and Poisson's ratio 1/4: `C_ijkl = (1/V) sum k l^2 n_i n_j n_k n_l`
//! over the springs gives `C_1111 = 3 k/h` and `C_1122 = C_1212 = k/h`. A block under uniform
//! tension deforms homogeneously.

use super::{Lattice, Mesh, MeshError, Simplex, Spring, SpringKind};
use std::collections::BTreeMap;

/// Number of corners of a cube; bits 0, 1, 2 of an index are the offsets along x, y, z.
const CUBE: usize = 8;

/// Tetrahedra of both divisions: the inner one, of four corners not joined by sides, then one at
/// each of the other corners.
const TETRAHEDRA: [[usize; 4]; 10] = [
    [0, 3, 6, 5],
    [1, 0, 5, 3],
    [2, 0, 3, 6],
    [4, 0, 6, 5],
    [7, 3, 5, 6],
    [1, 2, 4, 7],
    [0, 1, 2, 4],
    [3, 1, 7, 2],
    [5, 1, 4, 7],
    [6, 2, 7, 4],
];

/// A block of `cubes` along x, y and z with this spacing (um) and one corner at the origin.
///
/// The ten tetrahedra of a cube are consecutive; cubes are ordered with x fastest.
///
/// # Errors
/// [`MeshError`] if there is no cube along an axis, or if the spacing is not positive.
///
/// # Example
/// ```
/// use myospring::mesh::bar;
/// let block = bar::block([4, 2, 2], 2.0)?;
/// assert_eq!((block.len(), block.area()), (5 * 3 * 3, 8.0 * 4.0 * 4.0));
/// # Ok::<(), myospring::mesh::MeshError>(())
/// ```
pub fn block(cubes: [usize; 3], spacing: f64) -> Result<Mesh<3, 4>, MeshError> {
    let shape = cubes.map(|count| count + 1);
    let number = |at: [usize; 3]| at[0] + shape[0] * (at[1] + shape[1] * at[2]);
    let count: usize = shape.iter().product();
    let cells: Vec<[u32; 3]> = (0..count)
        .map(|n| [n % shape[0], n / shape[0] % shape[1], n / (shape[0] * shape[1])])
        .map(|at| at.map(|place| place as u32))
        .collect();
    let points = [0, 1, 2]
        .map(|axis| cells.iter().map(|cell| spacing * f64::from(cell[axis])).collect::<Vec<f64>>());
    let mut volumes = vec![0.0; count];
    let mut shares: BTreeMap<[u32; 2], (SpringKind, f64)> = BTreeMap::new();
    let mut simplices = Vec::new();
    for cube in 0..cubes.iter().product() {
        let at = [cube % cubes[0], cube / cubes[0] % cubes[1], cube / (cubes[0] * cubes[1])];
        let corner =
            |c: usize| number([at[0] + (c & 1), at[1] + (c >> 1 & 1), at[2] + (c >> 2 & 1)]) as u32;
        for a in 0..CUBE {
            volumes[corner(a) as usize] += spacing.powi(3) / CUBE as f64;
            for b in a + 1..CUBE {
                let (kind, share) = match (a ^ b).count_ones() {
                    1 => (SpringKind::Axial, 0.25),
                    2 => (SpringKind::Diagonal, 0.5),
                    _ => continue,
                };
                shares.entry([corner(a), corner(b)]).or_insert((kind, 0.0)).1 += share;
            }
        }
        simplices
            .extend(TETRAHEDRA.map(|corners| Simplex { nodes: corners.map(corner), weight: 0.5 }));
    }
    let springs =
        shares.into_iter().map(|(nodes, (kind, share))| Spring { nodes, kind, share }).collect();
    let lattice = Lattice { spacing, shape, origin: [0.0; 3], cells };
    Mesh::new(points, volumes, springs, simplices, Some(lattice))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::simplex::measure_at;
    use std::collections::BTreeSet;

    #[test]
    fn the_tetrahedra_of_both_cuts_fill_the_block_and_their_edges_are_its_springs() {
        let block = block([3, 2, 4], 1.5).unwrap();
        let volume: f64 =
            block.simplices.iter().map(|s| s.weight * measure_at(&block.points, s.nodes)).sum();
        assert!((volume - 24.0 * 1.5_f64.powi(3)).abs() < 1e-12);
        let ends = |a: u32, b: u32| [a.min(b), a.max(b)];
        let edges: BTreeSet<_> = block
            .simplices
            .iter()
            .flat_map(|s| {
                [(0, 1), (0, 2), (0, 3), (1, 2), (1, 3), (2, 3)]
                    .map(|(i, j)| ends(s.nodes[i], s.nodes[j]))
            })
            .collect();
        let springs: BTreeSet<_> =
            block.springs.iter().map(|spring| ends(spring.nodes[0], spring.nodes[1])).collect();
        assert_eq!(edges, springs);
    }

    #[test]
    fn a_block_without_cubes_is_refused() {
        assert!(block([0, 2, 2], 1.0).is_err());
        assert!(block([2, 2, 2], f64::NAN).is_err());
    }
}
