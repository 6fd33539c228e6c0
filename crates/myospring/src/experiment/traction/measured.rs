//! Displacements of a gel as they were measured, and where they lie in the pictures.

use super::followed::Followed;
use crate::experiment::ExperimentError;
use crate::mechanics::gel::Surface;
use crate::mechanics::gel::cytometry::Errors;

/// Displacements of a gel, frame by frame.
#[derive(Debug, Clone)]
pub(super) struct Displacements {
    /// One for each frame, all of one shape.
    pub(super) surfaces: Vec<Surface>,
    /// Numbers of the frames, from 0.
    pub(super) frames: Vec<usize>,
    /// Frames a second.
    pub(super) frame_rate_per_s: Option<f64>,
    pub(super) grid: Grid,
    /// What is known of the errors of displacements.
    pub(super) errors: Errors,
    /// What the picture shows where the displacements come from beads.
    pub(super) followed: Option<Followed>,
}

/// Where the places of displacements are in a picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Columns and rows of the picture.
    pub(super) picture: [usize; 2],
    /// Side of a pixel, um.
    pub(super) pixel_um: f64,
    /// Columns and rows of places.
    pub(super) shape: [usize; 2],
    /// Column and row of the pixel of the upper left place.
    pub(super) first: [usize; 2],
    /// Pixels from one place to the next.
    pub(super) step: usize,
}

impl Grid {
    /// A picture with one pixel for each place.
    pub(super) fn of_pixels(shape: [usize; 2], pixel_um: f64) -> Self {
        Self { picture: shape, pixel_um, shape, first: [0; 2], step: 1 }
    }

    /// Refuses a picture of another size.
    pub(super) fn check_size(&self, found: [usize; 2], name: &str) -> Result<(), ExperimentError> {
        let ([width, height], [columns, rows]) = (found, self.picture);
        if found == self.picture {
            return Ok(());
        }
        let (what, advice) = if self.step == 1 {
            ("the displacements have", "scale it to one pixel for each displacement")
        } else {
            (
                "the pictures of beads have",
                "it must show the same window at the same scale; or give an outline in um",
            )
        };
        let message =
            format!("`{name}` has {width} columns and {height} rows, {what} {columns} and {rows}");
        Err(ExperimentError::new(message).advise(advice))
    }

    /// Which places have one of these pixels in the square of the lattice around them, rows from the lowest. `inside` has the
    /// pixels row by row from the top.
    pub(super) fn places(&self, inside: &[bool]) -> Vec<bool> {
        let ([width, height], [columns, rows]) = (self.picture, self.shape);
        let square = |at: usize, axis: usize, length: usize| {
            let middle = self.first[axis] + at * self.step;
            let low = middle.saturating_sub(self.step / 2);
            low..(low + self.step).max(middle + 1).min(length)
        };
        let place = |(row, column): (usize, usize)| {
            square(row, 1, height)
                .any(|row| square(column, 0, width).any(|column| inside[row * width + column]))
        };
        let upward = (0..rows).rev();
        upward.flat_map(|row| (0..columns).map(move |column| (row, column))).map(place).collect()
    }
}

/// Rows from the top as rows from the lowest, or back, times a factor.
pub(super) fn upward(values: &[f64], columns: usize, factor: f64) -> Vec<f64> {
    values.chunks_exact(columns).rev().flatten().map(|value| factor * value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_is_in_the_region_that_touches_its_square() {
        let grid = Grid { picture: [40, 30], pixel_um: 0.5, shape: [4, 3], first: [5, 5], step: 8 };
        let one = |column: usize, row: usize| {
            let mut inside = vec![false; 40 * 30];
            inside[row * 40 + column] = true;
            let places = grid.places(&inside);
            (0..12).filter(|&place| places[place]).collect::<Vec<_>>()
        };
        // The upper left place is the first of the last row.
        assert_eq!(one(5, 5), [8]);
        assert_eq!((one(8, 5), one(9, 5), one(29, 21)), (vec![8], vec![9], vec![3]));
        assert_eq!(one(39, 29), Vec::<usize>::new());
        let pixels = Grid::of_pixels([3, 2], 1.0);
        let inside = [true, false, false, false, false, true];
        assert_eq!(pixels.places(&inside), [false, false, true, true, false, false]);
    }
}
