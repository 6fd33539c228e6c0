//! The squares that a cell is drawn with: those of its lattice, or coarser ones, and more around them that carry the
//! colour to the outline.

use myospring_core::mesh::Mesh;
use myospring_core::mesh::carried::Carried;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::simplex::measure_at;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// Column and row.
type Place = [i32; 2];

/// Squares with their corners, and the outline, as points of one list.
pub(super) struct Display {
    /// Side of a square, um.
    pub(super) spacing: f64,
    /// Points at rest, um: corners of squares, then the outline.
    pub(super) rest: Vec<[f64; 2]>,
    /// Corners of each square, counter-clockwise.
    pub(super) corners: Vec<[u32; 4]>,
    /// How many of them belong to the mesh.
    pub(super) within: usize,
    /// Points of each ring of the outline.
    pub(super) rings: Vec<usize>,
    /// Triangles of the mesh with their areas, for each square; for a square around the cell those
    /// of the nearest square.
    pub(super) triangles: Vec<Vec<(usize, f64)>>,
    moved: Vec<Moved>,
    carried: Carried,
}

/// The source of a point's motion.
enum Moved {
    /// It is a node.
    Node(u32),
    /// The nodes around it.
    Carried(usize),
}

impl Display {
    /// Squares of `coarser` times the spacing of the lattice.
    pub(super) fn new(mesh: &Mesh, outline: &Outline, coarser: u32) -> Self {
        let mean = || (mesh.area() / mesh.len() as f64).sqrt();
        let finest = mesh.lattice.as_ref().map_or_else(mean, |lattice| lattice.spacing);
        let spacing = finest * f64::from(coarser);
        let lowest = |axis: usize| mesh.points[axis].iter().copied().fold(f64::INFINITY, f64::min);
        let origin =
            mesh.lattice.as_ref().map_or_else(|| [lowest(0), lowest(1)], |lattice| lattice.origin);
        let place = |point: [f64; 2]| -> Place {
            [0, 1].map(|axis| ((point[axis] - origin[axis]) / spacing).floor() as i32)
        };
        let corner = |[i, j]: Place| {
            [origin[0] + f64::from(i) * spacing, origin[1] + f64::from(j) * spacing]
        };

        let mut within: BTreeMap<Place, Vec<(usize, f64)>> = BTreeMap::new();
        for (index, simplex) in mesh.simplices.iter().enumerate() {
            let area = simplex.weight * measure_at(&mesh.points, simplex.nodes);
            within.entry(place(mesh.centre(simplex))).or_default().push((index, area));
        }
        let rings: Vec<Vec<[f64; 2]>> =
            Carried::rings(mesh, outline).iter().map(|ring| ring.at(&mesh.points)).collect();
        let mut around: BTreeSet<Place> =
            rings.iter().flatten().map(|&point| place(point)).collect();
        around.extend(within.keys().flat_map(|&square| neighbours(square)));
        around.retain(|square| !within.contains_key(square));
        let nearest = nearest(&within, &around);

        let nodes: HashMap<Place, u32> = mesh
            .lattice
            .iter()
            .flat_map(|lattice| {
                lattice.cells.iter().zip(0..).filter_map(move |(cell, node)| {
                    let corner =
                        cell.map(|along| i32::try_from(along / coarser).unwrap_or(i32::MAX));
                    cell.iter().all(|along| along % coarser == 0).then_some((corner, node))
                })
            })
            .collect();
        let mut numbered: HashMap<Place, u32> = HashMap::new();
        let (mut rest, mut moved, mut free) = (Vec::new(), Vec::new(), Vec::new());
        let mut corners = Vec::new();
        let mut triangles = Vec::new();
        for square in within.keys().chain(nearest.keys()) {
            let [i, j] = *square;
            corners.push([[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|at| {
                *numbered.entry(at).or_insert_with(|| {
                    let point = corner(at);
                    moved.push(nodes.get(&at).map_or_else(
                        || {
                            free.push(point);
                            Moved::Carried(free.len() - 1)
                        },
                        |&node| Moved::Node(node),
                    ));
                    rest.push(point);
                    rest.len() as u32 - 1
                })
            }));
            let own = nearest.get(square).unwrap_or(square);
            triangles.push(within.get(own).cloned().unwrap_or_default());
        }
        for &point in rings.iter().flatten() {
            moved.push(Moved::Carried(free.len()));
            free.push(point);
            rest.push(point);
        }
        Self {
            spacing,
            rest,
            corners,
            within: within.len(),
            rings: rings.iter().map(Vec::len).collect(),
            triangles,
            moved,
            carried: Carried::new(mesh, free),
        }
    }

    /// How far every point has moved from rest, um: x and y in turn.
    pub(super) fn displacements(&self, positions: &[Vec<f64>; 2]) -> Vec<f32> {
        let carried = self.carried.at(positions);
        let points = self.moved.iter().zip(&self.rest);
        points
            .flat_map(|(moved, rest)| {
                let now = match *moved {
                    Moved::Node(node) => [0, 1].map(|axis| positions[axis][node as usize]),
                    Moved::Carried(index) => carried[index],
                };
                [(now[0] - rest[0]) as f32, (now[1] - rest[1]) as f32]
            })
            .collect()
    }

    /// The mean over the triangles of each square of the values of all triangles.
    pub(super) fn means(&self, values: &[f64]) -> Vec<f64> {
        let mean = |triangles: &Vec<(usize, f64)>| {
            let area: f64 = triangles.iter().map(|(_, area)| area).sum();
            let sum: f64 = triangles.iter().map(|&(index, area)| area * values[index]).sum();
            if area > 0.0 { sum / area } else { 0.0 }
        };
        self.triangles.iter().map(mean).collect()
    }
}

fn neighbours([i, j]: Place) -> impl Iterator<Item = Place> {
    (-1..=1).flat_map(move |up| (-1..=1).map(move |along| [i + along, j + up]))
}

/// For each square around the cell a near square of the cell; squares without one are far from the
/// mesh and left out.
fn nearest(
    within: &BTreeMap<Place, Vec<(usize, f64)>>,
    around: &BTreeSet<Place>,
) -> BTreeMap<Place, Place> {
    let mut nearest: BTreeMap<Place, Place> = BTreeMap::new();
    loop {
        let of = |square: Place| {
            neighbours(square).find_map(|beside| {
                let own = within.contains_key(&beside).then_some(beside);
                own.or_else(|| nearest.get(&beside).copied())
            })
        };
        let open = around.iter().filter(|square| !nearest.contains_key(*square));
        let found: Vec<(Place, Place)> =
            open.filter_map(|&square| Some((square, of(square)?))).collect();
        if found.is_empty() {
            return nearest;
        }
        nearest.extend(found);
    }
}
