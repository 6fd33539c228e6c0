//! All points at one level of detail: each is followed on its own, checked against its neighbours,
//! and interpolated from them if it fails.

use super::neighbours::{Neighbours, distance, median};
use super::spline::Spline;
use super::subset::{Found, Subset, Warp};
use crate::filter;
use crate::plane::Plane;
use rayon::prelude::*;

/// Blur before comparison, pixels: single pixels are mostly noise, whose slopes would shorten every
/// step.
pub(super) const SMOOTHING: f64 = 0.8;

/// Rounds in which points that disagree with their neighbours are searched again from the position
/// that the neighbours predict.
const ROUNDS: usize = 6;
/// Least correlation: as a part of the correlation expected with this noise, and in absolute terms
/// (chance alone gives less).
const LEAST_PART: f32 = 0.5;
const LEAST_CORRELATION: f32 = 0.25;
/// Largest error due to noise, pixels: points with too little texture to reach it are not followed.
const LARGEST_ERROR: f32 = 0.5;
/// A predicted start at least this far from the last one is searched again, pixels.
const ANEW: f32 = 0.3;
/// Largest deviation of a point from its neighbours, in their standard deviations; `off_by` bounds
/// it.
const DEVIATIONS: f32 = 3.0;

/// Resolution and tolerances of a level.
#[derive(Debug, Clone, Copy)]
pub(super) struct Detail {
    /// Pixels of the film along the side of one pixel of this level.
    pub(super) factor: usize,
    /// Standard deviation of the blur before binning, pixels of the film.
    pub(super) blur: f64,
    /// Half of a subset's side, pixels of this level.
    pub(super) half: usize,
    /// Largest distance of neighbours, and of adjacent points, pixels of this level.
    pub(super) reach: [f32; 2],
    /// Bounds of the largest deviation of a point from its neighbours, pixels of this level.
    pub(super) off_by: [f32; 2],
    /// Whether points that were found are averaged with their neighbours.
    pub(super) smooths: bool,
}

/// All points at one level of detail.
#[derive(Debug)]
pub(super) struct Level {
    detail: Detail,
    subsets: Vec<Option<Subset>>,
    neighbours: Neighbours,
    /// Expected correlation of a subset that is found, given the noise.
    expected: Vec<f32>,
    /// Weight of each point in smoothing: the inverse of the sum of the squares of its error and of
    /// the typical error.
    weights: Vec<f32>,
}

/// Displacements of the points of a level.
#[derive(Debug, Clone)]
pub(super) struct Field {
    pub(super) warps: Vec<Warp>,
    /// Correlation of the points that were found; `None` for interpolated ones.
    pub(super) found: Vec<Option<f32>>,
}

impl Field {
    /// Part of the points that were found.
    pub(super) fn found_share(&self) -> f64 {
        let found = self.found.iter().filter(|found| found.is_some()).count();
        found as f64 / self.found.len().max(1) as f64
    }

    /// Median correlation of the points that were found.
    pub(super) fn correlation(&self) -> Option<f32> {
        let found: Vec<f32> = self.found.iter().copied().flatten().collect();
        (!found.is_empty()).then(|| median(found))
    }
}

impl Level {
    /// A level over the picture at rest; points are pixels of the film, `allowed` says which of its
    /// pixels may be used, `noise` is the standard deviation of its grey values.
    pub(super) fn new(
        rest: &Plane,
        points: &[[f32; 2]],
        allowed: &Plane,
        noise: f64,
        detail: Detail,
    ) -> Self {
        let spline = look(rest, detail);
        let [width, height] = spline.size();
        let allowed = if detail.factor > 1 {
            filter::coarse(allowed, detail.factor)
        } else {
            allowed.clone()
        };
        let allowed: Vec<bool> = allowed.values().iter().map(|&part| part >= 0.5).collect();
        debug_assert_eq!(allowed.len(), width * height);
        let points: Vec<[f32; 2]> =
            points.iter().map(|point| point.map(|at| detail.own(at))).collect();
        // Binning and blurring reduce the noise.
        let blurred = (2.0 * std::f64::consts::PI.sqrt() * detail.blur).max(1.0);
        let noise = (noise / blurred.max(detail.factor as f64)) as f32;
        let subsets: Vec<Option<Subset>> = points
            .par_iter()
            .map(|&point| {
                Subset::new(&spline, point, detail.half, &allowed, noise)
                    .filter(|subset| subset.sensitivity * noise <= LARGEST_ERROR)
            })
            .collect();
        let left = |subset: &Option<Subset>| {
            let variance = subset.as_ref().map_or(1.0, |subset| subset.variance);
            (1.0 - noise * noise / variance).clamp(0.2, 1.0)
        };
        let expected = subsets.iter().map(left).collect();
        let [reach, next] = detail.reach;
        let errors: Vec<f32> = subsets.iter().flatten().map(|subset| subset.sensitivity).collect();
        let usual = median(errors);
        let weight = |subset: &Option<Subset>| {
            let error = subset.as_ref().map_or(0.0, |subset| subset.sensitivity / usual);
            (1.0 + error * error).recip()
        };
        let weights = subsets.iter().map(weight).collect();
        Self { detail, expected, weights, subsets, neighbours: Neighbours::of(points, reach, next) }
    }

