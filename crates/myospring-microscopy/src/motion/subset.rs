//! Matching one subset of the picture at rest in another frame: inverse-compositional Gauss-Newton
//! on the zero-normalised sum of squared differences, with translation and gradients free
//! (`baker_matthews_2004`, `pan_2013`), or translation alone.
#![allow(clippy::inline_always, reason = "code dispatched to wider vectors must be inlined")]

use super::spline::Spline;

/// Most steps of one search.
const MOST_STEPS: usize = 10;
/// Steps that shrink by a constant ratio (noise steepens the slopes) are combined into one; largest
/// factor of a combined step.
const MOST_TOGETHER: f32 = 3.0;
/// A search ends when its step moves no pixel of the subset by more than this part of the error due
/// to noise, limited to these bounds, pixels.
const SMALL_PART: f32 = 0.15;
const SMALL_STEPS: [f32; 2] = [0.005, 0.04];
/// A search that has not ended after all steps is accepted if its last step was below this, pixels.
const RESTLESS: f32 = 0.05;
/// Largest displacement gradient of a cell.
const STEEPEST: f32 = 0.5;
/// Least part of a subset that must be within the frame.
const LEAST_SEEN: f32 = 0.6;
/// Fewest pixels of a subset.
const FEWEST: usize = 40;
/// From this number of pixels on, every second pixel is used.
const DENSE: usize = 300;
/// Number of parallel partial sums, so that the compiler vectorises them.
const STRANDS: usize = 8;

/// Motion of a subset: `x + d` moves to `x + d + shift + gradient d`, pixels, y downward.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Warp {
    pub(crate) shift: [f32; 2],
    /// `gradient[a][b]` is the slope of shift `a` along axis `b`.
    pub(crate) gradient: [[f32; 2]; 2],
}

impl Warp {
    /// The shift at a distance from the middle.
    pub(crate) fn at(&self, [x, y]: [f32; 2]) -> [f32; 2] {
        [0, 1].map(|a: usize| self.shift[a] + self.gradient[a][0] * x + self.gradient[a][1] * y)
    }

    /// The warp with its shift in other pixels.
    pub(crate) fn scaled(&self, factor: f32) -> Self {
        Self { shift: self.shift.map(|shift| factor * shift), ..*self }
    }

    /// This warp composed with the inverse of a small one; `None` if that would turn the subset
    /// over.
    fn after_inverse(&self, step: &Self) -> Option<Self> {
        let [[a, b], [c, d]] = step.gradient;
        let (a, d) = (1.0 + a, 1.0 + d);
        let determinant = a * d - b * c;
        if determinant.is_nan() || determinant < 0.1 {
            return None;
        }
        let inverse = [[d / determinant, -b / determinant], [-c / determinant, a / determinant]];
        let back =
            [0, 1].map(|i: usize| -(inverse[i][0] * step.shift[0] + inverse[i][1] * step.shift[1]));
        let own = [
            [1.0 + self.gradient[0][0], self.gradient[0][1]],
            [self.gradient[1][0], 1.0 + self.gradient[1][1]],
        ];
        let product = |i: usize, j: usize| own[i][0] * inverse[0][j] + own[i][1] * inverse[1][j];
        Some(Self {
            shift: [0, 1].map(|i: usize| self.shift[i] + own[i][0] * back[0] + own[i][1] * back[1]),
            gradient: [[product(0, 0) - 1.0, product(0, 1)], [product(1, 0), product(1, 1) - 1.0]],
        })
    }
}

/// Where a subset was found.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    pub(crate) warp: Warp,
    /// Zero-normalised cross-correlation, -1 to 1.
    pub(crate) correlation: f32,
}

/// A search for the processor's widest vectors. A closure would not do: the call of one is compiled on its own, without them.
struct Search<'a> {
    subset: &'a Subset,
    now: &'a Spline,
    start: &'a Warp,
    room: &'a mut Vec<f32>,
}

impl pulp::WithSimd for Search<'_> {
    type Output = Option<Found>;

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) -> Option<Found> {
        self.subset.search(self.now, self.start, self.room)
    }
}

