//! Length, width and rotation of a deformed cell relative to its resting shape.
//!
//! At rest, length and width are the extent along and across the long axis. Their *change* is that
//! of the distance between the means of two caps, so that it does not depend on single points:
//! along the axis the caps are the [ends](crate::mesh::ends), each a twentieth of the length;
//! across it they are the outermost rows, each with a twentieth of the area. Uniform strain by a
//! factor multiplies the resting length by that factor.

use crate::mesh::ends::end_points;

/// Least part of the area in a cap across the long axis.
const SIDE_PART: f64 = 0.05;
/// Points at the same depth within this part of the extent belong to one row.
const SAME_ROW: f64 = 1e-9;

/// Measures a moving cell along its reference long axis after rigid rotation is removed.
#[derive(Debug, Clone, PartialEq)]
pub struct ShapeMeter {
    reference: [Vec<f64>; 2],
    axis: [f64; 2],
    /// The rotation of the axis along which the length is measured.
    turn: Turn,
    /// That for the width, if it differs.
    across: Option<Turn>,
    length: Span,
    width: Span,
}

/// Length along and width across the long axis, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extent {
    /// Length along the long axis, um: at rest the distance between its ends, scaled by the
    /// distance between the means of both ends.
    pub length: f64,
    /// Width across the long axis, um: at rest the largest extent, scaled by the distance between
    /// the means of both sides.
    pub width: f64,
}

/// The points by which a rotation is measured.
#[derive(Debug, Clone, PartialEq)]
struct Turn {
    /// Weight times distance from the mean of all points at rest, by axis.
    arms: [Vec<f64>; 2],
    /// Sum of the weighted squares of the distances.
    square: f64,
}

impl Turn {
    fn new(reference: &[Vec<f64>; 2], weights: &[f64]) -> Self {
        assert!(reference.iter().all(|of| of.len() == weights.len()), "one weight per point");
        let total: f64 = weights.iter().sum();
        let (mut arms, mut square) = ([const { Vec::new() }; 2], 0.0);
        for (arms, points) in arms.iter_mut().zip(reference) {
            let weighted = |(x, weight): (&f64, &f64)| x * weight;
            let mean = points.iter().zip(weights).map(weighted).sum::<f64>() / total;
            arms.extend(points.iter().zip(weights).map(|(x, weight)| weight * (x - mean)));
            square += arms.iter().zip(points).map(|(arm, x)| arm * (x - mean)).sum::<f64>();
        }
        Self { arms, square }
    }

    /// Returns the angle of the least squares, `tan = sum w (r x p) / sum w (r . p)`, with the distances `r` and `p` from the mean at
    /// rest and now. All `w r` add up to 0, so `p` is replaced by `r` plus the displacement: without displacements the angle is exactly 0.
    fn angle(&self, reference: &[Vec<f64>; 2], positions: &[Vec<f64>; 2]) -> f64 {
        let points = self.arms[0].len();
        assert!(positions.iter().all(|of| of.len() == points), "one position per point");
        let [x, y] = [0, 1].map(|axis| positions[axis].iter().zip(&reference[axis]));
        let (mut cosine, mut sine) = (self.square, 0.0);
        for ((a, b), ((x, x0), (y, y0))) in self.arms[0].iter().zip(&self.arms[1]).zip(x.zip(y)) {
            let [dx, dy] = [x - x0, y - y0];
            cosine += a * dx + b * dy;
            sine += a * dy - b * dx;
        }
        sine.atan2(cosine)
    }
}

/// An extent that is scaled by the distance between the means of two caps.
#[derive(Debug, Clone, PartialEq)]
struct Span {
    /// The extent at rest, um.
    rest: f64,
    /// Points of the lower and of the upper cap, and the weight of each in the mean.
    caps: [Vec<(usize, f64)>; 2],
    /// Distance between the means of the caps at rest, um.
    apart: f64,
    /// Parts of the extent, and of the distance between the means, that clamps keep at constant
    /// length, um.
    rigid: [f64; 2],
}

