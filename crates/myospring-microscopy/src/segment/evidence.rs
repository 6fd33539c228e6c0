//! Evidence for a cell at each place: brightness above the surroundings, or texture.

use super::found::Working;
use super::ground::Ground;
use crate::filter::{self, otsu, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Region};
use myospring_core::interruption::{Interrupted, Interruption};

/// Side up to which pixels are averaged, um.
pub(super) const PIXEL_UM: f64 = 0.25;
/// Default scale on which brightness is smoothed, um.
pub(super) const SMOOTH_UM: f64 = 0.5;
/// Dark gaps up to twice this width are filled with the brightness of both sides, um: stripes of a
/// myocyte are 1.6 to 2.2 um apart.
const GAP_UM: f64 = 1.2;
/// Band of scales of texture (stripes, threads, grains), as standard deviations of Gaussians, um.
pub(super) const TEXTURE_UM: [f64; 2] = [0.35, 1.2];
/// Scale over which the texture's energy is averaged, um: more than a period.
const ENERGY_UM: f64 = 2.5;
/// Least unit of evidence, as a part of the brightest: below it, stray light dominates noise.
const LEAST_UNIT: f32 = 0.03;
/// Smallest area from which the brightness of the brightest is measured, um^2; debris and hot
/// pixels are smaller.
const BRIGHT_UM2: f64 = 50.0;
/// Least evidence of a cell, in standard deviations of the background.
const LEAST_NOISES: f32 = 3.5;
/// Background that scatters more than this many times as much as the quietest dark places may not
/// be background.
const UNEVEN: f32 = 2.0;
/// The mean of the background is measured within this distance of bright objects, um, so that it
/// does not depend on the size of the field of view.
const AROUND_UM: f64 = 10.0;

/// The working grid, and the coarser one on which islands are found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Grid {
    /// Side of a pixel of the working grid, um.
    pub(super) working_um: f64,
    /// Pixels of the working grid along the side of a coarse one.
    pub(super) factor: usize,
}

impl Grid {
    /// Chooses the coarse grid: fine enough for islands, coarse enough for a large field of view.
    pub(super) fn of(working: &Working) -> Self {
        let pixels = (working.plane.width() * working.plane.height()) as f64;
        let affordable_um = working.pixel_um * (pixels / MOST_PIXELS).sqrt();
        let pixel_um = affordable_um.clamp(FINEST_PIXEL_UM, COARSEST_PIXEL_UM);
        let factor = ((pixel_um / working.pixel_um).round() as usize).max(1);
        Self { working_um: working.pixel_um, factor }
    }

    /// Side of a coarse pixel, um.
    pub(super) fn pixel_um(self) -> f64 {
        self.working_um * self.factor as f64
    }
}

/// Finest pixel of the coarse grid, um, and the largest number of its pixels.
const FINEST_PIXEL_UM: f64 = 0.4;
const COARSEST_PIXEL_UM: f64 = 1.0;
const MOST_PIXELS: f64 = 250_000.0;

/// A plane that is large in a cell and small outside, above its slowly varying background.
///
/// It is measured in units of noise, logarithmically above one unit, so that a bright cell does not
/// hide a dim one.
pub(super) struct Evidence {
    /// The plane above its background.
    pub(super) lifted: Plane,
    /// The same on the coarse grid.
    pub(super) coarse: Plane,
    /// The same before gaps were filled.
    pub(super) plain: Plane,
    /// Standard deviation of the background.
    pub(super) noise: f32,
    /// The unit of evidence.
    unit: f32,
    /// The typical value of the background.
    pub(super) middle: f32,
    /// Means of background and cells on the logarithmic scale, separated by Otsu's threshold (Otsu
    /// 1979).
    means: [f32; 2],
}

/// Alternative estimates of the background.
pub(super) struct Readings {
    pub(super) first: Evidence,
    pub(super) other: Option<Evidence>,
}

impl Evidence {
    /// Evidence from brightness, with gaps between stripes filled; `smooth_um` is the scale of
    /// smoothing.
    pub(super) fn brightness(
        working: &Working,
        smooth_um: f64,
        grid: Grid,
    ) -> Result<Readings, Interrupted> {
        let pixel = working.pixel_um;
        let smooth = filter::gaussian(&working.plane, smooth_um / pixel);
        let closed = filter::closed(&smooth, (GAP_UM / pixel).round() as usize);
        Self::readings(&closed, &smooth, grid, &working.interruption)
    }

