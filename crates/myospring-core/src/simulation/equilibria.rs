//! The equilibria of a mesh under one tension, with any support.
//!
//! Length, width, area and energies are functions of the tension alone. They are computed at nine
//! tensions in each load step and interpolated by cubics through four of them: exact for lengths
//! along an axis that does not rotate, which are cubic polynomials of the tension. Shapes come from
//! the path itself.
//!
//! An afterloaded cell has two branches: clamped at its stop, and shortened against its load. Until
//! it pulls harder than the load it is at its stop, so its state does not depend on its history.

use super::fault::fault;
use super::gauges::GAUGES;
use super::setup::{Assembly, in_steps};
use super::space::Space;
use super::{SettingError, SetupError, Simulation, StopReason};
use crate::integrate::quasi_static::{Path, PathError, Shapes, Tolerance, Workspace};
use crate::interruption::Interrupted;
use crate::mechanics::{Configuration, Vectors, product, zeros};
use std::sync::Arc;

/// Intervals at whose ends a load step is measured.
const PARTS: usize = 8;

/// First and largest tension of a search for a shortening, kPa; no cell pulls harder than the
/// largest.
const FIRST_TENSION: f64 = 1.0;
const LARGEST_TENSION: f64 = 1e5;

/// Margin of the solved tensions: a beat's peak differs from that of the reference beat by some
/// 1e-4, and in a train it may still rise.
pub(super) const MARGIN: f64 = 1e-3;

/// The response of a mesh in equilibrium to one tension: its equilibria, or a table of them.
pub trait TensionResponse: Send + Sync {
    /// Shortening, a part of the length before a beat, under a tension in kPa, and its derivative, 1/kPa.
    fn shortening(&self, tension: f64) -> [f64; 2];
    /// The largest of these derivatives, 1/kPa.
    fn steepest(&self) -> f64;
    /// The highest tension of the table, kPa; beyond it shortening is extrapolated linearly.
    fn highest(&self) -> f64;
    /// The stretch of the cell between the clamps at a shortening.
    fn stretch(&self, shortening: f64) -> f64 {
        1.0 - shortening
    }
    /// A force, moment or energy of the support by its name, such as [`AXIAL_FORCE`](crate::recording::AXIAL_FORCE), in nN or fJ, and its
    /// derivative by the tension; `None` if the support has none of this name.
    fn load(&self, _name: &str, _tension: f64) -> Option<[f64; 2]> {
        None
    }
}

/// The equilibria of one mesh for every tension of a range.
#[derive(Clone)]
pub struct Equilibria<const D: usize = 2, const N: usize = 3> {
    pub(super) held: Branch<D, N>,
    /// For an afterloaded cell: the equilibria away from its stop.
    pub(super) loaded: Option<Box<Branch<D, N>>>,
}

/// A mesh with its forces, and its equilibria as far as they were solved.
#[derive(Clone)]
pub(super) struct Branch<const D: usize, const N: usize> {
    pub(super) assembly: Arc<Assembly<D>>,
    pub(super) shapes: Shapes<D>,
    workspace: Workspace<D>,
    curve: Arc<Curve<D>>,
    /// Why they go no further.
    pub(super) end: Option<PathError>,
}

