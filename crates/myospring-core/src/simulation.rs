//! The loop: cell tension in, shape out.
//!
//! In every exchange interval the [`Activation`], by default a cell model, advances under the
//! stretch of the mesh. Its tension acts on the mesh, linearly interpolated over the interval, and
//! the masses follow. Every output interval a [`Sample`](crate::recording::Sample) is recorded,
//! every frame interval a [`Frame`](crate::recording::Frame).
//!
//! ```text
//! t        t + exchange
//! |---------|   activation: stretch at t  ->  tension at t + exchange
//! |-|-|-|-|-|   masses: n equal steps, tension linear in between
//! ```
//!
//! Where the tension depends on the stretch that it causes, both are solved together (see
//! `coupler`).
//!
//! [`Simulation::build`] checks everything and prepares a run by the method of the settings: in
//! time ([`Prepared`]), along the path of equilibria ([`PreparedPath`]), or, where the tension
//! differs from place to place, from equilibrium to equilibrium ([`PreparedField`]). The loop is
//! the same (`course`). A prepared run owns all its data and can be sent to a thread.
//!
//! A value that is not a number, an inverted triangle or a spring without length stops the run with
//! the time and the place; what was recorded until then is returned.

mod beats;
mod capture;
mod check;
mod coupler;
mod course;
pub mod equilibria;
mod fault;
mod field;
mod gauges;
mod given_calcium;
mod held;
mod in_time;
mod observer;
mod outcome;
mod pace;
mod period;
mod quasi_static;
mod ready;
mod setup;
mod shared;
mod shared_cell;
mod space;
mod stop;
mod strain;
mod thickness;
mod train;

pub use beats::Beating;
pub use check::{MOST_FRAME_MEMORY, MOST_FRAMES, MOST_SAMPLES, SettingError, divides};
pub use fault::projected_area;
pub use field::PreparedField;
pub use in_time::Prepared;
pub use observer::{Progress, RunObserver, RunPart};
pub use outcome::{Effort, Outcome};
pub use pace::Pace;
pub use quasi_static::PreparedPath;
pub use ready::{Motion, Ready};
pub use shared::SharedPath;
pub use space::InSpace;
pub use stop::{SetupError, StopReason};
pub use strain::MOST_STRAIN;
pub use train::Train;

use crate::cell::pacing::Protocol;
use crate::cell::solve::SolverSettings;
use crate::cell::{CellModel, coelho_2021};
use crate::exchange::{Activation, Coupling};
use crate::integrate::Method;
use crate::integrate::engine::Engine;
use crate::integrate::stepper::Stepper;
use crate::integrate::verlet::Integrator;
use crate::interruption::Interruption;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::material::{Material, default_material};
use crate::mechanics::support::SupportKind;
use crate::mechanics::{Body, System};
use crate::mesh::thick::Thick;
use crate::mesh::{Mesh, quality};
use serde::Serialize;
use std::sync::Arc;

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
    /// Interval of the recorded shapes, ms, a multiple of the output interval; 5. The shape at the
    /// peak of tension is recorded, too.
    pub frame_interval: f64,
    /// Integration of the cell model; `None` takes [`CellModel::usual_settings`], in a tissue [`SolverSettings::coupled`].
    pub cell: Option<SolverSettings>,
    /// Engine of a run in time: by default the fastest that can move this mesh, on one thread.
    /// [`crate::integrate::stencil::worthwhile_threads`] gives the useful number of threads.
    pub engine: Engine,
}

impl Default for Numerics {
    fn default() -> Self {
        Self {
            method: Method::Verlet(Integrator::StoermerVerlet),
            time_step: None,
            exchange_interval: 0.25,
            output_interval: 0.5,
            frame_interval: 5.0,
            cell: None,
            engine: Engine::default(),
        }
    }
}

/// The default time step as a part of the stability limit.
///
/// The limit is that of the resting shape under peak tension. Beats of the built-in cell are stable at
/// 0.998 of it at 12 % shortening and at 0.98 of it at 34 %.
pub const SAFETY: f64 = 0.95;

/// Which stretch acts on a cell model that depends on stretch.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum StretchFelt {
    /// That of the whole cell, with one model.
    Cell,
    /// That of each triangle along its fibre, with a model for each.
    Triangle,
}

