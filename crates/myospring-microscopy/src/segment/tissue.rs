//! Whether what was found is a heart cell: something with a texture of its own, that ends at its outline, in a picture
//! that is not full of its like.
//!
//! How well an outline is seen says nothing of what lies within: letters, posts and patches of a sheet have outlines as
//! clear as cells. Each question here is independent of the others, and answers with a factor and a reason.

use super::Working;
use super::confidence::{Candidate, Confidence, PATCH};
use super::evidence::{TEXTURE_UM, texture_of};
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Islands, Region, Window};

/// Relative strength of the texture between the scales of stripes and grains: of something without, and of a cell.
/// Cells have 0.04 (a dissolved dye at 1 um a pixel) to 0.7 (z-discs).
const TEXTURE: [f64; 2] = [0.008, 0.025];
/// Part of the background's noise that texture can hide in: where this is more than a cell's texture, nobody can say.
const HIDDEN: f64 = 0.15;
/// The quietest places have so much less noise than the mean, by chance.
const QUIETEST: f32 = 1.3;
/// Coarsest pixel that shows what kind of texture there is, um.
const COARSEST_UM: f64 = 0.55;
/// Depth below the outline at which the texture is that of the inside, um: the outline itself has an edge.
const CORE_UM: f64 = 3.0;
/// Beyond the outline it is looked for from and to so far away, um.
const BEYOND_UM: [f64; 2] = [4.0, 7.0];
/// What lies beyond is more of the same if it has so much of the texture and of the brightness.
const SAME_TEXTURE: f32 = 0.4;
const SAME_LIGHT: f32 = 0.25;
/// Where the ground itself may be a sheet, its texture alone must be so much, and that within so clear.
const SAME_TEXTURE_ALONE: f32 = 0.5;
const CLEAR_TEXTURE: f64 = 0.18;
/// Scale on which light is averaged, um: more than a stripe.
const LIGHT_UM: f64 = 1.2;
/// Least variance of the texture beyond the outline, relative to that of the noise.
const ABOVE_NOISE: f32 = 0.5;
/// What stands out of the ground, in standard deviations of it, and at least in parts of the brightest.
const STANDS_OUT: f32 = 5.0;
const STANDS_OUT_LEAST: f32 = 0.01;
/// Gaps that are closed in it, and points that are taken off, um.
const TIDY_UM: f64 = 1.2;
/// Further from the outline than this it is no rim of the cell, um.
const RIM_UM: f64 = 2.0;
/// Part of all that stands out there and is left out: of half a cell, and of a whole one.
const LEFT_OUT: [f64; 2] = [0.6, 0.2];
/// What reaches the frame with more of its rim is several cells.
const MOST_ON_FRAME: f64 = 0.25;
/// Part of the surroundings that is more of the same: of a patch of a sheet, and of a cell among neighbours.
const GOES_ON: [f64; 2] = [0.8, 0.45];

/// The picture as it is judged: its light above the ground, and its texture.
pub(super) struct Tissue<'a> {
    lifted: &'a Plane,
    texture: Plane,
    /// Its brightness, and the least of it.
    plain: Plane,
    darkest: f32,
    /// Texture of the quietest places: noise.
    quiet: f32,
    /// What stands out of the ground, each island with the part of its rim that lies on the frame.
    standing: Islands,
    on_frame: Vec<f64>,
    factor: usize,
    pixel_um: f64,
}

impl<'a> Tissue<'a> {
    /// `noise` is the standard deviation of the ground.
    pub(super) fn of(working: &Working, lifted: &'a Plane, noise: f32) -> Self {
        let texture = texture_of(working);
        let pixel_um = working.pixel_um;
        // Where texture is everywhere, the quietest places have some, too; noise alone changes from pixel to pixel.
        let quietest = quantile(&filter::sample(texture.values(), 100_000), 0.05);
        let quiet =
            (noise_of(&working.plane) * texture_of_noise(pixel_um)).min(QUIETEST * quietest);
        let bright = quantile(&filter::sample(lifted.values(), 100_000), 0.999);
        let least = (STANDS_OUT * noise).max(STANDS_OUT_LEAST * bright);
        let (width, height) = (lifted.width(), lifted.height());
        let above = lifted.values().iter().map(|&value| value > least);
        let tidy = (TIDY_UM / pixel_um).max(1.0);
        let standing = Region::new(width, height, above).closed(tidy).opened(tidy);
        let standing = standing.islands(Connectivity::Four);
        let on_frame = on_frame(&standing, width, height);
        let plain = filter::slow_part(&working.plane, LIGHT_UM / pixel_um);
        let darkest = quantile(&filter::sample(working.plane.values(), 100_000), 0.01);
        let factor = working.factor;
        Self { lifted, texture, plain, darkest, quiet, standing, on_frame, factor, pixel_um }
    }

