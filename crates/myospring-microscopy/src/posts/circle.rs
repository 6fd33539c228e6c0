//! Slopes of the grey values along the radii of circles.

use crate::filter;
use std::f64::consts::{FRAC_PI_6, TAU};

/// Number of radii, and of those on which the step may be smaller.
const RADII: usize = 16;
const SMALLER: usize = RADII / 4;
/// Part of the diameter by which the circle may leave the frame.
const BEYOND: f64 = 0.1;
/// Number of radii to each side of a direction, and the angle that they cover: the corners of a square that faces the direction are
/// beyond it.
const FACING: i32 = 4;
const TO_EACH_SIDE: f64 = FRAC_PI_6;

/// Slope along the radii of a circle around each pixel that is reached on all but a quarter of them: outward for dark objects,
/// inward for bright ones; 0 where there is none.
pub(super) fn strengths(slopes: &[Vec<f32>; 2], size: [usize; 2], diameter: f64) -> [Vec<f32>; 2] {
    let [width, height] = size;
    let mut maps = [vec![0.0; width * height], vec![0.0; width * height]];
    let samples: Vec<Sample> = (0..RADII)
        .map(|ray| Sample::new(TAU * ray as f64 / RADII as f64, 0.5 * diameter))
        .collect();
    let beyond = (BEYOND * diameter) as f32;
    let mut along = vec![[0.0_f32; RADII]; width];
    for row in 0..height {
        along.fill([0.0; RADII]);
        for (ray, sample) in samples.iter().enumerate() {
            let Some(line) = sample.line(row as f32, height, beyond) else { continue };
            for (column, along) in along.iter_mut().enumerate() {
                along[ray] =
                    sample.slope(slopes, line, column as f32, width, beyond).unwrap_or(0.0);
            }
        }
        for (column, along) in along.iter_mut().enumerate() {
            along.sort_unstable_by(f32::total_cmp);
            maps[0][row * width + column] = along[SMALLER].max(0.0);
            maps[1][row * width + column] = (-along[RADII - 1 - SMALLER]).max(0.0);
        }
    }
    maps
}

/// Slope outward that three quarters of the radii around a direction have at least, an angle from the right downward; inward where
/// `bright`.
pub(super) fn facing(
    slopes: &[Vec<f32>; 2],
    [width, height]: [usize; 2],
    diameter: f64,
    [column, row]: [f64; 2],
    (direction, bright): (f64, bool),
) -> f64 {
    let beyond = (BEYOND * diameter) as f32;
    let slope = |ray: i32| {
        let angle = direction + f64::from(ray) / f64::from(FACING) * TO_EACH_SIDE;
        let sample = Sample::new(angle, 0.5 * diameter);
        let line = sample.line(row as f32, height, beyond)?;
        let slope = sample.slope(slopes, line, column as f32, width, beyond)?;
        Some(if bright { -slope } else { slope })
    };
    let slopes: Vec<f32> = (-FACING..=FACING).filter_map(slope).collect();
    f64::from(filter::quantile(&slopes, 0.25))
}

/// Where a slope is taken, relative to the middle of a circle.
struct Sample {
    normal: [f32; 2],
    off: [f32; 2],
}

impl Sample {
    fn new(angle: f64, radius: f64) -> Self {
        let normal = [angle.cos(), angle.sin()];
        Self {
            normal: normal.map(|part| part as f32),
            off: normal.map(|part| (part * radius) as f32),
        }
    }

    /// The row above and how far below it the place is, for a middle in a given row; `None` outside the frame.
    fn line(&self, row: f32, height: usize, beyond: f32) -> Option<(usize, f32)> {
        let (y, last) = (row + self.off[1], (height - 1) as f32);
        (y >= -beyond && y <= last + beyond).then(|| {
            let y = y.clamp(0.0, last);
            (y as usize, y.fract())
        })
    }

    /// The slope outward.
    fn slope(
        &self,
        slopes: &[Vec<f32>; 2],
        (above, down): (usize, f32),
        column: f32,
        width: usize,
        beyond: f32,
    ) -> Option<f32> {
        let (x, last) = (column + self.off[0], (width - 1) as f32);
        if x < -beyond || x > last + beyond {
            return None;
        }
        let x = x.clamp(0.0, last);
        let (left, part) = (x as usize, x.fract());
        let right = (left + 1).min(width - 1);
        let first = above * width;
        let second = if down > 0.0 { first + width } else { first };
        let of = |axis: usize| {
            let mix = |line: usize| {
                let [a, b] = [slopes[axis][line + left], slopes[axis][line + right]];
                a + part * (b - a)
            };
            let upper = mix(first);
            upper + down * (mix(second) - upper)
        };
        Some(self.normal[0] * of(0) + self.normal[1] * of(1))
    }
}
