//! The length of sarcomeres in every frame, from the period of the stripes themselves.
//!
//! At each place with stripes at rest, a profile of grey values is read along the fibre in every
//! frame, at the fibre's displaced position and rotated direction. The wavelength with the most
//! power in that profile is the sarcomere length.

use super::spline::Spline;
use super::subset::Warp;
use crate::fibres::FibreField;
use crate::outlines::PixelFrame;
use rayon::prelude::*;
use std::f32::consts::TAU;

/// Distance between places, um; larger if there would be more than [`MOST_PLACES`].
const APART_UM: f64 = 1.0;
const MOST_PLACES: usize = 800;
/// Half-length of the profile, periods; its window, a squared cosine, has an effective length of
/// about half of it.
const HALF_PERIODS: f32 = 3.0;
/// Least number of samples per period.
const SAMPLES: f32 = 10.0;
/// Half of the width over which parallel profiles are averaged, um, and their number.
const HALF_WIDTH_UM: f64 = 0.5;
const PROFILES: usize = 5;
/// First and last wave number that are tested, relative to that at rest, and their number.
const WAVES: [f32; 2] = [0.78, 1.3];
const STEPS: usize = 27;
/// Least part of the profile's variance that the wave explains.
const LEAST_POWER: f32 = 0.25;
/// Least part of the frames in which a place must be read.
const OFTEN: f64 = 0.8;
/// Least number of parts of a cell from which a mean sarcomere length is given.
pub const FEWEST_PARTS: usize = 5;
/// Least distance between the centres of two parts, periods: nearer profiles contain mostly the
/// same stripes, so they are not independent.
const PARTS_APART: f32 = HALF_PERIODS;

/// A place with stripes.
#[derive(Debug, Clone, Copy)]
struct Place {
    /// The nearest point, and the offset from it, pixels.
    point: usize,
    offset: [f32; 2],
    middle: [f32; 2],
    /// Unit vector along the fibre at rest, y downward.
    along: [f32; 2],
    period: f32,
}

/// Sarcomere lengths in each frame.
pub(super) struct Lengths {
    /// Mean over all places, um.
    pub(super) mean_um: Vec<Option<f64>>,
    /// Number of places that were read, and of parts of the cell in which they lie.
    pub(super) places: usize,
    pub(super) parts: usize,
    /// Mean over the places of each part, um; empty if there are too few.
    pub(super) by_part_um: Vec<Vec<Option<f64>>>,
}

/// Places with stripes at rest.
#[derive(Debug, Clone, Default)]
pub(super) struct Stripes {
    places: Vec<Place>,
    half_width: f32,
}

impl Stripes {
    /// Places where a field shows sarcomeres; points are pixels.
    pub(super) fn new(field: &FibreField, points: &[[f32; 2]], frame: &PixelFrame) -> Self {
        let pixel_um = frame.pixel_size().um();
        let mut apart = APART_UM;
        let striped = loop {
            let grid = field.on_grid(apart);
            let striped: Vec<_> = grid
                .into_iter()
                .filter_map(|(point, fibre)| Some((point, fibre.direction, fibre.sarcomere_um?)))
                .collect();
            if striped.len() <= MOST_PLACES {
                break striped;
            }
            apart *= (striped.len() as f64 / MOST_PLACES as f64).sqrt().max(1.05);
        };
        let place = |(at, [x, y], length): ([f64; 2], [f64; 2], f64)| {
            let middle = frame.to_pixels(at).map(|place| (place - 0.5) as f32);
            let away = |point: &[f32; 2]| (point[0] - middle[0]).hypot(point[1] - middle[1]);
            let point =
                (0..points.len()).min_by(|&a, &b| away(&points[a]).total_cmp(&away(&points[b])))?;
            let offset = [0, 1].map(|a: usize| middle[a] - points[point][a]);
            let period = (length / pixel_um) as f32;
            Some(Place { point, offset, middle, along: [x as f32, -y as f32], period })
        };
        let places = striped.into_iter().filter_map(place).collect();
        Self { places, half_width: (HALF_WIDTH_UM / pixel_um) as f32 }
    }

    /// The part of the cell (counted from 0) to which each place belongs: the one with the nearest
    /// centre. Centres are places far enough from each other.
    fn parts(&self, places: &[usize]) -> Vec<usize> {
        let apart = |a: usize, b: usize| {
            let [a, b] = [a, b].map(|place| self.places[place].middle);
            (a[0] - b[0]).hypot(a[1] - b[1])
        };
        let mut middles: Vec<usize> = Vec::new();
        for &place in places {
            let least = PARTS_APART * self.places[place].period;
            if middles.iter().all(|&middle| apart(place, middle) >= least) {
                middles.push(place);
            }
        }
        let nearest = |&place: &usize| {
            let far = |at: &usize| apart(place, middles[*at]);
            (0..middles.len()).min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or_default()
        };
        places.iter().map(nearest).collect()
    }

