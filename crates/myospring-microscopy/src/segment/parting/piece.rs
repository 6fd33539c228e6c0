//! A connected set of pixels in a window of its own.

use crate::filter;
use crate::outlines::trace::follow;
use crate::plane::Plane;
use crate::region::Island;
use crate::segment::confidence::solidity;

/// A part of an island, in a window with a margin of one pixel.
pub(super) struct Piece {
    /// Column and row of the picture at the second column and row of the window.
    pub(super) corner: [usize; 2],
    pub(super) width: usize,
    pub(super) inside: Vec<bool>,
}

/// Scale of smoothing the rim between two parts, pixels, and its reach.
const SOFT: f64 = 1.0;
const MARGIN: usize = 2;
/// Sides of a cut to which a pixel belongs.
const NO_SIDE: u8 = 0;
const THROUGH: u8 = u8::MAX;

impl Piece {
    /// The piece of an island, in a picture of `columns` columns.
    pub(super) fn of(numbers: &[u32], columns: usize, number: u32, island: &Island) -> Self {
        let corner = [island.columns[0], island.rows[0]];
        let inner = island.columns[1] + 1 - corner[0];
        let width = inner + 2;
        let mut inside = vec![false; width * (island.rows[1] + 3 - corner[1])];
        let rows = inside.chunks_exact_mut(width).skip(1);
        for (row, to) in (corner[1]..=island.rows[1]).zip(rows) {
            let from = &numbers[row * columns + corner[0]..][..inner];
            for (to, &from) in to[1..].iter_mut().zip(from) {
                *to = from == number;
            }
        }
        Self { corner, width, inside }
    }

    /// The pixels on one side of a cut, in their bounding window.
    fn part(&self, sides: &[u8], side: u8) -> Self {
        let places = || (0..sides.len()).filter(|&at| sides[at] == side);
        let columns = || places().map(|at| at % self.width);
        let [left, right] = [columns().min().unwrap_or(1), columns().max().unwrap_or(1)];
        let [first, last] =
            [places().next(), places().next_back()].map(|at| at.unwrap_or(0) / self.width);
        let width = right - left + 3;
        let mut inside = vec![false; width * (last - first + 3)];
        for at in places() {
            inside[(at / self.width - first + 1) * width + at % self.width - left + 1] = true;
        }
        Self { corner: [self.corner[0] + left - 1, self.corner[1] + first - 1], width, inside }
    }

    pub(super) fn height(&self) -> usize {
        self.inside.len() / self.width
    }

    pub(super) fn count(&self) -> usize {
        self.inside.iter().filter(|inside| **inside).count()
    }

    /// Whether the pixel at a place of the picture is inside.
    pub(super) fn contains(&self, [x, y]: [f64; 2]) -> bool {
        // Negative values become 0, the margin of the window, which is never inside.
        let column = (x - self.corner[0] as f64 + 1.5) as usize;
        let row = (y - self.corner[1] as f64 + 1.5) as usize;
        column < self.width && self.inside.get(row * self.width + column) == Some(&true)
    }

    /// Column and row of the picture for an index of the window.
    pub(super) fn place(&self, at: usize) -> [f64; 2] {
        let [column, row] = [at % self.width + self.corner[0], at / self.width + self.corner[1]];
        [column as f64 - 1.0, row as f64 - 1.0]
    }

    /// The pixels of the outer rim in order, as columns and rows of the picture.
    pub(super) fn rim(&self) -> Vec<[f64; 2]> {
        let Some(first) = self.inside.iter().position(|inside| *inside) else { return Vec::new() };
        let width = self.width.cast_signed();
        let inside = |column: isize, row: isize| self.inside[(row * width + column) as usize];
        let mut rim: Vec<[f64; 2]> = Vec::new();
        follow([first.cast_signed() % width, first.cast_signed() / width], inside, |step| {
            let place = self.place((step.pixel[1] * width + step.pixel[0]) as usize);
            if rim.last() != Some(&place) {
                rim.push(place);
            }
        });
        rim
    }

    /// Area over that of the convex hull.
    pub(super) fn solidity(&self) -> f64 {
        solidity(self.rim().into_iter(), self.count())
    }

