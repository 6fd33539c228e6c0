//! Where the cell adheres to its gel, from a table or a picture.
//!
//! - A table (`.csv`) with the header `adhesion` has one row for each node, in the order of the mesh; one with the header
//!   `x_um,y_um,adhesion` has points; each node takes the value of the nearest. 0 does not adhere, 1 adheres with the
//!   stiffness of the adhesion.
//! - A picture (`.png`, `.tif`), such as one of stained focal adhesions, must have the same frame as the picture of the cell;
//!   its plane is chosen in the same way. The adhesion is its grey values, averaged over a lattice square around each node,
//!   relative to the largest in the cell. That the stain measures stiffness is an assumption.

use super::overlay::{Overlay, OverlayError};
use super::places::{self, Column, Part, PlacesError};
use crate::mesh::Mesh;
use crate::microscopy::cells::PictureCells;
use crate::microscopy::picture::Selection;
use std::io;

/// Endings of files that say where the cell adheres, without the dot.
pub const ADHESION_ENDINGS: &[&str] = &["csv", "png", "tif", "tiff"];

/// Why a file does not say where the cell adheres.
#[derive(Debug, thiserror::Error)]
pub enum AdhesionError {
    /// The table is not valid.
    #[error(transparent)]
    Table(#[from] PlacesError),
    /// The picture is not valid.
    #[error(transparent)]
    Picture(#[from] OverlayError),
    /// Too few places adhere.
    #[error(
        "by `{path}` the cell adheres in {nodes} of its {all} nodes; give an adhesion above 0 in 2 or more, which hold it"
    )]
    Loose {
        /// The file.
        path: String,
        /// Nodes that adhere.
        nodes: usize,
        /// All nodes.
        all: usize,
    },
}

/// The column of adhesions in a table.
const COLUMN: Column = Column {
    name: "adhesion",
    of: "the adhesion",
    within: 0.0..=100.0,
    must: "from 0, which does not adhere, to 100, where 1 is as stiff as adhesion_stiffness",
    part: Part::Node,
};

/// Reads how strongly each node of a mesh adheres from a file, with warnings; `read` reads a file by its name as written,
/// `picture` is that of the cell, with its selected plane, and `gives_way` is whether the adhesion has a stiffness.
pub(super) fn read_adhesion(
    path: &str,
    mesh: &Mesh,
    picture: Option<(&PictureCells, &Selection)>,
    gives_way: bool,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<(Vec<f64>, Vec<String>), AdhesionError> {
    let (adhesion, warnings) = if path.to_lowercase().ends_with(".csv") {
        (places::read_table(path, &COLUMN, mesh, read)?, Vec::new())
    } else {
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
        let is_grey = grey.iter().all(|grey| *grey > 0.0) && grey.iter().any(|grey| *grey < 1.0);
        let warning = (is_grey && !gives_way).then(|| {
            format!(
                "`{path}` is nowhere black in the cell, so the cell adheres everywhere; subtract the background, or state \
                 adhesion_stiffness, to which its grey values are then relative"
            )
        });
        (grey, note.into_iter().chain(warning).collect())
    };
    let (nodes, all) = (adhesion.iter().filter(|it| **it > 0.0).count(), adhesion.len());
    if nodes < 2 {
        return Err(AdhesionError::Loose { path: path.to_owned(), nodes, all });
    }
    Ok((adhesion, warnings))
}
