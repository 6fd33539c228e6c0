//! Springs and axial dashpots.
//!
//! With `l = x_b - x_a`, rest length `r`, the force on node a is
//!
//! ```text
//! f = k (|l| - r) l/|l|  +  c (l'.l / |l|) l/|l|          coelho_2021, Eqs (7) and (8)
//! c = xi 2 sqrt(k m)                                       coelho_2021, Eqs (9) and (11)
//! ```
//!
//! and minus that on node b, so the spring pulls the nodes together when long and the dashpot
//! opposes their approach and parting. (The paper prints both for the node at the other end.)
//!
//! The dashpot is stiffness-proportional damping: it holds down the fastest vibrations of the
//! lattice and hardly touches the slow ones of a long cell; see [`super::drag`] for those.

use super::runs::{self, LONGEST, Run, vectorised};
use super::stencil::LatticeTerms;
use super::stiffness::StiffnessMatrix;
use super::{Configuration, Force, Vectors};

/// Springs with dashpots between pairs of nodes.
#[derive(Debug, Clone, PartialEq)]
pub struct Springs {
    nodes: Vec<[u32; 2]>,
    stiffness: Vec<f64>,
    rest_length: Vec<f64>,
    damping: Vec<f64>,
    runs: Vec<Run<2>>,
}

impl Springs {
    /// Springs between `nodes`, all of equal length: stiffness nN/um, rest length um, dashpot
    /// coefficient nN ms/um.
    ///
    /// # Panics
    /// If the lists differ in length.
    ///
    /// # Example
    /// ```
    /// use myospring::mechanics::{Configuration, Force, spring::Springs, zeros};
    /// // A spring of 2 nN/um stretched by 0.5 um along x pulls its ends together with 1 nN.
    /// let spring = Springs::new(vec![[0, 1]], vec![2.0], vec![1.0], vec![0.0]);
    /// let (positions, velocities) = ([vec![0.0, 1.5], vec![0.0, 0.0]], zeros(2));
    /// let at = Configuration { positions: &positions, velocities: &velocities, tension: 0.0 };
    /// let mut forces = zeros(2);
    /// spring.add_forces(&at, &mut forces);
    /// assert_eq!(forces[0], [1.0, -1.0]);
    /// assert_eq!(spring.energy(&at), Some(0.25));
    /// ```
    pub fn new(
        nodes: Vec<[u32; 2]>,
        stiffness: Vec<f64>,
        rest_length: Vec<f64>,
        damping: Vec<f64>,
    ) -> Self {
        assert!(
            [stiffness.len(), rest_length.len(), damping.len()] == [nodes.len(); 3],
            "one stiffness, rest length and damping per spring"
        );
        let runs = runs::find(&nodes);
        Self { nodes, stiffness, rest_length, damping, runs }
    }

    /// The pairs of nodes.
    pub fn nodes(&self) -> &[[u32; 2]] {
        &self.nodes
    }

