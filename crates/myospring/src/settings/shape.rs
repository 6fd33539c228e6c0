//! Turns the shape of a run file into a mesh.

use super::shown::{Shown, StackCell};
use crate::measured::decoded;
use crate::mesh::Mesh;
use crate::mesh::built_in::BuiltIn;
use crate::mesh::lattice::{self, LatticeError};
use crate::mesh::mask::Mask;
use crate::mesh::outline::{Outline, OutlineError};
use crate::mesh::pixel_size::PixelSize;
use crate::mesh::quality::{MeshReport, outline_dimensions};
use crate::mesh::thick::{self, Form, Thick};
use crate::microscopy::cells::{CellError, PictureCell, PictureCells, PictureOptions};
use crate::microscopy::outlines::trace::{Edge, trace_mask};
use crate::microscopy::outlines::{
    CoordinateUnit, OutlineFileError, Placement, ReadOptions, read_outlines,
};
use crate::microscopy::report::{USUAL_AREAS_UM2, impossible_size};
use crate::microscopy::segment::Choice;
use crate::microscopy::stack::{
    FirstSlice, Stack, StackError, StackOptions, StackSelection, Stain,
};
use std::io;
use std::path::Path;
use std::sync::Arc;

/// A picture, and how its cell is found.
#[derive(Debug, Clone, PartialEq)]
pub struct PictureSource {
    /// The file, as written.
    pub path: String,
    /// A file of outlines drawn on the picture, as written; `None` segments it.
    pub outline: Option<String>,
    /// Plane, pixel size and segmentation.
    pub options: PictureOptions,
    /// The chosen cell.
    pub choice: Choice,
    /// Whether a cell may be cut by the frame.
    pub allow_cut: bool,
    /// How its slices lie, if it is a stack in depth, whose cell is thick.
    pub slices: Option<Slices>,
}

/// The slices of a stack in depth.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Slices {
    /// Distance of two slices, um; `None` uses the file's own.
    pub z_step: Option<f64>,
    /// Where the first slice of the file lies.
    pub first: FirstSlice,
    /// What of the cell is bright.
    pub stain: Stain,
}

/// The source of the shape.
#[derive(Debug, Clone, PartialEq)]
pub enum Source {
    /// A built-in cell.
    BuiltIn(&'static BuiltIn),
    /// A picture from a microscope, or its mask.
    Picture(Box<PictureSource>),
    /// A file of outlines.
    Outline {
        /// The file, as written.
        path: String,
        /// Side of one pixel of outlines in pixels.
        pixel_size: Option<PixelSize>,
        /// The chosen one of several outlines.
        choice: Choice,
    },
}

/// Endings of pictures, without the dot.
pub const PICTURE_ENDINGS: &[&str] = &["png", "tif", "tiff"];

/// Endings of stacks in depth, without the dot.
pub const STACK_ENDINGS: &[&str] = &["tif", "tiff"];

/// Endings of files of outlines, without the dot.
pub const OUTLINE_ENDINGS: &[&str] = &["geojson", "json", "csv", "roi", "zip", "txt"];

impl Source {
    /// The picture, if it is one.
    pub fn picture(&self) -> Option<&PictureSource> {
        match self {
            Self::Picture(picture) => Some(picture),
            _ => None,
        }
    }

    /// The picture, if it is one.
    pub fn picture_mut(&mut self) -> Option<&mut PictureSource> {
        match self {
            Self::Picture(picture) => Some(picture),
            _ => None,
        }
    }

    /// The chosen cell of a picture or of a file of outlines.
    pub fn choice(&self) -> Option<Choice> {
        match self {
            Self::BuiltIn(_) => None,
            Self::Picture(picture) => Some(picture.choice),
            Self::Outline { choice, .. } => Some(*choice),
        }
    }

    /// The chosen cell of a picture or of a file of outlines.
    pub fn choice_mut(&mut self) -> Option<&mut Choice> {
        match self {
            Self::BuiltIn(_) => None,
            Self::Picture(picture) => Some(&mut picture.choice),
            Self::Outline { choice, .. } => Some(choice),
        }
    }
}

/// The bytes of the files of a shape.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ShapeBytes {
    /// The picture, the outline, or the built-in cell's outline.
    pub shape: Vec<u8>,
    /// The outline drawn on the picture.
    pub outline: Option<Vec<u8>>,
}

