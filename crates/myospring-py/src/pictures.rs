//! Arrays as pictures: what a microscope's software would have written, so that an array and a file take the same way.

use crate::errors;
use ::tiff::encoder::colortype::{ColorType, Gray8, Gray16, Gray32, Gray32Float, RGB8, RGB16};
use ::tiff::encoder::{TiffEncoder, TiffValue};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::io::Cursor;

/// An array as a TIFF: (rows, columns) in grey or as labels, or (rows, columns, 3) in colour.
#[pyfunction]
pub(crate) fn tiff<'py>(
    py: Python<'py>,
    array: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyBytes>> {
    macro_rules! try_as {
        ($($number:ty: $grey:ty $(, $colour:ty)?;)*) => {
            $(if let Ok(array) = array.cast::<PyArrayDyn<$number>>() {
                let values = array.readonly();
                let pixels = values.as_slice()?;
                return match *array.shape() {
                    [rows, columns] => encode::<$grey>(py, rows, columns, pixels),
                    $([rows, columns, 3] => encode::<$colour>(py, rows, columns, pixels),)?
                    ref other => Err(PyValueError::new_err(format!(
                        "an array of the shape {other:?} is no picture; give (rows, columns), or for 8 or 16 bits \
                         in colour (rows, columns, 3): one channel, slice and time of a stack"
                    ))),
                };
            })*
        };
    }
    try_as! {
        u8: Gray8, RGB8;
        u16: Gray16, RGB16;
        u32: Gray32;
        f32: Gray32Float;
    }
    Err(PyTypeError::new_err("a picture has pixels of type uint8, uint16, uint32 or float32"))
}

fn encode<'py, C: ColorType>(
    py: Python<'py>,
    rows: usize,
    columns: usize,
    pixels: &[C::Inner],
) -> PyResult<Bound<'py, PyBytes>>
where
    [C::Inner]: TiffValue,
{
    let side = |pixels: usize| u32::try_from(pixels).map_err(errors::value);
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes)
        .and_then(|mut encoder| {
            encoder.write_image::<C>(side(columns).unwrap_or(0), side(rows).unwrap_or(0), pixels)
        })
        .map_err(|error| PyValueError::new_err(format!("the array is no picture: {error}")))?;
    Ok(PyBytes::new(py, bytes.get_ref()))
}
