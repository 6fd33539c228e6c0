//! One plane of a picture from the bytes of a PNG or TIFF file.

use super::picture::{Picture, Selection};

mod canvas;
mod error;
mod kind;
mod pixel_size;
mod png;
mod tiff;

pub use error::PictureError;

/// Most pixels that a picture may declare.
pub const MOST_PIXELS: u64 = 100_000_000;

/// Longest side that a picture may declare, pixels.
pub const LONGEST_SIDE: u32 = 32_768;

/// Most memory that the decoded bytes of a picture, or of one of its strips or tiles, may take, bytes.
const MOST_MEMORY: u64 = 1 << 29;

/// Reads one plane of a PNG or TIFF file, with what the file says about itself.
///
/// PNG of every kind; TIFF and `BigTIFF` with one page or many, OME-TIFF, ImageJ hyperstacks; whole
/// numbers of 1 to 16, 32 and 64 bits, with sign from 8 bits on, and floating point of 16, 32 and 64
/// bits; grey, colour and any number of channels; uncompressed, LZW, deflate and `PackBits`. A palette PNG
/// is its colours; a palette TIFF is its indices, which are the labels where it is a label image. A
/// fully transparent pixel is 0. Only the pages that are needed are decoded, one slice at a time.
///
/// Pages mean what OME-XML says, else ImageJ's description, else they are frames; see
/// [`Selection::depth`]. Pages of another size than the first (thumbnails) are left out.
///
/// The pixel size is that of OME-XML, else of ImageJ, else of the resolution tags, else of a PNG's `pHYs`;
/// sizes outside 0.01 to 20 um and resolutions of printers and screens are not believed, which a note
/// says.
///
/// Values are the file's own as `f32`, which holds whole numbers up to 16777216 exactly; a note says
/// where a picture has larger ones.
///
/// # Errors
/// Bytes that are no PNG or TIFF, or are not complete; kinds of pixels and compression that are not
/// read; more than [`MOST_PIXELS`] or [`LONGEST_SIDE`]; a channel, frame or slice that is not there;
/// infinite pixels or such that are no number; pixels that are not square.
///
/// # Example
/// ```
/// use myospring::microscopy::{picture::Selection, read::read_picture};
/// # let mut bytes = Vec::new();
/// # png::Encoder::new(&mut bytes, 4, 3).write_header()?.write_image_data(&[7; 12])?;
/// let picture = read_picture(&bytes, &Selection::default())?;
/// assert_eq!((picture.plane.width(), picture.plane.height()), (4, 3));
/// assert_eq!(picture.plane.at(2, 1), 7.0);
/// assert_eq!(picture.pixel_size, None);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn read_picture(bytes: &[u8], selection: &Selection) -> Result<Picture, PictureError> {
    match kind::recognise(bytes)? {
        kind::Kind::Png => png::read(bytes, selection),
        kind::Kind::Tiff => tiff::read(bytes, selection),
    }
}

/// Refuses sizes that no picture here may have; called before memory is taken.
fn check_size(width: u32, height: u32) -> Result<(), PictureError> {
    let pixels = u64::from(width) * u64::from(height);
    if width > LONGEST_SIDE || height > LONGEST_SIDE || pixels > MOST_PIXELS {
        return Err(PictureError::TooLarge { width, height });
    }
    Ok(())
}

/// Refuses a buffer that is larger than [`MOST_MEMORY`].
fn check_memory(bytes: u64) -> Result<(), PictureError> {
    if bytes <= MOST_MEMORY {
        return Ok(());
    }
    Err(PictureError::TooMuch {
        what: format!("{} MiB of memory at once", bytes >> 20),
        most: format!("{} MiB are allowed", MOST_MEMORY >> 20),
        mend: "cut out the cell, or save the picture as grey values",
    })
}

/// Refuses a number that is not below `count`.
fn check_range(what: &'static str, asked: usize, count: usize) -> Result<(), PictureError> {
    if asked < count { Ok(()) } else { Err(PictureError::OutOfRange { what, asked, count }) }
}
