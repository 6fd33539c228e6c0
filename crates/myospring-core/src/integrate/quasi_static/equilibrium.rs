//! One equilibrium: Newton's method with a line search on the energy.
//!
//! ```text
//! K(x) dx = f(x; Ta),     x <- x + s dx,     s = 1, 1/2, 1/4, ... until the energy drops
//! ```
//!
//! A free body has no stiffness against shift and rotation. Three coordinates of two nodes far apart
//! are held instead: internal forces have no resultant, so the holds bear nothing and the shape is
//! that of the free body. It is then put where a free body would be: the mass centre at its place, no
//! rotation against the start in the sense of least squares weighted by mass (what
//! `analysis::shape::ShapeMeter` takes out). A body that outer forces hold, such as an elastic bed, has
//! a place of its own and nothing of this is needed.

use super::factor::{Factor, FactorError};
use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::support::Support;
use crate::mechanics::{Body, Configuration, System, Vectors, zeros};

/// Why an equilibrium was not found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Failure {
    /// The stiffness is not positive definite.
    Indefinite,
    /// Newton's method does not come to rest.
    NoRest,
    /// The factors do not fit into memory.
    TooLarge,
}

impl From<FactorError> for Failure {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::Indefinite => Self::Indefinite,
            FactorError::TooLarge => Self::TooLarge,
        }
    }
}

/// Iterations after which Newton's method is given up.
const ITERATIONS: usize = 25;

/// A stable equilibrium.
pub(super) struct Rest {
    /// Positions, um.
    pub(super) positions: Vectors,
    /// Their derivative with respect to tension, um/kPa.
    pub(super) slope: Vectors,
    /// Largest corrections of Newton's method, um, one per iteration.
    pub(super) corrections: Vec<f64>,
    /// Drop of the active energy per kPa on the way along `slope`, fJ/kPa^2: slope . K slope.
    pub(super) compliance: f64,
}

/// Finds equilibria of one body.
pub(super) struct Solver<'a> {
    system: &'a System,
    body: &'a Body,
    still: Vectors,
    factor: Factor<'a>,
    stiffness: StiffnessMatrix,
    /// Matrices factorised so far.
    pub(super) factorisations: usize,
}

impl<'a> Solver<'a> {
    pub(super) fn new(system: &'a System, body: &'a Body) -> Self {
        let count = body.len();
        let mut free = [vec![true; count], vec![true; count]];
        match &system.support {
            Support::Clamped(nodes) => {
                for axis in &mut free {
                    for &node in nodes {
                        axis[node] = false;
                    }
                }
            }
            Support::MassCentre | Support::Free if adrift(system) => {
                hold_three(&body.positions, &mut free);
            }
            Support::MassCentre | Support::Free => {}
        }
        Self {
            system,
            body,
            still: zeros(count),
            factor: Factor::new(&body.positions, free),
            stiffness: StiffnessMatrix::new(count),
            factorisations: 0,
        }
    }

