//! The fibres of a cell: source of their direction, and what the picture shows.

use super::shown::{Shown, StackCell};
use crate::mesh::Mesh;
use crate::mesh::pixel_size::PixelSize;
use crate::mesh::quality::long_axis;
use crate::mesh::thick::Thick;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::fibres::{
    COARSEST_PIXEL_UM, Fibre as Place, FibreError, FibreField, FibreSettings, SarcomereDoubt, Stain,
};
use crate::microscopy::segment::Modality;
use crate::microscopy::stack::{self, StackError, StackFibres};
use serde::Serialize;
use std::fmt;

/// Why fibres cannot be read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FibresError {
    /// From a picture.
    #[error(transparent)]
    Picture(#[from] FibreError),
    /// From a stack of slices.
    #[error(transparent)]
    Stack(Box<StackError>),
}

impl From<StackError> for FibresError {
    fn from(error: StackError) -> Self {
        match error {
            StackError::Fibres(error) => Self::Picture(error),
            error => Self::Stack(Box::new(error)),
        }
    }
}

/// Direction of the fibres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FibreDirection {
    /// From the picture, if it shows sarcomeres or the stated stain; otherwise, and without a
    /// picture, along the long axis.
    Auto(Asked),
    /// Along the cell's long axis.
    LongAxis,
    /// At an angle counter-clockwise from x, degrees.
    Angle(f64),
    /// From the picture; along the long axis where it shows no fibres.
    Picture(FibreSettings),
}

/// Options for a picture that may or may not show fibres.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Asked {
    /// What the picture shows; by default z-discs, if stripes with the period of sarcomeres are
    /// found.
    pub stain: Option<Stain>,
    /// Scale over which directions are averaged, um.
    pub smoothing_um: Option<f64>,
}

/// Why the direction of the fibres was not read from the picture.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NotRead {
    /// A mask.
    #[error("a mask shows none")]
    Mask,
    /// A stain of the membrane alone.
    #[error("a stain of the membrane shows none")]
    Membrane,
    /// Brightfield, of which nobody said what it shows.
    #[error("a brightfield picture has no stain that shows them")]
    Brightfield,
    /// Pixels too large for stripes.
    #[error(
        "pixels of {0} are too coarse for stripes 1.6 to 2.2 um apart, which need at most {COARSEST_PIXEL_UM} um"
    )]
    TooCoarse(PixelSize),
    /// No sarcomeres stand out, and nobody said that something else does.
    #[error("the picture shows no sarcomeres")]
    NoSarcomeres,
    /// Nothing of what the stain shows stands out.
    #[error("the picture shows none")]
    Nothing,
}

/// The fibres of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Fibres {
    /// Source of their direction; never [`FibreDirection::Auto`].
    pub taken: FibreDirection,
    /// Unit vector along the fibre in each triangle of the mesh.
    pub directions: Vec<[f64; 2]>,
    /// What the picture shows, if they were read from it.
    pub seen: Option<PictureFibres>,
    /// Why they were not read from the picture, with [`FibreDirection::Auto`].
    pub not_read: Option<NotRead>,
    /// What the slices of a stack show, if they were read from it; then `directions` are those at half the height of the cell.
    pub slices: Option<StackFibres>,
    /// Warnings, one sentence each.
    pub warnings: Vec<String>,
}

/// What a picture shows of the fibres.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureFibres {
    /// What the picture shows.
    pub stain: Stain,
    /// The fibres everywhere in the cell.
    pub field: FibreField,
    /// The fibre in each triangle of the mesh.
    pub triangles: Vec<Place>,
}

/// The fibres of a cell in numbers.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FibreReport {
    /// Source of their direction: `picture`, `long axis`, or an angle.
    pub direction: String,
    /// Why they were not read from the picture, with `auto`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub not_read: Option<String>,
    /// What the picture shows, if they were read from it.
    #[serde(flatten)]
    pub seen: Option<SeenReport>,
    /// What the slices of a stack show, if they were read from it.
    #[serde(flatten)]
    pub slices: Option<StackFibres>,
}

