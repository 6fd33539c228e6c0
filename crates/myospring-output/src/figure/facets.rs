//! Patches that cover a mesh without overlap, and their rim.

use std::collections::BTreeMap;

use super::FigureError;
use crate::digits::point;
use myospring_core::mesh::{Mesh, Simplex};
use myospring_core::recording::Frame;

/// A patch: a lattice square (of a thick cell a cube), or a simplex if the mesh is not a lattice.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Facet {
    /// Corners, counter-clockwise; of a cube those of its lower face, then of its upper one.
    pub(crate) corners: Vec<u32>,
    /// Which simplices of the mesh cover it.
    pub(crate) simplices: Vec<usize>,
}

/// Checks that simplices and springs refer to existing points, and that points at rest are finite.
pub(crate) fn check_mesh<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
) -> Result<(), FigureError> {
    let points = mesh.points.iter().map(Vec::len).min().unwrap_or(0);
    if points == 0 {
        return Err(FigureError::Nothing { what: "points" });
    }
    let springs = mesh.springs.iter().flat_map(|spring| spring.nodes);
    let corners = mesh.simplices.iter().flat_map(|simplex| simplex.nodes);
    if let Some(node) = springs.chain(corners).find(|&node| node as usize >= points) {
        return Err(FigureError::NoSuchPoint { node, points });
    }
    check_finite(&mesh.points, || "the mesh".to_owned())
}

/// Checks that a frame has as many finite positions as the mesh has points.
pub(crate) fn check_frame<const D: usize, const N: usize>(
    mesh: &Mesh<D, N>,
    frame: &Frame<D>,
) -> Result<(), FigureError> {
    for axis in 0..D {
        let (found, points) = (frame.positions[axis].len(), mesh.points[axis].len());
        if found != points {
            return Err(FigureError::WrongMesh { t_ms: frame.t_ms, axis, found, points });
        }
    }
    check_finite(&frame.positions, || format!("the frame at {} ms", frame.t_ms))
}

fn check_finite<const D: usize>(
    positions: &[Vec<f64>; D],
    what: impl FnOnce() -> String,
) -> Result<(), FigureError> {
    let points = positions.iter().map(Vec::len).min().unwrap_or(0);
    let at = |node: usize| positions.each_ref().map(|axis| axis[node]);
    match (0..points).find(|&node| at(node).iter().any(|x| !x.is_finite())) {
        Some(node) => Err(FigureError::NotFinite { what: what(), node, at: point(&at(node)) }),
        None => Ok(()),
    }
}

/// The facets of a checked mesh: squares or cubes in a lattice, triangles or tetrahedra elsewhere.
pub(crate) fn facets<const D: usize, const N: usize>(mesh: &Mesh<D, N>) -> Vec<Facet> {
    let lattice =
        mesh.lattice.as_ref().filter(|lattice| lattice.cells.len() == mesh.points[0].len());
    let Some(lattice) = lattice else {
        let alone = |(index, s): (usize, &Simplex<N>)| Facet {
            corners: s.nodes.to_vec(),
            simplices: vec![index],
        };
        return mesh.simplices.iter().enumerate().map(alone).collect();
    };
    // By layer, then row, then column.
    let mut places: BTreeMap<[u32; D], Vec<usize>> = BTreeMap::new();
    for (index, simplex) in mesh.simplices.iter().enumerate() {
        let cells = simplex.nodes.map(|node| lattice.cells[node as usize]);
        let lowest = std::array::from_fn(|axis| {
            cells.iter().fold(u32::MAX, |lowest, cell| lowest.min(cell[D - 1 - axis]))
        });
        places.entry(lowest).or_default().push(index);
    }
    places
        .into_iter()
        .map(|(lowest, simplices)| {
            let nodes = simplices.iter().flat_map(|&index| mesh.simplices[index].nodes);
            let mut corners: Vec<u32> = nodes.collect();
            let around = |&node: &u32| {
                let cell = lattice.cells[node as usize];
                let offset = |axis: usize| usize::from(cell[axis] > lowest[D - 1 - axis]);
                let upper = (2..D).map(offset).sum::<usize>();
                4 * upper + [0, 1, 3, 2][offset(0) + 2 * offset(1)]
            };
            corners.sort_by_key(|node| (around(node), *node));
            corners.dedup();
            Facet { corners, simplices }
        })
        .collect()
}