impl<const D: usize, const N: usize> Branch<D, N>
where
    Simulation: Space<D, N>,
{
    fn at_rest(
        simulation: &Simulation,
        assembly: Arc<Assembly<D>>,
        tolerance: Tolerance,
    ) -> Result<Self, SetupError> {
        let interruption = &simulation.interruption;
        let Assembly { system, body, .. } = &*assembly;
        let path = Path::start(system, body, simulation.accepting(tolerance), interruption)?;
        let curve = Arc::new(Curve::along(&path, simulation, &assembly)?);
        let (shapes, workspace) = path.into_parts();
        Ok(Self { assembly, shapes, workspace, curve, end: None })
    }

    /// Solves further.
    fn extend(
        &mut self,
        simulation: &Simulation,
        further: impl FnOnce(&mut Path<'_, D>) -> Result<(), PathError>,
    ) -> Result<(), Interrupted> {
        let interruption = &simulation.interruption;
        let Assembly { system, body, .. } = &*self.assembly;
        let found = (self.shapes.clone(), std::mem::take(&mut self.workspace));
        let mut path = Path::resume(system, body, found, interruption);
        let end = further(&mut path).err();
        interruption.check()?;
        self.end = end;
        self.curve = Arc::new(Curve::along(&path, simulation, &self.assembly)?);
        (self.shapes, self.workspace) = path.into_parts();
        Ok(())
    }

    /// Extends the path to a tension, unless it ends before.
    fn extend_to(&mut self, simulation: &Simulation, tension: f64) -> Result<(), Interrupted> {
        if self.is_known_to(tension) {
            return Ok(());
        }
        self.extend(simulation, |path| path.extend(tension))
    }

    /// Extends the path to a tension that a run reaches at a time.
    fn reach(
        &mut self,
        simulation: &Simulation,
        time: f64,
        tension: f64,
    ) -> Result<(), StopReason> {
        if self.shapes.reaches(tension) {
            return Ok(());
        }
        let further = self.extend(simulation, |path| path.extend((1.0 + MARGIN) * tension));
        further.map_err(|_| StopReason::Interrupted { time })?;
        match &self.end {
            Some(cause) if !self.shapes.reaches(tension) => {
                let cause = cause.to_string();
                Err(StopReason::NoEquilibrium { time, tension, cause })
            }
            _ => Ok(()),
        }
    }
}

impl<const D: usize, const N: usize> Branch<D, N> {
    /// Lowest and highest tension, kPa, up to which the shapes are valid.
    pub(super) fn intact(&self) -> [f64; 2] {
        self.curve.intact
    }

    /// Whether it is solved up to a tension, or ends before.
    fn is_known_to(&self, tension: f64) -> bool {
        self.shapes.reaches(tension) || self.end.is_some()
    }

    /// The quantities of its shape at a tension.
    fn at(&self, tension: f64) -> Quantities {
        self.curve.at(tension)
    }
}

impl Simulation {
    /// The mesh at rest without tension, of which equilibria can be solved.
    pub(super) fn equilibria_at_rest<const D: usize, const N: usize>(
        &self,
        tolerance: Tolerance,
    ) -> Result<Equilibria<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        self.check()?;
        self.interruption.check()?;
        let assembly = Arc::new(self.assembled_at_rest()?);
        let held = Branch::at_rest(self, Arc::clone(&assembly), tolerance)?;
        let loaded = in_steps(|steps| self.loaded_at_rest(&assembly, tolerance, steps))?;
        Ok(Equilibria { held, loaded: loaded.map(Box::new) })
    }

    /// The cell at rest under the load of an afterloaded contraction, which grows in steps.
    fn loaded_at_rest<const D: usize, const N: usize>(
        &self,
        held: &Assembly<D>,
        tolerance: Tolerance,
        steps: u32,
    ) -> Result<Option<Branch<D, N>>, SetupError>
    where
        Self: Space<D, N>,
    {
        let mut branch: Option<Branch<D, N>> = None;
        for step in 1..=steps {
            let Some(mut assembly) = self.loaded(held, f64::from(step) / f64::from(steps)) else {
                return Ok(None);
            };
            if let Some(rest) = branch.and_then(|last| last.shapes.positions(0.0)) {
                assembly.body.positions = rest;
            }
            branch = Some(Branch::at_rest(self, Arc::new(assembly), tolerance)?);
        }
        Ok(branch)
    }

    /// The mesh's equilibria at every tension from 0 to those in kPa, without a cell model: for any
    /// course of tension ([`Equilibria::follow`]).
    ///
    /// # Errors
    /// Forces for which there is no path of equilibria, and a path that ends before a tension.
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::Tolerance;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::Simulation;
    ///
    /// let simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// let equilibria = simulation.equilibria(&[50.0], Tolerance::default())?;
    /// // A transient that was measured: time (ms) and tension (kPa).
    /// let curve = equilibria.follow(&[[0.0, 0.0], [80.0, 31.0], [120.0, 50.0], [300.0, 4.0]])?;
    /// assert!((curve[2].shortening_pct - 12.0).abs() < 0.1);
    /// let shape = equilibria.positions(31.0).ok_or("31 kPa lies on the way to 50")?;
    /// assert_eq!(shape[0].len(), simulation.mesh.len());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn equilibria(
        &self,
        tensions: &[f64],
        tolerance: Tolerance,
    ) -> Result<Equilibria, SetupError> {
        self.refuse_thick("Equilibria")?;
        let mut equilibria = self.equilibria_at_rest(tolerance)?;
        for &tension in tensions {
            equilibria.extend_to(self, tension)?;
            if let Some(end) = equilibria.end(tension) {
                return Err(end.clone().into());
            }
        }
        Ok(equilibria)
    }

    /// As [`Simulation::equilibria`], up to the tension at which the cell is shorter by a part of its resting length,
    /// or as far as its path goes.
    ///
    /// # Errors
    /// Forces for which there is no path of equilibria.
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::Tolerance;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::Simulation;
    ///
    /// let simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// let equilibria = simulation.equilibria_to(0.2, Tolerance::default())?;
    /// let [_, highest] = equilibria.shapes().range();
    /// assert!(equilibria.follow(&[[0.0, highest]])?[0].shortening_pct > 20.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn equilibria_to(
        &self,
        shortening: f64,
        tolerance: Tolerance,
    ) -> Result<Equilibria, SetupError> {
        self.refuse_thick("Equilibria")?;
        self.equilibria_up_to(shortening, tolerance)
    }

    /// As [`Simulation::equilibria_to`], of a flat or thick cell.
    ///
    /// # Errors
    /// Those of [`Simulation::equilibria_to`].
    pub fn response_to(
        &self,
        shortening: f64,
        tolerance: Tolerance,
    ) -> Result<Arc<dyn TensionResponse>, SetupError> {
        Ok(match &self.thick {
            None => Arc::new(self.equilibria_up_to::<2, 3>(shortening, tolerance)?),
            Some(_) => Arc::new(self.equilibria_up_to::<3, 4>(shortening, tolerance)?),
        })
    }

    fn equilibria_up_to<const D: usize, const N: usize>(
        &self,
        shortening: f64,
        tolerance: Tolerance,
    ) -> Result<Equilibria<D, N>, SetupError>
    where
        Self: Space<D, N>,
    {
        let mut equilibria = self.equilibria_at_rest(tolerance)?;
        let Equilibria { held, loaded } = &mut equilibria;
        let branch = loaded.as_deref_mut().unwrap_or(held);
        let assembly = Arc::clone(&branch.assembly);
        let enough = |path: &Path<'_, D>| {
            let [_, highest] = path.range();
            path.positions(highest).is_none_or(|shape| {
                let reached = 1.0 - assembly.measure(&shape).length / assembly.held_length;
                // With held ends it does not shorten under any tension.
                reached >= shortening || reached.abs() <= f64::EPSILON
            })
        };
        let mut tension = FIRST_TENSION;
        branch.extend(self, |path| {
            while tension < LARGEST_TENSION && path.extend(tension).is_ok() && !enough(path) {
                tension *= 2.0;
            }
            Ok(())
        })?;
        let [_, highest] = branch.shapes.range();
        equilibria.extend_to(self, highest)?;
        Ok(equilibria)
    }

    /// Refuses to give a thick cell in a form that is flat.
    pub(super) fn refuse_thick(&self, what: &'static str) -> Result<(), SettingError> {
        if self.thick.is_none() {
            return Ok(());
        }
        let because = "it is for flat cells; take Simulation::build, or Simulation::response_to";
        Err(SettingError::Conflict { what, with: "a thick cell", because })
    }
}