/// What a picture shows of the fibres, in numbers over the cell's area.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SeenReport {
    /// What the picture shows.
    pub stain: Stain,
    /// Part of the cell that was read from the picture, per cent.
    pub read_pct: f64,
    /// Mean angle to the long axis, degrees counter-clockwise, above -90 and up to 90.
    pub angle_to_axis_deg: f64,
    /// How parallel the fibres are, 0 to 1; places where the long axis is used are included.
    pub alignment: f64,
    /// Mean of how sharply the picture shows one direction and one period, 0 to 1.
    pub order: f64,
    /// Median length of the sarcomeres that were read, um.
    pub sarcomere_um: Option<f64>,
    /// First quartile of it, um.
    pub sarcomere_q1_um: Option<f64>,
    /// Third quartile of it, um.
    pub sarcomere_q3_um: Option<f64>,
    /// Why that length is doubtful, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sarcomere_doubt: Option<SarcomereDoubt>,
    /// Number of triangles of the mesh in which a sarcomere length was read.
    pub sarcomeres: usize,
}

impl FibreDirection {
    /// The fibres on the mesh of a cell; `shown` shows them.
    ///
    /// # Errors
    /// A picture with pixels that are too coarse ([`FibreDirection::Picture`] only), or settings out of
    /// range.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::lattice;
    /// use myospring::settings::{Asked, FibreDirection};
    /// let mesh = lattice::rectangle(20, 4, 5.0).unwrap();
    /// // Without a picture the long axis is all that there is.
    /// let fibres = FibreDirection::Auto(Asked::default()).on(&mesh, None)?;
    /// assert_eq!(fibres.taken, FibreDirection::LongAxis);
    /// assert_eq!(fibres.directions, vec![[1.0, 0.0]; mesh.simplices.len()]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn on(self, mesh: &Mesh, shown: Option<Shown<'_>>) -> Result<Fibres, FibresError> {
        match (self, shown) {
            (Self::Picture(settings), Some(Shown::Picture(cells, cell))) => {
                let field = cells.fibres(cell, long_axis(mesh), &settings)?;
                let warnings = cells.fibre_warnings(&field);
                Ok(Fibres::read(mesh, settings, field, warnings))
            }
            (Self::Picture(settings), Some(Shown::Stack(cell))) => {
                Ok(cell.fibres(mesh, settings)?.unwrap_or_else(|warnings| Fibres {
                    warnings,
                    ..Fibres::everywhere(mesh, Self::LongAxis, long_axis(mesh))
                }))
            }
            (Self::Auto(asked), Some(Shown::Picture(cells, cell))) => asked.on(mesh, cells, cell),
            (Self::Auto(asked), Some(Shown::Stack(cell))) => asked.on_slices(mesh, cell),
            (Self::Angle(degrees), _) => {
                let (sine, cosine) = degrees.to_radians().sin_cos();
                Ok(Fibres::everywhere(mesh, self, [cosine, sine]))
            }
            (Self::LongAxis | Self::Auto(_) | Self::Picture(_), _) => {
                Ok(Fibres::everywhere(mesh, Self::LongAxis, long_axis(mesh)))
            }
        }
    }
}

impl StackCell {
    /// The fibres of all slices, or warnings if none shows a direction.
    fn fibres(
        &self,
        mesh: &Mesh,
        settings: FibreSettings,
    ) -> Result<Result<Fibres, Vec<String>>, StackError> {
        let slices = self.stack.fibres(&self.voxels, long_axis(mesh), &settings, &self.options)?;
        let [low, high] = self.voxels.bounds_um().map(|[_, _, z]| z);
        let middle = 0.5 * (low + high);
        let at = |[x, y]: [f64; 2]| slices.at([x, y, middle]);
        let directions = mesh.simplices.iter().map(|triangle| at(mesh.centre(triangle)));
        let Some(directions) = directions.collect() else { return Ok(Err(slices.warnings)) };
        let (taken, warnings) = (FibreDirection::Picture(settings), slices.warnings.clone());
        let slices = Some(slices);
        Ok(Ok(Fibres { taken, directions, seen: None, not_read: None, slices, warnings }))
    }
}

impl Asked {
    /// The settings by which a picture is read.
    pub fn settings(&self) -> FibreSettings {
        let of_stain = FibreSettings::of(self.stain.unwrap_or(Stain::ZDisc));
        let smoothing_um = self.smoothing_um.unwrap_or(of_stain.smoothing_um);
        FibreSettings { smoothing_um, ..of_stain }
    }

