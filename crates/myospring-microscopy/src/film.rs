//! Films: sequences of frames, each decoded when it is needed.
//!
//! A film is a TIFF of many pages (OME-TIFF, ImageJ's, plain), an AVI that is uncompressed or has
//! JPEG or PNG frames, a list of pictures, or `YUV4MPEG2`, the uncompressed stream into which
//! ffmpeg converts any other format.

pub(crate) mod error;
mod order;
mod repeats;
mod still;

pub use error::{FEWEST_FRAMES, FilmError};
pub use order::in_natural_order;

use super::picture::{Depth, Picture, Samples, Selection, StatedPixelSize};
use super::plane::Plane;
use super::read::avi::Avi;
use super::read::y4m::Y4m;
use super::read::{PictureError, read_picture};

/// A film.
#[derive(Debug, Clone)]
pub struct Film {
    frames: Frames,
    len: usize,
    size: [usize; 2],
    /// Side of a pixel, where the file states one.
    pub pixel_size: Option<StatedPixelSize>,
    /// Frames a second, if the file states them.
    pub frames_per_second: Option<f64>,
    /// Type of the pixel values.
    pub samples: Samples,
    /// Warnings, one sentence each.
    pub notes: Vec<String>,
}

/// Where frames come from.
#[derive(Debug, Clone)]
enum Frames {
    /// The pages of one TIFF; `slices` if its slices are the frames.
    Tiff {
        bytes: Vec<u8>,
        selection: Selection,
        slices: bool,
    },
    Avi(Avi),
    Y4m(Y4m),
    /// One file per frame, with its name.
    Pictures {
        files: Vec<(String, Vec<u8>)>,
        selection: Selection,
    },
    /// A picture, then the frames of a film.
    Led {
        first: Plane,
        film: Box<Film>,
    },
}