/// Pixels of the picture at rest.
struct Pixels {
    /// Distances from the middle.
    x: Vec<f32>,
    y: Vec<f32>,
    /// Grey values and their slopes along both axes.
    values: [Vec<f32>; 3],
}

impl Pixels {
    /// The pixels of a square that are taken.
    fn of(
        rest: &Spline,
        middle: [f32; 2],
        half: usize,
        is_taken: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let [width, height] = rest.size();
        let [column, row] = middle.map(|place| place as usize);
        let mut found = Self { x: Vec::new(), y: Vec::new(), values: Default::default() };
        for r in row.saturating_sub(half)..(row + half + 1).min(height) {
            for c in column.saturating_sub(half)..(column + half + 1).min(width) {
                if is_taken(c, r) {
                    found.x.push(c as f32 - middle[0]);
                    found.y.push(r as f32 - middle[1]);
                    for (into, value) in found.values.iter_mut().zip(rest.at_pixel(c, r)) {
                        into.push(value);
                    }
                }
            }
        }
        found
    }
}

/// The pixel nearest to a point, if it is within the picture.
fn pixel_at(point: [f32; 2], [width, height]: [usize; 2]) -> Option<[f32; 2]> {
    let middle = point.map(f32::round);
    let within = middle[0] >= 0.0
        && middle[1] >= 0.0
        && middle[0] < width as f32
        && middle[1] < height as f32;
    within.then_some(middle)
}

/// The pixels around a point at rest.
#[derive(Debug, Clone)]
pub(crate) struct Subset {
    /// Pixel at the centre.
    centre: [f32; 2],
    /// From that pixel to the point.
    offset: [f32; 2],
    /// Distances from the centre.
    x: Vec<f32>,
    y: Vec<f32>,
    /// Grey values minus their mean, divided by their norm.
    grey: Vec<f32>,
    /// Slopes divided by that norm.
    slope_x: Vec<f32>,
    slope_y: Vec<f32>,
    /// Inverse of the matrix of the normal equations.
    inverse: [[f32; 6]; 6],
    half: f32,
    /// Standard error of the shift in its worst direction per standard deviation of the noise, pixels per grey level.
    pub(crate) sensitivity: f32,
    /// A search ends when its step moves no pixel by more than this, pixels.
    small_step: f32,
    /// Variance of the grey values.
    pub(crate) variance: f32,
}

impl Subset {
    /// The allowed pixels of a square around a point, with gradients free; `None` if they are too few or have no contrast.
    pub(crate) fn new(
        rest: &Spline,
        point: [f32; 2],
        half: usize,
        allowed: &[bool],
        noise: f32,
    ) -> Option<Self> {
        let [width, height] = rest.size();
        let middle = pixel_at(point, [width, height])?;
        let [column, row] = middle.map(|place| place as usize);
        // As on a chessboard: after the blur, the other pixels add no information.
        let thin = (2 * half + 1).pow(2) > DENSE;
        let is_taken = |c: usize, r: usize| {
            allowed[r * width + c] && !(thin && (r + c + row + column) % 2 == 1)
        };
        let pixels = Pixels::of(rest, middle, half, is_taken);
        let whole = (2 * half + 1).pow(2) / if thin { 2 } else { 1 };
        if pixels.x.len() < FEWEST.max(whole / 4) {
            return None;
        }
        Self::of(pixels, point, middle, half, noise, |gx, gy, dx, dy| {
            [gx, gx * dx, gx * dy, gy, gy * dx, gy * dy]
        })
    }

