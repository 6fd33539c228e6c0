//! One post in one frame, found again in others.
//!
//! On a coarse grid, on which the post is some ten pixels wide, the normalised cross-correlation of all shifts within reach gives
//! the best one. [`Subset::rigid`] refines it on the pixels of the film, and also starts from the place in the last frame; the
//! better result counts. A post keeps its shape and does not turn, so a shift describes its motion.

use super::coarse::Coarse;
use super::post::Body;
use super::window::Window;
use crate::filter;
use crate::motion::spline::Spline;
use crate::motion::subset::{Subset, Warp};
use crate::plane::Plane;
use std::f64::consts::PI;

/// Blur before comparison, pixels: single pixels are mostly noise, whose slopes would shorten every step.
const SMOOTHING: f64 = 0.8;
/// Width of a post on the coarse grid, its pixels.
const COARSE: f64 = 10.0;
/// Least correlation: as a part of the correlation that is expected with this noise.
const LEAST_PART: f64 = 0.5;
/// Least correlation, standard deviations of that which chance gives (Fisher's transform): about one of 30,000 places that have
/// nothing to do with the post correlates better.
const CHANCE: f64 = 4.0;

/// A post in the frame with which others are compared.
#[derive(Debug)]
pub(super) struct Patch {
    middle: [f64; 2],
    body: Body,
    fine: Subset,
    factor: usize,
    coarse: Coarse,
    /// Least correlation with which it counts as found.
    least: f64,
    /// Farthest that it is sought from its place in the frame before, along each axis, pixels.
    far: f64,
}

/// A post in a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    /// Shift from its place in the frame with which it is compared, pixels, to the right and downward.
    pub(super) shift: [f64; 2],
    /// Zero-normalised cross-correlation.
    pub(super) correlation: f64,
    /// Standard error of the shift in its worst direction, from the residual of the match, pixels.
    pub(super) error: f64,
}

impl Patch {
    /// A post around `middle`, sought up to `far` pixels from where it was last; `noise` is the standard deviation of the grey
    /// values' noise. `Err` has the standard deviation of its grey values, if these have too little structure.
    pub(super) fn new(
        plane: &Plane,
        middle: [f64; 2],
        body: Body,
        far: f64,
        noise: f64,
    ) -> Result<Self, f64> {
        let reach = body.reach();
        let window = Window::around(plane, middle, reach + 4);
        let own = window.own(middle);
        let blurred = noise / (2.0 * PI.sqrt() * SMOOTHING);
        let spline = Spline::of(&filter::gaussian(&window.plane, SMOOTHING));
        let inside = |at: [f32; 2]| body.has(at);
        let fine = Subset::rigid(&spline, own.map(|at| at as f32), reach, inside, blurred as f32)
            .ok_or(0.0)?;
        let variance = f64::from(fine.variance);
        // The post must be seen better than to half a pixel, given the noise.
        if f64::from(fine.sensitivity) * blurred * correlated() > 0.5 {
            return Err(variance.sqrt());
        }
        let factor = ((2 * reach) as f64 / COARSE).floor().max(1.0) as usize;
        let coarse = Coarse::of(plane, middle, &body, factor).ok_or(variance.sqrt())?;
        let expected = (1.0 - blurred * blurred / variance).clamp(0.2, 1.0);
        let independent = fine.pixels() as f64 / (4.0 * PI * SMOOTHING * SMOOTHING);
        let chance = (CHANCE / (independent - 3.0).max(1.0).sqrt()).tanh();
        let least = (LEAST_PART * expected).max(chance);
        Ok(Self { middle, body, fine, factor, coarse, least, far })
    }

    /// Finds the post in a frame, near a shift from its place; `None` if nothing correlates well enough. The second value is the
    /// best correlation, also if it was too low; `None` if there was nothing to compare.
    pub(super) fn find(&self, plane: &Plane, near: [f64; 2]) -> (Option<Seen>, Option<f64>) {
        let place = [0, 1].map(|k: usize| self.middle[k] + near[k]);
        let room = self.far.ceil() as usize + self.body.reach() + 2 * self.factor + 4;
        let window = Window::around(plane, place, room);
        let spline = Spline::of(&filter::gaussian(&window.plane, SMOOTHING));
        let coarse = self.coarse.find(plane, self.middle, near, self.far, self.factor);
        // The subset's own middle is in the pixels of its own window, a whole number of pixels from those of this one.
        let own = Window::origin(plane, self.middle, self.body.reach() + 4);
        let moved = [0, 1].map(|k: usize| own[k] as f64 - window.first[k] as f64);
        let mut scratch = Vec::new();
        let mut best: Option<(Warp, f32)> = None;
        for start in coarse.into_iter().chain([near]) {
            let shift = [0, 1].map(|k: usize| (start[k] + moved[k]) as f32);
            let from = Warp { shift, ..Warp::default() };
            if let Some(found) = self.fine.find(&spline, &from, &mut scratch)
                && best.is_none_or(|(_, before)| found.correlation > before)
            {
                best = Some((found.warp, found.correlation));
            }
        }
        let Some((warp, correlation)) = best else { return (None, None) };
        let correlation = f64::from(correlation);
        let shift = [0, 1].map(|k: usize| f64::from(warp.shift[k]) - moved[k]);
        let residual = ((1.0 - correlation).max(0.0) * f64::from(self.fine.variance)).sqrt();
        let error = f64::from(self.fine.sensitivity) * residual * correlated();
        let is_near = (0..2).all(|k| (shift[k] - near[k]).abs() <= self.far + self.factor as f64);
        let seen = Seen { shift, correlation, error };
        ((correlation >= self.least && is_near).then_some(seen), Some(correlation))
    }
}

/// Factor by which the error of a shift is larger because neighbouring pixels share their noise after the blur.
fn correlated() -> f64 {
    2.0 * PI.sqrt() * SMOOTHING
}
