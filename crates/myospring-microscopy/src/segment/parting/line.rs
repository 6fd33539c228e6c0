//! Darkness of a line through a piece, and the difference in brightness between its sides.

use super::light::Light;
use super::piece::Piece;
use super::whole::{Whole, distance, rise, straight};

/// Distance to both sides at which the surroundings of a line are read, um.
const BESIDE_UM: f64 = 3.0;
/// Least width of constant brightness on both sides of a step, um: a bright rim is narrower.
const PLATEAU_UM: f64 = 9.0;
/// Least depth of a dark line.
const SHALLOW: f64 = 0.03;
/// Distance of independent places along a line, um, since brightness is smoothed.
const APART_UM: f64 = 2.5;
/// Distances of parallel lines that are compared with a line: nearest, furthest and step, um.
const RIVALS_UM: [f64; 3] = [3.75, 12.0, 0.75];
/// Step between the places of a line, pixels.
pub(super) const STEP: f64 = 0.7;

/// Brightness along a line and beside it.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Line {
    /// Mean difference between the darker side and the line, relative to the brighter side.
    depth: f64,
    /// Part of its length on which it is darker than both sides.
    along: f64,
    /// Part of its length with both sides inside the piece.
    sided: f64,
    /// Height of a step between two plateaus: the difference between both sides minus the change of
    /// each further away, relative to the brighter side.
    pub(super) step: f64,
}

impl Line {
    pub(super) fn along(
        piece: &Piece,
        light: &Light<'_>,
        path: impl Iterator<Item = [f64; 2]> + Clone,
    ) -> Self {
        Self::beside(piece, light, path, 0.0, |_| ())
    }

    /// Measures a line; `seen` is called for each place with the difference between the darker side
    /// and the line.
    pub(super) fn telling(
        piece: &Piece,
        light: &Light<'_>,
        path: impl Iterator<Item = [f64; 2]> + Clone,
        seen: impl FnMut(f32),
    ) -> Self {
        Self::beside(piece, light, path, 0.0, seen)
    }

    /// Measures a line parallel to another one, at a distance in um.
    fn beside(
        piece: &Piece,
        light: &Light<'_>,
        path: impl Iterator<Item = [f64; 2]> + Clone,
        shift_um: f64,
        mut seen: impl FnMut(f32),
    ) -> Self {
        let mut places = 0.0;
        let from = path.clone().next().unwrap_or_default();
        let to = path.clone().last().unwrap_or_default();
        let length = distance(from, to).max(1e-9);
        let (x, y) = ((from[1] - to[1]) / length, (to[0] - from[0]) / length);
        let (mut depths, mut along, mut sided) = (0.0, 0.0, 0.0);
        let (mut steps, mut slopes, mut stepped) = (0.0_f64, 0.0, 0.0);
        for [column, row] in path {
            places += 1.0;
            let at = |um: f64| {
                let away = (shift_um + um) / light.pixel_um;
                [column + x * away, row + y * away]
            };
            let sides = [at(BESIDE_UM), at(-BESIDE_UM)];
            if !sides.iter().all(|&side| piece.contains(side)) {
                continue;
            }
            let own = light.at(at(0.0));
            let [left, right] = sides.map(|side| light.at(side));
            let bright = left.max(right).max(f64::from(f32::MIN_POSITIVE));
            let depth = ((left.min(right) - own) / bright).max(-1.0);
            seen(depth as f32);
            sided += 1.0;
            // Limited, so that a speck does not dominate.
            depths += depth.clamp(-0.2, 0.3);
            along += f64::from(u8::from(depth > SHALLOW));
            let further = [at(PLATEAU_UM), at(-PLATEAU_UM)];
            if further.iter().all(|&side| piece.contains(side)) {
                let [beyond_left, beyond_right] = further.map(|side| light.at(side));
                stepped += 1.0;
                steps += ((left - right) / bright).clamp(-1.0, 1.0);
                let slope = (left - beyond_left).abs() + (right - beyond_right).abs();
                slopes += (slope / bright).min(1.0);
            }
        }
        let count = f64::max(sided, 1.0);
        Self {
            depth: depths / count,
            along: along / count,
            sided: sided / f64::max(places, 1.0),
            step: if 2.0 * stepped > sided { (steps.abs() - slopes) / stepped } else { 0.0 },
        }
    }

    /// Depth of the darkest parallel line: texture has many of equal depth, a boundary has none.
    fn rival(piece: &Piece, light: &Light<'_>, [from, to]: [[f64; 2]; 2]) -> f64 {
        let [nearest, furthest, step] = RIVALS_UM;
        let count = ((furthest - nearest) / step) as usize;
        (0..=count)
            .map(|at| nearest + at as f64 * step)
            .flat_map(|shift| [shift, -shift])
            .map(|shift| Self::beside(piece, light, straight(from, to, STEP), shift, |_| ()))
            .filter(|line| line.sided > 0.5)
            .map(|line| line.depth * line.along)
            .fold(0.0, f64::max)
    }

    /// Value for comparison with other lines.
    pub(super) fn worth(&self) -> f64 {
        if self.sided < 0.5 { 0.0 } else { (self.depth * self.along).max(self.step / 4.0) }
    }

    /// Strength as evidence for a boundary between these ends, 0 to 1.
    pub(super) fn voice(&self, whole: &Whole<'_>, ends: [[f64; 2]; 2]) -> f64 {
        let Self { depth, along, sided, .. } = *self;
        let dark = rise(depth, 0.025, 0.08) * rise(along, 0.6, 0.9) * rise(sided, 0.4, 0.7);
        // The darkest of thousands of lines was chosen, so chance must be excluded.
        let places = distance(ends[0], ends[1]) * whole.light.pixel_um / APART_UM;
        let clear = rise(depth * places.sqrt() / whole.scatter.max(1e-6), 3.5, 6.0);
        if dark * clear == 0.0 {
            return 0.0;
        }
        let rival = Self::rival(whole.piece, whole.light, ends);
        dark * clear * rise(depth * along / rival.max(1e-3), 1.2, 2.5)
    }
}
