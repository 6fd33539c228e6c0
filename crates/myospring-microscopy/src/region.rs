//! Sets of pixels: closing gaps, filling holes, numbering islands, smoothing rims.

use std::ops::Range;

use super::dilation::{Norm, dilated, eroded};
use super::filter;
use super::plane::Plane;
use super::runs::{Run, runs};

/// Rows that are smoothed at a time.
const BAND: usize = 64;

/// A set of pixels of a picture, row by row from the top left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Region {
    width: usize,
    height: usize,
    inside: Vec<bool>,
}

/// Which pixels count as connected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Connectivity {
    /// Those that share a side.
    Four,
    /// Those that share a side or a corner.
    Eight,
}

/// Islands (connected components) of a region, numbered from 1; 0 is outside.
pub(super) struct Islands {
    /// Number of each pixel.
    pub(super) numbers: Vec<u32>,
    /// The islands; island n has index n - 1.
    pub(super) list: Vec<Island>,
}

/// One island.
#[derive(Debug, Clone, Copy)]
pub(super) struct Island {
    pub(super) pixels: usize,
    /// First and last column and row.
    pub(super) columns: [usize; 2],
    pub(super) rows: [usize; 2],
}

impl Islands {
    /// For each island, the part of its rim that lies on the frame of a plane of this size.
    pub(super) fn on_frame(&self, width: usize, height: usize) -> Vec<f64> {
        let mut counts = vec![[0_usize; 2]; self.list.len()];
        for (at, &number) in self.numbers.iter().enumerate().filter(|(_, number)| **number > 0) {
            let (column, row) = (at % width, at / width);
            let count = &mut counts[number as usize - 1];
            if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
                count[0] += 1;
            } else {
                let sides = [at - 1, at + 1, at - width, at + width];
                count[1] += usize::from(sides.iter().any(|&side| self.numbers[side] != number));
            }
        }
        counts.iter().map(|&[on, off]| on as f64 / (on + off).max(1) as f64).collect()
    }
}

impl Island {
    /// An island without pixels, in a picture of this size.
    fn none(width: usize, height: usize) -> Self {
        Self { pixels: 0, columns: [width, 0], rows: [height, 0] }
    }

    fn add(&mut self, run: &Run) {
        self.pixels += run.to - run.from;
        self.columns = [self.columns[0].min(run.from), self.columns[1].max(run.to - 1)];
        self.rows = [self.rows[0].min(run.row), self.rows[1].max(run.row)];
    }

    /// The islands of the runs of a picture of this size.
    fn list(runs: &[Run], width: usize, height: usize) -> Vec<Self> {
        let count = runs.iter().map(|run| run.island + 1).max().unwrap_or(0);
        let mut list = vec![Self::none(width, height); count];
        for run in runs {
            list[run.island].add(run);
        }
        list
    }

    /// Length of the diagonal of its bounding box, pixels.
    pub(super) fn extent(&self) -> f64 {
        let side = |[first, last]: [usize; 2]| (last - first + 1) as f64;
        side(self.columns).hypot(side(self.rows))
    }

    /// Number of sides of the picture that it reaches.
    pub(super) fn sides(&self, width: usize, height: usize) -> usize {
        let reach = |[first, last]: [usize; 2], count: usize| {
            usize::from(first == 0) + usize::from(last + 1 == count)
        };
        reach(self.columns, width) + reach(self.rows, height)
    }
}

/// A rectangle of pixels.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Window {
    pub(super) columns: Range<usize>,
    pub(super) rows: Range<usize>,
}

impl Window {
    /// The bounding box of an island with a margin of `margin` pixels within the picture, aligned
    /// to blocks of `block` x `block` pixels.
    pub(super) fn around(
        island: &Island,
        margin: usize,
        block: usize,
        [width, height]: [usize; 2],
    ) -> Self {
        let widened = |[first, last]: [usize; 2], count: usize| {
            first.saturating_sub(margin) / block * block..(last + margin + 1).min(count)
        };
        Self { columns: widened(island.columns, width), rows: widened(island.rows, height) }
    }

    pub(super) fn width(&self) -> usize {
        self.columns.len()
    }

    pub(super) fn height(&self) -> usize {
        self.rows.len()
    }

    fn overlaps(&self, other: &Self) -> bool {
        let meet = |a: &Range<usize>, b: &Range<usize>| a.start < b.end && b.start < a.end;
        meet(&self.columns, &other.columns) && meet(&self.rows, &other.rows)
    }

