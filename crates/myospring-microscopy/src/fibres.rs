//! The direction of the myofibrils and the length of their sarcomeres, from the picture.
//!
//! **Stripes** ([`Stain::ZDisc`]) are recognised by the period that only sarcomeres have: peaks in
//! local power spectra at 1.4 to 2.6 um, near one period for the whole cell, in directions that
//! neighbours share (`stripes`). Columns of myofibrils, the rim, nuclei and single lines have
//! strong edges but no period, so they give no direction. Stripes of another period are never used:
//! they show that the pixel size is wrong ([`Misfit`]). A sarcomere length near an end of the band,
//! or read from a small part of the cell, is doubtful ([`SarcomereDoubt`]).
//!
//! **Threads** ([`Stain::Filament`]) have no period. At each pixel the grey values have a gradient `g`. The mean of
//! `g g^T` over a neighbourhood, the structure tensor, has its small eigenvector along the threads
//! (`bigun_granlund_1987`). The difference of the eigenvalues over their sum is the coherency: 1 where all
//! gradients lie on one line, 0 where no direction is preferred (`rezakhaniha_2012`). Done in this order:
//!
//! 1. Outside the cell pixels have no weight. The local mean of the cell is subtracted, so that
//!    uneven light and the step at the outline have no gradient.
//! 2. Gradients, as derivatives of a Gaussian of [`FibreSettings::gradient_scale_um`]. Those in a rim
//!    of [`FibreSettings::rim_um`] along the outline are left out.
//! 3. Tensors are divided by the gradient energy (their trace) around them, so that bright and dim
//!    myofibrils weigh the same. The energy is averaged over a few um: dividing each pixel's tensor
//!    by its own trace would give the noise between two threads the weight of a thread.
//! 4. A Gaussian of [`FibreSettings::smoothing_um`] over the tensors, and their eigenvectors.
//!
//! Where the picture shows no direction, the long axis of the cell is used. Directions are lines:
//! `v` and `-v` are one. All mixing is therefore done with the doubled angle, in which both are the
//! same vector. The mixed field is smoothed once more, over half as much, so that the direction
//! changes smoothly between the picture's and the long axis, as the mechanics need.

mod doubt;
mod field;
mod grid;
mod misfit;
mod reading;
mod settings;
mod spectra;
mod stripes;
mod tensor;
mod window;

use std::ops::RangeInclusive;

use super::plane::Plane;
pub use doubt::SarcomereDoubt;
pub use field::{Fibre, FibreField, FibreSummary};
pub use misfit::Misfit;
use myospring_core::interruption::{Interrupted, Interruption};
use myospring_core::mesh::pixel_size::PixelSize;
pub use settings::{COHERENCY_BOUNDS, FibreSettings, SCALES_UM, Stain};

/// Largest pixel, um: sarcomeres are 1.6 to 2.2 um long, and their stripes need more than two pixels.
pub const COARSEST_PIXEL_UM: f64 = 0.7;

/// Why a picture gives no directions.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FibreError {
    /// The work was ended early.
    #[error(transparent)]
    Interrupted(#[from] Interrupted),
    /// The mask does not fit the picture.
    #[error(
        "the mask has {found} pixels, but the picture has {width} x {height}; both must show the same \
         field of view at the same size"
    )]
    MaskShape {
        /// Columns of the picture.
        width: usize,
        /// Rows of the picture.
        height: usize,
        /// Pixels of the mask.
        found: usize,
    },
    /// No pixel is the cell.
    #[error("the mask is empty: fibres are sought within the cell, and no pixel belongs to it")]
    EmptyMask,
    /// The pixels are too large to show myofibrils.
    #[error(
        "pixels of {pixel_size} are too coarse for myofibrils: stripes 1.6 to 2.2 um apart need \
         pixels of at most {COARSEST_PIXEL_UM} um; take the long axis or a fixed angle instead"
    )]
    TooCoarse {
        /// Side of a pixel.
        pixel_size: PixelSize,
    },
    /// The long axis is not a direction.
    #[error("the long axis ({x}, {y}) has no finite length above 0; give a vector like (1, 0)")]
    LongAxis {
        /// Component along x.
        x: f64,
        /// Component along y.
        y: f64,
    },
    /// A setting out of range.
    #[error("{name} is {value}{unit}; it must be between {low} and {high}{unit}")]
    Setting {
        /// Which setting.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Its unit with a space before it, or nothing.
        unit: &'static str,
        /// Least value.
        low: f64,
        /// Greatest value.
        high: f64,
    },
}

