//! Length, width and rotation of a deformed cell against its resting shape.

/// Measures a moving cell along its reference long axis after rigid rotation is removed.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeMeter {
    reference: [Vec<f64>; 2],
    axis: [f64; 2],
    weights: Vec<f64>,
    /// Weights of the rotation across which the width is measured, where they are others.
    across: Option<Vec<f64>>,
}

/// Length along and width across the long axis, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// End-to-end length along the long axis, um.
    pub length: f64,
    /// Largest extent across the long axis, as the cell has turned it, um.
    pub width: f64,
}

impl ShapeMeter {
    /// A meter for resting positions (um, by axis), a unit long axis and one weight per point.
    ///
    /// # Example
    /// ```
    /// use myospring::analysis::shape::ShapeMeter;
    /// let square = [vec![0.0, 2.0, 2.0, 0.0], vec![0.0, 0.0, 1.0, 1.0]];
    /// let meter = ShapeMeter::new(square, [1.0, 0.0], vec![1.0; 4]);
    /// // A quarter turn changes neither length nor width.
    /// let turned = [vec![0.0, 0.0, -1.0, -1.0], vec![0.0, 2.0, 2.0, 0.0]];
    /// let extent = meter.measure(&turned);
    /// assert!((extent.length - 2.0).abs() < 1e-12 && (extent.width - 1.0).abs() < 1e-12);
    /// ```
    pub fn new(reference: [Vec<f64>; 2], axis: [f64; 2], weights: Vec<f64>) -> Self {
        Self { reference, axis, weights, across: None }
    }

    /// Measures the width across the axis that points of these weights have turned, while the length stays
    /// along the axis that those of [`ShapeMeter::new`] have turned: for a cell that is held at one end and
    /// swings aside.
    #[must_use]
    pub fn width_turned_by(self, weights: Vec<f64>) -> Self {
        Self { across: Some(weights), ..self }
    }

    /// Angle by which the points have turned, rad, counter-clockwise: the rotation that brings the
    /// reference closest to them in the sense of weighted least squares.
    pub fn rotation(&self, positions: &[Vec<f64>; 2]) -> f64 {
        self.rotation_of(positions, &self.weights)
    }

    fn rotation_of(&self, positions: &[Vec<f64>; 2], weights: &[f64]) -> f64 {
        let total: f64 = weights.iter().sum();
        let mean =
            |values: &[f64]| values.iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / total;
        let before = [0, 1].map(|axis| mean(&self.reference[axis]));
        let after = [0, 1].map(|axis| mean(&positions[axis]));
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (i, weight) in weights.iter().enumerate() {
            let old = [0, 1].map(|axis| self.reference[axis][i] - before[axis]);
            let new = [0, 1].map(|axis| positions[axis][i] - after[axis]);
            cosine += weight * (old[0] * new[0] + old[1] * new[1]);
            sine += weight * (old[0] * new[1] - old[1] * new[0]);
        }
        sine.atan2(cosine)
    }

    /// Length and width now, um.
    pub fn measure(&self, positions: &[Vec<f64>; 2]) -> Extent {
        let [x, y] = self.axis;
        let turned = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            [cosine * x - sine * y, sine * x + cosine * y]
        };
        let along = turned(self.rotation(positions));
        let across = match &self.across {
            None => along,
            Some(weights) => turned(self.rotation_of(positions, weights)),
        };
        let length = extent(positions, along);
        Extent { length, width: extent(positions, [-across[1], across[0]]) }
    }
}

/// Points (um, by axis) shifted and turned as a whole to where they are nearest to others in the sense of least squares with
/// these weights.
///
/// # Example
/// ```
/// use myospring::analysis::shape::laid_upon;
/// let square = [vec![0.0, 2.0, 2.0, 0.0], vec![0.0, 0.0, 1.0, 1.0]];
/// let turned = [vec![5.0, 5.0, 4.0, 4.0], vec![5.0, 7.0, 7.0, 5.0]];
/// let laid = laid_upon(&turned, &square, &[1.0; 4]);
/// assert!((0..4).all(|i| (0..2).all(|axis| (laid[axis][i] - square[axis][i]).abs() < 1e-12)));
/// ```
///
/// # Panics
/// If there are more points than others or weights.
pub fn laid_upon(points: &[Vec<f64>; 2], others: &[Vec<f64>; 2], weights: &[f64]) -> [Vec<f64>; 2] {
    let meter = ShapeMeter::new(points.clone(), [1.0, 0.0], weights.to_vec());
    let (sine, cosine) = meter.rotation(others).sin_cos();
    let total: f64 = weights.iter().sum();
    let middle = |of: &[Vec<f64>; 2]| {
        [0, 1].map(|axis: usize| {
            of[axis].iter().zip(weights).map(|(x, w)| x * w).sum::<f64>() / total
        })
    };
    let (from, to) = (middle(points), middle(others));
    let turned = |axis: usize| {
        let [a, b] = [[cosine, -sine], [sine, cosine]][axis];
        let of = |(x, y): (&f64, &f64)| a * (x - from[0]) + b * (y - from[1]) + to[axis];
        points[0].iter().zip(&points[1]).map(of).collect()
    };
    [turned(0), turned(1)]
}

/// Distance of the outermost points along a unit direction, um.
pub fn extent(positions: &[Vec<f64>; 2], direction: [f64; 2]) -> f64 {
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for (x, y) in positions[0].iter().zip(&positions[1]) {
        let along = x * direction[0] + y * direction[1];
        lowest = lowest.min(along);
        highest = highest.max(along);
    }
    highest - lowest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_and_stretch_are_told_apart() {
        let points = [vec![0.0, 10.0, 10.0, 0.0, 4.0], vec![0.0, 0.0, 2.0, 2.0, 1.0]];
        let meter = ShapeMeter::new(points.clone(), [1.0, 0.0], vec![1.0; 5]);
        for angle in [-1.0_f64, 0.3, 2.0] {
            let (sine, cosine) = angle.sin_cos();
            let (mut turned, shift) = (points.clone(), 7.0);
            for i in 0..5 {
                let (x, y) = (0.9 * points[0][i], 1.05 * points[1][i]);
                turned[0][i] = cosine * x - sine * y + shift;
                turned[1][i] = sine * x + cosine * y;
            }
            let extent = meter.measure(&turned);
            assert!((meter.rotation(&turned) - angle).abs() < 1e-12);
            assert!((extent.length - 9.0).abs() < 1e-12 && (extent.width - 2.1).abs() < 1e-12);
        }
    }

    #[test]
    fn a_bar_that_swings_about_its_end_keeps_its_width() {
        let bar = [vec![0.0, 10.0, 10.0, 0.0], vec![0.0, 0.0, 2.0, 2.0]];
        let held = ShapeMeter::new(bar.clone(), [1.0, 0.0], vec![1.0, 0.0, 0.0, 1.0]);
        let (sine, cosine) = 0.1_f64.sin_cos();
        let mut swung = bar.clone();
        for i in [1, 2] {
            swung[0][i] = 10.0 * cosine - sine * bar[1][i];
            swung[1][i] = 10.0 * sine + cosine * bar[1][i];
        }
        let before = held.measure(&swung);
        let now = held.width_turned_by(vec![1.0; 4]).measure(&swung);
        // The held end has not turned, so the rest seems wider by its swing unless the width turns with it.
        assert!((before.width - (10.0 * sine + 2.0 * cosine)).abs() < 1e-12);
        assert!((now.width - 2.0).abs() < 0.02, "{now:?}");
        assert_eq!(now.length, before.length);
    }
}