    /// Asks whether a candidate is a heart cell.
    pub(super) fn weigh(&self, confidence: &mut Confidence, candidate: &Candidate<'_>) {
        let Some(Seen { own, others, window }) = self.seen(candidate) else { return };
        let columns = self.texture.width();
        let texture = window.cut(self.texture.values(), columns);
        let light = window.cut(self.lifted.values(), columns);
        let median = |of: &dyn Fn(usize) -> bool, values: &[f32]| {
            let chosen: Vec<f32> =
                (0..values.len()).filter(|&at| of(at)).map(|at| values[at]).collect();
            (!chosen.is_empty()).then(|| quantile(&chosen, 0.5))
        };
        let core = (1..=4).map(|part| own.shrunk(CORE_UM / self.pixel_um / f64::from(part)));
        let core = core.into_iter().find(|core| core.count() > 0).unwrap_or_else(|| own.clone());
        let Some(within) = median(&|at| core.contains(at), &texture) else { return };
        let Some(bright) = median(&|at| own.contains(at), &light) else { return };
        let bright = bright.max(f32::MIN_POSITIVE);
        let squares = (within.powi(2) - self.quiet.powi(2)).max(0.0);
        let relative = f64::from(squares.sqrt() / bright);
        let hidden = HIDDEN * f64::from(self.quiet / bright);
        confidence.weigh(relative.max(hidden), TEXTURE[0], TEXTURE[1], || {
            format!(
                "it is uniform: its brightness varies by {:.1} % on the scale of sarcomeres and organelles, that of \
                 cells by 4 % and more; is it a bead, a post, a mark or an overexposed place?",
                100.0 * relative
            )
        });
        let [from, to] = BEYOND_UM.map(|um| own.grown((um / self.pixel_um).max(1.0)));
        let ring: Vec<usize> = (0..own.pixels())
            .filter(|&at| to.contains(at) && !from.contains(at) && !others.contains(at))
            .collect();
        // The ground may be the sheet itself: then its light is that above the darkest of all.
        let plain = window.cut(self.plain.values(), columns);
        let plain_within = median(&|at| core.contains(at), &plain).unwrap_or(bright);
        // Nothing is asked where noise or coarse pixels hide the texture.
        let asked = self.pixel_um <= COARSEST_UM && squares >= ABOVE_NOISE * self.quiet.powi(2);
        let own_texture = |at: usize| {
            (texture[at].powi(2) - self.quiet.powi(2)).max(0.0).sqrt()
                / squares.sqrt().max(f32::MIN_POSITIVE)
        };
        let same = |&&at: &&usize| {
            let alike = own_texture(at);
            alike > SAME_TEXTURE && light[at] > SAME_LIGHT * bright
                || alike > SAME_TEXTURE_ALONE
                    && relative > CLEAR_TEXTURE
                    && plain[at] - self.darkest > SAME_LIGHT * (plain_within - self.darkest)
        };
        let goes_on = if asked { ring.iter().filter(same).count() } else { 0 };
        let share = goes_on as f64 / ring.len().max(1) as f64;
        confidence.weigh(-share, -GOES_ON[0], -GOES_ON[1], || {
            format!(
                "{PATCH}: around {:.0} % of it the picture goes on as within; is it a patch of a sheet?",
                100.0 * share
            )
        });
        // A dim part has as much texture for its light as the bright one, scattered light has less.
        let rim = own.grown((RIM_UM / self.pixel_um).max(1.0));
        let number = self.standing_at(&core, &window);
        let left_out = (0..own.pixels()).filter(|&at| {
            let [column, row] = window.place(at % window.width(), at / window.width());
            !rim.contains(at)
                && !others.contains(at)
                && Some(self.standing.numbers[row * columns + column]) == number
                && own_texture(at) * bright > 0.5 * light[at]
        });
        let left_out = if asked { left_out.count() as f64 } else { 0.0 };
        let share = left_out / (left_out + own.count() as f64);
        confidence.weigh(-share, -LEFT_OUT[0], -LEFT_OUT[1], || {
            format!(
                "it is part of something larger: {:.0} % of what stands out there, dimmer but of the same texture, lies \
                 beyond the outline; a lower --threshold takes it in",
                100.0 * share
            )
        });
    }

    /// The island of what stands out in which a region lies, unless the frame cuts that.
    fn standing_at(&self, core: &Region, window: &Window) -> Option<u32> {
        let within = (0..core.pixels()).filter(|&at| core.contains(at));
        let number = |at: usize| {
            let [column, row] = window.place(at % window.width(), at / window.width());
            self.standing.numbers[row * self.lifted.width() + column]
        };
        let number = within.map(number).find(|&number| number > 0)?;
        (self.on_frame[number as usize - 1] <= MOST_ON_FRAME).then_some(number)
    }

