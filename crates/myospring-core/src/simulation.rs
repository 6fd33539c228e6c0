//! The loop: cell tension in, shape out.
//!
//! The only place where cell models and mechanics meet. Every exchange interval the cell model moves
//! on under the present stretch, its tension goes to the mesh (linearly over the interval), and the
//! masses follow. Every output interval a [`Sample`] is recorded, every frame interval a [`Frame`].
//!
//! ```text
//! t        t + exchange
//! |---------|   cell model: stretch at t  ->  tension at t + exchange
//! |-|-|-|-|-|   masses: n equal Verlet steps, tension linear in between
//! ```
//!
//! [`Prepared::run`] moves the masses in time, [`PreparedPath::run`] puts them along their path of
//! equilibria; the loop is the same. [`Simulation::ready`] takes the one that the settings ask for.
//!
//! A value that is not a number, an inverted triangle or a spring without length stops the run with
//! the time and the place; what was recorded up to there is kept.

mod in_time;
mod observer;
pub mod quasi_static;
mod ready;
mod stop;

pub use observer::{Observer, Part, Progress};
pub use quasi_static::PreparedPath;
pub use ready::{Effort, Finished, Ready};
pub use stop::{SetupError, StopReason};

use crate::analysis::shape::{self, ShapeMeter};
use crate::cell::integrator::CellIntegrator;
use crate::cell::pacing::Protocol;
use crate::cell::solve::{self, Settings, SolveError};
use crate::cell::{self, CellModel, coelho_2021};
use crate::integrate::Method;
use crate::integrate::verlet::{Integrator, Motion};
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::{AreaLaw, signed_area};
use crate::mechanics::material::{Material, assemble, default_material};
use crate::mechanics::stability::StabilityLimit;
use crate::mechanics::stencil::Stencil;
use crate::mechanics::support::{Support, SupportKind};
use crate::mechanics::{Body, System, Vectors};
use crate::mesh::{Mesh, quality};
use crate::recording::{Frame, Recording, Sample};
use in_time::InTime;
use observer::Samples;
use serde::Serialize;

/// Numerical settings of a run; [`Default`] gives a converged beat.
#[derive(Debug, Clone, PartialEq)]
pub struct Numerics {
    /// How the mesh follows the tension; by Stoermer-Verlet, as in the paper.
    pub method: Method,
    /// Mechanical time step of a motion in time, ms; `None` takes [`SAFETY`] of the stability limit.
    pub time_step: Option<f64>,
    /// Interval at which cell model and mesh exchange tension and stretch, ms; 0.25.
    pub exchange_interval: f64,
    /// Interval of the recorded samples, ms, a multiple of the exchange interval; 0.5.
    pub output_interval: f64,
    /// Interval of the recorded shapes, ms, a multiple of the output interval; 5. The shape at the peak
    /// of tension is kept besides.
    pub frame_interval: f64,
    /// Integration of the cell model.
    pub cell: Settings,
    /// Threads that move the masses of a lattice, 1. The result is the same to the last bit; how many
    /// pay for so many masses says [`crate::mechanics::stencil::worthwhile_threads`].
    pub threads: usize,
}

impl Default for Numerics {
    fn default() -> Self {
        Self {
            method: Method::Verlet(Integrator::StoermerVerlet),
            time_step: None,
            exchange_interval: 0.25,
            output_interval: 0.5,
            frame_interval: 5.0,
            cell: Settings::default(),
            threads: 1,
        }
    }
}

/// Part of the stability limit that the default time step takes.
///
/// The limit is that of the resting shape under peak tension. Beats of the built-in cell are stable at
/// 0.998 of it at 12 % shortening and at 0.98 of it at 34 %.
pub const SAFETY: f64 = 0.95;

/// What peak the cell model's tension has when it is scaled to the peak tension in kPa.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum TensionScale {
    /// That of the model's published parameters ([`CellModel::published_peak_tension`]): a changed parameter
    /// changes the strength of the cell.
    Published,
    /// That of the model as it is, by a reference beat of its own: every cell has the same peak tension,
    /// whatever its parameters.
    OwnPeak,
}