/// A meshed shape.
#[derive(Debug, Clone)]
pub struct Shaped {
    /// The mesh; of a thick cell, as it is seen from above.
    pub mesh: Mesh,
    /// The thickness of a thick cell.
    pub thick: Option<Arc<Thick>>,
    /// Report on the mesh, with earlier warnings.
    pub report: MeshReport,
    /// The meshed outline, um; rotated if requested.
    pub outline: Outline,
    /// The picture with its cells, and the chosen one.
    pub picture: Option<(PictureCells, PictureCell)>,
    /// The stack of slices with the cell in it.
    pub stack: Option<Arc<StackCell>>,
}

impl Shaped {
    /// What shows the fibres of the cell, if anything does.
    pub fn shown(&self) -> Option<Shown<'_>> {
        let picture = self.picture.as_ref().map(|(cells, cell)| Shown::Picture(cells, cell));
        picture.or(self.stack.as_deref().map(Shown::Stack))
    }
}

/// The mesh of a cell, with its report.
#[derive(Debug, Clone, PartialEq)]
pub struct Meshed {
    /// The mesh; of a thick cell, as it is seen from above.
    pub mesh: Mesh,
    /// The thickness of a thick cell.
    pub thick: Option<Arc<Thick>>,
    /// Report on the mesh.
    pub report: MeshReport,
}

impl From<(Mesh, MeshReport)> for Meshed {
    fn from((mesh, report): (Mesh, MeshReport)) -> Self {
        Self { mesh, thick: None, report }
    }
}

impl From<(Mesh, Thick, MeshReport)> for Meshed {
    fn from((mesh, thick, report): (Mesh, Thick, MeshReport)) -> Self {
        Self { mesh, thick: Some(Arc::new(thick)), report }
    }
}

/// The cell's shape.
#[derive(Debug, Clone, PartialEq)]
pub struct Shape {
    /// Its source.
    pub source: Source,
    /// Angle by which an outline or built-in cell is rotated, degrees.
    pub rotate: f64,
    /// Lattice spacing, um; `None` gives about 2000 masses.
    pub spacing: Option<f64>,
    /// Whether a size is accepted that is impossible for a heart cell.
    pub any_size: bool,
    /// How its thickness varies; `None` is a flat cell.
    pub form: Option<Form>,
}

/// Why a shape cannot be meshed.
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
    /// The stack gives no cell.
    #[error("`{path}`: {cause}")]
    Stack {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: Box<StackError>,
    },
    /// The picture gives no cell.
    #[error("`{path}`: {cause}")]
    Picture {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: Box<CellError>,
    },
    /// The file has no usable outlines.
    #[error("`{path}`: {cause}")]
    OutlineFile {
        /// The file.
        path: String,
        /// What is wrong with it.
        cause: OutlineFileError,
    },
    /// Outlines in pixels of unknown size.
    #[error(
        "`{path}` has outlines in pixels; give the side of one pixel, like --pixel-size \"0.27 um\""
    )]
    NoPixelSize {
        /// The file.
        path: String,
    },
    /// There is no such outline.
    #[error("`{path}` has no outline {wanted}; it has {held}")]
    NoSuchOutline {
        /// The file.
        path: String,
        /// The requested one.
        wanted: String,
        /// The existing ones.
        held: String,
    },
    /// The file is not text.
    #[error("`{path}` is not text; an outline is GeoJSON or a list of points")]
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
    /// The size of the cell is impossible for a heart cell.
    #[error(
        "`{path}`: the cell {size}. {scale}. Correct {wrong}; if the size is right, --any-size (any_size = true in \
         [shape]) takes it"
    )]
    Size {
        /// The file.
        path: String,
        /// What is wrong, as the predicate of a sentence.
        size: String,
        /// The scale that determines the size, with its source.
        scale: String,
        /// What may be wrong.
        wrong: &'static str,
    },
    /// The shape cannot be meshed.
    #[error("{place}{cause}")]
    Lattice {
        /// The file, as the start of a sentence.
        place: String,
        /// What is wrong.
        cause: LatticeError,
    },
}

impl Shape {
    /// The file of the shape, as written; `None` for a built-in cell.
    pub fn file(&self) -> Option<&str> {
        match &self.source {
            Source::BuiltIn(_) => None,
            Source::Picture(picture) => Some(&picture.path),
            Source::Outline { path, .. } => Some(path),
        }
    }

    /// A name for titles and folders: that of the built-in cell, or of the file without its ending.
    pub fn name(&self) -> &str {
        match (&self.source, self.file()) {
            (Source::BuiltIn(cell), _) => cell.name,
            (_, path) => {
                let stem = Path::new(path.unwrap_or_default()).file_stem();
                stem.and_then(|stem| stem.to_str()).unwrap_or("cell")
            }
        }
    }

