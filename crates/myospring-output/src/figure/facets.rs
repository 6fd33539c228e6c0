//! Patches that cover a mesh without overlap, and their rim.

use std::collections::BTreeMap;

use super::FigureError;
use myospring_core::mesh::{Mesh, Simplex};
use myospring_core::recording::Frame;

/// A patch: a lattice square, or a triangle if the mesh is not a lattice.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Facet {
    /// Corners, counter-clockwise.
    pub(crate) corners: Vec<u32>,
    /// Which triangles of the mesh cover it.
    pub(crate) triangles: Vec<usize>,
}

/// Checks that triangles and springs refer to existing points, and that points at rest are finite.
pub(crate) fn check_mesh(mesh: &Mesh) -> Result<(), FigureError> {
    let points = mesh.points[0].len().min(mesh.points[1].len());
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
pub(crate) fn check_frame(mesh: &Mesh, frame: &Frame) -> Result<(), FigureError> {
    for axis in 0..2 {
        let (found, points) = (frame.positions[axis].len(), mesh.points[axis].len());
        if found != points {
            return Err(FigureError::WrongMesh { t_ms: frame.t_ms, axis, found, points });
        }
    }
    check_finite(&frame.positions, || format!("the frame at {} ms", frame.t_ms))
}

fn check_finite(
    positions: &[Vec<f64>; 2],
    what: impl FnOnce() -> String,
) -> Result<(), FigureError> {
    let [xs, ys] = positions;
    match xs.iter().zip(ys).position(|(x, y)| !(x.is_finite() && y.is_finite())) {
        Some(node) => Err(FigureError::NotFinite { what: what(), node, x: xs[node], y: ys[node] }),
        None => Ok(()),
    }
}

/// The facets of a checked mesh: squares in a lattice, triangles elsewhere.
pub(crate) fn facets(mesh: &Mesh) -> Vec<Facet> {
    let columns_and_rows =
        mesh.lattice.as_ref().filter(|lattice| lattice.cells.len() == mesh.points[0].len());
    let Some(lattice) = columns_and_rows else {
        let triangle = |(index, s): (usize, &Simplex<3>)| Facet {
            corners: s.nodes.to_vec(),
            triangles: vec![index],
        };
        return mesh.simplices.iter().enumerate().map(triangle).collect();
    };
    let mut squares: BTreeMap<[u32; 2], Vec<usize>> = BTreeMap::new();
    for (index, simplex) in mesh.simplices.iter().enumerate() {
        let corner = |axis: usize| simplex.nodes.map(|node| lattice.cells[node as usize][axis]);
        let lowest = |[a, b, c]: [u32; 3]| a.min(b).min(c);
        squares.entry([lowest(corner(1)), lowest(corner(0))]).or_default().push(index);
    }
    squares
        .into_values()
        .map(|triangles| {
            let nodes = triangles.iter().flat_map(|&index| mesh.simplices[index].nodes);
            let mut corners: Vec<u32> = nodes.collect();
            corners.sort_unstable();
            corners.dedup();
            let at = |node: u32| [0, 1].map(|axis: usize| mesh.points[axis][node as usize]);
            let middle = [0, 1].map(|axis: usize| {
                corners.iter().map(|&node| at(node)[axis]).sum::<f64>() / corners.len() as f64
            });
            let angle = |&node: &u32| {
                let [x, y] = at(node);
                (y - middle[1]).atan2(x - middle[0])
            };
            corners.sort_by(|a, b| angle(a).total_cmp(&angle(b)));
            Facet { corners, triangles }
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
    use myospring_core::mesh::Lattice;

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
        Frame {
            t_ms: 0.0,
            ta_kpa: 0.0,
            ta_by_triangle_kpa: None,
            on_gel_nn: None,
            positions: [xs, ys],
        }
    }

    #[test]
    fn squares_are_put_together_from_their_triangles() {
        let facets = facets(&mesh());
        let corners: Vec<_> = facets.iter().map(|facet| facet.corners.clone()).collect();
        assert_eq!(corners, [[0, 1, 4, 3], [1, 2, 5, 4]]);
        assert_eq!(facets[0].triangles.len(), 4);
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
