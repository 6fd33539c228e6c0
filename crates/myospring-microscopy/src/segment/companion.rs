//! Finds dim light next to a bright candidate that is hidden by the noise of single pixels: the
//! other half of an unevenly stained cell. Averages over blocks reveal light far below the noise of
//! a pixel; larger blocks reveal dimmer light. The candidate's own light is left out of the blocks
//! around it.

use super::evidence::Grid;
use crate::filter::{self, bulk, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Islands, Region, Window};

/// Sides of the blocks over which light is averaged, um.
const BLOCKS_UM: [f64; 3] = [4.0, 8.0, 16.0];
/// Least brightness of a block above the background, in standard deviations of background blocks,
/// and as a part of the brightest.
const STANDS_OUT: f32 = 4.0;
const STANDS_OUT_LEAST: f32 = 0.003;
/// Scattered light fades with the distance from the outline; a part of a cell does not. The light
/// at these distances, um, is compared with that beyond, which must be at least this part of it.
const NEAR_UM: [f64; 2] = [6.0, 14.0];
const FADES: f32 = 0.6;
/// Light within this distance of the outline is not another part, um.
const RIM_UM: f64 = 2.0;
/// An island with a larger part of its rim on the frame is several cells.
const MOST_ON_FRAME: f64 = 0.25;
/// Least number of blocks from which the scatter of the background is measured.
const FEWEST_BLOCKS: usize = 40;
/// Least part of a block outside the candidate.
const LEAST_BESIDE: f32 = 0.5;

/// A picture in blocks of several sizes.
pub(super) struct Blocks {
    /// Light above the ground, on a coarse grid with `factor` pixels along the side of its own.
    plain: Plane,
    factor: usize,
    sizes: Vec<Size>,
}

/// A picture in blocks of one size.
struct Size {
    /// Side of a block, pixels of the coarse grid.
    blocks: usize,
    /// Standard deviation of background blocks, and least brightness of a bright block.
    scatter: f32,
    middle: f32,
    least: f32,
    /// Number of blocks along a row, and islands of bright blocks.
    columns: usize,
    islands: Islands,
    on_frame: Vec<f64>,
}

impl Blocks {
    /// Computes blocks from light above the background on a coarse grid; `bright` is the brightness
    /// of the brightest objects.
    pub(super) fn of(plain: &Plane, grid: Grid, bright: f32) -> Self {
        let mut sizes: Vec<Size> = Vec::new();
        for um in BLOCKS_UM {
            let blocks = ((um / grid.pixel_um()).round() as usize).max(1);
            let light = filter::coarse(plain, blocks);
            if light.values().len() < FEWEST_BLOCKS && !sizes.is_empty() {
                break;
            }
            let [middle, scatter] = bulk(light.values());
            let least = middle + (STANDS_OUT * scatter).max(STANDS_OUT_LEAST * bright);
            let above = light.values().iter().map(|&value| value > least);
            let standing = Region::new(light.width(), light.height(), above);
            let islands = standing.islands(Connectivity::Four);
            let on_frame = islands.on_frame(light.width(), light.height());
            let columns = light.width();
            sizes.push(Size { blocks, scatter, middle, least, columns, islands, on_frame });
        }
        Self { plain: plain.clone(), factor: grid.factor, sizes }
    }

    /// First and last column and row of the bright island at a pixel; `None` if the island is
    /// several cells.
    pub(super) fn bounds(&self, column: usize, row: usize) -> Option<[[usize; 2]; 2]> {
        let both = |a: [[usize; 2]; 2], b: [[usize; 2]; 2]| {
            [0, 1].map(|side| [a[side][0].min(b[side][0]), a[side][1].max(b[side][1])])
        };
        let bounds = self.sizes.iter().filter_map(|size| {
            let side = size.blocks * self.factor;
            let island = size.island(column / side, row / side)?;
            let part = size.islands.list[island];
            let pixels = |[first, last]: [usize; 2]| [first * side, (last + 1) * side - 1];
            Some([part.columns, part.rows].map(pixels))
        });
        bounds.reduce(both)
    }

