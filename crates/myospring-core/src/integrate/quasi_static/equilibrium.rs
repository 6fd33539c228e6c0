//! One equilibrium: Newton's method with a line search on the energy.
//!
//! ```text
//! K(x) dx = f(x; Ta),     x <- x + s dx,     s = 1, 1/2, 1/4, ... until the energy drops
//! ```

use super::factor::{Factor, FactorError};
use super::nearby::{self, Nearby};
use super::placement::{adrift, free, in_place};
use super::shapes::Knot;
use super::tied;
use crate::interruption::Interruption;
use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::support::Support;
use crate::mechanics::{
    Body, Configuration, Force, System, Tension, Vectors, largest, product, zeros,
};
use std::array::from_fn;

/// Why an equilibrium was not found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Failure {
    /// The stiffness is not positive definite.
    Indefinite,
    /// Newton's method does not converge.
    NoRest,
    /// The factors do not fit into memory.
    TooLarge {
        /// What they take at least, bytes.
        bytes: usize,
    },
    /// It was interrupted.
    Interrupted,
}

impl From<FactorError> for Failure {
    fn from(error: FactorError) -> Self {
        match error {
            FactorError::Indefinite => Self::Indefinite,
            FactorError::TooLarge { bytes } => Self::TooLarge { bytes },
            FactorError::Interrupted => Self::Interrupted,
        }
    }
}

/// Iterations of Newton's method with a stiffness that is not positive definite, after which a guess was too far.
const INDEFINITE: usize = 3;

/// Largest number of iterations of Newton's method.
const ITERATIONS: usize = 25;

/// How well a body is solved for: for a correction, after which others follow, and for what is kept. A part of the forces between it and
/// another one that it is tied to; with a rounded factor a part of the displacements, in the norm of the stiffness.
const INEXACT: f64 = 1e-5;
const EXACT: f64 = 1e-10;
/// The same with a stiffness near one whose factor is known, for a correction: Newton's method leaves more of it.
const NEARLY: f64 = 1e-3;
/// The same for the first correction of a thick body, of which Newton's method leaves most.
const FIRST_NEARLY: f64 = 1e-2;
/// The same for a slope of a flat and of a thick body, which is kept: far below what the interpolation between two tensions may be off. Between
/// tensions that differ by `h` a relative error `e` of slopes moves it by at most `e h |slope| / 4`, where `h |slope|` is some
/// hundredths of the length.
const SLOPE: [f64; 2] = [1e-7, 1e-6];

/// A correction with an old factor is at most this part of the one before; otherwise the factor is too far from the stiffness.
const FALLS: f64 = 0.3;
/// Most corrections with an old factor.
const MOST_USES: usize = 20;
/// A factor that took more corrections than this is made anew for the next equilibrium.
const FEW_USES: usize = 8;
/// Most equilibria that a factor serves: a new one shows that they are stable.
const MOST_SERVED: usize = 10;
/// Part of the tolerance that these corrections may leave: the coupling compares equilibria with each other.
const LEFT: f64 = 1e-4;

/// A stable equilibrium.
pub(super) struct Rest<const D: usize> {
    /// Positions, um.
    pub(super) positions: Vectors<D>,
    /// Their derivative with respect to tension, um/kPa.
    pub(super) slope: Vectors<D>,
    /// Largest corrections of Newton's method, um, one per iteration.
    pub(super) corrections: Vec<f64>,
    /// Decrease of the active energy per kPa along `slope`, fJ/kPa^2: slope . K slope.
    pub(super) compliance: f64,
}

/// What a solver has of a body: the pattern of its stiffness, and the factor at the tension (kPa) of one equilibrium.
pub(super) struct Kept<const D: usize> {
    factor: Factor<D>,
    stiffness: StiffnessMatrix<D>,
    stands_at: Option<f64>,
}

impl<const D: usize> Kept<D> {
    /// At the start: a stiffness, whose blocks need not be found again.
    pub(super) fn new(system: &System<D>, body: &Body<D>, stiffness: StiffnessMatrix<D>) -> Self {
        let free = free(system, body);
        let tied = system.compliance().is_some();
        let factor = if tied { Factor::whole(free) } else { Factor::new(free) };
        Self { factor, stiffness, stands_at: None }
    }
}

