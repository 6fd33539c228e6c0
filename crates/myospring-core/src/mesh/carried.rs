//! Points that move with a mesh: the cell's outline, landmarks of its picture.
//!
//! The mesh of a cell is made of lattice squares, whose rim is a staircase; the outline lies partly
//! inside and partly outside of it. Each of its points moves with the affine map that best fits the
//! nodes around it: moving least squares of first degree (`lancaster_1981`, Section 2), with a
//! weight that falls to 0 at a radius of two and a half spacings, wider outside of the mesh. So
//! uniform stretch, shear and rotation move the points exactly, neighbours stay neighbours, and
//! there is no seam between inside and outside.

use super::Mesh;
use super::outline::Outline;

/// Radius around a point inside the mesh whose nodes determine its motion, in spacings.
const REACH: f64 = 2.5;
/// Growth of the radius with the distance from the mesh: further outside, the motion is a mean over
/// more nodes.
const WIDENING: f64 = 2.0;
/// Least determinant of the nodes' covariance, in radii^4; with less they are collinear.
const FLAT: f64 = 1e-12;
/// Longest step between points of an outline, in spacings.
const STEP: f64 = 0.5;

/// Points that move with a mesh, each with a few of its nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Carried {
    /// Nodes and their weights, which sum to 1, point after point.
    weights: Vec<(u32, f64)>,
    /// End of each point's weights.
    ends: Vec<usize>,
}

impl Carried {
    /// Attaches points in or near a mesh at rest, um.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::carried::Carried;
    /// use myospring::mesh::lattice;
    /// let mesh = lattice::rectangle(20, 5, 2.0).unwrap();
    /// let carried = Carried::new(&mesh, [[-1.0, 5.0], [20.0, 11.0]]);
    /// // All of the cell becomes shorter by a tenth, what lies outside of it with it.
    /// let shorter = [mesh.points[0].iter().map(|x| 0.9 * x).collect(), mesh.points[1].clone()];
    /// let [left, top] = carried.at(&shorter)[..] else { panic!() };
    /// assert!((left[0] + 0.9).abs() < 1e-9 && (top[0] - 18.0).abs() < 1e-9 && (top[1] - 11.0).abs() < 1e-9);
    /// ```
    pub fn new(mesh: &Mesh, points: impl IntoIterator<Item = [f64; 2]>) -> Self {
        let nodes = Bins::new(mesh);
        let mut carried = Self { weights: Vec::new(), ends: Vec::new() };
        for point in points {
            nodes.add_weights(point, &mut carried.weights);
            carried.ends.push(carried.weights.len());
        }
        carried
    }

    /// The rings of an outline, the exterior first, with points at most half a spacing apart.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::carried::Carried;
    /// use myospring::mesh::{built_in, lattice};
    /// let outline = built_in::adult_ventricular();
    /// let (mesh, _) = lattice::from_outline(&outline, None).unwrap();
    /// let rings = Carried::rings(&mesh, &outline);
    /// assert_eq!(rings.len(), 1);
    /// assert!(rings[0].len() >= outline.exterior().len());
    /// ```
    pub fn rings(mesh: &Mesh, outline: &Outline) -> Vec<Self> {
        let longest = STEP * spacing(mesh);
        outline.rings().map(|ring| Self::new(mesh, divided(ring, longest))).collect()
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Whether there are no points.
    pub fn is_empty(&self) -> bool {
        self.ends.is_empty()
    }

    /// The nodes that determine the motion of a point, with their weights, which sum to 1; outside
    /// the mesh some are negative.
    pub fn weights(&self, point: usize) -> &[(u32, f64)] {
        let start = point.checked_sub(1).map_or(0, |before| self.ends[before]);
        &self.weights[start..self.ends[point]]
    }

    /// Positions of the points for nodes at `positions[axis][node]`, um.
    pub fn at(&self, positions: &[Vec<f64>; 2]) -> Vec<[f64; 2]> {
        let [xs, ys] = positions;
        let place = |point| {
            self.weights(point).iter().fold([0.0; 2], |[x, y], &(node, weight)| {
                [x + weight * xs[node as usize], y + weight * ys[node as usize]]
            })
        };
        (0..self.len()).map(place).collect()
    }
}

/// Distance between neighbouring nodes, um; for a mesh that is not a lattice, estimated as if it
/// were.
fn spacing(mesh: &Mesh) -> f64 {
    let mean = || (mesh.area() / mesh.len() as f64).sqrt();
    mesh.lattice.as_ref().map_or_else(mean, |lattice| lattice.spacing)
}

/// A ring with points added until none are further apart than `longest`.
fn divided(ring: &[[f64; 2]], longest: f64) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(ring.len());
    for (&from, &to) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        let way = [to[0] - from[0], to[1] - from[1]];
        let parts = (way[0].hypot(way[1]) / longest).ceil().max(1.0);
        points.extend((0..parts as usize).map(|part| {
            let part = part as f64 / parts;
            [from[0] + part * way[0], from[1] + part * way[1]]
        }));
    }
    points
}

