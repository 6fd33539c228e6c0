//! Checks of a simulation before it runs.

use super::{Simulation, StretchFelt};
use crate::exchange::{ActivationBounds, Sites};
use crate::integrate::engine::Loops;
use crate::mechanics::active::ActiveLaw;
use crate::mechanics::gel::{Gel, GelError};
use crate::mechanics::material::Stiffness;
use crate::mechanics::post::Post;
use crate::mechanics::support::SupportKind;
use crate::mesh::thick::Thick;
use std::sync::Arc;

/// An invalid setting.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SettingError {
    /// A gel that does not fit the mesh.
    #[error(transparent)]
    Gel(GelError),
    /// A number out of range, or not a number.
    #[error("{what} is {value}{gap}{unit}; it must be {must}", gap = if unit.is_empty() { "" } else { " " })]
    Value {
        /// Which setting.
        what: &'static str,
        /// Its value.
        value: f64,
        /// Unit of the value.
        unit: &'static str,
        /// What it must be.
        must: &'static str,
    },
    /// An interval that does not hold a whole number of another.
    #[error(
        "{what} ({long} ms) is no multiple of {of} ({short} ms), so they cannot be kept; give a multiple"
    )]
    Interval {
        /// The longer interval.
        what: &'static str,
        /// Its length, ms.
        long: f64,
        /// The shorter one.
        of: &'static str,
        /// Its length, ms.
        short: f64,
    },
    /// A list with another length than the mesh has triangles or nodes.
    #[error("{what} has {found} entries, but the mesh has {expected} {parts}s: give one for each")]
    Length {
        /// Which list.
        what: &'static str,
        /// Its length.
        found: usize,
        /// Number of triangles or nodes.
        expected: usize,
        /// Which of them: `triangle` or `node`.
        parts: &'static str,
    },
    /// An entry of a list that is out of range, or not a number.
    #[error("{what} of {part} {index} is {value}; it must be {must}")]
    Entry {
        /// Which list.
        what: &'static str,
        /// `triangle` or `node`.
        part: &'static str,
        /// Which of them, from 0.
        index: usize,
        /// The value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },
    /// More shapes than fit into memory.
    #[error(
        "{shapes:.0} shapes of {masses} masses take {gigabytes:.1} GB of memory, more than {most:.1} GB; take a frame \
         interval of {interval:.0} ms or more, a shorter run or a coarser mesh"
    )]
    Memory {
        /// How many shapes would be recorded.
        shapes: f64,
        /// Masses of the mesh.
        masses: usize,
        /// Memory that the shapes would take.
        gigabytes: f64,
        /// Memory that they may take.
        most: f64,
        /// The shortest possible frame interval, ms.
        interval: f64,
    },
    /// Two choices that exclude each other.
    #[error("{what} and {with} do not go together: {because}")]
    Conflict {
        /// A choice.
        what: &'static str,
        /// Another.
        with: &'static str,
        /// Why not, and what to do instead.
        because: &'static str,
    },
}

/// Tolerance of whole quotients of intervals and of the length of unit vectors: far above rounding,
/// far below any intended difference.
const SLACK: f64 = 1e-6;

/// Allowed stretches of a cell at rest.
const RESTING_STRETCH: std::ops::RangeInclusive<f64> = 0.5..=1.5;

/// The smallest number of nodes that hold a cell on a gel: it turns about one.
const FEWEST: usize = 2;

const TRIANGLE: &str = "triangle";
const ABOVE: &str = "a finite number, 0 or above";

type Checked = Result<(), SettingError>;

fn value(what: &'static str, value: f64, unit: &'static str, positive: bool) -> Checked {
    let must = if positive { "a finite number above 0" } else { ABOVE };
    if value.is_finite() && (value > 0.0 || !positive && value == 0.0) {
        return Ok(());
    }
    Err(SettingError::Value { what, value, unit, must })
}

fn multiple(what: &'static str, long: f64, of: &'static str, short: f64) -> Checked {
    if divides(short, long) {
        Ok(())
    } else {
        Err(SettingError::Interval { what, long, of, short })
    }
}

/// Most samples that a run may record.
pub const MOST_SAMPLES: f64 = 5e6;
/// Most shapes that a run may record.
pub const MOST_FRAMES: f64 = 1e5;
/// Most memory that the shapes of a run may take, bytes: a beat of a million masses with the default interval takes
/// half of it.
pub const MOST_FRAME_MEMORY: f64 = 4e9;

