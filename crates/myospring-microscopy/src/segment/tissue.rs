//! Decides whether an object is a heart cell: it has a texture, it ends at its outline, and the
//! picture is not full of similar texture.
//!
//! A clear outline is not enough: letters, posts and patches of a sheet have outlines as clear as
//! cells. Each criterion is independent of the others and gives a factor and a reason.

use super::companion::Blocks;
use super::confidence::{Candidate, Confidence, HIDES, OUT_OF_FOCUS, PATCH, UNIFORM};
use super::evidence::{Evidence, Grid, texture_of};
use super::found::Working;
use super::grain::{Grain, noise_of, texture_of_noise};
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Islands, Region, Window};

/// Relative strength of texture on the scale of stripes and grains: of an object without texture,
/// and of a cell. Cells have 0.04 (a dissolved dye at 1 um a pixel) to 0.7 (z-discs).
const TEXTURE: [f64; 2] = [0.008, 0.025];
/// Factor if noise may hide a cell's texture, so that neither its presence nor its absence is
/// certain.
const HIDDEN: f64 = 0.6;
/// Relative texture from which on this applies: that of a dissolved dye.
const MAY_HIDE: f64 = 0.04;
/// Blur (standard deviation, measured at the rim), um, from which on some texture is hidden, and
/// all of it: a lens that spreads light over half a sarcomere shows no stripes.
const BLURS_UM: [f64; 2] = [0.9, 1.1];
/// Coarsest period of texture, um, which passes blur best.
const COARSE_UM: f64 = 3.5;
/// Least blur that is mentioned, um.
const TELLS_BLUR_UM: f64 = 0.6;
/// Factor if blur hides all texture, which a sharper picture would show.
const BLURRED: f64 = 0.5;
/// Ratio of the mean noise to that of the quietest places, due to chance.
const QUIETEST: f32 = 1.3;
/// Coarsest pixel on which texture can be compared, um.
const COARSEST_UM: f64 = 0.55;
/// Depth inside the outline from which on texture is read, um, away from the edge itself.
const CORE_UM: f64 = 3.0;
/// Distances beyond the outline at which texture is read, um.
const BEYOND_UM: [f64; 2] = [4.0, 7.0];
/// The surroundings are similar if they have at least this part of the texture and of the
/// brightness.
const SAME_TEXTURE: f32 = 0.4;
const SAME_LIGHT: f32 = 0.25;
/// If the background itself may be a sheet: the least part of the texture, and the least strength
/// of the texture inside.
const SAME_TEXTURE_ALONE: f32 = 0.5;
const CLEAR_TEXTURE: f64 = 0.18;
/// Scale on which light is averaged, um: more than a stripe.
const LIGHT_UM: f64 = 1.2;
/// Least variance of the texture beyond the outline, relative to that of the noise.
const ABOVE_NOISE: f32 = 0.5;
/// Least brightness above the background, in its standard deviations, and as a part of the
/// brightest.
const STANDS_OUT: f32 = 5.0;
const STANDS_OUT_LEAST: f32 = 0.01;
/// Radius of closing gaps and removing tips in the bright area, um.
const TIDY_UM: f64 = 1.2;
/// Width of the blurred rim around a cell, um.
const RIM_UM: f64 = 2.0;
/// Part of the bright island outside the outline: for half a cell, and for a whole one.
const LEFT_OUT: [f64; 2] = [0.6, 0.2];
/// An island with a larger part of its rim on the frame is several cells.
const MOST_ON_FRAME: f64 = 0.25;
/// Part of the surroundings that is similar to the inside: for a patch of a sheet, and for a cell
/// among neighbours.
const GOES_ON: [f64; 2] = [0.8, 0.45];

/// The picture as needed for these criteria: its light above the background, and its texture.
pub(super) struct Tissue<'a> {
    lifted: &'a Plane,
    plane: &'a Plane,
    texture: Plane,
    /// Standard deviation of the noise of the quietest places, per pixel.
    noise: f32,
    /// Its brightness, and the smallest brightness.
    plain: Plane,
    darkest: f32,
    /// Texture of the quietest places, which is that of noise.
    quiet: f32,
    /// Islands above the background, each with the part of its rim that lies on the frame.
    standing: Islands,
    on_frame: Vec<f64>,
    blocks: Blocks,
    factor: usize,
    pixel_um: f64,
}

impl<'a> Tissue<'a> {
    pub(super) fn of(working: &'a Working, evidence: &'a Evidence, grid: Grid) -> Self {
        let (lifted, noise) = (&evidence.lifted, evidence.noise);
        let texture = texture_of(working);
        let pixel_um = working.pixel_um;
        // If texture is everywhere, even the quietest places have some; only noise changes from
        // pixel to pixel.
        let quietest = quantile(&filter::sample(texture.values(), 100_000), 0.05);
        let unit = texture_of_noise(pixel_um).max(f32::MIN_POSITIVE);
        let quiet = (noise_of(&working.plane) * unit).min(QUIETEST * quietest);
        let noise_per_pixel = quiet / unit;
        let bright = quantile(&filter::sample(lifted.values(), 100_000), 0.999);
        let least = (STANDS_OUT * noise).max(STANDS_OUT_LEAST * bright);
        let (width, height) = (lifted.width(), lifted.height());
        let above = lifted.values().iter().map(|&value| value > least);
        let tidy = (TIDY_UM / pixel_um).max(1.0);
        let standing = Region::new(width, height, above).closed(tidy).opened(tidy);
        let standing = standing.islands(Connectivity::Four);
        let on_frame = standing.on_frame(width, height);
        let plain = filter::slow_part(&working.plane, LIGHT_UM / pixel_um);
        let darkest = quantile(&filter::sample(working.plane.values(), 100_000), 0.01);
        let factor = working.factor;
        let plane = &working.plane;
        Self {
            lifted,
            plane,
            texture,
            noise: noise_per_pixel,
            plain,
            darkest,
            quiet,
            standing,
            on_frame,
            blocks: Blocks::of(&evidence.plain, grid, bright),
            factor,
            pixel_um,
        }
    }

