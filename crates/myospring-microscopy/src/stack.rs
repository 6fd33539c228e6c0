//! Stacks in depth: many planes of one cell, to the voxels that belong to it.
//!
//! A stack is a TIFF of many pages (OME-TIFF, ImageJ's, plain) or a list of pictures, one for each
//! slice. Slices run along z, the first at the bottom unless stated otherwise. [`Stack::cell`] gives
//! the [`Voxels`] of one cell and a [`StackReport`]; [`Stack::fibres`] reads the direction of the
//! myofibrils in each slice.
//!
//! - **Masks and labels** are used voxel by voxel as they are.
//! - **Fluorescence**, in this order:
//!   1. The stack is smoothed with a Gaussian, 0.5 um wide in all three directions.
//!   2. The cell's outline from above is found in the largest brightness over all slices, as in a
//!      picture ([`segment()`](super::segment::segment)). This also chooses among several cells.
//!   3. Each slice has its own background, the median around the cell. If brightness falls (or
//!      rises) steadily with depth inside the cell, an exponential is divided out.
//!   4. A voxel is inside if it is brighter than half of the largest brightness above and below it,
//!      averaged over some um. Between two slices brightness is interpolated linearly, so the surface
//!      is not bound to slices.
//!   5. Gaps narrower than 3 um are closed; holes are filled in each slice and in space; parts that
//!      are not connected by faces are dropped.
//!   6. The half of a thin bright layer's brightness lies outside of it: if only the membrane is
//!      bright, the surface is moved inward to the brightest layer.
//!
//! What the microscope blurs in z is not undone: half of the brightness is the right place for the
//! surface of a cell that is thicker than the blur, not for a thinner one. The report says how wide
//! the edges are.

mod bright;
mod depth;
mod distance;
mod error;
mod fibres;
mod labels;
mod load;
mod options;
mod report;
mod shape;
mod surface;
#[cfg(test)]
mod tests;
mod volume;

pub use error::{FEWEST_SLICES, MOST_VOXELS, StackError};
pub use fibres::{HelixAngle, SliceFibre, StackFibres};
pub use options::{FirstSlice, StackOptions, StackSelection, Stain};
pub use report::{Blur, StackReport};

use super::film::Film;
use super::film::error::FilmError;
use super::picture::{Depth, Selection, StatedPixelSize};
use super::plane::Plane;
use super::read::avi::Avi;
use super::read::y4m::Y4m;
use super::read::{PictureError, read_picture};
use super::segment::Modality;
use myospring_core::mesh::pixel_size::PixelSize;
use myospring_core::mesh::voxels::Voxels;

/// Largest relative difference between a given length and that of the file that is not noted.
const SAME: f64 = 0.01;

/// A stack in depth; each slice is decoded when it is needed.
#[derive(Debug, Clone)]
pub struct Stack {
    /// The slices, as the frames of a film.
    film: Film,
    /// Side of a pixel, if the file states one.
    pub pixel_size: Option<StatedPixelSize>,
    /// Distance of two slices, um, if the file states one.
    pub z_step_um: Option<f64>,
    /// Warnings, one sentence each.
    pub notes: Vec<String>,
}

/// Side of a pixel and distance of slices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scale {
    /// Side of a pixel.
    pub pixel_size: PixelSize,
    /// Distance of two slices, um.
    pub z_step_um: f64,
}

