//! Arrays as pictures: what a microscope's software would have written, so that an array and a file take the same way.

use ::tiff::encoder::colortype::{ColorType, Gray8, Gray16, Gray32, Gray32Float, RGB8, RGB16};
use ::tiff::encoder::{TiffEncoder, TiffValue};
use numpy::{PyArrayDyn, PyArrayMethods, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::io::Cursor;

/// An array as a TIFF: (rows, columns) in grey or as labels, or (rows, columns, 3) in colour; of a `stack`, (slices, rows, columns).
#[pyfunction]
#[pyo3(signature = (array, stack=false))]
pub(crate) fn tiff<'py>(
    py: Python<'py>,
    array: &Bound<'py, PyAny>,
    stack: bool,
) -> PyResult<Bound<'py, PyBytes>> {
    macro_rules! try_as {
        ($($number:ty: $grey:ty $(, $colour:ty)?;)*) => {
            $(if let Ok(array) = array.cast::<PyArrayDyn<$number>>() {
                let values = array.readonly();
                let pixels = values.as_slice()?;
                return match *array.shape() {
                    [_, rows, columns] if stack => encode::<$grey>(py, [rows, columns], rows * columns, pixels),
                    ref other if stack => Err(PyValueError::new_err(format!(
                        "an array of the shape {other:?} is no stack; give (slices, rows, columns), in grey"
                    ))),
                    [rows, columns] => encode::<$grey>(py, [rows, columns], pixels.len(), pixels),
                    $([rows, columns, 3] => encode::<$colour>(py, [rows, columns], pixels.len(), pixels),)?
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

/// Pictures of `size` values each.
fn encode<'py, C: ColorType>(
    py: Python<'py>,
    sides: [usize; 2],
    size: usize,
    pixels: &[C::Inner],
) -> PyResult<Bound<'py, PyBytes>>
where
    [C::Inner]: TiffValue,
{
    let [rows, columns] = sides.map(|side| u32::try_from(side).unwrap_or(0));
    let mut bytes = Cursor::new(Vec::new());
    TiffEncoder::new(&mut bytes)
        .and_then(|mut encoder| {
            // A picture without pixels is one that cannot be written.
            let pages = if size == 0 { vec![pixels] } else { pixels.chunks(size).collect() };
            pages.into_iter().try_for_each(|page| encoder.write_image::<C>(columns, rows, page))
        })
        .map_err(|error| PyValueError::new_err(format!("the array is no picture: {error}")))?;
    Ok(PyBytes::new(py, bytes.get_ref()))
}
