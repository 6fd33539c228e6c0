//! Segmentation of bright cells on a dark background.

use super::confidence::Candidate;
use super::evidence::SMOOTH_UM;
use super::found::{Found, Working};
use super::ladder::{Climbed, Rough};
use super::parting::Seen;
use super::tissue::Tissue;
use super::{Confidence, Modality, SegmentError, Segmentation, SegmentationSettings};
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::{Connectivity, Region, Window};
use myospring_core::interruption::Interrupted;
use myospring_core::mesh::pixel_size::PixelSize;

/// Radius by which gaps are closed, um: stripes of a myocyte are 1.6 to 2.2 um apart, and the
/// outline must continue between two stripes at the rim.
const CLOSING_UM: f64 = 1.5;
/// Brightness of the edge, as a part of the largest brightness within two scales of smoothing: one
/// half for a blurred step.
const EDGE: f32 = 0.5;
/// Largest distance of the outline from that on the coarser grid of the ladder, um.
const AROUND_UM: f64 = 2.5;
/// Parts of a cell that are thinner than twice this, um, and smaller than this part of it are cut
/// off if only they connect it to the frame.
const SPUR_UM: f64 = 3.0;
const SPUR_SHARE: f64 = 0.02;

/// Distances inside the outline at which the brightness is measured from which it falls, um; the
/// largest value counts.
const WITHIN_UM: [f64; 3] = [1.5, 3.0, 6.0];

/// The objects of a picture that are brighter than their surroundings.
pub(super) struct Bright {
    pub(super) working: Working,
    smooth_um: f64,
    pub(super) climbed: Climbed,
}

impl Bright {
    /// Finds the objects that are brighter than their surroundings.
    pub(super) fn of(
        working: Working,
        settings: &SegmentationSettings,
    ) -> Result<Self, Interrupted> {
        let smooth_um = settings.smooth_um.unwrap_or(SMOOTH_UM);
        let climbed = Climbed::by_brightness(&working, smooth_um, settings.smallest_cell_um2)?;
        Ok(Self { working, smooth_um, climbed })
    }

    /// The outlines on the finer grid: where brightness crosses the level that explains the cell
    /// best, and half of the largest brightness nearby.
    fn region(&self, settings: &SegmentationSettings) -> Result<Region, Interrupted> {
        let Self { working, climbed: Climbed { evidence, levels, grid, rough, .. }, .. } = self;
        let (width, height) = (levels.width(), levels.height());
        let pixel = working.pixel_um;
        let lifted = &evidence.lifted;
        if let Some(threshold) = settings.threshold {
            let smooth = filter::gaussian(&working.plane, self.smooth_um / pixel);
            let above = smooth.values().iter().map(|&value| f64::from(value) > threshold);
            return Ok(self.tidied(&Region::new(width, height, above), settings));
        }
        // Light of a bright place is blurred across the outline; the edge is at half of it.
        let near = filter::largest_nearby(lifted, (2.0 * self.smooth_um / pixel).round() as usize);
        let around = AROUND_UM / pixel;
        let mut all = Region::new(width, height, std::iter::empty());
        for Rough { window, region, level, .. } in rough {
            working.interruption.check()?;
            let margin = (2.0 * around.max(CLOSING_UM / pixel)).ceil() as usize;
            let fine = window.finer(grid.factor, margin, [width, height]);
            let near_by = region.spread_within(window, grid.factor, &fine).grown(around);
            let cut = |plane: &Plane| fine.cut(plane.values(), width);
            let (levels, lifted, near) = (cut(levels), cut(lifted), cut(&near));
            let inside = (0..near_by.pixels()).map(|at| {
                near_by.contains(at) && levels[at] > *level && lifted[at] > EDGE * near[at]
            });
            let own = self.tidied(&Region::new(fine.width(), fine.height(), inside), settings);
            let own = without_spurs_to_the_frame(own, &fine, [width, height], SPUR_UM / pixel);
            all.put_apart(&own, &fine);
        }
        Ok(all)
    }

    /// The region without specks, gaps, holes and spikes.
    fn tidied(&self, region: &Region, settings: &SegmentationSettings) -> Region {
        let pixel = self.working.pixel_um;
        let smallest = settings.smallest_cell_um2 / pixel.powi(2);
        // Specks first, so that they are not joined to the cell or to each other.
        let speck = std::f64::consts::PI * (CLOSING_UM / 2.0 / pixel).powi(2);
        let region = region.kept(Connectivity::Eight, |island| island.pixels as f64 > speck);
        // Only around the remaining region: distances over the whole field of view would dominate
        // the cost.
        let window = region.window((2.0 * CLOSING_UM / pixel).ceil() as usize, 1);
        region
            .cut(&window)
            .closed(CLOSING_UM / pixel)
            .filled(usize::MAX)
            .opened(self.smooth_um / pixel)
            .kept(Connectivity::Four, |island| island.pixels as f64 >= smallest)
            .smoothed(self.smooth_um / pixel)
            .pasted(&window, region.width(), region.height())
    }
}

/// The region without small thin parts that alone connect a cell to the frame, such as dust and
/// threads.
fn without_spurs_to_the_frame(
    region: Region,
    window: &Window,
    [width, height]: [usize; 2],
    radius: f64,
) -> Region {
    let columns = window.width();
    let on_frame = |at: usize| {
        let [column, row] = window.place(at % columns, at / columns);
        column == 0 || row == 0 || column + 1 == width || row + 1 == height
    };
    let reaches =
        |region: &Region| (0..region.pixels()).any(|at| region.contains(at) && on_frame(at));
    if !reaches(&region) {
        return region;
    }
    let thick = region.opened(radius);
    if reaches(&thick) {
        return region;
    }
    let thin = region.inside().zip(thick.inside()).map(|(all, thick)| all && !thick);
    let islands = Region::new(columns, window.height(), thin).islands(Connectivity::Eight);
    let mut spur = vec![false; islands.list.len() + 1];
    for (at, &number) in islands.numbers.iter().enumerate() {
        spur[number as usize] |= number > 0 && on_frame(at);
    }
    let kept = |(inside, &number): (bool, &u32)| inside && !spur[number as usize];
    let without =
        Region::new(columns, window.height(), region.inside().zip(&islands.numbers).map(kept));
    let most_lost = SPUR_SHARE * region.count() as f64;
    if (region.count() - without.count()) as f64 <= most_lost { without } else { region }
}