    /// Applies the criteria to a candidate; `blur_um` is the blur of its rim.
    pub(super) fn weigh(
        &self,
        confidence: &mut Confidence,
        candidate: &Candidate<'_>,
        blur_um: f64,
    ) {
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
        self.weigh_grain(confidence, &own, &window, f64::from(bright), blur_um);
        let [from, to] = BEYOND_UM.map(|um| own.grown((um / self.pixel_um).max(1.0)));
        let ring: Vec<usize> = (0..own.pixels())
            .filter(|&at| to.contains(at) && !from.contains(at) && !others.contains(at))
            .collect();
        // The background may be the sheet itself; then light is measured above the darkest place.
        let plain = window.cut(self.plain.values(), columns);
        let plain_within = median(&|at| core.contains(at), &plain).unwrap_or(bright);
        // Skipped if noise or coarse pixels hide the texture.
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
                "{PATCH}: around {:.0} % of it the picture continues as inside; is it a patch of a sheet?",
                100.0 * share
            )
        });
        // A dim part has the same ratio of texture to light as the bright one; scattered light has
        // less.
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
        let hidden = |light: f32| !asked || relative * f64::from(light) < f64::from(self.quiet);
        let dim = self.blocks.beside(&own, &others, &window, self.pixel_um, hidden);
        if dim > share {
            confidence.weigh(-dim, -LEFT_OUT[0], -LEFT_OUT[1], || {
                format!(
                    "it may be part of something larger: {:.0} % of the bright area there, so dim that it shows no texture, \
                     lies outside the outline; a lower --threshold or a larger --smooth includes it",
                    100.0 * dim
                )
            });
            return;
        }
        confidence.weigh(-share, -LEFT_OUT[0], -LEFT_OUT[1], || {
            format!(
                "it is part of something larger: {:.0} % of the bright area there, dimmer but of the same texture, lies \
                 outside the outline; a lower --threshold includes it",
                100.0 * share
            )
        });
    }

    /// Checks for texture inside, which sarcomeres and organelles give to all cells.
    fn weigh_grain(
        &self,
        confidence: &mut Confidence,
        own: &Region,
        window: &Window,
        bright: f64,
        blur_um: f64,
    ) {
        let within = own.window(1, 1);
        let (own, within) = (own.cut(&within), window.part(&within));
        let values = within.cut(self.plane.values(), self.plane.width());
        let Some(plane) = Plane::new(within.width(), within.height(), values) else { return };
        let Some(Grain { least, most }) = Grain::within(&plane, &own, self.pixel_um, self.noise)
        else {
            return;
        };
        let [least, most] = [least, most].map(|strength| strength / bright);
        let [none, enough] = TEXTURE;
        let seen = ((least - none) / (enough - none)).clamp(0.0, 1.0);
        let [some, all] = BLURS_UM;
        let blurred = ((blur_um - some) / (all - some)).clamp(0.0, 1.0);
        let passes = (-2.0 * (std::f64::consts::PI * blur_um / COARSE_UM).powi(2)).exp();
        if seen < BLURRED && blurred >= 1.0 {
            confidence.weigh(BLURRED, 0.0, 1.0, || {
                format!(
                    "{OUT_OF_FOCUS}: a blur of {blur_um:.1} um, as at its rim, hides sarcomeres and organelles, so it \
                     may or may not be a cell; take a sharper picture, or check the outline by eye"
                )
            });
        } else if most < MAY_HIDE * passes * (1.0 - blurred) || seen >= HIDDEN {
            confidence.weigh(least, none, enough, || {
                format!(
                    "{UNIFORM}: its brightness varies by {:.1} % on the scale of sarcomeres and organelles, in \
                     cells by 4 % or more; is it a bead, a post, a mark or an overexposed place?",
                    100.0 * least
                )
            });
        } else {
            confidence.weigh(HIDDEN, 0.0, 1.0, || {
                let [blurred, noisy] = HIDES;
                let hide = if blur_um > TELLS_BLUR_UM { blurred } else { noisy };
                format!(
                    "{hide} whether it has the texture of a cell: a variation below {:.0} % of its brightness would not be \
                     visible; is it a cell?",
                    100.0 * most
                )
            });
        }
    }

    /// The bright island in which a region lies; `None` if the frame cuts it.
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
        let both = |range: std::ops::Range<usize>, [first, last]: [usize; 2]| {
            range.start.min(first)..range.end.max(last + 1)
        };
        let number = self.standing.numbers[row * width + column];
        if let Some(island) = (number as usize).checked_sub(1).map(|at| self.standing.list[at])
            && self.on_frame[number as usize - 1] <= MOST_ON_FRAME
        {
            (columns, rows) = (both(columns, island.columns), both(rows, island.rows));
        }
        if let Some([across, down]) = self.blocks.bounds(column, row) {
            // The rest of a cell lies within the length of the candidate.
            let reach = columns.len().max(rows.len());
            let near = |[first, last]: [usize; 2], own: &std::ops::Range<usize>| {
                [first.max(own.start.saturating_sub(reach)), last.min(own.end + reach)]
            };
            let [across, down] = [near(across, &columns), near(down, &rows)];
            (columns, rows) = (both(columns, across), both(rows, down));
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

/// A candidate in a window that also contains its surroundings.
struct Seen {
    own: Region,
    others: Region,
    window: Window,
}