/// All that a run is made of.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, pacing::Protocol, toy::ToyModel};
/// use myospring::mesh::lattice;
/// use myospring::simulation::Simulation;
///
/// let strip = lattice::rectangle(20, 4, 5.0)?;
/// let toy = ToyModel::published();
/// let simulation = Simulation {
///     protocol: Protocol { start_ms: 0.0, ..Protocol::once(toy.default_stimulus()) },
///     cell: Box::new(toy),
///     duration: 60.0,
///     ..Simulation::coelho_2021(strip)
/// };
/// let outcome = simulation.prepare()?.run(|progress| progress.time <= 60.0);
/// assert!(outcome.stop.is_none());
/// // The toy's tension peaks after 50 ms, and the strip with it.
/// assert!((outcome.recording.samples[100].shortening_pct - 12.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Simulation {
    /// The cell model.
    pub cell: Box<dyn CellModel>,
    /// When and how it is stimulated.
    pub protocol: Protocol,
    /// Peak of the active tension, kPa, of one default beat of the cell model that `tension_scale` names.
    pub peak_tension: f64,
    /// Whose peak is scaled to it.
    pub tension_scale: TensionScale,
    /// The mesh at rest.
    pub mesh: Mesh,
    /// Its long axis, a unit vector: length is measured along it.
    pub long_axis: [f64; 2],
    /// Fibre direction in each triangle, unit vectors.
    pub fibres: Vec<[f64; 2]>,
    /// What the cell is made of.
    pub material: Material,
    /// How the active tension acts.
    pub active: ActiveLaw,
    /// What holds the cell.
    pub support: SupportKind,
    /// Time simulated, ms.
    pub duration: f64,
    /// Numerical settings.
    pub numerics: Numerics,
}

/// What came of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// All that was recorded, up to the stop.
    pub recording: Recording,
    /// Why it stopped early, if it did.
    pub stop: Option<StopReason>,
    /// The mechanical time step that was used, ms.
    pub time_step: f64,
    /// Mechanical steps made.
    pub steps: u64,
    /// The stability limit at peak tension.
    pub limit: StabilityLimit,
}

/// A run made ready: forces assembled, time step chosen.
pub struct Prepared<'a> {
    setup: Setup<'a>,
    /// The stability limit at peak tension.
    pub limit: StabilityLimit,
    /// Mechanical steps in each exchange interval.
    pub steps_per_exchange: usize,
}

/// What every run starts from.
struct Setup<'a> {
    simulation: &'a Simulation,
    cell: CellIntegrator<'a>,
    body: Body,
    system: System,
    meter: ShapeMeter,
    /// kPa per unit of the model's tension.
    tension_scale: f64,
    /// Highest tension to be expected, kPa.
    strongest: f64,
    /// Tension of a default beat relative to that of the parameters that are scaled to the peak tension.
    strength: f64,
    resting_length: f64,
}

/// The mesh with its forces, and what measures it.
struct Assembly {
    body: Body,
    system: System,
    meter: ShapeMeter,
    resting_length: f64,
}

/// What a shape is recorded by; units as in [`Sample`].
#[derive(Debug, Clone, Copy, PartialEq)]
struct Observed {
    length: f64,
    width: f64,
    area: f64,
    elastic_energy: f64,
    kinetic_energy: f64,
    active_work: f64,
    dissipated_energy: f64,
    momentum: f64,
    angular_momentum: f64,
}

/// What gives the mesh its shape under a tension: a motion in time, or the path of equilibria.
trait Shaping {
    /// Follows the tension (kPa), linear over an exchange interval that ends at a time (ms).
    fn follow(&mut self, time: f64, tensions: [f64; 2]) -> Result<(), StopReason>;
    /// Length along the long axis now, um.
    fn length(&self) -> f64;
    /// All that is recorded now.
    fn observe(&self) -> Observed;
    /// Positions now, um.
    fn positions(&self) -> Vectors;
}