    /// Reads the files of the shape; `read` reads a file by its name as written.
    ///
    /// # Errors
    /// Errors of `read`.
    pub fn bytes(
        &self,
        read: impl Fn(&str) -> io::Result<Vec<u8>>,
    ) -> Result<ShapeBytes, ShapeError> {
        let read = |path: &str| {
            read(path).map_err(|cause| ShapeError::Read { path: path.to_owned(), cause })
        };
        let (shape, outline) = match &self.source {
            Source::BuiltIn(cell) => (cell.geojson.as_bytes().to_vec(), None),
            Source::Outline { path, .. } => (read(path)?, None),
            Source::Picture(picture) => {
                (read(&picture.path)?, picture.outline.as_deref().map(read).transpose()?)
            }
        };
        Ok(ShapeBytes { shape, outline })
    }

    /// Meshes the shape in `bytes`.
    ///
    /// # Errors
    /// Bytes without a cell, or a spacing that does not fit the shape.
    pub fn mesh(&self, bytes: &ShapeBytes) -> Result<Shaped, ShapeError> {
        let Source::Picture(picture) = &self.source else {
            let (outline, notes) = self.outline(&bytes.shape)?;
            self.check_outline(&outline)?;
            let meshed = self.of_outline(&outline).map_err(|cause| self.unmeshed(cause))?;
            let Meshed { mesh, thick, mut report } = meshed;
            report.warnings.extend(notes);
            return Ok(Shaped { mesh, thick, report, outline, picture: None, stack: None });
        };
        if let Some(slices) = picture.slices {
            return self.mesh_stack(picture, slices, bytes);
        }
        let cells = picture.cells(bytes)?;
        let cell =
            cells.cell(picture.choice, picture.allow_cut).map_err(|cause| picture.failed(cause))?;
        self.mesh_cell(cells, cell)
    }

    /// Whether the cell has a thickness of its own.
    pub fn is_thick(&self) -> bool {
        self.form.is_some() || self.slices().is_some()
    }

    /// The slices of a stack in depth, if it is one.
    pub fn slices(&self) -> Option<Slices> {
        self.source.picture().and_then(|picture| picture.slices)
    }

    /// Meshes the cell in a stack of slices.
    fn mesh_stack(
        &self,
        picture: &PictureSource,
        slices: Slices,
        bytes: &ShapeBytes,
    ) -> Result<Shaped, ShapeError> {
        let failed =
            |cause| ShapeError::Stack { path: picture.path.clone(), cause: Box::new(cause) };
        let PictureOptions { selection, pixel_size, segmentation, .. } = &picture.options;
        // The first frame is the usual one; a file with more needs a choice.
        let frame = Some(selection.frame).filter(|frame| *frame > 0);
        let selection = StackSelection { channel: selection.channel, frame };
        let stack = Stack::read(bytes.shape.clone(), &selection).map_err(failed)?;
        let options = StackOptions {
            pixel_size: *pixel_size,
            z_step_um: slices.z_step,
            segmentation: segmentation.clone(),
            choice: picture.choice,
            allow_cut: picture.allow_cut,
            stain: slices.stain,
            first_slice: slices.first,
        };
        let (voxels, found) = stack.cell(&options).map_err(failed)?;
        let meshed = thick::from_voxels(&voxels, self.spacing);
        let (mesh, thick, mut report) = meshed.map_err(|cause| self.unmeshed(cause))?;
        report.warnings.extend(found.notes.iter().cloned());
        report.warnings.extend(found.warnings.iter().cloned());
        report.touches_frame = found.touched.sides;
        let outline = voxels.above().ok().and_then(|mask| trace_mask(&mask, Edge::Smooth).ok());
        let outline = outline.ok_or_else(|| {
            self.unmeshed(LatticeError::Above("its pixels have no ring around them".to_owned()))
        })?;
        let pointed_at = picture.choice != Choice::Largest;
        let areas_um2 = if pointed_at { [0.0, f64::INFINITY] } else { picture.options.areas_um2 };
        let length = outline_dimensions(&outline).length_um;
        self.possible(impossible_size(length, outline.area(), areas_um2), || {
            (
                format!("Its pixels are {:.4} um wide", found.pixel_um),
                "the pixel size (--pixel-size)",
            )
        })?;
        let seen = stack.brightest().ok().zip(PixelSize::new(found.pixel_um).ok());
        let seen = seen.and_then(|(plane, size)| {
            PictureCells::with_outline(plane, size, outline.clone()).ok()
        });
        let stack = Some(Arc::new(StackCell { stack, voxels, options, report: found, seen }));
        Ok(Shaped { mesh, thick: Some(Arc::new(thick)), report, outline, picture: None, stack })
    }

