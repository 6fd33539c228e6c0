//! The drawn cell: its outline, moved with the lattice, and bands of colour up to the outline.
//!
//! The outline lies partly outside the lattice's squares. There, squares are added whose corners
//! move like the outline itself, so that colours reach the rim without a step or gap. Area and
//! length in the results of a run are those of the lattice; those of the outline differ by a
//! fraction of a spacing.

use std::collections::{BTreeMap, BTreeSet};

use myospring_core::mesh::carried::Carried;
use myospring_core::mesh::outline::Outline;
use myospring_core::mesh::{Lattice, Mesh};

use super::facets::{Facet, outline};

/// Distance between the points at which an outline is sampled, in spacings.
const STEP: f64 = 0.25;
/// Index that stands for none.
const NONE: u32 = u32::MAX;

/// Rings of points, um.
pub(super) type Rings = Vec<Vec<[f64; 2]>>;

/// Triangles that cover the cell to beyond its outline; corners are the nodes of the mesh, then the
/// added ones.
#[derive(Debug, Clone)]
pub(super) struct Skin {
    nodes: usize,
    beside: Carried,
    rings: Edge,
    triangles: Vec<[u32; 3]>,
    /// Sides of each triangle, by index; the side after a corner leads to the next corner.
    sides: Vec<[u32; 3]>,
    /// Ends of each side, the lower number first.
    ends: Vec<[u32; 2]>,
    /// Sides with a triangle on one side only: index, whether it runs from its lower end, and the
    /// next one around the skin.
    rim: Vec<(u32, bool, u32)>,
}

/// The boundary of the cell.
#[derive(Debug, Clone)]
enum Edge {
    /// The rim of the mesh.
    Nodes(Vec<Vec<u32>>),
    Carried(Vec<Carried>),
}