/// Whether an interval is a multiple of a shorter one, up to the rounding of decimal fractions to
/// binary numbers.
///
/// # Example
/// ```
/// use myospring::simulation::divides;
/// assert!(divides(0.1, 600.0) && !divides(0.25, 600.1) && !divides(0.25, 200_000.1));
/// ```
pub fn divides(short: f64, long: f64) -> bool {
    let parts = long / short;
    let whole = parts.round();
    whole >= 1.0 && (parts - whole).abs() <= (SLACK * whole).min(1e-3)
}

/// Whether a length is not that of a unit vector.
fn is_no_unit(length: f64) -> bool {
    length.is_nan() || (length - 1.0).abs() > SLACK
}

/// Checks the bounds that an activation states: they must be finite, and their slopes must
/// stabilise the mesh.
pub(super) fn check_strongest(strongest: ActivationBounds) -> Checked {
    let ActivationBounds { tension, per_stretch, per_rate } = strongest;
    if !tension.is_finite() {
        let (what, must) = ("the strongest tension of the activation", "a finite number");
        return Err(SettingError::Value { what, value: tension, unit: "kPa", must });
    }
    value("the steepest slope of the activation by stretch", per_stretch, "kPa", false)?;
    value("the steepest slope of the activation by rate of stretch", per_rate, "kPa ms", false)
}

impl Simulation {
    /// Whether each triangle has its own activation.
    pub fn has_sites_in_triangles(&self) -> bool {
        if let Some(activation) = &self.activation {
            return matches!(activation.sites(), Sites::PerElement(_));
        }
        let each_feels = self.stretch_felt == StretchFelt::Triangle && self.cell.feels_stretch();
        each_feels || self.wave_speed.is_some() || self.tissue.is_some()
    }

    /// Checks every setting.
    pub(super) fn check(&self) -> Checked {
        self.check_times()?;
        self.check_memory()?;
        self.check_material()?;
        self.check_lists()?;
        self.check_adhesion()?;
        self.check_choices()
    }

    fn check_times(&self) -> Checked {
        let numerics = &self.numerics;
        value("the duration", self.duration, "ms", true)?;
        if let Some(step) = numerics.time_step {
            value("the time step", step, "ms", true)?;
        }
        let [exchange, output, frame] =
            [numerics.exchange_interval, numerics.output_interval, numerics.frame_interval];
        value("the exchange interval", exchange, "ms", true)?;
        value("the output interval", output, "ms", true)?;
        value("the frame interval", frame, "ms", true)?;
        multiple("the output interval", output, "the exchange interval", exchange)?;
        multiple("the frame interval", frame, "the output interval", output)?;
        multiple("the duration", self.duration, "the exchange interval", exchange)?;
        for (what, interval, most, must) in [
            (
                "the output interval",
                output,
                MOST_SAMPLES,
                "so long that there are at most 5e6 samples; or take fewer beats or a shorter duration",
            ),
            (
                "the frame interval",
                frame,
                MOST_FRAMES,
                "so long that there are at most 1e5 shapes; or take fewer beats or a shorter duration",
            ),
        ] {
            if self.duration / interval > most {
                return Err(SettingError::Value { what, value: interval, unit: "ms", must });
            }
        }
        Ok(())
    }

    fn check_memory(&self) -> Checked {
        let (duration, interval) = (self.duration, self.numerics.frame_interval);
        let masses = self.thick.as_ref().map_or(self.mesh.len(), |thick| thick.mesh.len());
        let field = self.has_sites_in_triangles();
        let in_space = if self.thick.is_some() { 3 * masses } else { 0 };
        let numbers =
            2 * self.mesh.len() + in_space + if field { self.mesh.simplices.len() } else { 0 };
        let bytes = (numbers * size_of::<f64>()) as f64;
        // Two more: at 0 ms, and at the peak of tension.
        let shapes = duration / interval + 2.0;
        if shapes * bytes <= MOST_FRAME_MEMORY {
            return Ok(());
        }
        Err(SettingError::Memory {
            shapes,
            masses,
            gigabytes: shapes * bytes / 1e9,
            most: MOST_FRAME_MEMORY / 1e9,
            interval: (duration / (MOST_FRAME_MEMORY / bytes - 2.0).max(1.0)).ceil(),
        })
    }

