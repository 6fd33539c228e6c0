//! Brightness and texture on the grid on which cells are separated.

use super::piece::Piece;
use crate::filter;
use crate::plane::Plane;

/// Scale of smoothing, um: stripes and rows of myofibrils, up to 2.6 um apart, vanish; the dark
/// line between two membranes remains.
const SMOOTH_UM: f64 = 1.0;
/// Scale on which the gradient of stripes is seen, um.
const STRIPES_UM: f64 = 0.4;
/// Coarsest pixel that shows stripes, um.
const COARSEST_UM: f64 = 0.7;

/// The data in which a region was found, on the same grid.
pub(in crate::segment) struct Seen<'a> {
    /// Brightness, neither smoothed nor with gaps filled.
    pub(in crate::segment) brightness: &'a Plane,
    /// Brightness without light.
    pub(in crate::segment) dark: f32,
    /// Side of a pixel, um.
    pub(in crate::segment) pixel_um: f64,
    /// Smallest area of a cell, um^2.
    pub(in crate::segment) smallest_um2: f64,
}

/// Brightness on the grid of the parts, with the data from which texture is read.
pub(super) struct Light<'a> {
    pub(super) pixel_um: f64,
    bright: Plane,
    seen: &'a Seen<'a>,
    factor: usize,
}

/// The structure tensor of the texture of a piece.
pub(super) struct Texture {
    corner: [usize; 2],
    /// Difference and sum of the squares of the gradient along rows and down columns, and twice their product.
    planes: [Plane; 3],
}

impl<'a> Light<'a> {
    pub(super) fn of(seen: &'a Seen<'a>, factor: usize) -> Self {
        let pixel_um = seen.pixel_um * factor as f64;
        let coarse = filter::coarse(seen.brightness, factor).map(|value| value - seen.dark);
        Self { pixel_um, bright: filter::gaussian(&coarse, SMOOTH_UM / pixel_um), seen, factor }
    }

    /// Brightness at a place, by linear interpolation.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> f64 {
        let (width, height) = (self.bright.width(), self.bright.height());
        let (x, y) = (x.clamp(0.0, (width - 1) as f64), y.clamp(0.0, (height - 1) as f64));
        let (column, row) = (x as usize, y as usize);
        let (right, below) = ((column + 1).min(width - 1), (row + 1).min(height - 1));
        let (u, v) = (x - column as f64, y - row as f64);
        let values = self.bright.values();
        let value = |column, row| f64::from(values[row * width + column]);
        let upper = value(column, row) * (1.0 - u) + value(right, row) * u;
        let lower = value(column, below) * (1.0 - u) + value(right, below) * u;
        upper * (1.0 - v) + lower * v
    }

    /// The texture within a piece; `None` if pixels are too coarse for stripes.
    pub(super) fn texture(&self, piece: &Piece) -> Option<Texture> {
        let Seen { brightness, pixel_um, .. } = self.seen;
        if *pixel_um > COARSEST_UM {
            return None;
        }
        let (width, height) = (brightness.width(), brightness.height());
        let corner = piece.corner;
        let [left, top] = corner.map(|at| at * self.factor);
        let end = |from: usize, cells: usize, most: usize| (from + cells * self.factor).min(most);
        let (right, bottom) = (end(left, piece.width, width), end(top, piece.height(), height));
        let rows = (top..bottom).flat_map(|row| &brightness.values()[row * width..][left..right]);
        let part = Plane::new(right - left, bottom - top, rows.copied().collect())?;
        let smooth = filter::gaussian(&part, STRIPES_UM / pixel_um);
        let [along, down] = filter::slopes(&smooth);
        let of = |value: &dyn Fn(f32, f32) -> f32| {
            let values = along.iter().zip(&down).map(|(x, y)| value(*x, *y)).collect();
            let plane = Plane::new(smooth.width(), smooth.height(), values)?;
            Some(filter::coarse(&plane, self.factor))
        };
        let planes =
            [of(&|x, y| x * x - y * y)?, of(&|x, y| x * x + y * y)?, of(&|x, y| 2.0 * x * y)?];
        Some(Texture { corner, planes })
    }
}

impl Texture {
    /// Difference, sum and product at a place of the picture.
    pub(super) fn at(&self, [x, y]: [f64; 2]) -> [f64; 3] {
        let (column, row) = (x as usize - self.corner[0], y as usize - self.corner[1]);
        self.planes.each_ref().map(|plane| f64::from(plane.at(column, row)))
    }
}