/// The complete description of a run.
///
/// # Example
/// ```
/// use myospring::cell::{CellModel, pacing::Protocol, toy::ToyModel};
/// use myospring::prelude::*;
///
/// let strip = lattice::rectangle(20, 4, 5.0)?;
/// let toy = ToyModel::published();
/// let simulation = Simulation {
///     protocol: Protocol { start_ms: 0.0, ..Protocol::once(toy.default_stimulus()) },
///     cell: std::sync::Arc::new(toy),
///     duration: 60.0,
///     ..Simulation::new(strip)
/// };
/// let outcome = simulation.build()?.run(|progress| progress.time <= 60.0);
/// assert!(outcome.stop.is_none());
/// // The toy's tension peaks after 50 ms, and the strip with it.
/// assert!((outcome.recording.samples[100].shortening_pct - 12.0).abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone)]
pub struct Simulation {
    /// The cell model.
    pub cell: Arc<dyn CellModel>,
    /// When and how it is stimulated.
    pub protocol: Protocol,
    /// State in which the cell model starts, in the order of its states; `None` is its initial state.
    pub start_state: Option<Vec<f64>>,
    /// Peak of the active tension, kPa, of one default beat of the cell model with its published parameters
    /// ([`TensionKind::Relative`](crate::cell::TensionKind::Relative)): changed parameters change the strength of the cell.
    pub peak_tension: f64,
    /// Which stretch acts on a cell model that depends on stretch.
    pub stretch_felt: StretchFelt,
    /// Source of the tension instead of the cell model, in its state at 0 ms; cell model, protocol
    /// and peak tension are then not used.
    pub activation: Option<Box<dyn Activation>>,
    /// The mesh at rest; of a thick cell, as it is seen from above.
    pub mesh: Mesh,
    /// Its thickness above that mesh; `None` for a flat cell.
    pub thick: Option<Arc<Thick>>,
    /// Fibre direction in each tetrahedron of a thick cell, unit vectors; `None` is that of the triangles below, through the thickness.
    pub fibres_in_space: Option<Vec<[f64; 3]>>,
    /// Its long axis, a unit vector: length is measured along it.
    pub long_axis: [f64; 2],
    /// Fibre direction in each triangle, unit vectors.
    pub fibres: Vec<[f64; 2]>,
    /// Content of myofibrils in each triangle relative to that of the cell; tension is proportional
    /// to it. `None` is 1 everywhere.
    pub myofibril_content: Option<Vec<f64>>,
    /// Stretch along the fibre of each triangle of the cell at rest, as it acts on the cell model:
    /// the length of its sarcomeres over that at which the model's stretch is 1; `None` is 1
    /// everywhere. For a model of the whole cell the mean is used. It does not change the shape at
    /// rest.
    pub resting_stretch: Option<Vec<f64>>,
    /// Speed at which each stimulus travels along the long axis from the end where the axis starts,
    /// um/ms; `None` stimulates the whole cell at once.
    pub wave_speed: Option<f64>,
    /// How the cells of a tissue stimulate each other, one at each node; `None` for a single cell.
    pub tissue: Option<Coupling>,
    /// Material of the cell.
    pub material: Material,
    /// How the active tension acts.
    pub active: ActiveLaw,
    /// Support of the cell.
    pub support: SupportKind,
    /// How strongly each node adheres to a gel, where the support lets it: 0 is not at all, 1 with the stiffness of the
    /// adhesion, if it gives way. `None` is 1 everywhere, and the only choice without a gel.
    pub adhesion: Option<Vec<f64>>,
    /// Distance of clamped ends relative to that of the cell at rest, a pure number: above 1 the cell is stretched
    /// before it beats. 1 with any other support.
    pub end_stretch: f64,
    /// Time simulated, ms.
    pub duration: f64,
    /// Numerical settings.
    pub numerics: Numerics,
    /// Another integrator instead of Verlet's, for a run in time. Its time step is that of the
    /// numerical settings, even above the stability limit; by default that of Verlet's method.
    pub stepper: Option<MakeStepper>,
    /// Interruption that ends the preparation or the run early; a run returns what it has recorded.
    pub interruption: Interruption,
}

/// Makes a stepper for a system of forces, a body at rest and a time step in ms.
pub type MakeStepper =
    Arc<dyn for<'a> Fn(&'a System, Body, f64) -> Box<dyn Stepper + 'a> + Send + Sync>;

impl Simulation {
    /// The experiment of `coelho_2021` on any mesh: its cell model stimulated once at 50 ms, 50 kPa
    /// along the long axis, mass centre fixed, the default material, 600 ms.
    pub fn new(mesh: Mesh) -> Self {
        let cell = coelho_2021::model();
        let long_axis = quality::long_axis(&mesh);
        Self {
            protocol: Protocol::once(cell.default_stimulus()),
            cell: Arc::new(cell),
            start_state: None,
            peak_tension: 50.0,
            stretch_felt: StretchFelt::Cell,
            activation: None,
            long_axis,
            fibres: vec![long_axis; mesh.simplices.len()],
            myofibril_content: None,
            resting_stretch: None,
            wave_speed: None,
            tissue: None,
            mesh,
            thick: None,
            fibres_in_space: None,
            material: default_material(),
            active: ActiveLaw::Fibre,
            support: SupportKind::MassCentre,
            adhesion: None,
            end_stretch: 1.0,
            duration: 600.0,
            numerics: Numerics::default(),
            stepper: None,
            interruption: Interruption::default(),
        }
    }

    /// How the cell model is integrated: as [`Numerics::cell`] says, or as is usual for the model.
    pub fn cell_settings(&self) -> SolverSettings {
        self.numerics
            .cell
            .unwrap_or_else(|| SolverSettings::usual(&*self.cell, self.tissue.is_some()))
    }
}
