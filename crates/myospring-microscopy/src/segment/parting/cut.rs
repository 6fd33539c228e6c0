//! A cut, and what speaks for it.

use super::light::Light;
use super::piece::Piece;
use super::whole::{Whole, distance, straight};

/// From this strength on two cells are parted.
pub(super) const PARTED: f64 = 0.75;
/// From this strength on there is a doubt whether it is one cell.
pub(super) const DOUBTED: f64 = 0.35;

/// How far to both sides of a line its surroundings are looked at, um.
const BESIDE_UM: f64 = 3.0;
/// How far to both sides of a step brightness stays as it is, um: a bright rim is narrower.
const PLATEAU_UM: f64 = 9.0;
/// Depth below which a line is none.
const SHALLOW: f64 = 0.03;
/// Step between the places of a line, pixels.
const STEP: f64 = 0.7;
/// Places of a line are told apart at this distance, um: brightness is smoothed.
const APART_UM: f64 = 2.5;
/// Where lines beside a line are looked for: the nearest, the furthest and the steps between, um.
const RIVALS_UM: [f64; 3] = [3.75, 12.0, 0.75];
/// The band along a cut whose texture is read, um.
const BAND_UM: [f64; 2] = [1.5, 9.0];
/// Texture is read so far from the rim, um: the rim has a direction of its own.
const FROM_THE_RIM_UM: f64 = 2.0;
/// Strength of a cut for which there is only a step of brightness.
const STEPPED: f64 = 0.5;
/// Most strength of a cut through what lies across: it cannot be parted, the cell below would be in two pieces.
const CROSSED: f64 = 0.6;

/// What brightness says along a line.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Line {
    /// Mean of how much darker it is than the darker side, part of the brighter.
    depth: f64,
    /// Part of its length on which it is darker than both sides.
    along: f64,
    /// Part of its length that has two sides within.
    sided: f64,
    /// Difference of both sides beyond what each changes further away, part of the brighter: that of a step
    /// between two plateaus.
    step: f64,
}

impl Line {
    pub(super) fn along(
        piece: &Piece,
        light: &Light<'_>,
        path: impl Iterator<Item = [f64; 2]> + Clone,
    ) -> Self {
        Self::beside(piece, light, path, 0.0, |_| ())
    }

    /// And what of each place `seen` wants to know: how much darker it is than the darker side.
    pub(super) fn telling(
        piece: &Piece,
        light: &Light<'_>,
        path: impl Iterator<Item = [f64; 2]> + Clone,
        seen: impl FnMut(f32),
    ) -> Self {
        Self::beside(piece, light, path, 0.0, seen)
    }

    /// Along a line so many um beside another one.
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
            // So that no speck decides.
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

    /// The darkest line that runs beside another one: texture has many, a boundary is alone.
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

    /// For comparison with other lines.
    pub(super) fn worth(&self) -> f64 {
        if self.sided < 0.5 { 0.0 } else { (self.depth * self.along).max(self.step / 4.0) }
    }
}

/// A cut from rim to rim.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    pub(super) ends: [[f64; 2]; 2],
    /// Half its length over the radius of the largest circle that fits into the slimmer part.
    neck: f64,
    line: Line,
    /// Worth of the darkest line beside it.
    rival: f64,
    /// How many standard deviations the line is deep, of a line of that length at any place of the piece.
    deviations: f64,
    /// Angle between the directions of the texture on both sides, degrees, and how clear the less clear one is.
    turn_deg: f64,
    order: f64,
    /// Solidity of the whole and of the more ragged part.
    whole: f64,
    part: f64,
    /// Area of the smaller part over that of the larger one.
    share: f64,
    /// Difference of the mean brightness of both parts, part of the brighter.
    apart: f64,
    /// Whether a part goes on beyond the other.
    crossed: bool,
}

/// How strongly each thing speaks for a cut, 0 to 1.
struct Voices {
    neck: f64,
    line: f64,
    step: f64,
    branch: f64,
}