    fn join(&mut self, other: &Self) {
        let both = |a: &Range<usize>, b: &Range<usize>| a.start.min(b.start)..a.end.max(b.end);
        self.columns = both(&self.columns, &other.columns);
        self.rows = both(&self.rows, &other.rows);
    }

    /// Converts a window within this one to the picture's coordinates.
    pub(super) fn part(&self, within: &Self) -> Self {
        let shifted =
            |own: &Range<usize>, part: &Range<usize>| own.start + part.start..own.start + part.end;
        Self {
            columns: shifted(&self.columns, &within.columns),
            rows: shifted(&self.rows, &within.rows),
        }
    }

    /// Column and row of the picture for a column and row of the window.
    pub(super) fn place(&self, column: usize, row: usize) -> [usize; 2] {
        [self.columns.start + column, self.rows.start + row]
    }

    /// The same window on a grid finer by `factor`, with a margin of `margin` fine pixels within
    /// the picture.
    pub(super) fn finer(&self, factor: usize, margin: usize, [width, height]: [usize; 2]) -> Self {
        let widened = |range: &Range<usize>, count: usize| {
            (range.start * factor).saturating_sub(margin)..(range.end * factor + margin).min(count)
        };
        Self { columns: widened(&self.columns, width), rows: widened(&self.rows, height) }
    }

    /// The values within the window, from a picture of `width` columns.
    pub(super) fn cut<T: Copy>(&self, values: &[T], width: usize) -> Vec<T> {
        let row = |row: usize| &values[row * width..][self.columns.clone()];
        self.rows.clone().flat_map(row).copied().collect()
    }
}

impl Region {
    /// The pixels for which `inside` is true.
    pub(super) fn new(width: usize, height: usize, inside: impl Iterator<Item = bool>) -> Self {
        let mut inside: Vec<bool> = inside.take(width * height).collect();
        inside.resize(width * height, false);
        Self { width, height, inside }
    }

    pub(super) fn width(&self) -> usize {
        self.width
    }

    pub(super) fn height(&self) -> usize {
        self.height
    }

