//! Separates touching cells by their shape, brightness or stripes.
//!
//! Each island is treated on its own. Candidates are straight cuts from rim to rim ([`cuts`]); the
//! evidence for each ([`cut`]) is a neck between two wide parts, a dark line from rim to rim, or
//! stripes that change direction. The strongest cut is made if it is strong enough, and both parts
//! are treated again. An uncertain case stays one cell, with a doubt in words.

mod cut;
mod cuts;
mod light;
mod line;
mod piece;
mod whole;

use crate::filter;
use crate::region::{Connectivity, Region};
use cut::{DOUBTED, PARTED};
use light::Light;
pub(super) use light::Seen;
use myospring_core::interruption::{Interrupted, Interruption};
use piece::Piece;

/// Side up to which pixels are averaged, um: a tenth of a narrow cell.
const PIXEL_UM: f64 = 0.75;
/// Largest number of cells of one island; more are a tissue, or noise.
const MOST_PARTS: usize = 64;

/// Evidence for another number of cells than was chosen.
pub(super) struct Doubt {
    /// The middle of the cut and one place on each side of it: column and row on the region's grid.
    places: [[f64; 2]; 3],
    /// Strength of the evidence, 0 to 1.
    strength: f64,
    /// The evidence in words.
    what: String,
    /// Whether the cells were separated there.
    parted: bool,
}

impl Doubt {
    /// Factor for the confidence of the cells concerned, 0 to 1.
    pub(super) fn factor(&self) -> f64 {
        if self.parted {
            return self.strength;
        }
        0.79 - 0.4 * (self.strength - DOUBTED) / (PARTED - DOUBTED)
    }

    /// The cells concerned, in a picture finer than the region by `factor`.
    pub(super) fn concerns(
        &self,
        number: u32,
        numbers: &[u32],
        width: usize,
        factor: usize,
    ) -> bool {
        let at = |place: [f64; 2]| {
            let [column, row] = place.map(|at| (at * factor as f64) as usize);
            numbers.get(row * width + column.min(width - 1))
        };
        self.places.iter().any(|&place| at(place) == Some(&number))
    }

    /// The doubt as a reason for the user.
    pub(super) fn reason(&self, factor: usize) -> String {
        let [column, row] = self.places[0].map(|at| at * factor as f64);
        let what = &self.what;
        if self.parted {
            return format!(
                "it was separated from its neighbour at {what}, column {column:.0}, row {row:.0}: are both one cell?"
            );
        }
        format!(
            "it has {what} at column {column:.0}, row {row:.0}: are these two cells that touch? Then draw the \
             outline of one, or give a label mask"
        )
    }
}

/// The separated parts of the islands of a region.
pub(super) struct Parting {
    /// Pixels of the region along the side of a pixel of the parts.
    factor: usize,
    /// For each island of several cells, its parts in their windows.
    islands: Vec<Vec<Piece>>,
    /// Uncertain cases.
    pub(super) doubts: Vec<Doubt>,
}

impl Parting {
    /// Separates the cells of each island.
    pub(super) fn of(
        region: &Region,
        seen: &Seen<'_>,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        interruption.check()?;
        let factor = ((PIXEL_UM / seen.pixel_um) as usize).max(1);
        let pixel_um = seen.pixel_um * factor as f64;
        let coarse = region.halves(factor);
        let width = coarse.width();
        let light = Light::of(seen, factor);
        let smallest = seen.smallest_um2 / pixel_um.powi(2);
        let islands = coarse.islands(Connectivity::Four);
        let mut parting = Self { factor, islands: Vec::new(), doubts: Vec::new() };
        for (number, island) in (1..).zip(&islands.list) {
            if (island.pixels as f64) < 2.0 * smallest {
                continue;
            }
            let whole = Piece::of(&islands.numbers, width, number, island);
            let parts = parting.parted(whole, &light, smallest, interruption)?;
            if parts.len() > 1 {
                parting.islands.push(parts);
            }
        }
        Ok(parting)
    }

    /// The part to which each pixel of an island of several cells belongs, 0 for all other islands,
    /// in a picture finer than the region by `factor`; `None` if there is no such island.
    pub(super) fn marks(&self, region: &Region, factor: usize) -> Option<Vec<u32>> {
        if self.islands.is_empty() {
            return None;
        }
        let (width, height) = (region.width(), region.height());
        let factor = self.factor * factor;
        let mut marks = vec![0; region.pixels()];
        // Smaller values lie beyond the rim, possibly in another island.
        let mut most = vec![0.5_f32; region.pixels()];
        for (mark, part) in (1..).zip(self.islands.iter().flatten()) {
            let Some((corner, soft)) = part.soft() else { continue };
            let (left, top) = (corner[0] * factor, corner[1] * factor);
            let (right, bottom) = (
                (left + soft.width() * factor).min(width),
                (top + soft.height() * factor).min(height),
            );
            let fine = filter::spread(&soft, factor, right - left, bottom - top);
            for (row, values) in (top..bottom).zip(fine.values().chunks_exact(right - left)) {
                for (column, &value) in (left..right).zip(values) {
                    let at = row * width + column;
                    if value > most[at] && region.contains(at) {
                        (most[at], marks[at]) = (value, mark);
                    }
                }
            }
        }
        spread_marks(&mut marks, region);
        Some(marks)
    }

    fn parted(
        &mut self,
        whole: Piece,
        light: &Light<'_>,
        smallest: f64,
        interruption: &Interruption,
    ) -> Result<Vec<Piece>, Interrupted> {
        let (mut open, mut done) = (vec![whole], Vec::new());
        while let Some(piece) = open.pop() {
            interruption.check()?;
            let Some((cut, sides)) = cuts::strongest(&piece, light, smallest) else {
                done.push(piece);
                continue;
            };
            let strength = cut.strength();
            let parted = strength >= PARTED && open.len() + done.len() + 2 <= MOST_PARTS;
            if (DOUBTED..1.0).contains(&strength) {
                let places =
                    cut.places().map(|place| place.map(|at| (at + 0.5) * self.factor as f64));
                self.doubts.push(Doubt {
                    places,
                    strength,
                    what: cut.seen(light.pixel_um),
                    parted,
                });
            }
            if parted {
                open.extend(sides);
            } else {
                done.push(piece);
            }
        }
        Ok(done)
    }
}

/// Pixels of the region without a mark take the mark of a connected pixel.
fn spread_marks(marks: &mut [u32], region: &Region) {
    let width = region.width();
    let mut open: Vec<usize> = (0..marks.len()).filter(|&at| marks[at] != 0).collect();
    while !open.is_empty() {
        let mut next = Vec::new();
        for at in open {
            let sides = [
                (at % width > 0).then(|| at - 1),
                (at % width + 1 < width).then_some(at + 1),
                at.checked_sub(width),
                (at + width < marks.len()).then_some(at + width),
            ];
            for side in sides.into_iter().flatten() {
                if marks[side] == 0 && region.contains(side) {
                    marks[side] = marks[at];
                    next.push(side);
                }
            }
        }
        open = next;
    }
}
