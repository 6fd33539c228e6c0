//! Where tractions are sought: a picture that is black elsewhere, or outlines.

use super::measured::Grid;
use crate::experiment::input::ending;
use crate::experiment::{ExperimentError, Files};
use crate::mesh::pixel_size::PixelSize;
use crate::microscopy::outlines::{
    CoordinateUnit, PixelFrame, Placement, ReadOptions, raster, read_outlines,
};
use crate::microscopy::picture::Selection;
use crate::microscopy::read::read_picture;
use crate::settings::OUTLINE_ENDINGS;
use std::path::Path;

/// The places of the region that a file shows, rows from the lowest.
pub(super) fn read(path: &Path, grid: &Grid, files: &Files) -> Result<Vec<bool>, ExperimentError> {
    let bytes = files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
    let is_outline = OUTLINE_ENDINGS.contains(&ending(path).as_str());
    let inside = if is_outline { outlined(path, &bytes, grid) } else { lit(path, &bytes, grid) }?;
    let places = grid.places(&inside);
    let within = places.iter().filter(|is| **is).count();
    let name = path.display();
    if within == 0 {
        return Err(ExperimentError::new(format!(
            "no displacement is known in the region of `{name}`"
        ))
        .advise(
            "the region must be where the gel was measured, away from the edges of the pictures",
        ));
    }
    Ok(places)
}

/// The pixels that are not black.
fn lit(path: &Path, bytes: &[u8], grid: &Grid) -> Result<Vec<bool>, ExperimentError> {
    let name = path.display();
    let picture = read_picture(bytes, &Selection::default())
        .map_err(|error| ExperimentError::new(format!("`{name}`: {error}")))?;
    let (plane, [columns, rows]) = (picture.plane, grid.picture);
    if [plane.width(), plane.height()] != grid.picture {
        let what = if grid.step == 1 { "the displacements have" } else { "the film has" };
        let message = format!(
            "`{name}` has {} columns and {} rows, {what} {columns} and {rows}",
            plane.width(),
            plane.height()
        );
        let advice = if grid.step == 1 {
            "scale it to one pixel for each displacement"
        } else {
            "draw it on a frame of the film, or give an outline"
        };
        return Err(ExperimentError::new(message).advise(advice));
    }
    let inside: Vec<bool> = plane.values().iter().map(|value| *value > 0.0).collect();
    if !inside.contains(&true) {
        return Err(ExperimentError::new(format!(
            "`{name}` is black everywhere, so there is no region in it"
        )));
    }
    Ok(inside)
}

/// The pixels within any outline of a file.
fn outlined(path: &Path, bytes: &[u8], grid: &Grid) -> Result<Vec<bool>, ExperimentError> {
    let name = path.display();
    let failed = |error: &dyn std::fmt::Display| ExperimentError::new(format!("`{name}`: {error}"));
    let [width, height] = grid.picture;
    let pixel_size = PixelSize::new(grid.pixel_um).map_err(|error| failed(&error))?;
    let frame = PixelFrame::new(width, height, pixel_size).map_err(|error| failed(&error))?;
    let options = ReadOptions {
        placement: Placement::Picture(frame),
        silent_unit: CoordinateUnit::default(),
    };
    let given = read_outlines(bytes, &name.to_string(), &options);
    let given = given.map_err(|error| failed(&error))?;
    let mut inside = vec![false; width * height];
    for cell in &given.outlines {
        let mask = raster::rasterise(&cell.outline, &frame).map_err(|error| failed(&error))?;
        inside.iter_mut().zip(mask.inside()).for_each(|(into, is)| *into |= is);
    }
    Ok(inside)
}