impl Span {
    fn new(
        points: &[Vec<f64>; 2],
        weights: &[f64],
        direction: [f64; 2],
        caps: [Vec<usize>; 2],
    ) -> Self {
        let weighted = caps.map(|cap| {
            let total: f64 = cap.iter().map(|&point| weights[point]).sum();
            let even = 1.0 / cap.len() as f64;
            let part = |point: usize| if total > 0.0 { weights[point] / total } else { even };
            cap.iter().map(|&point| (point, part(point))).collect()
        });
        let mut span =
            Self { rest: extent(points, direction), caps: weighted, apart: 0.0, rigid: [0.0; 2] };
        span.apart = span.distance(points, direction);
        span
    }

    /// Distance between the means of the caps along a direction, um.
    fn distance(&self, positions: &[Vec<f64>; 2], [x, y]: [f64; 2]) -> f64 {
        let [low, high] = self.caps.each_ref().map(|cap| {
            let along = |&(point, weight): &(usize, f64)| {
                weight * (positions[0][point] * x + positions[1][point] * y)
            };
            cap.iter().map(along).sum::<f64>()
        });
        high - low
    }

    /// The extent now, um: the part that is not rigid is stretched like the distance between the
    /// means of the caps.
    fn now(&self, positions: &[Vec<f64>; 2], direction: [f64; 2]) -> f64 {
        let [rigid, between] = self.rigid;
        let stretch = (self.distance(positions, direction) - between) / (self.apart - between);
        // In this form, an unchanged length is reproduced exactly.
        self.rest + (self.rest - rigid) * (stretch - 1.0)
    }
}

impl ShapeMeter {
    /// A meter for resting positions (um, by axis), a unit long axis and one weight per point, such
    /// as its area; the weights apply to the means of the caps and to the rotation.
    ///
    /// # Example
    /// ```
    /// use myospring::analysis::shape::ShapeMeter;
    /// let square = [vec![0.0, 2.0, 2.0, 0.0], vec![0.0, 0.0, 1.0, 1.0]];
    /// let meter = ShapeMeter::new(square, [1.0, 0.0], &[1.0; 4]);
    /// // A quarter turn changes neither length nor width.
    /// let turned = [vec![0.0, 0.0, -1.0, -1.0], vec![0.0, 2.0, 2.0, 0.0]];
    /// let extent = meter.measure(&turned);
    /// assert!((extent.length - 2.0).abs() < 1e-12 && (extent.width - 1.0).abs() < 1e-12);
    /// ```
    ///
    /// # Panics
    /// If there is not one weight per point.
    pub fn new(reference: [Vec<f64>; 2], axis: [f64; 2], weights: &[f64]) -> Self {
        let across = [-axis[1], axis[0]];
        let length = Span::new(&reference, weights, axis, end_points(&reference, axis));
        let width = Span::new(&reference, weights, across, sides(&reference, weights, across));
        let turn = Turn::new(&reference, weights);
        Self { reference, axis, turn, across: None, length, width }
    }

    /// Sets other weights for the rotation, for instance those of points held by a clamp.
    #[must_use]
    pub fn turned_by(mut self, weights: &[f64]) -> Self {
        self.turn = Turn::new(&self.reference, weights);
        self
    }

    /// Measures the width across an axis that turns with the points of these weights, while the
    /// length is still measured along the axis of the meter's own rotation: for a cell that is held
    /// at one end and swings aside.
    #[must_use]
    pub fn width_turned_by(mut self, weights: &[f64]) -> Self {
        self.across = Some(Turn::new(&self.reference, weights));
        self
    }