    fn check_material(&self) -> Checked {
        let material = &self.material;
        match material.stiffness {
            Stiffness::YoungModulus(modulus) => value("Young's modulus", modulus, "kPa", true)?,
            Stiffness::Spring(spring) => value("the spring stiffness", spring, "nN/um", true)?,
        }
        value("the thickness", material.thickness, "um", true)?;
        value("the area modulus", material.area_modulus, "kPa", false)?;
        value("the damping ratio", material.damping_ratio, "", false)?;
        if let Some(period) = material.slowest_period {
            value("the slowest period", period, "ms", true)?;
        }
        value("the drag ratio", material.drag_ratio, "", false)?;
        value("the retardation time", material.retardation_time, "ms", false)?;
        match self.support {
            SupportKind::SpringHeldEnds { stiffness } => {
                value("the stiffness of the ends", stiffness, "nN/um", true)
            }
            SupportKind::Posts(post) => Self::check_post(post),
            SupportKind::ElasticBed { stiffness } => {
                value("the stiffness of the bed", stiffness, "kPa/um", true)
            }
            SupportKind::AfterloadedEnds { load } => value("the afterload", load, "nN", true),
            SupportKind::Gel(gel) => self.check_gel(gel),
            SupportKind::MassCentre | SupportKind::ClampedEnd | SupportKind::ClampedEnds => Ok(()),
        }
    }

    fn check_post(post: Post) -> Checked {
        let Post { length, load_height, width, thickness, modulus } = post;
        value("the post length", length, "um", true)?;
        value("the post width", width, "um", true)?;
        value("the post thickness", thickness.unwrap_or(width), "um", true)?;
        value("Young's modulus of the posts", modulus, "kPa", true)?;
        let height = load_height.unwrap_or(length);
        value("the post load height", height, "um", true)?;
        if height > length {
            let (what, must) = ("the post load height", "at most the post length");
            return Err(SettingError::Value { what, value: height, unit: "um", must });
        }
        Ok(())
    }

    fn check_gel(&self, gel: Gel) -> Checked {
        value("Young's modulus of the gel", gel.modulus, "kPa", true)?;
        if !(0.0..0.5).contains(&gel.poisson) {
            let (what, must) = ("Poisson's ratio of the gel", "from 0 to below 0.5");
            return Err(SettingError::Value { what, value: gel.poisson, unit: "", must });
        }
        if let Some(thickness) = gel.thickness {
            value("the thickness of the gel", thickness, "um", true)?;
        }
        if let Some(stiffness) = gel.adhesion_stiffness {
            value("the stiffness of the adhesion", stiffness, "kPa/um", true)?;
        }
        gel.check(&self.mesh).map_err(SettingError::Gel)
    }

    /// Directions in the tetrahedra of a thick cell.
    fn check_fibres_in_space(&self) -> Checked {
        const TETRAHEDRON: &str = "tetrahedron";
        let Some(fibres) = &self.fibres_in_space else { return Ok(()) };
        let expected = self.thick.as_ref().map_or(0, |thick| thick.mesh.simplices.len());
        if fibres.len() != expected {
            let (what, found) = ("the list of fibres in space", fibres.len());
            return Err(SettingError::Length { what, found, expected, parts: TETRAHEDRON });
        }
        let lengths = fibres.iter().map(|[x, y, z]| x.hypot(*y).hypot(*z));
        match lengths.enumerate().find(|(_, length)| is_no_unit(*length)) {
            None => Ok(()),
            Some((index, value)) => {
                let (what, must) = ("the length of the fibre", "1: a unit vector");
                Err(SettingError::Entry { what, part: TETRAHEDRON, index, value, must })
            }
        }
    }

