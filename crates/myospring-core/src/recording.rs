//! What a run keeps: time series and frames.

use serde::{Deserialize, Serialize};

/// One row of the time series; the names of the CSV columns carry the units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time, ms.
    pub t_ms: f64,
    /// The cell model's potential variable, dimensionless, where it has one.
    pub u: Option<f64>,
    /// Membrane potential, mV, where the model defines it.
    pub vm_mv: Option<f64>,
    /// Active tension, kPa; of one that differs from place to place, its mean over the cell.
    pub ta_kpa: f64,
    /// Length along the reference long axis after rigid rotation is removed, um: end to end at rest, changed as the
    /// distance between the means of both ends.
    pub length_um: f64,
    /// Largest extent across the long axis at rest, changed as the distance between the means of both sides after the
    /// rigid rotation of the whole cell is removed, um; between two clamps, across the line between them.
    pub width_um: f64,
    /// Projected area, um^2.
    pub area_um2: f64,
    /// Shortening, per cent of the resting length.
    pub shortening_pct: f64,
    /// Energy of the conservative passive forces (springs, area law, elastic supports), fJ.
    pub elastic_energy_fj: f64,
    /// Kinetic energy, fJ.
    pub kinetic_energy_fj: f64,
    /// Work done by the active force since the start, fJ.
    pub active_work_fj: f64,
    /// Energy taken by dashpots and drag since the start, fJ.
    pub dissipated_energy_fj: f64,
    /// Size of the linear momentum, nN ms; internal forces keep it at zero.
    pub momentum_nn_ms: f64,
    /// Angular momentum about the mass centre, nN um ms, counter-clockwise; internal forces keep it at
    /// zero.
    pub angular_momentum_nn_um_ms: f64,
}

impl Sample {
    /// A cell of length, width and area 1 at 0 ms that does nothing and has no potential.
    pub const STILL: Self = Self {
        t_ms: 0.0,
        u: None,
        vm_mv: None,
        ta_kpa: 0.0,
        length_um: 1.0,
        width_um: 1.0,
        area_um2: 1.0,
        shortening_pct: 0.0,
        elastic_energy_fj: 0.0,
        kinetic_energy_fj: 0.0,
        active_work_fj: 0.0,
        dissipated_energy_fj: 0.0,
        momentum_nn_ms: 0.0,
        angular_momentum_nn_um_ms: 0.0,
    };
}

/// Something that the cell model tells beside potential and tension, over time: a transient of calcium, a
/// current.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// Its name, ASCII.
    pub name: String,
    /// Its unit as written for people; empty for a pure number.
    pub unit: String,
    /// One value for each sample, in that unit.
    pub values: Vec<f64>,
}

/// The signal of the force with which a cell draws its ends inward, nN, where both are held.
pub const END_FORCE: &str = "end_force";

/// The signal of free calcium in the cytosol, uM, of a cell model that has it.
pub const CALCIUM: &str = "Ca_i";

/// The signal of the largest rate of the potential since the last stimulus, by the model's own rates at every step and
/// without the current of the stimulus.
pub const STEEPEST_RISE: &str = "steepest_rise";

impl Signal {
    /// Whether it is the signal of that name; one that was read from a table has its unit in its name.
    pub fn is(&self, name: &str) -> bool {
        self.name.strip_prefix(name).is_some_and(|unit| unit.is_empty() || unit.starts_with('_'))
    }
}

/// The cell's shape at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame<const D: usize = 2> {
    /// Time, ms.
    pub t_ms: f64,
    /// Active tension, kPa; of one that differs from place to place, its mean over the cell, each triangle by
    /// its volume and its content of myofibrils.
    pub ta_kpa: f64,
    /// Active tension of each triangle, kPa, where it differs.
    pub ta_by_triangle_kpa: Option<Vec<f64>>,
    /// Positions, um: `positions[axis][node]`.
    pub positions: [Vec<f64>; D],
}

/// Everything one run kept.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording<const D: usize = 2> {
    /// Time series, in order of time.
    pub samples: Vec<Sample>,
    /// Shapes, in order of time.
    pub frames: Vec<Frame<D>>,
    /// What the cell model tells besides; none of most models.
    pub signals: Vec<Signal>,
}

impl<const D: usize> Default for Recording<D> {
    /// Nothing yet.
    fn default() -> Self {
        Self { samples: Vec::new(), frames: Vec::new(), signals: Vec::new() }
    }
}
