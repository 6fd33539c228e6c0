//! Cubes: the lattice of a thick cell.
//!
//! Each cube is divided into five tetrahedra in both possible ways, by its even and by its odd
//! corners; all ten have weight 1/2, so no direction is preferred, and their edges are exactly the
//! springs. Each cube contributes a quarter of the stiffness of its 12 sides and half of its 12
//! face diagonals. With equal stiffness `k = (2/5) E h` of all springs this is an isotropic solid
//! with Young's modulus `E` and Poisson's ratio 1/4: `C_ijkl = (1/V) sum k l^2 n_i n_j n_k n_l`
//! over the springs gives `C_1111 = 3 k/h` and `C_1122 = C_1212 = k/h`. A block under uniform
//! tension deforms homogeneously.
//!
//! # Order, guaranteed
//! Points and cubes run with x fastest, then y, then z; the ten tetrahedra of a cube are consecutive; springs run by
//! direction, and within each as their first points.

use super::{Lattice, Mesh, MeshError, Simplex, Spring, SpringKind};

/// Number of corners of a cube; bits 0, 1, 2 of an index are the offsets along x, y, z.
const CORNERS: usize = 8;

/// Tetrahedra of a cube.
pub const TETRAHEDRA_OF_A_CUBE: usize = 10;

/// Tetrahedra of both divisions: the inner one, of four corners not joined by sides, then one at
/// each of the other corners.
pub(crate) const TETRAHEDRA: [[usize; 4]; TETRAHEDRA_OF_A_CUBE] = [
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

/// The directions of springs, in steps along x, y and z: three of sides, six of face diagonals. None leads to an earlier
/// layer, or to an earlier row of a layer.
const DIRECTIONS: [[isize; 3]; 9] = [
    [1, 0, 0],
    [0, 1, 0],
    [0, 0, 1],
    [1, 1, 0],
    [-1, 1, 0],
    [1, 0, 1],
    [-1, 0, 1],
    [0, 1, 1],
    [0, -1, 1],
];

/// A block of cubes of which some are filled.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// Side of a cube, um.
    pub spacing: f64,
    /// The corner with the least x, y and z, um.
    pub origin: [f64; 3],
    /// Cubes along x, y and z.
    pub shape: [usize; 3],
}

impl Grid {
    /// Number of cubes.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Column, row and layer of a cube.
    pub fn place(&self, cube: usize) -> [usize; 3] {
        let [columns, rows, _] = self.shape;
        [cube % columns, cube / columns % rows, cube / (columns * rows)]
    }
}

/// A block of `cubes` along x, y and z with this spacing (um) and one corner at the origin.
///
/// # Errors
/// [`MeshError`] if there is no cube along an axis, or if the spacing is not positive.
///
/// # Example
/// ```
/// use myospring::mesh::cubes;
/// let block = cubes::block([4, 2, 2], 2.0)?;
/// assert_eq!((block.len(), block.area()), (5 * 3 * 3, 8.0 * 4.0 * 4.0));
/// # Ok::<(), myospring::mesh::MeshError>(())
/// ```
pub fn block(cubes: [usize; 3], spacing: f64) -> Result<Mesh<3, 4>, MeshError> {
    let grid = Grid { spacing, origin: [0.0; 3], shape: cubes };
    filled(&grid, &vec![true; grid.len()])
}

