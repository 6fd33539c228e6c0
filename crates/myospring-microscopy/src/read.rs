//! One plane of a picture from the bytes of a PNG or TIFF file.

use super::picture::{Picture, Selection};

pub(crate) mod avi;
mod canvas;
mod check;
mod error;
mod kind;
mod limits;
mod pixel_size;
mod png;
mod tiff;
pub(crate) mod y4m;

pub use error::PictureError;
pub use limits::{LONGEST_SIDE, MOST_PIXELS};

/// The error for a kind of picture that cannot be read, from the ending of the file name (without
/// dot): it says what the file is and how to convert it. `None` for all other endings.
///
/// # Example
/// ```
/// use myospring::microscopy::read::unread_kind;
/// let error = unread_kind("czi").unwrap().to_string();
/// assert!(error.starts_with("this is a Zeiss CZI file, which cannot be read; export it as OME-TIFF"));
/// assert!(unread_kind("tif").is_none());
/// ```
pub fn unread_kind(ending: &str) -> Option<PictureError> {
    kind::unread(ending)
}

/// Reads one plane of a PNG or TIFF file, with the metadata of the file.
///
/// PNG of every kind; TIFF and `BigTIFF` with one page or many, OME-TIFF, ImageJ hyperstacks; whole
/// numbers of 1 to 16, 32 and 64 bits (signed from 8 bits on), and floating point of 16, 32 and 64
/// bits; grey, colour and any number of channels; uncompressed, LZW, deflate and `PackBits`. A
/// palette PNG gives its colours; a palette TIFF gives its indices, which are the labels of a label
/// image. A fully transparent pixel is 0. Only the needed pages are decoded, one slice at a time.
///
/// The meaning of pages comes from OME-XML, else from ImageJ's description, else they are frames;
/// see [`Selection::depth`]. Pages of another size than the first (thumbnails) are left out.
///
/// The pixel size comes from OME-XML, else from ImageJ, else from the resolution tags, else from a
/// PNG's `pHYs`; sizes outside 0.01 to 20 um and resolutions of printers and screens are rejected
/// with a note.
///
/// Values are those of the file as `f32`, which represents whole numbers up to 16777216 exactly;
/// larger values are noted.
///
/// # Errors
/// Bytes that are not a complete PNG or TIFF; unsupported pixel types and compression; more than
/// [`MOST_PIXELS`] or [`LONGEST_SIDE`]; a channel, frame or slice that does not exist; infinite or
/// NaN pixels; pixels that are not square.
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