    /// Evidence from texture: variation on the scale of stripes and grains.
    pub(super) fn texture(working: &Working, grid: Grid) -> Result<Readings, Interrupted> {
        let energy = texture_of(working);
        Self::readings(&energy, &energy, grid, &working.interruption)
    }

    /// Evidence above the fitted background; also above the darkest places if the fitted background
    /// scatters too much, because cells or haze may then fill most of the picture.
    fn readings(
        plane: &Plane,
        plain: &Plane,
        grid: Grid,
        interruption: &Interruption,
    ) -> Result<Readings, Interrupted> {
        interruption.check()?;
        let (surface, dark) = (Ground::under(plane), Ground::darkest(plane, grid.working_um));
        let doubtful = surface.noise > UNEVEN * dark.noise;
        interruption.check()?;
        let first = Self::above(&surface, plane, plain, grid);
        interruption.check()?;
        let other = doubtful.then(|| Self::above(&dark, plane, plain, grid));
        Ok(Readings { first, other })
    }

    fn above(ground: &Ground, plane: &Plane, plain: &Plane, grid: Grid) -> Self {
        let lifted = ground.taken_off(plane);
        let coarse = filter::coarse(&lifted, grid.factor);
        let plain = filter::coarse(&ground.taken_off(plain), grid.factor);
        let in_pixels = |um2: f64| um2 / grid.pixel_um().powi(2);
        let share = in_pixels(BRIGHT_UM2) / coarse.values().len() as f64;
        let bright = quantile(coarse.values(), 1.0 - share.min(0.5));
        let (noise, middle) = (ground.noise, ground.middle());
        let unit = noise.max(LEAST_UNIT * bright).max(f32::MIN_POSITIVE);
        let mut evidence = Self { lifted, coarse, plain, noise, unit, middle, means: [0.0, 1.0] };
        let coarse = &evidence.coarse;
        let least = LEAST_NOISES * noise;
        let stands_out = coarse.values().iter().map(|&value| value > least);
        let near = Region::new(coarse.width(), coarse.height(), stands_out)
            .kept(Connectivity::Eight, |island| island.pixels as f64 >= in_pixels(BRIGHT_UM2))
            .grown(AROUND_UM / grid.pixel_um());
        let near = coarse.values().iter().zip(near.inside()).filter(|(_, near)| *near);
        let near: Vec<f32> = near.map(|(&value, _)| evidence.scaled(value)).collect();
        if let Some(means) = classes(&near) {
            evidence.means = means;
        }
        evidence
    }

    fn scaled(&self, lifted: f32) -> f32 {
        (lifted / self.unit).asinh()
    }

    /// The evidence at each place: 0 as in the background, 1 as in the cells.
    pub(super) fn levels(&self) -> Plane {
        let [low, high] = self.means;
        self.lifted.map(|value| (self.scaled(value) - low) / (high - low))
    }

    /// The smallest level above noise.
    pub(super) fn least(&self) -> f32 {
        let [low, high] = self.means;
        (self.scaled(LEAST_NOISES * self.noise) - low) / (high - low)
    }

    /// A level above the background, in the unit of the plane.
    pub(super) fn above_ground(&self, level: f32) -> f32 {
        let [low, high] = self.means;
        self.unit * (low + level * (high - low)).sinh()
    }

    /// A level as a value of the plane, over the typical background.
    pub(super) fn value(&self, level: f32) -> f32 {
        self.middle + self.above_ground(level)
    }
}

/// Variation of a plane on the scale of stripes and grains, averaged around each place.
pub(super) fn texture_of(working: &Working) -> Plane {
    let pixel = working.pixel_um;
    let [fine, rough] = TEXTURE_UM.map(|um| filter::gaussian(&working.plane, um / pixel));
    let squares = fine.values().iter().zip(rough.values()).map(|(a, b)| (a - b).powi(2));
    let (width, height) = (fine.width(), fine.height());
    let squares = Plane::new(width, height, squares.collect()).unwrap_or(fine);
    filter::slow_part(&squares, ENERGY_UM / pixel).map(f32::sqrt)
}

/// Means of Otsu's classes; `None` if all values are equal.
fn classes(values: &[f32]) -> Option<[f32; 2]> {
    let [level, _] = otsu(values)?;
    let mean = |of: &dyn Fn(f32) -> bool| {
        let chosen: Vec<f32> = values.iter().copied().filter(|&value| of(value)).collect();
        chosen.iter().sum::<f32>() / chosen.len().max(1) as f32
    };
    let [low, high] = [mean(&|value| value <= level), mean(&|value| value > level)];
    (high > low).then_some([low, high])
}
