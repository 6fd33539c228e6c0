//! Area preservation: the cell's resistance to a change of its projected area.
//!
//! For a triangle of area `A` (at rest `A0`), weight `w` and stiffness `k` (nN/um):
//!
//! - [`AreaLaw::Gradient`]: energy `E = w (k/2) (A - A0)^2 / A0`, force `-grad E` on all three
//!   corners. Conserves linear and angular momentum. Not from the paper; the default.
//! - [`AreaLaw::Barycentric`]: the paper's direction with the deviation from rest,
//!   `f_i = -w k (A - A0)/sqrt(A0) (x_i - x_b)/|x_i - x_b|` with the barycentre `x_b`, Eq. (12).
//! - [`AreaLaw::Printed`]: Eq. (13) exactly as printed, `f_i = -w k A/sqrt(A0) (x_i - x_b)/|x_i -
//!   x_b|`. It contracts a resting cell and increases the loss of area in a contraction; included
//!   to show that.
//!
//! Eq. (13) has no length scale: `k_prev area` must be a force. The factor `1/sqrt(A0)` gives all
//! three laws the same `k` in nN/um.

use super::force::{Configuration, Force};
use super::lattice_law::LatticeLaw;
use super::runs::{self, LONGEST, Run, vectorised};
use super::stiffness::StiffnessMatrix;
use super::vectors::Vectors;
use crate::mesh::Mesh;
use crate::mesh::simplex::measure_at;
use serde::Serialize;

/// The law of area preservation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum AreaLaw {
    /// Minus the gradient of an energy of the area's deviation from rest.
    Gradient,
    /// Towards the barycentre, proportional to the area's deviation from rest.
    Barycentric,
    /// Exactly the paper's Eq. (13), absolute area and all; for comparison only.
    Printed,
}

impl AreaLaw {
    /// All laws, in the order of display.
    pub const ALL: [Self; 3] = [Self::Gradient, Self::Barycentric, Self::Printed];
}

/// Area preservation on the triangles of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct AreaPreservation {
    law: AreaLaw,
    nodes: Vec<[u32; 3]>,
    /// Rest area A0, um^2.
    rest_area: Vec<f64>,
    /// w k / A0, nN/um^3.
    stiffness: Vec<f64>,
    runs: Vec<Run<3>>,
}