    /// Part of the bright island that lies beyond a region, where `hidden` says that light so dim
    /// shows no texture; 0 if it fades with the distance from the outline.
    pub(super) fn beside(
        &self,
        own: &Region,
        others: &Region,
        window: &Window,
        pixel_um: f64,
        hidden: impl Fn(f32) -> bool,
    ) -> f64 {
        let grown = |um: f64| own.grown((um / pixel_um).max(1.0));
        let around = Around { own, rim: grown(RIM_UM), others, near: NEAR_UM.map(grown), window };
        let shares = self.sizes.iter().map(|size| self.share(size, &around, &hidden));
        shares.fold(0.0, f64::max)
    }

    /// The same for blocks of one size.
    fn share(&self, size: &Size, around: &Around<'_>, hidden: &impl Fn(f32) -> bool) -> f64 {
        let Around { own, rim, others, near: [near, far], window } = around;
        let side = size.blocks * self.factor;
        let [left, top] = [window.columns.start / side, window.rows.start / side];
        let width = window.columns.end.div_ceil(side) - left;
        let height = window.rows.end.div_ceil(side) - top;
        let mut blocks = vec![Block::default(); width * height];
        for at in 0..own.pixels() {
            let [column, row] = window.place(at % window.width(), at / window.width());
            let block = &mut blocks[(row / side - top) * width + column / side - left];
            block.pixels += 1;
            block.own += usize::from(own.contains(at));
            let (x, y) = (column / self.factor, row / self.factor);
            if !rim.contains(at)
                && !others.contains(at)
                && x < self.plain.width()
                && y < self.plain.height()
            {
                block.beside += 1;
                block.light += f64::from(self.plain.at(x, y));
                block.near += usize::from(near.contains(at));
                block.far += usize::from(far.contains(at));
            }
        }
        let whole = (side * side) as f32;
        let stands = |block: &Block| {
            let part = block.beside as f32 / whole;
            // The mean of fewer pixels scatters more.
            let least = size.least + STANDS_OUT * size.scatter * (part.max(1e-3).powf(-0.5) - 1.0);
            part >= LEAST_BESIDE && block.mean() > least
        };
        let is_own = |block: &Block| 2 * block.own > block.pixels;
        let standing = blocks.iter().map(|block| is_own(block) || stands(block));
        let islands = Region::new(width, height, standing).islands(Connectivity::Four);
        let mut counts = vec![0_usize; islands.list.len() + 1];
        for (block, &number) in blocks.iter().zip(&islands.numbers) {
            counts[number as usize] += usize::from(number > 0) * block.own;
        }
        let number = (1..counts.len()).max_by_key(|&number| counts[number]).unwrap_or(0);
        let middle = (0..own.pixels()).filter(|&at| own.contains(at)).nth(own.count() / 2);
        let several = middle.is_none_or(|at| {
            let [column, row] = window.place(at % window.width(), at / window.width());
            size.island(column / side, row / side).is_none()
        });
        if number == 0 || counts[number] == 0 || several {
            return 0.0;
        }
        let (mut beyond, mut close, mut away) = (0_usize, Vec::new(), Vec::new());
        for (block, &island) in blocks.iter().zip(&islands.numbers) {
            if island as usize != number || !stands(block) {
                continue;
            }
            beyond += block.beside;
            let light = block.mean();
            match (2 * block.near > block.beside, 2 * block.far > block.beside) {
                (false, true) if hidden(light) => close.push(light - size.middle),
                (false, false) if hidden(light) => away.push(light - size.middle),
                _ => {}
            }
        }
        if away.is_empty() || quantile(&away, 0.5) < FADES * quantile(&close, 0.5) {
            return 0.0;
        }
        beyond as f64 / (beyond + own.count()) as f64
    }
}

impl Size {
    /// The bright island of a block; `None` if it is several cells.
    fn island(&self, column: usize, row: usize) -> Option<usize> {
        let at = (column < self.columns).then(|| row * self.columns + column)?;
        let island = (*self.islands.numbers.get(at)? as usize).checked_sub(1)?;
        (self.on_frame[island] <= MOST_ON_FRAME).then_some(island)
    }
}

/// A candidate with what surrounds it.
struct Around<'a> {
    own: &'a Region,
    rim: Region,
    others: &'a Region,
    near: [Region; 2],
    window: &'a Window,
}

/// Pixels of one block: all within the window, those of the candidate, and those outside it with
/// their light.
#[derive(Debug, Clone, Default)]
struct Block {
    pixels: usize,
    own: usize,
    beside: usize,
    near: usize,
    far: usize,
    light: f64,
}

impl Block {
    fn mean(&self) -> f32 {
        (self.light / self.beside.max(1) as f64) as f32
    }
}