    /// Sets the depths, um, to which the lower and the upper end are within clamps (0 for a free
    /// end): clamped parts do not change length.
    #[must_use]
    pub fn gripped(mut self, depths: [f64; 2]) -> Self {
        let [x, y] = self.axis;
        let along = |point: usize| self.reference[0][point] * x + self.reference[1][point] * y;
        let all = || (0..self.reference[0].len()).map(along);
        let ends = [all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max)];
        let (mut rigid, mut between) = (0.0, 0.0);
        for ((depth, end), cap) in depths.into_iter().zip(ends).zip(&self.length.caps) {
            if depth > 0.0 {
                let mean: f64 = cap.iter().map(|&(point, weight)| weight * along(point)).sum();
                rigid += depth;
                between += depth - (mean - end).abs();
            }
        }
        self.length.rigid = [rigid, between];
        self
    }

    /// Angle by which the points have turned, rad, counter-clockwise: the rotation that brings the
    /// reference closest to them by weighted least squares.
    pub fn rotation(&self, positions: &[Vec<f64>; 2]) -> f64 {
        self.turn.angle(&self.reference, positions)
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
            Some(turn) => turned(turn.angle(&self.reference, positions)),
        };
        let length = self.length.now(positions, along);
        Extent { length, width: self.width.now(positions, [-across[1], across[0]]) }
    }
}

/// The outermost rows of points along a direction with [`SIDE_PART`] of all weights, at the lower
/// and at the upper side.
fn sides(points: &[Vec<f64>; 2], weights: &[f64], [x, y]: [f64; 2]) -> [Vec<usize>; 2] {
    let along: Vec<f64> = points[0].iter().zip(&points[1]).map(|(a, b)| a * x + b * y).collect();
    let mut order: Vec<usize> = (0..along.len()).collect();
    order.sort_by(|&a, &b| along[a].total_cmp(&along[b]));
    let least = SIDE_PART * weights.iter().sum::<f64>();
    let row = SAME_ROW * extent(points, [x, y]);
    let cap = |order: &mut dyn Iterator<Item = usize>| {
        let (mut cap, mut held) = (Vec::new(), 0.0);
        for point in order {
            let is_of_row =
                cap.last().is_some_and(|&last: &usize| (along[last] - along[point]).abs() <= row);
            if held >= least && !is_of_row && !cap.is_empty() {
                break;
            }
            held += weights[point];
            cap.push(point);
        }
        cap
    };
    [cap(&mut order.iter().copied()), cap(&mut order.iter().rev().copied())]
}

