//! Sections of a thick cell: upright planes through its middle, along its long axis and across it.
//!
//! A section is a grid that fits into the surface: stations along it, and on each the same number of points from the lower to the upper
//! side. The lower and the upper end of a station lie on the drawn surface and move with it, the points between them lie evenly on the
//! line that joins them. The value at a point is interpolated from the mesh at
//! its resting place. Where an upright line leaves the cell and enters it again, as at an overhang or a cavity, the section is drawn closed.

use crate::figure::{Between, cut_surface};
use crate::surface::{SmoothSurface, unit};
use myospring_core::mesh::Mesh;
use std::collections::BTreeMap;

/// Fewest and most stations of a section, and points of a station.
const STATIONS: [f64; 2] = [20.0, 72.0];
const LAYERS: [f64; 2] = [3.0, 9.0];

/// A place on the surface: the sum of four of its points, with these weights.
type Place = ([u32; 4], [f32; 4]);

/// What a point has: the sum of what some nodes of the mesh have, with these weights.
type Share = Vec<(u32, f64)>;

/// The parts of the cell in one plane; a bent cell has several.
#[derive(Debug)]
pub(super) struct Section {
    pub(super) parts: Vec<Part>,
}

/// One grid.
#[derive(Debug)]
pub(super) struct Part {
    /// Points of each station, from the lower to the upper side.
    pub(super) layers: usize,
    /// The lower and the upper end of each station in turn.
    pub(super) ends: Vec<Place>,
    /// Of each point, station by station.
    shares: Vec<Share>,
}

impl Part {
    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.shares.len()
    }

    /// The value at each point, station by station, from those of the nodes.
    pub(super) fn values<'a>(&'a self, nodes: &'a [f64]) -> impl Iterator<Item = f64> + 'a {
        let of =
            |share: &Share| share.iter().map(|&(node, part)| part * nodes[node as usize]).sum();
        self.shares.iter().map(of)
    }
}

/// The sections along and across the long axis of a cell that is drawn with this surface.
pub(super) fn both(
    mesh: &Mesh<3, 4>,
    surface: &SmoothSurface,
    long_axis: [f64; 2],
) -> [Section; 2] {
    let rest = surface.positions(&mesh.points);
    let middle = [0, 1].map(|axis: usize| {
        let ends = rest.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], point| {
            [low.min(point[axis]), high.max(point[axis])]
        });
        f64::midpoint(ends[0], ends[1])
    });
    let [x, y] = unit(long_axis);
    let nearby = Nearby::new(mesh);
    // Each to the right of who looks at it: from the side, from the end at the back.
    [[x, y], [y, -x]].map(|within| {
        let along = |[a, b, _]: [f64; 3]| within[0] * (a - middle[0]) + within[1] * (b - middle[1]);
        let heights: Vec<f64> = rest
            .iter()
            .map(|[a, b, _]| within[0] * (b - middle[1]) - within[1] * (a - middle[0]))
            .collect();
        let rings = cut_surface(surface, &heights);
        let parts = rings.iter().filter_map(|ring| {
            let seen: Vec<[f64; 2]> = ring
                .iter()
                .map(|place| {
                    let point = [0, 1, 2].map(|axis| place.of(|at| rest[at][axis]));
                    [along(point), point[2]]
                })
                .collect();
            let at = |[s, z]: [f64; 2]| [middle[0] + s * within[0], middle[1] + s * within[1], z];
            part(ring, &seen, surface.spacing(), |place| nearby.share(at(place)))
        });
        Section { parts: parts.collect() }
    })
}

/// The grid within a ring whose places are seen at `seen`, along the section and upward.
fn part(
    ring: &[Between],
    seen: &[[f64; 2]],
    spacing: f64,
    share: impl Fn([f64; 2]) -> Share,
) -> Option<Part> {
    let extent = |axis: usize| {
        seen.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
            [low.min(place[axis]), high.max(place[axis])]
        })
    };
    let ([left, right], [low, high]) = (extent(0), extent(1));
    if !(right > left && high > low) {
        return None;
    }
    let stations = ((right - left) / spacing).ceil().clamp(STATIONS[0], STATIONS[1]) as usize;
    let layers = ((high - low) / spacing + 1.0).ceil().clamp(LAYERS[0], LAYERS[1]) as usize;
    let (mut ends, mut shares) = (Vec::new(), Vec::new());
    for station in 0..=stations {
        // Closer to each other towards both ends, which are round.
        let turn = std::f64::consts::PI * station as f64 / stations as f64;
        let s = f64::midpoint(left, right) - 0.5 * (right - left) * turn.cos();
        let s = s.clamp(left, right);
        let sides = (0..ring.len()).filter_map(|first| {
            let second = (first + 1) % ring.len();
            let [from, to] = [seen[first], seen[second]];
            if !(from[0].min(to[0]) <= s && s <= from[0].max(to[0])) {
                return None;
            }
            let way = to[0] - from[0];
            let part = if way == 0.0 { 0.0 } else { (s - from[0]) / way };
            Some((from[1] + part * (to[1] - from[1]), [first, second], part))
        });
        let sides: Vec<(f64, [usize; 2], f64)> = sides.collect();
        let lowest = sides.iter().min_by(|a, b| a.0.total_cmp(&b.0));
        let highest = sides.iter().max_by(|a, b| a.0.total_cmp(&b.0));
        let (below, above) = lowest.zip(highest)?;
        ends.extend([below, above].map(|&(_, [first, second], part)| {
            let ([a, b], [c, d]) = (ring[first].weights(), ring[second].weights());
            let weighted = |(_, weight): (u32, f64), part: f64| (weight * part) as f32;
            (
                [a.0, b.0, c.0, d.0],
                [
                    weighted(a, 1.0 - part),
                    weighted(b, 1.0 - part),
                    weighted(c, part),
                    weighted(d, part),
                ],
            )
        }));
        shares.extend((0..layers).map(|layer| {
            let part = layer as f64 / (layers - 1) as f64;
            share([s, below.0 + part * (above.0 - below.0)])
        }));
    }
    Some(Part { layers, ends, shares })
}

