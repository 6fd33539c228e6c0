//! A run along the path of equilibria.
//!
//! The cell model runs in time and feels the stretch as in any run; the mesh takes at once the shape
//! that belongs to the tension ([`Path`]). So length, width, area and energies are functions of the
//! tension alone. They are computed at nine tensions in each load step and interpolated by cubics
//! through four of them: exact for lengths along an axis that does not turn, which are cubic polynomials of
//! the tension. A frame is the path's own shape.
//!
//! Nothing moves, so momenta and kinetic energy are 0, and nothing is dissipated: these are the limits of
//! a slow contraction, not unknowns. The work of the active force is the elastic energy, added up on its
//! own as in a run in time.

use super::coupling::{Observed, Shaping};
use super::fault::{fault, projected_area};
use super::observer::{Observer, Progress, Samples};
use super::outcome::{Effort, Outcome};
use super::setup::{Assembly, Setup};
use super::{SettingError, SetupError, Simulation, StopReason};
use crate::cell::tension::lag::Lag;
use crate::exchange::Sites;
use crate::integrate::quasi_static::{Path, PathError, Shapes, Tolerance};
use crate::interruption::{Interrupted, Interruption};
use crate::mechanics::{Configuration, Tension, Vectors, zeros};
use crate::mesh::Mesh;
use crate::recording::Recording;
use std::sync::Arc;

/// Intervals at whose ends a load step is measured.
const PARTS: usize = 8;

/// Where a path to a shortening looks first, kPa, and where it gives up: no cell pulls as hard.
const FIRST_TENSION: f64 = 1.0;
const LARGEST_TENSION: f64 = 1e5;

/// Part of the tension by which a path is solved in advance: a beat's peak differs from the reference
/// beat's by some 1e-4, a train of beats may go on rising.
const MARGIN: f64 = 1e-3;

/// A quasi-static run made ready: its path is solved up to the peak of tension.
pub struct PreparedPath {
    pub(super) setup: Setup,
    /// The shapes at every tension.
    pub shapes: Shapes,
    /// Why the path ends before the peak of tension, if it does.
    pub end: Option<PathError>,
    pub(super) curve: Arc<Curve>,
    pub(super) loaded: Option<Box<Loaded>>,
}

/// The cell under its afterload, away from its stop.
pub(super) struct Loaded {
    assembly: Assembly,
    shapes: Shapes,
    curve: Arc<Curve>,
}

impl Simulation {
    /// Solves the path of equilibria up to the peak of a tension that is the same everywhere; time step and
    /// method of the numerical settings do not matter.
    ///
    /// # Errors
    /// A setting that no run can have, forces for which there is no such path, or a cell model without tension.
    /// A path that ends before the peak is no error but [`PreparedPath::end`].
    pub fn prepare_quasi_static(&self, tolerance: Tolerance) -> Result<PreparedPath, SetupError> {
        let setup = self.set_up()?;
        setup.check_path()?;
        let Assembly { system, body, .. } = &*setup.assembly;
        let mut path = Path::start_interruptible(system, body, tolerance, &self.interruption)?;
        let end = path.extend(setup.peak()).err();
        self.interruption.check()?;
        let mesh = &setup.simulation.mesh;
        let curve = Arc::new(Curve::along(&path, mesh, &setup.assembly, &self.interruption)?);
        let shapes = path.into_shapes();
        let loaded = setup.loaded(shapes.tolerance())?;
        Ok(PreparedPath { setup, shapes, end, curve, loaded })
    }

