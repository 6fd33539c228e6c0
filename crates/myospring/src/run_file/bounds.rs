//! What each dimensional value of a run file may be: dimension, bounds and an example, stated once.

use super::error::Problem;
use crate::microscopy::segment::LARGEST_LABEL;
use crate::units::{self, Dimension};
use schemars::{JsonSchema, Schema, transform::Transform};
use serde::{Deserialize, Serialize};

/// A value as it was written: text with a unit, or a bare number.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(untagged)]
#[schemars(inline)]
pub enum Setting {
    /// A bare number: right for pure numbers only.
    Number(f64),
    /// Text: a number with its unit, or a word.
    Text(String),
}

impl Setting {
    /// A value in the internal unit of its dimension, as it is written back.
    pub fn of(value: f64, dimension: Dimension) -> Self {
        match dimension {
            Dimension::Number => Self::Number(value),
            _ => Self::Text(units::format(value, dimension)),
        }
    }

    /// Reads the value in the internal unit of its dimension.
    ///
    /// # Errors
    /// A wrong unit, no unit, or no finite number.
    pub fn read(&self, dimension: Dimension) -> Result<f64, units::UnitError> {
        match self {
            Self::Text(text) => units::parse(text, dimension),
            Self::Number(value) => units::parse(&value.to_string(), dimension),
        }
    }
}

impl std::fmt::Display for Setting {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Number(value) => write!(formatter, "{value}"),
            Self::Text(text) => write!(formatter, "\"{text}\""),
        }
    }
}

/// What a value may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// The key with its table: `material.thickness`.
    pub key: &'static str,
    /// What it measures.
    pub dimension: Dimension,
    /// Smallest value in the internal unit, itself allowed unless `open`.
    pub minimum: f64,
    /// Whether the smallest value itself is refused.
    pub open: bool,
    /// Largest value in the internal unit.
    pub maximum: f64,
    /// A value as a person writes it.
    pub example: &'static str,
}

impl Bounds {
    const fn new(key: &'static str, dimension: Dimension, example: &'static str) -> Self {
        Self { key, dimension, minimum: 0.0, open: false, maximum: 1.0, example }
    }

    const fn from(mut self, minimum: f64) -> Self {
        self.minimum = minimum;
        self
    }

    const fn above(mut self, minimum: f64) -> Self {
        self.minimum = minimum;
        self.open = true;
        self
    }

    const fn to(mut self, maximum: f64) -> Self {
        self.maximum = maximum;
        self
    }

    /// The bounds in words: `above 0 um, at most 100 um`.
    pub fn words(&self) -> String {
        let low = units::format(self.minimum, self.dimension);
        let high = units::format(self.maximum, self.dimension);
        if self.open { format!("above {low}, at most {high}") } else { format!("{low} to {high}") }
    }

    /// Whether a value in the internal unit is within the bounds.
    pub fn contains(&self, value: f64) -> bool {
        let low = if self.open { value > self.minimum } else { value >= self.minimum };
        low && value <= self.maximum
    }

    /// The bounds as a note for the JSON Schema.
    pub(super) const fn in_schema(self) -> Self {
        self
    }

    /// Reads a value and checks it.
    pub(super) fn read(&self, setting: &Setting) -> Result<f64, (String, Problem)> {
        let fail = |problem| (self.key.to_owned(), problem);
        let value = setting.read(self.dimension).map_err(|cause| {
            fail(Problem::Unit {
                key: self.key.to_owned(),
                cause,
                example: self.example.to_owned(),
            })
        })?;
        if self.contains(value) {
            return Ok(value);
        }
        Err(fail(Problem::OutOfBounds {
            key: self.key,
            value: units::format(value, self.dimension),
            bounds: self.words(),
            example: self.example,
        }))
    }

    /// Reads a value that may be absent.
    pub(super) fn read_or(
        &self,
        setting: Option<&Setting>,
        default: f64,
    ) -> Result<f64, (String, Problem)> {
        setting.map_or(Ok(default), |setting| self.read(setting))
    }

