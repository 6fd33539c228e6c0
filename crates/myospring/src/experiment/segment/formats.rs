//! Files of outlines: the ending says what a file holds.

use crate::experiment::ExperimentError;
use crate::experiment::input::ending;
use crate::microscopy::outlines::raster::{write_labels_png, write_mask_png};
use crate::microscopy::outlines::{
    NamedOutline, PixelFrame, write_cellpose, write_geojson, write_roi, write_roi_set,
};
use std::path::Path;

/// Endings of files of outlines that are written.
pub const ENDINGS: [&str; 6] = ["geojson", "json", "roi", "zip", "txt", "png"];

/// The outlines in the format that the ending names.
pub(super) fn encoded(
    file: &Path,
    cells: &[NamedOutline],
    frame: &PixelFrame,
) -> Result<Vec<u8>, ExperimentError> {
    let encoded = match (ending(file).as_str(), cells) {
        ("roi", [cell]) => Ok(write_roi(cell, frame)),
        ("roi", _) => {
            let message = format!("`{}` can hold one outline, not {}", file.display(), cells.len());
            return Err(ExperimentError::new(message)
                .advise("write several as a RoiSet: --output cells.zip"));
        }
        ("zip", _) => write_roi_set(cells, frame),
        ("txt", _) => write_cellpose(cells, frame).map(String::into_bytes),
        ("png", [cell]) => write_mask_png(cell, frame),
        ("png", _) => write_labels_png(cells, frame),
        _ => Ok(write_geojson(cells).into_bytes()),
    };
    encoded.map_err(|error| ExperimentError::new(format!("`{}`: {error}", file.display())))
}
