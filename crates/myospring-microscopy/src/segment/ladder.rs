//! Chooses for each cell the threshold level whose outline explains the evidence best.
//!
//! The levels form a ladder. The pixels above each rung form islands, and the islands of a rung lie
//! within those of the rung below. An island explains more as a cell if the evidence falls more
//! steeply across its outline, along more of its outline, if less of it is cut by the frame, and if
//! it is more compact. An island is chosen over the islands within it on higher rungs if it
//! explains more. So different cells have different thresholds, and two cells connected only by
//! haze are separated (component trees, Jones 1999; related to the maximally stable extremal
//! regions of Matas et al. 2002).

use super::confidence::solidity;
use super::evidence::{Evidence, Grid, Readings};
use super::found::Working;
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Region, Window};
use myospring_core::interruption::{Interrupted, Interruption};

/// Distance of the rungs, as a part of the difference between cells and background.
const RUNG: f32 = 0.05;
/// Highest rung.
const TOP: f32 = 1.3;
/// Radii of closing gaps and of opening tips and necks, um.
const CLOSING_UM: f64 = 0.5;
const OPENING_UM: f64 = 1.5;
/// Scale on which the slope across an outline is measured, um.
const SLOPE_UM: f64 = 0.5;
/// Scale on which the direction across an outline is measured, um.
const ACROSS_UM: f64 = 1.0;
/// The surroundings of an island lie at these distances from it, um.
const BESIDE_UM: [f64; 2] = [1.5, 5.0];
/// An outline within another is chosen if it explains at least this part as much, because blur
/// moves light outward.
const AS_GOOD: f64 = 0.8;
/// Rise of an island's median (gaps not filled) above its surroundings, relative to its mean height
/// (gaps filled): at or below the first it is only a halo, from the second on it is an object.
const RISE: [f32; 2] = [0.15, 0.4];
/// Least slope across the outline that counts as falling, per um.
const FALL_PER_UM: f32 = 0.03;

/// How well an island is explained as a single cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Explained {
    /// Mean slope of the evidence across the outline, except on the frame, per um.
    pub(super) slope_per_um: f64,
    /// Part of that outline across which it falls.
    pub(super) falling: f64,
    /// Part of the outline that lies on the frame.
    pub(super) on_frame: f64,
    /// Certainty that most of the inside is higher than the surroundings, 0 to 1.
    pub(super) inside: f64,
    /// Area over that of the convex hull.
    pub(super) solidity: f64,
    /// Area, um^2.
    pub(super) area_um2: f64,
}

impl Explained {
    /// Quality of an island, per unit of its area.
    fn quality(&self) -> f64 {
        let whole = 1.0 - self.on_frame;
        let rises = self.slope_per_um.max(0.0) * self.inside;
        rises * self.falling * whole.powi(3) * self.solidity.powi(2)
    }

    /// How much the island explains; values of several islands add.
    pub(super) fn value(&self) -> f64 {
        self.area_um2 * self.quality().powi(2)
    }
}

/// An island that was chosen as a cell.
pub(super) struct Rough {
    /// Where it lies.
    pub(super) window: Window,
    /// Its pixels, within the window.
    pub(super) region: Region,
    /// The level of its outline.
    pub(super) level: f32,
    pub(super) explained: Explained,
}

/// Evidence with the islands chosen from it.
pub(super) struct Climbed {
    pub(super) evidence: Evidence,
    /// Its levels, on the working grid.
    pub(super) levels: Plane,
    pub(super) grid: Grid,
    /// The islands, on the coarse grid.
    pub(super) rough: Vec<Rough>,
    /// Part of all light in these islands, if the background is uncertain.
    share: f64,
}

impl Climbed {
    fn of(
        evidence: Evidence,
        grid: Grid,
        smallest_um2: f64,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        interruption.check()?;
        let levels = evidence.levels();
        let coarse = filter::coarse(&levels, grid.factor);
        let ladder = Ladder::on(&coarse, &evidence, grid.pixel_um(), smallest_um2);
        let rough = ladder.climb(evidence.least(), interruption)?;
        Ok(Self { evidence, levels, grid, rough, share: 1.0 })
    }

    /// Chooses islands by brightness.
    pub(super) fn by_brightness(
        working: &Working,
        smooth_um: f64,
        smallest_um2: f64,
    ) -> Result<Self, Interrupted> {
        let grid = Grid::of(working);
        let readings = Evidence::brightness(working, smooth_um, grid)?;
        Self::best(readings, grid, smallest_um2, &working.interruption)
    }

    /// Chooses islands by texture.
    pub(super) fn by_texture(working: &Working, smallest_um2: f64) -> Result<Self, Interrupted> {
        let grid = Grid::of(working);
        let readings = Evidence::texture(working, grid)?;
        Self::best(readings, grid, smallest_um2, &working.interruption)
    }