impl Skin {
    /// Builds the skin of a checked mesh and its facets. Without an outline, or if the mesh is not
    /// a lattice, the rim of the mesh is the boundary.
    pub(super) fn new(mesh: &Mesh, facets: &[Facet], given: Option<&Outline>) -> Self {
        let mut triangles = Vec::new();
        let mut add = |corners: &[u32]| {
            triangles.extend((2..corners.len()).map(|k| [corners[0], corners[k - 1], corners[k]]));
        };
        for facet in facets {
            add(&facet.corners);
        }
        let mut places = Vec::new();
        let rings = match given.zip(mesh.lattice.as_ref()) {
            None => Edge::Nodes(outline(facets)),
            Some((given, lattice)) => {
                let mut numbers: BTreeMap<[i64; 2], u32> = (0_u32..)
                    .zip(&lattice.cells)
                    .map(|(node, cell)| (cell.map(i64::from), node))
                    .collect();
                for [i, j] in squares_beside(facets, lattice, given) {
                    let corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]].map(|place| {
                        *numbers.entry(place).or_insert_with(|| {
                            places.push(at(lattice, place.map(|index| index as f64)));
                            (mesh.len() + places.len() - 1) as u32
                        })
                    });
                    add(&corners);
                }
                Edge::Carried(Carried::rings(mesh, given))
            }
        };
        let beside = Carried::new(mesh, places);
        let nodes = mesh.len();
        let mut skin = Self {
            nodes,
            beside,
            rings,
            triangles,
            sides: Vec::new(),
            ends: Vec::new(),
            rim: Vec::new(),
        };
        skin.join();
        skin
    }

    /// Numbers the sides of the triangles and orders those of the rim.
    fn join(&mut self) {
        let mut numbers: BTreeMap<[u32; 2], u32> = BTreeMap::new();
        // Number of times a side runs from its lower end, minus the number of times it runs the
        // other way.
        let mut runs: Vec<i32> = Vec::new();
        for corners in &self.triangles {
            let sides = [0, 1, 2].map(|k: usize| {
                let (a, b) = (corners[k], corners[(k + 1) % 3]);
                let side = *numbers.entry([a.min(b), a.max(b)]).or_insert_with(|| {
                    self.ends.push([a.min(b), a.max(b)]);
                    runs.push(0);
                    (runs.len() - 1) as u32
                });
                runs[side as usize] += if a < b { 1 } else { -1 };
                side
            });
            self.sides.push(sides);
        }
        let mut from: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (side, &run) in runs.iter().enumerate().filter(|(_, run)| **run != 0) {
            let start = self.ends[side][usize::from(run < 0)];
            from.entry(start).or_default().push(self.rim.len());
            self.rim.push((side as u32, run > 0, NONE));
        }
        for index in 0..self.rim.len() {
            let (side, ahead, _) = self.rim[index];
            let end = self.ends[side as usize][usize::from(ahead)];
            // If two rims meet in a point, each side is used once, in any order.
            if let Some(next) = from.get_mut(&end).and_then(Vec::pop) {
                self.rim[index].2 = next as u32;
            }
        }
    }

    /// The outline for nodes at `positions`.
    pub(super) fn rings(&self, positions: &[Vec<f64>; 2]) -> Rings {
        match &self.rings {
            Edge::Carried(rings) => rings.iter().map(|ring| ring.at(positions)).collect(),
            Edge::Nodes(rings) => {
                let place = |&node: &u32| [0, 1].map(|axis: usize| positions[axis][node as usize]);
                rings.iter().map(|ring| ring.iter().map(place).collect()).collect()
            }
        }
    }

    /// The skin for nodes at `positions` with `values`.
    pub(super) fn shaped(&self, positions: &[Vec<f64>; 2], values: &[f64]) -> Shaped<'_> {
        let mut points: Vec<[f64; 2]> =
            (0..self.nodes).map(|node| [0, 1].map(|axis: usize| positions[axis][node])).collect();
        points.extend(self.beside.at(positions));
        let mut values = values.to_vec();
        for point in 0..self.beside.len() {
            let parts = self.beside.weights(point);
            let near = parts.iter().map(|&(node, _)| values[node as usize]);
            let (low, high) = near.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| {
                (low.min(v), high.max(v))
            });
            let value: f64 = parts.iter().map(|&(node, part)| part * values[node as usize]).sum();
            // Extrapolated values stay within the range of the lattice.
            values.push(value.max(low).min(high));
        }
        Shaped { skin: self, points, values }
    }
}

/// Empty squares of the lattice's grid that the outline touches or contains.
fn squares_beside(facets: &[Facet], lattice: &Lattice, given: &Outline) -> BTreeSet<[i64; 2]> {
    let filled: BTreeSet<[i64; 2]> = facets
        .iter()
        .filter_map(|facet| {
            let places = facet.corners.iter().map(|&node| lattice.cells[node as usize]);
            places.reduce(|a, b| [a[0].min(b[0]), a[1].min(b[1])])
        })
        .map(|place| place.map(i64::from))
        .collect();
    let on_grid = |point: [f64; 2]| {
        [0, 1].map(|axis: usize| (point[axis] - lattice.origin[axis]) / lattice.spacing)
    };
    let mut touched = BTreeSet::new();
    // Crossings of the outline with the middle of each row of squares.
    let mut crossings: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for ring in given.rings() {
        for (&p, &q) in ring.iter().zip(ring.iter().cycle().skip(1)) {
            let (p, q) = (on_grid(p), on_grid(q));
            let way = [q[0] - p[0], q[1] - p[1]];
            let parts = (way[0].hypot(way[1]) / STEP).ceil().max(1.0);
            for part in 0..parts as usize {
                let part = part as f64 / parts;
                let [i, j] = [0, 1].map(|axis: usize| (p[axis] + part * way[axis]).floor() as i64);
                touched.extend((-1..=1).flat_map(|x| (-1..=1).map(move |y| [i + x, j + y])));
            }
            let rows = [p[1].min(q[1]), p[1].max(q[1])].map(|y| (y - 0.5).ceil() as i64);
            for row in rows[0]..rows[1] {
                let part = (row as f64 + 0.5 - p[1]) / way[1];
                crossings.entry(row).or_default().push(p[0] + part * way[0]);
            }
        }
    }
    for (row, mut places) in crossings {
        places.sort_by(f64::total_cmp);
        for inside in places.chunks_exact(2) {
            let [from, to] = [inside[0], inside[1]].map(|x| (x - 0.5).ceil() as i64);
            touched.extend((from..to).map(|column| [column, row]));
        }
    }
    touched.difference(&filled).copied().collect()
}

