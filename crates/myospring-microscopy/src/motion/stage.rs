//! The motion of the stage: what the background does, where it has a texture.

use super::level::{Detail, Level, SMOOTHING, mask};
use super::neighbours::median;
use super::spline::Spline;
use super::subset::Warp;
use crate::filter;
use crate::plane::Plane;

/// What was taken for the motion of the stage.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// What the background does: the median over so many places.
    Background {
        /// Places in the background that show enough.
        points: usize,
    },
    /// The background shows too little: the mean displacement of the cell, each point by its area.
    CellMean,
}

/// Distance from any cell at which the background begins, um: what pulls beads and dish along stays behind.
const AWAY_UM: f64 = 5.0;
/// Fewest places in the background, and the most that are looked at.
const FEWEST: usize = 8;
const MOST: usize = 150;
/// Most by which the places may differ in a frame, by the median of their distances, pixels.
const LARGEST_SPREAD: f32 = 0.35;

/// Places in the background.
#[derive(Debug)]
pub(super) struct Background {
    level: Level,
    len: usize,
}

impl Background {
    /// Places that show enough; `None` where they are too few.
    pub(super) fn new(
        rest: &Plane,
        any_cell: &[bool],
        pixel_um: f64,
        noise: f64,
        half: usize,
    ) -> Option<Self> {
        let cells = mask(rest, |at| any_cell[at]);
        let near = filter::largest_nearby(&cells, (AWAY_UM / pixel_um).ceil() as usize);
        let allowed = near.map(|near| 1.0 - near);
        let free = allowed.values().iter().filter(|&&is| is > 0.5).count();
        let apart = ((free as f64 / MOST as f64).sqrt().ceil() as usize).max(half);
        let (width, height) = (rest.width(), rest.height());
        let rows = (half..height.saturating_sub(half)).step_by(apart);
        let places = rows.flat_map(|row| {
            (half..width.saturating_sub(half)).step_by(apart).map(move |column| (column, row))
        });
        let points: Vec<[f32; 2]> = places
            .filter(|&(column, row)| allowed.at(column, row) > 0.5)
            .map(|(column, row)| [column as f32, row as f32])
            .collect();
        if points.len() < FEWEST {
            return None;
        }
        let reach = [2.6, 1.5].map(|part| part * apart as f32);
        let detail = Detail { factor: 1, blur: SMOOTHING, half, reach, off_by: [0.25, 1.0] };
        let level = Level::new(rest, &points, &allowed, noise, detail);
        let len = (level.textured_share() * points.len() as f64).round() as usize;
        (len >= FEWEST).then_some(Self { level, len })
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// How far the background has gone in a frame, pixels, from a start; `None` where its places do not agree.
    pub(super) fn shift(&self, now: &Spline, start: [f32; 2]) -> Option<[f32; 2]> {
        let start = vec![Warp { shift: start, ..Warp::default() }; self.level.len()];
        let field = self.level.follow(now, &[&start]);
        let found: Vec<[f32; 2]> = (field.warps.iter().zip(&field.found))
            .filter_map(|(warp, found)| found.map(|_| warp.shift))
            .collect();
        if found.len() < FEWEST.max(self.len / 2) {
            return None;
        }
        let shift = [0, 1].map(|a: usize| median(found.iter().map(|shift| shift[a]).collect()));
        let away = found.iter().map(|at| (at[0] - shift[0]).hypot(at[1] - shift[1])).collect();
        (median(away) <= LARGEST_SPREAD).then_some(shift)
    }
}
