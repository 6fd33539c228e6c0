//! Reads and writes NumPy's archive of arrays, `.npz`, without pickled objects.
//!
//! The format is NumPy's own (NEP 1, version 1.0 of `.npy`): each array is a file `NAME.npy` in a
//! ZIP archive, a short header and the numbers as they lie in memory, row by row. It is written
//! uncompressed, since positions hardly compress; the same arrays give the same bytes.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

/// First bytes of an array, with the version of its header.
const MAGIC: &[u8; 8] = b"\x93NUMPY\x01\x00";
/// The header ends at a multiple of this.
const ALIGNMENT: usize = 64;

/// Numbers of an array.
#[derive(Debug, Clone, PartialEq)]
pub enum ArrayNumbers {
    /// 64-bit floats.
    Floats(Vec<f64>),
    /// Whole numbers, signed 32 bits.
    Whole(Vec<i32>),
}

/// An array: its shape and its numbers, row by row.
#[derive(Debug, Clone, PartialEq)]
pub struct Array {
    /// Length along each axis.
    pub shape: Vec<usize>,
    /// The values; their number is the product of the lengths.
    pub numbers: ArrayNumbers,
}

impl Array {
    /// An array of floats.
    pub fn floats(shape: impl Into<Vec<usize>>, numbers: impl IntoIterator<Item = f64>) -> Self {
        Self { shape: shape.into(), numbers: ArrayNumbers::Floats(numbers.into_iter().collect()) }
    }

    /// An array of whole numbers.
    pub fn whole(shape: impl Into<Vec<usize>>, numbers: impl IntoIterator<Item = i32>) -> Self {
        Self { shape: shape.into(), numbers: ArrayNumbers::Whole(numbers.into_iter().collect()) }
    }

    /// Its values, if they are floats.
    pub fn as_floats(&self) -> Option<&[f64]> {
        match &self.numbers {
            ArrayNumbers::Floats(numbers) => Some(numbers),
            ArrayNumbers::Whole(_) => None,
        }
    }

    /// Its lengths, the outermost first.
    pub fn shape(&self) -> &[usize] {
        &self.shape
    }

    /// Its values, if they are whole numbers.
    pub fn as_whole(&self) -> Option<&[i32]> {
        match &self.numbers {
            ArrayNumbers::Whole(numbers) => Some(numbers),
            ArrayNumbers::Floats(_) => None,
        }
    }

    /// The header of its NumPy file.
    fn header(&self) -> Vec<u8> {
        let kind = match self.numbers {
            ArrayNumbers::Floats(_) => "<f8",
            ArrayNumbers::Whole(_) => "<i4",
        };
        header(kind, &self.shape)
    }
}

/// The header of a NumPy file for an array of this type (`<f8`) and shape.
pub(crate) fn header(kind: &str, shape: &[usize]) -> Vec<u8> {
    let lengths: Vec<String> = shape.iter().map(|length| format!("{length},")).collect();
    let lengths = lengths.join(" ");
    let mut text = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({lengths}), }}");
    let before = MAGIC.len() + 2;
    let padded = (before + text.len() + 1).next_multiple_of(ALIGNMENT);
    text.extend(std::iter::repeat_n(' ', padded - before - text.len() - 1));
    text.push('\n');
    let length = (text.len() as u16).to_le_bytes();
    [MAGIC.as_slice(), &length, text.as_bytes()].concat()
}

/// Why an archive cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum NpzError {
    /// The archive is damaged.
    #[error("the archive of arrays is incomplete or damaged: {0}")]
    Archive(#[from] ZipError),
    /// The bytes of an array cannot be read or written.
    #[error("the array `{name}` of the archive cannot be read or written: {source}")]
    Bytes {
        /// The array.
        name: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// An array of an unsupported type.
    #[error(
        "`{name}` of the archive is not an array of 64-bit floats or 32-bit whole numbers, row by row"
    )]
    Kind {
        /// The array.
        name: String,
    },
}

/// Writes an archive of named arrays.
///
/// # Errors
/// More data than an archive can hold.
///
/// # Example
/// ```
/// use myospring::output::npz::{self, Array};
/// let times = Array::floats([2], [0.0, 5.0]);
/// let bytes = npz::to_bytes(&[("t_ms", times.clone())])?;
/// assert_eq!(npz::read(&bytes)?["t_ms"], times);
/// # Ok::<(), npz::NpzError>(())
/// ```
pub fn to_bytes(arrays: &[(&str, Array)]) -> Result<Vec<u8>, NpzError> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, array) in arrays {
        let failed = |source| NpzError::Bytes { name: (*name).to_owned(), source };
        let bytes = to_npy(array);
        let large = bytes.len() > u32::MAX as usize / 2;
        writer.start_file(format!("{name}.npy"), options.large_file(large))?;
        writer.write_all(&bytes).map_err(failed)?;
    }
    Ok(writer.finish()?.into_inner())
}

