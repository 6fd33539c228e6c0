//! Candidate cuts through a piece: straight lines between two places of its rim that are short,
//! dark, or begin at a dent.

use std::f64::consts::PI;

use super::cut::Cut;
use super::light::Light;
use super::line::Line;
use super::piece::Piece;
use super::whole::{Whole, distance, straight};
use crate::filter::quantile;

/// Distance between the ends of cuts along the rim, um, and the largest number of ends.
const SPACING_UM: f64 = 2.5;
const MOST_ENDS: usize = 140;
/// Two candidates differ if at least one end is this far apart, um.
const APART_UM: f64 = 6.0;
/// Number of candidates of each kind.
const EACH: usize = 5;
/// Least length of a dark line, um.
const SHORTEST_LINE_UM: f64 = 6.0;
/// Least worth of a dark line.
const LEAST_WORTH: f64 = 0.015;
/// Largest ratio of half the length of a neck to the widest radius.
const NECK: f64 = 0.75;
/// Number of candidates from a dent, and the least angle between them, degrees.
const FROM_A_DENT: usize = 3;
const APART_DEG: f64 = 35.0;
/// Length over which the bend of the rim is measured, um, and least bend of a dent, degrees.
const BEND_UM: f64 = 5.0;
const DENT_DEG: f64 = 30.0;

/// A straight cut between two places of the rim.
#[derive(Debug, Clone, Copy)]
struct Chord {
    ends: [usize; 2],
    worth: f64,
}

/// Places of the rim, at equal distances.
struct Rim {
    pixels: Vec<[f64; 2]>,
    /// Index of the pixel of each place.
    index: Vec<usize>,
    ends: Vec<[f64; 2]>,
    /// Twice the area swept about the origin by the rim from the first place on.
    swept: Vec<f64>,
}

impl Rim {
    fn of(piece: &Piece, pixel_um: f64) -> Option<Self> {
        let pixels = piece.rim();
        // A step along the rim has a mean length of 1.1 pixels, between straight and diagonal
        // steps.
        let count = (pixels.len() as f64 * 1.1 * pixel_um / SPACING_UM) as usize;
        let count = count.min(MOST_ENDS).min(pixels.len());
        if count < 8 {
            return None;
        }
        let index: Vec<usize> = (0..count).map(|at| at * pixels.len() / count).collect();
        let ends: Vec<[f64; 2]> = index.iter().map(|&at| pixels[at]).collect();
        let mut swept = vec![0.0];
        for at in 0..count {
            let ([a, b], [c, d]) = (ends[at], ends[(at + 1) % count]);
            swept.push(swept[at] + a * d - b * c);
        }
        Some(Self { pixels, index, ends, swept })
    }

    /// The area between the rim and a chord, on the side of the places between its ends.
    fn beyond(&self, i: usize, j: usize) -> f64 {
        let ([a, b], [c, d]) = (self.ends[i], self.ends[j]);
        ((self.swept[j] - self.swept[i] + c * b - d * a) / 2.0).abs()
    }

    /// Whether the rim bends inward at each place, more than at its neighbours.
    fn dents(&self, pixel_um: f64) -> Vec<bool> {
        let count = self.ends.len();
        let place = |at: usize| self.ends[at % count];
        let way: f64 = (0..count).map(|at| distance(place(at), place(at + 1))).sum();
        let reach = ((BEND_UM / pixel_um / (way / count as f64)).round() as usize).max(1);
        let inward = -self.swept[count].signum();
        let bend = |at: usize| {
            let [before, here, after] = [at + count - reach, at, at + reach].map(place);
            let (a, b) = (here[0] - before[0], here[1] - before[1]);
            let (c, d) = (after[0] - here[0], after[1] - here[1]);
            inward * (a * d - b * c).atan2(a * c + b * d).to_degrees()
        };
        let bends: Vec<f64> = (0..count).map(bend).collect();
        let most_beside = |at: usize| {
            let beside = (1..=reach)
                .flat_map(|by| [bends[(at + by) % count], bends[(at + count - by) % count]]);
            beside.fold(f64::NEG_INFINITY, f64::max)
        };
        (0..count).map(|at| bends[at] > DENT_DEG && most_beside(at) <= bends[at]).collect()
    }

    /// The candidates of largest worth, each different from those before.
    fn best(&self, mut chords: Vec<Chord>, apart: f64, most: usize) -> Vec<Chord> {
        chords.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        let near = |a: usize, b: usize| distance(self.ends[a], self.ends[b]) < apart;
        let mut chosen: Vec<Chord> = Vec::new();
        for chord in chords {
            let [i, j] = chord.ends;
            let same = |other: &Chord| {
                let [k, l] = other.ends;
                near(i, k) && near(j, l) || near(i, l) && near(j, k)
            };
            if chosen.len() < most && !chosen.iter().any(same) {
                chosen.push(chord);
            }
        }
        chosen
    }