    /// The alternative that explains most.
    fn best(
        readings: Readings,
        grid: Grid,
        smallest_um2: f64,
        interruption: &Interruption,
    ) -> Result<Self, Interrupted> {
        let mut first = Self::of(readings.first, grid, smallest_um2, interruption)?;
        let Some(other) = readings.other else { return Ok(first) };
        let mut other = Self::of(other, grid, smallest_um2, interruption)?;
        // The light above the darkest places is the whole that must be explained.
        let light = filter::coarse(&other.evidence.lifted, grid.factor);
        (first.share, other.share) = (first.share_of(&light), other.share_of(&light));
        Ok(if other.value() > first.value() { other } else { first })
    }

    /// How much all islands explain.
    pub(super) fn value(&self) -> f64 {
        // An empty sum would be -0.
        let sum = self.rough.iter().fold(0.0, |sum, rough| sum + rough.explained.value());
        sum * self.share.powi(2)
    }

    /// The region within `reach_um` of the islands, on pixels of `pixel_um`; `None` without
    /// islands.
    pub(super) fn around(
        &self,
        reach_um: f64,
        pixel_um: f64,
        [width, height]: [usize; 2],
    ) -> Option<Region> {
        let coarse = &self.evidence.coarse;
        let mut all = Region::new(coarse.width(), coarse.height(), std::iter::empty());
        for Rough { window, region, .. } in &self.rough {
            all.add(region, window);
        }
        let near = all.grown(reach_um / self.grid.pixel_um());
        let ratio = pixel_um / self.grid.pixel_um();
        (!self.rough.is_empty()).then(|| near.resampled(ratio, width, height))
    }

    /// Part of all light that lies in the islands.
    fn share_of(&self, light: &Plane) -> f64 {
        let sum = |values: &mut dyn Iterator<Item = f32>| -> f64 {
            values.map(|value| f64::from(value.max(0.0))).sum()
        };
        let within = |rough: &Rough| {
            let values = rough.window.cut(light.values(), light.width());
            let inside = values.into_iter().zip(rough.region.inside());
            sum(&mut inside.filter(|(_, inside)| *inside).map(|(value, _)| value))
        };
        let all = sum(&mut light.values().iter().copied());
        self.rough.iter().map(within).sum::<f64>() / all.max(f64::MIN_POSITIVE)
    }
}

/// A ladder on a plane of evidence.
pub(super) struct Ladder<'a> {
    levels: &'a Plane,
    evidence: &'a Evidence,
    /// Slopes along rows and columns, per um.
    slopes: [Vec<f32>; 2],
    pixel_um: f64,
    smallest_um2: f64,
}

impl<'a> Ladder<'a> {
    /// A ladder on the levels of a plane with pixels of `pixel_um`, for cells of at least
    /// `smallest_um2`.
    fn on(levels: &'a Plane, evidence: &'a Evidence, pixel_um: f64, smallest_um2: f64) -> Self {
        let smooth = filter::gaussian(levels, SLOPE_UM / pixel_um);
        let slopes = filter::slopes(&smooth).map(|slopes| {
            slopes.into_iter().map(|slope| slope / pixel_um as f32).collect::<Vec<f32>>()
        });
        Self { levels, evidence, slopes, pixel_um, smallest_um2 }
    }

    /// The islands that explain most, at levels from `least` on.
    fn climb(&self, least: f32, interruption: &Interruption) -> Result<Vec<Rough>, Interrupted> {
        let (width, height) = (self.levels.width(), self.levels.height());
        let least = least.max(RUNG);
        let above = Region::new(width, height, self.levels.values().iter().map(|&v| v > least));
        let smallest = self.smallest_um2 / self.pixel_um.powi(2) / 4.0;
        // Most islands are noise; removing them first saves work.
        let above = above.kept(Connectivity::Eight, |island| island.pixels as f64 >= smallest);
        let mut found = Vec::new();
        for window in above.windows((BESIDE_UM[1] / self.pixel_um).ceil() as usize) {
            found.extend(self.best(&above.cut(&window), &window, least, interruption)?.1);
        }
        Ok(found)
    }

