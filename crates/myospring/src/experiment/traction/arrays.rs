//! Displacements from NumPy arrays.

use super::measured::{Displacements, Grid, upward};
use crate::experiment::{ExperimentError, Files};
use crate::mechanics::gel::Surface;
use crate::mechanics::gel::cytometry::Errors;
use crate::output::npz::{self, Array};
use std::path::{Path, PathBuf};

/// Smallest number of rows and of columns of a window.
const LEAST: usize = 8;

/// The displacements of two files, to the right and downward; `unit` is what a displacement of 1 is, um.
pub(super) fn read(
    paths: &[PathBuf; 2],
    spacing: f64,
    unit: f64,
    files: &Files,
) -> Result<Displacements, ExperimentError> {
    let [u, v] = [array(files, &paths[0])?, array(files, &paths[1])?];
    if u.shape() != v.shape() {
        let [first, second] = paths.each_ref().map(|path| path.display());
        let message = format!(
            "`{first}` has the shape {:?} and `{second}` {:?}; both components of the displacement are needed in the same \
             places",
            u.shape(),
            v.shape()
        );
        return Err(ExperimentError::new(message));
    }
    let shape = u.shape();
    let (rows, columns) = (shape[shape.len() - 2], shape[shape.len() - 1]);
    let (u, v) = (u.as_floats().unwrap_or_default(), v.as_floats().unwrap_or_default());
    let frames = u.chunks_exact(rows * columns).zip(v.chunks_exact(rows * columns));
    let surface = |(u, v): (&[f64], &[f64])| Surface {
        spacing,
        origin: [0.0; 2],
        shape: [columns, rows],
        // Rows from the lowest, and up is positive.
        displacements: [upward(u, columns, unit), upward(v, columns, -unit)],
    };
    let surfaces: Vec<Surface> = frames.map(surface).collect();
    if surfaces.is_empty() {
        return Err(ExperimentError::new(format!("`{}` has no frames", paths[0].display())));
    }
    let moves = |axis: &Vec<f64>| axis.iter().any(|moved| *moved != axis[0]);
    if !surfaces.iter().flat_map(|surface| &surface.displacements).any(moves) {
        let [u, v] = paths.each_ref().map(|path| path.display());
        let message =
            format!("nothing moves: all displacements in `{u}` are the same, and all in `{v}`");
        return Err(ExperimentError::new(message)
            .advise("check that the two arrays are those of the pulled gel"));
    }
    Ok(Displacements {
        frames: (0..surfaces.len()).collect(),
        surfaces,
        frame_rate_per_s: None,
        grid: Grid::of_pixels([columns, rows], spacing),
        errors: Errors::default(),
        followed: None,
    })
}

/// The array of a file: floats of rows and columns, or of frames, rows and columns.
fn array(files: &Files, path: &Path) -> Result<Array, ExperimentError> {
    let bytes = files.bytes(path).map_err(|error| ExperimentError::unread(path, &error))?;
    let name = path.display();
    let advice = "save displacements as floats of rows and columns, or frames, rows and columns: numpy.save(\"u.npy\", \
                  u.astype(float))";
    let array = npz::from_npy(&bytes).filter(|array| array.as_floats().is_some());
    let array = array.ok_or_else(|| {
        ExperimentError::new(format!("`{name}` is no NumPy array of floats")).advise(advice)
    })?;
    let shape = array.shape();
    if !matches!(shape.len(), 2 | 3) || shape[shape.len() - 2..].iter().any(|count| *count < LEAST)
    {
        let message = format!(
            "`{name}` has the shape {shape:?}; displacements need rows and columns, at least {LEAST} each, or frames, \
             rows and columns"
        );
        return Err(ExperimentError::new(message).advise(advice));
    }
    let numbers = array.as_floats().unwrap_or_default();
    if let Some(at) = numbers.iter().position(|number| !number.is_finite()) {
        let (columns, rows) = (shape[shape.len() - 1], shape[shape.len() - 2]);
        let missing = numbers.iter().filter(|number| !number.is_finite()).count();
        let message = format!(
            "`{name}` has {} in row {}, column {} of frame {}, and {missing} such places in all",
            numbers[at],
            at / columns % rows,
            at % columns,
            at / (columns * rows)
        );
        return Err(
            ExperimentError::new(message).advise("fill them, for example from their neighbours")
        );
    }
    Ok(array)
}