    fn check_lists(&self) -> Checked {
        let expected = self.mesh.simplices.len();
        let length = |what, found| {
            if found == expected {
                Ok(())
            } else {
                Err(SettingError::Length { what, found, expected, parts: TRIANGLE })
            }
        };
        let turned = self.long_axis[0].hypot(self.long_axis[1]);
        if is_no_unit(turned) {
            let (what, must) = ("the length of the long axis", "1: a unit vector");
            return Err(SettingError::Value { what, value: turned, unit: "", must });
        }
        length("the list of fibres", self.fibres.len())?;
        for (index, [x, y]) in self.fibres.iter().enumerate() {
            let value = x.hypot(*y);
            if is_no_unit(value) {
                let (what, must) = ("the length of the fibre", "1: a unit vector");
                return Err(SettingError::Entry { what, part: TRIANGLE, index, value, must });
            }
        }
        self.check_fibres_in_space()?;
        if let Some(stretch) = &self.resting_stretch {
            length("the stretch at rest", stretch.len())?;
            let outside = |value: &f64| !RESTING_STRETCH.contains(value);
            if let Some(index) = stretch.iter().position(outside) {
                let (what, part, must) = ("the stretch at rest", TRIANGLE, "from 0.5 to 1.5");
                return Err(SettingError::Entry { what, part, index, value: stretch[index], must });
            }
        }
        let Some(content) = &self.myofibril_content else { return Ok(()) };
        length("the content of myofibrils", content.len())?;
        match content.iter().position(|value| !(value.is_finite() && *value >= 0.0)) {
            None if content.iter().sum::<f64>() > 0.0 => Ok(()),
            None => Err(SettingError::Value {
                what: "the content of myofibrils of all triangles together",
                value: content.iter().sum(),
                unit: "",
                must: "above 0",
            }),
            Some(index) => {
                let (what, part) = ("the content of myofibrils", TRIANGLE);
                Err(SettingError::Entry { what, part, index, value: content[index], must: ABOVE })
            }
        }
    }

    /// The list says for each node how strongly it adheres, and enough of them do to hold the cell.
    fn check_adhesion(&self) -> Checked {
        let Some(adhesion) = &self.adhesion else { return Ok(()) };
        let SupportKind::Gel(gel) = self.support else {
            let because = "only a cell on a gel adheres; take support = \"gel\" or leave it out";
            return conflict("an adhesion for each node", "another support than a gel", because);
        };
        let (what, part) = ("the adhesion", "node");
        let (found, expected) = (adhesion.len(), self.mesh.len());
        if found != expected {
            return Err(SettingError::Length { what, found, expected, parts: part });
        }
        if let Some(index) = adhesion.iter().position(|it| !(it.is_finite() && *it >= 0.0)) {
            return Err(SettingError::Entry {
                what,
                part,
                index,
                value: adhesion[index],
                must: ABOVE,
            });
        }
        let attached = gel.attached(&self.mesh, self.long_axis, Some(adhesion)).len();
        if attached < FEWEST {
            let (what, must) =
                ("the number of nodes that adhere to the gel", "2 or more, which hold the cell");
            return Err(SettingError::Value { what, value: attached as f64, unit: "", must });
        }
        Ok(())
    }

    fn check_choices(&self) -> Checked {
        self.check_thickness()?;
        if let Some(speed) = self.wave_speed {
            value("the speed of the wave", speed, "um/ms", true)?;
        }
        self.check_tissue()?;
        let field = self.has_field()?;
        if self.active == ActiveLaw::Ends && self.myofibril_content.is_some() {
            let because = "loads on the ends know no triangles; take the fibre law";
            return conflict("a content of myofibrils", "the law of the ends", because);
        }
        if self.active == ActiveLaw::Ends && field {
            let because = "loads on the ends know one tension only; take the fibre law";
            return conflict("a tension for each triangle", "the law of the ends", because);
        }
        self.check_support(field)?;
        if self.material.retardation_time > 0.0 {
            self.check_retardation(field)?;
        }
        self.check_engine()
    }

    /// What a tissue cannot have.
    fn check_tissue(&self) -> Checked {
        if self.tissue.is_none() {
            return Ok(());
        }
        if self.wave_speed.is_some() {
            let because = "the wave of a tissue has the speed that its cells give it; leave out the speed of the wave";
            return conflict("a speed of the wave", "a tissue", because);
        }
        if self.thick.is_some() {
            let because = "a tissue is a flat sheet; leave out its profile, and give its thickness as that of the material";
            return conflict("a thickness in space", "a tissue", because);
        }
        if self.cell.feels_stretch() && self.numerics.method.is_in_time() {
            let because = "its stretch is foretold, which takes one that goes smoothly; take the quasi-static method";
            return conflict("a tissue that feels stretch", "a method in time", because);
        }
        Ok(())
    }

