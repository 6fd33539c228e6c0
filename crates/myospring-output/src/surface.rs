//! The surface of a thick cell as it is drawn: without the steps of its cubes.
//!
//! Its points are nodes of the mesh, or the means of neighbouring nodes. They are smoothed by
//! Taubin's filter (1995, "A signal processing approach to fair surface design"), which takes away
//! steps of one cube and leaves length, width and thickness. The filter is linear in the positions
//! and the same in every frame, so a cell that is deformed evenly is drawn deformed evenly.

use myospring_core::mesh::{Mesh, surface};
use std::collections::{BTreeMap, BTreeSet};

/// Passes of the filter, and its two factors: one that shrinks, one that swells back.
const PASSES: usize = 24;
const FACTORS: [f64; 2] = [0.5, -0.53];

/// A smooth closed surface that moves with the nodes of a mesh.
#[derive(Debug, Clone)]
pub(crate) struct SmoothSurface {
    spacing: f64,
    /// Nodes of the mesh whose mean each point is.
    groups: Vec<Vec<u32>>,
    /// Column, row and layer of each point in the lattice.
    places: Vec<[u32; 3]>,
    /// Corners of each patch, counter-clockwise seen from outside; the last two of a triangle are one.
    quads: Vec<[u32; 4]>,
    /// Points on the other ends of the sides that end at each point.
    beside: Vec<Vec<u32>>,
}

impl SmoothSurface {
    /// The surface of the cubes of a checked mesh; `None` of a mesh without cubes.
    pub(crate) fn new(mesh: &Mesh<3, 4>) -> Option<Self> {
        let faces = surface::quads(mesh);
        let lattice = mesh.lattice.as_ref().filter(|_| !faces.is_empty())?;
        let nodes: BTreeSet<u32> = faces.iter().flatten().copied().collect();
        let number: BTreeMap<u32, u32> = nodes.iter().copied().zip(0..).collect();
        let quads = faces.iter().map(|face| face.map(|node| number[&node])).collect();
        let places = nodes.iter().map(|&node| lattice.cells[node as usize]).collect();
        let groups = nodes.into_iter().map(|node| vec![node]).collect();
        Some(Self::made(lattice.spacing, groups, places, quads))
    }

    /// The same surface with one point for all that lie in the same block of `by` places along each axis.
    pub(crate) fn coarser(&self, by: u32) -> Self {
        let mut blocks: BTreeMap<[u32; 3], u32> = BTreeMap::new();
        let (mut groups, mut places) = (Vec::new(), Vec::new());
        let mut block_of = Vec::new();
        for (group, place) in self.groups.iter().zip(&self.places) {
            let block = place.map(|along| along / by.max(1));
            let index = *blocks.entry(block).or_insert_with(|| {
                groups.push(Vec::new());
                places.push(block);
                groups.len() as u32 - 1
            });
            groups[index as usize].extend(group);
            block_of.push(index);
        }
        let mut seen = BTreeSet::new();
        let drawn = self.quads.iter().filter_map(|quad| {
            let mut corners = quad.map(|point| block_of[point as usize]).to_vec();
            corners.dedup();
            if corners.first() == corners.last() {
                corners.pop();
            }
            let first = (0..corners.len()).min_by_key(|&at| corners[at])?;
            corners.rotate_left(first);
            // What has shrunk to a line is not seen; a corner that comes twice is two triangles without area.
            let quad = match corners[..] {
                [a, b, c] => [a, b, c, c],
                [a, b, c, d] if a != c && b != d => [a, b, c, d],
                _ => return None,
            };
            seen.insert(quad).then_some(quad)
        });
        let quads = drawn.collect();
        Self::made(self.spacing * f64::from(by), groups, places, quads)
    }

    fn made(
        spacing: f64,
        groups: Vec<Vec<u32>>,
        places: Vec<[u32; 3]>,
        quads: Vec<[u32; 4]>,
    ) -> Self {
        let mut beside: Vec<BTreeSet<u32>> = vec![BTreeSet::new(); groups.len()];
        for quad in &quads {
            for (at, &a) in quad.iter().enumerate() {
                let b = quad[(at + 1) % 4];
                if a != b {
                    beside[a as usize].insert(b);
                    beside[b as usize].insert(a);
                }
            }
        }
        let beside = beside.into_iter().map(|points| points.into_iter().collect()).collect();
        Self { spacing, groups, places, quads, beside }
    }

    /// Number of points.
    pub(crate) fn len(&self) -> usize {
        self.groups.len()
    }

    /// Side of a patch, um.
    pub(crate) fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Corners of each patch, counter-clockwise seen from outside; the last two of a triangle are one.
    pub(crate) fn quads(&self) -> &[[u32; 4]] {
        &self.quads
    }

    /// The points for these positions of the nodes, um, without steps.
    pub(crate) fn positions(&self, nodes: &[Vec<f64>; 3]) -> Vec<[f64; 3]> {
        let axes = nodes.each_ref().map(|axis| self.means(axis));
        let mut points: Vec<[f64; 3]> =
            (0..self.len()).map(|point| axes.each_ref().map(|axis| axis[point])).collect();
        for factor in [FACTORS; PASSES].concat() {
            points = self.filtered(&points, factor);
        }
        points
    }

