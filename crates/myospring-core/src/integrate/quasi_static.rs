//! The path of equilibria: the shape as a function of the tension alone.
//!
//! A contraction is quasi-static: the masses follow the tension without vibrating, because of
//! damping. If all forces have an energy, the shape then depends on the present tension and not on
//! time. [`Path`] solves
//!
//! ```text
//! f(x; Ta) = 0     from Ta = 0 to the largest tension
//! ```
//!
//! once, at a few load steps, and gives the shape at any tension by interpolation; a beat, a train
//! of beats or any other course of tension has no further cost.
//!
//! - Each load step: prediction by extrapolation, then Newton's method with the tangent stiffness `K`
//!   (sparse Cholesky) and a line search on the energy.
//! - Between load steps: the cubic polynomials that agree with the shapes and with their slopes
//!   `dx/dTa = K^-1 df/dTa` at both ends (Hermite's).
//! - Length of the load steps: from the error of that interpolation. Extrapolating the last cubic
//!   over the new step has the error `x''''/24 (h_1 + h_2)^2 h_2^2`, the new cubic at most
//!   `x''''/24 (h_2/2)^4`; the first can be measured, which gives the second.
//!
//! Guaranteed: at each load step the stiffness is positive definite, so the equilibrium is stable
//! and the one that a slow contraction reaches; if stability is lost (buckling, collapse), an error
//! states the tension. Where a factor of the stiffness is costly (thick cells), three load steps share
//! one: the last of them is shown to be stable by it, those before it only in the directions in which
//! they were corrected. The same input gives the same bits, of thick cells where products and sums are fused alike.
//!
//! Not supported (the error names an alternative): forces without an energy, active loads from
//! outside, damping so strong that it delays the shape. Inverted triangles are not an error here,
//! since a path does not use triangles: see [`Shapes::tensions`].

mod equilibrium;
mod error;
mod factor;
mod field;
mod nearby;
mod placement;
mod shapes;
mod tied;
mod tolerance;

pub use error::{PathError, WeakPlace};
pub use field::Equilibrium;
pub use shapes::Shapes;
pub use tolerance::Tolerance;

use crate::interruption::Interruption;
use crate::mechanics::stiffness::StiffnessMatrix;
use crate::mechanics::support::Support;
use crate::mechanics::{Body, Configuration, System, add_scaled, largest, zeros};
use crate::mesh::Place;
use equilibrium::{Failure, Kept, Rest, Solver};
use shapes::{Knot, between};
use std::ops::Deref;

/// If the error of a step of the least length exceeds the tolerance by this factor, the step leads
/// to another path: the cell snaps. A smaller error is a bend in the path, and counts in
/// [`Shapes::error`].
const TORN: f64 = 100.0;

/// Longest load step, kPa, for a body that tension hardly moves.
const LONGEST_STEP: f64 = 1000.0;

/// Part of the first load step that is tried first where the factor of its beginning is to serve to its end.
const SERVED: f64 = 0.125;

/// Load steps that are shown to be stable together, where that is costly.
const TOGETHER: usize = 3;

/// Where a branch ends.
#[derive(Debug, Clone, Copy)]
struct End {
    knots: usize,
    /// Length of the next load step, kPa.
    step: f64,
    error: f64,
}

/// The assessment of a load step.
#[derive(Debug, Clone, Copy)]
struct Judgement {
    /// Its error relative to the tolerance.
    ratio: f64,
    kept: bool,
}

/// What the search for a path has computed and would compute again, if that is costly. It is not part of a result: without it, and
/// after it was cloned, the path is the same to the last bit.
#[derive(Default)]
pub struct Workspace<const D: usize>(Option<Kept<D>>);

impl<const D: usize> Clone for Workspace<D> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

/// Equilibria from tension 0 upward and downward, as far as requested.
///
/// # Example
/// ```
/// use myospring::integrate::quasi_static::{Path, Tolerance};
/// use myospring::mechanics::active::ActiveLaw;
/// use myospring::mechanics::material::{assemble, default_material};
/// use myospring::mechanics::support::SupportKind;
/// use myospring::mesh::lattice;
///
/// let strip = lattice::rectangle(20, 4, 5.0)?;
/// let fibres = vec![[1.0, 0.0]; strip.simplices.len()];
/// let (body, system) = assemble(
///     &strip, &default_material(), ActiveLaw::Fibre, &fibres, SupportKind::MassCentre, [1.0, 0.0], 100.0,
/// );
/// let path = Path::solve(&system, &body, 50.0, Tolerance::default())?;
/// // Node 0 is the strip's lower left corner, node 20 its lower right one.
/// let [x, _] = path.positions(35.0).ok_or("35 kPa lies on the way to 50")?;
/// assert!(((x[20] - x[0]) / 100.0 - 0.9123).abs() < 1e-4);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Path<'a, const D: usize = 2> {
    solver: Solver<'a, D>,
    shapes: Shapes<D>,
}