impl Simulation {
    /// The experiment of `coelho_2021` on any mesh: its cell model stimulated once at 50 ms, 50 kPa
    /// along the long axis, mass centre fixed, our default material, 600 ms.
    pub fn coelho_2021(mesh: Mesh) -> Self {
        let cell = coelho_2021::model();
        let long_axis = quality::long_axis(&mesh);
        Self {
            protocol: Protocol::once(cell.default_stimulus()),
            cell: Box::new(cell),
            peak_tension: 50.0,
            tension_scale: TensionScale::Published,
            long_axis,
            fibres: vec![long_axis; mesh.simplices.len()],
            mesh,
            material: default_material(),
            active: ActiveLaw::Fibre,
            support: SupportKind::MassCentre,
            duration: 600.0,
            numerics: Numerics::default(),
        }
    }

    /// Assembles the forces and chooses the time step of a motion in time, whatever method the
    /// numerical settings name.
    ///
    /// # Errors
    /// A time step above the stability limit, or a cell model without tension to scale.
    pub fn prepare(&self) -> Result<Prepared<'_>, SetupError> {
        let setup = self.set_up()?;
        let limit = StabilityLimit::of(&setup.system, &setup.body, setup.strongest);
        if let Some(time_step) = self.numerics.time_step
            && time_step > limit.time_step
        {
            let node = limit.stiffest_node;
            let [x, y] = [0, 1].map(|axis| self.mesh.points[axis][node]);
            let limit = limit.time_step;
            return Err(SetupError::UnstableStep { time_step, limit, node, x, y });
        }
        let wanted = self.numerics.time_step.unwrap_or(SAFETY * limit.time_step);
        // Equal steps that fill the exchange interval; a hair of slack for rounding in the quotient.
        let steps = (self.numerics.exchange_interval / wanted - 1e-9).ceil().max(1.0) as usize;
        Ok(Prepared { setup, limit, steps_per_exchange: steps })
    }

    fn set_up(&self) -> Result<Setup<'_>, SetupError> {
        let model = self.cell.name();
        let failed = |error: SolveError| SetupError::CellModel { model, cause: error.to_string() };
        let settings = self.numerics.cell;
        let [peak, highest] = self.peaks().map_err(failed)?;
        let cell = CellIntegrator::new(&*self.cell, self.protocol, settings).map_err(failed)?;
        let Assembly { body, system, meter, resting_length } = self.assembled();
        let tension_scale = self.peak_tension / peak;
        let strength = highest / peak;
        let strongest = self.peak_tension * strength.max(1.0);
        Ok(Setup {
            simulation: self,
            cell,
            body,
            system,
            meter,
            tension_scale,
            strongest,
            strength,
            resting_length,
        })
    }

    /// The tension of the model that is scaled to the peak tension, and the highest of a default beat. A
    /// model with its published parameters needs no beat for it.
    fn peaks(&self) -> Result<[f64; 2], SolveError> {
        let own = || solve::reference_beat(&*self.cell, self.numerics.cell);
        if self.tension_scale == TensionScale::OwnPeak {
            return own().map(|beat| [beat.peak_tension; 2]);
        }
        let published = self.cell.published_peak_tension();
        if cell::is_as_published(&*self.cell) {
            return Ok([published; 2]);
        }
        match own() {
            Ok(beat) => Ok([published, beat.peak_tension]),
            // Too weak to peak, or too slow to peak in time: not for us to refuse.
            Err(SolveError::NoPeak { value, .. }) => Ok([published, value.max(0.0)]),
            Err(error) => Err(error),
        }
    }

    fn assembled(&self) -> Assembly {
        let resting_length = shape::extent(&self.mesh.points, self.long_axis);
        let (body, system) = assemble(
            &self.mesh,
            &self.material,
            self.active,
            &self.fibres,
            self.support,
            self.long_axis,
            resting_length,
        );
        // A free cell turns as its mass does; a clamped one cannot turn, whatever it does inside. One that is
        // clamped at one end swings aside, though, and takes its width along.
        let areas = self.mesh.areas.clone();
        let meter = |weights| ShapeMeter::new(self.mesh.points.clone(), self.long_axis, weights);
        let meter = match &system.support {
            Support::Clamped(nodes) => {
                let mut held = vec![0.0; areas.len()];
                for &node in nodes {
                    held[node] = 1.0;
                }
                let meter = meter(held);
                if self.support == SupportKind::ClampedEnd {
                    meter.width_turned_by(areas)
                } else {
                    meter
                }
            }
            _ => meter(areas),
        };
        Assembly { body, system, meter, resting_length }
    }
}