    /// Meshes one cell of a picture, with a warning if others were not taken.
    ///
    /// # Errors
    /// A size impossible for a heart cell, or a spacing that does not fit the cell.
    pub fn mesh_cell(&self, cells: PictureCells, cell: PictureCell) -> Result<Shaped, ShapeError> {
        let others = (cells.len() > 1).then(|| {
            format!(
                "the picture has {} cells; cell {} was taken, {:.0} um^2 (--cell N or --seed X,Y takes another)",
                cells.len(),
                cell.number,
                cell.outline.area()
            )
        });
        let mut shaped = self.mesh_each(cells, cell)?;
        shaped.report.warnings.extend(others);
        Ok(shaped)
    }

    /// Meshes one cell of a picture whose cells are all taken.
    ///
    /// # Errors
    /// As of [`Shape::mesh_cell`].
    pub fn mesh_each(&self, cells: PictureCells, cell: PictureCell) -> Result<Shaped, ShapeError> {
        self.check_size(&cells, &cell)?;
        let Meshed { mesh, thick, mut report } = self.lattice(&cells, &cell)?;
        report.warnings.extend(cells.notes.iter().cloned());
        report.warnings.extend(cell.warnings());
        let outline = cell.outline.clone();
        Ok(Shaped { mesh, thick, report, outline, picture: Some((cells, cell)), stack: None })
    }

    /// Rejects a cell of a picture whose size is impossible for a heart cell, unless any size is
    /// allowed; for a cell that the user pointed at, only its length is checked.
    ///
    /// # Errors
    /// Such a size.
    pub fn check_size(&self, cells: &PictureCells, cell: &PictureCell) -> Result<(), ShapeError> {
        let (size, source) = (cells.pixel_size, cells.pixel_size_source);
        let from = if source == "given" { source.to_owned() } else { format!("from its {source}") };
        let pointed_at = self.source.choice().is_some_and(|choice| choice != Choice::Largest);
        self.possible(cells.impossible_size(cell, pointed_at), || {
            (format!("Its pixels are {size} wide ({from})"), "the pixel size (--pixel-size)")
        })
    }

    /// Rejects an outline of a file whose size is impossible for a heart cell.
    fn check_outline(&self, outline: &Outline) -> Result<(), ShapeError> {
        let Source::Outline { pixel_size, choice, .. } = &self.source else { return Ok(()) };
        let length = outline_dimensions(outline).length_um;
        let pointed_at = *choice != Choice::Largest;
        let areas_um2 = if pointed_at { [0.0, f64::INFINITY] } else { USUAL_AREAS_UM2 };
        self.possible(impossible_size(length, outline.area(), areas_um2), || match pixel_size {
            Some(size) => {
                let scale = format!("A pixel of its outline was taken as {size} (given)");
                (scale, "the pixel size (--pixel-size)")
            }
            None => ("Its coordinates were read as um".to_owned(), "their unit"),
        })
    }