/// A path dereferences to the shapes found so far.
impl<const D: usize> Deref for Path<'_, D> {
    type Target = Shapes<D>;

    fn deref(&self) -> &Shapes<D> {
        &self.shapes
    }
}

impl<'a, const D: usize> Path<'a, D> {
    /// Computes the path from rest to a largest tension in kPa (negative: the active force pushes),
    /// or slightly beyond it.
    ///
    /// The body's velocities are ignored; its positions define mass centre and orientation.
    ///
    /// # Errors
    /// Every [`PathError`]: unsupported forces, and paths that end before the largest tension.
    pub fn solve(
        system: &'a System<D>,
        body: &'a Body<D>,
        largest_tension: f64,
        tolerance: Tolerance,
    ) -> Result<Self, PathError> {
        let mut path = Self::start(system, body, tolerance, &Interruption::default())?;
        path.extend(largest_tension)?;
        Ok(path)
    }

    /// Computes the path's first point, the body without tension; [`Path::extend`] continues from
    /// there. The search can be interrupted, now and later.
    ///
    /// # Errors
    /// Unsupported forces; a body that is unstable without tension; [`PathError::Interrupted`].
    pub fn start(
        system: &'a System<D>,
        body: &'a Body<D>,
        tolerance: Tolerance,
        interruption: &Interruption,
    ) -> Result<Self, PathError> {
        let stiffness = check_forces(system, body, interruption)?;
        let extent = extent(body);
        let kept = Kept::new(system, body, stiffness);
        let mut solver = Solver::continued(system, body, Some(kept), interruption);
        let rest = solver
            .find_from_afar(&body.positions, tolerance.equilibrium * extent)
            .map_err(|failure| ending(failure, body, [0.0; 2], None))?;
        // Power of the damping when the shape moves at the rate `slope` per kPa and ms, divided by
        // the power of its elastic forces: the delay of the shape.
        let at = Configuration {
            positions: &rest.positions,
            velocities: &rest.slope,
            tension: 0.0.into(),
        };
        let delay =
            if rest.compliance > 0.0 { system.dissipation(&at) / rest.compliance } else { 0.0 };
        if delay > tolerance.longest_delay {
            return Err(PathError::Delayed { delay, longest: tolerance.longest_delay });
        }
        let newton_iterations = rest.corrections.len();
        let knot = Knot { tension: 0.0, positions: rest.positions, slope: rest.slope };
        let shapes = Shapes {
            tolerance,
            extent,
            branches: [vec![knot.clone()], vec![knot]],
            steps: [0.0; 2],
            error: 0.0,
            delay,
            newton_iterations,
            factorisations: solver.factorisations,
            one_by_one: [false; 2],
        };
        Ok(Self { solver, shapes })
    }

    /// Continues a path from shapes found before for the same forces and body; its search can be
    /// interrupted.
    pub fn resume(
        system: &'a System<D>,
        body: &'a Body<D>,
        (shapes, workspace): (Shapes<D>, Workspace<D>),
        interruption: &Interruption,
    ) -> Self {
        Self { solver: Solver::continued(system, body, workspace.0, interruption), shapes }
    }

    /// The shapes, without the body and its forces, and what a path that continues need not compute again.
    pub fn into_parts(self) -> (Shapes<D>, Workspace<D>) {
        (self.shapes, Workspace(self.solver.keep()))
    }

    /// Extends the path to a tension in kPa, if it has not reached it yet.
    ///
    /// # Errors
    /// [`PathError::Unstable`], [`PathError::Lost`] or [`PathError::TooLarge`] if the path ends
    /// before; the path then ends at the last stable equilibrium. [`PathError::NotFinite`] for a
    /// tension that is not finite; [`PathError::Interrupted`] if the search was interrupted; it can
    /// be continued later.
    pub fn extend(&mut self, tension: f64) -> Result<(), PathError> {
        if !tension.is_finite() {
            return Err(PathError::NotFinite { tension });
        }
        let side = usize::from(tension > 0.0);
        let direction = if tension > 0.0 { 1.0 } else { -1.0 };
        let before = self.solver.factorisations;
        let reached = self.extend_branch(side, direction, tension.abs());
        self.shapes.factorisations += self.solver.factorisations - before;
        reached
    }