    /// The pixels around a point that are `inside` a body, which gets their distances from the point; the body is rigid and does
    /// not turn, so gradients stay 0. `half` is the largest of these distances along an axis, rounded up. `None` if the pixels
    /// are too few or have no contrast.
    pub(crate) fn rigid(
        rest: &Spline,
        point: [f32; 2],
        half: usize,
        inside: impl Fn([f32; 2]) -> bool,
        noise: f32,
    ) -> Option<Self> {
        let middle = pixel_at(point, rest.size())?;
        let is_taken = |c: usize, r: usize| inside([c as f32 - point[0], r as f32 - point[1]]);
        let pixels = Pixels::of(rest, middle, half, is_taken);
        if pixels.x.len() < FEWEST {
            return None;
        }
        let mut subset = Self::of(pixels, point, middle, half, noise, |gx, gy, _, _| {
            [gx, 0.0, 0.0, gy, 0.0, 0.0]
        })?;
        for gradient in [1, 2, 4, 5] {
            subset.inverse[gradient] = [0.0; 6];
        }
        Some(subset)
    }

    /// Normalises the pixels. `descent` gives the derivatives of a grey value by the six unknowns, from its slopes and distances.
    fn of(
        pixels: Pixels,
        point: [f32; 2],
        middle: [f32; 2],
        half: usize,
        noise: f32,
        descent: impl Fn(f64, f64, f64, f64) -> [f64; 6],
    ) -> Option<Self> {
        let Pixels { x, y, values: [mut grey, mut slope_x, mut slope_y] } = pixels;
        let count = x.len();
        let mean = grey.iter().sum::<f32>() / count as f32;
        for value in &mut grey {
            *value -= mean;
        }
        let norm = grey.iter().map(|value| value * value).sum::<f32>().sqrt();
        if norm.is_nan() || norm <= 1e-6 {
            return None;
        }
        for list in [&mut grey, &mut slope_x, &mut slope_y] {
            for value in list.iter_mut() {
                *value /= norm;
            }
        }
        let mut normal = [[0.0_f64; 6]; 6];
        for k in 0..count {
            let [gx, gy, dx, dy] = [slope_x[k], slope_y[k], x[k], y[k]].map(f64::from);
            let descent = descent(gx, gy, dx, dy);
            for i in 0..6 {
                for j in 0..6 {
                    normal[i][j] += descent[i] * descent[j];
                }
            }
        }
        for (i, row) in normal.iter_mut().enumerate() {
            if row[i] == 0.0 {
                // An unknown that is not free: any other number keeps the matrix regular.
                row[i] = 1.0;
            }
        }
        let inverse = inverted(normal)?;
        let [a, b, d] = [inverse[0][0], inverse[0][3], inverse[3][3]];
        let worst = f64::midpoint(a, d) + (0.25 * (a - d).powi(2) + b * b).sqrt();
        // Both pictures are noisy.
        let sensitivity = ((2.0 * worst).sqrt() / f64::from(norm)) as f32;
        let [least, most] = SMALL_STEPS;
        Some(Self {
            centre: middle,
            small_step: (SMALL_PART * sensitivity * noise).clamp(least, most),
            offset: [point[0] - middle[0], point[1] - middle[1]],
            inverse: inverse.map(|row| row.map(|value| value as f32)),
            half: half as f32,
            sensitivity,
            variance: norm * norm / count as f32,
            x,
            y,
            grey,
            slope_x,
            slope_y,
        })
    }

    /// Number of its pixels.
    pub(crate) fn pixels(&self) -> usize {
        self.x.len()
    }

    /// Searches the subset from a start; `start` and the result are shifts of the point itself.
    pub(crate) fn find(&self, now: &Spline, start: &Warp, room: &mut Vec<f32>) -> Option<Found> {
        // Uses the widest vectors of the processor; the order of summation is always the same.
        pulp::Arch::new().dispatch(Search { subset: self, now, start, room })
    }

