//! Lines around a thick cell and sections through it.

use crate::surface::SmoothSurface;
use geo::{Polygon, unary_union};
use myospring_core::mesh::Mesh;
use std::collections::BTreeMap;

use super::facets::facets;

/// A place between two points: their numbers, and how far it is from the first to the second.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Between {
    ends: [u32; 2],
    part: f64,
}

impl Between {
    /// Where a plane, which is 0 there, cuts the line between two points with these heights above it.
    fn cut(ends: [u32; 2], heights: [f64; 2]) -> Self {
        Self { ends, part: heights[0] / (heights[0] - heights[1]) }
    }

    /// The value there, from those of all points.
    pub(crate) fn of(self, value: impl Fn(usize) -> f64) -> f64 {
        let [a, b] = self.ends.map(|end| value(end as usize));
        a + self.part * (b - a)
    }

    /// The two points, and what the place has of each.
    pub(crate) fn weights(self) -> [(u32, f64); 2] {
        [(self.ends[0], 1.0 - self.part), (self.ends[1], self.part)]
    }
}

/// The lines in which a surface is cut: rings of places on it. `heights` are those of its points above the plane.
pub(crate) fn cut_surface(surface: &SmoothSurface, heights: &[f64]) -> Vec<Vec<Between>> {
    let mut sides = Vec::new();
    for [a, b, c, d] in surface.quads() {
        for triangle in [[a, b, c], [a, c, d]] {
            let ends = [[0, 1], [1, 2], [2, 0]].map(|pair| pair.map(|at: usize| *triangle[at]));
            let cuts: Vec<[u32; 2]> = ends
                .into_iter()
                .filter(|[a, b]| (heights[*a as usize] > 0.0) != (heights[*b as usize] > 0.0))
                .map(|[a, b]| [a.min(b), a.max(b)])
                .collect();
            if let [from, to] = cuts[..] {
                sides.push([from, to]);
            }
        }
    }
    let place = |ends: [u32; 2]| Between::cut(ends, ends.map(|end| heights[end as usize]));
    rings(&sides).into_iter().map(|ring| ring.into_iter().map(place).collect()).collect()
}

/// The polygons in which the cells of a mesh are cut, without overlap. `heights` are those of its nodes above the plane.
pub(super) fn cut_mesh(mesh: &Mesh<3, 4>, heights: &[f64]) -> Vec<Vec<Between>> {
    let mut polygons = Vec::new();
    for facet in facets(mesh) {
        // Of the ten tetrahedra of a cube the first five fill it.
        let filling = if facet.simplices.len() == 10 { 5 } else { facet.simplices.len() };
        for &index in &facet.simplices[..filling] {
            let nodes = mesh.simplices[index].nodes;
            let (above, below): (Vec<u32>, Vec<u32>) =
                nodes.iter().partition(|&&node| heights[node as usize] > 0.0);
            let cut =
                |a: u32, b: u32| Between::cut([a, b], [a, b].map(|end| heights[end as usize]));
            match (&above[..], &below[..]) {
                (&[a, b], &[c, d]) => {
                    polygons.push(vec![cut(a, c), cut(a, d), cut(b, d), cut(b, c)]);
                }
                (&[a], others) | (others, &[a]) => {
                    polygons.push(others.iter().map(|&other| cut(a, other)).collect());
                }
                _ => {}
            }
        }
    }
    polygons
}

/// The outermost line around a surface as it is seen: that around all of its patches together. `at` gives where a point is seen.
pub(super) fn silhouette(surface: &SmoothSurface, at: impl Fn(u32) -> [f64; 2]) -> Vec<[f64; 2]> {
    let halves = surface.quads().iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    let seen = halves.map(|corners| corners.map(&at)).filter(|ring| area(ring) != 0.0);
    let patches: Vec<Polygon> = seen
        .map(|mut ring| {
            // All one way round, whichever side faces the viewer.
            if area(&ring) < 0.0 {
                ring.reverse();
            }
            Polygon::new(ring.into_iter().collect(), Vec::new())
        })
        .collect();
    let rings = unary_union(&patches).into_iter().map(|polygon| {
        let (line, _) = polygon.into_inner();
        line.into_iter().map(|place| [place.x, place.y]).collect::<Vec<_>>()
    });
    rings.max_by(|a, b| area(a).abs().total_cmp(&area(b).abs())).unwrap_or_default()
}