impl Cut {
    pub(super) fn through(
        whole: &Whole<'_>,
        ends: [[f64; 2]; 2],
        smallest: f64,
    ) -> Option<(Self, Vec<u8>)> {
        let Whole { piece, light, depths, solidity, .. } = whole;
        let [from, to] = ends;
        if from == to {
            return None;
        }
        let sides = piece.sides(straight(from, to, 0.5))?;
        let (mut widest, mut areas) = ([0.0_f32; 3], [0.0_f64; 3]);
        for (&side, &depth) in sides.iter().zip(depths) {
            let side = usize::from(side);
            widest[side] = widest[side].max(depth);
            areas[side] += 1.0;
        }
        let (small, large) = (areas[1].min(areas[2]), areas[1].max(areas[2]));
        if small < smallest {
            return None;
        }
        // From the outer sides of both pixels.
        let length = distance(from, to) + 1.0;
        let (turn_deg, order) = turn(whole, &sides, ends);
        let line = Line::along(piece, light, straight(from, to, STEP));
        let places = distance(from, to) * light.pixel_um / APART_UM;
        let cut = Self {
            ends,
            neck: length / 2.0 / f64::from(widest[1].min(widest[2])).max(0.5),
            line,
            deviations: line.depth * places.sqrt() / whole.scatter.max(1e-6),
            rival: Line::rival(piece, light, ends),
            turn_deg,
            order,
            whole: *solidity,
            part: piece.parts(&sides).iter().map(Piece::solidity).fold(1.0, f64::min),
            share: small / large,
            apart: apart(whole, &sides),
            crossed: crossed(piece, &sides, ends),
        };
        Some((cut, sides))
    }

    fn voices(&self) -> Voices {
        let rise =
            |value: f64, none: f64, all: f64| ((value - none) / (all - none)).clamp(0.0, 1.0);
        // A waist is no neck; half as wide as what it joins, it is.
        let neck = DOUBTED * rise(self.neck, 0.72, 0.64)
            + (PARTED - DOUBTED) * rise(self.neck, 0.64, 0.42)
            + (1.0 - PARTED) * rise(self.neck, 0.42, 0.25);
        let Line { depth, along, sided, step, .. } = self.line;
        // Of thousands of lines the darkest was taken.
        let clear = rise(self.deviations, 3.5, 6.0);
        let alone = rise(depth * along / self.rival.max(1e-3), 1.2, 2.5);
        let turn = rise(self.turn_deg, 35.0, 60.0) * rise(self.order, 0.1, 0.3);
        // Both parts are plain, the whole is not.
        let gain = rise(self.part - self.whole, 0.05, 0.25) * rise(self.part, 0.75, 0.9);
        // A sliver is no cell; what hangs on a neck may be small.
        let sliver = rise(self.share, 0.05, 0.12);
        Voices {
            neck: neck * rise(self.share, 0.02, 0.08),
            line: sliver
                * rise(depth, 0.025, 0.08)
                * rise(along, 0.6, 0.9)
                * rise(sided, 0.4, 0.7)
                * alone
                * clear,
            step: sliver * STEPPED * rise(step.min(self.apart), 0.1, 0.3),
            branch: sliver * gain * (0.4 + 0.6 * turn),
        }
    }

    /// How sure it is that there are two cells: 0 not at all, 1 wholly.
    pub(super) fn strength(&self) -> f64 {
        let Voices { neck, line, step, branch } = self.voices();
        let two = 1.0 - (1.0 - neck) * (1.0 - line) * (1.0 - step) * (1.0 - branch);
        if self.crossed && neck < PARTED { two.min(CROSSED) } else { two }
    }

    /// For comparison with other cuts: of those that are surely right, that for which there is more.
    pub(super) fn worth(&self) -> f64 {
        let Voices { neck, line, step, branch } = self.voices();
        self.strength() + 0.1 * (neck + line + step + branch)
    }

    /// The middle, and a place on each side of it.
    pub(super) fn places(&self) -> [[f64; 2]; 3] {
        let [from, to] = self.ends;
        let length = distance(from, to).max(1e-9);
        [0.0, 2.0, -2.0].map(|away| {
            let away = away / length;
            let [x, y] = [(from[1] - to[1]) * away, (to[0] - from[0]) * away];
            [f64::midpoint(from[0], to[0]) + x, f64::midpoint(from[1], to[1]) + y]
        })
    }

    /// What speaks for it most, in words.
    pub(super) fn seen(&self, pixel_um: f64) -> String {
        let Voices { neck, line, step, branch } = self.voices();
        let length_um = distance(self.ends[0], self.ends[1]) * pixel_um;
        let most = neck.max(line).max(step).max(branch);
        if self.crossed && neck < PARTED {
            format!("an arm {length_um:.0} um wide that comes out again on the other side")
        } else if neck >= most {
            format!("a neck of {length_um:.0} um")
        } else if line >= most {
            format!("a dark line of {length_um:.0} um from rim to rim")
        } else if step >= most {
            format!("a step of brightness along {length_um:.0} um from rim to rim")
        } else {
            format!("a branch {length_um:.0} um wide")
        }
    }
}

