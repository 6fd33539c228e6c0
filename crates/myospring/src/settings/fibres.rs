//! The fibres of a cell: source of their direction, and what the picture shows.

use crate::mesh::Mesh;
use crate::mesh::pixel_size::PixelSize;
use crate::mesh::quality::long_axis;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::fibres::{
    COARSEST_PIXEL_UM, Fibre as Place, FibreError, FibreField, FibreSettings, SarcomereDoubt, Stain,
};
use crate::microscopy::segment::Modality;
use serde::Serialize;
use std::fmt;

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
    /// The fibres on the mesh of a cell; `picture` is where it was found.
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
    pub fn on(
        self,
        mesh: &Mesh,
        picture: Option<(&PictureCells, &PictureCell)>,
    ) -> Result<Fibres, FibreError> {
        match (self, picture) {
            (Self::Picture(settings), Some((cells, cell))) => {
                let field = cells.fibres(cell, long_axis(mesh), &settings)?;
                let warnings = cells.fibre_warnings(&field);
                Ok(Fibres::read(mesh, settings, field, warnings))
            }
            (Self::Auto(asked), Some((cells, cell))) => asked.on(mesh, cells, cell),
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
    ) -> Result<Fibres, FibreError> {
        let long_axis = long_axis(mesh);
        let instead = |reason, warnings| {
            let not_read = Some(reason);
            let along = Fibres::everywhere(mesh, FibreDirection::LongAxis, long_axis);
            Ok(Fibres { not_read, warnings, ..along })
        };
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

impl Fibres {
    fn everywhere(mesh: &Mesh, taken: FibreDirection, direction: [f64; 2]) -> Self {
        let directions = vec![direction; mesh.simplices.len()];
        Self { taken, directions, seen: None, not_read: None, warnings: Vec::new() }
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