/// The rim of the facets as closed loops of nodes: edges with facets on one side only.
pub(super) fn outline(facets: &[Facet]) -> Vec<Vec<u32>> {
    let mut sides: BTreeMap<(u32, u32), i32> = BTreeMap::new();
    for facet in facets {
        for (place, &a) in facet.corners.iter().enumerate() {
            let b = facet.corners[(place + 1) % facet.corners.len()];
            *sides.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    let mut next: BTreeMap<u32, Vec<u32>> = BTreeMap::new();
    for ((a, b), side) in sides {
        match side.signum() {
            1 => next.entry(a).or_default().push(b),
            -1 => next.entry(b).or_default().push(a),
            _ => {}
        }
    }
    let mut loops = Vec::new();
    while let Some((&start, _)) = next.first_key_value() {
        let (mut ring, mut node) = (Vec::new(), start);
        while let Some(ends) = next.get_mut(&node) {
            ring.push(node);
            let following = ends.pop();
            if ends.is_empty() {
                next.remove(&node);
            }
            match following {
                Some(end) if end != start => node = end,
                _ => break,
            }
        }
        loops.push(ring);
    }
    loops
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::{Lattice, cubes};

    /// Two squares of side 2 beside each other.
    fn mesh() -> Mesh {
        let square = |[a, b, c, d]: [u32; 4]| {
            [[a, b, c], [a, c, d], [a, b, d], [b, c, d]].map(|nodes| Simplex { nodes, weight: 0.5 })
        };
        Mesh {
            points: [vec![0.0, 2.0, 4.0, 0.0, 2.0, 4.0], vec![0.0, 0.0, 0.0, 2.0, 2.0, 2.0]],
            areas: vec![1.0; 6],
            springs: Vec::new(),
            simplices: [square([0, 1, 4, 3]), square([1, 2, 5, 4])].concat(),
            lattice: Some(Lattice {
                spacing: 2.0,
                shape: [3, 2],
                origin: [0.0, 0.0],
                cells: vec![[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1]],
            }),
        }
    }

    fn moved(mesh: &Mesh, map: impl Fn(f64, f64) -> [f64; 2]) -> Frame {
        let both = mesh.points[0].iter().zip(&mesh.points[1]).map(|(&x, &y)| map(x, y));
        let (xs, ys) = both.map(|[x, y]| (x, y)).unzip();
        Frame::new(0.0, 0.0, [xs, ys])
    }

    #[test]
    fn squares_are_put_together_from_their_triangles() {
        let facets = facets(&mesh());
        let corners: Vec<_> = facets.iter().map(|facet| facet.corners.clone()).collect();
        assert_eq!(corners, [[0, 1, 4, 3], [1, 2, 5, 4]]);
        assert_eq!(facets[0].simplices.len(), 4);
    }

    #[test]
    fn cubes_are_put_together_with_the_lower_face_first() {
        let block = cubes::block([2, 1, 1], 2.0).unwrap();
        let facets = facets(&block);
        assert_eq!(facets.len(), 2);
        let at = |node: &u32| block.point(*node as usize).map(|x| x / 2.0);
        let corners: Vec<[f64; 3]> = facets[0].corners.iter().map(at).collect();
        let round = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
        let expected = [0.0, 1.0].map(|z| round.map(|[x, y]| [x, y, z]));
        assert_eq!(corners, expected.concat());
        assert_eq!(facets[1].simplices.len(), 10);
    }

    #[test]
    fn the_outline_runs_once_around_the_cell() {
        let mut mesh = mesh();
        assert_eq!(outline(&facets(&mesh)), [[0, 1, 2, 5, 4, 3]]);
        // Without the lattice the four triangles of a square lie over each other.
        mesh.lattice = None;
        assert_eq!(outline(&facets(&mesh)), [[0, 1, 2, 5, 4, 3]]);
    }

    #[test]
    fn broken_shapes_are_refused() {
        let mesh = mesh();
        let mut frame = moved(&mesh, |x, y| [x, y]);
        check_frame(&mesh, &frame).unwrap();
        frame.positions[1][3] = f64::NAN;
        let message = check_frame(&mesh, &frame).unwrap_err().to_string();
        assert!(message.contains("point 3 at (0, NaN) um"), "{message}");
        frame.positions[1].pop();
        assert!(matches!(check_frame(&mesh, &frame), Err(FigureError::WrongMesh { axis: 1, .. })));
        let mut broken = mesh;
        broken.simplices[0].nodes[2] = 9;
        assert!(matches!(check_mesh(&broken), Err(FigureError::NoSuchPoint { node: 9, .. })));
    }
}
