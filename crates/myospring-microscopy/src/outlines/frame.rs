//! How the pixels of a picture lie in um.

use myospring_core::mesh::mask::{Mask, PixelSizeError, checked_pixel_size};

/// Longest side that a frame may have, pixels.
const LONGEST_SIDE: usize = 65_536;

/// Most pixels that a frame may have.
const MOST_PIXELS: usize = 100_000_000;

/// Why numbers do not describe a picture.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrameError {
    /// The pixel size is not a length that a microscope gives.
    #[error(transparent)]
    PixelSize(#[from] PixelSizeError),
    /// No pixel, or too many.
    #[error(
        "a picture of {width} x {height} pixels is not possible: 1 to {LONGEST_SIDE} per side and at \
         most {MOST_PIXELS} in all"
    )]
    Size {
        /// Columns.
        width: usize,
        /// Rows.
        height: usize,
    },
}

/// Size of a picture and of its pixels: turns pixels into um and back.
///
/// Pixels count from the top left corner of the picture, x to the right and y downward; the centre
/// of the first pixel is at (0.5, 0.5). Micrometres count from the lower left corner, y upward, as
/// [`Mask`] and [`myospring_core::mesh::lattice::from_mask`] have them: `x = s px`, `y = s (height - py)`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PixelFrame {
    width: usize,
    height: usize,
    pixel_size_um: f64,
}

impl PixelFrame {
    /// A picture of `width` x `height` pixels of side `pixel_size_um`.
    ///
    /// # Errors
    /// No pixel, more than 65536 per side or 100 million in all, a pixel size outside
    /// [`myospring_core::mesh::mask::PIXEL_SIZES_UM`].
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::outlines::PixelFrame;
    /// let frame = PixelFrame::new(100, 60, 0.5).unwrap();
    /// assert_eq!(frame.to_um([0.0, 60.0]), [0.0, 0.0]);
    /// assert_eq!(frame.to_pixels([50.0, 30.0]), [100.0, 0.0]);
    /// ```
    pub fn new(width: usize, height: usize, pixel_size_um: f64) -> Result<Self, FrameError> {
        checked_pixel_size(pixel_size_um)?;
        let sides = 1..=LONGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) || width * height > MOST_PIXELS {
            return Err(FrameError::Size { width, height });
        }
        Ok(Self { width, height, pixel_size_um })
    }

    /// The frame of a mask.
    ///
    /// # Example
    /// ```
    /// use myospring::{mesh::mask::Mask, microscopy::outlines::PixelFrame};
    /// let mask = Mask::new(2, 1, 0.5, vec![true, false]).unwrap();
    /// assert_eq!(PixelFrame::of(&mask).width(), 2);
    /// ```
    pub fn of(mask: &Mask) -> Self {
        Self { width: mask.width(), height: mask.height(), pixel_size_um: mask.pixel_size_um() }
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Side of a pixel, um.
    pub fn pixel_size_um(&self) -> f64 {
        self.pixel_size_um
    }

    /// A point in pixels, y downward, as one in um, y upward.
    pub fn to_um(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x * self.pixel_size_um, (self.height as f64 - y) * self.pixel_size_um]
    }

    /// A point in um, y upward, as one in pixels, y downward.
    pub fn to_pixels(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x / self.pixel_size_um, self.height as f64 - y / self.pixel_size_um]
    }
}