    /// The fibres of the picture, or the long axis and the reason.
    fn on(
        &self,
        mesh: &Mesh,
        cells: &PictureCells,
        cell: &PictureCell,
    ) -> Result<Fibres, FibresError> {
        let long_axis = long_axis(mesh);
        let instead = |reason, warnings| Ok(Fibres::along(mesh, reason, warnings));
        match (cells.segmentation().map(|found| found.modality), self.stain) {
            (Some(Modality::Mask), _) => return instead(NotRead::Mask, Vec::new()),
            (Some(Modality::Brightfield), None) => {
                return instead(NotRead::Brightfield, Vec::new());
            }
            _ => {}
        }
        let settings = self.settings();
        let field = match cells.fibres(cell, long_axis, &settings) {
            Err(FibreError::TooCoarse { pixel_size }) => {
                return instead(NotRead::TooCoarse(pixel_size), Vec::new());
            }
            field => field?,
        };
        let summary = field.summary();
        let none = summary.share_from_picture == 0.0;
        match self.stain {
            // Without a stated stain, the period of the stripes must be that of sarcomeres.
            None if none || summary.median_sarcomere_um.is_none() => {
                instead(NotRead::NoSarcomeres, field.doubts())
            }
            Some(_) if none => instead(NotRead::Nothing, field.doubts()),
            None => {
                let doubts = field.doubts();
                Ok(Fibres::read(mesh, settings, field, doubts))
            }
            Some(_) => {
                let warnings = cells.fibre_warnings(&field);
                Ok(Fibres::read(mesh, settings, field, warnings))
            }
        }
    }
}

impl Asked {
    /// The fibres of the slices, or the long axis and the reason. Without a stated stain, the slice in which the cell is widest must show
    /// stripes with the period of sarcomeres.
    fn on_slices(&self, mesh: &Mesh, cell: &StackCell) -> Result<Fibres, FibresError> {
        let instead = |reason, warnings| Ok(Fibres::along(mesh, reason, warnings));
        match (cell.report.modality, cell.report.stain) {
            (Modality::Mask, _) => return instead(NotRead::Mask, Vec::new()),
            (_, Some(stack::Stain::Membrane)) if self.stain.is_none() => {
                return instead(NotRead::Membrane, Vec::new());
            }
            _ => {}
        }
        let settings = self.settings();
        let axis = long_axis(mesh);
        let StackCell { stack, voxels, options, .. } = cell;
        let widest = match stack.fibres_of_widest(voxels, axis, &settings, options) {
            Err(StackError::Fibres(FibreError::TooCoarse { pixel_size })) => {
                return instead(NotRead::TooCoarse(pixel_size), Vec::new());
            }
            field => field?,
        };
        let (summary, doubts) = (widest.summary(), widest.doubts());
        if self.stain.is_none() && summary.median_sarcomere_um.is_none() {
            return instead(NotRead::NoSarcomeres, doubts);
        }
        match cell.fibres(mesh, settings)? {
            Ok(fibres) => Ok(fibres),
            Err(_) if self.stain.is_none() => instead(NotRead::NoSarcomeres, doubts),
            Err(_) => instead(NotRead::Nothing, doubts),
        }
    }
}

impl Fibres {
    /// The direction in each tetrahedron of a thick cell, where it is not that of the triangles below: from the slices of a stack, or by an
    /// angle, rad, by which the fibres turn from the lowest to the highest point.
    pub fn in_space(&self, thick: &Thick, helix_angle: f64) -> Option<Vec<[f64; 3]>> {
        if let Some(slices) = &self.slices {
            let tetrahedra = thick.mesh.simplices.iter().map(|of| thick.mesh.centre(of));
            return tetrahedra.map(|at| slices.at(at).map(|[x, y]| [x, y, 0.0])).collect();
        }
        (helix_angle != 0.0).then(|| thick.turned(&self.directions, helix_angle))
    }

    /// Along the long axis, and why.
    fn along(mesh: &Mesh, reason: NotRead, warnings: Vec<String>) -> Self {
        let along = Self::everywhere(mesh, FibreDirection::LongAxis, long_axis(mesh));
        Self { not_read: Some(reason), warnings, ..along }
    }

    fn everywhere(mesh: &Mesh, taken: FibreDirection, direction: [f64; 2]) -> Self {
        let directions = vec![direction; mesh.simplices.len()];
        Self { taken, directions, seen: None, not_read: None, slices: None, warnings: Vec::new() }
    }