/// Area within a ring, positive if it runs counter-clockwise.
pub(super) fn area(ring: &[[f64; 2]]) -> f64 {
    let following = ring.iter().cycle().skip(1);
    ring.iter().zip(following).map(|(a, b)| 0.5 * (a[0] * b[1] - a[1] * b[0])).sum()
}

/// Chains sides that share ends into rings.
fn rings<K: Ord + Copy>(sides: &[[K; 2]]) -> Vec<Vec<K>> {
    let mut beside: BTreeMap<K, Vec<K>> = BTreeMap::new();
    for &[a, b] in sides {
        beside.entry(a).or_default().push(b);
        beside.entry(b).or_default().push(a);
    }
    let mut rings = Vec::new();
    while let Some((&start, _)) = beside.first_key_value() {
        let (mut ring, mut at) = (vec![start], start);
        while let Some(next) = beside.get_mut(&at).and_then(Vec::pop) {
            if let Some(back) = beside.get_mut(&next)
                && let Some(place) = back.iter().position(|&other| other == at)
            {
                back.swap_remove(place);
            }
            if next == start {
                break;
            }
            ring.push(next);
            at = next;
        }
        beside.retain(|_, others| !others.is_empty());
        rings.push(ring);
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::cubes;

    #[test]
    fn a_section_of_a_block_has_its_area_whatever_the_plane() {
        let mesh = cubes::block([6, 4, 3], 2.0).unwrap();
        for (axis, expected) in [(0, 8.0 * 6.0), (1, 12.0 * 6.0), (2, 12.0 * 8.0)] {
            for level in [0.1, 2.0 + 1e-7, 3.3] {
                let heights: Vec<f64> = mesh.points[axis].iter().map(|x| x - level).collect();
                let others = [(axis + 1) % 3, (axis + 2) % 3];
                let place =
                    |point: &Between| others.map(|axis| point.of(|node| mesh.points[axis][node]));
                let polygons = cut_mesh(&mesh, &heights);
                let of = |polygon: &Vec<Between>| {
                    area(&polygon.iter().map(place).collect::<Vec<_>>()).abs()
                };
                let found: f64 = polygons.iter().map(of).sum();
                assert!((found - expected).abs() < 1e-4, "{axis}, {level}: {found}");
            }
        }
    }

    #[test]
    fn a_cut_surface_and_a_silhouette_are_one_ring_of_nearly_the_blocks_size() {
        let mesh = cubes::block([20, 8, 6], 2.0).unwrap();
        let surface = SmoothSurface::new(&mesh).unwrap();
        let points = surface.positions(&mesh.points);
        let heights: Vec<f64> = points.iter().map(|point| point[0] - 20.1).collect();
        let rings = cut_surface(&surface, &heights);
        assert_eq!(rings.len(), 1);
        let ring: Vec<[f64; 2]> = rings[0]
            .iter()
            .map(|place| [1, 2].map(|axis: usize| place.of(|point| points[point][axis])))
            .collect();
        assert!((area(&ring).abs() / (16.0 * 12.0) - 1.0).abs() < 0.1);
        let at = |point: u32| [points[point as usize][0], points[point as usize][1]];
        let seen = silhouette(&surface, at);
        assert!((area(&seen).abs() / (40.0 * 16.0) - 1.0).abs() < 0.05);
        // Nothing is seen outside of it, however the surface is folded.
        let folded = |point: u32| {
            let [x, y, z] = points[point as usize];
            [x + 3.0 * (0.4 * z).sin(), y + 0.3 * z + 2.0 * (0.3 * x).sin()]
        };
        let seen = silhouette(&surface, folded);
        for place in (0..points.len() as u32).map(folded) {
            let crossings = seen.windows(2).filter(|line| {
                let [a, b] = [line[0], line[1]];
                (a[1] > place[1]) != (b[1] > place[1])
                    && place[0] < a[0] + (b[0] - a[0]) * (place[1] - a[1]) / (b[1] - a[1])
            });
            let beside = seen.windows(2).any(|line| {
                let [a, b] = [line[0], line[1]];
                let along = [b[0] - a[0], b[1] - a[1]];
                let square = along[0].powi(2) + along[1].powi(2);
                let from = [place[0] - a[0], place[1] - a[1]];
                let part = ((from[0] * along[0] + from[1] * along[1]) / square).clamp(0.0, 1.0);
                (from[0] - part * along[0]).hypot(from[1] - part * along[1]) < 1e-6
            });
            assert!(beside || crossings.count() % 2 == 1, "{place:?}");
        }
    }
}