fn at(lattice: &Lattice, place: [f64; 2]) -> [f64; 2] {
    [0, 1].map(|axis: usize| lattice.origin[axis] + lattice.spacing * place[axis])
}

/// A skin in one shape, with values at its corners.
pub(super) struct Shaped<'a> {
    skin: &'a Skin,
    points: Vec<[f64; 2]>,
    values: Vec<f64>,
}

impl Shaped<'_> {
    /// Least and greatest value.
    pub(super) fn range(&self) -> [f64; 2] {
        self.values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], &value| {
            [low.min(value), high.max(value)]
        })
    }

    /// The area where the value is above `level`, as rings with the area on their left; values are
    /// interpolated linearly between corners.
    pub(super) fn above(&self, level: f64) -> Rings {
        let skin = self.skin;
        let is_above = |corner: u32| self.values[corner as usize] > level;
        // A ring is a list of crossed sides (their indices) and of rim corners (indices after those
        // of the sides).
        let sides = skin.ends.len();
        let mut next = vec![NONE; sides + skin.rim.len()];
        let mut starts = Vec::new();
        for (corners, sides) in skin.triangles.iter().zip(&skin.sides) {
            let above = corners.map(is_above);
            if above == [true; 3] || above == [false; 3] {
                continue;
            }
            let side =
                |from: bool| (0..3).find(|&k| above[k] == from && above[(k + 1) % 3] != from);
            if let (Some(out), Some(back)) = (side(true), side(false)) {
                next[sides[out] as usize] = sides[back];
                starts.push(sides[out]);
            }
        }
        for (index, &(side, ahead, following)) in skin.rim.iter().enumerate() {
            let ends = skin.ends[side as usize];
            let [start, end] = if ahead { ends } else { [ends[1], ends[0]] };
            let corner = (sides + index) as u32;
            let from = if is_above(start) { corner } else { side };
            let to = if is_above(end) { sides as u32 + following } else { side };
            if from != to && following != NONE {
                next[from as usize] = to;
                starts.push(from);
            }
        }
        let mut rings = Vec::new();
        for start in starts {
            let (mut ring, mut place) = (Vec::new(), start);
            while next[place as usize] != NONE {
                ring.push(self.place(place as usize, level));
                place = std::mem::replace(&mut next[place as usize], NONE);
            }
            if ring.len() > 2 {
                rings.push(ring);
            }
        }
        rings
    }

    /// Position at which a ring crosses a side, or of a rim corner.
    fn place(&self, number: usize, level: f64) -> [f64; 2] {
        let skin = self.skin;
        let Some(ends) = skin.ends.get(number) else {
            let (side, ahead, _) = skin.rim[number - skin.ends.len()];
            return self.points[skin.ends[side as usize][usize::from(!ahead)] as usize];
        };
        let [a, b] = ends.map(|corner| self.values[corner as usize]);
        let [p, q] = ends.map(|corner| self.points[corner as usize]);
        let part = (level - a) / (b - a);
        [0, 1].map(|axis: usize| p[axis] + part * (q[axis] - p[axis]))
    }
}

#[cfg(test)]
mod tests {
    use super::super::facets::facets;
    use super::*;
    use myospring_core::mesh::lattice;

    fn area(rings: &Rings) -> f64 {
        let of = |ring: &Vec<[f64; 2]>| -> f64 {
            let next = ring.iter().cycle().skip(1);
            ring.iter().zip(next).map(|(p, q)| 0.5 * (p[0] * q[1] - p[1] * q[0])).sum()
        };
        rings.iter().map(of).sum()
    }