/// The difference of the mean brightness of both sides, part of the brighter one, away from the rim.
fn apart(whole: &Whole<'_>, sides: &[u8]) -> f64 {
    let rim = (FROM_THE_RIM_UM / whole.light.pixel_um) as f32;
    let (mut sums, mut counts) = ([0.0; 3], [0.0_f64; 3]);
    for (at, &side) in
        sides.iter().enumerate().filter(|(at, side)| **side > 0 && whole.depths[*at] >= rim)
    {
        sums[usize::from(side)] += whole.light.at(whole.piece.place(at));
        counts[usize::from(side)] += 1.0;
    }
    let [one, other] = [1, 2].map(|side| sums[side] / counts[side].max(1.0));
    (one - other).abs() / one.max(other).max(f64::from(f32::MIN_POSITIVE))
}

/// The angle between the directions of the texture on both sides of a cut, degrees, and how clear the less clear one
/// is, 0 to 1.
fn turn(whole: &Whole<'_>, sides: &[u8], [from, to]: [[f64; 2]; 2]) -> (f64, f64) {
    let Some(texture) = whole.texture() else { return (0.0, 0.0) };
    let Whole { piece, light, depths, .. } = whole;
    let length = distance(from, to).max(1e-9);
    let (x, y) = ((to[0] - from[0]) / length, (to[1] - from[1]) / length);
    let band = BAND_UM[0] / light.pixel_um..=BAND_UM[1] / light.pixel_um;
    let rim = (FROM_THE_RIM_UM / light.pixel_um) as f32;
    let mut sums = [[0.0; 3]; 3];
    for (at, &side) in
        sides.iter().enumerate().filter(|(at, side)| **side > 0 && depths[*at] >= rim)
    {
        let place = piece.place(at);
        let (u, v) = (place[0] - from[0], place[1] - from[1]);
        if (0.0..=length).contains(&(u * x + v * y)) && band.contains(&(v * x - u * y).abs()) {
            for (sum, value) in sums[usize::from(side)].iter_mut().zip(texture.at(place)) {
                *sum += value;
            }
        }
    }
    let [_, one, other] = sums.map(|[difference, sum, product]: [f64; 3]| {
        (product.atan2(difference).to_degrees() / 2.0, difference.hypot(product) / sum.max(1e-30))
    });
    let between = (one.0 - other.0).rem_euclid(180.0);
    (between.min(180.0 - between), one.1.min(other.1))
}

/// Whether what is on one side of a cut goes on beyond the other side, as one cell that lies across another does:
/// straight on through the middle of the cut, or from the middle of that side, the piece gets wide and then as narrow
/// as the cut again.
fn crossed(piece: &Piece, sides: &[u8], [from, to]: [[f64; 2]; 2]) -> bool {
    let length = distance(from, to);
    let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
    let mut sums = [[0.0_f64; 3]; 3];
    for (at, &side) in sides.iter().enumerate().filter(|(_, side)| **side > 0) {
        let [x, y] = piece.place(at);
        for (sum, value) in sums[usize::from(side)].iter_mut().zip([x, y, 1.0]) {
            *sum += value;
        }
    }
    let across = [(from[1] - to[1]) / length, (to[0] - from[0]) / length];
    let mut straight_on = [across, across.map(|at| -at)].into_iter();
    if straight_on.any(|way| comes_out_again(piece, middle, way, length)) {
        return true;
    }
    sums[1..].iter().any(|[x, y, count]| {
        let centre = [x / count, y / count];
        let far = distance(centre, middle).max(1.0);
        let way = [(middle[0] - centre[0]) / far, (middle[1] - centre[1]) / far];
        comes_out_again(piece, middle, way, width(piece, centre, way, 4.0 * length))
    })
}

/// How wide a piece is at a place, across a direction; at most so much to each side.
fn width(piece: &Piece, [u, v]: [f64; 2], [x, y]: [f64; 2], most: f64) -> f64 {
    let run = |sign: f64| {
        let away = |at: i32| sign * f64::from(at);
        let inside = |at: &i32| piece.contains([u - y * away(*at), v + x * away(*at)]);
        (0..most as i32).take_while(inside).count() as f64
    };
    run(1.0) + run(-1.0)
}

/// Whether a piece gets much wider than a length and then about as narrow, on the way from a place in a direction.
fn comes_out_again(piece: &Piece, from: [f64; 2], [x, y]: [f64; 2], length: f64) -> bool {
    let (mut wide, mut narrow) = (false, 0.0);
    for way in 1.. {
        let place = [from[0] + x * f64::from(way), from[1] + y * f64::from(way)];
        if !piece.contains(place) {
            break;
        }
        let width = width(piece, place, [x, y], 4.0 * length);
        wide |= width > 1.7 * length;
        narrow = if wide && width < 1.4 * length { narrow + 1.0 } else { 0.0 };
        if narrow > 0.4 * length {
            return true;
        }
    }
    false
}