    /// The candidate of largest worth from a dent, and the best in other directions.
    fn in_all_directions(&self, dent: usize, mut chords: Vec<Chord>) -> Vec<Chord> {
        chords.sort_by(|a, b| b.worth.total_cmp(&a.worth));
        let direction = |chord: &Chord| {
            let [i, j] = chord.ends;
            let ([a, b], [c, d]) = (self.ends[dent], self.ends[if i == dent { j } else { i }]);
            (d - b).atan2(c - a)
        };
        let mut chosen: Vec<Chord> = Vec::new();
        for chord in chords {
            let turned = |other: &Chord| {
                (direction(other) - direction(&chord)).cos() < APART_DEG.to_radians().cos()
            };
            if chosen.len() < FROM_A_DENT && chosen.iter().all(turned) {
                chosen.push(chord);
            }
        }
        chosen
    }

    /// Moves the ends along the rim to where the cut is shortest or the line darkest.
    fn finer(&self, piece: &Piece, light: &Light<'_>, chord: Chord) -> [[f64; 2]; 2] {
        let count = self.pixels.len();
        let reach = count / self.ends.len() + 1;
        let moved =
            |end: usize, by: usize| self.pixels[(self.index[end] + count + by - reach) % count];
        let worth = |[from, to]: [[f64; 2]; 2]| {
            if !runs_inside(piece, from, to) {
                return f64::NEG_INFINITY;
            }
            let line = Line::along(piece, light, straight(from, to, 1.5));
            // A dark line weighs more than a short cut.
            10.0 * line.worth().max(0.0) - distance(from, to) / 20.0
        };
        let [i, j] = chord.ends;
        let shifts = || (0..=2 * reach).step_by((reach / 3).max(1));
        // One end after the other, twice.
        let mut best = chord.ends.map(|end| self.ends[end]);
        let mut most = worth(best);
        for moves_first in [true, false, true, false] {
            for shift in shifts() {
                let ends = if moves_first {
                    [moved(i, shift), best[1]]
                } else {
                    [best[0], moved(j, shift)]
                };
                let worth = worth(ends);
                if worth > most {
                    (most, best) = (worth, ends);
                }
            }
        }
        best
    }
}

/// The strongest cut through a piece, and its sides.
pub(super) fn strongest(
    piece: &Piece,
    light: &Light<'_>,
    smallest: f64,
) -> Option<(Cut, [Piece; 2])> {
    let rim = Rim::of(piece, light.pixel_um)?;
    let depths = piece.depths();
    let widest = f64::from(depths.iter().copied().fold(0.0, f32::max));
    let dents = rim.dents(light.pixel_um);
    let area = piece.count() as f64;
    let (mut necks, mut lines) = (Vec::new(), Vec::new());
    let mut seen = Vec::new();
    let mut from_dents: Vec<Vec<Chord>> = vec![Vec::new(); rim.ends.len()];
    for i in 0..rim.ends.len() {
        for j in i + 2..rim.ends.len() {
            let beyond = rim.beyond(i, j);
            let least = beyond.min(area - beyond);
            if least < smallest {
                continue;
            }
            let [from, to] = [i, j].map(|end| rim.ends[end]);
            let length = distance(from, to);
            // A circle in a part is smaller than the part and than the largest circle of the piece.
            let neck = length / 2.0 / (least / PI).sqrt().min(widest);
            let long = length * light.pixel_um >= SHORTEST_LINE_UM;
            let dented = dents[i] || dents[j];
            if !(neck < NECK || long || dented) || !runs_inside(piece, from, to) {
                continue;
            }
            let chord = |worth| Chord { ends: [i, j], worth };
            if neck < NECK {
                necks.push(chord(-neck));
            }
            // A cut between two dents may be longer.
            let length = if dents[i] && dents[j] { 0.7 * length } else { length };
            for end in [i, j].into_iter().filter(|&end| dents[end]) {
                from_dents[end].push(chord(-length));
            }
            if long {
                let path = straight(from, to, 1.5 / light.pixel_um);
                let line = Line::telling(piece, light, path, |depth| seen.push(depth));
                if line.worth() > LEAST_WORTH {
                    lines.push(chord(line.worth()));
                }
            }
        }
    }
    let apart = APART_UM / light.pixel_um;
    let mut chosen = rim.best(necks, apart, EACH);
    chosen.extend(rim.best(lines, apart, EACH));
    for (dent, chords) in from_dents.into_iter().enumerate() {
        chosen.extend(rim.in_all_directions(dent, chords));
    }
    if chosen.is_empty() {
        return None;
    }
    // Measured above the median; values below it come from the rim, where light falls off.
    let scatter = f64::from(quantile(&seen, 0.841) - quantile(&seen, 0.5));
    let solidity = piece.solidity();
    let whole = Whole::of(piece, light, depths, solidity, scatter);
    let cuts = chosen
        .into_iter()
        .filter_map(|chord| Cut::through(&whole, rim.finer(piece, light, chord), smallest));
    let (cut, sides) = cuts.max_by(|a, b| a.0.worth().total_cmp(&b.0.worth()))?;
    Some((cut, piece.parts(&sides)))
}

fn runs_inside(piece: &Piece, from: [f64; 2], to: [f64; 2]) -> bool {
    straight(from, to, 1.0).all(|place| piece.contains(place))
}
