//! A cut, and the evidence for it.

use super::line::{Line, STEP};
use super::piece::Piece;
use super::whole::{Whole, distance, rise, straight};

/// From this strength on, two cells are separated.
pub(super) const PARTED: f64 = 0.75;
/// From this strength on, it is doubtful whether it is one cell.
pub(super) const DOUBTED: f64 = 0.35;

/// Distances from a cut at which texture is read, um.
const BAND_UM: [f64; 2] = [1.5, 9.0];
/// Least distance from the rim at which texture is read, um: the rim has a direction of its own.
const FROM_THE_RIM_UM: f64 = 2.0;
/// Strength of a cut with only a step of brightness as evidence.
const STEPPED: f64 = 0.5;
/// Largest strength of a cut through a cell that lies across another: separating it would leave the
/// lower cell in two pieces.
const CROSSED: f64 = 0.6;

/// A cut from rim to rim.
#[derive(Debug, Clone)]
pub(super) struct Cut {
    ends: [[f64; 2]; 2],
    voices: Voices,
    /// Whether one part continues beyond the other.
    crossed: bool,
}

/// Strength of each kind of evidence for a cut, 0 to 1.
#[derive(Debug, Clone)]
struct Voices {
    neck: f64,
    line: f64,
    step: f64,
    branch: f64,
}

impl Voices {
    fn together(&self) -> f64 {
        let Self { neck, line, step, branch } = self;
        1.0 - (1.0 - neck) * (1.0 - line) * (1.0 - step) * (1.0 - branch)
    }
}

impl Cut {
    /// The cut, and on which side of it each pixel lies; `None` if a part is smaller than the smallest cell.
    pub(super) fn through(
        whole: &Whole<'_>,
        ends: [[f64; 2]; 2],
        smallest: f64,
    ) -> Option<(Self, Vec<u8>)> {
        let Whole { piece, light, depths, .. } = whole;
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
        let share = small / large;
        // A sliver is not a cell, but a part beyond a neck may be small.
        let sliver = rise(share, 0.05, 0.12);
        // Measured between the outer sides of both pixels.
        let length = distance(from, to) + 1.0;
        let width = length / 2.0 / f64::from(widest[1].min(widest[2])).max(0.5);
        let line = Line::along(piece, light, straight(from, to, STEP));
        let step = match rise(line.step, 0.1, 0.3) {
            0.0 => 0.0,
            step => step.min(rise(apart(whole, &sides), 0.1, 0.3)),
        };
        let voices = Voices {
            neck: neck(width) * rise(share, 0.02, 0.08),
            line: sliver * line.voice(whole, ends),
            step: sliver * STEPPED * step,
            branch: sliver * branch(whole, &sides, ends),
        };
        let crossed = voices.together() >= DOUBTED && crossed(piece, &sides, ends);
        Some((Self { ends, voices, crossed }, sides))
    }

    /// Certainty that there are two cells, 0 to 1.
    pub(super) fn strength(&self) -> f64 {
        let two = self.voices.together();
        if self.lies_across() { two.min(CROSSED) } else { two }
    }

    fn lies_across(&self) -> bool {
        self.crossed && self.voices.neck < PARTED
    }

    /// Value for comparison with other cuts; it also ranks cuts of full strength.
    pub(super) fn worth(&self) -> f64 {
        let Voices { neck, line, step, branch } = self.voices;
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

    /// The strongest evidence, in words.
    pub(super) fn seen(&self, pixel_um: f64) -> String {
        let Voices { neck, line, step, branch } = self.voices;
        let length_um = distance(self.ends[0], self.ends[1]) * pixel_um;
        let most = neck.max(line).max(step).max(branch);
        if self.lies_across() {
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

/// Strength of a neck as evidence for two cells, from half its width divided by the radius of the
/// largest circle that fits into the slimmer part: a slight waist is not a neck, one half as wide
/// as the parts is.
fn neck(width: f64) -> f64 {
    DOUBTED * rise(width, 0.72, 0.64)
        + (PARTED - DOUBTED) * rise(width, 0.64, 0.42)
        + (1.0 - PARTED) * rise(width, 0.42, 0.25)
}

/// Strength of a branch as evidence for two cells: both parts are convex while the whole is not,
/// and their textures have different directions.
fn branch(whole: &Whole<'_>, sides: &[u8], ends: [[f64; 2]; 2]) -> f64 {
    let parts = whole.piece.parts(sides);
    let part = parts.iter().map(Piece::solidity).fold(1.0, f64::min);
    let gain = rise(part - whole.solidity, 0.05, 0.25) * rise(part, 0.75, 0.9);
    if gain == 0.0 {
        return 0.0;
    }
    let (turn_deg, order) = turn(whole, sides, ends);
    gain * (0.4 + 0.6 * rise(turn_deg, 35.0, 60.0) * rise(order, 0.1, 0.3))
}

/// Difference of the mean brightness of both sides, relative to the brighter one, away from the
/// rim.
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

/// The angle between the directions of the texture on both sides of a cut, degrees, and the
/// coherency of the less clear one, 0 to 1.
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

/// Whether the part on one side of a cut continues beyond the other side, like a cell that lies
/// across another: straight on through the centre of the cut, or from the centre of that side, the
/// piece becomes wide and then as narrow as the cut again.
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

/// Width of a piece at a place, across a direction, searched up to `most` to each side.
fn width(piece: &Piece, [u, v]: [f64; 2], [x, y]: [f64; 2], most: f64) -> f64 {
    let run = |sign: f64| {
        let away = |at: i32| sign * f64::from(at);
        let inside = |at: &i32| piece.contains([u - y * away(*at), v + x * away(*at)]);
        (0..most as i32).take_while(inside).count() as f64
    };
    run(1.0) + run(-1.0)
}

/// Whether a piece, followed from a place in a direction, becomes much wider than a length and then
/// about as narrow as it.
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