/// The mesh of the filled cubes of a grid, which are listed with x fastest.
///
/// # Errors
/// [`MeshError`] if no cube is filled, if they are not joined, or if the spacing is not positive.
///
/// # Panics
/// If the list has not one entry per cube.
///
/// # Example
/// ```
/// use myospring::mesh::cubes::{Grid, filled};
/// // Two cubes side by side, and none above the second.
/// let grid = Grid { spacing: 1.0, origin: [0.0; 3], shape: [2, 1, 2] };
/// let step = filled(&grid, &[true, true, true, false])?;
/// assert_eq!((step.len(), step.area()), (12 + 4, 3.0));
/// # Ok::<(), myospring::mesh::MeshError>(())
/// ```
pub fn filled(grid: &Grid, filled: &[bool]) -> Result<Mesh<3, 4>, MeshError> {
    const NONE: u32 = u32::MAX;
    assert_eq!(filled.len(), grid.len(), "one entry per cube");
    let spacing = grid.spacing;
    let shape = grid.shape.map(|count| count + 1);
    let all: usize = shape.iter().product();
    let at = |[x, y, z]: [usize; 3]| x + shape[0] * (y + shape[1] * z);
    let place = |point: usize| {
        [point % shape[0], point / shape[0] % shape[1], point / (shape[0] * shape[1])]
    };
    let corner = |cube: [usize; 3], c: usize| {
        at([cube[0] + (c & 1), cube[1] + (c >> 1 & 1), cube[2] + (c >> 2 & 1)])
    };
    let cubes = || (0..grid.len()).filter(|&cube| filled[cube]).map(|cube| grid.place(cube));

    let mut around = vec![0_u8; all];
    for cube in cubes() {
        for c in 0..CORNERS {
            around[corner(cube, c)] += 1;
        }
    }
    let mut number = vec![NONE; all];
    let (mut cells, mut volumes) = (Vec::new(), Vec::new());
    for point in (0..all).filter(|&point| around[point] > 0) {
        number[point] = cells.len() as u32;
        cells.push(place(point).map(|place| place as u32));
        volumes.push(f64::from(around[point]) * spacing.powi(3) / CORNERS as f64);
    }
    let points = [0, 1, 2].map(|axis| {
        let along = |cell: &[u32; 3]| grid.origin[axis] + spacing * f64::from(cell[axis]);
        cells.iter().map(along).collect::<Vec<f64>>()
    });

    // By direction and first point, the cubes that share a spring.
    let mut shared = vec![[0_u8; DIRECTIONS.len()]; cells.len()];
    let mut simplices = Vec::new();
    for cube in cubes() {
        for a in 0..CORNERS {
            for (direction, step) in DIRECTIONS.iter().enumerate() {
                let offset = [a & 1, a >> 1 & 1, a >> 2 & 1];
                let to = |axis: usize| offset[axis].checked_add_signed(step[axis]);
                if (0..3).all(|axis| to(axis).is_some_and(|to| to <= 1)) {
                    shared[number[corner(cube, a)] as usize][direction] += 1;
                }
            }
        }
        let nodes = |c: usize| number[corner(cube, c)];
        simplices
            .extend(TETRAHEDRA.map(|corners| Simplex { nodes: corners.map(nodes), weight: 0.5 }));
    }
    let mut springs = Vec::new();
    for (direction, step) in DIRECTIONS.iter().enumerate() {
        let (kind, part) = match step.iter().filter(|part| **part != 0).count() {
            1 => (SpringKind::Axial, 0.25),
            _ => (SpringKind::Diagonal, 0.5),
        };
        for (node, cell) in cells.iter().enumerate() {
            let sharing = shared[node][direction];
            if sharing > 0 {
                let to = std::array::from_fn(|axis| {
                    (cell[axis] as usize).wrapping_add_signed(step[axis])
                });
                let nodes = [node as u32, number[at(to)]];
                springs.push(Spring { nodes, kind, share: part * f64::from(sharing) });
            }
        }
    }
    let lattice = Lattice { spacing, shape, origin: grid.origin, cells };
    Mesh::new(points, volumes, springs, simplices, Some(lattice))
}

/// The corners of each cube of a mesh of cubes; bits 0, 1, 2 of a place are the offsets along x, y, z.
pub fn corners(mesh: &Mesh<3, 4>) -> impl Iterator<Item = [u32; CORNERS]> {
    mesh.simplices.chunks_exact(TETRAHEDRA_OF_A_CUBE).map(|tetrahedra| {
        let first = |tetrahedron: usize, corner: usize| tetrahedra[tetrahedron].nodes[corner];
        [
            first(0, 0),
            first(1, 0),
            first(2, 0),
            first(0, 1),
            first(3, 0),
            first(0, 3),
            first(0, 2),
            first(4, 0),
        ]
    })
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
    fn corners_of_cubes_are_found_again() {
        let grid = Grid { spacing: 1.5, origin: [1.0, 2.0, 3.0], shape: [3, 2, 2] };
        let kept: Vec<bool> = (0..grid.len()).map(|cube| cube != 5 && cube != 6).collect();
        let mesh = filled(&grid, &kept).unwrap();
        let mut cubes = (0..grid.len()).filter(|&cube| kept[cube]);
        for corners in corners(&mesh) {
            let cube = grid.place(cubes.next().unwrap());
            for (c, node) in corners.into_iter().enumerate() {
                let offset = [c & 1, c >> 1 & 1, c >> 2 & 1];
                let expected = std::array::from_fn(|axis| {
                    grid.origin[axis] + 1.5 * (cube[axis] + offset[axis]) as f64
                });
                assert_eq!(mesh.point(node as usize), expected);
            }
        }
        assert_eq!(cubes.next(), None);
    }

    #[test]
    fn a_block_without_cubes_is_refused() {
        assert!(block([0, 2, 2], 1.0).is_err());
        assert!(block([2, 2, 2], f64::NAN).is_err());
    }
}
