//! Run files: a TOML text becomes validated working types, and goes back to text.
//!
//! ```text
//! text + options  ->  RunFile (what was written)  ->  Run (checked, internal units)  ->  Simulation
//!                          ^                             |
//!                          +----------- to_run_file -----+
//! ```
//!
//! The tables below are the one list of keys. Their JSON Schema ([`schema`]) finds unknown keys and
//! names, [`template()`] prints it with comments, and each value's bounds stand once, in [`bounds`].
//! No file is opened here: pictures come through a closure ([`Shape::bytes`]).
//!
//! # Example
//! ```
//! use myospring::run_file::RunFile;
//! let run = RunFile::from_text("[cell]\npeak_tension = \"40 kPa\"")?.resolve()?;
//! assert_eq!((run.peak_tension, run.duration), (40.0, 600.0));
//!
//! let error = RunFile::from_text("[material]\nthicknes = \"8 um\"").unwrap_err();
//! assert_eq!(
//!     error.to_string(),
//!     "line 2, column 1: unknown key `thicknes` in [material]; did you mean `thickness`?"
//! );
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod bounds;
mod check;
mod error;
mod picture;
mod reading;
mod resolve;
mod run;
mod shape;
mod template;

pub use bounds::{Bounds, Setting};
pub use error::{Origin, Problem, RunFileError};
pub use reading::Reader;
pub use run::{Fibre, Run};
pub use shape::{PictureSource, Shape, ShapeBytes, ShapeError, Shaped, Source};
pub use template::template;

use crate::cell::solve::Method;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::area::AreaLaw;
use crate::microscopy::fibres::Stain;
use crate::microscopy::segment::{LARGEST_LABEL, Modality};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A run file as it was written: every key may be absent.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct RunFile {
    /// What this run is about, for people.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub title: Option<String>,
    /// The cell model: action potential and active tension.
    pub cell: CellTable,
    /// When and how the cell is stimulated.
    pub stimulus: StimulusTable,
    /// The cell's shape: one of `built_in`, `picture`, `outline`.
    pub shape: ShapeTable,
    /// How the cell is found in a picture; of no use without one.
    pub segmentation: SegmentationTable,
    /// What the cell is made of, at rest and passive.
    pub material: MaterialTable,
    /// How the tension acts and what holds the cell.
    pub mechanics: MechanicsTable,
    /// Numerical settings; the defaults give a converged beat.
    pub numerics: NumericsTable,
    /// The run.
    pub run: RunTable,
}

/// `[cell]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct CellTable {
    /// Cell model; `myospring models` lists them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Peak of the active tension, to which the model's own peak is scaled.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::PEAK_TENSION.in_schema())]
    pub peak_tension: Option<Setting>,
    /// Integrate the cell model as the authors of `coelho_2021` did (staggered Euler, 0.05 ms);
    /// before scaling, their peak tension is 4 % low; its onset is 20 ms late. Not together with method
    /// or step.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub authors_step: Option<bool>,
    /// Integration method of the cell model.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub method: Option<Method>,
    /// Largest time step of the cell model.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::CELL_STEP.in_schema())]
    pub step: Option<Setting>,
    /// Parameters of the cell model that differ from the published ones, by name: "1.9 ms", or a
    /// plain number in the parameter's own unit; `myospring models NAME` lists them.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, Setting>,
}

/// How a stimulus acts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum StimulusKind {
    /// The potential variable jumps at once.
    Jump,
    /// A constant current for a while.
    Pulse,
}

/// `[stimulus]`; what is absent comes from the cell model.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct StimulusTable {
    /// A jump of the potential variable, or a pulse of current; by default the cell model's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub kind: Option<StimulusKind>,
    /// Size: a pure number for a jump of u, a rate ("0.5 1/ms") for a pulse; by default the cell
    /// model's own.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::JUMP.in_schema())]
    pub amplitude: Option<Setting>,
    /// How long a pulse lasts; not for a jump.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::PULSE_DURATION.in_schema())]
    pub duration: Option<Setting>,
    /// Time of the first stimulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::START.in_schema())]
    pub start: Option<Setting>,
    /// Number of stimuli; 0 leaves the cell at rest.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 10000))]
    pub beats: Option<i64>,
    /// Time from one stimulus to the next.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::CYCLE_LENGTH.in_schema())]
    pub cycle_length: Option<Setting>,
}