    /// Load steps do not depend on the requested tension, and the last ones go beyond it, so the
    /// path to a tension is bitwise the beginning of any longer path.
    ///
    /// Where factors are costly, load steps are found with the factor of one before, and a few of them are shown to be stable by that of
    /// the last one, which then serves the next. If it shows the contrary, they are made again, each with its own factor.
    fn extend_branch(
        &mut self,
        side: usize,
        direction: f64,
        tension: f64,
    ) -> Result<(), PathError> {
        // The straight line from rest moves no point by more than a twentieth of the body.
        let rate = largest(&self.branches[side][0].slope).max(f64::MIN_POSITIVE);
        let first_step = (0.05 * self.extent / rate).min(LONGEST_STEP);
        let mut shown = self.end(side);
        loop {
            let last = self.last(side).tension.abs();
            let open = self.branches[side].len() - shown.knots;
            if last >= tension && open == 0 {
                return Ok(());
            }
            let first = self.branches[side].len() == 1;
            if self.steps[side] == 0.0 {
                let rest = &self.shapes.branches[side][0];
                if self.solver.stand(rest) == Err(Failure::Interrupted) {
                    return Err(PathError::Interrupted);
                }
                let part = if self.solver.keeps_factor() { SERVED } else { 1.0 };
                self.shapes.steps[side] = part * first_step;
            }
            let reached = if first { self.tolerance.smallest_step * first_step } else { last };
            let smallest = self.tolerance.smallest_step * reached;
            let step = self.steps[side].clamp(smallest, LONGEST_STEP);
            let shortest = step <= smallest;
            let tried = self.try_step(side, open == 0, direction * step, shortest);
            let mut failure = match tried {
                Ok(Judgement { ratio, kept }) => {
                    // The next step keeps a margin below what the error allows.
                    self.shapes.steps[side] = step * (0.8 * ratio.powf(-0.25)).clamp(0.2, 3.0);
                    (shortest && !kept).then_some(Failure::NoRest)
                }
                Err(Failure::Interrupted) => Some(Failure::Interrupted),
                Err(failure) => {
                    self.shapes.steps[side] = 0.5 * step;
                    (shortest || matches!(failure, Failure::TooLarge { .. })).then_some(failure)
                }
            };
            let open = self.branches[side].len() - shown.knots;
            let ends = tried.is_err() || failure.is_some();
            let together = if self.solver.keeps_factor() { TOGETHER } else { 1 };
            if open > 0 && (open >= together || ends) && failure != Some(Failure::Interrupted) {
                let last = &self.shapes.branches[side][shown.knots + open - 1];
                match self.solver.stand(last) {
                    // What comes beyond the tension does not matter.
                    Ok(true) if last.tension.abs() >= tension => return Ok(()),
                    Ok(true) => shown = self.end(side),
                    Ok(false) => {
                        self.go_back(side, shown);
                        self.shapes.one_by_one[side] = true;
                        failure = None;
                    }
                    Err(other) => failure = Some(other),
                }
            }
            if let Some(failure) = failure {
                self.go_back(side, shown);
                // The path is then as before these steps, so it can be continued.
                if failure == Failure::Interrupted {
                    return Err(PathError::Interrupted);
                }
                let Knot { tension, positions, .. } = self.last(side).clone();
                let softest = self.solver.softest_node(&positions, tension.into());
                let place =
                    softest.map(|node| WeakPlace { node, place: Place::of(&positions, node) });
                let tensions = [tension, tension + direction * step];
                return Err(ending(failure, self.solver.body(), tensions, place));
            }
        }
    }

    /// Tries a load step; what the last ones have shown to be stable ends where it begins, unless others are open.
    fn try_step(
        &mut self,
        side: usize,
        all_shown: bool,
        step: f64,
        shortest: bool,
    ) -> Result<Judgement, Failure> {
        self.solver.nearby = !self.one_by_one[side];
        let last = self.shapes.branches[side].last();
        if let Some(last) = last.filter(|_| all_shown)
            && !self.solver.stand(last)?
        {
            return Err(Failure::Indefinite);
        }
        if self.branches[side].len() == 1 {
            self.first_step(side, step, shortest)
        } else {
            self.next_step(side, step, shortest)
        }
    }

    /// The end of a branch as it is now.
    fn end(&self, side: usize) -> End {
        End { knots: self.branches[side].len(), step: self.steps[side], error: self.error }
    }

    /// Takes load steps back that are not shown to be stable.
    fn go_back(&mut self, side: usize, end: End) {
        if self.branches[side].len() > end.knots {
            self.shapes.branches[side].truncate(end.knots);
            self.shapes.steps[side] = end.step;
            self.shapes.error = end.error;
        }
    }

    /// The farthest equilibrium of a branch.
    fn last(&self, side: usize) -> &Knot<D> {
        let branch = &self.branches[side];
        &branch[branch.len() - 1]
    }