pub(super) fn segment(
    bright: Bright,
    plane: &Plane,
    pixel_size: PixelSize,
    settings: &SegmentationSettings,
) -> Result<Segmentation, SegmentError> {
    let region = bright.region(settings)?;
    let Bright { working, climbed, smooth_um } = bright;
    let Climbed { evidence, rough, grid, .. } = climbed;
    let (factor, pixel) = (working.factor, working.pixel_um);
    let largest = rough.iter().max_by(|a, b| a.explained.area_um2.total_cmp(&b.explained.area_um2));
    let level = largest.map_or_else(|| evidence.least(), |rough| rough.level);
    let threshold = settings.threshold.unwrap_or_else(|| f64::from(evidence.value(level)));
    if region.count() == 0 {
        return Err(SegmentError::NoCell {
            modality: "fluorescence",
            threshold: format!("grey value {threshold:.4}"),
            why: format!("no brighter object is as large as {} um^2", settings.smallest_cell_um2),
            pixel_size,
        });
    }
    let tissue = Tissue::of(&working, &evidence, grid);
    let noise = evidence.noise;
    let view = View { lifted: &evidence.lifted, tissue, factor, pixel, noise, smooth_um };
    let smallest_um2 = settings.smallest_cell_um2;
    let seen =
        Seen { brightness: &working.plane, dark: evidence.middle, pixel_um: pixel, smallest_um2 };
    let found = Found { region, seen, factor, modality: Modality::Fluorescence, threshold };
    let judge = |candidate: &Candidate<'_>| view.judge(candidate, plane.width());
    Ok(found.finish(plane, pixel_size, settings, judge)?)
}

/// The picture as needed for the confidence.
struct View<'a> {
    lifted: &'a Plane,
    tissue: Tissue<'a>,
    factor: usize,
    pixel: f64,
    noise: f32,
    smooth_um: f64,
}

impl View<'_> {
    fn judge(&self, candidate: &Candidate<'_>, width: usize) -> Confidence {
        let mut confidence = Confidence::full();
        let (columns, rows) = (self.lifted.width(), self.lifted.height());
        let place = |pixel: u32| {
            let at = pixel as usize;
            (at % width / self.factor, at / width / self.factor)
        };
        let stride = (candidate.pixels.len() / 50_000).max(1) | 1;
        let inside: Vec<f32> = candidate
            .pixels
            .iter()
            .step_by(stride)
            .map(|&pixel| place(pixel))
            .map(|(column, row)| self.lifted.at(column, row))
            .collect();
        let bright = f64::from(quantile(&inside, 0.5));
        let contrast = bright / f64::from(self.noise).max(1e-12 * bright.abs()).max(1e-30);
        confidence.contrast = Some(contrast);
        confidence.weigh(contrast, 1.0, 5.0, || {
            if contrast <= 0.0 {
                return "it is no brighter than the background".to_owned();
            }
            format!(
                "it is only {contrast:.1} times the background's noise brighter than the background"
            )
        });
        // Width of the edge: brightness inside divided by the slope at the outline. Each place has
        // its own, since a cell may be dim in part.
        let falls: Vec<f32> = candidate
            .rim
            .iter()
            .map(|&pixel| place(pixel))
            .filter(|&(x, y)| x > 0 && y > 0 && x + 1 < columns && y + 1 < rows)
            .map(|(x, y)| {
                let along = self.lifted.at(x + 1, y) - self.lifted.at(x - 1, y);
                let down = self.lifted.at(x, y + 1) - self.lifted.at(x, y - 1);
                let slope = along.hypot(down);
                let within = |um: f64| {
                    let step = (um / self.pixel) as f32 / slope.max(f32::MIN_POSITIVE);
                    let shifted = |at: usize, by: f32, count: usize| {
                        ((at as f32 + by * step).round().max(0.0) as usize).min(count - 1)
                    };
                    self.lifted.at(shifted(x, along, columns), shifted(y, down, rows))
                };
                let height = WITHIN_UM.map(within).into_iter().fold(0.0, f32::max);
                height.min(bright as f32) * 2.0 * self.pixel as f32 / slope.max(1e-30)
            })
            .collect();
        let fall_um = f64::from(quantile(&falls, 0.5));
        // Twice the area divided by the outline's length: the radius of a disc, the width of a
        // strip.
        let pixel_um = self.pixel / self.factor as f64;
        let width_um =
            2.0 * candidate.pixels.len() as f64 / candidate.rim.len().max(1) as f64 * pixel_um;
        confidence.weigh(-fall_um / width_um, -0.7, -0.2, || {
            format!("its rim is blurred: its brightness falls over about {fall_um:.1} um; is it out of focus?")
        });
        // Smoothing blurs the rim, too; the slope of a blurred unit step is the peak of the
        // Gaussian.
        let blur_um =
            (fall_um.powi(2) / std::f64::consts::TAU - self.smooth_um.powi(2)).max(0.0).sqrt();
        self.tissue.weigh(&mut confidence, candidate, blur_um);
        confidence.weigh_shape(candidate, width);
        confidence
    }
}