impl Prepared<'_> {
    /// The mechanical time step, ms.
    pub fn time_step(&self) -> f64 {
        self.setup.simulation.numerics.exchange_interval / self.steps_per_exchange as f64
    }

    /// What keeps the fused kernel ([`crate::mechanics::stencil`]) from this run, in words for people; `None`
    /// if it makes the steps. The plain loops do the same in several times the time.
    pub fn plain_loops(&self) -> Option<&'static str> {
        let Setup { simulation, body, system, .. } = &self.setup;
        match &simulation.mesh.lattice {
            None => Some("a mesh that is no square lattice"),
            Some(lattice) if Stencil::takes(system, body, lattice) => None,
            Some(_) if simulation.active == ActiveLaw::Ends => Some("active = \"ends\""),
            Some(_) => match simulation.material.area_law {
                AreaLaw::Gradient => Some("a force or support that it does not know"),
                AreaLaw::Barycentric => Some("area_law = \"barycentric\""),
                AreaLaw::Printed => Some("area_law = \"printed\""),
            },
        }
    }

    /// Runs to the end or to the first thing that goes wrong; `observe` is called at each recorded
    /// sample and stops the run by returning `false`.
    pub fn run(&self, observe: impl FnMut(Progress) -> bool) -> Outcome {
        self.run_observed(&mut Samples(observe))
    }

    /// As [`Prepared::run`], for an observer that also hears which part of the work begins.
    pub fn run_observed(&self, observer: &mut dyn Observer) -> Outcome {
        let Setup { simulation, body, system, .. } = &self.setup;
        let integrator = simulation.numerics.method.in_time();
        let mut motion = Motion::new(system, body.clone(), integrator, self.time_step());
        if let Some(lattice) = &simulation.mesh.lattice {
            motion = motion.on_lattice(lattice, simulation.numerics.threads);
        }
        let mut shaping = InTime::new(&self.setup, motion, self.steps_per_exchange);
        let (recording, stop) = self.setup.run(&mut shaping, observer);
        let steps = shaping.steps_made();
        Outcome { recording, stop, time_step: self.time_step(), steps, limit: self.limit }
    }
}

