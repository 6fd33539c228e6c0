//! The side of a microscope's pixel.

use std::fmt;

/// Side of a square pixel: a plausible length for a microscope, from 0.001 to 50 um.
///
/// # Example
/// ```
/// use myospring::mesh::pixel_size::PixelSize;
/// let pixel = PixelSize::new(0.27)?;
/// assert_eq!((pixel.um(), pixel.to_string().as_str()), (0.27, "0.27 um"));
/// assert_eq!(
///     PixelSize::new(270.0).unwrap_err().to_string(),
///     "pixel size 270 um is outside 0.001 to 50 um: give the width of one pixel in micrometres"
/// );
/// # Ok::<(), myospring::mesh::pixel_size::PixelSizeError>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, PartialOrd)]
pub struct PixelSize(f64);

/// A length that is not a plausible pixel size.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "pixel size {um} um is outside {} to {} um: give the width of one pixel in micrometres",
    PixelSize::SMALLEST_UM,
    PixelSize::LARGEST_UM
)]
pub struct PixelSizeError {
    /// The given length, um.
    pub um: f64,
}

impl PixelSize {
    /// Smallest, um: beyond the resolution of light, that of electrons.
    pub const SMALLEST_UM: f64 = 0.001;
    /// Largest, um: that of a macro lens.
    pub const LARGEST_UM: f64 = 50.0;

    /// A pixel of 1 um.
    pub const MICROMETRE: Self = Self(1.0);

    /// A pixel of this side, um.
    ///
    /// # Errors
    /// A length outside the bounds, or NaN.
    pub fn new(um: f64) -> Result<Self, PixelSizeError> {
        let known = (Self::SMALLEST_UM..=Self::LARGEST_UM).contains(&um);
        known.then_some(Self(um)).ok_or(PixelSizeError { um })
    }

    /// The side, um.
    pub const fn um(self) -> f64 {
        self.0
    }
}

impl fmt::Display for PixelSize {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Files state ratios of whole numbers, whose last digits are not significant.
        write!(formatter, "{} um", (1e6 * self.0).round() / 1e6)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_that_no_microscope_gives_are_refused_with_their_bounds() {
        for um in [0.0, -1.0, f64::NAN, f64::INFINITY, 100.0, 1e-9] {
            let message = PixelSize::new(um).unwrap_err().to_string();
            let expected = format!("pixel size {um} um is outside 0.001 to 50 um");
            assert!(message.contains(&expected), "{message}");
        }
        assert!([0.001, 50.0].into_iter().all(|um| PixelSize::new(um).is_ok()));
    }
}
