//! Decodes one strip or tile.
//!
//! Each is passed to the `tiff` library as a small TIFF of its own, whose directory is written here
//! from checked values. So the library does decompression, predictors and byte order, but never
//! sees a hostile or unusual directory (palettes, planes, odd bit depths, lists of wrong length).

use std::io::Cursor;

use ::tiff::decoder::{Decoder, DecodingResult, Limits};

use super::directory::{Directory, File, Tag};
use super::page::{Format, Page};
use crate::read::PictureError;
use crate::read::canvas::unpack;
use crate::read::error::damaged_tiff;

/// Upper bound of the compression ratio: LZW has codes of 12 bits for up to 4096 bytes.
const MOST_EXPANSION: u64 = 4096;

/// One decoded strip or tile.
pub(super) struct Chunk {
    stored: DecodingResult,
    /// Number of values of `stored` per row.
    row_length: usize,
    /// Bits of a sample, if several samples share a byte.
    packed: Option<u32>,
}

impl Chunk {
    /// Decodes the first `rows` rows of the strip or tile with this number in the page's list.
    pub(super) fn decode(
        file: &File,
        directory: &Directory,
        page: &Page,
        index: u64,
        rows: u32,
    ) -> Result<Self, PictureError> {
        let data = data(file, directory, page, index, rows)?;
        let packed = page.packed();
        let (columns, samples, bits) = if packed {
            (page.row_bytes() as u32, 1, 8)
        } else {
            (page.grid.columns, page.samples_in_chunk(), page.bits)
        };
        let format: u16 = match page.format {
            Format::Unsigned => 1,
            Format::Signed => 2,
            Format::Float => 3,
        };
        let length = data.len() as u32;
        let tags: [(u16, u32); 12] = [
            (256, columns),
            (257, rows),
            (258, bits),
            (259, u32::from(page.compression)),
            (262, 1),
            (273, HEAD_BYTES),
            (277, samples),
            (278, rows),
            (279, length),
            (284, 1),
            (317, u32::from(page.predictor)),
            (339, u32::from(format)),
        ];
        let mut bytes = head(file.big_endian, &tags);
        bytes.extend_from_slice(data);
        let failed = |error| damaged_tiff(format!("strip or tile {index}: {error}"));
        let mut decoder = Decoder::new(Cursor::new(bytes)).map_err(failed)?;
        // Sizes were checked when the page was read.
        decoder = decoder.with_limits(Limits::unlimited());
        let stored = decoder.read_image().map_err(failed)?;
        Ok(Self {
            stored,
            row_length: columns as usize * samples as usize,
            packed: packed.then_some(page.bits),
        })
    }

    /// Writes the samples of one row into `values`.
    pub(super) fn row(&self, row: usize, values: &mut Vec<f32>) {
        let range = row * self.row_length..(row + 1) * self.row_length;
        values.clear();
        match (&self.stored, self.packed) {
            (DecodingResult::U8(all), Some(bits)) => unpack(&all[range], bits, values),
            (DecodingResult::U8(all), None) => convert(&all[range], values, f32::from),
            (DecodingResult::I8(all), _) => convert(&all[range], values, f32::from),
            (DecodingResult::U16(all), _) => convert(&all[range], values, f32::from),
            (DecodingResult::I16(all), _) => convert(&all[range], values, f32::from),
            (DecodingResult::U32(all), _) => convert(&all[range], values, |value| value as f32),
            (DecodingResult::I32(all), _) => convert(&all[range], values, |value| value as f32),
            (DecodingResult::U64(all), _) => convert(&all[range], values, |value| value as f32),
            (DecodingResult::I64(all), _) => convert(&all[range], values, |value| value as f32),
            (DecodingResult::F16(all), _) => convert(&all[range], values, f32::from),
            (DecodingResult::F32(all), _) => values.extend(&all[range]),
            (DecodingResult::F64(all), _) => convert(&all[range], values, |value| value as f32),
        }
    }
}

fn convert<Number: Copy>(stored: &[Number], values: &mut Vec<f32>, number: impl Fn(Number) -> f32) {
    values.extend(stored.iter().map(|&value| number(value)));
}

/// The encoded bytes of a strip or tile.
fn data<'a>(
    file: &File<'a>,
    directory: &Directory,
    page: &Page,
    index: u64,
    rows: u32,
) -> Result<&'a [u8], PictureError> {
    let (offsets, lengths) = if page.grid.tiled {
        (Tag::TileOffsets, Tag::TileByteCounts)
    } else {
        (Tag::StripOffsets, Tag::StripByteCounts)
    };
    let whole = file.bytes.len() as u64;
    let decoded = page.row_bytes() * u64::from(rows);
    let missing = || damaged_tiff(format!("strip or tile {index} is not in its list"));
    let start = file.integer(directory, offsets, index).ok_or_else(missing)?;
    // The length of uncompressed data is computed, since some programs state it wrongly.
    let (length, cut) = if page.compression == 1 {
        (decoded, true)
    } else {
        (file.integer(directory, lengths, index).unwrap_or(whole), false)
    };
    let end = start.saturating_add(length);
    if start >= whole || (cut && end > whole) {
        return Err(damaged_tiff(format!(
            "strip or tile {index} lies at bytes {start} to {end}, but the file has {whole} bytes"
        )));
    }
    let data = &file.bytes[start as usize..end.min(whole) as usize];
    if decoded > (data.len() as u64 + 1) * MOST_EXPANSION {
        let found = data.len();
        return Err(damaged_tiff(format!(
            "strip or tile {index}: {found} bytes cannot hold {decoded}"
        )));
    }
    Ok(data)
}

/// Bytes of the head: 8, then a directory of 12 entries of 12 bytes with a count and a next offset.
const HEAD_BYTES: u32 = 8 + 2 + 12 * 12 + 4;

/// Header and directory of a TIFF with one strip.
fn head(big_endian: bool, tags: &[(u16, u32); 12]) -> Vec<u8> {
    const LONG: u16 = 4;
    const SHORT: u16 = 3;
    let mut bytes = Vec::with_capacity(HEAD_BYTES as usize);
    let short = |bytes: &mut Vec<u8>, number: u16| {
        bytes.extend(if big_endian { number.to_be_bytes() } else { number.to_le_bytes() });
    };
    let long = |bytes: &mut Vec<u8>, number: u32| {
        bytes.extend(if big_endian { number.to_be_bytes() } else { number.to_le_bytes() });
    };
    bytes.extend(if big_endian { b"MM" } else { b"II" });
    short(&mut bytes, 42);
    long(&mut bytes, 8);
    short(&mut bytes, tags.len() as u16);
    for &(tag, value) in tags {
        let is_long = matches!(tag, 256 | 257 | 273 | 278 | 279);
        short(&mut bytes, tag);
        short(&mut bytes, if is_long { LONG } else { SHORT });
        long(&mut bytes, 1);
        if is_long {
            long(&mut bytes, value);
        } else {
            short(&mut bytes, value as u16);
            short(&mut bytes, 0);
        }
    }
    long(&mut bytes, 0);
    bytes
}