impl Setup<'_> {
    /// kPa.
    fn tension_at_start(&self) -> f64 {
        self.tension_scale * self.simulation.cell.tension(self.cell.state())
    }

    /// The loop.
    fn run(
        &self,
        shaping: &mut impl Shaping,
        observer: &mut dyn Observer,
    ) -> (Recording, Option<StopReason>) {
        let Simulation { cell, duration, numerics, .. } = self.simulation;
        let exchange = numerics.exchange_interval;
        let exchanges = (duration / exchange).round() as u64;
        let per_sample = (numerics.output_interval / exchange).round().max(1.0) as u64;
        let per_frame = (numerics.frame_interval / exchange).round().max(1.0) as u64;

        let model = &**cell;
        let mut cell = self.cell.clone();
        let mut recording = Recording::default();
        let mut tension = self.tension_at_start();
        let mut strongest: Option<Frame> = None;
        let mut stop = None;
        let mut length = self.resting_length;
        for index in 0..=exchanges {
            let time = index as f64 * exchange;
            if index > 0 {
                let stretch = length / self.resting_length;
                observer.begins(Part::Cell);
                if let Err(error) = cell.advance_to(time, stretch) {
                    stop = Some(StopReason::CellModel { cause: error.to_string() });
                    break;
                }
                let next = self.tension_scale * model.tension(cell.state());
                observer.begins(Part::Mechanics);
                if let Err(reason) = shaping.follow(time, [tension, next]) {
                    stop = Some(reason);
                    break;
                }
                tension = next;
                length = shaping.length();
            }
            observer.begins(Part::Recording);
            let snapshot = || Frame { t_ms: time, ta_kpa: tension, positions: shaping.positions() };
            if index % per_sample == 0 {
                recording.samples.push(self.sample(time, &cell, tension, &shaping.observe()));
                if strongest.as_ref().is_none_or(|frame| tension > frame.ta_kpa) {
                    strongest = Some(snapshot());
                }
            }
            if index % per_frame == 0 {
                recording.frames.push(snapshot());
            }
            if index % per_sample == 0 && !observer.sample(Progress { time, duration: *duration }) {
                stop = Some(StopReason::Interrupted { time });
                break;
            }
        }
        // The shape at the peak of tension belongs to every record, whatever the frame interval.
        if let Some(frame) = strongest {
            let place = recording.frames.partition_point(|other| other.t_ms < frame.t_ms);
            if recording.frames.get(place).is_none_or(|other| other.t_ms > frame.t_ms) {
                recording.frames.insert(place, frame);
            }
        }
        (recording, stop)
    }

    fn sample(
        &self,
        time: f64,
        cell: &CellIntegrator<'_>,
        tension: f64,
        observed: &Observed,
    ) -> Sample {
        let model = &*self.simulation.cell;
        Sample {
            t_ms: time,
            u: model.potential(cell.state()),
            vm_mv: model.membrane_potential_mv(cell.state()),
            ta_kpa: tension,
            length_um: observed.length,
            width_um: observed.width,
            area_um2: observed.area,
            shortening_pct: 100.0 * (1.0 - observed.length / self.resting_length),
            elastic_energy_fj: observed.elastic_energy,
            kinetic_energy_fj: observed.kinetic_energy,
            active_work_fj: observed.active_work,
            dissipated_energy_fj: observed.dissipated_energy,
            momentum_nn_ms: observed.momentum,
            angular_momentum_nn_um_ms: observed.angular_momentum,
        }
    }
}

/// Projected area of a mesh in given positions, um^2.
pub fn projected_area(mesh: &Mesh, positions: &[Vec<f64>; 2]) -> f64 {
    mesh.simplices
        .iter()
        .map(|simplex| simplex.weight * signed_area(positions, simplex.nodes))
        .sum()
}

/// The first thing that is wrong with a body, if anything is.
fn fault(mesh: &Mesh, positions: &Vectors, time: f64, tension: f64) -> Option<StopReason> {
    let [x, y] = positions;
    let rest = |node: usize| (mesh.points[0][node], mesh.points[1][node]);
    if let Some(node) = (0..x.len()).find(|&node| !(x[node].is_finite() && y[node].is_finite())) {
        let (x, y) = rest(node);
        return Some(StopReason::NotFinite { time, node, x, y });
    }
    let zero = |nodes: [u32; 2]| {
        let [a, b] = nodes.map(|node| node as usize);
        x[a] == x[b] && y[a] == y[b]
    };
    if let Some(spring) = mesh.springs.iter().position(|spring| zero(spring.nodes)) {
        let node = mesh.springs[spring].nodes[0] as usize;
        let (x, y) = (x[node], y[node]);
        return Some(StopReason::ZeroLength { time, tension, spring, x, y });
    }
    let inverted = |nodes: [u32; 3]| signed_area(positions, nodes) <= 0.0;
    let triangle = mesh.simplices.iter().position(|simplex| inverted(simplex.nodes))?;
    let node = mesh.simplices[triangle].nodes[0] as usize;
    Some(StopReason::Inverted { time, tension, triangle, x: x[node], y: y[node] })
}
