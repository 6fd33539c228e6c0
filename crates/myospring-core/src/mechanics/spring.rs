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
//! opposes their approach and parting. (The paper prints both with the opposite sign, for the other
//! node.)
//!
//! The dashpot is stiffness-proportional damping: it damps the fastest vibrations of the lattice,
//! and hardly the slow ones of a long cell; see [`super::drag`] for those.

use super::force::{Configuration, Force};
use super::lattice_law::LatticeLaw;
use super::runs::{self, LONGEST, Run, vectorised};
use super::stiffness::{Block, StiffnessMatrix};
use super::vectors::{Vectors, dot};
use std::array::from_fn;

/// Springs with dashpots between pairs of nodes, with any number of axes.
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
    /// let (positions, velocities) = ([vec![0.0, 1.5], vec![0.0, 0.0]], zeros::<2>(2));
    /// let at = Configuration { positions: &positions, velocities: &velocities, tension: 0.0.into() };
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
    fn add<const D: usize>(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        let mut buffer = [[0.0; LONGEST]; D];
        for &Run { nodes: [a, b], first, len } in &self.runs {
            let [xa, xb] = [a, b].map(|node| parts(at.positions, node, len));
            let [va, vb] = [a, b].map(|node| parts(at.velocities, node, len));
            let stiffness = &self.stiffness[first..first + len];
            let rest_length = &self.rest_length[first..first + len];
            let damping = &self.damping[first..first + len];
            for k in 0..len {
                let l: [f64; D] = from_fn(|axis| xb[axis][k] - xa[axis][k]);
                let inverse_length = 1.0 / dot(l, l).sqrt();
                // Eq. (7): k (|l| - r) / |l|
                let elastic = stiffness[k] * (1.0 - rest_length[k] * inverse_length);
                // Eq. (8): c (l'.l) / |l|^2
                let approach = dot(from_fn(|axis| vb[axis][k] - va[axis][k]), l);
                let scale = elastic + damping[k] * approach * (inverse_length * inverse_length);
                for axis in 0..D {
                    buffer[axis][k] = scale * l[axis];
                }
            }
            for (force, pull) in forces.iter_mut().zip(&buffer) {
                runs::add(force, a, &pull[..len]);
                runs::subtract(force, b, &pull[..len]);
            }
        }
    }

    /// Sum over all springs of a function of the spring, its vector from a to b and the relative
    /// velocity.
    fn total<const D: usize>(
        &self,
        at: &Configuration<'_, D>,
        one: impl Fn(usize, [f64; D], [f64; D]) -> f64,
    ) -> f64 {
        let mut total = 0.0;
        vectorised(
            #[inline(always)]
            || {
                let mut buffer = [0.0; LONGEST];
                for &Run { nodes: [a, b], first, len } in &self.runs {
                    let [xa, xb] = [a, b].map(|node| parts(at.positions, node, len));
                    let [va, vb] = [a, b].map(|node| parts(at.velocities, node, len));
                    let values = &mut buffer[..len];
                    for (k, value) in values.iter_mut().enumerate() {
                        let l = from_fn(|axis| xb[axis][k] - xa[axis][k]);
                        let w = from_fn(|axis| vb[axis][k] - va[axis][k]);
                        *value = one(first + k, l, w);
                    }
                    total += runs::sum(values);
                }
            },
        );
        total
    }
}

/// The components of `len` nodes from a first one on, by axis.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised loop around it")]
fn parts<const D: usize>(vectors: &Vectors<D>, first: usize, len: usize) -> [&[f64]; D] {
    from_fn(|axis| &vectors[axis][first..first + len])
}

impl<const D: usize> Force<D> for Springs {
    fn name(&self) -> &'static str {
        "springs"
    }

    fn add_forces(&self, at: &Configuration<'_, D>, forces: &mut Vectors<D>) {
        vectorised(
            #[inline(always)]
            || self.add(at, forces),
        );
    }

    fn energy(&self, at: &Configuration<'_, D>) -> Option<f64> {
        // (k/2)(|l| - r)^2
        Some(self.total(at, |spring, l, _| {
            let extension = dot(l, l).sqrt() - self.rest_length[spring];
            0.5 * self.stiffness[spring] * extension * extension
        }))
    }

    fn dissipation(&self, at: &Configuration<'_, D>) -> f64 {
        // c (l'.l / |l|)^2
        self.total(at, |spring, l, w| {
            let approach = dot(w, l);
            self.damping[spring] * approach * approach / dot(l, l)
        })
    }

    fn add_stiffness(&self, at: &Configuration<'_, D>, stiffness: &mut StiffnessMatrix<D>) -> bool {
        for (spring, nodes) in self.nodes.iter().enumerate() {
            let [a, b] = nodes.map(|node| node as usize);
            let l: [f64; D] = from_fn(|axis| at.positions[axis][b] - at.positions[axis][a]);
            let length = l.iter().copied().reduce(f64::hypot).unwrap_or_default();
            let n = l.map(|part| part / length);
            // k [(1 - r/|l|) I + (r/|l|) n (x) n], n = l/|l|
            let k = self.stiffness[spring];
            let ratio = self.rest_length[spring] / length;
            let across = k * (1.0 - ratio);
            let block: Block<D> = from_fn(|i| {
                from_fn(|j| {
                    let along = k * ratio * n[i.min(j)] * n[i.max(j)];
                    if i == j { across + along } else { along }
                })
            });
            stiffness.add_pair(a, b, block);
        }
        true
    }

    fn on_lattice(&self) -> Option<LatticeLaw<'_, D>> {
        let Self { nodes, stiffness, rest_length, damping, .. } = self;
        Some(LatticeLaw::Springs { nodes, stiffness, rest_length, damping })
    }

    fn is_internal(&self) -> bool {
        true
    }
}
