//! The area of a thick cell seen from above: that of its shadow, whatever lies above what.

use super::{Mesh, surface};

/// Lines in each row of the lattice at rest.
const LINES: f64 = 8.0;
/// The part of an interval up to which it does not overlap with another but touches it.
const TOUCHING: f64 = 1e-9;

/// The shadow that a mesh of cubes casts along z.
///
/// It is the sum of the faces that look up, less what lies above others of them: that is found along lines across the longer extent, at equal
/// distances over all of it, as how much longer their cuts are than what these cover together. Where nothing overlaps, as in a cell that neither
/// twists nor rolls, it is the sum without error.
///
/// # Example
/// ```
/// use myospring::mesh::{cubes, shadow::Shadow};
/// let block = cubes::block([6, 2, 3], 2.0)?;
/// let shadow = Shadow::of(&block);
/// assert!((shadow.area(&[&block.points[0], &block.points[1]]) - 48.0).abs() < 1e-9);
/// // Seen from the side: rolled by a quarter turn about x.
/// let [x, _, z] = &block.points;
/// assert!((shadow.area(&[x, &z.iter().map(|z| -z).collect()]) - 72.0).abs() < 1e-9);
/// # Ok::<(), myospring::mesh::MeshError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Shadow {
    triangles: Vec<[u32; 3]>,
    /// Distance of the lines at rest, um.
    apart: f64,
}

impl Shadow {
    /// The shadow of a mesh; without a lattice it has none.
    pub fn of(mesh: &Mesh<3, 4>) -> Self {
        let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
        let triangles = surface::quads(mesh).into_iter().flat_map(halves).collect();
        let spacing = mesh.lattice.as_ref().map_or(1.0, |lattice| lattice.spacing);
        Self { triangles, apart: spacing / LINES }
    }

    /// Its area in given positions along x and y, um^2.
    pub fn area(&self, [x, y]: &[&Vec<f64>; 2]) -> f64 {
        let extent = |places: &[f64]| {
            let corners = self.triangles.iter().flatten().map(|&node| places[node as usize]);
            corners.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], place| {
                [low.min(place), high.max(place)]
            })
        };
        let extents = [extent(x), extent(y)];
        let [width, height] = extents.map(|[low, high]| high - low);
        let (extent, along) = if width > height { (width, 0) } else { (height, 1) };
        let lines = (extent / self.apart).round().max(1.0);
        if !lines.is_finite() {
            return 0.0;
        }
        let (low, step) = (extents[along][0], extent / lines);
        let mut cuts: Vec<Vec<[f64; 2]>> = vec![Vec::new(); lines as usize];
        let mut sum = 0.0;
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|node| [x[node as usize], y[node as usize]]);
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            if twice > 0.0 {
                sum += 0.5 * twice;
                cut(
                    [a, b, c].map(|corner| [corner[along], corner[1 - along]]),
                    (low, step),
                    &mut cuts,
                );
            }
        }
        sum - step * cuts.iter_mut().map(|cuts| doubled(cuts)).sum::<f64>()
    }
}

/// Adds what the lines cut off a triangle, whose corners are given by the place along the extent and the one across it; the first line is
/// half a step above the lowest place.
fn cut(corners: [[f64; 2]; 3], (low, step): (f64, f64), cuts: &mut [Vec<[f64; 2]>]) {
    let [a, b, c] = corners.map(|corner| corner[0]);
    let (least, most) = (a.min(b).min(c), a.max(b).max(c));
    let number = |place: f64| ((place - low) / step - 0.5).ceil().max(0.0) as usize;
    let lines = number(least)..number(most).min(cuts.len());
    for (line, cuts) in cuts[lines.clone()].iter_mut().enumerate() {
        let place = low + ((lines.start + line) as f64 + 0.5) * step;
        let mut span = [f64::INFINITY, f64::NEG_INFINITY];
        for side in 0..3 {
            let [from, to] = [corners[side], corners[(side + 1) % 3]];
            if (from[0] <= place) != (to[0] <= place) {
                let at = from[1] + (to[1] - from[1]) * ((place - from[0]) / (to[0] - from[0]));
                span = [span[0].min(at), span[1].max(at)];
            }
        }
        if span[0] < span[1] {
            cuts.push(span);
        }
    }
}

/// How much longer intervals are than what they cover together, but for the rounding of ends that touch.
fn doubled(cuts: &mut [[f64; 2]]) -> f64 {
    cuts.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]));
    let mut end = f64::NEG_INFINITY;
    let mut length = 0.0;
    for [from, to] in cuts.iter() {
        let twice = end.min(*to) - from;
        if twice > TOUCHING * (to - from) {
            length += twice;
        }
        end = end.max(*to);
    }
    length
}