    /// Runs along the path of equilibria, to the end or to the first thing that goes wrong. `observe` is
    /// called at each recorded sample and stops the run by returning `false`.
    ///
    /// # Errors
    /// Those of [`Simulation::prepare_quasi_static`]. A path that ends before the largest tension of
    /// the run is no error but a [`StopReason`].
    ///
    /// # Example
    /// ```
    /// use myospring::integrate::quasi_static::Tolerance;
    /// use myospring::mesh::lattice;
    /// use myospring::simulation::Simulation;
    ///
    /// let simulation = Simulation::new(lattice::rectangle(20, 4, 5.0)?);
    /// let outcome = simulation.run_quasi_static(Tolerance::default(), |_progress| true)?;
    /// assert!(outcome.stop.is_none());
    /// let peak = outcome.recording.samples.iter().map(|s| s.shortening_pct).fold(0.0, f64::max);
    /// assert!((peak - 12.0).abs() < 0.1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn run_quasi_static(
        &self,
        tolerance: Tolerance,
        observe: impl FnMut(Progress) -> bool,
    ) -> Result<Outcome, SetupError> {
        Ok(self.prepare_quasi_static(tolerance)?.run(observe))
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
        self.check()?;
        self.interruption.check()?;
        let assembly = self.assembled_at_rest()?;
        let Assembly { system, body, .. } = &assembly;
        let mut path = Path::start_interruptible(system, body, tolerance, &self.interruption)?;
        for &tension in tensions {
            path.extend(tension)?;
        }
        let curve = Curve::along(&path, &self.mesh, &assembly, &self.interruption)?;
        Ok(Equilibria { shapes: path.into_shapes(), curve, held_length: assembly.held_length })
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
    /// let [_, highest] = equilibria.shapes.range();
    /// assert!(equilibria.follow(&[[0.0, highest]])?[0].shortening_pct > 20.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn equilibria_to(
        &self,
        shortening: f64,
        tolerance: Tolerance,
    ) -> Result<Equilibria, SetupError> {
        self.check()?;
        self.interruption.check()?;
        let assembly = self.assembled_at_rest()?;
        let Assembly { system, body, meter, held_length, .. } = &assembly;
        let mut path = Path::start_interruptible(system, body, tolerance, &self.interruption)?;
        let mut tension = FIRST_TENSION;
        let enough = |path: &Path<'_>| {
            let [_, highest] = path.range();
            let shape = path.positions(highest);
            shape.is_none_or(|shape| 1.0 - meter.measure(&shape).length / held_length >= shortening)
        };
        while tension < LARGEST_TENSION && path.extend(tension).is_ok() && !enough(&path) {
            tension *= 2.0;
        }
        self.interruption.check()?;
        let curve = Curve::along(&path, &self.mesh, &assembly, &self.interruption)?;
        Ok(Equilibria { shapes: path.into_shapes(), curve, held_length: assembly.held_length })
    }
}

impl Setup {
    /// Refuses what has no path that could be solved in advance.
    pub(super) fn check_path(&self) -> Result<(), SettingError> {
        match self.sites() {
            Sites::Whole => Ok(()),
            Sites::PerElement(_) => Err(SettingError::Conflict {
                what: "a tension for each triangle",
                with: "a path of equilibria, which is solved in advance",
                because: "take Simulation::build, or prepare_field, which goes from one to the next",
            }),
        }
    }

    /// The other path of an afterloaded cell, up to the peak of tension or as far as it goes.
    pub(super) fn loaded(&self, tolerance: Tolerance) -> Result<Option<Box<Loaded>>, SetupError> {
        let Some(assembly) = self.simulation.loaded(&self.assembly) else { return Ok(None) };
        let Assembly { system, body, .. } = &assembly;
        let interruption = &self.simulation.interruption;
        let mut path = Path::start_interruptible(system, body, tolerance, interruption)?;
        // One that ends before says so in the run, if it comes to that.
        let _ = path.extend(self.peak());
        interruption.check()?;
        let curve = Curve::along(&path, &self.simulation.mesh, &assembly, interruption)?;
        let curve = Arc::new(curve);
        let shapes = path.into_shapes();
        Ok(Some(Box::new(Loaded { assembly, shapes, curve })))
    }

    /// The tension up to which a path is solved in advance, kPa.
    pub(super) fn peak(&self) -> f64 {
        (1.0 + MARGIN) * self.strongest.tension
    }
}