    /// A candidate on the working grid, with the other cells around it.
    fn seen(&self, candidate: &Candidate<'_>) -> Option<Seen> {
        let (width, height) = (self.texture.width(), self.texture.height());
        let fine = candidate.width;
        let place = |&pixel: &u32| {
            let at = pixel as usize;
            [at % fine / self.factor, at / fine / self.factor]
        };
        let mut columns = width..0;
        let mut rows = height..0;
        for [column, row] in candidate.pixels.iter().map(place) {
            columns = columns.start.min(column)..columns.end.max(column + 1);
            rows = rows.start.min(row)..rows.end.max(row + 1);
        }
        let margin = (BEYOND_UM[1] / self.pixel_um).ceil() as usize + 1;
        let widened = |range: std::ops::Range<usize>, count: usize| {
            range.start.saturating_sub(margin)..(range.end + margin).min(count)
        };
        if columns.end > width || rows.end > height || candidate.pixels.is_empty() {
            return None;
        }
        let [column, row] = place(&candidate.pixels[candidate.pixels.len() / 2]);
        let number = self.standing.numbers[row * width + column];
        if let Some(island) = (number as usize).checked_sub(1).map(|at| self.standing.list[at])
            && self.on_frame[number as usize - 1] <= MOST_ON_FRAME
        {
            let both = |range: std::ops::Range<usize>, [first, last]: [usize; 2]| {
                range.start.min(first)..range.end.max(last + 1)
            };
            (columns, rows) = (both(columns, island.columns), both(rows, island.rows));
        }
        let window = Window { columns: widened(columns, width), rows: widened(rows, height) };
        let middle = self.factor / 2;
        let number = |at: usize| {
            let [column, row] = window.place(at % window.width(), at / window.width());
            let (column, row) = (column * self.factor + middle, row * self.factor + middle);
            candidate.numbers.get(row * fine + column.min(fine - 1)).copied().unwrap_or(0)
        };
        let numbers: Vec<u32> = (0..window.width() * window.height()).map(number).collect();
        let region = |of: &dyn Fn(u32) -> bool| {
            Region::new(window.width(), window.height(), numbers.iter().map(|&number| of(number)))
        };
        let own = region(&|number| number == candidate.number);
        let others = region(&|number| number != 0 && number != candidate.number);
        (own.count() > 0).then_some(Seen { own, others, window })
    }
}

/// Standard deviation of white noise: the mixed second difference knows no stripes, and its median no edges (Immerkaer
/// 1996).
fn noise_of(plane: &Plane) -> f32 {
    let (width, height) = (plane.width(), plane.height());
    let stride = (width * height / 200_000).max(1) | 1;
    let difference = |at: usize| {
        let (column, row) = (at % width, at / width);
        if column == 0 || row == 0 || column + 1 >= width || row + 1 >= height {
            return None;
        }
        let value = |x: usize, y: usize| plane.at(column + x - 1, row + y - 1);
        let corners = value(0, 0) + value(2, 0) + value(0, 2) + value(2, 2);
        let sides = value(1, 0) + value(0, 1) + value(2, 1) + value(1, 2);
        Some((corners - 2.0 * sides + 4.0 * value(1, 1)).abs())
    };
    let differences: Vec<f32> =
        (0..width * height).step_by(stride).filter_map(difference).collect();
    // Of a normal distribution half lies within 0.6745 standard deviations; the weights' squares sum to 36.
    quantile(&differences, 0.5) / (0.6745 * 6.0)
}

/// Texture of white noise of standard deviation 1: that of a single pixel, over the whole plane.
fn texture_of_noise(pixel_um: f64) -> f32 {
    let reach = (3.0 * TEXTURE_UM[1] / pixel_um).ceil() as usize;
    let side = 2 * reach + 1;
    let pixel = (0..side * side).map(|at| f32::from(u8::from(at == side * reach + reach)));
    let Some(pixel) = Plane::new(side, side, pixel.collect()) else { return 0.0 };
    let [fine, rough] = TEXTURE_UM.map(|um| filter::gaussian(&pixel, um / pixel_um));
    let squares = fine.values().iter().zip(rough.values()).map(|(a, b)| (a - b).powi(2));
    squares.sum::<f32>().sqrt()
}

/// Part of the rim of each island that lies on the frame.
fn on_frame(islands: &Islands, width: usize, height: usize) -> Vec<f64> {
    let mut counts = vec![[0_usize; 2]; islands.list.len()];
    for (at, &number) in islands.numbers.iter().enumerate().filter(|(_, number)| **number > 0) {
        let (column, row) = (at % width, at / width);
        let count = &mut counts[number as usize - 1];
        if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
            count[0] += 1;
        } else {
            let sides = [at - 1, at + 1, at - width, at + width];
            count[1] += usize::from(sides.iter().any(|&side| islands.numbers[side] != number));
        }
    }
    counts.iter().map(|&[on, off]| on as f64 / (on + off).max(1) as f64).collect()
}

/// A candidate in a window around it and what it is part of.
struct Seen {
    own: Region,
    others: Region,
    window: Window,
}
