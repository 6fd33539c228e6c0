//! The surface of a thick cell: the faces of its cubes that border on no other cube.

use super::Mesh;
use std::collections::BTreeMap;

/// Corners of a cube: bits 0, 1, 2 of an index are the offsets along x, y, z.
type Cube = [Option<u32>; 8];

/// The faces of the surface, four nodes each. Seen from outside they run counter-clockwise, so that
/// `(b - a) x (d - a)` points outward. Faces of one cube are consecutive.
///
/// A mesh without a lattice has no cubes, and the list is empty; so it is for tetrahedra that leave a
/// corner of their cube out.
///
/// # Example
/// ```
/// use myospring::mesh::{cubes, surface};
/// let block = cubes::block([4, 2, 3], 2.0)?;
/// assert_eq!(surface::quads(&block).len(), 2 * (4 * 2 + 2 * 3 + 3 * 4));
/// # Ok::<(), myospring::mesh::MeshError>(())
/// ```
pub fn quads(mesh: &Mesh<3, 4>) -> Vec<[u32; 4]> {
    let cubes = cubes(mesh);
    let mut quads = Vec::new();
    for (place, cube) in &cubes {
        for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beside = *place;
            beside[axis] = beside[axis] + 2 * side - 1;
            if cubes.contains_key(&beside) {
                continue;
            }
            let [first, second] = [(axis + 1) % 3, (axis + 2) % 3];
            let corner =
                |a: usize, b: usize| cube[(side as usize) << axis | a << first | b << second];
            let round = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
            if let [Some(a), Some(b), Some(c), Some(d)] = round {
                quads.push(if side == 1 { [a, b, c, d] } else { [d, c, b, a] });
            }
        }
    }
    quads
}

/// The cubes by their column, row and layer.
fn cubes(mesh: &Mesh<3, 4>) -> BTreeMap<[i64; 3], Cube> {
    let mut cubes: BTreeMap<[i64; 3], Cube> = BTreeMap::new();
    let Some(lattice) = &mesh.lattice else { return cubes };
    for simplex in &mesh.simplices {
        let places = simplex.nodes.map(|node| lattice.cells[node as usize].map(i64::from));
        let lowest = [0, 1, 2].map(|axis: usize| {
            places.iter().fold(i64::MAX, |lowest, place| lowest.min(place[axis]))
        });
        let cube = cubes.entry(lowest).or_default();
        for (place, node) in places.iter().zip(simplex.nodes) {
            let offset = |axis: usize| usize::from(place[axis] > lowest[axis]) << axis;
            cube[offset(0) | offset(1) | offset(2)] = Some(node);
        }
    }
    cubes
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::cubes;
    use std::collections::BTreeMap;

    /// Volume within the surface, um^3, as the sum of `x . n dA / 3`.
    fn volume_within(mesh: &Mesh<3, 4>, quads: &[[u32; 4]]) -> f64 {
        let sixth = |a: [f64; 3], b: [f64; 3], c: [f64; 3]| {
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        };
        let of = |quad: &[u32; 4]| {
            let [a, b, c, d] = quad.map(|node| mesh.point(node as usize));
            sixth(a, b, c) + sixth(a, c, d)
        };
        quads.iter().map(of).sum()
    }

    /// Whether every side of a face is that of another one, the other way round.
    fn is_closed(quads: &[[u32; 4]]) -> bool {
        let mut sides: BTreeMap<[u32; 2], i32> = BTreeMap::new();
        for quad in quads {
            for corner in 0..4 {
                let [a, b] = [quad[corner], quad[(corner + 1) % 4]];
                *sides.entry([a.min(b), a.max(b)]).or_default() += if a < b { 1 } else { -1 };
            }
        }
        sides.values().all(|&sum| sum == 0)
    }

    #[test]
    fn the_surface_is_closed_and_holds_the_volume_whatever_the_shape() {
        for cubes in [[1, 1, 1], [5, 3, 4], [7, 1, 2]] {
            for spacing in [0.3, 2.0, 11.0] {
                let mut block = cubes::block(cubes, spacing).unwrap();
                // Every third cube is missing, which leaves notches, holes and lone cubes.
                for kept in [1, 3] {
                    let mut index = 0;
                    block.simplices.retain(|_| {
                        index += 1;
                        kept == 1 || (index - 1) / 10 % kept != 1
                    });
                    let quads = quads(&block);
                    let volume = (block.simplices.len() / 10) as f64 * spacing.powi(3);
                    assert!((volume_within(&block, &quads) - volume).abs() < 1e-9 * volume);
                    assert!(is_closed(&quads), "{cubes:?}");
                }
            }
        }
    }

    #[test]
    fn without_a_lattice_there_are_no_cubes() {
        let mut block = cubes::block([2, 1, 1], 1.0).unwrap();
        block.lattice = None;
        assert!(quads(&block).is_empty());
    }
}