    /// The body at its start.
    pub(super) fn body(&self) -> &'a Body {
        self.body
    }

    fn forces(&self, positions: &Vectors, tension: f64) -> Vectors {
        let mut forces = zeros(self.body.len());
        let at = Configuration { positions, velocities: &self.still, tension };
        self.system.sum_forces(&at, &mut forces);
        forces
    }

    /// Total energy and the size of its parts, fJ.
    fn energy(&self, positions: &Vectors, tension: f64) -> [f64; 2] {
        let at = Configuration { positions, velocities: &self.still, tension };
        let parts = [self.system.elastic_energy(&at), self.system.active_energy(&at)];
        [parts[0] + parts[1], parts[0].abs() + parts[1].abs()]
    }

    /// Change of the active forces per kPa, nN/kPa.
    fn load(&self, positions: &Vectors, tension: f64) -> Vectors {
        let mut load = zeros(self.body.len());
        // Active forces are in proportion to tension, so the difference over 1 kPa is exact.
        let [mut more, mut less] = [zeros(self.body.len()), zeros(self.body.len())];
        for (sum, tension) in [(&mut more, tension + 0.5), (&mut less, tension - 0.5)] {
            let at = Configuration { positions, velocities: &self.still, tension };
            for force in &self.system.active {
                force.add_forces(&at, sum);
            }
        }
        for axis in 0..2 {
            for node in 0..load[axis].len() {
                load[axis][node] = more[axis][node] - less[axis][node];
            }
        }
        load
    }

    fn factorise(&mut self, positions: &Vectors, tension: f64) -> Result<(), Failure> {
        self.stiffness.clear();
        let at = Configuration { positions, velocities: &self.still, tension };
        for force in self.system.passive.iter().chain(&self.system.active) {
            force.add_stiffness(&at, &mut self.stiffness);
        }
        self.factorisations += 1;
        Ok(self.factor.factorise(&self.stiffness)?)
    }

    /// The equilibrium under a tension (kPa) near a guess; corrections below `tolerance` (um) end the
    /// search.
    pub(super) fn find(
        &mut self,
        guess: &Vectors,
        tension: f64,
        tolerance: f64,
    ) -> Result<Rest, Failure> {
        let mut positions = guess.clone();
        let mut corrections = Vec::new();
        let mut energy = self.energy(&positions, tension);
        for _ in 0..ITERATIONS {
            let forces = self.forces(&positions, tension);
            self.factorise(&positions, tension)?;
            let correction = self.factor.solve(&forces);
            let largest = largest(&correction);
            if !largest.is_finite() {
                return Err(Failure::NoRest);
            }
            corrections.push(largest);
            if largest <= tolerance {
                // A body that rests already keeps its bits.
                if corrections.len() > 1 || largest > 1e-3 * tolerance {
                    positions = moved(&positions, &correction, 1.0);
                }
                return Ok(self.at_rest(positions, tension, corrections));
            }
            // K is positive definite, so the energy falls in this direction, at this rate.
            let drop = dot(&forces, &correction);
            let mut part = 1.0;
            loop {
                let trial = moved(&positions, &correction, part);
                let there = self.energy(&trial, tension);
                // Armijo's rule; rounding in the energy must not stop the last steps.
                if there[0] <= energy[0] - 1e-4 * part * drop + 1e-13 * (energy[1] + there[1]) {
                    (positions, energy) = (trial, there);
                    break;
                }
                part *= 0.5;
                if part < 1e-6 {
                    return Err(Failure::NoRest);
                }
            }
        }
        Err(Failure::NoRest)
    }

    /// The node that moves most in the softest deformation of a stable equilibrium: the eigenvector of
    /// `K v = lambda M v` with the smallest `lambda`, by inverse iteration. Near the end of a path this is
    /// how the cell buckles.
    pub(super) fn softest_node(&mut self, positions: &Vectors, tension: f64) -> Option<usize> {
        const ROUNDS: usize = 20;
        self.factorise(positions, tension).ok()?;
        let count = self.body.len();
        // A fixed, irregular start: fractional parts of multiples of the golden ratio.
        let mut mode: Vectors = [0, 1].map(|axis| {
            (0..count)
                .map(|i| ((2 * i + axis + 1) as f64 * 0.618_033_988_749_894_9).fract() - 0.5)
                .collect()
        });
        for _ in 0..ROUNDS {
            for axis in &mut mode {
                axis.iter_mut().zip(&self.body.masses).for_each(|(x, mass)| *x *= mass);
            }
            mode = self.factor.solve(&mode);
            if adrift(self.system) && !matches!(self.system.support, Support::Clamped(_)) {
                mode = self.in_place(positions.clone(), mode).1;
            }
            let size = largest(&mode);
            mode.iter_mut().flatten().for_each(|x| *x /= size);
        }
        let square = |node: usize| mode[0][node].powi(2) + mode[1][node].powi(2);
        (0..count).max_by(|&a, &b| square(a).total_cmp(&square(b)))
    }

    /// Puts the body in its place and adds the slope, from the last factor.
    fn at_rest(&mut self, positions: Vectors, tension: f64, corrections: Vec<f64>) -> Rest {
        let load = self.load(&positions, tension);
        // 0 = d f/d Ta = load - K dx/dTa
        let slope = self.factor.solve(&load);
        let compliance = dot(&slope, &load);
        let (positions, slope) = match self.system.support {
            Support::MassCentre | Support::Free if adrift(self.system) => {
                self.in_place(positions, slope)
            }
            _ => (positions, slope),
        };
        Rest { positions, slope, corrections, compliance }
    }

    /// Removes shift and rotation against the start from positions and from their slope.
    fn in_place(&self, mut positions: Vectors, mut slope: Vectors) -> (Vectors, Vectors) {
        let masses = &self.body.masses;
        let total: f64 = masses.iter().sum();
        let mean = |values: &Vectors| {
            [0, 1].map(|axis| {
                values[axis].iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / total
            })
        };
        let start = &self.body.positions;
        let (before, after, drift) = (mean(start), mean(&positions), mean(&slope));
        let (mut cosine, mut sine, mut turn) = (0.0, 0.0, 0.0);
        for (i, mass) in masses.iter().enumerate() {
            let old = [start[0][i] - before[0], start[1][i] - before[1]];
            let new = [positions[0][i] - after[0], positions[1][i] - after[1]];
            cosine += mass * (old[0] * new[0] + old[1] * new[1]);
            sine += mass * (old[0] * new[1] - old[1] * new[0]);
        }
        // Undisturbed bodies keep their bits.
        let (angle, same) = (sine.atan2(cosine), positions == *start);
        let (s, c) = (-angle).sin_cos();
        for i in 0..masses.len() {
            let new = [positions[0][i] - after[0], positions[1][i] - after[1]];
            let rate = [slope[0][i] - drift[0], slope[1][i] - drift[1]];
            if !same {
                positions[0][i] = before[0] + c * new[0] - s * new[1];
                positions[1][i] = before[1] + s * new[0] + c * new[1];
            }
            slope[0][i] = c * rate[0] - s * rate[1];
            slope[1][i] = s * rate[0] + c * rate[1];
            let old = [start[0][i] - before[0], start[1][i] - before[1]];
            turn += masses[i] * (old[0] * slope[1][i] - old[1] * slope[0][i]);
        }
        // sum m (old x d new/dTa) = 0: a rotation at the rate w adds w sum m old . new to it
        let rate = -turn / cosine.hypot(sine);
        for i in 0..masses.len() {
            slope[0][i] -= rate * (positions[1][i] - before[1]);
            slope[1][i] += rate * (positions[0][i] - before[0]);
        }
        (positions, slope)
    }
}

