//! Cells that touch are parted where their shape, their brightness or their stripes say that they are two.
//!
//! One island of the region at a time. Straight cuts from rim to rim are looked at ([`cuts`]), and what speaks for
//! each of them ([`cut`]): a neck between two wide parts, a dark line from rim to rim, stripes that change their
//! direction. The strongest is cut where it is strong enough, and both parts are looked at again. What is neither
//! surely one cell nor surely two stays one, with a doubt in words.

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
use piece::Piece;

/// Coarsest pixel that shape needs, um: a tenth of a narrow cell.
const PIXEL_UM: f64 = 0.75;
/// Most cells of one island: more of them are a tissue, or a picture of noise.
const MOST_PARTS: usize = 64;

/// What speaks for another number of cells than was taken.
pub(super) struct Doubt {
    /// The middle of the cut and one place on each side of it: column and row on the region's grid.
    places: [[f64; 2]; 3],
    /// How much, 0 nothing, 1 all.
    strength: f64,
    /// What was seen.
    what: String,
    /// Whether the cells were parted there.
    parted: bool,
}

impl Doubt {
    /// How sure the cells are that have it, 0 to 1.
    pub(super) fn factor(&self) -> f64 {
        if self.parted {
            return self.strength;
        }
        0.79 - 0.4 * (self.strength - DOUBTED) / (PARTED - DOUBTED)
    }

    /// The cells that have it, in a picture of whose pixels `factor` make the side of one of the region's.
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

    /// What a person should know.
    pub(super) fn reason(&self, factor: usize) -> String {
        let [column, row] = self.places[0].map(|at| at * factor as f64);
        let what = &self.what;
        if self.parted {
            return format!(
                "it was parted from its neighbour at {what}, column {column:.0}, row {row:.0}: are both one cell?"
            );
        }
        format!(
            "it has {what} at column {column:.0}, row {row:.0}: are these two cells that touch? Then draw the \
             outline of one, or give a label mask"
        )
    }
}

/// The parts of the islands of a region.
pub(super) struct Parting {
    /// Pixels of the region's grid along the side of one of the parts'.
    factor: usize,
    /// Islands that are several cells: their parts, in windows.
    islands: Vec<Vec<Piece>>,
    /// What is not sure.
    pub(super) doubts: Vec<Doubt>,
}

impl Parting {
    /// Looks at each island.
    pub(super) fn of(region: &Region, seen: &Seen<'_>) -> Self {
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
            let parts = parting.parted(whole, &light, smallest);
            if parts.len() > 1 {
                parting.islands.push(parts);
            }
        }
        parting
    }

    /// The part to which each pixel of an island of several cells belongs, 0 for all other islands, in a picture of
    /// whose pixels `factor` make the side of one of the region's; `None` if there is no such island.
    pub(super) fn marks(&self, region: &Region, factor: usize) -> Option<Vec<u32>> {
        if self.islands.is_empty() {
            return None;
        }
        let (width, height) = (region.width(), region.height());
        let factor = self.factor * factor;
        let mut marks = vec![0; region.pixels()];
        // Less is beyond the rim: of another island, perhaps.
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

    fn parted(&mut self, whole: Piece, light: &Light<'_>, smallest: f64) -> Vec<Piece> {
        let (mut open, mut done) = (vec![whole], Vec::new());
        while let Some(piece) = open.pop() {
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
        done
    }
}

/// What of the region has no mark takes that of what it hangs together with.
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
