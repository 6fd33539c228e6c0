//! A RoiSet: a zip of ImageJ ROIs, read and written.

use std::collections::BTreeSet;
use std::io::{Cursor, Read as _, Write as _};

use zip::result::ZipError;
use zip::write::SimpleFileOptions;
use zip::{ZipArchive, ZipWriter};

use super::{
    MOST_OUTLINES, MOST_POINTS, NamedOutline, OutlineFileError, OutlineWriteError, PixelFrame, Raw,
    roi, write_roi,
};

/// Largest ROI: all points as shorts and floats, and room for headers and properties.
const LARGEST_ROI: u64 = 12 * MOST_POINTS as u64 + (1 << 16);

/// Largest sum of all ROIs, unpacked, bytes.
const LARGEST_SET: u64 = 1 << 26;

/// Reads all ROIs of a zip in their order; ROIs that enclose no area are left out with a note.
pub(super) fn read(bytes: &[u8], notes: &mut Vec<String>) -> Result<Vec<Raw>, OutlineFileError> {
    let failed = |error: ZipError| OutlineFileError::Zip { reason: error.to_string() };
    let mut archive = ZipArchive::new(Cursor::new(bytes)).map_err(failed)?;
    if archive.len() > MOST_OUTLINES {
        let (what, found) = ("entries in its zip", archive.len());
        return Err(OutlineFileError::TooMany { what, found, bound: MOST_OUTLINES });
    }
    let mut outlines = Vec::new();
    let mut left = LARGEST_SET;
    for index in 0..archive.len() {
        let entry = archive.by_index(index).map_err(failed)?;
        let name = entry.name().map_err(failed)?.into_owned();
        if entry.is_dir() || hidden(&name) {
            continue;
        }
        let bound = LARGEST_ROI.min(left);
        let mut bytes = Vec::new();
        let read = entry.take(bound + 1).read_to_end(&mut bytes);
        let length = read
            .map_err(|error| OutlineFileError::Zip { reason: format!("entry `{name}`: {error}") })?
            as u64;
        if length > bound {
            return Err(OutlineFileError::TooLarge { name: format!("entry `{name}`"), bound });
        }
        left -= length;
        match roi::read(&bytes, &name) {
            Ok(raw) => outlines.extend(raw),
            Err(OutlineFileError::RoiKind { name, kind, .. }) => {
                notes.push(format!("{name} is an ImageJ {kind} ROI and was left out"));
            }
            Err(error) => return Err(error),
        }
    }
    Ok(outlines)
}

/// Whether an entry is one of the files that macOS adds to a zip.
fn hidden(name: &str) -> bool {
    name.starts_with("__MACOSX/") || name.ends_with(".DS_Store")
}

/// Writes outlines as a RoiSet, which Fiji's ROI Manager opens; names are kept, and repeated names
/// get a number.
///
/// # Errors
/// More than [`MOST_OUTLINES`].
///
/// # Example
/// ```
/// use myospring::mesh::{outline::Outline, pixel_size::PixelSize};
/// use myospring::microscopy::outlines::{NamedOutline, PixelFrame, write_roi_set};
/// let square = vec![[5.0, 5.0], [9.0, 5.0], [9.0, 9.0], [5.0, 9.0]];
/// let outline = Outline::new(square, vec![])?;
/// let frame = PixelFrame::new(20, 20, PixelSize::new(1.0)?)?;
/// let zip = write_roi_set(&[NamedOutline { name: "1".to_owned(), outline }], &frame)?;
/// assert!(zip.starts_with(b"PK"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn write_roi_set(
    cells: &[NamedOutline],
    frame: &PixelFrame,
) -> Result<Vec<u8>, OutlineWriteError> {
    let found = cells.len();
    if found > MOST_OUTLINES {
        return Err(OutlineWriteError::TooMany { found, bound: MOST_OUTLINES });
    }
    pack(cells, frame).map_err(|error| OutlineWriteError::Encode { reason: error.to_string() })
}

fn pack(cells: &[NamedOutline], frame: &PixelFrame) -> Result<Vec<u8>, ZipError> {
    let mut writer = ZipWriter::new(Cursor::new(Vec::new()));
    let mut taken = BTreeSet::new();
    for cell in cells {
        // A name must not point outside the folder into which the zip is unpacked.
        let plain = cell.name.replace(['/', '\\', ':'], "_");
        let plain = if plain.trim().is_empty() { "cell".to_owned() } else { plain };
        let mut name = plain.clone();
        let mut number = 2;
        while !taken.insert(name.clone()) {
            name = format!("{plain}-{number}");
            number += 1;
        }
        writer.start_file(format!("{name}.roi"), SimpleFileOptions::default())?;
        writer.write_all(&write_roi(&NamedOutline { name, ..cell.clone() }, frame))?;
    }
    Ok(writer.finish()?.into_inner())
}
