//! One frame as a TIFF.

use super::error::FilmError;
use crate::plane::Plane;
use crate::read::PictureError;
use myospring_core::mesh::pixel_size::PixelSize;
use std::io::Cursor;
use tiff::TiffError;
use tiff::encoder::colortype::{ColorType, Gray8, Gray16, Gray32Float};
use tiff::encoder::{Rational, TiffEncoder, TiffValue};
use tiff::tags::ResolutionUnit;

/// Micrometres per centimetre (the unit of resolution), and the denominator of the fraction that
/// states it.
const CENTIMETRE_UM: f64 = 1e4;
const PARTS: u32 = 10_000;

/// The bytes of a TIFF: whole numbers of 8 or 16 bits if all values are whole numbers, else
/// floating point.
pub(super) fn tiff(plane: &Plane, pixel_size: Option<PixelSize>) -> Result<Vec<u8>, FilmError> {
    let whole = plane.values().iter().all(|value| value.fract() == 0.0);
    let [low, high] = plane.range();
    let values = plane.values();
    let written = if whole && low >= 0.0 && high <= 255.0 {
        let values: Vec<u8> = values.iter().map(|&value| value as u8).collect();
        write::<Gray8>(plane, &values, pixel_size)
    } else if whole && low >= 0.0 && high <= 65_535.0 {
        let values: Vec<u16> = values.iter().map(|&value| value as u16).collect();
        write::<Gray16>(plane, &values, pixel_size)
    } else {
        write::<Gray32Float>(plane, values, pixel_size)
    };
    written.map_err(|error| {
        PictureError::Unreadable { format: "TIFF", reason: error.to_string() }.into()
    })
}

fn write<C: ColorType>(
    plane: &Plane,
    values: &[C::Inner],
    pixel_size: Option<PixelSize>,
) -> Result<Vec<u8>, TiffError>
where
    [C::Inner]: TiffValue,
{
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes)?;
    let mut image = encoder.new_image::<C>(plane.width() as u32, plane.height() as u32)?;
    if let Some(size) = pixel_size {
        let n = (CENTIMETRE_UM / size.um() * f64::from(PARTS)).round() as u32;
        image.resolution(ResolutionUnit::Centimeter, Rational { n, d: PARTS });
    }
    image.write_data(values)?;
    Ok(bytes.into_inner())
}
