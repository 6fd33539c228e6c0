//! Reads the slices of a stack.

use super::error::{FEWEST_SLICES, StackError};
use super::options::{StackOptions, StackSelection};
use crate::film::{Film, FilmError};
use crate::picture::{Depth, Selection, StatedPixelSize};
use crate::plane::Plane;
use crate::read::avi::Avi;
use crate::read::y4m::Y4m;
use crate::read::{PictureError, read_picture};
use myospring_core::mesh::pixel_size::PixelSize;

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

    /// The brightest of each place over all slices.
    ///
    /// # Errors
    /// A slice that cannot be read.
    pub fn brightest(&self) -> Result<Plane, StackError> {
        let mut brightest = self.slice(0)?;
        for index in 1..self.slices() {
            let slice = self.slice(index)?;
            let both = brightest.values().iter().zip(slice.values());
            let values = both.map(|(a, b)| a.max(*b)).collect();
            brightest = Plane::new(slice.width(), slice.height(), values).unwrap_or(slice);
        }
        Ok(brightest)
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
