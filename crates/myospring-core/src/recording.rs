//! The recording of a run: time series and frames.

use serde::{Deserialize, Serialize};

/// One row of the time series; the names of the CSV columns carry the units.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sample {
    /// Time, ms.
    pub t_ms: f64,
    /// The cell model's potential variable, dimensionless, if it has one.
    pub u: Option<f64>,
    /// Membrane potential, mV, if the model defines it.
    pub vm_mv: Option<f64>,
    /// Active tension, kPa; if it is not uniform, its mean over the cell.
    pub ta_kpa: f64,
    /// Length along the reference long axis after rigid rotation is removed, um: at rest the
    /// distance between its ends, scaled by the distance between the means of both ends.
    pub length_um: f64,
    /// Width across the long axis after rigid rotation is removed, um: at rest the largest extent,
    /// scaled by the distance between the means of both sides; between two clamps, across the line
    /// between them.
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
    /// Energy dissipated by dashpots and drag since the start, fJ.
    pub dissipated_energy_fj: f64,
    /// Size of the linear momentum, nN ms; internal forces keep it at zero.
    pub momentum_nn_ms: f64,
    /// Angular momentum about the mass centre, nN um ms, counter-clockwise; internal forces keep it at
    /// zero.
    pub angular_momentum_nn_um_ms: f64,
}

impl Sample {
    /// A cell at rest at 0 ms, with length, width and area 1, without potential.
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

/// A further output of the cell model over time, such as a calcium transient or a current.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Signal {
    /// Its name, ASCII.
    pub name: String,
    /// Its unit; empty for a dimensionless number.
    pub unit: String,
    /// One value for each sample, in that unit.
    pub values: Vec<f64>,
}

/// Name of the signal of the force with which a cell pulls its held ends inward, nN.
pub const END_FORCE: &str = "end_force";

/// Name of the signal of the sum of the absolute forces of the cell's nodes on the gel to which it adheres, nN.
pub const TRACTION_FORCE: &str = "traction_force";

/// Name of the signal of the force along the long axis with which the halves of the cell draw the gel together, nN: half the sum of the
/// forces along it, each counted towards the middle of the cell.
pub const AXIAL_FORCE: &str = "axial_force";

/// Name of the signal of the contractile moment, fJ: minus the sum of force times place at rest (`butler_2002`), above 0 where the
/// cell pulls inward.
pub const CONTRACTILE_MOMENT: &str = "contractile_moment";

/// Name of the signal of the elastic energy of the gel, fJ.
pub const GEL_ENERGY: &str = "gel_energy";

/// Name of the signal of the mean thickness of a thick cell, um.
pub const THICKNESS: &str = "thickness";

/// Name of the signal of the volume of a thick cell, um^3.
pub const VOLUME: &str = "volume";

/// Name of the signal of the length of the upper face of a thick cell, um.
pub const LENGTH_TOP: &str = "length_top";

/// Name of the signal of the length of the lower face of a thick cell, um.
pub const LENGTH_BOTTOM: &str = "length_bottom";

/// Name of the signal of free cytosolic calcium, uM.
pub const CALCIUM: &str = "Ca_i";

/// Name of the signal of the largest rate of the potential since the last stimulus, from the
/// model's own rates at every step, without the stimulus current.
pub const STEEPEST_RISE: &str = "steepest_rise";

/// What the signals of the mechanics are called in figures, and their units.
const TITLES: [(&str, &str, &str); 9] = [
    (END_FORCE, "Force at the ends", "nN"),
    (TRACTION_FORCE, "Force on the gel", "nN"),
    (AXIAL_FORCE, "Force on the gel along the cell", "nN"),
    (CONTRACTILE_MOMENT, "Contractile moment", "fJ"),
    (GEL_ENERGY, "Energy of the gel", "fJ"),
    (THICKNESS, "Mean thickness", "um"),
    (VOLUME, "Volume", "um^3"),
    (LENGTH_TOP, "Length of the upper face", "um"),
    (LENGTH_BOTTOM, "Length of the lower face", "um"),
];

impl Signal {
    /// Whether it is the signal of that name; one that was read from a table has its unit in its name.
    pub fn is(&self, name: &str) -> bool {
        self.name.strip_prefix(name).is_some_and(|unit| unit.is_empty() || unit.starts_with('_'))
    }