/// Finds equilibria of one body.
pub(super) struct Solver<'a, const D: usize = 2> {
    system: &'a System<D>,
    body: &'a Body<D>,
    still: Vectors<D>,
    factor: Factor<D>,
    stiffness: StiffnessMatrix<D>,
    /// What another thread adds to it.
    beside: StiffnessMatrix<D>,
    /// Whether the factor is that of the stiffness, not of one nearby.
    is_factor: bool,
    /// Whether there is a factor, and the last equilibrium took few uses of it.
    serves: bool,
    /// Equilibria that it has served.
    served: usize,
    /// Whether equilibria are found with the factor of one nearby, if another one is costly.
    pub(super) nearby: bool,
    /// The tension of the equilibrium whose factor it is, kPa, if it is that of one.
    stands_at: Option<f64>,
    /// Matrices factorised so far.
    pub(super) factorisations: usize,
    /// Checked within each factorisation.
    interruption: Interruption,
}

impl<'a, const D: usize> Solver<'a, D> {
    /// A solver that goes on with what another one kept of the same body.
    pub(super) fn continued(
        system: &'a System<D>,
        body: &'a Body<D>,
        kept: Option<Kept<D>>,
        interruption: &Interruption,
    ) -> Self {
        let Kept { factor, stiffness, stands_at } =
            kept.unwrap_or_else(|| Kept::new(system, body, StiffnessMatrix::new(body.len())));
        Self {
            system,
            body,
            still: zeros(body.len()),
            factor,
            stiffness,
            beside: StiffnessMatrix::new(if D > 2 { body.len() } else { 0 }),
            is_factor: false,
            serves: false,
            served: 0,
            nearby: true,
            stands_at,
            factorisations: 0,
            interruption: interruption.clone(),
        }
    }

    /// What serves a solver that continues, where it is costly.
    pub(super) fn keep(self) -> Option<Kept<D>> {
        let serves = self.factor.is_costly() && self.system.compliance().is_none();
        let Self { factor, stiffness, stands_at, .. } = self;
        serves.then_some(Kept { factor, stiffness, stands_at })
    }

