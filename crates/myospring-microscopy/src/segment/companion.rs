//! Whether something dim lies beside a bright candidate that single pixels do not show for noise: the other half of a
//! cell that is stained unevenly. Light that is averaged over blocks shows what is far below the noise of a pixel.

use super::evidence::Grid;
use crate::filter::{self, bulk, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Islands, Region, Window};

/// Side of the blocks over which light is averaged, um.
const BLOCK_UM: f64 = 4.0;
/// What stands out, in standard deviations of the blocks of the ground, and at least in parts of the brightest.
const STANDS_OUT: f32 = 4.0;
const STANDS_OUT_LEAST: f32 = 0.01;
/// Scattered light fades from the outline on; a part of a cell stays as bright. The light from and to so far away, um, is
/// compared with that beyond, which must have at least so much of it.
const NEAR_UM: [f64; 2] = [6.0, 14.0];
const FADES: f32 = 0.6;
/// Closer to the outline it is no other part, um.
const RIM_UM: f64 = 2.0;
/// What reaches the frame with more of its rim is several cells.
const MOST_ON_FRAME: f64 = 0.25;

/// A picture in blocks.
pub(super) struct Blocks {
    light: Plane,
    islands: Islands,
    on_frame: Vec<f64>,
    /// Pixels along the side of a block.
    factor: usize,
}

impl Blocks {
    /// Of light above the ground on a coarse grid; `bright` is the brightness of the brightest.
    pub(super) fn of(plain: &Plane, grid: Grid, bright: f32) -> Self {
        let blocks = ((BLOCK_UM / grid.pixel_um()).round() as usize).max(1);
        let factor = blocks * grid.factor;
        let light = filter::coarse(plain, blocks);
        let [middle, scatter] = bulk(light.values());
        let least = middle + (STANDS_OUT * scatter).max(STANDS_OUT_LEAST * bright);
        let above = light.values().iter().map(|&value| value > least);
        let standing = Region::new(light.width(), light.height(), above);
        let islands = standing.islands(Connectivity::Four);
        let on_frame = islands.on_frame(light.width(), light.height());
        Self { light, islands, on_frame, factor }
    }

    /// The columns and rows of what stands out at a pixel, the first and the last, unless it is of several cells.
    pub(super) fn bounds(&self, column: usize, row: usize) -> Option<[[usize; 2]; 2]> {
        let (column, row) = (column / self.factor, row / self.factor);
        let inside = column < self.light.width() && row < self.light.height();
        let number = inside.then(|| self.islands.numbers[row * self.light.width() + column])?;
        let island = (number as usize).checked_sub(1)?;
        let part = self.islands.list[island];
        let pixels =
            |[first, last]: [usize; 2]| [first * self.factor, (last + 1) * self.factor - 1];
        (self.on_frame[island] <= MOST_ON_FRAME).then(|| [part.columns, part.rows].map(pixels))
    }

    /// Part of all that stands out there and lies beyond a region, where `hidden` says that light as dim shows no texture;
    /// 0 where that fades away from the outline.
    pub(super) fn beside(
        &self,
        own: &Region,
        others: &Region,
        window: &Window,
        pixel_um: f64,
        hidden: impl Fn(f32) -> bool,
    ) -> f64 {
        let [near, far] = NEAR_UM.map(|um| own.grown((um / pixel_um).max(1.0)));
        let columns = self.light.width();
        let place = |at: usize| {
            let [column, row] = window.place(at % window.width(), at / window.width());
            let (column, row) = (column / self.factor, row / self.factor);
            (row < self.light.height() && column < columns).then(|| row * columns + column)
        };
        let mut counts = vec![0_usize; self.on_frame.len() + 1];
        for at in (0..own.pixels()).filter(|&at| own.contains(at)) {
            counts[place(at).map_or(0, |at| self.islands.numbers[at] as usize)] += 1;
        }
        let island = (1..counts.len()).max_by_key(|&number| counts[number]).unwrap_or(0);
        if island == 0 || counts[island] == 0 || self.on_frame[island - 1] > MOST_ON_FRAME {
            return 0.0;
        }
        let rim = own.grown((RIM_UM / pixel_um).max(1.0));
        let (mut beyond, mut close, mut away) = (0_usize, Vec::new(), Vec::new());
        for at in (0..own.pixels()).filter(|&at| !rim.contains(at) && !others.contains(at)) {
            let Some(block) =
                place(at).filter(|&block| self.islands.numbers[block] as usize == island)
            else {
                continue;
            };
            beyond += 1;
            let light = self.light.values()[block];
            match (near.contains(at), far.contains(at)) {
                (false, true) if hidden(light) => close.push(light),
                (false, false) if hidden(light) => away.push(light),
                _ => {}
            }
        }
        if away.is_empty() || quantile(&away, 0.5) < FADES * quantile(&close, 0.5) {
            return 0.0;
        }
        beyond as f64 / (beyond + own.count()) as f64
    }
}