impl PreparedPath {
    /// Runs to the end or to the first thing that goes wrong; `observe` is called at each recorded
    /// sample and stops the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`PreparedPath::run`], for an observer that also hears which part of the work begins.
    pub fn run_observed(&self, observer: &mut dyn Observer) -> Outcome {
        let setup = &self.setup;
        let interruption = &setup.simulation.interruption;
        let held = Branch::resume(&setup.assembly, &self.shapes, &self.curve, interruption);
        let loaded = self.loaded.as_deref().map(|Loaded { assembly, shapes, curve }| {
            Branch::resume(assembly, shapes, curve, interruption)
        });
        let start = setup.activation.tension().at(0);
        let state = Lagging { tension: start, work: 0.0 };
        let mut shaping =
            AlongPath { setup, held, loaded, state, marked: state, start: Quantities::default() };
        let (recording, stop) = match shaping.follow(0.0, [start.into(); 2]) {
            Ok(()) => {
                shaping.start = shaping.at(start);
                setup.run(&mut shaping, observer)
            }
            Err(reason) => (Recording::default(), Some(reason)),
        };
        let paths = || std::iter::once(&shaping.held).chain(&shaping.loaded).map(|b| &b.path);
        let effort = Effort::QuasiStatic {
            load_steps: paths().map(|path| path.load_steps()).sum(),
            newton_iterations: paths().map(|path| path.newton_iterations()).sum(),
            factorisations: paths().map(|path| path.factorisations()).sum(),
            interpolation_error_um: paths().map(|path| path.error()).fold(0.0, f64::max),
            delay_ms: paths().map(|path| path.delay()).fold(0.0, f64::max),
        };
        let (stimulus_times_ms, s2_ms) = (setup.stimulus_times(), setup.s2_ms());
        Outcome { recording, stop, effort, engine: None, stimulus_times_ms, s2_ms }
    }
}

/// One mesh at rest under every tension of a range.
pub struct Equilibria {
    /// The shapes and what they took.
    pub shapes: Shapes,
    curve: Curve,
    held_length: f64,
}

/// The answer of a mesh to one tension.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Response {
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

/// A tension for which no equilibrium was asked.
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

impl Equilibria {
    /// The answer to a series of tensions, `[time (ms), tension (kPa)]` each: as many entries, in the same
    /// order. Nothing is solved for it.
    ///
    /// # Errors
    /// A tension outside the range that was solved, or that is no number.
    pub fn follow(&self, series: &[[f64; 2]]) -> Result<Vec<Response>, OutOfRange> {
        let [lowest, highest] = self.shapes.range();
        let one = |(index, &[time, tension]): (usize, &[f64; 2])| {
            if !(lowest..=highest).contains(&tension) {
                return Err(OutOfRange { index, time, tension, lowest, highest });
            }
            let [length, width, area, elastic_energy, ..] = self.curve.at(tension);
            Ok(Response {
                t_ms: time,
                ta_kpa: tension,
                length_um: length,
                width_um: width,
                area_um2: area,
                shortening_pct: 100.0 * (1.0 - length / self.held_length),
                elastic_energy_fj: elastic_energy,
            })
        };
        series.iter().enumerate().map(one).collect()
    }

    /// Positions under a tension in kPa, um; `None` outside the range that was solved.
    pub fn positions(&self, tension: f64) -> Option<Vectors> {
        self.shapes.positions(tension)
    }
}

/// Length, width, area, elastic energy, work of the active forces since tension 0, their energy at 1 kPa, force at
/// the ends.
type Quantities = [f64; 7];
const WORK: usize = 4;
const PER_TENSION: usize = 5;

/// Quantities as functions of the tension.
#[derive(Debug, Default)]
pub(super) struct Curve {
    /// kPa, ascending; `PARTS` intervals to a load step.
    tensions: Vec<f64>,
    values: Vec<Quantities>,
    /// Lowest and highest tension, kPa, up to which the measured shapes are without fault.
    intact: [f64; 2],
}