    /// Writes a value in the internal unit.
    pub(super) fn write(&self, value: f64) -> Setting {
        Setting::of(value, self.dimension)
    }
}

/// Tells the JSON Schema what the value may be.
impl Transform for Bounds {
    fn transform(&mut self, schema: &mut Schema) {
        schema.remove("anyOf");
        let types: &[&str] =
            if self.dimension == Dimension::Number { &["number", "string"] } else { &["string"] };
        schema.insert("type".to_owned(), types.into());
        schema.insert("x-unit".to_owned(), self.dimension.unit().into());
        schema.insert("x-bounds".to_owned(), self.words().into());
        // A pure number is written without quotes.
        let example: serde_json::Value =
            serde_json::from_str(self.example).unwrap_or_else(|_| self.example.into());
        schema.insert("examples".to_owned(), vec![example].into());
    }
}

/// What a whole number may be.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Whole {
    /// The key with its table: `stimulus.beats`.
    pub key: &'static str,
    /// Smallest value.
    pub minimum: i64,
    /// Largest value.
    pub maximum: i64,
    /// A value as a person writes it.
    pub example: i64,
}

impl Whole {
    /// The bounds as a note for the JSON Schema.
    pub(super) const fn in_schema(self) -> Self {
        self
    }

    /// Reads a value that may be absent; one within the bounds fits `T`.
    pub(super) fn read<T: TryFrom<i64>>(
        &self,
        value: Option<i64>,
    ) -> Result<Option<T>, (String, Problem)> {
        let Some(value) = value else { return Ok(None) };
        let inside = (self.minimum..=self.maximum).contains(&value);
        match T::try_from(value) {
            Ok(value) if inside => Ok(Some(value)),
            _ => {
                let wanted = format!("a whole number from {} to {}", self.minimum, self.maximum);
                let (key, found) = (self.key.to_owned(), value.to_string());
                Err((self.key.to_owned(), Problem::Kind { key, found, wanted }))
            }
        }
    }
}

/// Tells the JSON Schema what the value may be.
impl Transform for Whole {
    fn transform(&mut self, schema: &mut Schema) {
        schema.insert("minimum".to_owned(), self.minimum.into());
        schema.insert("maximum".to_owned(), self.maximum.into());
        schema.insert("examples".to_owned(), vec![self.example].into());
    }
}

/// `stimulus.beats`.
pub const BEATS: Whole = Whole { key: "stimulus.beats", minimum: 0, maximum: 10_000, example: 3 };
/// `shape.label`.
pub const LABEL: Whole =
    Whole { key: "shape.label", minimum: 1, maximum: LARGEST_LABEL as i64, example: 3 };
/// `segmentation.channel`.
pub const CHANNEL: Whole =
    Whole { key: "segmentation.channel", minimum: 0, maximum: 10_000, example: 0 };
/// `segmentation.frame`.
pub const FRAME: Whole =
    Whole { key: "segmentation.frame", minimum: 0, maximum: 1_000_000, example: 0 };

use Dimension::{Angle, BedStiffness, Length, Number, Pressure, Rate, Stiffness, Time};

/// `cell.peak_tension`.
pub const PEAK_TENSION: Bounds =
    Bounds::new("cell.peak_tension", Pressure, "50 kPa").from(0.0).to(500.0);
/// `cell.step`.
pub const CELL_STEP: Bounds = Bounds::new("cell.step", Time, "0.005 ms").above(0.0).to(1.0);
/// `stimulus.amplitude` of a jump.
pub const JUMP: Bounds = Bounds::new("stimulus.amplitude", Number, "0.325").from(-10.0).to(10.0);
/// `stimulus.amplitude` of a pulse.
pub const PULSE: Bounds =
    Bounds::new("stimulus.amplitude", Rate, "0.5 1/ms").from(-100.0).to(100.0);
/// `stimulus.duration`.
pub const PULSE_DURATION: Bounds =
    Bounds::new("stimulus.duration", Time, "1 ms").above(0.0).to(1000.0);
