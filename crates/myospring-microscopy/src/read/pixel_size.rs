//! Chooses among the pixel sizes that a file states.

use super::super::picture::{PixelSizeSource, StatedPixelSize};
use super::PictureError;
use myospring_core::mesh::pixel_size::PixelSize;

/// Largest relative difference between the sides of a pixel.
const SQUARE: f64 = 0.01;

/// Finest resolution of prints and scans, pixels per inch.
const FINEST_PRINT: f64 = 9600.0;

/// Micrometres in an inch.
const INCH_UM: f64 = 25_400.0;

/// Sides of a pixel as a file states them, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Stated {
    pub(super) x_um: f64,
    pub(super) y_um: f64,
    pub(super) source: PixelSizeSource,
}

/// The first plausible one of several statements; implausible ones before it become notes.
pub(super) fn choose(
    stated: impl IntoIterator<Item = Stated>,
    notes: &mut Vec<String>,
) -> Result<Option<StatedPixelSize>, PictureError> {
    for Stated { x_um, y_um, source } in stated {
        let sides = believed(x_um, source).and_then(|size| believed(y_um, source).map(|_| size));
        let size = match sides {
            Ok(size) => size,
            Err(reason) => {
                notes.push(format!("{} says {x_um:.4} um per pixel: {reason}", name(source)));
                continue;
            }
        };
        if (x_um - y_um).abs() > SQUARE * x_um.min(y_um) {
            return Err(PictureError::NotSquare { x_um, y_um });
        }
        return Ok(Some(StatedPixelSize { size, source }));
    }
    Ok(None)
}

/// The side of a pixel as stated, or why it is not plausible.
fn believed(um: f64, source: PixelSizeSource) -> Result<PixelSize, String> {
    let size = PixelSize::new(um).map_err(|_| {
        let [least, most] = [PixelSize::SMALLEST_UM, PixelSize::LARGEST_UM];
        format!("outside {least} to {most} um, ignored")
    })?;
    let per_inch = INCH_UM / um;
    let from_resolution =
        matches!(source, PixelSizeSource::TiffResolution | PixelSizeSource::PngResolution);
    if from_resolution && is_print(per_inch) {
        return Err(format!("a print setting of {per_inch:.0} dpi, ignored"));
    }
    Ok(size)
}

/// The distance of two slices as stated, um, if it is plausible for a microscope; otherwise a note.
pub(super) fn plausible_z_step(
    (um, source): (f64, PixelSizeSource),
    notes: &mut Vec<String>,
) -> Option<f64> {
    let size = PixelSize::new(um);
    if size.is_err() {
        let [least, most] = [PixelSize::SMALLEST_UM, PixelSize::LARGEST_UM];
        let name = name(source);
        notes.push(format!(
            "{name} says {um} um from slice to slice: outside {least} to {most} um, ignored"
        ));
    }
    size.ok().map(PixelSize::um)
}

/// Whether a resolution is typical of printers, screens and scanners: a round number of pixels per
/// inch, to the precision of whole pixels per metre.
fn is_print(per_inch: f64) -> bool {
    let near = |step: f64| (per_inch - (per_inch / step).round() * step).abs() < 0.02;
    per_inch <= FINEST_PRINT && [72.0, 96.0, 100.0].into_iter().any(near)
}

fn name(source: PixelSizeSource) -> &'static str {
    match source {
        PixelSizeSource::OmeXml => "the OME-XML",
        PixelSizeSource::ImageJ => "ImageJ's description",
        PixelSizeSource::TiffResolution => "the TIFF resolution",
        PixelSizeSource::PngResolution => "the PNG resolution",
    }
}

/// Micrometres in a unit of length as written in OME-XML and ImageJ; `None` for `pixel` and unknown
/// units.
pub(super) fn unit_um(unit: &str) -> Option<f64> {
    // Files contain the micro sign, the Greek letter, or ImageJ's escape of the micro sign.
    let unit = unit.trim().replace("\\u00B5", "u").replace(['\u{b5}', '\u{3bc}'], "u");
    Some(match unit.as_str() {
        "um" | "micron" | "microns" | "micrometer" | "micrometre" | "micrometers" => 1.0,
        "nm" | "nanometer" | "nanometre" => 1e-3,
        "\u{c5}" | "A" | "angstrom" => 1e-4,
        "pm" => 1e-6,
        "mm" | "millimeter" | "millimetre" => 1e3,
        "cm" | "centimeter" | "centimetre" => 1e4,
        "m" | "meter" | "metre" => 1e6,
        "in" | "inch" | "inches" => INCH_UM,
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn print_settings_are_no_pixel_sizes() {
        for per_inch in [1200.0, 2400.0, 4800.0, 9600.0, 2400.013] {
            assert!(is_print(per_inch), "{per_inch}");
        }
        // 0.27 um, 1 um, 6.45 um (a camera without lens).
        for um in [0.27, 1.0, 6.45] {
            assert!(!is_print(INCH_UM / um), "{um}");
        }
    }

    #[test]
    fn micrometres_are_known_in_every_spelling() {
        for unit in ["um", "micron", "\u{b5}m", "\u{3bc}m", "\\u00B5m", " micron "] {
            assert_eq!(unit_um(unit), Some(1.0), "{unit}");
        }
        assert_eq!(unit_um("pixel"), None);
    }
}