    /// Stiffness of each spring, nN/um.
    pub fn stiffness(&self) -> &[f64] {
        &self.stiffness
    }

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "it must be compiled anew for each vector unit")]
    fn add(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        let ([x, y], [vx, vy]) = (at.positions, at.velocities);
        let [force_x, force_y] = forces;
        let mut buffer = [[0.0; LONGEST]; 2];
        for &Run { nodes: [a, b], first, len } in &self.runs {
            let (xa, xb) = (&x[a..a + len], &x[b..b + len]);
            let (ya, yb) = (&y[a..a + len], &y[b..b + len]);
            let (vxa, vxb) = (&vx[a..a + len], &vx[b..b + len]);
            let (vya, vyb) = (&vy[a..a + len], &vy[b..b + len]);
            let stiffness = &self.stiffness[first..first + len];
            let rest_length = &self.rest_length[first..first + len];
            let damping = &self.damping[first..first + len];
            let [fx, fy] = &mut buffer;
            let (fx, fy) = (&mut fx[..len], &mut fy[..len]);
            for k in 0..len {
                let (lx, ly) = (xb[k] - xa[k], yb[k] - ya[k]);
                let inverse_length = 1.0 / (lx * lx + ly * ly).sqrt();
                // Eq. (7): k (|l| - r) / |l|
                let elastic = stiffness[k] * (1.0 - rest_length[k] * inverse_length);
                // Eq. (8): c (l'.l) / |l|^2
                let approach = (vxb[k] - vxa[k]) * lx + (vyb[k] - vya[k]) * ly;
                let scale = elastic + damping[k] * approach * (inverse_length * inverse_length);
                fx[k] = scale * lx;
                fy[k] = scale * ly;
            }
            runs::add(force_x, a, fx);
            runs::add(force_y, a, fy);
            runs::subtract(force_x, b, fx);
            runs::subtract(force_y, b, fy);
        }
    }

    /// Sum over all springs of a function of the spring, its vector from a to b and the relative
    /// velocity.
    fn total(&self, at: &Configuration<'_>, one: impl Fn(usize, [f64; 2], [f64; 2]) -> f64) -> f64 {
        let ([x, y], [vx, vy]) = (at.positions, at.velocities);
        let mut total = 0.0;
        vectorised(
            #[inline(always)]
            || {
                let mut buffer = [0.0; LONGEST];
                for &Run { nodes: [a, b], first, len } in &self.runs {
                    let (xa, xb) = (&x[a..a + len], &x[b..b + len]);
                    let (ya, yb) = (&y[a..a + len], &y[b..b + len]);
                    let (vxa, vxb) = (&vx[a..a + len], &vx[b..b + len]);
                    let (vya, vyb) = (&vy[a..a + len], &vy[b..b + len]);
                    let values = &mut buffer[..len];
                    for (k, value) in values.iter_mut().enumerate() {
                        let (l, w) =
                            ([xb[k] - xa[k], yb[k] - ya[k]], [vxb[k] - vxa[k], vyb[k] - vya[k]]);
                        *value = one(first + k, l, w);
                    }
                    total += runs::sum(values);
                }
            },
        );
        total
    }

    /// Length, and the unit vector from a to b, of a spring.
    fn direction(&self, spring: usize, positions: &Vectors) -> (f64, [f64; 2]) {
        let [a, b] = self.nodes[spring].map(|node| node as usize);
        let l = [0, 1].map(|axis| positions[axis][b] - positions[axis][a]);
        let length = l[0].hypot(l[1]);
        (length, [l[0] / length, l[1] / length])
    }
}

impl Force for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn add_forces(&self, at: &Configuration<'_>, forces: &mut Vectors) {
        vectorised(
            #[inline(always)]
            || self.add(at, forces),
        );
    }

    fn energy(&self, at: &Configuration<'_>) -> Option<f64> {
        // (k/2)(|l| - r)^2
        Some(self.total(at, |spring, [lx, ly], _| {
            let extension = (lx * lx + ly * ly).sqrt() - self.rest_length[spring];
            0.5 * self.stiffness[spring] * extension * extension
        }))
    }

    fn dissipation(&self, at: &Configuration<'_>) -> f64 {
        // c (l'.l / |l|)^2
        self.total(at, |spring, [lx, ly], [wx, wy]| {
            let approach = wx * lx + wy * ly;
            self.damping[spring] * approach * approach / (lx * lx + ly * ly)
        })
    }

    fn add_stiffness(&self, at: &Configuration<'_>, stiffness: &mut StiffnessMatrix) -> bool {
        for (spring, nodes) in self.nodes.iter().enumerate() {
            let [a, b] = nodes.map(|node| node as usize);
            let (length, n) = self.direction(spring, at.positions);
            // k [(1 - r/|l|) I + (r/|l|) n (x) n], n = l/|l|
            let k = self.stiffness[spring];
            let ratio = self.rest_length[spring] / length;
            let along = |i: usize, j: usize| k * ratio * n[i] * n[j];
            let across = k * (1.0 - ratio);
            let mixed = along(0, 1);
            let block = [[across + along(0, 0), mixed], [mixed, across + along(1, 1)]];
            stiffness.add_pair(a, b, block);
        }
        true
    }

    fn add_to_lattice(&self, terms: &mut LatticeTerms) -> bool {
        self.nodes.iter().enumerate().all(|(spring, &nodes)| {
            let stiffness = self.stiffness[spring];
            terms.add_spring(nodes, stiffness, self.rest_length[spring], self.damping[spring])
        })
    }

    fn is_internal(&self) -> bool {
        true
    }
}