    /// The mean over the nodes of each point.
    pub(crate) fn means(&self, values: &[f64]) -> Vec<f64> {
        let mean = |group: &Vec<u32>| {
            let sum: f64 = group.iter().map(|&node| values[node as usize]).sum();
            sum / group.len() as f64
        };
        self.groups.iter().map(mean).collect()
    }

    /// Each point moved by a part of its way to the mean of those beside it.
    fn filtered(&self, points: &[[f64; 3]], factor: f64) -> Vec<[f64; 3]> {
        let of = |(point, beside): (&[f64; 3], &Vec<u32>)| {
            if beside.is_empty() {
                return *point;
            }
            std::array::from_fn(|axis| {
                let sum: f64 = beside.iter().map(|&other| points[other as usize][axis]).sum();
                point[axis] + factor * (sum / beside.len() as f64 - point[axis])
            })
        };
        points.iter().zip(&self.beside).map(of).collect()
    }
}

/// Extents along the long axis, across it seen from above, and upward, um.
pub(crate) fn extents(positions: &[Vec<f64>; 3], long_axis: [f64; 2]) -> [f64; 3] {
    let [xs, ys, zs] = positions;
    let [x, y] = unit(long_axis);
    let extent = |values: &mut dyn Iterator<Item = f64>| {
        let ends = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = values.fold(ends, |[low, high], at| [low.min(at), high.max(at)]);
        (high - low).max(0.0)
    };
    let points = || xs.iter().zip(ys);
    [
        extent(&mut points().map(|(a, b)| x * a + y * b)),
        extent(&mut points().map(|(a, b)| x * b - y * a)),
        extent(&mut zs.iter().copied()),
    ]
}

/// The unit vector of a direction; x where it has none.
pub(crate) fn unit([x, y]: [f64; 2]) -> [f64; 2] {
    let length = x.hypot(y);
    if length.is_finite() && length > 0.0 { [x / length, y / length] } else { [1.0, 0.0] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::cubes;

    fn box_of(points: &[[f64; 3]]) -> [f64; 3] {
        let axes = [0, 1, 2].map(|axis: usize| points.iter().map(|point| point[axis]).collect());
        extents(&axes, [1.0, 0.0])
    }

    /// Volume within patches, um^3.
    fn volume(surface: &SmoothSurface, points: &[[f64; 3]]) -> f64 {
        let sixth = |[a, b, c]: [[f64; 3]; 3]| {
            (a[0] * (b[1] * c[2] - b[2] * c[1])
                + a[1] * (b[2] * c[0] - b[0] * c[2])
                + a[2] * (b[0] * c[1] - b[1] * c[0]))
                / 6.0
        };
        let of = |quad: &[u32; 4]| {
            let [a, b, c, d] = quad.map(|point| points[point as usize]);
            sixth([a, b, c]) + sixth([a, c, d])
        };
        surface.quads().iter().map(of).sum()
    }

    #[test]
    fn smoothing_leaves_size_and_volume_but_for_the_rims() {
        for cubes in [[20, 8, 4], [40, 10, 6], [12, 12, 12]] {
            for spacing in [0.5, 2.0] {
                let mesh = cubes::block(cubes, spacing).unwrap();
                let surface = SmoothSurface::new(&mesh).unwrap();
                let points = surface.positions(&mesh.points);
                for (found, cubes) in box_of(&points).into_iter().zip(cubes) {
                    let whole = cubes as f64 * spacing;
                    assert!((found - whole).abs() < 0.5 * spacing, "{found} of {whole}");
                }
                let part = volume(&surface, &points) / mesh.area();
                assert!((part - 1.0).abs() < 0.1, "{cubes:?}: {part}");
            }
        }
    }

    #[test]
    fn an_even_deformation_stays_even() {
        let mesh = cubes::block([9, 4, 3], 2.0).unwrap();
        let stretches = [0.88, 1.06, 1.07];
        let moved = [0, 1, 2].map(|axis: usize| {
            mesh.points[axis].iter().map(|x| stretches[axis] * x + 3.0).collect()
        });
        for by in [1, 2, 3] {
            let surface = SmoothSurface::new(&mesh).unwrap().coarser(by);
            let (rest, now) = (surface.positions(&mesh.points), surface.positions(&moved));
            for (rest, now) in rest.iter().zip(&now) {
                for axis in 0..3 {
                    assert!((stretches[axis] * rest[axis] + 3.0 - now[axis]).abs() < 1e-12);
                }
            }
        }
    }

    #[test]
    fn a_coarser_surface_has_fewer_points_and_nearly_the_same_volume() {
        let mesh = cubes::block([60, 16, 12], 1.0).unwrap();
        let finest = SmoothSurface::new(&mesh).unwrap();
        let mut points = finest.len();
        for by in [2, 3, 4] {
            let surface = finest.coarser(by);
            assert!(surface.len() < points);
            points = surface.len();
            let part = volume(&surface, &surface.positions(&mesh.points)) / mesh.area();
            assert!((0.7..1.05).contains(&part), "{by}: {part}");
        }
    }
}