    /// Half of a subset's side, pixels of this level.
    pub(super) fn half(&self) -> usize {
        self.detail.half
    }

    /// Number of points.
    pub(super) fn len(&self) -> usize {
        self.subsets.len()
    }

    /// Part of the points whose surroundings have enough texture.
    pub(super) fn textured_share(&self) -> f64 {
        let seen = self.subsets.iter().filter(|subset| subset.is_some()).count();
        seen as f64 / self.subsets.len().max(1) as f64
    }

    /// Median error of the points due to noise, pixels of the film.
    pub(super) fn error(&self, noise: f64) -> Option<f64> {
        let errors: Vec<f32> =
            self.subsets.iter().flatten().map(|subset| subset.sensitivity).collect();
        let error = f64::from(median(errors)) * noise * self.detail.factor as f64;
        error.is_finite().then_some(error)
    }

    /// Prepares a frame for this level.
    pub(super) fn look(&self, plane: &Plane) -> Spline {
        look(plane, self.detail)
    }

    /// Follows all points into a frame from each of several starts, in pixels of the film.
    pub(super) fn follow(&self, now: &Spline, starts: &[&[Warp]]) -> Field {
        let scale = (self.detail.factor as f32).recip();
        let mut found: Vec<Option<Found>> = (0..self.subsets.len())
            .into_par_iter()
            .map_init(Vec::new, |room, point| {
                let mut best: Option<Found> = None;
                for (at, start) in starts.iter().enumerate() {
                    // A start near an earlier one would give the same result.
                    let from = start[point].shift;
                    if starts[..at].iter().any(|other| distance(other[point].shift, from) < ANEW) {
                        continue;
                    }
                    let found = self.find(point, now, &start[point].scaled(scale), room);
                    let better = |found: &Found| {
                        best.is_none_or(|best| found.correlation > best.correlation)
                    };
                    best = found.filter(better).or(best);
                }
                best
            })
            .collect();
        let scaled =
            |start: &&[Warp]| start.iter().map(|warp| warp.scaled(scale).shift).collect::<Vec<_>>();
        // The last start of each point.
        let mut tried = starts.last().map(scaled).unwrap_or_default();
        for round in 0..ROUNDS {
            let doubtful = self.doubtful(&found);
            for (found, doubtful) in found.iter_mut().zip(&doubtful) {
                if *doubtful {
                    *found = None;
                }
            }
            if round + 1 == ROUNDS {
                break;
            }
            let anew: Vec<(usize, [f32; 2], Option<Found>)> = (0..found.len())
                .into_par_iter()
                .filter(|&point| found[point].is_none() && self.subsets[point].is_some())
                .map_init(Vec::new, |room, point| {
                    let know = |other: usize| found[other].map(|found| found.warp);
                    let said = self.neighbours.hearsay(point, know)?;
                    let from = said.warp.shift;
                    if distance(from, tried[point]) < ANEW {
                        return None;
                    }
                    let again = self.find(point, now, &said.warp, room);
                    let agrees = |again: &Found| {
                        distance(again.warp.shift, from) <= self.tolerance(said.spread)
                    };
                    Some((point, from, again.filter(agrees)))
                })
                .flatten()
                .collect();
            if anew.is_empty() {
                break;
            }
            for (point, from, again) in anew {
                tried[point] = from;
                found[point] = again;
            }
        }
        self.with_interpolated(&found)
    }

