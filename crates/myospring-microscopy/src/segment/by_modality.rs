//! Checks the plane and segments it by the picture's modality.

use super::fluorescence::Bright;
use super::found::Working;
use super::ladder::Climbed;
use super::{
    Modality, SegmentError, Segmentation, SegmentationSettings, brightfield, evidence,
    fluorescence, labels, modality,
};
use crate::plane::Plane;
use myospring_core::mesh::pixel_size::PixelSize;

/// Bounds of the scale of smoothing, um.
const SMOOTH_UM: [f64; 2] = [0.0, 20.0];

/// Finds the cells of a plane.
///
/// # Errors
/// A pixel size or setting out of range, pixels that are not finite, a blank picture, or no cell.
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::plane::Plane;
/// use myospring::microscopy::segment::{Choice, SegmentationSettings, segment};
/// // A bright disc of radius 20 um on a dark ground, pixels of 0.5 um.
/// let value = |x: f64, y: f64| if (x - 60.0).hypot(y - 60.0) < 40.0 { 900.0 } else { 100.0 };
/// let values = (0..120 * 120).map(|at| value(f64::from(at % 120), f64::from(at / 120)) as f32);
/// let plane = Plane::new(120, 120, values.collect()).unwrap();
/// let pixel = PixelSize::new(0.5).unwrap();
/// let cells = segment(&plane, pixel, &SegmentationSettings::default()).unwrap();
/// let cell = cells.choose(Choice::Largest, false).unwrap();
/// assert!((cell.area_um2 / 1256.6 - 1.0).abs() < 0.05);
/// ```
pub fn segment(
    plane: &Plane,
    pixel_size: PixelSize,
    settings: &SegmentationSettings,
) -> Result<Segmentation, SegmentError> {
    let interruption = &settings.interruption;
    interruption.check()?;
    check(plane, settings)?;
    let [low, high] = plane.range();
    if low == high {
        let (width, height) = (plane.width(), plane.height());
        return Err(SegmentError::Blank { width, height, value: low });
    }
    let working = || Working::of(plane, pixel_size, evidence::PIXEL_UM, interruption);
    match settings.modality {
        Modality::Mask => labels::segment(plane, pixel_size),
        Modality::Auto if modality::is_mask(plane) => labels::segment(plane, pixel_size),
        Modality::Auto => told_apart(plane, pixel_size, settings, working()?),
        Modality::Fluorescence => {
            let bright = Bright::of(working()?, settings)?;
            fluorescence::segment(bright, plane, pixel_size, settings)
        }
        Modality::Brightfield => {
            let texture = Climbed::by_texture(&working()?, settings.smallest_cell_um2)?;
            brightfield::segment(plane, pixel_size, settings, &texture)
        }
    }
}

/// Segments by the modality that explains the picture better.
fn told_apart(
    plane: &Plane,
    pixel_size: PixelSize,
    settings: &SegmentationSettings,
    working: Working,
) -> Result<Segmentation, SegmentError> {
    let texture = Climbed::by_texture(&working, settings.smallest_cell_um2)?;
    let bright = Bright::of(working, settings)?;
    let told = modality::by_evidence(&bright, &texture);
    let Some((modality, reason)) = told else {
        // Objects with neither may have closed edges.
        let edges = brightfield::segment(plane, pixel_size, settings, &texture);
        settings.interruption.check()?;
        return edges
            .ok()
            .filter(|found| found.cells.iter().any(|cell| !cell.confidence.is_doubtful()))
            .map(|found| {
                let reason = "objects differ from the background only in their edges".to_owned();
                Segmentation { modality_reason: Some(reason), ..found }
            })
            .ok_or(SegmentError::NothingStandsOut {
                smallest_um2: settings.smallest_cell_um2,
                pixel_size,
            });
    };
    let found = if modality == Modality::Fluorescence {
        fluorescence::segment(bright, plane, pixel_size, settings)
    } else {
        brightfield::segment(plane, pixel_size, settings, &texture)
    };
    match found {
        Ok(found) => Ok(Segmentation { modality_reason: Some(reason), ..found }),
        Err(SegmentError::NoCell { modality, threshold, why, pixel_size }) => {
            let why = format!("{why} (treated as {modality} because {reason})");
            Err(SegmentError::NoCell { modality, threshold, why, pixel_size })
        }
        Err(error) => Err(error),
    }
}

/// Whether a plane is segmented as a mask: as stated, or determined from its values.
pub(crate) fn is_taken_for_mask(plane: &Plane, settings: &SegmentationSettings) -> bool {
    match settings.modality {
        Modality::Mask => true,
        Modality::Auto => modality::is_mask(plane),
        Modality::Fluorescence | Modality::Brightfield => false,
    }
}

fn check(plane: &Plane, settings: &SegmentationSettings) -> Result<(), SegmentError> {
    if let Some(at) = plane.values().iter().position(|value| !value.is_finite()) {
        let (column, row) = (at % plane.width(), at / plane.width());
        return Err(SegmentError::NotFinite { column, row, value: plane.values()[at] });
    }
    check_settings(settings)
}

/// Rejects settings out of range.
pub(crate) fn check_settings(settings: &SegmentationSettings) -> Result<(), SegmentError> {
    let [low, high] = SMOOTH_UM;
    let smooth = settings.smooth_um.unwrap_or(low);
    let range = |what, value: f64, unit, low, high| {
        if (low..=high).contains(&value) {
            return Ok(());
        }
        Err(SegmentError::Setting { what, value, unit, low, high })
    };
    range("the scale of smoothing", smooth, "um", low, high)?;
    range("the smallest cell", settings.smallest_cell_um2, "um^2", 0.0, 1e6)?;
    range("the threshold", settings.threshold.unwrap_or(0.0), "", -1e12, 1e12)
}
