//! One plane of a picture: grey values on a grid of pixels.

use std::sync::Arc;

/// Grey values row by row from the top left, as the picture stores them (counts, not stretched).
///
/// Copies share the values, which never change.
///
/// Rows run downward: row 0 is the top of the picture. The y axis of meshes and outlines runs upward.
#[derive(Debug, Clone, PartialEq)]
pub struct Plane {
    width: usize,
    height: usize,
    values: Arc<Vec<f32>>,
}

impl Plane {
    /// Makes a plane of `width` x `height` pixels; `None` unless there is one value for each pixel and at least
    /// one pixel.
    ///
    /// # Example
    /// ```
    /// use myospring::microscopy::plane::Plane;
    /// let plane = Plane::new(2, 1, vec![0.0, 7.0]).unwrap();
    /// assert_eq!(plane.at(1, 0), 7.0);
    /// assert!(Plane::new(2, 2, vec![0.0]).is_none());
    /// ```
    pub fn new(width: usize, height: usize, values: Vec<f32>) -> Option<Self> {
        let fits = width.checked_mul(height) == Some(values.len()) && !values.is_empty();
        fits.then(|| Self { width, height, values: Arc::new(values) })
    }

    /// Number of columns.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Number of rows.
    pub fn height(&self) -> usize {
        self.height
    }

    /// All values, row by row from the top left.
    pub fn values(&self) -> &[f32] {
        &self.values
    }

    /// One value.
    ///
    /// # Panics
    /// Outside the plane.
    pub fn at(&self, column: usize, row: usize) -> f32 {
        assert!(column < self.width, "column {column} of {}", self.width);
        self.values[row * self.width + column]
    }

    /// The plane with a function applied to each value.
    #[must_use]
    pub fn map(&self, change: impl Fn(f32) -> f32) -> Self {
        let values = self.values.iter().map(|&value| change(value)).collect();
        Self { values: Arc::new(values), ..*self }
    }

    /// Smallest and largest finite value; both 0 if there is none.
    pub fn range(&self) -> [f32; 2] {
        let finite = self.values.iter().copied().filter(|value| value.is_finite());
        let start = [f32::INFINITY, f32::NEG_INFINITY];
        let range = finite.fold(start, |[low, high], value| [low.min(value), high.max(value)]);
        if range[0] > range[1] { [0.0; 2] } else { range }
    }
}