    #[inline(always)]
    fn search(&self, now: &Spline, start: &Warp, room: &mut Vec<f32>) -> Option<Found> {
        let back = self.offset.map(|offset| -offset);
        let mut warp = Warp { shift: start.at(back), gradient: start.gradient };
        let count = self.x.len();
        let (mut taken, mut before) = (None, None);
        for _ in 0..MOST_STEPS {
            let correlation = self.compare(now, &warp, room)?;
            let sums = self.descent(&room[..count]);
            let by =
                |i: usize| -> f32 { self.inverse[i].iter().zip(&sums).map(|(a, b)| a * b).sum() };
            let mut steps = [0, 1, 2, 3, 4, 5].map(by);
            if let Some(before) = before.take() {
                let ratio = self.alike(&steps, &before) / self.alike(&before, &before);
                if ratio > 0.0 {
                    let together = (1.0 - ratio).recip().clamp(1.0, MOST_TOGETHER);
                    steps = steps.map(|step| together * step);
                }
            } else {
                before = Some(steps);
            }
            let step = Warp {
                shift: [steps[0], steps[3]],
                gradient: [[steps[1], steps[2]], [steps[4], steps[5]]],
            };
            let of = |a: usize| {
                step.shift[a].abs()
                    + self.half * (step.gradient[a][0].abs() + step.gradient[a][1].abs())
            };
            let size = of(0).max(of(1));
            // A longer step would leave the subset.
            if size.is_nan() || step.shift[0].hypot(step.shift[1]) > 2.0 * self.half {
                return None;
            }
            warp = warp.after_inverse(&step)?;
            if warp.gradient.as_flattened().iter().any(|slope| slope.abs() > STEEPEST) {
                return None;
            }
            if size < RESTLESS {
                // The last step has hardly changed the correlation.
                let shift = warp.at(self.offset);
                taken = Some(Found { warp: Warp { shift, ..warp }, correlation });
            }
            if size < self.small_step {
                break;
            }
        }
        taken
    }

    /// Scalar product of two steps; gradients are weighted by the displacement they cause at the
    /// subset's rim.
    fn alike(&self, a: &[f32; 6], b: &[f32; 6]) -> f32 {
        let weigh = |at: usize| if at.is_multiple_of(3) { 1.0 } else { self.half * self.half };
        (0..6).map(|at| weigh(at) * a[at] * b[at]).sum()
    }

    /// Writes the residual (normalised grey values now minus at rest) into `room` and returns the
    /// correlation; `None` if too little of the subset is in the frame.
    #[inline(always)]
    fn compare(&self, now: &Spline, warp: &Warp, room: &mut Vec<f32>) -> Option<f32> {
        let count = self.x.len();
        let [cx, cy] = [0, 1].map(|a: usize| self.centre[a] + warp.shift[a]);
        let [[xx, xy], [yx, yy]] = warp.gradient;
        room.clear();
        let (xs, x_rest) = self.x.as_chunks::<STRANDS>();
        let (ys, y_rest) = self.y.as_chunks::<STRANDS>();
        let places = |xs: &[f32; STRANDS], ys: &[f32; STRANDS]| -> [[f32; STRANDS]; 2] {
            let mut to = [[0.0; STRANDS]; 2];
            for k in 0..STRANDS {
                let (x, y) = (xs[k], ys[k]);
                to[0][k] = cx + x + xx * x + xy * y;
                to[1][k] = cy + y + yx * x + yy * y;
            }
            to
        };
        for (xs, ys) in xs.iter().zip(ys) {
            let [to_x, to_y] = places(xs, ys);
            room.extend_from_slice(&now.at_eight(&to_x, &to_y));
        }
        let (mut xs, mut ys) = ([0.0; STRANDS], [0.0; STRANDS]);
        xs[..x_rest.len()].copy_from_slice(x_rest);
        ys[..y_rest.len()].copy_from_slice(y_rest);
        let [to_x, to_y] = places(&xs, &ys);
        room.extend_from_slice(&now.at_eight(&to_x, &to_y)[..x_rest.len()]);
        let outside = room.iter().filter(|value| value.is_nan()).count();
        let seen = (count - outside) as f32;
        if seen < LEAST_SEEN * count as f32 {
            return None;
        }
        let (mut rest_mean, mut rest_scale) = (0.0, 1.0);
        if outside > 0 {
            // Pixels outside the frame are left out of both pictures.
            let both = || self.grey.iter().zip(room.iter()).filter(|(_, now)| !now.is_nan());
            rest_mean = both().map(|(rest, _)| rest).sum::<f32>() / seen;
            let norm = both().map(|(rest, _)| (rest - rest_mean).powi(2)).sum::<f32>().sqrt();
            rest_scale = 1.0 / norm.max(1e-6);
        }
        let valid = || room.iter().filter(|value| !value.is_nan());
        let mean = if outside > 0 { valid().sum::<f32>() } else { total(room) } / seen;
        let squares = if outside > 0 {
            valid().map(|value| (value - mean).powi(2)).sum::<f32>()
        } else {
            total_of(room, |value| (value - mean) * (value - mean))
        };
        let scale = 1.0 / squares.sqrt();
        if !scale.is_finite() {
            return None;
        }
        for (value, rest) in room.iter_mut().zip(&self.grey) {
            *value = (*value - mean) * scale - (rest - rest_mean) * rest_scale;
        }
        if outside > 0 {
            room.iter_mut().filter(|value| value.is_nan()).for_each(|value| *value = 0.0);
        }
        Some(1.0 - 0.5 * total_of(room, |value| value * value))
    }

