//! Built-in cells, drawn by hand with typical sizes, and pieces of tissue.
//!
//! To add one: put its outline beside the others in `cells/` and add a line to [`CELLS`].

use super::outline::{Outline, OutlineError};
use super::{Mesh, lattice};

/// A built-in cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct BuiltIn {
    /// Its name in run files and on the command line.
    pub name: &'static str,
    /// Its description in one sentence.
    pub about: &'static str,
    /// Its outline, GeoJSON in um.
    pub geojson: &'static str,
    /// Whether it is a piece of tissue, of many cells.
    pub is_tissue: bool,
}

/// All built-in cells.
pub const CELLS: &[BuiltIn] = &[
    BuiltIn {
        name: "adult_ventricular",
        about: "adult left ventricular myocyte, 140 x 21 um, with stepped ends",
        geojson: include_str!("../../cells/adult_ventricular.geojson"),
        is_tissue: false,
    },
    BuiltIn {
        name: "hipsc_derived",
        about: "myocyte derived from human stem cells on a strip of matrix, 58 x 14 um",
        geojson: include_str!("../../cells/hipsc_derived.geojson"),
        is_tissue: false,
    },
    BuiltIn {
        name: "tissue_strip",
        about: "strip of tissue, 8 x 1.5 mm, as between two posts",
        geojson: include_str!("../../cells/tissue_strip.geojson"),
        is_tissue: true,
    },
    BuiltIn {
        name: "tissue_sheet",
        about: "square sheet of tissue, 10 x 10 mm",
        geojson: include_str!("../../cells/tissue_sheet.geojson"),
        is_tissue: true,
    },
];

impl BuiltIn {
    /// Its outline.
    ///
    /// # Errors
    /// Invalid data; a test reads every cell in [`CELLS`].
    pub fn outline(&self) -> Result<Outline, OutlineError> {
        Outline::from_geojson(self.geojson)
    }
}

/// The cell with this name, if there is one.
///
/// # Example
/// ```
/// use myospring::mesh::built_in;
/// assert!(built_in::find("adult_ventricular").is_some());
/// assert!(built_in::find("giraffe").is_none());
/// ```
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    CELLS.iter().find(|cell| cell.name == name)
}

/// An adult ventricular myocyte, about 140 um long and 21 um wide, its long axis along x.
///
/// Size after the human left ventricular cell of Gerdes et al. 1992 (141 um, length over width
/// 7.5); sides nearly parallel, ends stepped where intercalated discs were.
///
/// # Example
/// ```
/// use myospring::mesh::built_in;
/// let [low, high] = built_in::adult_ventricular().bounds();
/// assert!((high[0] - low[0] - 140.0).abs() < 2.0);
/// ```
pub fn adult_ventricular() -> Outline {
    match CELLS[0].outline() {
        Ok(outline) => outline,
        Err(error) => unreachable!("a built-in cell, which a test reads: {error}"),
    }
}

/// The same cell on a lattice of about 2000 masses.
///
/// # Example
/// ```
/// use myospring::mesh::built_in;
/// assert!((1_800..2_200).contains(&built_in::adult_ventricular_mesh().len()));
/// ```
pub fn adult_ventricular_mesh() -> Mesh {
    match lattice::from_outline(&adult_ventricular(), None) {
        Ok((mesh, _)) => mesh,
        Err(error) => unreachable!("a built-in cell, which a test meshes: {error}"),
    }
}