/// The direction of the myofibrils everywhere in a cell.
///
/// `inside` says row by row from the top left which pixels are the cell; `pixel_size` is the side
/// of a pixel. `long_axis` (of any length, y upward) is the direction used where the picture shows
/// none. Points of the field are um from the lower left corner of the picture, y upward, as in
/// meshes made from a mask of that picture. Pixels with values that are not finite are ignored.
///
/// The field is found at any pixel size up to [`COARSEST_PIXEL_UM`]; a picture without structure is
/// not an error: it gives the long axis everywhere, and [`FibreSummary::share_from_picture`] is 0.
///
/// # Errors
/// A mask of another size or without a cell, pixels that are too coarse, a long axis of
/// no length, settings outside [`SCALES_UM`] and [`COHERENCY_BOUNDS`].
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// use myospring::microscopy::fibres::{FibreSettings, Stain, fibres};
/// use myospring::microscopy::plane::Plane;
/// // Upright z-discs 1.8 um apart: the fibre runs along x, although the cell stands upright.
/// let stripes = |i: usize| (std::f32::consts::TAU * 0.2 * (i % 100) as f32 / 1.8).sin();
/// let plane = Plane::new(100, 200, (0..20_000).map(stripes).collect()).unwrap();
/// let settings = FibreSettings::of(Stain::ZDisc);
/// let pixel = PixelSize::new(0.2)?;
/// let field = fibres(&plane, &[true; 20_000], pixel, [0.0, 1.0], &settings)?;
/// let fibre = field.at([10.0, 20.0]);
/// assert!(fibre.from_picture && fibre.angle_deg().abs() < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fibres(
    plane: &Plane,
    inside: &[bool],
    pixel_size: PixelSize,
    long_axis: [f64; 2],
    settings: &FibreSettings,
) -> Result<FibreField, FibreError> {
    let never = Interruption::default();
    fibres_interruptible(plane, inside, pixel_size, long_axis, settings, &never)
}

/// [`fibres`], ended early once `interruption` asks for it.
pub(crate) fn fibres_interruptible(
    plane: &Plane,
    inside: &[bool],
    pixel_size: PixelSize,
    long_axis: [f64; 2],
    settings: &FibreSettings,
    interruption: &Interruption,
) -> Result<FibreField, FibreError> {
    let (width, height) = (plane.width(), plane.height());
    if inside.len() != width * height {
        return Err(FibreError::MaskShape { width, height, found: inside.len() });
    }
    if pixel_size.um() > COARSEST_PIXEL_UM {
        return Err(FibreError::TooCoarse { pixel_size });
    }
    let [x, y] = long_axis;
    let length = x.hypot(y);
    if !(length.is_finite() && length > 0.0) {
        return Err(FibreError::LongAxis { x, y });
    }
    check(settings)?;
    interruption.check()?;
    let pixel_um = pixel_size.um();
    let (readings, band, misfit) = match settings.stain {
        Stain::Filament => (tensor::read(plane, inside, pixel_um, settings), None, None),
        Stain::ZDisc => {
            let found = stripes::of_cell(plane, inside, pixel_um, settings, interruption)?
                .ok_or(FibreError::EmptyMask)?;
            let misfit = misfit::find(plane, inside, pixel_um, settings, &found, interruption);
            let (readings, band) = (found.readings, found.band);
            let readings = if misfit.is_some() { readings.emptied() } else { readings };
            (Some(readings), Some(band), misfit)
        }
    };
    interruption.check()?;
    let axis = [x / length, y / length];
    // Half as wide as the neighbourhood over which directions are averaged.
    let border_um = 0.5 * settings.smoothing_um;
    let readings = readings.ok_or(FibreError::EmptyMask)?;
    Ok(FibreField::new(readings, band, misfit, axis, border_um))
}

fn check(settings: &FibreSettings) -> Result<(), FibreError> {
    let within = |name, value: f64, unit, bounds: &RangeInclusive<f64>| {
        let (low, high) = (*bounds.start(), *bounds.end());
        let error = FibreError::Setting { name, value, unit, low, high };
        if bounds.contains(&value) { Ok(()) } else { Err(error) }
    };
    for (name, value) in [
        ("the gradient scale", settings.gradient_scale_um),
        ("the background scale", settings.background_scale_um),
        ("the smoothing", settings.smoothing_um),
    ] {
        within(name, value, " um", &SCALES_UM)?;
    }
    within("the rim", settings.rim_um, " um", &(0.0..=*SCALES_UM.end()))?;
    within("the least coherency", settings.least_coherency, "", &COHERENCY_BOUNDS)
}
