//! Compact objects in a frame: places around which the brightness steps inward, or outward, on all sides.
//!
//! On a circle around a place, the slopes of the grey values along its radii are all positive around a bright object of this
//! size, whatever its inside looks like, and negative around a dark one; across a stripe or along an edge they are so on two sides
//! at most. The **strength** of an object is the step in brightness that is reached or exceeded on three quarters of the circle,
//! in grey levels. A square counts, too: blurred by a part of its diameter, its sides lie near the circle.

use super::circle;
use crate::filter;
use crate::plane::Plane;
use rayon::prelude::*;
use std::f64::consts::PI;

/// Smallest diameter that is tried, pixels, and as a part of the frame's longer side: a tissue and its posts fill the frame.
const SMALLEST: f64 = 7.0;
const SMALLEST_PART: f64 = 1.0 / 80.0;
/// Factor from one diameter to the next.
const NEXT: f64 = 1.12;
/// Diameter on the coarse grid, its pixels, at least.
const COARSE: f64 = 8.0;
/// Blur as a part of the diameter, and at least, coarse pixels.
const BLUR: f64 = 0.08;
const LEAST_BLUR: f64 = 0.5;
/// Number of objects of each brightness that are returned.
const MOST: usize = 400;

/// A compact object.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Blob {
    /// Step in brightness on three quarters of its edge, grey levels.
    pub(super) strength: f64,
    /// Whether it is brighter than what is around it.
    pub(super) bright: bool,
    /// Pixels.
    pub(super) diameter: f64,
    /// Column and row.
    pub(super) middle: [f64; 2],
    /// Number of its diameter.
    scale: usize,
}

impl Blob {
    /// Distance of the middles, pixels.
    pub(super) fn distance(&self, other: &Self) -> f64 {
        (self.middle[0] - other.middle[0]).hypot(self.middle[1] - other.middle[1])
    }
}

/// Range of diameters that are tried, pixels.
pub(super) fn diameters([width, height]: [usize; 2]) -> [f64; 2] {
    let smallest = SMALLEST.max(SMALLEST_PART * width.max(height) as f64);
    [smallest, (width.min(height) as f64).max(smallest)]
}

/// A frame at the resolution of one diameter.
#[derive(Debug)]
struct Scale {
    /// Pixels.
    diameter: f64,
    /// Pixels of the frame along the side of one pixel here.
    factor: usize,
    size: [usize; 2],
    /// Slopes along rows and down columns, grey levels: the largest of a step of height 1 is 1.
    slopes: [Vec<f32>; 2],
}

impl Scale {
    fn of(plane: &Plane, diameter: f64) -> Self {
        let factor = (diameter / COARSE).floor().max(1.0) as usize;
        let blur = BLUR * diameter / factor as f64 + LEAST_BLUR;
        let smooth = filter::gaussian(&filter::coarse(plane, factor), blur);
        // A step of height 1 that is blurred by a Gaussian has the inverse of this slope.
        let step = ((2.0 * PI).sqrt() * blur) as f32;
        let smooth = smooth.map(|value| step * value);
        let size = [smooth.width(), smooth.height()];
        Self { diameter, factor, size, slopes: filter::slopes(&smooth) }
    }

    /// The objects of this diameter: the places that are stronger than the eight around them.
    fn blobs(&self, scale: usize) -> Vec<Blob> {
        let [width, height] = self.size;
        let diameter = self.diameter / self.factor as f64;
        let strengths = circle::strengths(&self.slopes, self.size, diameter);
        let mut found = Vec::new();
        for (bright, map) in [(false, &strengths[0]), (true, &strengths[1])] {
            for row in 1..height.saturating_sub(1) {
                for column in 1..width - 1 {
                    let at = row * width + column;
                    let strength = map[at];
                    let around = (row - 1..=row + 1)
                        .flat_map(|r| map[r * width + column - 1..=r * width + column + 1].iter());
                    if strength <= 0.0 || around.copied().fold(0.0, f32::max) > strength {
                        continue;
                    }
                    let past = [[map[at - 1], map[at + 1]], [map[at - width], map[at + width]]]
                        .map(|beside| top(beside, strength));
                    let middle = [column as f64 + past[0], row as f64 + past[1]]
                        .map(|at| (at + 0.5) * self.factor as f64 - 0.5);
                    let (strength, diameter) = (f64::from(strength), self.diameter);
                    found.push(Blob { strength, bright, diameter, middle, scale });
                }
            }
        }
        found
    }
}

/// The most distinct compact objects of a frame, strongest first. One thing may be several objects of different diameters.
#[derive(Debug)]
pub(super) struct Blobs {
    scales: Vec<Scale>,
    pub(super) all: Vec<Blob>,
}

impl Blobs {
    /// Searches a frame.
    pub(super) fn of(plane: &Plane) -> Self {
        let [smallest, largest] = diameters([plane.width(), plane.height()]);
        let ladder = std::iter::successors(Some(smallest), |diameter| Some(diameter * NEXT));
        let ladder: Vec<f64> = ladder.take_while(|diameter| *diameter <= largest).collect();
        let scales: Vec<Scale> =
            ladder.par_iter().map(|&diameter| Scale::of(plane, diameter)).collect();
        let found = scales.par_iter().enumerate().flat_map_iter(|(at, scale)| scale.blobs(at));
        let mut all: Vec<Blob> = found.collect();
        all.sort_by(|a, b| b.strength.total_cmp(&a.strength));
        let mut counts = [0; 2];
        all.retain(|blob| {
            let count = &mut counts[usize::from(blob.bright)];
            *count += 1;
            *count <= MOST
        });
        Self { scales, all }
    }

    /// Step in brightness on three quarters of the side of an object that faces another place, grey levels; positive if it is as
    /// on the rest of the edge.
    pub(super) fn facing(&self, blob: &Blob, place: [f64; 2]) -> f64 {
        let Scale { diameter, factor, size, slopes } = &self.scales[blob.scale];
        let own = blob.middle.map(|at| (at + 0.5) / *factor as f64 - 0.5);
        let direction = (place[1] - blob.middle[1]).atan2(place[0] - blob.middle[0]);
        let side = (direction, blob.bright);
        circle::facing(slopes, *size, diameter / *factor as f64, own, side)
    }
}

/// How far the top of a parabola through three values at distance 1 is past the middle one, which is the largest.
fn top([before, after]: [f32; 2], middle: f32) -> f64 {
    let bend = 2.0 * middle - before - after;
    if bend > 0.0 { f64::from((after - before) / (2.0 * bend)).clamp(-0.5, 0.5) } else { 0.0 }
}