    pub(super) fn inside(&self) -> impl Iterator<Item = bool> + '_ {
        self.inside.iter().copied()
    }

    /// The intersection of two regions.
    pub(super) fn and(&self, other: &Self) -> Self {
        let both = self.inside().zip(other.inside()).map(|(a, b)| a && b);
        Self::new(self.width, self.height, both)
    }

    pub(super) fn count(&self) -> usize {
        self.inside().filter(|&is| is).count()
    }

    /// Morphological closing: fills gaps and bays narrower than `2 radius` pixels, except at the
    /// picture's rim.
    pub(super) fn closed(&self, radius: f64) -> Self {
        self.grown(radius).shrunk(radius)
    }

    /// Morphological opening: removes necks and tips narrower than `2 radius` pixels.
    pub(super) fn opened(&self, radius: f64) -> Self {
        self.shrunk(radius).grown(radius)
    }

    /// Dilation by `radius` pixels, rounded to a whole number.
    pub(super) fn grown(&self, radius: f64) -> Self {
        let inside = dilated(&self.inside, self.width, radius.round() as usize, Norm::Euclid);
        Self { inside, ..*self }
    }

    /// Erosion by `radius` pixels, rounded to a whole number.
    pub(super) fn shrunk(&self, radius: f64) -> Self {
        let inside = eroded(&self.inside, self.width, radius.round() as usize, Norm::Euclid);
        Self { inside, ..*self }
    }

    /// The region on a grid of blocks of `factor` x `factor` pixels: the blocks that contain a
    /// pixel of the region.
    pub(super) fn coarse(&self, factor: usize) -> Self {
        let (width, height) = (self.width().div_ceil(factor), self.height().div_ceil(factor));
        let mut blocks = vec![false; width * height];
        for (row, pixels) in self.inside.chunks_exact(self.width).enumerate() {
            let blocks = &mut blocks[row / factor * width..][..width];
            for (block, pixels) in blocks.iter_mut().zip(pixels.chunks(factor)) {
                *block |= pixels.contains(&true);
            }
        }
        Self::new(width, height, blocks.into_iter())
    }

    /// The region on a grid of blocks of `factor` x `factor` pixels: the blocks of which it covers
    /// at least half.
    pub(super) fn halves(&self, factor: usize) -> Self {
        if factor == 1 {
            return self.clone();
        }
        let (width, height) = (self.width().div_ceil(factor), self.height().div_ceil(factor));
        let mut counts = vec![0_usize; width * height];
        for (row, pixels) in self.inside.chunks_exact(self.width).enumerate() {
            let counts = &mut counts[row / factor * width..][..width];
            for (count, pixels) in counts.iter_mut().zip(pixels.chunks(factor)) {
                *count += pixels.iter().filter(|inside| **inside).count();
            }
        }
        let half = |count: usize| 2 * count >= factor * factor;
        Self::new(width, height, counts.into_iter().map(half))
    }

    /// The region on a grid that is finer by `factor`.
    pub(super) fn spread(&self, factor: usize, width: usize, height: usize) -> Self {
        let mut inside = vec![false; width * height];
        let blocks = self.inside.chunks_exact(self.width);
        for (rows, blocks) in inside.chunks_mut(factor * width).zip(blocks) {
            let (first, others) = rows.split_at_mut(width);
            for (pixels, &block) in first.chunks_mut(factor).zip(blocks) {
                pixels.fill(block);
            }
            for row in others.chunks_exact_mut(width) {
                row.copy_from_slice(first);
            }
        }
        Self { width, height, inside }
    }

    /// The region on pixels `ratio` times as wide.
    pub(super) fn resampled(&self, ratio: f64, width: usize, height: usize) -> Self {
        let place = |at: usize, count: usize| {
            (((at as f64 + 0.5) * ratio) as usize).min(count.saturating_sub(1))
        };
        let columns: Vec<usize> = (0..width).map(|at| place(at, self.width)).collect();
        let rows: Vec<usize> = (0..height).map(|at| place(at, self.height)).collect();
        let mut inside = Vec::with_capacity(width * height);
        for row in rows {
            inside.extend(columns.iter().map(|column| self.inside[row * self.width + column]));
        }
        Self { width, height, inside }
    }

    /// The region, which lies in the window `coarse` of a coarse grid, on the window `fine` of a
    /// grid that is finer by `factor`.
    pub(super) fn spread_within(&self, coarse: &Window, factor: usize, fine: &Window) -> Self {
        let inside = |at: usize| {
            let [column, row] = fine.place(at % fine.width(), at / fine.width());
            let column = (column / factor).wrapping_sub(coarse.columns.start);
            let row = (row / factor).wrapping_sub(coarse.rows.start);
            column < self.width && row < self.height && self.inside[row * self.width + column]
        };
        Self::new(fine.width(), fine.height(), (0..fine.width() * fine.height()).map(inside))
    }

    /// Adds a part at the position of its window.
    pub(super) fn add(&mut self, part: &Self, window: &Window) {
        for at in (0..part.pixels()).filter(|&at| part.contains(at)) {
            let [column, row] = window.place(at % window.width(), at / window.width());
            self.inside[row * self.width + column] = true;
        }
    }

    /// Adds a part at the position of its window, except within two pixels of existing pixels, so
    /// that smoothing does not join them.
    pub(super) fn put_apart(&mut self, part: &Self, window: &Window) {
        let there = self.cut(window).grown(2.0);
        let apart = part.inside().zip(there.inside()).map(|(part, there)| part && !there);
        self.add(&Self::new(part.width, part.height, apart), window);
    }

    /// The bounding window of the region with a margin of `margin` pixels within the picture,
    /// aligned to blocks of `block` x `block` pixels; the whole picture if the region is empty.
    pub(super) fn window(&self, margin: usize, block: usize) -> Window {
        let (width, height) = (self.width(), self.height());
        let mut all = Island::none(width, height);
        for run in self.runs(Connectivity::Eight) {
            all.add(&run);
        }
        match all.pixels {
            0 => Window { columns: 0..width, rows: 0..height },
            _ => Window::around(&all, margin, block, [width, height]),
        }
    }

    /// A window for each island, with a margin of `margin` pixels within the picture; overlapping
    /// windows are merged.
    pub(super) fn windows(&self, margin: usize) -> Vec<Window> {
        let size = [self.width(), self.height()];
        let islands = Island::list(&self.runs(Connectivity::Eight), size[0], size[1]);
        let around = |island: &Island| Window::around(island, margin, 1, size);
        let mut windows: Vec<Window> = islands.iter().map(around).collect();
        loop {
            let before = windows.len();
            let mut apart: Vec<Window> = Vec::new();
            for window in windows {
                match apart.iter_mut().find(|other| other.overlaps(&window)) {
                    Some(other) => other.join(&window),
                    None => apart.push(window),
                }
            }
            windows = apart;
            if windows.len() == before {
                return windows;
            }
        }
    }

    /// The part of the region within a window.
    pub(super) fn cut(&self, window: &Window) -> Self {
        let inside = window.cut(&self.inside, self.width);
        Self { width: window.width(), height: window.height(), inside }
    }

    /// The region, cut out by a window, as a region of a picture of this size.
    pub(super) fn pasted(&self, window: &Window, width: usize, height: usize) -> Self {
        let mut whole = Self::new(width, height, std::iter::empty());
        whole.put(self, window);
        whole
    }

    /// Replaces the pixels of a window by a part.
    pub(super) fn put(&mut self, part: &Self, window: &Window) {
        let rows = part.inside.chunks_exact(window.width());
        for (row, values) in window.rows.clone().zip(rows) {
            self.inside[row * self.width..][window.columns.clone()].copy_from_slice(values);
        }
    }

    /// Number of pixels of the picture.
    pub(super) fn pixels(&self) -> usize {
        self.inside.len()
    }

    /// Whether the pixel at this place is in the region.
    pub(super) fn contains(&self, at: usize) -> bool {
        self.inside[at]
    }

    /// The region with every hole of at most `most` pixels filled; a hole is an outside area that
    /// does not reach the picture's rim.
    pub(super) fn filled(&self, most: usize) -> Self {
        let (width, height) = (self.width(), self.height());
        let outside = |at: usize| (!self.inside[at]).then_some(());
        let runs = runs(width, height, outside, false);
        let islands = Island::list(&runs, width, height);
        let is_hole = |island: &Island| island.sides(width, height) == 0 && island.pixels <= most;
        let mut filled = self.clone();
        for run in runs.iter().filter(|run| is_hole(&islands[run.island])) {
            filled.inside[run.row * width..][run.from..run.to].fill(true);
        }
        filled
    }

    /// The region with a smooth rim: the pixels where the region, blurred with a Gaussian of
    /// `sigma` pixels, exceeds one half.
    pub(super) fn smoothed(&self, sigma: f64) -> Self {
        if sigma < 0.3 {
            return self.clone();
        }
        let mut smooth = Self::new(self.width, self.height, std::iter::empty());
        let margin = filter::reach(sigma);
        // In bands, to save memory, and because most of a picture is outside.
        for first in (0..self.height).step_by(BAND) {
            let last = (first + BAND).min(self.height);
            let rows = first.saturating_sub(margin)..(last + margin).min(self.height);
            let pixels = &self.inside[rows.start * self.width..rows.end * self.width];
            if !pixels.contains(&true) {
                continue;
            }
            let values = pixels.iter().map(|&is| if is { 1.0 } else { 0.0 }).collect();
            let Some(plane) = Plane::new(self.width, rows.len(), values) else { continue };
            let plane = filter::gaussian(&plane, sigma);
            let values = &plane.values()[(first - rows.start) * self.width..];
            let pixels = &mut smooth.inside[first * self.width..last * self.width];
            for (pixel, &value) in pixels.iter_mut().zip(values) {
                *pixel = value > 0.5;
            }
        }
        smooth
    }

    /// The runs of the region, with the numbers of their islands.
    fn runs(&self, connectivity: Connectivity) -> Vec<Run> {
        let kind = |at: usize| self.inside[at].then_some(());
        runs(self.width, self.height, kind, connectivity == Connectivity::Eight)
    }

    /// Numbers the islands, in the order of their first pixels.
    pub(super) fn islands(&self, connectivity: Connectivity) -> Islands {
        self.numbered(&self.runs(connectivity))
    }

    /// Numbers the islands, where only pixels of the same mark are connected.
    pub(super) fn islands_of_marks(&self, connectivity: Connectivity, marks: &[u32]) -> Islands {
        let kind = |at: usize| self.inside[at].then(|| marks[at]);
        self.numbered(&runs(self.width, self.height, kind, connectivity == Connectivity::Eight))
    }

    fn numbered(&self, runs: &[Run]) -> Islands {
        let mut numbers = vec![0_u32; self.pixels()];
        for run in runs {
            numbers[run.row * self.width..][run.from..run.to].fill(run.island as u32 + 1);
        }
        Islands { numbers, list: Island::list(runs, self.width, self.height) }
    }

    /// The islands for which `keep` is true.
    pub(super) fn kept(&self, connectivity: Connectivity, keep: impl Fn(&Island) -> bool) -> Self {
        let runs = self.runs(connectivity);
        let islands = Island::list(&runs, self.width, self.height);
        let kept: Vec<bool> = islands.iter().map(keep).collect();
        let mut region = Self::new(self.width, self.height, std::iter::empty());
        for run in runs.iter().filter(|run| kept[run.island]) {
            region.inside[run.row * self.width..][run.from..run.to].fill(true);
        }
        region
    }
}
