//! Fibres and sarcomeres of a whole picture without outlines, for sheets and tissues.

use super::cells::PictureCells;
use super::fibres::{Fibre, FibreError, FibreField, FibreSettings, FibreSummary};

/// Default distance of neighbouring places, um, and the largest number of places.
const SPACING_UM: f64 = 1.0;
const MOST_PLACES: f64 = 20_000.0;

/// Fibres and sarcomeres of a whole frame.
#[derive(Debug, Clone)]
pub struct WholeFrame {
    /// Width and height of the frame, um.
    pub size_um: [f64; 2],
    /// Distance of neighbouring places, um.
    pub spacing_um: f64,
    /// Places (um, y upward from the lower left corner) with their fibres.
    pub places: Vec<([f64; 2], Fibre)>,
    /// Summary over the whole frame.
    pub summary: FibreSummary,
    /// Mean direction over the places with fibres, degrees counter-clockwise from x, above -90 and
    /// up to 90.
    pub direction_deg: Option<f64>,
    /// How parallel the fibres of these places are, 0 to 1.
    pub alignment: Option<f64>,
    field: FibreField,
}

impl WholeFrame {
    /// Reads the fibres at places `spacing_um` apart; `None` takes 1 um, or more if there would be
    /// more than 20 000 places.
    ///
    /// # Errors
    /// Pixels that are too coarse, or settings out of range.
    pub fn read(
        cells: &PictureCells,
        settings: &FibreSettings,
        spacing_um: Option<f64>,
    ) -> Result<Self, FibreError> {
        let field = cells.fibres_of_frame(settings)?;
        let pixel_um = cells.pixel_size.um();
        let size_um =
            [cells.plane.width(), cells.plane.height()].map(|side| side as f64 * pixel_um);
        let [width, height] = size_um;
        let spacing_um =
            spacing_um.unwrap_or_else(|| SPACING_UM.max((width * height / MOST_PLACES).sqrt()));
        let places = field.on_grid(spacing_um);
        let read: Vec<&Fibre> =
            places.iter().map(|(_, place)| place).filter(|place| place.from_picture).collect();
        let count = read.len() as f64;
        // Directions are lines without sign, so doubled angles are averaged.
        let [x, y] = read.iter().fold([0.0, 0.0], |[x, y], place| {
            let (sine, cosine) = (2.0 * place.angle_deg().to_radians()).sin_cos();
            [x + cosine, y + sine]
        });
        let some = |value: f64| (count > 0.0).then_some(value);
        Ok(Self {
            size_um,
            spacing_um,
            summary: field.summary(),
            direction_deg: some(0.5 * y.atan2(x).to_degrees()),
            alignment: some(x.hypot(y) / count),
            places,
            field,
        })
    }

    /// Returns a function that determines whether a sarcomere length (um) is doubtful.
    pub fn doubtful_lengths(&self) -> impl Fn(f64) -> bool {
        self.field.doubtful_lengths()
    }

    /// Warning if the picture shows no fibres.
    pub fn note(&self) -> Option<&'static str> {
        (self.summary.share_from_picture == 0.0).then_some(
            "the picture shows no fibres: is the pixel size right, and does --stain match the stain?",
        )
    }
}