/// `[shape]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct ShapeTable {
    /// A cell that comes with the program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub built_in: Option<String>,
    /// Picture of the cell from a microscope, or its mask: PNG, TIFF or OME-TIFF; relative to this file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = "cell.png")]
    pub picture: Option<String>,
    /// Side of one pixel of the picture; by default what the picture says of itself. Never guessed. Also for
    /// an outline in pixels.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::PIXEL_SIZE.in_schema())]
    pub pixel_size: Option<Setting>,
    /// In a label mask, the grey value of the cell; without it the largest cell is taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = LARGEST_LABEL), example = 3)]
    pub label: Option<i64>,
    /// Outline of the cell: GeoJSON (.geojson, .json), points in um (.csv), ImageJ's .roi or RoiSet .zip,
    /// Cellpose's _outlines.txt; relative to this file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = "cell.geojson")]
    pub outline: Option<String>,
    /// Turns an outline or built-in cell counter-clockwise before it is meshed.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::ROTATE.in_schema())]
    pub rotate: Option<Setting>,
    /// Distance of neighbouring masses; by default such that the cell has about 2000 of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::SPACING.in_schema())]
    pub spacing: Option<Setting>,
}

/// `[segmentation]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct SegmentationTable {
    /// How the picture was taken.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = Modality::Auto)]
    pub modality: Option<Modality>,
    /// Channel of the picture, from 0; by default the first, of a colour picture its luminance.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 10000), example = 0)]
    pub channel: Option<i64>,
    /// Frame (time point) of the picture, from 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 0, max = 1000000), example = 0)]
    pub frame: Option<i64>,
    /// Of a stack in depth: "max", "mean", or the number of a slice, from 0; by default the maximum.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = &"max")]
    pub z: Option<Setting>,
    /// Threshold. Fluorescence: grey value above which a pixel is cell. Brightfield: least relative change of
    /// brightness per um that is an edge. By default found from the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = 120.5)]
    pub threshold: Option<f64>,
    /// Scale of smoothing; by default 0.5 um for fluorescence, 0.8 um for brightfield.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::SMOOTH.in_schema())]
    pub smooth: Option<Setting>,
    /// Takes the cell at this place: column and row in pixels from the top left.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = "120, 85")]
    pub seed: Option<String>,
    /// Which cell: "largest", or its number by size, 1 being the largest.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = "2")]
    pub cell: Option<Setting>,
    /// Takes a cell although the frame of the picture cuts it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = true)]
    pub allow_cut: Option<bool>,
    /// Outline of the cell drawn on the picture elsewhere, instead of finding it: GeoJSON, ImageJ's .roi or
    /// RoiSet .zip, Cellpose's _outlines.txt; relative to this file.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = "cell.roi")]
    pub outline: Option<String>,
}

/// `[material]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct MaterialTable {
    /// Young's modulus of the sheet that the springs make.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::YOUNG_MODULUS.in_schema())]
    pub young_modulus: Option<Setting>,
    /// Stiffness of a horizontal or vertical spring, instead of `young_modulus`; a diagonal one has
    /// half of it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::SPRING_STIFFNESS.in_schema())]
    pub spring_stiffness: Option<Setting>,
    /// Thickness of the cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::THICKNESS.in_schema())]
    pub thickness: Option<Setting>,
    /// What keeps the projected area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub area_law: Option<AreaLaw>,
    /// Stiffness of the area law per thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::AREA_MODULUS.in_schema())]
    pub area_modulus: Option<Setting>,
    /// Dashpots along the springs, as a part of critical damping.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::DAMPING_RATIO.in_schema())]
    pub damping_ratio: Option<Setting>,
    /// Period of the slowest vibration along the cell; sets the numerical density. Above 2 ms the
    /// contraction is no longer quasi-static.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::SLOWEST_PERIOD.in_schema())]
    pub slowest_period: Option<Setting>,
    /// Damping of that vibration by drag, as a part of critical damping.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::DRAG_RATIO.in_schema())]
    pub drag_ratio: Option<Setting>,
}

/// Which support holds the cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum SupportName {
    /// Mass centre and orientation fixed; otherwise free.
    MassCentre,
    /// The end where the long axis starts is clamped.
    ClampedEnd,
    /// Both ends are clamped: an isometric contraction.
    ClampedEnds,
    /// A spring at either end, such as a carbon fibre: an auxotonic contraction; needs `end_stiffness`.
    SpringHeldEnds,
    /// Every point is tied to its resting place, as on a gel; needs `bed_stiffness`.
    ElasticBed,
}