    fn find(&mut self, guess: &Knot<D>) -> Result<(Knot<D>, f64), Failure> {
        let tolerance = self.tolerance.equilibrium * self.extent;
        let Rest { positions, slope, corrections, .. } = self.solver.find(guess, tolerance)?;
        self.shapes.newton_iterations += corrections.len();
        let mut missed = 0.0_f64;
        for axis in 0..D {
            for (a, b) in positions[axis].iter().zip(&guess.positions[axis]) {
                missed = missed.max((a - b).abs());
            }
        }
        Ok((Knot { tension: guess.tension, positions, slope }, missed))
    }

    /// Compares the error of a step with the tolerance; the knots are kept if it is within, or if
    /// the step cannot be shorter and the path is not torn.
    fn judge(&mut self, side: usize, error: f64, shortest: bool, knots: Vec<Knot<D>>) -> Judgement {
        let Tolerance { interpolation, equilibrium, .. } = self.tolerance;
        // The residual of Newton's method does not count as interpolation error.
        let allowed = interpolation.max(10.0 * equilibrium) * self.extent;
        // Twice, because the fourth derivative is not constant.
        let ratio = 2.0 * error / allowed;
        let kept = ratio <= 1.0 || (shortest && ratio <= TORN);
        if kept {
            self.shapes.error = self.error.max(2.0 * error);
            self.shapes.branches[side].extend(knots);
        }
        Judgement { ratio, kept }
    }

    /// Two half steps from rest: there is no earlier step to extrapolate, so the middle serves as
    /// the check.
    fn first_step(&mut self, side: usize, step: f64, shortest: bool) -> Result<Judgement, Failure> {
        let rest = self.branches[side][0].clone();
        let mut guess = Knot { tension: step, ..rest.clone() };
        add_scaled(&mut guess.positions, step, &rest.slope);
        let (end, _) = self.find(&guess)?;
        let (middle, missed) = self.find(&between(&rest, &end, 0.5 * step))?;
        // With half the length, a cubic has 1/16 of the error.
        Ok(self.judge(side, missed / 16.0, shortest, vec![middle, end]))
    }

    fn next_step(&mut self, side: usize, step: f64, shortest: bool) -> Result<Judgement, Failure> {
        let branch = &self.branches[side];
        let (before, last) = (&branch[branch.len() - 2], &branch[branch.len() - 1]);
        let (done, tension) = (last.tension - before.tension, last.tension + step);
        let guess = between(before, last, tension);
        let (knot, missed) = self.find(&guess)?;
        let error = missed * (step / (4.0 * (done + step))).powi(2);
        Ok(self.judge(side, error, shortest, vec![knot]))
    }
}

/// Largest extent of a body along an axis, um.
fn extent<const D: usize>(body: &Body<D>) -> f64 {
    let along = |axis: &Vec<f64>| {
        axis.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - axis.iter().copied().fold(f64::INFINITY, f64::min)
    };
    body.positions.iter().map(along).fold(0.0, f64::max)
}

fn ending<const D: usize>(
    failure: Failure,
    body: &Body<D>,
    [tension, beyond]: [f64; 2],
    place: Option<WeakPlace>,
) -> PathError {
    match failure {
        Failure::Indefinite | Failure::NoRest if tension == 0.0 => PathError::AtRest { place },
        Failure::Indefinite => PathError::Unstable { tension, beyond, place },
        Failure::NoRest => PathError::Lost { tension, beyond, place },
        Failure::TooLarge { bytes } => {
            PathError::TooLarge { masses: body.len(), gb: bytes as f64 / 1e9 }
        }
        Failure::Interrupted => PathError::Interrupted,
    }
}

/// Checks that the shape depends on the tension alone; returns a stiffness with all its blocks.
fn check_forces<const D: usize>(
    system: &System<D>,
    body: &Body<D>,
    interruption: &Interruption,
) -> Result<StiffnessMatrix<D>, PathError> {
    let still = zeros(body.len());
    let at = Configuration { positions: &body.positions, velocities: &still, tension: 1.0.into() };
    // Holding the mass centre removes the resultant of outer forces, and that has no energy.
    let held = system.support != Support::MassCentre;
    let mut stiffness = StiffnessMatrix::new(body.len());
    let mut tied = system.forces().filter(|force| force.compliance().is_some());
    if let Some(second) = tied.nth(1) {
        return Err(PathError::NoStiffness { force: second.name() });
    }
    let passive = system.passive.iter().map(|force| (force, held));
    for (force, may_be_external) in passive.chain(system.active.iter().map(|force| (force, false)))
    {
        interruption.check()?;
        let name = force.name();
        if force.energy(&at).is_none() {
            return Err(PathError::NoEnergy { force: name });
        }
        if !force.is_internal() && !may_be_external {
            return Err(PathError::External { force: name });
        }
        if !force.add_stiffness(&at, &mut stiffness) {
            return Err(PathError::NoStiffness { force: name });
        }
    }
    Ok(stiffness)
}

#[cfg(test)]
mod tests;
