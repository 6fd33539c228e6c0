//! What a picture file holds, and which plane of it is wanted.

use std::str::FromStr;

use super::plane::Plane;
use myospring_core::mesh::pixel_size::PixelSize;

/// Which plane of a picture to take. Channels, frames and slices count from 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Selection {
    /// Channel; `None` takes the first, and of a colour picture its luminance.
    pub channel: Option<usize>,
    /// Frame (time point).
    pub frame: usize,
    /// What to make of a stack in depth; `None` is the maximum of what the file calls slices.
    ///
    /// The pages of a file that does not say what they are count as frames; where a depth is
    /// given, they count as slices.
    pub depth: Option<Depth>,
}

/// What to make of a stack of slices in depth.
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

/// A word that is no way to take a stack in depth.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{word}` is no way to take a stack in depth; write max, mean, or the number of a slice, from 0"
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
    /// Where the file says so.
    pub source: PixelSizeSource,
}

/// Kind of the numbers in the file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Samples {
    /// Whole numbers of so many bits.
    Integer {
        /// 1 to 64.
        bits: u8,
    },
    /// Floating point of so many bits.
    Float {
        /// 16, 32 or 64.
        bits: u8,
    },
}

/// One plane of a picture with what the file says about itself.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// The plane that was selected.
    pub plane: Plane,
    /// Side of a pixel, where the file states one that makes sense under a microscope.
    pub pixel_size: Option<StatedPixelSize>,
    /// Kind of the numbers.
    pub samples: Samples,
    /// Whether red, green and blue differ somewhere in the plane.
    pub coloured: bool,
    /// Number of channels; 3 for a colour picture. Transparency is none.
    pub channels: usize,
    /// Number of frames.
    pub frames: usize,
    /// Number of slices in depth.
    pub slices: usize,
    /// Time between two frames, s, where the file states one.
    pub frame_interval_s: Option<f64>,
    /// What a person should know: which channel was taken of several, a pixel size that was not believed.
    pub notes: Vec<String>,
}