/// The response of a mesh to one tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeshResponse {
    /// Time, ms.
    pub t_ms: f64,
    /// Active tension, kPa.
    pub ta_kpa: f64,
    /// Length along the reference long axis, um.
    pub length_um: f64,
    /// Width across the long axis, um.
    pub width_um: f64,
    /// Projected area, um^2.
    pub area_um2: f64,
    /// Shortening, per cent of the resting length.
    pub shortening_pct: f64,
    /// Energy of the passive forces, fJ.
    pub elastic_energy_fj: f64,
}

/// A tension outside the solved range.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "entry {index}, {tension} kPa at t = {time} ms, lies outside the equilibria that were solved, \
     {lowest} to {highest} kPa; ask for the lowest and the highest tension of the series"
)]
pub struct OutOfRange {
    /// Which entry of the series, the first is 0.
    pub index: usize,
    /// Time, ms.
    pub time: f64,
    /// Tension, kPa.
    pub tension: f64,
    /// Lowest tension solved, kPa.
    pub lowest: f64,
    /// Highest tension solved, kPa.
    pub highest: f64,
}

impl<const D: usize, const N: usize> TensionResponse for Equilibria<D, N> {
    fn shortening(&self, tension: f64) -> [f64; 2] {
        let part = 1.0 / self.held.assembly.held_length;
        let [length, slope] = self.branch(tension).curve.length(tension);
        [1.0 - length * part, -slope * part]
    }