    /// Mean lengths in each frame, from the periods of the places by frame. Only places that were
    /// read in nearly all frames are used. No length is given if they lie in too few parts of the
    /// cell.
    pub(super) fn lengths(&self, periods: &[Vec<Option<f32>>], pixel_um: f64) -> Lengths {
        let often = (OFTEN * periods.len() as f64).ceil() as usize;
        let known: Vec<(usize, f64)> = (0..self.places.len())
            .filter_map(|place| {
                let read: Vec<f32> = periods.iter().filter_map(|frame| frame[place]).collect();
                (read.len() >= often.max(1))
                    .then(|| (place, f64::from(super::neighbours::median(read))))
            })
            .collect();
        let places: Vec<usize> = known.iter().map(|(place, _)| *place).collect();
        let parts = self.parts(&places);
        let count = parts.iter().max().map_or(0, |last| last + 1);
        if count < FEWEST_PARTS {
            let none = vec![None; periods.len()];
            return Lengths {
                mean_um: none,
                places: known.len(),
                parts: count,
                by_part_um: Vec::new(),
            };
        }
        // Ratios to each place's usual length are averaged, so that a missing reading does not
        // shift the mean.
        let mean_of = |frame: &[Option<f32>], of_part: &dyn Fn(usize) -> bool| {
            let own =
                || known.iter().zip(&parts).filter(|(_, part)| of_part(**part)).map(|(it, _)| it);
            let usual = own().map(|(_, usual)| usual).sum::<f64>() / own().count() as f64;
            let ratios: Vec<f64> = own()
                .filter_map(|&(place, usual)| Some(f64::from(frame[place]?) / usual))
                .collect();
            let mean = ratios.iter().sum::<f64>() / ratios.len() as f64;
            (ratios.len(), mean * usual * pixel_um)
        };
        let mean = |frame: &Vec<Option<f32>>| {
            let (read, mean) = mean_of(frame, &|_| true);
            (read >= FEWEST_PARTS).then_some(mean)
        };
        let by_part = |frame: &Vec<Option<f32>>| {
            let mean = |part: usize| mean_of(frame, &|of| of == part);
            (0..count)
                .map(|part| Some(mean(part)).filter(|(read, _)| *read > 0).map(|it| it.1))
                .collect()
        };
        Lengths {
            mean_um: periods.iter().map(mean).collect(),
            places: known.len(),
            parts: count,
            by_part_um: periods.iter().map(by_part).collect(),
        }
    }

    /// Period of the stripes of each place in a frame, pixels.
    pub(super) fn read(&self, now: &Spline, warps: &[Warp]) -> Vec<Option<f32>> {
        self.places
            .par_iter()
            .map_init(Vec::new, |profile, place| {
                let warp = &warps[place.point];
                let shift = warp.at(place.offset);
                let middle = [0, 1].map(|a: usize| place.middle[a] + shift[a]);
                let [x, y] = place.along;
                let [[xx, xy], [yx, yy]] = warp.gradient;
                let turned = [x + xx * x + xy * y, y + yx * x + yy * y];
                let stretch = turned[0].hypot(turned[1]);
                let along = turned.map(|part| part / stretch);
                self.profile(now, middle, along, place.period, profile)?;
                period(profile, place.period)
            })
            .collect()
    }

    /// Mean grey values across a fibre, along it.
    fn profile(
        &self,
        now: &Spline,
        middle: [f32; 2],
        [x, y]: [f32; 2],
        period: f32,
        profile: &mut Vec<f32>,
    ) -> Option<()> {
        let (step, half) = steps(period);
        profile.clear();
        for k in -half..=half {
            let along = f32::from(k) * step;
            // The parallel profiles; the three unused of eight lanes repeat the last.
            let place = |line: usize| {
                let part = 2.0 * line.min(PROFILES - 1) as f32 / (PROFILES - 1) as f32 - 1.0;
                let across = part * self.half_width;
                [middle[0] + along * x - across * y, middle[1] + along * y + across * x]
            };
            let places = [0, 1, 2, 3, 4, 5, 6, 7].map(place);
            let values = now.at_eight(&places.map(|place| place[0]), &places.map(|place| place[1]));
            let sum: f32 = values[..PROFILES].iter().sum();
            if sum.is_nan() {
                return None;
            }
            profile.push(sum / PROFILES as f32);
        }
        Some(())
    }
}

/// Length of a sample and number of samples to each side.
fn steps(period: f32) -> (f32, i16) {
    let step = (period / SAMPLES).min(1.0);
    (step, (HALF_PERIODS * period / step).round() as i16)
}