impl Curve {
    pub(super) fn along(
        shapes: &Shapes,
        mesh: &Mesh,
        assembly: &Assembly,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        let Assembly { system, meter, ends, .. } = assembly;
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
        let still = zeros(mesh.len());
        let mut curve = Self { tensions, ..Self::default() };
        let mut sound = Vec::new();
        let mut before: Option<(f64, Vectors)> = None;
        let mut added = Vec::new();
        for &tension in &curve.tensions {
            interruption.check()?;
            let Some(positions) = shapes.positions(tension) else { break };
            let energy = |positions: &Vectors, tension: f64| {
                let tension = tension.into();
                let at = Configuration { positions, velocities: &still, tension };
                system.active_energy(&at)
            };
            // W = -int grad E(x; Ta) dx by the mean tension of each part
            added.push(before.as_ref().map_or(0.0, |(last, from)| {
                let mean = 0.5 * (last + tension);
                energy(from, mean) - energy(&positions, mean)
            }));
            let extent = meter.measure(&positions);
            let at = Configuration {
                positions: &positions,
                velocities: &still,
                tension: tension.into(),
            };
            curve.values.push([
                extent.length,
                extent.width,
                projected_area(mesh, &positions),
                system.elastic_energy(&at),
                0.0,
                energy(&positions, 1.0),
                ends.as_ref().map_or(0.0, |ends| ends.of(system, &at)),
            ]);
            sound.push(fault(mesh, &positions, 0.0, tension).is_none());
            before = Some((tension, positions));
        }
        // Work counts from tension 0, which is a knot, both ways: neither knows how far the other goes.
        let rest = curve.tensions.partition_point(|tension| *tension < 0.0);
        for above in rest + 1..curve.values.len() {
            curve.values[above][WORK] = curve.values[above - 1][WORK] + added[above];
        }
        for below in (0..rest).rev() {
            curve.values[below][WORK] = curve.values[below + 1][WORK] - added[below + 1];
        }
        let up = sound[rest..].iter().take_while(|sound| **sound).count();
        let down = sound[..=rest].iter().rev().take_while(|sound| **sound).count();
        curve.intact =
            [curve.tensions[rest + 1 - down.max(1)], curve.tensions[rest + up.max(1) - 1]];
        Ok(curve)
    }

    /// Cubic through the four nearest tensions of the load step (Lagrange's).
    fn at(&self, tension: f64) -> Quantities {
        if self.tensions.len() <= PARTS {
            return self.values[0];
        }
        let parts = self.tensions.len() - 1;
        let part = self.tensions.partition_point(|t| *t <= tension).clamp(1, parts) - 1;
        let first = part - part % PARTS;
        let start = (part.max(first + 1) - 1).min(first + PARTS - 3);
        let nodes = &self.tensions[start..start + 4];
        // From the first value on, so that what does not change stays the same to the last bit.
        let base = self.values[start];
        let mut sum = base;
        for (k, values) in self.values[start..start + 4].iter().enumerate() {
            let mut weight = 1.0;
            for (j, node) in nodes.iter().enumerate() {
                if j != k {
                    weight *= (tension - node) / (nodes[k] - node);
                }
            }
            for ((total, value), base) in sum.iter_mut().zip(values).zip(base) {
                *total += weight * (value - base);
            }
        }
        sum
    }
}

/// A path, the forces that it is of, and what is measured along it.
struct Branch<'a> {
    assembly: &'a Assembly,
    path: Path<'a>,
    curve: Arc<Curve>,
}

impl<'a> Branch<'a> {
    fn resume(
        assembly: &'a Assembly,
        shapes: &Shapes,
        curve: &Arc<Curve>,
        interruption: &Interruption,
    ) -> Self {
        let Assembly { system, body, .. } = assembly;
        let path = Path::resume(system, body, shapes.clone(), interruption);
        Self { assembly, path, curve: Arc::clone(curve) }
    }

    /// Goes on to a tension.
    fn reach(
        &mut self,
        simulation: &Simulation,
        time: f64,
        tension: f64,
    ) -> Result<(), StopReason> {
        if self.path.reaches(tension) {
            return Ok(());
        }
        let reached = self.path.extend((1.0 + MARGIN) * tension);
        let Simulation { mesh, interruption, .. } = simulation;
        let curve = Curve::along(&self.path, mesh, self.assembly, interruption);
        self.curve = Arc::new(curve.map_err(|_| StopReason::Interrupted { time })?);
        match reached {
            Err(PathError::Interrupted) => Err(StopReason::Interrupted { time }),
            Err(cause) if !self.path.reaches(tension) => {
                let cause = cause.to_string();
                Err(StopReason::NoEquilibrium { time, tension, cause })
            }
            _ => Ok(()),
        }
    }
}