/// `stimulus.start`.
pub const START: Bounds = Bounds::new("stimulus.start", Time, "50 ms").from(0.0).to(1e5);
/// `stimulus.cycle_length`.
pub const CYCLE_LENGTH: Bounds =
    Bounds::new("stimulus.cycle_length", Time, "1000 ms").above(0.0).to(1e5);
/// `shape.pixel_size`.
pub const PIXEL_SIZE: Bounds =
    Bounds::new("shape.pixel_size", Length, "0.27 um").from(0.001).to(50.0);
/// `segmentation.smooth`.
pub const SMOOTH: Bounds = Bounds::new("segmentation.smooth", Length, "0.5 um").from(0.0).to(20.0);
/// `mechanics.fibre_smoothing`.
pub const FIBRE_SMOOTHING: Bounds =
    Bounds::new("mechanics.fibre_smoothing", Length, "3 um").from(0.1).to(20.0);
/// `shape.rotate`.
pub const ROTATE: Bounds = Bounds::new("shape.rotate", Angle, "30 deg").from(-360.0).to(360.0);
/// `shape.spacing`; the mesh checks it against the shape.
pub const SPACING: Bounds = Bounds::new("shape.spacing", Length, "1.1 um").above(0.0).to(1000.0);
/// `material.young_modulus`.
pub const YOUNG_MODULUS: Bounds =
    Bounds::new("material.young_modulus", Pressure, "308 kPa").from(0.1).to(1e6);
/// `material.spring_stiffness`.
pub const SPRING_STIFFNESS: Bounds =
    Bounds::new("material.spring_stiffness", Stiffness, "2310 nN/um").from(0.1).to(1e8);
/// `material.thickness`.
pub const THICKNESS: Bounds =
    Bounds::new("material.thickness", Length, "10 um").above(0.0).to(100.0);
/// `material.area_modulus`.
pub const AREA_MODULUS: Bounds =
    Bounds::new("material.area_modulus", Pressure, "175 kPa").from(0.0).to(1e6);
/// `material.damping_ratio`.
pub const DAMPING_RATIO: Bounds =
    Bounds::new("material.damping_ratio", Number, "0.05").from(0.0).to(10.0);
/// `material.slowest_period`.
pub const SLOWEST_PERIOD: Bounds =
    Bounds::new("material.slowest_period", Time, "2 ms").from(0.01).to(100.0);
/// `material.drag_ratio`.
pub const DRAG_RATIO: Bounds =
    Bounds::new("material.drag_ratio", Number, "0.3").from(0.0).to(100.0);
/// `mechanics.fibre`, as an angle.
pub const FIBRE: Bounds = Bounds::new("mechanics.fibre", Angle, "15 deg").from(-360.0).to(360.0);
/// `mechanics.end_stiffness`.
pub const END_STIFFNESS: Bounds =
    Bounds::new("mechanics.end_stiffness", Stiffness, "100 nN/um").above(0.0).to(1e8);
/// `mechanics.bed_stiffness`.
pub const BED_STIFFNESS: Bounds =
    Bounds::new("mechanics.bed_stiffness", BedStiffness, "0.5 kPa/um").above(0.0).to(1e6);
/// `numerics.time_step`; the simulation checks it against the stability limit.
pub const TIME_STEP: Bounds =
    Bounds::new("numerics.time_step", Time, "0.004 ms").from(1e-7).to(10.0);
/// `numerics.exchange_interval`.
pub const EXCHANGE_INTERVAL: Bounds =
    Bounds::new("numerics.exchange_interval", Time, "0.25 ms").from(1e-3).to(10.0);
/// `numerics.output_interval`.
pub const OUTPUT_INTERVAL: Bounds =
    Bounds::new("numerics.output_interval", Time, "0.5 ms").from(1e-3).to(1e4);
/// `numerics.frame_interval`.
pub const FRAME_INTERVAL: Bounds =
    Bounds::new("numerics.frame_interval", Time, "5 ms").from(1e-3).to(1e5);
/// `run.duration`.
pub const DURATION: Bounds = Bounds::new("run.duration", Time, "600 ms").above(0.0).to(1e6);