/// Nodes sorted into squares, so that those near a point are found quickly.
struct Bins<'a> {
    mesh: &'a Mesh,
    spacing: f64,
    /// Side of a square, um.
    side: f64,
    low: [f64; 2],
    shape: [usize; 2],
    nodes: Vec<Vec<u32>>,
}

impl<'a> Bins<'a> {
    fn new(mesh: &'a Mesh) -> Self {
        let spacing = spacing(mesh);
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for axis in 0..2 {
            for &x in &mesh.points[axis] {
                low[axis] = low[axis].min(x);
                high[axis] = high[axis].max(x);
            }
        }
        // At most a few squares per node for any mesh.
        let box_area = (high[0] - low[0] + spacing) * (high[1] - low[1] + spacing);
        let side = (2.0 * spacing).max((box_area / (4.0 * mesh.len() as f64)).sqrt());
        let shape = [0, 1].map(|axis| ((high[axis] - low[axis]) / side) as usize + 1);
        let mut bins = Self { mesh, spacing, side, low, shape, nodes: Vec::new() };
        bins.nodes = vec![Vec::new(); shape[0] * shape[1]];
        for node in 0..mesh.len() {
            let [i, j] = bins.square(mesh.point(node));
            bins.nodes[j * shape[0] + i].push(node as u32);
        }
        bins
    }