impl AreaPreservation {
    /// The law on all triangles of a mesh, with one stiffness in nN/um.
    pub fn new(mesh: &Mesh, law: AreaLaw, stiffness: f64) -> Self {
        let nodes: Vec<[u32; 3]> = mesh.simplices.iter().map(|simplex| simplex.nodes).collect();
        let rest_area: Vec<f64> =
            nodes.iter().map(|corners| measure_at(&mesh.points, *corners)).collect();
        let stiffness = mesh
            .simplices
            .iter()
            .zip(&rest_area)
            .map(|(simplex, area)| simplex.weight * stiffness / area)
            .collect();
        let runs = runs::find(&nodes);
        Self { law, nodes, rest_area, stiffness, runs }
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn add_gradient(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        let [x, y] = at.positions;
        let [force_x, force_y] = forces;
        let mut buffer = [[0.0; LONGEST]; 6];
        for &Run { nodes: [a, b, c], first, len } in &self.runs {
            let (xa, xb, xc) = (&x[a..a + len], &x[b..b + len], &x[c..c + len]);
            let (ya, yb, yc) = (&y[a..a + len], &y[b..b + len], &y[c..c + len]);
            let rest_area = &self.rest_area[first..first + len];
            let stiffness = &self.stiffness[first..first + len];
            let [fxa, fya, fxb, fyb, fxc, fyc] = &mut buffer;
            let (fxa, fya) = (&mut fxa[..len], &mut fya[..len]);
            let (fxb, fyb) = (&mut fxb[..len], &mut fyb[..len]);
            let (fxc, fyc) = (&mut fxc[..len], &mut fyc[..len]);
            for k in 0..len {
                let (ux, uy) = (xb[k] - xa[k], yb[k] - ya[k]);
                let (wx, wy) = (xc[k] - xa[k], yc[k] - ya[k]);
                let area = 0.5 * (ux * wy - uy * wx);
                // f = -dE/dA dA/dx, and dA/dx_b = (w_y, -w_x)/2, dA/dx_c = (-u_y, u_x)/2
                let half = -0.5 * stiffness[k] * (area - rest_area[k]);
                (fxb[k], fyb[k]) = (half * wy, -half * wx);
                (fxc[k], fyc[k]) = (-half * uy, half * ux);
                (fxa[k], fya[k]) = (-(fxb[k] + fxc[k]), -(fyb[k] + fyc[k]));
            }
            for (start, fx, fy) in [(a, fxa, fya), (b, fxb, fyb), (c, fxc, fyc)] {
                runs::add(force_x, start, fx);
                runs::add(force_y, start, fy);
            }
        }
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn gradient_energy(&self, [x, y]: &Vectors) -> f64 {
        let (mut total, mut buffer) = (0.0, [0.0; LONGEST]);
        for &Run { nodes: [a, b, c], first, len } in &self.runs {
            let (xa, xb, xc) = (&x[a..a + len], &x[b..b + len], &x[c..c + len]);
            let (ya, yb, yc) = (&y[a..a + len], &y[b..b + len], &y[c..c + len]);
            let rest_area = &self.rest_area[first..first + len];
            let stiffness = &self.stiffness[first..first + len];
            let values = &mut buffer[..len];
            for (k, value) in values.iter_mut().enumerate() {
                let (ux, uy) = (xb[k] - xa[k], yb[k] - ya[k]);
                let (wx, wy) = (xc[k] - xa[k], yc[k] - ya[k]);
                let deviation = 0.5 * (ux * wy - uy * wx) - rest_area[k];
                *value = 0.5 * stiffness[k] * deviation * deviation;
            }
            total += runs::sum(values);
        }
        total
    }

    fn add_towards_barycentre(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        let printed = self.law == AreaLaw::Printed;
        for (triangle, corners) in self.nodes.iter().enumerate() {
            let area = measure_at(at.positions, *corners);
            let rest = self.rest_area[triangle];
            // Eq. (13); stiffness holds w k / A0
            let magnitude =
                self.stiffness[triangle] * rest.sqrt() * if printed { area } else { area - rest };
            let corners = corners.map(|node| node as usize);
            // Eq. (12)
            let barycentre = [0, 1]
                .map(|axis| corners.iter().map(|&i| at.positions[axis][i]).sum::<f64>() / 3.0);
            for node in corners {
                let arm = [0, 1].map(|axis| at.positions[axis][node] - barycentre[axis]);
                let length = arm[0].hypot(arm[1]);
                for axis in 0..2 {
                    forces[axis][node] -= magnitude * arm[axis] / length;
                }
            }
        }
    }
}

impl Force for AreaPreservation {
    fn name(&self) -> &'static str {
        match self.law {
            AreaLaw::Gradient => "area preservation",
            AreaLaw::Barycentric => "barycentric area preservation",
            AreaLaw::Printed => "printed area preservation",
        }
    }

    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        match self.law {
            AreaLaw::Gradient => vectorised(
                #[inline(always)]
                || self.add_gradient(at, forces),
            ),
            AreaLaw::Barycentric | AreaLaw::Printed => self.add_towards_barycentre(at, forces),
        }
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        if self.law != AreaLaw::Gradient {
            return None;
        }
        let mut total = 0.0;
        vectorised(
            #[inline(always)]
            || total = self.gradient_energy(at.positions),
        );
        Some(total)
    }

    fn add_stiffness(&self, at: &Configuration<'_>, stiffness: &mut StiffnessMatrix) -> bool {
        if self.law != AreaLaw::Gradient {
            return false;
        }
        let [x, y] = at.positions;
        for (triangle, corners) in self.nodes.iter().enumerate() {
            let scale = self.stiffness[triangle];
            let stress = scale * (measure_at(at.positions, *corners) - self.rest_area[triangle]);
            let corners = corners.map(|node| node as usize);
            // dA/dx_a = (y_b - y_c, x_c - x_b)/2
            let gradient = [0, 1, 2].map(|k| {
                let (next, last) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
                [0.5 * (y[next] - y[last]), 0.5 * (x[last] - x[next])]
            });
            for k in 0..3 {
                // (dE/dA)' dA/dx_a (x) dA/dx_b + dE/dA d2A/(dx_a dx_b), the last for a before b:
                // ((0, 1/2), (-1/2, 0))
                let next = (k + 1) % 3;
                let product =
                    |other: usize, i: usize, j: usize| scale * gradient[k][i] * gradient[other][j];
                let mixed = product(k, 0, 1);
                let own = [[product(k, 0, 0), mixed], [mixed, product(k, 1, 1)]];
                let pair = [
                    [product(next, 0, 0), product(next, 0, 1) + 0.5 * stress],
                    [product(next, 1, 0) - 0.5 * stress, product(next, 1, 1)],
                ];
                stiffness.add(corners[k], corners[k], own);
                stiffness.add(corners[k], corners[next], pair);
            }
        }
        true
    }

    fn on_lattice(&self) -> Option<LatticeLaw<'_>> {
        let Self { law, nodes, rest_area, stiffness, .. } = self;
        (*law == AreaLaw::Gradient).then_some(LatticeLaw::Areas { nodes, stiffness, rest_area })
    }

    fn is_internal(&self) -> bool {
        self.law == AreaLaw::Gradient
    }
}
