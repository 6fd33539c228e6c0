//! The motion of the stage, from that of the background if it has a texture.

use super::level::{Detail, Level, SMOOTHING, mask};
use super::neighbours::median;
use super::spline::Spline;
use super::subset::Warp;
use crate::filter;
use crate::plane::Plane;

/// How the motion of the stage was determined.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// From the background: the median over `points` places.
    Background {
        /// Number of places in the background with enough texture.
        points: usize,
    },
    /// From the cells, because the background has too little texture: the mean displacement of
    /// their points, weighted by area.
    CellMean {
        /// Number of cells.
        cells: usize,
    },
}

/// Least distance of the background from any cell, um: nearer to it, the cell pulls the substrate
/// along.
const AWAY_UM: f64 = 5.0;
/// Least and largest number of places in the background.
const FEWEST: usize = 8;
const MOST: usize = 150;
/// Largest median deviation of the places within a frame, pixels.
const LARGEST_SPREAD: f32 = 0.35;

/// Places in the background.
#[derive(Debug)]
pub(super) struct Background {
    level: Level,
    len: usize,
}

impl Background {
    /// Places with enough texture; `None` if there are too few.
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
        let detail =
            Detail { factor: 1, blur: SMOOTHING, half, reach, off_by: [0.25, 1.0], smooths: true };
        let level = Level::new(rest, &points, &allowed, noise, detail);
        let len = (level.textured_share() * points.len() as f64).round() as usize;
        (len >= FEWEST).then_some(Self { level, len })
    }

    pub(super) fn len(&self) -> usize {
        self.len
    }

    /// Shift of the background in a frame, pixels, searched from a start; `None` if its places
    /// disagree.
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