/// Whether no force has a hold on the body as a whole.
fn adrift(system: &System) -> bool {
    system.passive.iter().all(|force| force.is_internal())
}

/// Holds one node, and another far from it across the line between them.
fn hold_three(positions: &Vectors, free: &mut [Vec<bool>; 2]) {
    let farthest = |from: usize| {
        let square = |i: usize| {
            (positions[0][i] - positions[0][from]).powi(2)
                + (positions[1][i] - positions[1][from]).powi(2)
        };
        (0..positions[0].len()).max_by(|&a, &b| square(a).total_cmp(&square(b))).unwrap_or(from)
    };
    if positions[0].is_empty() {
        return;
    }
    let first = farthest(0);
    let second = farthest(first);
    let arm = [0, 1].map(|axis| (positions[axis][second] - positions[axis][first]).abs());
    (free[0][first], free[1][first]) = (false, false);
    free[usize::from(arm[0] >= arm[1])][second] = false;
}

/// Largest absolute value, um; not a number if one is not.
pub(super) fn largest(vectors: &Vectors) -> f64 {
    vectors
        .iter()
        .flatten()
        .fold(0.0, |size: f64, value| if value.is_nan() { f64::NAN } else { size.max(value.abs()) })
}

fn moved(positions: &Vectors, direction: &Vectors, by: f64) -> Vectors {
    [0, 1]
        .map(|axis| positions[axis].iter().zip(&direction[axis]).map(|(x, d)| x + by * d).collect())
}

fn dot(a: &Vectors, b: &Vectors) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mechanics::active::ActiveLaw;
    use crate::mechanics::material::{assemble, default_material};
    use crate::mechanics::support::SupportKind;
    use crate::mesh::lattice;

    #[test]
    fn newtons_method_converges_quadratically_from_rest_to_full_tension() {
        let mesh = lattice::rectangle(20, 4, 1.0).unwrap();
        let fibres = vec![[0.8, 0.6]; mesh.simplices.len()];
        for support in [SupportKind::MassCentre, SupportKind::ClampedEnd] {
            let (body, system) = assemble(
                &mesh,
                &default_material(),
                ActiveLaw::Fibre,
                &fibres,
                support,
                [1.0, 0.0],
                20.0,
            );
            let rest = Solver::new(&system, &body).find(&body.positions, 50.0, 1e-9).unwrap();
            let sizes = rest.corrections;
            // Once near, each correction is of the order of the square of the one before, in um.
            let pairs: Vec<_> =
                sizes.windows(2).filter(|pair| pair[0] < 0.02 && pair[1] > 1e-12).collect();
            assert!(!pairs.is_empty(), "{sizes:?}");
            for pair in pairs {
                assert!(pair[1] < 10.0 * pair[0] * pair[0], "{support:?}: {sizes:?} um");
            }
        }
    }
}