    /// The islands within a region that explain most, and the sum of their values.
    fn best(
        &self,
        region: &Region,
        window: &Window,
        level: f32,
        interruption: &Interruption,
    ) -> Result<(f64, Vec<Rough>), Interrupted> {
        let (mut value, mut found) = (0.0, Vec::new());
        if level > TOP {
            return Ok((value, found));
        }
        interruption.check()?;
        let width = self.levels.width();
        let values = window.cut(self.levels.values(), width);
        let above = region.inside().zip(&values).map(|(inside, &value)| inside && value > level);
        let tidy = Region::new(region.width(), region.height(), above)
            .closed(CLOSING_UM / self.pixel_um)
            .filled(usize::MAX)
            .opened((OPENING_UM / self.pixel_um).max(1.0));
        let islands = tidy.islands(Connectivity::Four);
        let smallest = self.smallest_um2 / self.pixel_um.powi(2);
        let margin = (BESIDE_UM[1] / self.pixel_um).ceil() as usize;
        for (number, island) in (1..).zip(&islands.list) {
            if (island.pixels as f64) < smallest {
                continue;
            }
            let own = Region::new(
                tidy.width(),
                tidy.height(),
                islands.numbers.iter().map(|&other| other == number),
            );
            let within = own.window(margin, 1);
            let (own_region, within) = (own.cut(&within), window.part(&within));
            let explained = self.explained(&own_region, &within);
            let (sum, parts) = self.best(&own_region, &within, level + RUNG, interruption)?;
            let own = explained.value();
            let tighter = match parts.as_slice() {
                [part] => part.explained.value() >= AS_GOOD * own,
                _ => sum > own,
            };
            value += sum.max(own);
            if tighter {
                found.extend(parts);
            } else {
                found.push(Rough { window: within, region: own_region, level, explained });
            }
        }
        Ok((value, found))
    }

    fn explained(&self, region: &Region, window: &Window) -> Explained {
        let (width, height) = (self.levels.width(), self.levels.height());
        let [along, down] = self.slopes.each_ref().map(|slopes| window.cut(slopes, width));
        let step = region.inside().map(|is| if is { 1.0 } else { 0.0 }).collect();
        let inward = Plane::new(region.width(), region.height(), step)
            .map(|step| filter::slopes(&filter::gaussian(&step, ACROSS_UM / self.pixel_um)))
            .unwrap_or_default();
        let (mut on_frame, mut rim, mut count) = (0_usize, Vec::new(), 0_usize);
        let (mut falling, mut slopes) = (0_usize, 0.0);
        let (columns, rows) = (region.width(), region.height());
        for at in (0..region.pixels()).filter(|&at| region.contains(at)) {
            let (x, y) = (at % columns, at / columns);
            let [column, row] = window.place(x, y);
            if column == 0 || row == 0 || column + 1 == width || row + 1 == height {
                on_frame += 1;
                rim.push([x as f64, y as f64]);
                continue;
            }
            let outside = |x: usize, y: usize| !region.contains(y * columns + x);
            let is_rim = x == 0
                || y == 0
                || x + 1 == columns
                || y + 1 == rows
                || outside(x - 1, y)
                || outside(x + 1, y)
                || outside(x, y - 1)
                || outside(x, y + 1);
            if is_rim {
                rim.push([x as f64, y as f64]);
                let (u, v) = (inward[0][at], inward[1][at]);
                let slope = (along[at] * u + down[at] * v) / u.hypot(v).max(1e-9);
                count += 1;
                falling += usize::from(slope > FALL_PER_UM);
                slopes += f64::from(slope);
            }
        }
        let plain = window.cut(self.evidence.plain.values(), width);
        let [apart, beyond] = BESIDE_UM.map(|um| region.grown((um / self.pixel_um).max(1.0)));
        let median = |of: &dyn Fn(usize) -> bool| {
            let values: Vec<f32> =
                (0..plain.len()).filter(|&at| of(at)).map(|at| plain[at]).collect();
            (!values.is_empty()).then(|| quantile(&values, 0.5))
        };
        let heights = window.cut(self.evidence.coarse.values(), width);
        let heights = heights.into_iter().zip(region.inside()).filter(|(_, inside)| *inside);
        let sum: f32 = heights.map(|(height, _)| height).sum();
        let height = sum / region.count().max(1) as f32;
        let own = median(&|at| region.contains(at));
        let beside = median(&|at| beyond.contains(at) && !apart.contains(at));
        // Without surroundings, the rise above the background is used.
        let [own, beside] = [own, beside].map(|median| median.unwrap_or(0.0));
        let [low, high] = RISE;
        let rise = (own - beside) / height.max(f32::MIN_POSITIVE);
        let count = count.max(1) as f64;
        Explained {
            slope_per_um: slopes / count,
            falling: falling as f64 / count,
            on_frame: on_frame as f64 / (count + on_frame as f64),
            inside: f64::from(((rise - low) / (high - low)).clamp(0.0, 1.0)),
            solidity: solidity(rim.into_iter(), region.count()),
            area_um2: region.count() as f64 * self.pixel_um.powi(2),
        }
    }
}