    fn steepest(&self) -> f64 {
        let branches = std::iter::once(&self.held).chain(self.loaded.as_deref());
        let slopes =
            branches.flat_map(|branch| branch.curve.pieces.iter().map(|[[_, b, ..], ..]| -b));
        slopes.fold(0.0, f64::max) / self.held.assembly.held_length
    }

    fn highest(&self) -> f64 {
        let [_, highest] = self.held.shapes.range();
        highest
    }

    fn stretch(&self, shortening: f64) -> f64 {
        let Assembly { held_length, .. } = *self.held.assembly;
        self.held.assembly.stretch(held_length * (1.0 - shortening))
    }

    fn load(&self, name: &str, tension: f64) -> Option<[f64; 2]> {
        let place = self.held.assembly.gauges.place(name)?;
        Some(self.branch(tension).curve.with_slope(LOADS + place, tension))
    }
}

#[allow(private_bounds, reason = "flat or thick, and nothing else")]
impl<const D: usize, const N: usize> Equilibria<D, N>
where
    Simulation: Space<D, N>,
{
    /// Extends the path to a tension, unless it ends before.
    pub(super) fn extend_to(
        &mut self,
        simulation: &Simulation,
        tension: f64,
    ) -> Result<(), Interrupted> {
        let mut branches = std::iter::once(&mut self.held).chain(self.loaded.as_deref_mut());
        branches.try_for_each(|branch| branch.extend_to(simulation, tension))
    }

    /// Extends the path to a tension that a run reaches at a time.
    pub(super) fn reach(
        &mut self,
        simulation: &Simulation,
        time: f64,
        tension: f64,
    ) -> Result<(), StopReason> {
        let mut branches = std::iter::once(&mut self.held).chain(self.loaded.as_deref_mut());
        branches.try_for_each(|branch| branch.reach(simulation, time, tension))
    }
}

impl<const D: usize, const N: usize> Equilibria<D, N> {
    /// Whether they are solved up to a tension, or end before.
    pub(super) fn are_known_to(&self, tension: f64) -> bool {
        let mut branches = std::iter::once(&self.held).chain(self.loaded.as_deref());
        branches.all(|branch| branch.is_known_to(tension))
    }

    /// Why they end before a tension, if they do.
    pub(super) fn end(&self, tension: f64) -> Option<&PathError> {
        self.held.end.as_ref().filter(|_| !self.held.shapes.reaches(tension))
    }

    /// The branch that the mesh is on at a tension.
    pub(super) fn branch(&self, tension: f64) -> &Branch<D, N> {
        let length = |branch: &Branch<D, N>| branch.curve.length(tension)[0];
        match self.loaded.as_deref() {
            Some(loaded) if length(loaded) < length(&self.held) => loaded,
            _ => &self.held,
        }
    }

    /// The quantities at a tension.
    pub(super) fn at(&self, tension: f64) -> Quantities {
        self.branch(tension).at(tension)
    }

    /// The shapes and the work they took; for an afterloaded cell those at its stop.
    pub fn shapes(&self) -> &Shapes<D> {
        &self.held.shapes
    }