    /// What it is called in figures, and its unit: `Force on the gel` in nN. Signals of the cell model keep their names and units.
    ///
    /// ```
    /// use myospring_core::recording::{Signal, TRACTION_FORCE};
    ///
    /// let signal = |name: &str, unit: &str| Signal { name: name.into(), unit: unit.into(), values: vec![] };
    /// assert_eq!(signal(TRACTION_FORCE, "nN").title(), ("Force on the gel", "nN"));
    /// // As a table has it.
    /// assert_eq!(signal("traction_force_nN", "").title(), ("Force on the gel", "nN"));
    /// assert_eq!(signal("volume_um3", "").title(), ("Volume", "um^3"));
    /// assert_eq!(signal("volume_nsr", "pL").title(), ("volume_nsr", "pL"));
    /// ```
    pub fn title(&self) -> (&str, &str) {
        let known = TITLES.iter().find(|(name, _, unit)| {
            let rest = self.name.strip_prefix(name);
            rest.is_some_and(|rest| match rest.strip_prefix('_') {
                Some(in_name) => self.unit.is_empty() && in_name == unit.replace('^', ""),
                None => rest.is_empty() && self.unit == *unit,
            })
        });
        known.map_or((&self.name, &self.unit), |&(_, title, unit)| (title, unit))
    }
}

/// The cell's shape at one time.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame<const D: usize = 2> {
    /// Time, ms.
    pub t_ms: f64,
    /// Active tension, kPa; if it is not uniform, its mean over the cell, weighted by volume and
    /// content of myofibrils.
    pub ta_kpa: f64,
    /// Active tension of each triangle (with three axes tetrahedron), kPa, if it is not uniform.
    pub ta_by_triangle_kpa: Option<Vec<f64>>,
    /// Force of each node on the gel to which the cell adheres, nN: `on_gel_nn[axis][node]`.
    pub on_gel_nn: Option<[Vec<f64>; D]>,
    /// Membrane potential at each node, mV, where it differs from place to place, as in a tissue.
    pub potential_mv: Option<Vec<f64>>,
    /// Positions, um: `positions[axis][node]`.
    pub positions: [Vec<f64>; D],
}

impl<const D: usize> Frame<D> {
    /// The shape at a time (ms) of a cell on no gel with the same tension (kPa) everywhere; positions in um, `positions[axis][node]`.
    pub const fn new(t_ms: f64, ta_kpa: f64, positions: [Vec<f64>; D]) -> Self {
        Self {
            t_ms,
            ta_kpa,
            ta_by_triangle_kpa: None,
            on_gel_nn: None,
            potential_mv: None,
            positions,
        }
    }
}

/// One beat at one place of a tissue.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct LocalBeat {
    /// When the potential rose above -40 mV (a dimensionless one without millivolts: 0.5), ms.
    pub activated_ms: f64,
    /// When it had fallen by 90 % of its height above that at 0 ms, ms; `None` if it did not.
    pub repolarised_ms: Option<f64>,
}

/// Where a wave in a tissue ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WaveTip {
    /// When, ms.
    pub t_ms: f64,
    /// Where, in the tissue at rest, um.
    pub x_um: f64,
    /// Where, in the tissue at rest, um.
    pub y_um: f64,
}

/// How beats spread over a tissue.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Wave {
    /// Its nodes at rest, um: `points[axis][node]`.
    pub points: [Vec<f64>; 2],
    /// The corners of its triangles.
    pub triangles: Vec<[u32; 3]>,
    /// The beats of each node, in order of time.
    pub beats: Vec<Vec<LocalBeat>>,
    /// Where waves end, in order of time: the tips about which spiral waves turn (`fenton_1998`). Waves that meet have some for a moment.
    #[serde(default)]
    pub tips: Vec<WaveTip>,
}

/// The recording of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording<const D: usize = 2> {
    /// Time series, in order of time.
    pub samples: Vec<Sample>,
    /// Shapes, in order of time; of a thick cell as it is seen from above.
    pub frames: Vec<Frame<D>>,
    /// Of a thick cell, each of these shapes in space; empty of a flat one.
    pub in_space: Vec<Frame<3>>,
    /// Further outputs of the cell model; empty for most models.
    pub signals: Vec<Signal>,
    /// How beats spread, of a tissue.
    pub wave: Option<Wave>,
}

impl<const D: usize> Default for Recording<D> {
    /// An empty recording.
    fn default() -> Self {
        Self {
            samples: Vec::new(),
            frames: Vec::new(),
            in_space: Vec::new(),
            signals: Vec::new(),
            wave: None,
        }
    }
}