/// The nodes of a lattice by their places in it.
struct Nearby<'a> {
    mesh: &'a Mesh<3, 4>,
    nodes: BTreeMap<[i64; 3], u32>,
}

impl<'a> Nearby<'a> {
    fn new(mesh: &'a Mesh<3, 4>) -> Self {
        let places = mesh.lattice.iter().flat_map(|lattice| &lattice.cells);
        Self { mesh, nodes: places.map(|place| place.map(i64::from)).zip(0..).collect() }
    }

    /// What a point has of the nodes around it: of those of its cube that there are, or of the nearest one, since the surface lies
    /// beyond the cubes here and there.
    fn share(&self, point: [f64; 3]) -> Share {
        let Some(lattice) = &self.mesh.lattice else { return Vec::new() };
        let place: [f64; 3] =
            std::array::from_fn(|axis| (point[axis] - lattice.origin[axis]) / lattice.spacing);
        let cube = place.map(f64::floor);
        let corners = (0..8).filter_map(|corner| {
            let side: [f64; 3] = std::array::from_fn(|axis| f64::from(corner >> axis & 1));
            let weight: f64 = (0..3)
                .map(|axis| {
                    let part = place[axis] - cube[axis];
                    if side[axis] == 1.0 { part } else { 1.0 - part }
                })
                .product();
            let at = std::array::from_fn(|axis| (cube[axis] + side[axis]) as i64);
            Some((*self.nodes.get(&at)?, weight))
        });
        let mut share: Share = corners.filter(|(_, weight)| *weight > 0.0).collect();
        let whole: f64 = share.iter().map(|(_, weight)| weight).sum();
        if whole < 1e-6 {
            let square = |node: usize| {
                (0..3).map(|axis| (self.mesh.points[axis][node] - point[axis]).powi(2)).sum::<f64>()
            };
            let nearest = (0..self.mesh.len()).min_by(|a, b| square(*a).total_cmp(&square(*b)));
            return nearest.map(|node| (node as u32, 1.0)).into_iter().collect();
        }
        for (_, weight) in &mut share {
            *weight /= whole;
        }
        share
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use myospring_core::mesh::cubes;

    /// Where the points of a grid are, from the surface's points.
    fn points(part: &Part, surface: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let place = |(ends, weights): &Place| -> [f64; 3] {
            std::array::from_fn(|axis| {
                let weighted = ends.iter().zip(weights);
                weighted.map(|(&at, &part)| f64::from(part) * surface[at as usize][axis]).sum()
            })
        };
        let stations = part.ends.chunks(2).map(|ends| [place(&ends[0]), place(&ends[1])]);
        let layers = part.layers;
        let between = |[low, high]: [[f64; 3]; 2]| {
            (0..layers).map(move |layer| {
                let part = layer as f64 / (layers - 1) as f64;
                std::array::from_fn(|axis| low[axis] + part * (high[axis] - low[axis]))
            })
        };
        stations.flat_map(between).collect()
    }

    #[test]
    fn a_section_of_a_block_lies_in_its_plane_and_has_the_values_there() {
        for (coarser, long_axis) in [(1, [1.0, 0.0]), (2, [0.8, 0.6])] {
            let mesh = cubes::block([24, 8, 4], 2.0).unwrap();
            let surface = SmoothSurface::new(&mesh).unwrap().coarser(coarser);
            let rest = surface.positions(&mesh.points);
            let slanted: Vec<f64> = (0..mesh.len())
                .map(|node| mesh.points[0][node] + 3.0 * mesh.points[2][node])
                .collect();
            let sections = both(&mesh, &surface, long_axis);
            for (section, normal) in sections.iter().zip([[-0.6, 0.8], [0.8, 0.6]]) {
                assert_eq!(section.parts.len(), 1);
                let part = &section.parts[0];
                let points = points(part, &rest);
                assert_eq!(points.len(), part.values(&slanted).count());
                for (point, value) in points.iter().zip(part.values(&slanted)) {
                    if coarser == 2 {
                        let [x, y] = [0, 1].map(|axis: usize| point[axis] - points[0][axis]);
                        assert!((normal[0] * x + normal[1] * y).abs() < 1e-4, "{point:?}");
                    }
                    // Beyond the cubes, by less than one, it is the value of their face.
                    let expected = point[0] + 3.0 * point[2];
                    assert!((value - expected).abs() < 8.0 * 0.6, "{point:?}: {value}");
                }
            }
            let area = |part: &Part| {
                let points = points(part, &rest);
                let rows: Vec<&[[f64; 3]]> = points.chunks(part.layers).collect();
                rows.windows(2)
                    .map(|pair| {
                        let wide =
                            (pair[1][0][0] - pair[0][0][0]).hypot(pair[1][0][1] - pair[0][0][1]);
                        let high = |row: &[[f64; 3]]| row[part.layers - 1][2] - row[0][2];
                        wide * f64::midpoint(high(pair[0]), high(pair[1]))
                    })
                    .sum::<f64>()
            };
            if coarser == 1 {
                for (section, whole) in sections.iter().zip([48.0 * 8.0, 16.0 * 8.0]) {
                    let found = area(&section.parts[0]);
                    assert!((found / whole - 1.0).abs() < 0.1, "{found} of {whole}");
                }
            }
        }
    }
}
