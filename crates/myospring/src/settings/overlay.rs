//! Pictures of the same frame as the picture of the cell, whose grey values are wanted by place.

use super::places::Part;
use crate::mesh::Mesh;
use crate::microscopy::cells::PictureCells;
use crate::microscopy::hot_pixels;
use crate::microscopy::picture::Selection;
use crate::microscopy::plane::Plane;
use crate::microscopy::read::{PictureError, read_picture};

/// Why a picture has no grey values for places of the cell.
#[derive(Debug, thiserror::Error)]
pub enum OverlayError {
    /// It cannot be read.
    #[error("`{path}`: {cause}")]
    Picture {
        /// The file.
        path: String,
        /// What is wrong.
        cause: PictureError,
    },
    /// There is no picture of the cell.
    #[error(
        "`{path}` is a picture, but the shape of the cell does not come from a picture, so their positions cannot be matched; give a table \
         (.csv), or the picture of the cell as its shape"
    )]
    NoFrame {
        /// The file.
        path: String,
    },
    /// It is of another frame.
    #[error(
        "`{path}` has {found:?} pixels, the picture of the cell {expected:?}; {of} needs a picture of \
         the same frame"
    )]
    Frame {
        /// The file.
        path: String,
        /// Its columns and rows.
        found: [usize; 2],
        /// Those of the picture of the cell.
        expected: [usize; 2],
        /// What is read from it.
        of: &'static str,
    },
    /// It is black where the cell is.
    #[error("`{path}` is black everywhere in the cell, so it contains no information on {of}")]
    Black {
        /// The file.
        path: String,
        /// What is read from it.
        of: &'static str,
    },
}

/// A picture over that of the cell.
pub(super) struct Overlay<'a> {
    /// The file.
    pub(super) path: &'a str,
    /// What is read from it, in words.
    pub(super) of: &'static str,
}

impl Overlay<'_> {
    /// The grey value of each part of a mesh, at least 0: the mean over a lattice square around its place; with a note on
    /// pixels that were corrected. `cell` is the picture of the cell, with its selected plane.
    pub(super) fn grey(
        &self,
        bytes: &[u8],
        part: Part,
        mesh: &Mesh,
        cell: Option<(&PictureCells, &Selection)>,
    ) -> Result<(Vec<f64>, Option<String>), OverlayError> {
        let path = || self.path.to_owned();
        let (cell, selection) = cell.ok_or_else(|| OverlayError::NoFrame { path: path() })?;
        let picture = read_picture(bytes, selection)
            .map_err(|cause| OverlayError::Picture { path: path(), cause })?;
        let (plane, note) = match hot_pixels::cooled(&picture.plane) {
            Some((plane, note)) => (plane, Some(format!("`{}`: {note}", self.path))),
            None => (picture.plane, None),
        };
        let size = |plane: &Plane| [plane.width(), plane.height()];
        let (found, expected) = (size(&plane), size(&cell.plane));
        if found != expected {
            return Err(OverlayError::Frame { path: path(), found, expected, of: self.of });
        }
        let pixel = cell.pixel_size.um();
        let spacing = mesh.lattice.as_ref().map_or(pixel, |lattice| lattice.spacing);
        let reach = 0.5 * spacing / pixel;
        // Columns, or rows from the bottom, of the pixels covered by a square around a place.
        let covered = |at: f64, count: usize| {
            let last = count as f64 - 1.0;
            let [first, end] = [at - reach, at + reach].map(|edge| edge.floor().clamp(0.0, last));
            first as usize..=end as usize
        };
        let grey = part.places(mesh).into_iter().map(|[x, y]| {
            let rows = covered(y / pixel, expected[1]);
            let pixels = rows.flat_map(|row| {
                let row = expected[1] - 1 - row;
                covered(x / pixel, expected[0]).map(move |column| [column, row])
            });
            let values = pixels.map(|[column, row]| f64::from(plane.at(column, row)));
            let (sum, count) =
                values.fold((0.0, 0.0), |(sum, n), grey| (sum + grey.max(0.0), n + 1.0));
            sum / count
        });
        Ok((grey.collect(), note))
    }

    /// The error for a picture that is black where the cell is.
    pub(super) fn black(&self) -> OverlayError {
        OverlayError::Black { path: self.path.to_owned(), of: self.of }
    }
}