    /// The square of a point, or the nearest one.
    fn square(&self, point: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|axis: usize| {
            let at = (point[axis] - self.low[axis]) / self.side;
            (at.max(0.0) as usize).min(self.shape[axis] - 1)
        })
    }

    /// Nodes within `radius` of a point, with the vectors to them.
    fn near(&self, point: [f64; 2], radius: f64) -> impl Iterator<Item = (u32, [f64; 2])> + '_ {
        let [first, last] = [-radius, radius].map(|by| self.square(point.map(|x| x + by)));
        (first[1]..=last[1])
            .flat_map(move |j| (first[0]..=last[0]).map(move |i| j * self.shape[0] + i))
            .flat_map(|square| self.nodes[square].iter().copied())
            .map(move |node| {
                let [x, y] = self.mesh.point(node as usize);
                (node, [x - point[0], y - point[1]])
            })
            .filter(move |(_, way)| way[0].hypot(way[1]) < radius)
    }

    /// The node nearest to a point, and its distance.
    fn nearest(&self, point: [f64; 2]) -> (u32, f64) {
        let mut radius = 2.0 * self.spacing;
        loop {
            let distances =
                self.near(point, radius).map(|(node, way)| (node, way[0].hypot(way[1])));
            if let Some(nearest) = distances.min_by(|a, b| a.1.total_cmp(&b.1)) {
                return nearest;
            }
            radius *= 2.0;
        }
    }

    /// Adds the nodes of a point with their weights: those of the nodes' values in the value, at
    /// the point, of the best-fitting affine function.
    fn add_weights(&self, point: [f64; 2], weights: &mut Vec<(u32, f64)>) {
        let (nearest, distance) = self.nearest(point);
        let mut radius = WIDENING * distance + REACH * self.spacing;
        let [width, height] = [0, 1].map(|axis: usize| self.shape[axis] as f64 * self.side);
        let whole = 2.0 * (distance + width + height);
        loop {
            let near: Vec<(u32, [f64; 2], f64)> = self
                .near(point, radius)
                .map(|(node, [x, y])| (node, [x / radius, y / radius]))
                .map(|(node, [x, y])| (node, [x, y], (1.0 - x * x - y * y).powi(2)))
                .collect();
            let total: f64 = near.iter().map(|(_, _, weight)| weight).sum();
            let mean = |value: &dyn Fn([f64; 2]) -> f64| {
                near.iter().map(|&(_, way, weight)| weight * value(way)).sum::<f64>() / total
            };
            let centre = [mean(&|[x, _]| x), mean(&|[_, y]| y)];
            let from_centre = |[x, y]: [f64; 2]| [x - centre[0], y - centre[1]];
            let xx = mean(&|way| from_centre(way)[0].powi(2));
            let yy = mean(&|way| from_centre(way)[1].powi(2));
            let xy = mean(&|way| from_centre(way)[0] * from_centre(way)[1]);
            let determinant = xx * yy - xy * xy;
            if determinant > FLAT {
                // Value of the best affine function at the point, which is at -centre from the
                // nodes' own centre: the mean plus the slope, which is the inverse covariance times
                // the covariance with the values.
                let slope = [
                    (xy * centre[1] - yy * centre[0]) / determinant,
                    (xy * centre[0] - xx * centre[1]) / determinant,
                ];
                weights.extend(near.iter().map(|&(node, way, weight)| {
                    let [x, y] = from_centre(way);
                    (node, weight / total * (1.0 + slope[0] * x + slope[1] * y))
                }));
                return;
            }
            // Collinear nodes: use more distant ones, or for a mesh without width the nearest one.
            if radius > whole {
                weights.push((nearest, 1.0));
                return;
            }
            radius *= 2.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::lattice;
    use super::*;

    fn moved(mesh: &Mesh, map: impl Fn([f64; 2]) -> [f64; 2]) -> [Vec<f64>; 2] {
        let (xs, ys) =
            (0..mesh.len()).map(|node| map(mesh.point(node))).map(|[x, y]| (x, y)).unzip();
        [xs, ys]
    }

    fn disc(radius: f64, corners: usize) -> Outline {
        let corner = |k| {
            let (sin, cos) = (std::f64::consts::TAU * k as f64 / corners as f64).sin_cos();
            [30.0 + radius * cos, 40.0 + radius * sin]
        };
        Outline::new((0..corners).map(corner).collect(), Vec::new()).unwrap()
    }

    #[test]
    fn affine_maps_carry_points_inside_outside_and_far_away_to_rounding() {
        let (mesh, _) = lattice::from_outline(&disc(20.0, 90), Some(1.7)).unwrap();
        let points: Vec<[f64; 2]> =
            (0..400).map(|k| [f64::from(k % 20) * 4.0 - 10.0, f64::from(k / 20) * 4.0]).collect();
        let carried = Carried::new(&mesh, points.iter().copied());
        let map = |[x, y]: [f64; 2]| [0.88 * x + 0.1 * y - 3.0, 1.07 * y - 0.2 * x + 8.0];
        for (found, rest) in carried.at(&moved(&mesh, map)).into_iter().zip(points) {
            let wanted = map(rest);
            for axis in 0..2 {
                // Rounding, of coordinates of 100 um and weights of up to 100.
                assert!(
                    (found[axis] - wanted[axis]).abs() < 1e-10,
                    "{rest:?}: {found:?}, {wanted:?}"
                );
            }
        }
    }

    #[test]
    fn bending_carries_the_outline_as_finely_as_the_lattice_is() {
        // A bar that is bent into an arc: x' = (x, y + x^2 / 200), curved by 1 / 100 um.
        let bend = |[x, y]: [f64; 2]| [x, y + x * x / 200.0];
        let errors = [2.0, 1.0, 0.5].map(|spacing| {
            let mesh =
                lattice::rectangle((60.0 / spacing) as usize, (12.0 / spacing) as usize, spacing);
            let mesh = mesh.unwrap();
            let along =
                (0..mesh.len()).map(|k| 0.25 * spacing * k as f64).take_while(|x| *x <= 60.0);
            let points: Vec<[f64; 2]> = along.map(|x| [x, 12.0 + 0.5 * spacing]).collect();
            let found = Carried::new(&mesh, points.iter().copied()).at(&moved(&mesh, bend));
            found.iter().zip(&points).map(|(a, &b)| (a[1] - bend(b)[1]).abs()).fold(0.0, f64::max)
        });
        // Curvature times the square of the reach over two: 4.5 spacings at the very end.
        assert!(errors[0] < 0.5 * 0.01 * 9.0_f64.powi(2), "{errors:?}");
        for (coarse, fine) in errors.iter().zip(&errors[1..]) {
            assert!((coarse / fine - 4.0).abs() < 0.2, "second order: {errors:?}");
        }
    }

    #[test]
    fn neighbours_stay_neighbours_wherever_they_lie() {
        let (mesh, _) = lattice::from_outline(&disc(20.0, 90), Some(2.0)).unwrap();
        let wavy = |[x, y]: [f64; 2]| [x + 0.6 * (y / 4.0).sin(), y + 0.6 * (x / 3.0).cos()];
        let positions = moved(&mesh, wavy);
        // A line through the cell and out of it, in steps of a hundredth of a spacing.
        let points: Vec<[f64; 2]> = (0..3000).map(|k| [f64::from(k) * 0.02, 41.3]).collect();
        let found = Carried::new(&mesh, points).at(&positions);
        for pair in found.windows(2) {
            let step = (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            assert!(step < 0.05, "a jump of {step} um at {:?}", pair[0]);
        }
    }

    #[test]
    fn long_edges_are_divided_and_corners_kept() {
        let square = vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
        let points = divided(&square, 3.0);
        assert_eq!(points.len(), 16);
        assert!(square.iter().all(|corner| points.contains(corner)));
        let outline = Outline::new(square, Vec::new()).unwrap();
        let (mesh, _) = lattice::from_outline(&outline, Some(1.0)).unwrap();
        let rings = Carried::rings(&mesh, &outline);
        assert_eq!((rings.len(), rings[0].len()), (1, 80));
    }

    #[test]
    fn a_mesh_without_width_carries_by_its_nearest_node() {
        let mut mesh = lattice::rectangle(3, 1, 1.0).unwrap();
        mesh.points[1] = vec![0.0; mesh.len()];
        let carried = Carried::new(&mesh, [[0.1, 5.0]]);
        assert_eq!(carried.weights(0), [(0, 1.0)]);
    }
}