/// Shifts and rotates points (um, by axis) rigidly to where they are nearest to others by weighted
/// least squares.
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
/// If there are not as many points as others and weights.
pub fn laid_upon(points: &[Vec<f64>; 2], others: &[Vec<f64>; 2], weights: &[f64]) -> [Vec<f64>; 2] {
    let meter = ShapeMeter::new(points.clone(), [1.0, 0.0], weights);
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

/// Distance between the outermost points along a unit direction, um.
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
        let meter = ShapeMeter::new(points.clone(), [1.0, 0.0], &[1.0; 5]);
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

    /// A bar of 100 x 10 um, points 1 um apart, and the area of each.
    fn bar() -> ([Vec<f64>; 2], Vec<f64>) {
        let (mut points, mut areas) = ([Vec::new(), Vec::new()], Vec::new());
        for x in 0..=100 {
            for y in 0..=10 {
                points[0].push(f64::from(x));
                points[1].push(f64::from(y));
                let part = |at: i32, last: i32| if at == 0 || at == last { 0.5 } else { 1.0 };
                areas.push(part(x, 100) * part(y, 10));
            }
        }
        (points, areas)
    }

    #[test]
    fn an_even_strain_stretches_the_whole_length_and_width() {
        let (bar, areas) = bar();
        let meter = ShapeMeter::new(bar.clone(), [1.0, 0.0], &areas);
        assert_eq!(meter.measure(&bar), Extent { length: 100.0, width: 10.0 });
        for (along, across) in [(0.8799, 1.066), (0.5, 1.3), (1.1, 0.97)] {
            let strained = [
                bar[0].iter().map(|x| along * x).collect(),
                bar[1].iter().map(|y| across * y).collect(),
            ];
            let now = meter.measure(&strained);
            assert!((now.length - 100.0 * along).abs() < 1e-10, "{now:?}");
            assert!((now.width - 10.0 * across).abs() < 1e-10, "{now:?}");
        }
    }

    #[test]
    fn one_point_that_is_lost_hardly_moves_length_and_width() {
        let (bar, areas) = bar();
        let meter = ShapeMeter::new(bar.clone(), [1.0, 0.0], &areas);
        let mut shortened = [bar[0].iter().map(|x| 0.9 * x).collect::<Vec<f64>>(), bar[1].clone()];
        // One point of an end that stayed behind by 10 um, and one of a side that jumped by 3 um.
        let end = (0..bar[0].len()).find(|&at| bar[0][at] == 100.0 && bar[1][at] == 5.0).unwrap();
        shortened[0][end] += 10.0;
        let side = (0..bar[0].len()).find(|&at| bar[0][at] == 50.0 && bar[1][at] == 10.0).unwrap();
        shortened[1][side] += 3.0;
        let now = meter.measure(&shortened);
        // The cap has 66 points that count as 55, the side 101 that count as 50 and more: a share of the jump each.
        assert!((now.length - 90.0).abs() < 10.0 / 50.0, "{now:?}");
        assert!((now.width - 10.0).abs() < 0.05, "{now:?}");
        // From one extreme point to the other nothing of it would be left.
        assert!(extent(&shortened, [1.0, 0.0]) > 99.9 && extent(&shortened, [0.0, 1.0]) > 12.9);
    }

    #[test]
    fn what_clamps_hold_keeps_its_length() {
        let (bar, areas) = bar();
        for depths in [[5.0, 0.0], [5.0, 5.0], [0.0, 5.0], [0.0, 0.0]] {
            let meter = ShapeMeter::new(bar.clone(), [1.0, 0.0], &areas).gripped(depths);
            let [low, high] = [depths[0], 100.0 - depths[1]];
            for stretch in [0.8, 1.0, 1.2] {
                let place = |x: &f64| {
                    let free = x.clamp(low, high);
                    low + stretch * (free - low) + (x - free)
                };
                let now = [bar[0].iter().map(place).collect::<Vec<f64>>(), bar[1].clone()];
                let whole = extent(&now, [1.0, 0.0]);
                let length = meter.measure(&now).length;
                assert!((length - whole).abs() < 1e-10, "{depths:?}, {stretch}: {length}, {whole}");
            }
        }
    }

    #[test]
    fn points_without_weight_have_no_say_in_a_cap_unless_all_have_none() {
        let (bar, areas) = bar();
        let lost: Vec<usize> = (0..bar[0].len()).filter(|&at| bar[0][at] > 97.5).collect();
        let mut seen = areas.clone();
        for &point in &lost {
            seen[point] = 0.0;
        }
        let mut moved = bar.clone();
        for &point in &lost {
            moved[0][point] += 7.0;
        }
        let meter = ShapeMeter::new(bar.clone(), [1.0, 0.0], &seen);
        assert!((meter.measure(&moved).length - 100.0).abs() < 1e-10);
        let mut none = areas;
        for at in 0..bar[0].len() {
            none[at] *= f64::from(u8::from(bar[0][at] < 90.0));
        }
        let meter = ShapeMeter::new(bar.clone(), [1.0, 0.0], &none);
        assert!(meter.measure(&bar).length == 100.0 && meter.measure(&moved).length > 100.0);
    }

    #[test]
    fn a_bar_that_swings_about_its_end_keeps_its_width() {
        let bar = [vec![0.0, 10.0, 10.0, 0.0], vec![0.0, 0.0, 2.0, 2.0]];
        let held =
            ShapeMeter::new(bar.clone(), [1.0, 0.0], &[1.0; 4]).turned_by(&[1.0, 0.0, 0.0, 1.0]);
        let (sine, cosine) = 0.1_f64.sin_cos();
        let mut swung = bar.clone();
        for i in [1, 2] {
            swung[0][i] = 10.0 * cosine - sine * bar[1][i];
            swung[1][i] = 10.0 * sine + cosine * bar[1][i];
        }
        let before = held.measure(&swung);
        let now = held.width_turned_by(&[1.0; 4]).measure(&swung);
        // The held end has not turned: the swung one lies askew to its axis, so half of the width counts by its cosine.
        assert!((before.width - (1.0 + cosine)).abs() < 1e-12);
        assert!((now.width - 2.0).abs() < 0.02, "{now:?}");
        assert_eq!(now.length, before.length);
    }
}
