//! Where a tissue conducts, and where it does not, from a table or a picture.
//!
//! - A table (`.csv`) with the header `conductivity` has one row for each triangle, in the order of the mesh; one with the header
//!   `x_um,y_um,conductivity` has points; each triangle takes the value of the nearest. 0 is a scar, 1 conducts as the tissue does.
//! - A picture (`.png`, `.tif`) must have the same frame as the picture of the tissue; its plane is chosen in the same way. The
//!   conductivity is its grey values, averaged over a lattice square around each triangle, relative to the largest in the tissue.

use super::overlay::{Overlay, OverlayError};
use super::places::{self, Column, Part, PlacesError};
use super::words::Word;
use crate::mesh::Mesh;
use crate::microscopy::cells::PictureCells;
use crate::microscopy::picture::Selection;
use std::io;

/// Endings of files that say where a tissue conducts, without the dot.
pub const CONDUCTIVITY_ENDINGS: &[&str] = &["csv", "png", "tif", "tiff"];

/// The word that names no file.
pub(super) const EVEN: &str = "uniform";
pub(super) const WORDS: &[Word] = &[Word { name: EVEN, doc: "The same in every place." }];

/// Why a file does not say where a tissue conducts.
#[derive(Debug, thiserror::Error)]
pub enum ConductivityError {
    /// The table is not valid.
    #[error(transparent)]
    Table(#[from] PlacesError),
    /// The picture is not valid.
    #[error(transparent)]
    Picture(#[from] OverlayError),
}

const COLUMN: Column = Column {
    name: "conductivity",
    of: "the conductivity",
    within: 0.0..=100.0,
    must: "from 0, which does not conduct, to 100, where 1 conducts as the tissue does",
    part: Part::Triangle,
};

/// Reads the relative conductivity of each triangle of a mesh from a file, with a warning; `read` reads a file by its name as written,
/// `picture` is that of the tissue, with its selected plane.
pub(super) fn read_conductivity(
    path: &str,
    mesh: &Mesh,
    picture: Option<(&PictureCells, &Selection)>,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<(Vec<f64>, Option<String>), ConductivityError> {
    if path.to_lowercase().ends_with(".csv") {
        return Ok((places::read_table(path, &COLUMN, mesh, read)?, None));
    }
    let bytes = places::read_bytes(path, read)?;
    let overlay = Overlay { path, of: COLUMN.of };
    let (mut grey, note) = overlay.grey(&bytes, COLUMN.part, mesh, picture)?;
    let most = grey.iter().copied().fold(0.0, f64::max);
    if most == 0.0 {
        return Err(overlay.black().into());
    }
    for grey in &mut grey {
        *grey /= most;
    }
    Ok((grey, note))
}