    fn find(&self, point: usize, now: &Spline, start: &Warp, room: &mut Vec<f32>) -> Option<Found> {
        let found = self.subsets[point].as_ref()?.find(now, start, room)?;
        let least = (LEAST_PART * self.expected[point]).max(LEAST_CORRELATION);
        (found.correlation >= least).then_some(found)
    }

    fn tolerance(&self, spread: f32) -> f32 {
        let [least, most] = self.detail.off_by;
        (least + DEVIATIONS * spread).min(most.max(least))
    }

    /// Which points disagree with their neighbours.
    fn doubtful(&self, found: &[Option<Found>]) -> Vec<bool> {
        let warps: Vec<Option<Warp>> =
            found.iter().map(|found| Some(found.as_ref()?.warp)).collect();
        let [_, most] = self.detail.off_by;
        let mut doubtful = self.neighbours.at_odds(&warps, most);
        for (doubtful, at_odds) in doubtful.iter_mut().zip(self.off(&warps)) {
            *doubtful |= at_odds;
        }
        doubtful
    }

    /// Which points deviate too much from the position that their neighbours predict.
    fn off(&self, warps: &[Option<Warp>]) -> Vec<bool> {
        let is_off = |point: usize| {
            let Some(own) = &warps[point] else { return false };
            let heard = self.neighbours.heard_shift(point, |other| warps[other]);
            heard.is_some_and(|(shift, spread)| distance(own.shift, shift) > self.tolerance(spread))
        };
        (0..warps.len()).into_par_iter().map(is_off).collect()
    }

    /// The field, with points that were not found interpolated from their neighbours, in pixels of
    /// the film. Far from any found point, the displacement is constant, because extrapolated
    /// gradients would grow without bound.
    fn with_interpolated(&self, found: &[Option<Found>]) -> Field {
        let mut warps: Vec<Option<Warp>> =
            found.iter().map(|found| Some(found.as_ref()?.warp)).collect();
        while warps.iter().any(Option::is_none) {
            let interpolated: Vec<(usize, Warp)> = (0..warps.len())
                .filter(|&point| warps[point].is_none())
                .filter_map(|point| {
                    let shift = self.neighbours.shift(point, |other| warps[other])?;
                    Some((point, Warp { shift, ..Warp::default() }))
                })
                .collect();
            if interpolated.is_empty() {
                break;
            }
            for (point, warp) in interpolated {
                warps[point] = Some(warp);
            }
        }
        // Points without neighbours take the median displacement.
        let known: Vec<Warp> = warps.iter().copied().flatten().collect();
        let middle = |a: usize| median(known.iter().map(|warp| warp.shift[a]).collect());
        let shift = if known.is_empty() { [0.0; 2] } else { [middle(0), middle(1)] };
        let lone = Warp { shift, ..Warp::default() };
        let factor = self.detail.factor as f32;
        let smooth = |point: usize| {
            if let (false, Some(own)) = (self.detail.smooths, &found[point]) {
                return own.warp.scaled(factor);
            }
            let know =
                |other: usize| found[other].map(|found| (found.warp.shift, self.weights[other]));
            let fitted = self.neighbours.fitted(point, know);
            fitted.or(warps[point]).unwrap_or(lone).scaled(factor)
        };
        Field {
            warps: (0..warps.len()).into_par_iter().map(smooth).collect(),
            found: found.iter().map(|found| found.map(|found| found.correlation)).collect(),
        }
    }
}

impl Detail {
    /// Converts a position from pixels of the film to pixels of this level.
    fn own(self, place: f32) -> f32 {
        let factor = self.factor as f32;
        (place + 0.5) / factor - 0.5
    }
}

fn look(plane: &Plane, Detail { factor, blur, .. }: Detail) -> Spline {
    let blurred = if blur > 0.0 { &filter::gaussian(plane, blur) } else { plane };
    if factor > 1 { Spline::of(&filter::coarse(blurred, factor)) } else { Spline::of(blurred) }
}

/// 1 where `is` holds, else 0, for the pixels of a plane.
pub(super) fn mask(plane: &Plane, is: impl Fn(usize) -> bool) -> Plane {
    let values = (0..plane.values().len()).map(|at| if is(at) { 1.0 } else { 0.0 }).collect();
    Plane::new(plane.width(), plane.height(), values).unwrap_or_else(|| plane.clone())
}
