//! The content of a picture file, and the selection of a plane.

use std::str::FromStr;

use super::plane::Plane;
use myospring_core::mesh::pixel_size::PixelSize;

/// Which plane of a picture to take. Channels, frames and slices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Selection {
    /// Channel; `None` takes the first, or the luminance of a colour picture.
    pub channel: Option<usize>,
    /// Frame (time point).
    pub frame: usize,
    /// How a stack in depth becomes one plane; `None` takes the maximum over the slices.
    ///
    /// If the file does not say what its pages are, they count as slices when a depth is given, and
    /// as frames otherwise.
    pub depth: Option<Depth>,
}

/// How a stack of slices in depth becomes one plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Depth {
    /// The largest value over all slices at each pixel.
    #[default]
    Maximum,
    /// The mean over all slices at each pixel.
    Mean,
    /// One slice.
    Slice(usize),
}

/// A word that does not name a [`Depth`].
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{word}` is not a way to reduce a stack in depth; write max, mean, or the number of a slice, from 0"
)]
pub struct DepthError {
    /// What was written.
    pub word: String,
}

/// `max`, `mean`, or the number of a slice.
///
/// # Example
/// ```
/// use myospring::microscopy::picture::Depth;
/// assert_eq!("mean".parse(), Ok(Depth::Mean));
/// assert_eq!("3".parse(), Ok(Depth::Slice(3)));
/// assert!("top".parse::<Depth>().is_err());
/// ```
impl FromStr for Depth {
    type Err = DepthError;

    fn from_str(word: &str) -> Result<Self, DepthError> {
        match word {
            "max" => Ok(Self::Maximum),
            "mean" => Ok(Self::Mean),
            number => {
                let slice = number.parse().map_err(|_| DepthError { word: word.to_owned() })?;
                Ok(Self::Slice(slice))
            }
        }
    }
}

/// Where the size of a pixel is written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelSizeSource {
    /// `PhysicalSizeX` of OME-XML.
    OmeXml,
    /// ImageJ's description with its unit, and the TIFF resolution.
    ImageJ,
    /// The TIFF resolution tags with their unit.
    TiffResolution,
    /// The `pHYs` chunk of a PNG.
    PngResolution,
}

/// Side of one pixel as the file states it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StatedPixelSize {
    /// Side.
    pub size: PixelSize,
    /// Where the file states it.
    pub source: PixelSizeSource,
}

/// Type of the pixel values in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    /// Whole numbers.
    Integer {
        /// Bits of each, 1 to 64.
        bits: u8,
    },
    /// Floating-point numbers.
    Float {
        /// Bits of each: 16, 32 or 64.
        bits: u8,
    },
}

/// One plane of a picture with the metadata of the file.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The plane that was selected.
    pub plane: Plane,
    /// Side of a pixel, if the file states one that is plausible for a microscope.
    pub pixel_size: Option<StatedPixelSize>,
    /// Type of the pixel values.
    pub samples: Samples,
    /// Whether red, green and blue differ somewhere in the plane.
    pub coloured: bool,
    /// Number of channels; 3 for a colour picture. Opacity is not counted.
    pub channels: usize,
    /// Number of channels to choose from: a colour picture, read as its luminance, counts as one.
    pub choices: usize,
    /// Number of frames.
    pub frames: usize,
    /// Number of slices in depth.
    pub slices: usize,
    /// Time between two frames, s, if the file states one.
    pub frame_interval_s: Option<f64>,
    /// Distance of two slices in depth, um, if the file states one that is plausible for a microscope.
    pub z_step_um: Option<f64>,
    /// Warnings, for instance which of several channels was taken, or a stated pixel size that was
    /// rejected as implausible.
    pub notes: Vec<String>,
}