    fn possible(
        &self,
        wrong: Option<String>,
        scale: impl FnOnce() -> (String, &'static str),
    ) -> Result<(), ShapeError> {
        let Some(size) = wrong.filter(|_| !self.any_size) else { return Ok(()) };
        let path = self.file().unwrap_or_default().to_owned();
        let (scale, wrong) = scale();
        Err(ShapeError::Size { path, size, scale, wrong })
    }

    /// The lattice of one cell of a picture, without warnings on the picture.
    ///
    /// # Errors
    /// A spacing that does not fit the cell.
    pub fn lattice(&self, cells: &PictureCells, cell: &PictureCell) -> Result<Meshed, ShapeError> {
        // The pixels of a segmented cell, or a drawn outline.
        let meshed = match cells.segmentation() {
            Some(_) => self.of_mask(&cell.mask),
            None => self.of_outline(&cell.outline),
        };
        meshed.map_err(|cause| self.unmeshed(cause))
    }

    fn of_mask(&self, mask: &Mask) -> Result<Meshed, LatticeError> {
        Ok(match self.form {
            None => lattice::from_mask(mask, self.spacing)?.into(),
            Some(form) => thick::from_mask(mask, form, self.spacing)?.into(),
        })
    }

    fn of_outline(&self, outline: &Outline) -> Result<Meshed, LatticeError> {
        Ok(match self.form {
            None => lattice::from_outline(outline, self.spacing)?.into(),
            Some(form) => thick::from_outline(outline, form, self.spacing)?.into(),
        })
    }

    fn unmeshed(&self, cause: LatticeError) -> ShapeError {
        let place = self.file().map(|path| format!("`{path}`: ")).unwrap_or_default();
        ShapeError::Lattice { place, cause }
    }

    /// The rotated outline of a file or built-in cell, with warnings.
    fn outline(&self, bytes: &[u8]) -> Result<(Outline, Vec<String>), ShapeError> {
        let path = self.file().unwrap_or("built-in cell").to_owned();
        let ending = path.rsplit('.').next().unwrap_or_default().to_lowercase();
        let (pixel_size, choice) = match &self.source {
            Source::Outline { pixel_size, choice, .. } => (*pixel_size, *choice),
            _ => (None, Choice::Largest),
        };
        let drawn = matches!(ending.as_str(), "roi" | "zip" | "txt");
        let several = pixel_size.is_some() || choice != Choice::Largest;
        let (outline, notes) = if drawn || (several && ending != "csv") {
            // Coordinates with their own unit need no pixel size.
            let own_unit = (!drawn).then_some(PixelSize::MICROMETRE);
            let Some(pixel_size) = pixel_size.or(own_unit) else {
                return Err(ShapeError::NoPixelSize { path });
            };
            chosen(&path, bytes, pixel_size, choice)?
        } else {
            let Ok(text) = decoded(bytes) else {
                return Err(ShapeError::NotText { path });
            };
            let outline = if ending == "csv" {
                Outline::from_csv(&text)
            } else {
                Outline::from_geojson(&text)
            };
            (outline.map_err(|cause| ShapeError::Outline { path, cause })?, Vec::new())
        };
        Ok((if self.rotate == 0.0 { outline } else { outline.rotated(self.rotate) }, notes))
    }
}

impl PictureSource {
    /// Reads the picture and finds its cells, or uses the given outlines.
    ///
    /// # Errors
    /// A picture or outlines that cannot be read, no pixel size, or no cell.
    pub fn cells(&self, bytes: &ShapeBytes) -> Result<PictureCells, ShapeError> {
        let cells = match (&bytes.outline, &self.outline) {
            (Some(outline), Some(name)) => {
                PictureCells::with_outlines(&bytes.shape, outline, name, &self.options)
            }
            _ => PictureCells::find(&bytes.shape, &self.options),
        };
        cells.map_err(|cause| self.failed(cause))
    }

    /// Reads the picture without segmenting it, so that it can be shown when no cell was found.
    ///
    /// # Errors
    /// A picture that cannot be read, or no pixel size.
    pub fn unsegmented(&self, bytes: &ShapeBytes) -> Result<PictureCells, ShapeError> {
        PictureCells::unsegmented(&bytes.shape, &self.options).map_err(|cause| self.failed(cause))
    }

    /// An error with the name of the file that caused it.
    pub fn failed(&self, cause: CellError) -> ShapeError {
        let path = match (&cause, &self.outline) {
            (CellError::Outlines(_), Some(outline)) => outline,
            _ => &self.path,
        };
        ShapeError::Picture { path: path.clone(), cause: Box::new(cause) }
    }
}

/// The chosen outline of a file, with a note.
fn chosen(
    path: &str,
    bytes: &[u8],
    pixel_size: PixelSize,
    choice: Choice,
) -> Result<(Outline, Vec<String>), ShapeError> {
    let placement = Placement::Bounds { pixel_size };
    let options = ReadOptions { placement, silent_unit: CoordinateUnit::default() };
    let mut given = read_outlines(bytes, path, &options)
        .map_err(|cause| ShapeError::OutlineFile { path: path.to_owned(), cause })?;
    let count = given.outlines.len();
    given.sort_by_area();
    let (at, wanted) = match choice {
        Choice::Number(number) => (given.numbered(number), number.to_string()),
        Choice::Label(label) => (given.labelled(label), format!("named {label}")),
        Choice::Largest | Choice::At(_) => (given.numbered(1), "at all".to_owned()),
    };
    let Some(cell) = at.map(|at| given.outlines.swap_remove(at)) else {
        let held = format!("{count}: {}", given.names());
        return Err(ShapeError::NoSuchOutline { path: path.to_owned(), wanted, held });
    };
    let mut notes = given.notes;
    if count > 1 {
        notes.push(format!("the file has {count} outlines; `{}` was taken", cell.name));
    }
    Ok((cell.outline, notes))
}
