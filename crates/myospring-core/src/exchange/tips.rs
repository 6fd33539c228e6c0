//! Where waves in a tissue end: the tips about which spiral waves turn.
//!
//! A tip is where the lines of equal potential of two times cross (`fenton_1998`): there the potential has that value and does not change.

use crate::mesh::Mesh;
use crate::recording::WaveTip;
use std::sync::Arc;

/// Time between the two lines, ms.
const BETWEEN_MS: f64 = 2.0;

/// The tips that were found so far.
#[derive(Debug, Clone)]
pub(super) struct Tips {
    mesh: Arc<Mesh>,
    /// Tips of the two diagonals of a square, which are the same, are nearer than this, um.
    same_um: f64,
    level: f64,
    before: Vec<f64>,
    before_ms: f64,
    found: Vec<WaveTip>,
}

impl Tips {
    /// From these potentials at 0 ms on; a wave is where the potential is above `level`.
    pub(super) fn new(mesh: &Mesh, level: f64, potentials: &[f64]) -> Self {
        let side = |triangle: &crate::mesh::Simplex<3>| {
            let [a, b, c] = triangle.nodes.map(|node| mesh.point(node as usize));
            let length = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
            length(a, b).max(length(b, c)).max(length(c, a))
        };
        Self {
            same_um: mesh.simplices.iter().map(side).fold(0.0, f64::max),
            mesh: Arc::new(mesh.clone()),
            level,
            before: potentials.to_vec(),
            before_ms: 0.0,
            found: Vec::new(),
        }
    }

    /// All tips so far, in order of time.
    pub(super) fn found(&self) -> &[WaveTip] {
        &self.found
    }

    /// Takes the potentials of a later time, ms.
    pub(super) fn see(&mut self, potentials: &[f64], now_ms: f64) {
        if now_ms - self.before_ms < BETWEEN_MS {
            return;
        }
        let t_ms = f64::midpoint(self.before_ms, now_ms);
        let mut groups: Vec<(f64, [f64; 2])> = Vec::new();
        for triangle in &self.mesh.simplices {
            let over = |potentials: &[f64]| {
                triangle.nodes.map(|node| potentials[node as usize] - self.level)
            };
            let Some(parts) = crossing(over(&self.before), over(potentials)) else { continue };
            let corners = triangle.nodes.map(|node| self.mesh.point(node as usize));
            let place = [0, 1].map(|axis: usize| {
                corners.iter().zip(parts).map(|(corner, part)| part * corner[axis]).sum::<f64>()
            });
            let near = |(count, sum): &&mut (f64, [f64; 2])| {
                (sum[0] / *count - place[0]).hypot(sum[1] / *count - place[1]) < self.same_um
            };
            match groups.iter_mut().find(near) {
                Some((count, sum)) => {
                    *count += 1.0;
                    *sum = [sum[0] + place[0], sum[1] + place[1]];
                }
                None => groups.push((1.0, place)),
            }
        }
        let tip =
            |(count, [x, y]): (f64, [f64; 2])| WaveTip { t_ms, x_um: x / count, y_um: y / count };
        self.found.extend(groups.into_iter().map(tip));
        self.before.copy_from_slice(potentials);
        self.before_ms = now_ms;
    }
}

/// Where in a triangle two linear functions, given at its corners, are both 0: the parts of its corners.
fn crossing(a: [f64; 3], b: [f64; 3]) -> Option<[f64; 3]> {
    let one_sign = |of: [f64; 3]| of.iter().all(|at| *at > 0.0) || of.iter().all(|at| *at < 0.0);
    if one_sign(a) || one_sign(b) {
        return None;
    }
    let parts = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let sum: f64 = parts.iter().sum();
    let parts = parts.map(|part| part / sum);
    parts.iter().all(|part| (0.0..=1.0).contains(part)).then_some(parts)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::lattice;
    use std::f64::consts::TAU;

    #[test]
    fn the_tip_of_a_turning_wave_is_its_centre_and_a_plane_wave_has_none() {
        let mesh = lattice::rectangle(30, 30, 10.0).unwrap();
        let of = |potential: &dyn Fn([f64; 2]) -> f64| -> Vec<f64> {
            (0..mesh.len()).map(|node| potential(mesh.point(node))).collect()
        };
        let centre = [143.0, 158.0];
        let turning = |phase: f64| {
            of(&|[x, y]| {
                0.5 + 0.01 * ((x - centre[0]) * phase.cos() + (y - centre[1]) * phase.sin())
            })
        };
        let mut tips = Tips::new(&mesh, 0.5, &turning(0.0));
        for step in 1..=10 {
            tips.see(&turning(TAU * f64::from(step) / 12.0), 2.0 * f64::from(step));
        }
        // Where the lines turn by a half they lie on each other.
        assert!(tips.found().len() >= 8, "{:?}", tips.found());
        for WaveTip { x_um, y_um, .. } in tips.found() {
            assert!((x_um - centre[0]).hypot(y_um - centre[1]) < 1e-6, "{x_um} {y_um}");
        }
        assert_eq!(tips.found()[0].t_ms, 1.0);
        let plane = |at: f64| of(&|[x, _]| (at - x) / 20.0);
        let mut tips = Tips::new(&mesh, 0.5, &plane(0.0));
        for step in 1..=10 {
            tips.see(&plane(23.0 * f64::from(step)), 2.0 * f64::from(step));
        }
        assert!(tips.found().is_empty(), "{:?}", tips.found());
    }
}