impl Film {
    /// Reads a film from the bytes of one file. `selection` chooses channel and depth of a TIFF;
    /// its frame is ignored. Slices count as frames in a file that has no others.
    ///
    /// # Errors
    /// Bytes that are not a film, damage, unsupported compression, fewer than [`FEWEST_FRAMES`].
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::film::Film;
    /// use myospring::microscopy::picture::Selection;
    /// let mut bytes = b"YUV4MPEG2 W2 H1 F50:1 Cmono\n".to_vec();
    /// for frame in 0..3 {
    ///     bytes.extend(b"FRAME\n");
    ///     bytes.extend([frame, 7]);
    /// }
    /// let film = Film::read(bytes, &Selection::default())?;
    /// assert_eq!((film.len(), film.frames_per_second), (3, Some(50.0)));
    /// assert_eq!(film.frame(2)?.values(), [2.0, 7.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn read(bytes: Vec<u8>, selection: &Selection) -> Result<Self, FilmError> {
        Self::read_any(bytes, selection)?.whole()
    }

    /// As [`Film::read`], of any number of frames: a single picture is a film of one.
    ///
    /// # Errors
    /// Bytes that are not a film or picture, damage, unsupported compression.
    pub fn read_any(bytes: Vec<u8>, selection: &Selection) -> Result<Self, FilmError> {
        if Avi::is_one(&bytes) {
            let (avi, notes) = Avi::read(bytes)?;
            let (len, size, rate) = (avi.len(), avi.size(), avi.frames_per_second());
            let film = Self::of(Frames::Avi(avi), len, size, rate);
            return Ok(Self { notes, ..film });
        }
        if Y4m::is_one(&bytes) {
            let (y4m, notes) = Y4m::read(bytes)?;
            let (len, size, rate) = (y4m.len(), y4m.size(), y4m.frames_per_second());
            let samples = Samples::Integer { bits: y4m.bits() };
            let film = Self::of(Frames::Y4m(y4m), len, size, rate);
            return Ok(Self { samples, notes, ..film });
        }
        let mut selection = Selection { frame: 0, ..*selection };
        let mut first = read_picture(&bytes, &selection)?;
        let slices = first.frames == 1 && first.slices > 1 && selection.depth.is_none();
        let mut notes = Vec::new();
        if slices {
            notes.push(format!(
                "the file has one frame and {} slices; the slices were taken as frames",
                first.slices
            ));
            selection.depth = Some(Depth::Slice(0));
            first = read_picture(&bytes, &selection)?;
        }
        let len = if slices { first.slices } else { first.frames };
        // The note on how pages were interpreted is settled here.
        first.notes.retain(|note| !note.contains("they were taken as"));
        notes.append(&mut first.notes);
        let size = [first.plane.width(), first.plane.height()];
        let rate = first.frame_interval_s.map(f64::recip);
        let frames = Frames::Tiff { bytes, selection, slices };
        let Picture { pixel_size, samples, .. } = first;
        Ok(Self { pixel_size, samples, notes, ..Self::of(frames, len, size, rate) })
    }

    /// The slices of one frame of a TIFF as a film (of the frames, if the selection names no slice).
    ///
    /// # Errors
    /// Bytes that are not a TIFF, or no such frame or channel.
    pub(crate) fn of_slices(bytes: Vec<u8>, selection: Selection) -> Result<Self, PictureError> {
        let first = read_picture(&bytes, &selection)?;
        let slices = selection.depth.is_some();
        let len = if slices { first.slices } else { first.frames };
        let size = [first.plane.width(), first.plane.height()];
        let frames = Frames::Tiff { bytes, selection, slices };
        let Picture { pixel_size, samples, notes, .. } = first;
        Ok(Self { pixel_size, samples, notes, ..Self::of(frames, len, size, None) })
    }

    /// A film of pictures, each a file with its name; they are put in natural order (`frame2` before `frame10`).
    ///
    /// # Errors
    /// Fewer than [`FEWEST_FRAMES`], or a first picture that cannot be read.
    pub fn of_pictures(
        files: Vec<(String, Vec<u8>)>,
        selection: &Selection,
    ) -> Result<Self, FilmError> {
        Self::of_any_pictures(files, selection)?.whole()
    }

    /// As [`Film::of_pictures`], of any number of pictures but none.
    ///
    /// # Errors
    /// No picture, or a first one that cannot be read.
    pub fn of_any_pictures(
        mut files: Vec<(String, Vec<u8>)>,
        selection: &Selection,
    ) -> Result<Self, FilmError> {
        files.sort_by(|a, b| in_natural_order(&a.0, &b.0));
        let Some((name, bytes)) = files.first() else {
            return Err(FilmError::TooFew { frames: 0 });
        };
        let selection = Selection { frame: 0, ..*selection };
        let picture = read_picture(bytes, &selection).map_err(|cause| FilmError::Frame {
            frame: 0,
            name: Some(name.clone()),
            cause,
        })?;
        let size = [picture.plane.width(), picture.plane.height()];
        let Picture { pixel_size, samples, notes, .. } = picture;
        let len = files.len();
        let film = Self::of(Frames::Pictures { files, selection }, len, size, None);
        Ok(Self { pixel_size, samples, notes, ..film })
    }

    /// A film that begins with a picture, such as that of a gel without its cell, and goes on with the frames of this one.
    ///
    /// # Errors
    /// A picture of another size.
    pub fn after(self, first: Plane) -> Result<Self, FilmError> {
        let found = [first.width(), first.height()];
        if found != self.size {
            return Err(FilmError::Sizes { frame: 0, name: None, expected: self.size, found });
        }
        let Self { len, size, pixel_size, frames_per_second, samples, .. } = self;
        let notes = self.notes.clone();
        let frames = Frames::Led { first, film: Box::new(self) };
        Ok(Self { frames, len: len + 1, size, pixel_size, frames_per_second, samples, notes })
    }

    fn of(frames: Frames, len: usize, size: [usize; 2], rate: Option<f64>) -> Self {
        let samples = Samples::Integer { bits: 8 };
        let rate = rate.filter(|rate| rate.is_finite() && *rate > 0.0);
        let notes = Vec::new();
        Self { frames, len, size, pixel_size: None, frames_per_second: rate, samples, notes }
    }

    fn whole(self) -> Result<Self, FilmError> {
        if self.len < FEWEST_FRAMES {
            return Err(FilmError::TooFew { frames: self.len });
        }
        Ok(self)
    }

    /// Number of frames.
    pub fn len(&self) -> usize {
        self.len
    }

    /// Whether there are no frames; always false.
    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Columns and rows of every frame.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// Decodes a frame.
    ///
    /// # Errors
    /// A frame that does not exist, is damaged, has NaN pixels, or differs in size from the first.
    pub fn frame(&self, index: usize) -> Result<Plane, FilmError> {
        if index >= self.len {
            return Err(FilmError::NoSuchFrame { frame: index, frames: self.len });
        }
        let failed = |cause| FilmError::Frame { frame: index, name: self.name(index), cause };
        let plane = match &self.frames {
            Frames::Avi(avi) => avi.frame(index).map_err(failed)?,
            Frames::Y4m(y4m) => y4m.frame(index).map_err(failed)?,
            Frames::Tiff { bytes, selection, slices } => {
                let selection = if *slices {
                    Selection { depth: Some(Depth::Slice(index)), ..*selection }
                } else {
                    Selection { frame: index, ..*selection }
                };
                read_picture(bytes, &selection).map_err(failed)?.plane
            }
            Frames::Led { first, .. } if index == 0 => first.clone(),
            Frames::Led { film, .. } => film.frame(index - 1)?,
            Frames::Pictures { files, selection } => {
                read_picture(&files[index].1, selection).map_err(failed)?.plane
            }
        };
        let found = [plane.width(), plane.height()];
        if found != self.size {
            let (name, expected) = (self.name(index), self.size);
            return Err(FilmError::Sizes { frame: index, name, expected, found });
        }
        Ok(plane)
    }

    /// A frame as a picture of its own: the bytes of a TIFF with the same grey values and pixel size.
    ///
    /// # Errors
    /// As of [`Film::frame`].
    pub fn picture(&self, index: usize) -> Result<Vec<u8>, FilmError> {
        still::tiff(&self.frame(index)?, self.pixel_size.map(|stated| stated.size))
    }

    /// Name of a frame's file, if each frame has one.
    fn name(&self, index: usize) -> Option<String> {
        match &self.frames {
            Frames::Pictures { files, .. } => files.get(index).map(|(name, _)| name.clone()),
            _ => None,
        }
    }
}