/// The period with the most power in a profile, near a known one; `None` if no wave has enough
/// power.
fn period(profile: &mut [f32], known: f32) -> Option<f32> {
    let (step, half) = steps(known);
    let window = |k: i16| (0.25 * TAU * f32::from(k) / f32::from(half + 1)).cos().powi(2);
    // Level and slope are subtracted.
    let (mut weights, mut mean, mut slope, mut squares) = (0.0, 0.0, 0.0, 0.0);
    for (value, k) in profile.iter().zip(-half..) {
        let (weight, k) = (window(k), f32::from(k));
        weights += weight;
        mean += weight * value;
        slope += weight * k * value;
        squares += weight * k * k;
    }
    let (mean, slope) = (mean / weights, slope / squares);
    let mut variation = 0.0;
    for (value, k) in profile.iter_mut().zip(-half..) {
        let flat = *value - mean - slope * f32::from(k);
        variation += window(k) * flat * flat;
        *value = window(k) * flat;
    }
    let [first, last] = WAVES;
    let wave = |at: f32| (first + (last - first) * at / (STEPS - 1) as f32) / known;
    let power = |at: usize| {
        let turn = TAU * wave(at as f32) * step;
        let (mut real, mut imaginary) = (0.0_f32, 0.0_f32);
        for (value, k) in profile.iter().zip(-half..) {
            let (sine, cosine) = (turn * f32::from(k)).sin_cos();
            real += value * cosine;
            imaginary += value * sine;
        }
        real * real + imaginary * imaginary
    };
    let powers: Vec<f32> = (0..STEPS).map(power).collect();
    let top = (0..STEPS).max_by(|&a, &b| powers[a].total_cmp(&powers[b]))?;
    if top == 0 || top + 1 == STEPS {
        return None;
    }
    // For a pure wave, the power is half of the weights times the variance.
    let part = 2.0 * powers[top] / (weights * variation);
    if part.is_nan() || part < LEAST_POWER {
        return None;
    }
    let [left, middle, right] = [top - 1, top, top + 1].map(|at| powers[at].max(1e-30).ln());
    let bend = left - 2.0 * middle + right;
    let shift = if bend < 0.0 { 0.5 * (left - right) / bend } else { 0.0 };
    Some(wave(top as f32 + shift.clamp(-0.5, 0.5)).recip())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Places that lie in two rows, 1 um apart, of as many columns; pixels of 0.2 um.
    fn two_rows(columns: u16) -> Stripes {
        let place = |at: u16| {
            let middle = [5.0 * f32::from(at / 2), 5.0 * f32::from(at % 2)];
            Place { point: 0, offset: [0.0; 2], middle, along: [1.0, 0.0], period: 9.0 }
        };
        Stripes { places: (0..2 * columns).map(place).collect(), half_width: 2.5 }
    }

    #[test]
    fn places_whose_profiles_overlap_are_one_part_and_few_parts_say_nothing() {
        // Parts are three periods of 1.8 um apart, so they need 6 columns each.
        for (columns, parts) in [(4, 1), (20, 4), (24, 4), (25, 5), (60, 10)] {
            let stripes = two_rows(columns);
            let frames = vec![vec![Some(9.0); stripes.places.len()]; 3];
            let found = stripes.lengths(&frames, 0.2);
            assert_eq!((found.places, found.parts), (2 * usize::from(columns), parts));
            let wanted = (parts >= FEWEST_PARTS).then_some(1.8);
            for mean in found.mean_um {
                assert_eq!(mean.is_some(), wanted.is_some());
                assert!(mean.is_none_or(|mean| (mean - 1.8).abs() < 1e-9), "{mean:?}");
            }
        }
    }

    #[test]
    fn the_period_of_a_wave_is_read_between_the_samples() {
        let known = 9.0;
        for true_period in [7.6_f32, 8.3, 9.0, 9.7, 10.6] {
            for phase in [0.0, 1.0, 2.5] {
                let (step, half) = steps(known);
                let mut profile: Vec<f32> = (-half..=half)
                    .map(|k| f32::from(k) * step)
                    .map(|s| 30.0 + 0.2 * s + 5.0 * (TAU * s / true_period + phase).cos())
                    .collect();
                let found = period(&mut profile, known).unwrap();
                // What the window lets through from the wave's mirror image.
                assert!((found / true_period - 1.0).abs() < 2e-3, "{true_period} {phase}: {found}");
            }
        }
    }

    #[test]
    fn a_profile_without_stripes_has_no_period() {
        let (_, half) = steps(9.0);
        let mut flat = vec![7.0; 2 * half as usize + 1];
        assert_eq!(period(&mut flat, 9.0), None);
    }
}