    /// The distance of each pixel's centre from the outside, pixels: a step to a side neighbour
    /// counts 1, a diagonal step 4/3 (Borgefors 1986).
    pub(super) fn depths(&self) -> Vec<f32> {
        let width = self.width;
        let mut depths: Vec<u32> =
            self.inside.iter().map(|&is| if is { u32::MAX / 2 } else { 0 }).collect();
        for at in 0..depths.len() {
            if depths[at] > 0 {
                let before =
                    [(at - 1, 3), (at - width - 1, 4), (at - width, 3), (at - width + 1, 4)];
                depths[at] = before
                    .map(|(next, step)| depths[next] + step)
                    .into_iter()
                    .fold(depths[at], u32::min);
            }
        }
        for at in (0..depths.len()).rev() {
            if depths[at] > 0 {
                let after =
                    [(at + 1, 3), (at + width + 1, 4), (at + width, 3), (at + width - 1, 4)];
                depths[at] = after
                    .map(|(next, step)| depths[next] + step)
                    .into_iter()
                    .fold(depths[at], u32::min);
            }
        }
        // Measured from the edge of the last inside pixel, not from the centre of the first outside
        // one.
        depths.into_iter().map(|depth| (depth as f32 / 3.0 - 0.5).max(0.0)).collect()
    }

    /// The side (1 or 2) of each pixel for a cut along these places; `None` if it does not separate
    /// the piece.
    pub(super) fn sides(&self, path: impl Iterator<Item = [f64; 2]>) -> Option<Vec<u8>> {
        let mut sides: Vec<u8> = self.inside.iter().map(|_| NO_SIDE).collect();
        let mut through = Vec::new();
        for [x, y] in path {
            let [column, row] =
                [x - self.corner[0] as f64, y - self.corner[1] as f64].map(|at| at.round() + 1.0);
            let at = row as usize * self.width + column as usize;
            if sides.get(at) == Some(&NO_SIDE) && self.inside[at] {
                sides[at] = THROUGH;
                through.push(at);
            }
        }
        let near = |at: usize| [at - 1, at + 1, at - self.width, at + self.width];
        let starts: Vec<usize> = through.iter().copied().flat_map(near).collect();
        let mut sizes = Vec::new();
        let mut open = Vec::new();
        for start in starts {
            if !self.inside[start] || sides[start] != NO_SIDE || sizes.len() == 250 {
                continue;
            }
            let side = sizes.len() as u8 + 1;
            let mut size = 0;
            sides[start] = side;
            open.push(start);
            while let Some(at) = open.pop() {
                size += 1;
                for next in near(at) {
                    if self.inside[next] && sides[next] == NO_SIDE {
                        sides[next] = side;
                        open.push(next);
                    }
                }
            }
            sizes.push(size);
        }
        let mut order: Vec<usize> = (0..sizes.len()).collect();
        order.sort_by_key(|&side| std::cmp::Reverse(sizes[side]));
        let [first, second] = [*order.first()?, *order.get(1)?].map(|side| side as u8 + 1);
        // Pixels on neither side take the side of a neighbour.
        let mut front = Vec::new();
        for (at, side) in sides.iter_mut().enumerate().filter(|(at, _)| self.inside[*at]) {
            *side = if *side == first {
                1
            } else if *side == second {
                2
            } else {
                NO_SIDE
            };
            if *side != NO_SIDE {
                front.push(at);
            }
        }
        while !front.is_empty() {
            let mut next_front = Vec::new();
            for at in front {
                for next in near(at) {
                    if self.inside[next] && sides[next] == NO_SIDE {
                        sides[next] = sides[at];
                        next_front.push(next);
                    }
                }
            }
            front = next_front;
        }
        Some(sides)
    }

    /// The piece as a plane with soft edges (1 inside, 0 outside), and the column and row of its
    /// first pixel in the picture.
    pub(super) fn soft(&self) -> Option<([usize; 2], Plane)> {
        let corner = self.corner.map(|at| at.saturating_sub(MARGIN + 1));
        let [left, top] = [0, 1].map(|axis| self.corner[axis] - corner[axis]);
        let inner = self.height();
        let (width, height) = (left + self.width + MARGIN, top + inner + MARGIN);
        let mut values = vec![0.0; width * height];
        for at in (0..self.inside.len()).filter(|&at| self.inside[at]) {
            values[(at / self.width + top - 1) * width + at % self.width + left - 1] = 1.0;
        }
        let hard = Plane::new(width, height, values);
        hard.map(|hard| (corner, filter::gaussian(&hard, SOFT)))
    }

    /// Both parts.
    pub(super) fn parts(&self, sides: &[u8]) -> [Self; 2] {
        [1, 2].map(|side| self.part(sides, side))
    }
}