/// The content of a NumPy file of one array, `.npy`.
pub fn to_npy(array: &Array) -> Vec<u8> {
    let mut bytes = array.header();
    match &array.numbers {
        ArrayNumbers::Floats(numbers) => {
            bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
        ArrayNumbers::Whole(numbers) => {
            bytes.extend(numbers.iter().flat_map(|number| number.to_le_bytes()));
        }
    }
    bytes
}

/// Reads the arrays of an archive by their names.
///
/// # Errors
/// Bytes that are not an archive, or contain something other than supported arrays.
pub fn read(bytes: &[u8]) -> Result<BTreeMap<String, Array>, NpzError> {
    let mut archive = ZipArchive::new(Cursor::new(bytes))?;
    let mut arrays = BTreeMap::new();
    for index in 0..archive.len() {
        let mut file = archive.by_index(index)?;
        let name = file.name()?.trim_end_matches(".npy").to_owned();
        let mut content = Vec::new();
        file.read_to_end(&mut content)
            .map_err(|source| NpzError::Bytes { name: name.clone(), source })?;
        let array = from_npy(&content).ok_or_else(|| NpzError::Kind { name: name.clone() })?;
        arrays.insert(name, array);
    }
    Ok(arrays)
}

/// Reads the array of a NumPy file, `.npy`: 64-bit or 32-bit floats (which become 64-bit) or 32-bit whole numbers, row by row
/// or column by column; `None` of anything else.
pub fn from_npy(bytes: &[u8]) -> Option<Array> {
    let rest = bytes.strip_prefix(MAGIC.as_slice())?;
    let (length, rest) = rest.split_first_chunk::<2>()?;
    let (header, content) = rest.split_at_checked(usize::from(u16::from_le_bytes(*length)))?;
    let header = std::str::from_utf8(header).ok()?;
    let by_column = header.contains("'fortran_order': True");
    if !by_column && !header.contains("'fortran_order': False") {
        return None;
    }
    let (_, lengths) = header.split_once("'shape': (")?;
    let lengths = lengths.split_once(')')?.0.split(',').map(str::trim);
    let shape: Option<Vec<usize>> =
        lengths.filter(|length| !length.is_empty()).map(|length| length.parse().ok()).collect();
    let shape = shape?;
    let count = shape.iter().try_fold(1_usize, |product, length| product.checked_mul(*length))?;
    let numbers = if header.contains("'<f8'") {
        let (chunks, []) = content.as_chunks::<8>() else { return None };
        ArrayNumbers::Floats(chunks.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect())
    } else if header.contains("'<f4'") {
        let (chunks, []) = content.as_chunks::<4>() else { return None };
        let numbers = chunks.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes)));
        ArrayNumbers::Floats(numbers.collect())
    } else if header.contains("'<i4'") {
        let (chunks, []) = content.as_chunks::<4>() else { return None };
        ArrayNumbers::Whole(chunks.iter().map(|bytes| i32::from_le_bytes(*bytes)).collect())
    } else {
        return None;
    };
    let found = match &numbers {
        ArrayNumbers::Floats(numbers) => numbers.len(),
        ArrayNumbers::Whole(numbers) => numbers.len(),
    };
    if found != count {
        return None;
    }
    let numbers = match numbers {
        numbers if !by_column => numbers,
        ArrayNumbers::Floats(numbers) => ArrayNumbers::Floats(by_row(&numbers, &shape)),
        ArrayNumbers::Whole(numbers) => ArrayNumbers::Whole(by_row(&numbers, &shape)),
    };
    Some(Array { shape, numbers })
}

/// Numbers whose first index runs fastest, as NumPy has them in the order of Fortran, with the last one fastest.
fn by_row<T: Copy>(numbers: &[T], shape: &[usize]) -> Vec<T> {
    let mut indices = vec![0; shape.len()];
    let mut ordered = Vec::with_capacity(numbers.len());
    for _ in numbers {
        let at = indices.iter().zip(shape).rev().fold(0, |at, (index, length)| at * length + index);
        ordered.push(numbers[at]);
        for (index, length) in indices.iter_mut().zip(shape).rev() {
            *index += 1;
            if *index < *length {
                break;
            }
            *index = 0;
        }
    }
    ordered
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arrays_come_back_and_their_headers_are_aligned() {
        let arrays = [
            ("positions_um", Array::floats([2, 3, 1], (0..6).map(f64::from))),
            ("triangles", Array::whole([1, 3], [0, 1, -2])),
            ("none", Array::floats([0, 2], [])),
        ];
        for (_, array) in &arrays {
            assert_eq!(array.header().len() % ALIGNMENT, 0);
        }
        let read = read(&to_bytes(&arrays).unwrap()).unwrap();
        assert_eq!(read.len(), 3);
        for (name, array) in arrays {
            assert_eq!(read[name], array, "{name}");
        }
    }

    #[test]
    fn what_is_no_array_is_an_error_that_names_it() {
        assert!(matches!(super::read(b"no archive"), Err(NpzError::Archive(_))));
        let mut bytes = to_bytes(&[("t_ms", Array::floats([2], [0.0, 1.0]))]).unwrap();
        let at = bytes.windows(3).position(|part| part == b"<f8").unwrap();
        bytes[at..at + 3].copy_from_slice(b"|O8");
        // The checksum of the archive says so first.
        assert!(super::read(&bytes).is_err());
        let whole = Array::whole([1], [7]);
        let mut file = [whole.header(), vec![7, 0, 0, 0]].concat();
        assert_eq!(from_npy(&file), Some(whole));
        file.pop();
        assert_eq!(from_npy(&file), None);
    }

    #[test]
    fn an_array_that_is_stored_column_by_column_is_the_same_array() {
        let array = Array::floats([2, 3, 4], (0..24).map(f64::from));
        // As `numpy.asfortranarray` stores it: the first index runs fastest.
        let stored = (0..24).map(|at| f64::from(12 * (at % 2) + 4 * (at / 2 % 3) + at / 6));
        let mut file = to_npy(&Array::floats([2, 3, 4], stored));
        let at = file.windows(6).position(|part| part == b"False,").unwrap();
        file[at..at + 6].copy_from_slice(b"True, ");
        assert_eq!(from_npy(&file), Some(array));
    }
}