    fn disc(radius: f64, hole: f64) -> Outline {
        let ring = |radius: f64| {
            let corner = |k| {
                let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / 180.0).sin_cos();
                [radius * cos, radius * sin]
            };
            (0..180).map(corner).collect::<Vec<[f64; 2]>>()
        };
        Outline::new(ring(radius), vec![ring(hole)]).unwrap()
    }

    /// The area of triangles of the skin that hold no part of it twice.
    fn covered(skin: &Skin, points: &[[f64; 2]]) -> f64 {
        let of = |corners: &[u32; 3]| area(&vec![corners.map(|c| points[c as usize]).to_vec()]);
        skin.triangles.iter().map(of).sum()
    }

    #[test]
    fn the_skin_reaches_beyond_the_outline_and_into_its_holes() {
        let given = disc(20.0, 6.0);
        let (mesh, _) = lattice::from_outline(&given, Some(1.5)).unwrap();
        let skin = Skin::new(&mesh, &facets(&mesh), Some(&given));
        let x: Vec<f64> = mesh.points[0].clone();
        let shaped = skin.shaped(&mesh.points, &x);
        // At rest the outline is the given one, and the skin is larger on both sides.
        assert!((area(&skin.rings(&mesh.points)) - given.area()).abs() < 1e-9);
        let whole = covered(&skin, &shaped.points);
        assert!(whole > given.area() && whole < given.area() * 1.6, "{whole}");
        assert!((area(&shaped.above(-1e9)) - whole).abs() < 1e-9);
        assert!(shaped.above(1e9).is_empty());
        for ring in given.rings() {
            for p in ring {
                let within = skin.triangles.iter().any(|corners| {
                    let [a, b, c] = corners.map(|corner| shaped.points[corner as usize]);
                    [(a, b), (b, c), (c, a)]
                        .into_iter()
                        .all(|(a, b)| area(&vec![vec![*p, a, b]]) >= -1e-9)
                });
                assert!(within, "{p:?} is bare");
            }
        }
    }

    #[test]
    fn a_linear_field_is_parted_along_straight_lines() {
        let given = disc(20.0, 6.0);
        let (mesh, _) = lattice::from_outline(&given, Some(1.5)).unwrap();
        let skin = Skin::new(&mesh, &facets(&mesh), Some(&given));
        let values: Vec<f64> = mesh.points[0].iter().map(|x| 2.0 * x + 1.0).collect();
        let shaped = skin.shaped(&mesh.points, &values);
        let mut left = covered(&skin, &shaped.points);
        for level in [-20.0, -3.3, 1.0, 12.5] {
            let rings = shaped.above(level);
            let cut = (level - 1.0) / 2.0;
            assert!(rings.iter().flatten().all(|p| p[0] > cut - 1e-9), "{level}");
            let right = area(&rings);
            assert!(right < left, "{level}: {right} of {left}");
            left = right;
        }
    }

    #[test]
    fn bands_add_up_whatever_the_field() {
        let mesh = lattice::rectangle(12, 9, 1.0).unwrap();
        let skin = Skin::new(&mesh, &facets(&mesh), None);
        let value = |[x, y]: [f64; 2]| (1.3 * x).sin() * (1.7 * y).cos() + 0.1 * x;
        let values: Vec<f64> = (0..mesh.len()).map(|node| value(mesh.point(node))).collect();
        let shaped = skin.shaped(&mesh.points, &values);
        // The mean over the cell, of a function that is linear in each triangle, is the integral of the area above
        // a level; by the midpoints of 4000 levels.
        let [low, high] = shaped.range();
        let step = (high - low) / 4000.0;
        let levels = (0..4000).map(|k| low + (f64::from(k) + 0.5) * step);
        let sum: f64 = levels.map(|level| step * area(&shaped.above(level))).sum();
        let exact: f64 = skin
            .triangles
            .iter()
            .map(|corners| corners.iter().map(|&c| values[c as usize] - low).sum::<f64>() / 6.0)
            .sum();
        // Second order in the step.
        assert!((sum / exact - 1.0).abs() < 1e-5, "{sum} {exact}");
    }
}