/// `[mechanics]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct MechanicsTable {
    /// How the tension acts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub active: Option<ActiveLaw>,
    /// Direction of the fibres: "long axis" of the cell, an angle counter-clockwise from x, or "picture",
    /// which reads it from the stripes or filaments of the picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::FIBRE.in_schema())]
    pub fibre: Option<Setting>,
    /// What the picture shows, for fibre = "picture": stripes across the fibre, or filaments along it.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(example = Stain::ZDisc)]
    pub stain: Option<Stain>,
    /// Scale over which directions from the picture are averaged; by default 3 um.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::FIBRE_SMOOTHING.in_schema())]
    pub fibre_smoothing: Option<Setting>,
    /// What holds the cell.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub support: Option<SupportName>,
    /// Stiffness of each of the two springs of "spring-held-ends", such as carbon fibres.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::END_STIFFNESS.in_schema())]
    pub end_stiffness: Option<Setting>,
    /// Stiffness of an "elastic-bed", traction per displacement: of a thin layer its shear modulus over its
    /// thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::BED_STIFFNESS.in_schema())]
    pub bed_stiffness: Option<Setting>,
}

/// How the mesh follows the tension.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(inline)]
pub enum IntegratorName {
    /// In time, by the paper's form of Verlet's method: the same as "stoermer-verlet".
    Verlet,
    /// Stoermer-Verlet, the paper's Eq. (16).
    StoermerVerlet,
    /// Velocity Verlet: the same positions to rounding.
    VelocityVerlet,
    /// Along the path of equilibria: fast, for tension along the fibre and the area law "gradient".
    QuasiStatic,
}

/// `[numerics]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct NumericsTable {
    /// How the mesh follows the tension: in time by Verlet's method, of which "verlet" is the paper's form,
    /// or along its equilibria.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub integrator: Option<IntegratorName>,
    /// Mechanical time step; by default 0.95 of the stability limit. A step above the limit is refused.
    /// Not for "quasi-static".
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::TIME_STEP.in_schema())]
    pub time_step: Option<Setting>,
    /// Interval at which cell model and mesh exchange tension and stretch.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::EXCHANGE_INTERVAL.in_schema())]
    pub exchange_interval: Option<Setting>,
    /// Interval of the rows in traces.csv, a multiple of the exchange interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::OUTPUT_INTERVAL.in_schema())]
    pub output_interval: Option<Setting>,
    /// Interval of the recorded shapes, a multiple of the output interval.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::FRAME_INTERVAL.in_schema())]
    pub frame_interval: Option<Setting>,
}

/// `[run]`.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default)]
#[schemars(inline)]
pub struct RunTable {
    /// Time simulated, a multiple of the exchange interval; by default 550 ms after the last stimulus.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schemars(transform = bounds::DURATION.in_schema())]
    pub duration: Option<Setting>,
}

impl RunFile {
    /// Reads the text of a run file.
    ///
    /// # Errors
    /// Text that is not TOML, unknown keys and names, values of the wrong kind; with the place.
    pub fn from_text(text: &str) -> Result<Self, RunFileError> {
        Ok(Reader::new().text("", text)?.read()?.0)
    }

    /// Checks every value and fills in every default.
    ///
    /// # Errors
    /// A value with a wrong unit or outside its bounds, keys that exclude each other, a model or
    /// parameter that does not exist.
    pub fn resolve(&self) -> Result<Run, RunFileError> {
        resolve::resolve(self).map_err(|(key, problem)| RunFileError::bare(&key, problem))
    }

    /// The run file as TOML; reading it gives the same run file.
    ///
    /// # Errors
    /// None that a run file can cause; the serialiser's signature has one.
    pub fn to_toml(&self) -> Result<String, RunFileError> {
        let text = toml::to_string(self).map_err(|error| {
            RunFileError::bare("", Problem::Syntax { reason: error.to_string() })
        })?;
        // Empty tables say nothing.
        let parts: Vec<&str> = text.split("\n\n").filter(|part| part.contains('=')).collect();
        Ok(format!("{}\n", parts.join("\n\n").trim_end()))
    }
}

/// JSON Schema of run files.
pub fn schema() -> serde_json::Value {
    let settings = schemars::generate::SchemaSettings::draft2020_12()
        .with(|settings| settings.inline_subschemas = true);
    let mut schema = settings.into_generator().into_root_schema_for::<RunFile>();
    schema.insert("title".to_owned(), "Myospring run file".into());
    schema.to_value()
}