/// A mesh that takes the shapes of a path, each at its tension, or lagging behind it.
///
/// An afterloaded cell has two: clamped at its stop, and shortened against its load. Where the load would let it be
/// longer than the stop does, it is at its stop; no memory of what was before is needed.
struct AlongPath<'a> {
    setup: &'a Setup,
    held: Branch<'a>,
    loaded: Option<Branch<'a>>,
    state: Lagging,
    marked: Lagging,
    /// At the start of the run.
    start: Quantities,
}

/// Where on the path a mesh is.
#[derive(Debug, Clone, Copy)]
struct Lagging {
    /// The tension at which its shape is an equilibrium, kPa: the one that acts, unless the cell is viscous.
    tension: f64,
    /// Work of the tension that acts, since the start of the run, fJ; kept of a viscous cell only.
    work: f64,
}

impl AlongPath<'_> {
    /// The path that the mesh is on at a tension.
    fn branch(&self, tension: f64) -> &Branch<'_> {
        let length = |branch: &Branch<'_>| branch.curve.at(tension)[0];
        match &self.loaded {
            Some(loaded) if length(loaded) < length(&self.held) => loaded,
            _ => &self.held,
        }
    }

    fn at(&self, tension: f64) -> Quantities {
        self.branch(tension).curve.at(tension)
    }

    /// Whether the work of the tension hangs on more than the shape that it has come to along one path.
    fn keeps_account(&self) -> bool {
        self.is_viscous() || self.loaded.is_some()
    }

    fn is_viscous(&self) -> bool {
        self.setup.simulation.material.retardation_time > 0.0
    }

    /// The tension that shapes the cell at the end of an interval over which the one that acts changes evenly.
    fn lagging(&self, time: f64, [from, to]: [f64; 2]) -> f64 {
        let Simulation { material, numerics, .. } = &self.setup.simulation;
        // What has acted for ever before the run has made its shape.
        if time <= 0.0 {
            return to;
        }
        let lag = Lag::by(material.retardation_time);
        let [share, kept] = lag.over_line(numerics.exchange_interval, self.state.tension, from);
        share * to + kept
    }
}

impl Shaping for AlongPath<'_> {
    fn is_static(&self) -> bool {
        true
    }

    fn mark(&mut self) {
        self.marked = self.state;
    }

    fn back(&mut self) {
        self.state = self.marked;
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let acting = tensions.map(|tension| tension.at(0));
        let tension = self.lagging(time, acting);
        let simulation = &self.setup.simulation;
        self.held.reach(simulation, time, tension)?;
        if let Some(loaded) = &mut self.loaded {
            loaded.reach(simulation, time, tension)?;
        }
        if self.keeps_account() {
            let [before, after] = [self.state.tension, tension].map(|at| self.at(at)[PER_TENSION]);
            self.state.work += 0.5 * (acting[0] + acting[1]) * (before - after);
        }
        self.state.tension = tension;
        let [lowest, highest] = self.branch(tension).curve.intact;
        if !(lowest..=highest).contains(&tension) {
            let positions = self.positions();
            if let Some(reason) = fault(&simulation.mesh, &positions, time, tension) {
                return Err(reason);
            }
        }
        Ok(())
    }

    fn length(&self) -> f64 {
        self.at(self.state.tension)[0]
    }

    fn observe(&self) -> Observed {
        let [length, width, area, elastic_energy, work, _, end_force] = self.at(self.state.tension);
        let [_, _, _, elastic_at_start, work_at_start, ..] = self.start;
        let active_work = if self.keeps_account() { self.state.work } else { work - work_at_start };
        let dissipated_energy =
            if self.is_viscous() { active_work - (elastic_energy - elastic_at_start) } else { 0.0 };
        Observed {
            length,
            width,
            area,
            elastic_energy,
            kinetic_energy: 0.0,
            active_work,
            dissipated_energy,
            momentum: 0.0,
            angular_momentum: 0.0,
            end_force: self.setup.assembly.ends.as_ref().map(|_| end_force),
        }
    }

    /// The path reaches every tension that was followed.
    fn positions(&self) -> Vectors {
        let tension = self.state.tension;
        self.branch(tension)
            .path
            .positions(tension)
            .unwrap_or_else(|| self.setup.assembly.body.positions.clone())
    }
}