    /// Whether all is there that a thick cell needs, and nothing that only a flat one has.
    fn check_thickness(&self) -> Checked {
        let Some(thick) = &self.thick else { return Ok(()) };
        let thickness = "a thick cell";
        let (found, expected) = (thick.columns.len(), self.mesh.len());
        if found != expected {
            let what = "the list of columns of the thick cell";
            return Err(SettingError::Length { what, found, expected, parts: "node" });
        }
        let poisson = self.material.poisson_ratio;
        if !(0.25..0.5).contains(&poisson) {
            let (what, must) =
                ("Poisson's ratio", "from 0.25, that of springs alone, to below 0.5");
            return Err(SettingError::Value { what, value: poisson, unit: "", must });
        }
        if let Stiffness::Spring(_) = self.material.stiffness {
            let because = "the stiffness of its springs follows from Young's modulus; give that";
            return conflict("a spring stiffness", thickness, because);
        }
        if self.active == ActiveLaw::Ends {
            let because = "loads on the ends are for flat cells; take the fibre law";
            return conflict("the law of the ends", thickness, because);
        }
        if self.stepper.is_some() {
            let because = "its masses have three axes; take an integrator of the settings";
            return conflict("a stepper of your own", thickness, because);
        }
        Ok(())
    }

    /// Whether triangles have tensions of their own.
    fn has_field(&self) -> Result<bool, SettingError> {
        match self.activation.as_ref().map(|activation| activation.sites()) {
            Some(Sites::PerElement(found)) => {
                let simplices = |thick: &Arc<Thick>| thick.mesh.simplices.len();
                let expected = self.thick.as_ref().map_or(self.mesh.simplices.len(), simplices);
                let what = "the activation";
                if found != expected {
                    return Err(SettingError::Length { what, found, expected, parts: TRIANGLE });
                }
                Ok(true)
            }
            Some(Sites::Whole) => Ok(false),
            None => {
                let (what, value) = ("the peak tension", self.peak_tension);
                if !value.is_finite() {
                    let must = "a finite number";
                    return Err(SettingError::Value { what, value, unit: "kPa", must });
                }
                Ok(self.has_sites_in_triangles())
            }
        }
    }

    fn check_support(&self, field: bool) -> Checked {
        let clamps =
            matches!(self.support, SupportKind::ClampedEnds | SupportKind::AfterloadedEnds { .. });
        if self.end_stretch != 1.0 && !clamps {
            let because = "nothing holds the cell stretched; clamp its ends";
            return conflict("a stretch of the ends", "a support that lets them go", because);
        }
        if !RESTING_STRETCH.contains(&self.end_stretch) {
            let (what, must) = ("the stretch of the ends", "from 0.5 to 1.5");
            return Err(SettingError::Value { what, value: self.end_stretch, unit: "", must });
        }
        if matches!(self.support, SupportKind::AfterloadedEnds { .. }) {
            if self.numerics.method.is_in_time() {
                let because = "a grip that leaves its stop is followed from equilibrium to equilibrium; take the quasi-static method";
                return conflict("an afterload", "a method in time", because);
            }
            if field {
                let because = "a loaded grip needs one tension for the cell";
                return conflict("an afterload", "a tension for each triangle", because);
            }
        }
        Ok(())
    }

    /// Whether a path of equilibria can lag.
    fn check_retardation(&self, field: bool) -> Checked {
        let viscous = "a retardation time";
        if self.numerics.method.is_in_time() {
            let because = "dashpots that give it would ask for steps of some 1e-6 ms; take the quasi-static method";
            return conflict(viscous, "a method in time", because);
        }
        if field {
            let because = "the path of equilibria of one tension lags as a whole; take one tension for the cell";
            return conflict(viscous, "a tension for each triangle", because);
        }
        if self.support.gives_way() {
            let because =
                "it would make the springs of the support viscous, too; take another support";
            return conflict(viscous, "a support that gives way", because);
        }
        Ok(())
    }

    fn check_engine(&self) -> Checked {
        let chosen = self.numerics.engine.loops != Loops::Auto;
        if chosen && !self.numerics.method.is_in_time() {
            let because = "equilibria need no engine; take Loops::Auto, or a method in time";
            return conflict("an engine", "the quasi-static method", because);
        }
        if chosen && self.stepper.is_some() {
            let because = "the stepper moves the masses; take Loops::Auto";
            return conflict("an engine", "a stepper of your own", because);
        }
        if self.stepper.is_some() && !self.numerics.method.is_in_time() {
            let because = "a path of equilibria has no steps in time; take a method in time";
            return conflict("a stepper of your own", "the quasi-static method", because);
        }
        Ok(())
    }
}

fn conflict(what: &'static str, with: &'static str, because: &'static str) -> Checked {
    Err(SettingError::Conflict { what, with, because })
}