    /// The body at its start.
    pub(super) fn body(&self) -> &'a Body<D> {
        self.body
    }

    fn forces(&self, positions: &Vectors<D>, tension: Tension<'_>) -> Vectors<D> {
        let mut forces = zeros(self.body.len());
        let at = Configuration { positions, velocities: &self.still, tension };
        self.system.sum_forces(&at, &mut forces);
        forces
    }

    /// Total energy and the size of its parts, fJ.
    fn energy(&self, positions: &Vectors<D>, tension: Tension<'_>) -> [f64; 2] {
        let at = Configuration { positions, velocities: &self.still, tension };
        let parts = [self.system.elastic_energy(&at), self.system.active_energy(&at)];
        [parts[0] + parts[1], parts[0].abs() + parts[1].abs()]
    }

    /// Derivative of the active forces with respect to tension, nN/kPa.
    fn load(&self, positions: &Vectors<D>, tension: f64) -> Vectors<D> {
        let mut load = zeros(self.body.len());
        // Active forces are proportional to tension, so the difference over 1 kPa is exact.
        let [mut more, mut less] = [zeros(self.body.len()), zeros(self.body.len())];
        for (sum, tension) in [(&mut more, tension + 0.5), (&mut less, tension - 0.5)] {
            let tension = tension.into();
            let at = Configuration { positions, velocities: &self.still, tension };
            for force in &self.system.active {
                force.add_forces(&at, sum);
            }
        }
        for axis in 0..D {
            for node in 0..load[axis].len() {
                load[axis][node] = more[axis][node] - less[axis][node];
            }
        }
        load
    }

    /// Computes the stiffness and its factor.
    pub(super) fn factorise(
        &mut self,
        positions: &Vectors<D>,
        tension: Tension<'_>,
    ) -> Result<(), Failure> {
        self.assemble(positions, tension);
        self.renew()
    }

    /// Computes the stiffness; a factor that is costly stays that of the last one.
    fn approach(&mut self, positions: &Vectors<D>, tension: Tension<'_>) -> Result<(), Failure> {
        self.assemble(positions, tension);
        if self.keeps_factor() {
            self.is_factor = false;
            return Ok(());
        }
        self.renew()
    }

    /// Whether a factor serves for equilibria nearby.
    pub(super) fn keeps_factor(&self) -> bool {
        self.nearby
            && self.factor.is_costly()
            && self.factor.is_made()
            && self.system.compliance().is_none()
    }

    /// Lets equilibria share factors or not, whatever these cost.
    #[cfg(test)]
    pub(super) fn share_factors(&mut self, shares: bool) {
        self.factor.is_to_be_costly(shares);
        self.stands_at = None;
    }

    /// Shows that an equilibrium is stable, by the factor of its stiffness, with which the next ones are found; returns whether it is. Where each
    /// equilibrium has its own factor, all were shown already.
    pub(super) fn stand(&mut self, at: &Knot<D>) -> Result<bool, Failure> {
        let serves = self.nearby && self.system.compliance().is_none();
        if !serves || self.stands_at == Some(at.tension) {
            return Ok(true);
        }
        if !self.factor.is_analysed() {
            self.assemble(&at.positions, at.tension.into());
            self.factor.analyse(&self.body.positions, &self.stiffness, &self.interruption)?;
        }
        if !self.factor.is_costly() {
            return Ok(true);
        }
        self.assemble(&at.positions, at.tension.into());
        match self.renew() {
            Ok(()) => self.stands_at = Some(at.tension),
            Err(Failure::Indefinite) => return Ok(false),
            Err(failure) => return Err(failure),
        }
        Ok(true)
    }

    fn assemble(&mut self, positions: &Vectors<D>, tension: Tension<'_>) {
        let at = Configuration { positions, velocities: &self.still, tension };
        let fill = |matrix: &mut StiffnessMatrix<D>, forces: &[&dyn Force<D>]| {
            matrix.clear();
            for force in forces {
                force.add_stiffness(&at, matrix);
            }
        };
        let forces = self.system.passive.iter().chain(&self.system.active);
        let forces: Vec<&dyn Force<D>> = forces.map(AsRef::as_ref).collect();
        if D == 2 {
            fill(&mut self.stiffness, &forces);
            return;
        }
        // Thick bodies have many blocks: two threads add up theirs.
        let (first, others) = forces.split_at(1.min(forces.len()));
        let [one, other] = [&mut self.stiffness, &mut self.beside];
        rayon::join(|| fill(one, first), || fill(other, others));
        one.add_all(other);
    }

    /// Computes the factor of the stiffness.
    fn renew(&mut self) -> Result<(), Failure> {
        self.factorisations += 1;
        self.is_factor = false;
        (self.serves, self.served, self.stands_at) = (false, 0, None);
        self.factor.factorise(&self.body.positions, &self.stiffness, &self.interruption)?;
        self.is_factor = true;
        Ok(())
    }

    /// Displacements (um) under forces (nN), with the last factor.
    pub(super) fn response(&mut self, forces: &Vectors<D>) -> Vectors<D> {
        self.by_factor(forces, EXACT)
    }

    fn by_factor(&mut self, forces: &Vectors<D>, tolerance: f64) -> Vectors<D> {
        match self.system.compliance() {
            Some(other) => tied::solve(&self.factor, other, forces, tolerance),
            None if self.factor.is_rounded() => {
                nearby::solve_by_rounded(&self.factor, &self.stiffness, forces, tolerance)
            }
            None => self.factor.solve(forces),
        }
    }

    /// A correction (um) under forces (nN), with the last stiffness, and whether it is near Newton's. Where the stiffness is not positive
    /// definite, it is a direction in which the energy falls, or `renews` a failure.
    fn correct(
        &mut self,
        forces: &Vectors<D>,
        tolerance: f64,
        is_first: bool,
        renews: bool,
    ) -> Result<(Vectors<D>, bool), Failure> {
        if !self.is_factor {
            let part = if D > 2 && is_first { FIRST_NEARLY } else { NEARLY };
            match nearby::solve(&self.factor, &self.stiffness, forces, part, tolerance) {
                Nearby::Solved(moved) => return Ok((moved, true)),
                Nearby::Indefinite(moved) if !renews => {
                    return Ok((moved, false));
                }
                _ => self.renew()?,
            }
        }
        Ok((self.by_factor(forces, INEXACT), true))
    }

    /// The equilibrium at a tension near a guess, with its slope; corrections below `tolerance` (um) end the search.
    pub(super) fn find(&mut self, guess: &Knot<D>, tolerance: f64) -> Result<Rest<D>, Failure> {
        let Knot { tension, positions, slope } = guess;
        let (positions, corrections) =
            self.settle(positions, (*tension).into(), tolerance, false)?;
        self.at_rest(positions, *tension, Some(slope), corrections)
    }

    /// As [`Solver::find`] without tension, where loads from outside may be far from a guess: a step to where the stiffness is
    /// not positive definite is shortened.
    pub(super) fn find_from_afar(
        &mut self,
        guess: &Vectors<D>,
        tolerance: f64,
    ) -> Result<Rest<D>, Failure> {
        self.nearby = false;
        let settled = self.settle(guess, 0.0.into(), tolerance, true);
        self.nearby = true;
        let (positions, corrections) = settled?;
        if self.is_factor && positions == *guess {
            self.stands_at = Some(0.0);
        }
        self.at_rest(positions, 0.0, None, corrections)
    }

    /// Moves the body to the equilibrium under any tension near a guess; returns the largest
    /// corrections of Newton's method, um, one per iteration.
    pub(super) fn settle_in_place(
        &mut self,
        guess: &Vectors<D>,
        tension: Tension<'_>,
        tolerance: f64,
    ) -> Result<(Vectors<D>, Vec<f64>), Failure> {
        let nearby = self.settle_nearby(guess, tension, tolerance)?;
        let (positions, corrections) = if let Some(found) = nearby {
            found
        } else {
            // Each correction with its own factor, the last of which shows that the equilibrium is stable.
            self.nearby = false;
            let found = self.settle(guess, tension, tolerance, false);
            self.nearby = true;
            let found = found?;
            self.serves = self.is_factor;
            found
        };
        let positions = match self.system.support {
            Support::MassCentre | Support::Free if adrift(self.system) => {
                in_place(self.body, positions, zeros(self.body.len())).0
            }
            _ => positions,
        };
        Ok((positions, corrections))
    }

    /// Corrections with one factor, the last one where it serves: a use of it costs a small part of a new one, and a small change of
    /// tension changes the stiffness little. `None` if they do not fall fast enough.
    ///
    /// That they fall shows that the stiffness is positive definite in the directions in which the body was off: each is multiplied by
    /// one minus a ratio of stiffnesses. In all directions a new factor shows it, at the latest after ten equilibria.
    fn settle_nearby(
        &mut self,
        guess: &Vectors<D>,
        tension: Tension<'_>,
        tolerance: f64,
    ) -> Result<Option<(Vectors<D>, Vec<f64>)>, Failure> {
        if self.system.compliance().is_some() {
            return Ok(None);
        }
        if !self.serves || self.served >= MOST_SERVED {
            self.assemble(guess, tension);
            match self.renew() {
                Err(Failure::Indefinite) => return Ok(None),
                renewed => renewed?,
            }
        }
        self.is_factor = false;
        self.served += 1;
        let mut positions = guess.clone();
        let mut corrections: Vec<f64> = Vec::new();
        while corrections.len() < MOST_USES {
            if self.interruption.is_requested() {
                return Err(Failure::Interrupted);
            }
            let forces = self.forces(&positions, tension);
            let correction = self.factor.solve(&forces);
            let size = largest(&correction);
            let part = corrections.last().map_or(FALLS, |last| size / last);
            corrections.push(size);
            if part.is_nan() || part > FALLS {
                break;
            }
            // A body that is already at rest is not changed.
            if corrections.len() > 1 || size > 1e-3 * tolerance {
                positions = moved(&positions, &correction, 1.0);
            }
            if size * part <= LEFT * tolerance {
                self.serves = corrections.len() <= FEW_USES;
                return Ok(Some((positions, corrections)));
            }
        }
        self.serves = false;
        Ok(None)
    }

    fn settle(
        &mut self,
        guess: &Vectors<D>,
        tension: Tension<'_>,
        tolerance: f64,
        shortens: bool,
    ) -> Result<(Vectors<D>, Vec<f64>), Failure> {
        let mut positions = guess.clone();
        let mut corrections = Vec::new();
        // The last step: from where, in which direction, and how far.
        let mut last: Option<(Vectors<D>, Vectors<D>, f64)> = None;
        let mut energy = self.energy(&positions, tension);
        if !energy[0].is_finite() {
            return Err(Failure::Indefinite);
        }
        let mut indefinite = 0;
        for _ in 0..ITERATIONS {
            let forces = self.forces(&positions, tension);
            match (self.approach(&positions, tension), &mut last) {
                (Err(Failure::Indefinite), Some((from, direction, part))) if shortens => {
                    *part *= 0.5;
                    positions = moved(from, direction, *part);
                    energy = self.energy(&positions, tension);
                    continue;
                }
                (factorised, _) => factorised?,
            }
            let (correction, near) =
                self.correct(&forces, tolerance, corrections.is_empty(), indefinite >= INDEFINITE)?;
            indefinite += usize::from(!near);
            let largest = largest(&correction);
            if !largest.is_finite() {
                return Err(Failure::NoRest);
            }
            corrections.push(largest);
            if near && largest <= tolerance {
                // A body that is already at rest is not changed.
                if corrections.len() > 1 || largest > 1e-3 * tolerance {
                    positions = moved(&positions, &correction, 1.0);
                }
                return Ok((positions, corrections));
            }
            // K is positive definite, or it was chosen so: the energy falls in this direction, at this rate.
            let drop = product(&forces, &correction);
            let mut part = 1.0;
            loop {
                let trial = moved(&positions, &correction, part);
                let there = self.energy(&trial, tension);
                // Armijo's rule; rounding in the energy must not stop the last steps.
                if there[0] <= energy[0] - 1e-4 * part * drop + 1e-13 * (energy[1] + there[1]) {
                    let from = std::mem::replace(&mut positions, trial);
                    energy = there;
                    last = shortens.then(|| (from, correction.clone(), part));
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
    pub(super) fn softest_node(
        &mut self,
        positions: &Vectors<D>,
        tension: Tension<'_>,
    ) -> Option<usize> {
        const ROUNDS: usize = 20;
        self.factorise(positions, tension).ok()?;
        let count = self.body.len();
        // A fixed, irregular start: fractional parts of multiples of the golden ratio.
        let mut mode: Vectors<D> = from_fn(|axis| {
            (0..count)
                .map(|i| ((D * i + axis + 1) as f64 * 0.618_033_988_749_894_9).fract() - 0.5)
                .collect()
        });
        for _ in 0..ROUNDS {
            for axis in &mut mode {
                axis.iter_mut().zip(&self.body.masses).for_each(|(x, mass)| *x *= mass);
            }
            mode = self.by_factor(&mode, INEXACT);
            if adrift(self.system) && !matches!(self.system.support, Support::Clamped(_)) {
                mode = in_place(self.body, positions.clone(), mode).1;
            }
            let size = largest(&mode);
            mode.iter_mut().flatten().for_each(|x| *x /= size);
        }
        let square = |node: usize| mode.iter().map(|axis| axis[node].powi(2)).sum::<f64>();
        (0..count).max_by(|&a, &b| square(a).total_cmp(&square(b)))
    }

    /// Removes rigid motion and computes the slope, from the last stiffness. Its factor, if there is one, shows that it is positive definite.
    fn at_rest(
        &mut self,
        positions: Vectors<D>,
        tension: f64,
        guess: Option<&Vectors<D>>,
        corrections: Vec<f64>,
    ) -> Result<Rest<D>, Failure> {
        let load = self.load(&positions, tension);
        // 0 = d f/d Ta = load - K dx/dTa
        let slope = match guess.filter(|_| !self.is_factor) {
            Some(guess) => {
                let tolerance = SLOPE[usize::from(D > 2)];
                nearby::solve_from(&self.factor, &self.stiffness, &load, guess, tolerance).solved()
            }
            None => None,
        };
        let slope = if let Some(slope) = slope {
            slope
        } else {
            if !self.is_factor {
                self.renew()?;
            }
            self.response(&load)
        };
        let compliance = product(&slope, &load);
        let (positions, slope) = match self.system.support {
            Support::MassCentre | Support::Free if adrift(self.system) => {
                in_place(self.body, positions, slope)
            }
            _ => (positions, slope),
        };
        Ok(Rest { positions, slope, corrections, compliance })
    }
}

fn moved<const D: usize>(positions: &Vectors<D>, direction: &Vectors<D>, by: f64) -> Vectors<D> {
    from_fn(|axis| positions[axis].iter().zip(&direction[axis]).map(|(x, d)| x + by * d).collect())
}

#[cfg(test)]
mod tests;
