//! From the shape that a run file names to a mesh.

use crate::mesh::Mesh;
use crate::mesh::built_in::BuiltIn;
use crate::mesh::lattice::{self, LatticeError};
use crate::mesh::outline::{Outline, OutlineError};
use crate::mesh::quality::MeshReport;
use std::io;
use std::path::Path;

/// Where the shape comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A cell that comes with the program.
    BuiltIn(&'static BuiltIn),
    /// A mask.
    Picture {
        /// The file, as written.
        path: String,
        /// Side of one pixel, um.
        pixel_size: f64,
        /// Grey value of the cell; `None` takes every non-zero pixel.
        label: Option<u32>,
    },
    /// An outline, GeoJSON or CSV by its ending.
    Outline(String),
}

/// The cell's shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Where it comes from.
    pub source: Source,
    /// Angle by which an outline or built-in cell is turned, degrees.
    pub rotate: f64,
    /// Lattice spacing, um; `None` gives about 2000 masses.
    pub spacing: Option<f64>,
}

/// Why a shape did not become a mesh.
#[derive(Debug, thiserror::Error)]
pub enum ShapeError {
    /// The file could not be read.
    #[error("cannot read `{path}`: {cause}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        cause: io::Error,
    },
    /// The file is not a mask.
    #[cfg(feature = "microscopy")]
    #[error("`{path}`: {cause}")]
    Picture {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: crate::microscopy::read::PictureError,
    },
    /// Built without pictures.
    #[cfg(not(feature = "microscopy"))]
    #[error(
        "`{path}`: this program was built without the feature `microscopy`, which reads pictures"
    )]
    NoPictures {
        /// The file.
        path: String,
    },
    /// The file is not text.
    #[error("`{path}` is not UTF-8 text; an outline is GeoJSON or a list of points")]
    NotText {
        /// The file.
        path: String,
    },
    /// The file is not an outline.
    #[error("`{path}`: {cause}")]
    Outline {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: OutlineError,
    },
    /// The shape gives no mesh.
    #[error("{place}{cause}")]
    Lattice {
        /// The file, as the start of a sentence.
        place: String,
        /// What is wrong.
        cause: LatticeError,
    },
}

impl Shape {
    /// The file that holds the shape, as written; `None` for a built-in cell.
    pub fn file(&self) -> Option<&str> {
        match &self.source {
            Source::BuiltIn(_) => None,
            Source::Picture { path, .. } | Source::Outline(path) => Some(path),
        }
    }

    /// A name for people and folders: the built-in cell's or the file's without its ending.
    pub fn name(&self) -> &str {
        match &self.source {
            Source::BuiltIn(cell) => cell.name,
            Source::Picture { path, .. } | Source::Outline(path) => {
                Path::new(path).file_stem().and_then(|stem| stem.to_str()).unwrap_or("cell")
            }
        }
    }

    /// Takes a relative file name as relative to the folder `base`.
    pub fn resolve_path(&mut self, base: &Path) {
        if let Source::Picture { path, .. } | Source::Outline(path) = &mut self.source {
            *path = base.join(&*path).to_string_lossy().into_owned();
        }
    }

    /// The bytes that hold the shape; `read` reads a file by its name as written.
    ///
    /// # Errors
    /// What `read` says.
    pub fn bytes(
        &self,
        read: impl FnOnce(&str) -> io::Result<Vec<u8>>,
    ) -> Result<Vec<u8>, ShapeError> {
        match &self.source {
            Source::BuiltIn(cell) => Ok(cell.geojson.as_bytes().to_vec()),
            Source::Picture { path, .. } | Source::Outline(path) => {
                read(path).map_err(|cause| ShapeError::Read { path: path.clone(), cause })
            }
        }
    }

    /// The outline, turned; `None` for a picture.
    ///
    /// # Errors
    /// Bytes that are no outline.
    pub fn outline(&self, bytes: &[u8]) -> Result<Option<Outline>, ShapeError> {
        let path = self.file().unwrap_or("built-in cell").to_owned();
        if matches!(self.source, Source::Picture { .. }) {
            return Ok(None);
        }
        let Ok(text) = std::str::from_utf8(bytes) else {
            return Err(ShapeError::NotText { path });
        };
        let is_csv = path.to_lowercase().ends_with(".csv");
        let outline = if is_csv { Outline::from_csv(text) } else { Outline::from_geojson(text) };
        let outline = outline.map_err(|cause| ShapeError::Outline { path, cause })?;
        Ok(Some(if self.rotate == 0.0 { outline } else { outline.rotated(self.rotate) }))
    }

    /// Meshes the shape that `bytes` hold.
    ///
    /// # Errors
    /// Bytes that are no mask or outline, or a spacing that does not fit the shape.
    pub fn mesh(&self, bytes: &[u8]) -> Result<(Mesh, MeshReport), ShapeError> {
        let place = self.file().map(|path| format!("`{path}`: ")).unwrap_or_default();
        let failed = |cause| ShapeError::Lattice { place, cause };
        if let Some(outline) = self.outline(bytes)? {
            return lattice::from_outline(&outline, self.spacing).map_err(failed);
        }
        let Source::Picture { path, pixel_size, label } = &self.source else {
            unreachable!("every other source has an outline")
        };
        #[cfg(feature = "microscopy")]
        {
            use crate::microscopy::read::{MaskOptions, read_mask};
            let options = MaskOptions { label: *label, pixel_size_um: *pixel_size };
            let picture = read_mask(bytes, &options)
                .map_err(|cause| ShapeError::Picture { path: path.clone(), cause })?;
            let (mesh, mut report) =
                lattice::from_mask(&picture.mask, self.spacing).map_err(failed)?;
            if label.is_none() && picture.values.len() > 1 {
                report.warnings.push(format!(
                    "the picture holds {} different non-zero values; all count as one cell unless a \
                     label is given",
                    picture.values.len()
                ));
            }
            Ok((mesh, report))
        }
        #[cfg(not(feature = "microscopy"))]
        {
            let _ = (pixel_size, label, failed);
            Err(ShapeError::NoPictures { path: path.clone() })
        }
    }
}