    /// The responses to a series of tensions, `[time (ms), tension (kPa)]` each, in the same order,
    /// without solving further.
    ///
    /// # Errors
    /// A tension outside the range that was solved, or that is not a number.
    pub fn follow(&self, series: &[[f64; 2]]) -> Result<Vec<MeshResponse>, OutOfRange> {
        let [lowest, highest] = self.held.shapes.range();
        let one = |(index, &[time, tension]): (usize, &[f64; 2])| {
            if !(lowest..=highest).contains(&tension) {
                return Err(OutOfRange { index, time, tension, lowest, highest });
            }
            let [length, width, area, elastic_energy, ..] = self.at(tension);
            Ok(MeshResponse {
                t_ms: time,
                ta_kpa: tension,
                length_um: length,
                width_um: width,
                area_um2: area,
                shortening_pct: 100.0 * (1.0 - length / self.held.assembly.held_length),
                elastic_energy_fj: elastic_energy,
            })
        };
        series.iter().enumerate().map(one).collect()
    }

    /// The forces of the nodes that adhere to a gel under a tension in kPa, nN; `None` without a gel, or outside the range that
    /// was solved.
    pub(super) fn pulls(&self, tension: f64) -> Option<Vectors<D>> {
        self.branch(tension).curve.pulls.as_ref()?.positions(tension)
    }

    /// Positions under a tension in kPa, um; `None` outside the range that was solved.
    pub fn positions(&self, tension: f64) -> Option<Vectors<D>> {
        self.branch(tension).shapes.positions(tension)
    }
}

/// Length, width, area, elastic energy, work of the active forces since tension 0, their energy at 1 kPa, and what the gauges
/// tell.
pub(super) type Quantities = [f64; QUANTITIES];
const QUANTITIES: usize = LOADS + GAUGES;
/// Where those of the gauges begin.
const LOADS: usize = 6;
const WORK: usize = 4;
pub(super) const PER_TENSION: usize = 5;

/// Quantities as functions of the tension, in cubic pieces.
#[derive(Debug)]
struct Curve<const D: usize> {
    /// Where pieces begin and where the last one ends, kPa, ascending; `PARTS` intervals to a load step.
    tensions: Vec<f64>,
    /// Coefficients by the tension above the begin of each.
    pieces: Vec<[Cubic; QUANTITIES]>,
    /// Lowest and highest tension, kPa, up to which the measured shapes are valid.
    intact: [f64; 2],
    /// The forces on a gel, nN.
    pulls: Option<Shapes<D>>,
}

/// Coefficients, the constant first.
type Cubic = [f64; 4];

impl<const D: usize> Curve<D> {
    fn along<const N: usize>(
        shapes: &Shapes<D>,
        simulation: &Simulation,
        assembly: &Assembly<D>,
    ) -> Result<Self, Interrupted>
    where
        Simulation: Space<D, N>,
    {
        let Assembly { system, gauges, body, .. } = assembly;
        // The forces on a gel are linear in the displacements, so they need not be solved for at each tension.
        let gel = system.compliance();
        let pulls = gel.map(|gel| shapes.linear(&body.positions, |moved| gel.forces_of(moved)));
        let knots = shapes.tensions();
        let mut tensions: Vec<f64> = knots
            .windows(2)
            .flat_map(|pair| {
                (0..PARTS)
                    .map(|k| pair[0] + (pair[1] - pair[0]) * k as f64 / PARTS as f64)
                    .collect::<Vec<f64>>()
            })
            .collect();
        tensions.extend(knots.last());
        let still = zeros(body.len());
        let mut values: Vec<Quantities> = Vec::new();
        let mut sound = Vec::new();
        let mut before: Option<(f64, Vectors<D>)> = None;
        let mut added = Vec::new();
        for &tension in &tensions {
            simulation.interruption.check()?;
            let Some(positions) = shapes.positions(tension) else { break };
            let energy = |positions: &Vectors<D>, tension: f64| {
                let tension = tension.into();
                let at = Configuration { positions, velocities: &still, tension };
                system.active_energy(&at)
            };
            // W = -int grad E(x; Ta) dx by the mean tension of each part
            added.push(before.as_ref().map_or(0.0, |(last, from)| {
                let mean = 0.5 * (last + tension);
                energy(from, mean) - energy(&positions, mean)
            }));
            let extent = assembly.measure(&positions);
            let at = Configuration {
                positions: &positions,
                velocities: &still,
                tension: tension.into(),
            };
            let pulling = pulls.as_ref().and_then(|pulls| pulls.positions(tension));
            let outside = match (gel, &pulling) {
                (Some(gel), Some(pulls)) => 0.5 * product(pulls, &gel.displacements(&positions)),
                _ => 0.0,
            };
            let area = assembly.area(&simulation.mesh, &positions);
            let mut quantities = [0.0; QUANTITIES];
            quantities[..LOADS].copy_from_slice(&[
                extent.length,
                extent.width,
                area,
                system.own_energy(&at) + outside,
                0.0,
                energy(&positions, 1.0),
            ]);
            for (quantity, told) in
                quantities[LOADS..].iter_mut().zip(gauges.read(system, &at, pulling.as_ref(), area))
            {
                *quantity = told;
            }
            values.push(quantities);
            sound.push(fault(simulation.body_mesh(), &positions, 0.0, tension).is_none());
            before = Some((tension, positions));
        }
        // Work counts from tension 0, which is a knot, in both directions, so that it does not
        // depend on the range.
        let rest = tensions.partition_point(|tension| *tension < 0.0);
        for above in rest + 1..values.len() {
            values[above][WORK] = values[above - 1][WORK] + added[above];
        }
        for below in (0..rest).rev() {
            values[below][WORK] = values[below + 1][WORK] - added[below + 1];
        }
        let up = sound[rest..].iter().take_while(|sound| **sound).count();
        let down = sound[..=rest].iter().rev().take_while(|sound| **sound).count();
        let intact = [tensions[rest + 1 - down.max(1)], tensions[rest + up.max(1) - 1]];
        let piece = |part: usize| std::array::from_fn(|of| cubic(&tensions, &values, part, of));
        let pieces: Vec<[Cubic; QUANTITIES]> = (0..tensions.len() - 1).map(piece).collect();
        let at_rest = || vec![values[0].map(|value| [value, 0.0, 0.0, 0.0])];
        let pieces = if pieces.is_empty() { at_rest() } else { pieces };
        Ok(Self { tensions, pieces, intact, pulls })
    }