impl Stack {
    /// Reads a stack from the bytes of one file.
    ///
    /// Pages without stated meaning are slices. So are the time points of a file that has several
    /// but only one slice, with a note: programs often write slices as time points.
    ///
    /// # Errors
    /// Bytes that are not a stack, damage, fewer than [`FEWEST_SLICES`]; several channels, or
    /// several time points of several slices, of which none was chosen; one that does not exist.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::stack::{Stack, StackSelection};
    /// # use tiff::encoder::{TiffEncoder, colortype::Gray8};
    /// # let mut file = std::io::Cursor::new(Vec::new());
    /// # let mut encoder = TiffEncoder::new(&mut file)?;
    /// # for slice in 0..5 {
    /// #     encoder.write_image::<Gray8>(4, 3, &[slice; 12])?;
    /// # }
    /// # let bytes = file.into_inner();
    /// let stack = Stack::read(bytes, &StackSelection::default())?;
    /// assert_eq!((stack.slices(), stack.size()), (5, [4, 3]));
    /// assert_eq!(stack.slice(2)?.at(0, 0), 2.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(bytes: Vec<u8>, selection: &StackSelection) -> Result<Self, StackError> {
        if Avi::is_one(&bytes) || Y4m::is_one(&bytes) {
            let film = Film::read_any(bytes, &Selection::default()).map_err(of_film)?;
            return Self::of(film, None, Vec::new());
        }
        let taken = Selection {
            channel: selection.channel,
            frame: selection.frame.unwrap_or(0),
            depth: Some(Depth::Slice(0)),
        };
        let first = read_picture(&bytes, &taken)?;
        if selection.channel.is_none() && first.choices > 1 {
            return Err(StackError::several("channels", "--channel", first.choices));
        }
        let mut notes = Vec::new();
        let mut taken = taken;
        if selection.frame.is_none() && first.frames > 1 {
            if first.slices > 1 {
                return Err(StackError::several("time points", "--frame", first.frames));
            }
            taken.depth = None;
            notes.push(format!(
                "the file has {} time points and one slice; the time points were taken as slices",
                first.frames
            ));
        }
        let film = Film::of_slices(bytes, taken)?;
        Self::of(film, first.z_step_um, notes)
    }

    /// A stack of pictures, each a file with its name; they are put in natural order (`z2` before
    /// `z10`).
    ///
    /// # Errors
    /// Fewer than [`FEWEST_SLICES`], or a first picture that cannot be read or has several
    /// channels, of which none was chosen.
    pub fn of_pictures(
        files: Vec<(String, Vec<u8>)>,
        selection: &StackSelection,
    ) -> Result<Self, StackError> {
        if files.len() < FEWEST_SLICES {
            return Err(StackError::TooFew { slices: files.len() });
        }
        let frame = selection.frame.unwrap_or(0);
        let taken = Selection { channel: selection.channel, frame, depth: None };
        if let (None, Some((name, bytes))) = (selection.channel, files.first()) {
            let first = read_picture(bytes, &taken).map_err(|cause| StackError::Slice {
                slice: 0,
                name: Some(name.clone()),
                cause,
            })?;
            if first.choices > 1 {
                return Err(StackError::several("channels", "--channel", first.choices));
            }
        }
        let film = Film::of_any_pictures(files, &taken).map_err(of_film)?;
        Self::of(film, None, Vec::new())
    }

    fn of(film: Film, z_step_um: Option<f64>, mut notes: Vec<String>) -> Result<Self, StackError> {
        if film.len() < FEWEST_SLICES {
            return Err(StackError::TooFew { slices: film.len() });
        }
        // The note on how pages were interpreted is settled here.
        let others = film.notes.iter().filter(|note| !note.contains("they were taken as"));
        notes.extend(others.cloned());
        Ok(Self { pixel_size: film.pixel_size, film, z_step_um, notes })
    }

    /// Number of slices.
    pub fn slices(&self) -> usize {
        self.film.len()
    }

    /// Columns and rows of every slice.
    pub fn size(&self) -> [usize; 2] {
        self.film.size()
    }

    /// Decodes a slice, counted from 0 in the order of the file.
    ///
    /// # Errors
    /// A slice that does not exist, is damaged, or differs in size from the first.
    pub fn slice(&self, index: usize) -> Result<Plane, StackError> {
        self.film.frame(index).map_err(of_film)
    }

    /// Side of a pixel and distance of slices: those of the options, else those of the file.
    ///
    /// # Errors
    /// One that neither states, or a distance outside [`PixelSize::SMALLEST_UM`] to
    /// [`PixelSize::LARGEST_UM`].
    pub fn scale(&self, options: &StackOptions) -> Result<Scale, StackError> {
        let stated = self.pixel_size.map(|stated| stated.size);
        let pixel_size = options.pixel_size.or(stated).ok_or(StackError::NoPixelSize)?;
        let z_step_um = options.z_step_um.or(self.z_step_um).ok_or(StackError::NoZStep)?;
        if PixelSize::new(z_step_um).is_err() {
            return Err(StackError::ZStep { um: z_step_um });
        }
        Ok(Scale { pixel_size, z_step_um })
    }

    /// The voxels of one cell, with a report.
    ///
    /// Voxels from a mask have the sides of the file's. Those from fluorescence are as wide as its
    /// pixels, and finer in z than its slices by a whole number.
    ///
    /// # Errors
    /// A pixel size or z step that nobody states, slices that cannot be read, settings out of
    /// range, no cell, not the one that was asked for, or one that the sides of the picture cut
    /// while [`StackOptions::allow_cut`] is false; brightfield.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::pixel_size::PixelSize;
    /// use myospring::microscopy::stack::{Stack, StackOptions, StackSelection};
    /// # use tiff::encoder::{TiffEncoder, colortype::Gray8};
    /// # let mut file = std::io::Cursor::new(Vec::new());
    /// # let mut encoder = TiffEncoder::new(&mut file)?;
    /// # for slice in 0..6 {
    /// #     let inside = |at: usize| (2..5).contains(&slice) && (3..7).contains(&(at % 10)) && (1..9).contains(&(at / 10));
    /// #     let values: Vec<u8> = (0..100).map(|at| if inside(at) { 255 } else { 0 }).collect();
    /// #     encoder.write_image::<Gray8>(10, 10, &values)?;
    /// # }
    /// # let bytes = file.into_inner();
    /// // A mask of 4 x 8 pixels in three of six slices.
    /// let stack = Stack::read(bytes, &StackSelection::default())?;
    /// let options = StackOptions {
    ///     pixel_size: Some(PixelSize::new(0.5)?),
    ///     z_step_um: Some(2.0),
    ///     ..StackOptions::default()
    /// };
    /// let (voxels, report) = stack.cell(&options)?;
    /// assert_eq!(voxels.volume_um3(), 2.0 * 4.0 * 6.0);
    /// assert_eq!(report.thickness_um, 6.0);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn cell(&self, options: &StackOptions) -> Result<(Voxels, StackReport), StackError> {
        let scale = self.scale(options)?;
        options.segmentation.interruption.check()?;
        let of_mask = match options.segmentation.modality {
            Modality::Mask => true,
            Modality::Auto => load::is_mask(self)?,
            Modality::Fluorescence => false,
            Modality::Brightfield => return Err(StackError::Brightfield),
        };
        let (voxels, mut report) = if of_mask {
            labels::cell(self, scale, options)?
        } else {
            bright::cell(self, scale, options)?
        };
        report.notes.splice(0..0, self.scale_notes(options));
        report.finish(&voxels, self.slices(), options);
        Ok((voxels, report))
    }

    /// Notes of the file, and on lengths that differ from the file's.
    fn scale_notes(&self, options: &StackOptions) -> Vec<String> {
        let mut notes = self.notes.clone();
        let own = self.pixel_size.map(|stated| stated.size.um());
        let given = options.pixel_size.map(PixelSize::um);
        let pairs = [("pixel size", own, given), ("z step", self.z_step_um, options.z_step_um)];
        for (what, own, given) in pairs {
            if let (Some(own), Some(given)) = (own, given)
                && (own - given).abs() > SAME * own
            {
                notes.push(format!("the {what} is {given} um as given, but {own} um in the file"));
            }
        }
        notes
    }
}

/// A film's error, in the words of a stack.
fn of_film(error: FilmError) -> StackError {
    match error {
        FilmError::Frame { frame, name, cause } => StackError::Slice { slice: frame, name, cause },
        FilmError::Sizes { frame, name, expected, found } => {
            StackError::Sizes { slice: frame, name, expected, found }
        }
        FilmError::NoSuchFrame { frame, frames } => {
            PictureError::OutOfRange { what: "slice", asked: frame, count: frames }.into()
        }
        other => StackError::Film(other),
    }
}