    fn read(
        mesh: &Mesh,
        settings: FibreSettings,
        field: FibreField,
        warnings: Vec<String>,
    ) -> Self {
        let triangles = field.on_triangles(mesh);
        Self {
            taken: FibreDirection::Picture(settings),
            directions: triangles.iter().map(|place| place.direction).collect(),
            seen: Some(PictureFibres { stain: settings.stain, field, triangles }),
            not_read: None,
            slices: None,
            warnings,
        }
    }

    /// Its numbers for reports.
    pub fn report(&self) -> FibreReport {
        FibreReport {
            direction: match self.taken {
                FibreDirection::Picture(_) => "picture".to_owned(),
                FibreDirection::Angle(degrees) => format!("{degrees} deg"),
                FibreDirection::LongAxis | FibreDirection::Auto(_) => "long axis".to_owned(),
            },
            not_read: self.not_read.map(|reason| reason.to_string()),
            seen: self.seen.as_ref().map(PictureFibres::report),
            slices: self.slices.clone(),
        }
    }
}

impl PictureFibres {
    /// Its numbers for reports.
    pub fn report(&self) -> SeenReport {
        let summary = self.field.summary();
        let quartiles = summary.sarcomere_quartiles_um;
        SeenReport {
            stain: self.stain,
            read_pct: 100.0 * summary.share_from_picture,
            angle_to_axis_deg: summary.mean_angle_deg,
            alignment: summary.alignment,
            order: summary.mean_order,
            sarcomere_um: summary.median_sarcomere_um,
            sarcomere_q1_um: quartiles.map(|[first, _]| first),
            sarcomere_q3_um: quartiles.map(|[_, third]| third),
            sarcomere_doubt: summary.sarcomere_doubt,
            sarcomeres: self.lengths().count(),
        }
    }

    /// Lengths of the sarcomeres of the triangles in which one was read, um.
    pub fn lengths(&self) -> impl Iterator<Item = f64> {
        self.triangles.iter().filter_map(|place| place.sarcomere_um)
    }
}

impl fmt::Display for FibreReport {
    /// `63 % of the cell read from the picture, elsewhere its long axis; sarcomeres 1.83 um (quartiles 1.79, 1.88)`.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(slices) = &self.slices {
            return told_of_slices(slices, out);
        }
        let Some(seen) = &self.seen else {
            match self.direction.as_str() {
                "long axis" => write!(out, "along the cell's long axis")?,
                angle => write!(out, "at {angle}")?,
            }
            return match &self.not_read {
                Some(reason) => write!(out, ": {reason}"),
                None => Ok(()),
            };
        };
        write!(out, "{:.0} % of the cell read from the picture", seen.read_pct)?;
        if seen.read_pct < 99.5 {
            write!(out, ", elsewhere its long axis")?;
        }
        let SeenReport { sarcomere_um, sarcomere_q1_um, sarcomere_q3_um, .. } = seen;
        if let (Some(median), Some(q1), Some(q3)) = (sarcomere_um, sarcomere_q1_um, sarcomere_q3_um)
        {
            write!(out, "; sarcomeres {median:.2} um (quartiles {q1:.2}, {q3:.2})")?;
            if let Some(doubt) = seen.sarcomere_doubt {
                write!(out, ", doubtful: {doubt}")?;
            }
        }
        Ok(())
    }
}

/// `read from 12 of 14 slices; from the lowest of them to the highest they turn by 24 degrees (standard error 0.6); sarcomeres 1.83 um`.
fn told_of_slices(fibres: &StackFibres, out: &mut fmt::Formatter<'_>) -> fmt::Result {
    write!(out, "read from {} of {} slices", fibres.shown(), fibres.slices.len())?;
    if let Some(helix) = fibres.helix {
        let error = match helix.error_deg {
            small if small < 0.1 => "below 0.1".to_owned(),
            error => format!("{error:.1}"),
        };
        write!(
            out,
            "; from the lowest of them to the highest they turn by {:.0} degrees (standard error {error})",
            helix.turn_deg
        )?;
    }
    match fibres.sarcomere_um() {
        Some(length) => write!(out, "; sarcomeres {length:.2} um"),
        None => Ok(()),
    }
}