    /// The piece of a tension, and how far it is above its begin, kPa.
    fn piece(&self, tension: f64) -> (&[Cubic; QUANTITIES], f64) {
        let after = self.tensions.partition_point(|begin| *begin <= tension);
        let piece = after.saturating_sub(1).min(self.pieces.len() - 1);
        (&self.pieces[piece], tension - self.tensions[piece])
    }

    fn at(&self, tension: f64) -> Quantities {
        let (piece, by) = self.piece(tension);
        piece.map(|[a, b, c, d]| a + by * (b + by * (c + by * d)))
    }

    /// Length and its derivative by the tension; past either end, on the straight line.
    fn length(&self, tension: f64) -> [f64; 2] {
        self.with_slope(0, tension)
    }

    /// A quantity and its derivative by the tension; past either end, on the straight line.
    fn with_slope(&self, quantity: usize, tension: f64) -> [f64; 2] {
        let ends = [self.tensions[0], self.tensions[self.tensions.len() - 1]];
        let within = tension.clamp(ends[0], ends[1]);
        let (piece, by) = self.piece(within);
        let [a, b, c, d] = piece[quantity];
        let slope = b + by * (2.0 * c + by * 3.0 * d);
        [a + by * (b + by * (c + by * d)) + (tension - within) * slope, slope]
    }
}

/// One quantity in a part of a load step: the cubic through the four nearest tensions of the step.
fn cubic(tensions: &[f64], values: &[Quantities], part: usize, of: usize) -> Cubic {
    let first = part - part % PARTS;
    let start = (part.max(first + 1) - 1).min(first + PARTS - 3);
    let x: [f64; 4] = std::array::from_fn(|k| tensions[start + k] - tensions[part]);
    let mut y: [f64; 4] = std::array::from_fn(|k| values[start + k][of]);
    // Newton's divided differences: a constant stays exact to the last bit.
    for order in 1..4 {
        for k in (order..4).rev() {
            y[k] = (y[k] - y[k - 1]) / (x[k] - x[k - order]);
        }
    }
    let mut powers = [y[3], 0.0, 0.0, 0.0];
    for k in (0..3).rev() {
        for at in (1..4).rev() {
            powers[at] = powers[at - 1] - x[k] * powers[at];
        }
        powers[0] = y[k] - x[k] * powers[0];
    }
    powers
}
