//! Conversion between pixels and um.

use myospring_core::mesh::mask::Mask;
use myospring_core::mesh::outline::{Outline, OutlineError};
use myospring_core::mesh::pixel_size::PixelSize;

/// Longest side that a frame may have, pixels.
const LONGEST_SIDE: usize = 65_536;

/// Most pixels that a frame may have.
const MOST_PIXELS: usize = 100_000_000;

/// Why a picture size is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FrameError {
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
    pixel_size: PixelSize,
}

impl PixelFrame {
    /// A picture of `width` x `height` pixels.
    ///
    /// # Errors
    /// No pixel, more than 65536 per side or 100 million in all.
    ///
    /// # Example
    /// ```
    /// use myospring::{mesh::pixel_size::PixelSize, microscopy::outlines::PixelFrame};
    /// let frame = PixelFrame::new(100, 60, PixelSize::new(0.5)?)?;
    /// assert_eq!(frame.to_um([0.0, 60.0]), [0.0, 0.0]);
    /// assert_eq!(frame.to_pixels([50.0, 30.0]), [100.0, 0.0]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn new(width: usize, height: usize, pixel_size: PixelSize) -> Result<Self, FrameError> {
        let sides = 1..=LONGEST_SIDE;
        if !sides.contains(&width) || !sides.contains(&height) || width * height > MOST_PIXELS {
            return Err(FrameError::Size { width, height });
        }
        Ok(Self { width, height, pixel_size })
    }

    /// The frame of a mask.
    ///
    /// # Example
    /// ```
    /// use myospring::mesh::{mask::Mask, pixel_size::PixelSize};
    /// use myospring::microscopy::outlines::PixelFrame;
    /// let mask = Mask::new(2, 1, PixelSize::new(0.5)?, vec![true, false])?;
    /// assert_eq!(PixelFrame::of(&mask).width(), 2);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of(mask: &Mask) -> Self {
        Self { width: mask.width(), height: mask.height(), pixel_size: mask.pixel_size() }
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Side of a pixel.
    pub fn pixel_size(&self) -> PixelSize {
        self.pixel_size
    }

    /// The outline of rings in pixels, the exterior first.
    pub(super) fn outline(&self, rings: Vec<Vec<[f64; 2]>>) -> Result<Outline, OutlineError> {
        let in_um = |ring: Vec<[f64; 2]>| ring.into_iter().map(|point| self.to_um(point)).collect();
        let mut rings = rings.into_iter().map(in_um);
        let exterior = rings.next().unwrap_or_default();
        Outline::new(exterior, rings.collect())
    }

    /// Converts a point from pixels, y downward, to um, y upward.
    pub fn to_um(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let side = self.pixel_size.um();
        [x * side, (self.height as f64 - y) * side]
    }

    /// Converts a point from um, y upward, to pixels, y downward.
    pub fn to_pixels(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let side = self.pixel_size.um();
        [x / side, self.height as f64 - y / side]
    }
}