    /// Projections of the residual onto the steepest-descent images.
    #[inline(always)]
    fn descent(&self, differences: &[f32]) -> [f32; 6] {
        let mut sums = [[0.0_f32; STRANDS]; 6];
        let lists = [&self.x, &self.y, &self.slope_x, &self.slope_y];
        let [xs, ys, gxs, gys] = lists.map(|list| list.as_chunks::<STRANDS>());
        let (chunks, rest) = differences.as_chunks::<STRANDS>();
        let mut add = |at: usize, x: f32, y: f32, gx: f32, gy: f32, off: f32| {
            let (a, b) = (gx * off, gy * off);
            sums[0][at] += a;
            sums[1][at] += a * x;
            sums[2][at] += a * y;
            sums[3][at] += b;
            sums[4][at] += b * x;
            sums[5][at] += b * y;
        };
        for (k, off) in chunks.iter().enumerate() {
            let (x, y, gx, gy) = (&xs.0[k], &ys.0[k], &gxs.0[k], &gys.0[k]);
            for at in 0..STRANDS {
                add(at, x[at], y[at], gx[at], gy[at], off[at]);
            }
        }
        for (at, off) in rest.iter().enumerate() {
            add(at, xs.1[at], ys.1[at], gxs.1[at], gys.1[at], *off);
        }
        sums.map(|strands| strands.iter().sum())
    }
}

#[inline(always)]
fn total(values: &[f32]) -> f32 {
    total_of(values, |value| value)
}

#[inline(always)]
fn total_of(values: &[f32], of: impl Fn(f32) -> f32) -> f32 {
    let (chunks, rest) = values.as_chunks::<STRANDS>();
    let mut sums = [0.0_f32; STRANDS];
    for chunk in chunks {
        for (sum, &value) in sums.iter_mut().zip(chunk) {
            *sum += of(value);
        }
    }
    sums.iter().sum::<f32>() + rest.iter().map(|&value| of(value)).sum::<f32>()
}

/// The inverse of a symmetric matrix by Gauss-Jordan elimination with pivoting; `None` if it is
/// nearly singular.
fn inverted(mut matrix: [[f64; 6]; 6]) -> Option<[[f64; 6]; 6]> {
    let mut inverse = [[0.0; 6]; 6];
    for (i, row) in inverse.iter_mut().enumerate() {
        row[i] = 1.0;
    }
    let largest = (0..6).map(|i| matrix[i][i]).fold(0.0, f64::max);
    for column in 0..6 {
        let pivot = (column..6)
            .max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        if matrix[pivot][column].abs() < 1e-12 * largest || largest == 0.0 {
            return None;
        }
        matrix.swap(column, pivot);
        inverse.swap(column, pivot);
        let scale = matrix[column][column].recip();
        for j in 0..6 {
            matrix[column][j] *= scale;
            inverse[column][j] *= scale;
        }
        for i in (0..6).filter(|&i| i != column) {
            let factor = matrix[i][column];
            for j in 0..6 {
                matrix[i][j] -= factor * matrix[column][j];
                inverse[i][j] -= factor * inverse[column][j];
            }
        }
    }
    Some(inverse)
}
