//! A bright cell on a dark ground.

use super::confidence::Candidate;
use super::ground::Ground;
use super::{Confidence, Found, Modality, SegmentError, Segmentation, Settings, Working};
use crate::filter::{self, otsu, quantile, sample};
use crate::plane::Plane;
use crate::region::{Connectivity, Region};
use myospring_core::mesh::pixel_size::PixelSize;

/// Scale of smoothing unless stated, um.
const SMOOTH_UM: f64 = 0.5;
/// Coarsest pixel that the work needs, um; finer pictures are averaged.
const WORKING_PIXEL_UM: f64 = 0.25;
/// Radius by which gaps are closed, um: stripes of a myocyte are 1.6 to 2.2 um apart, and between two
/// stripes of the rim the outline is to go on.
const CLOSING_UM: f64 = 1.5;
/// Part of the brightest by which the unit of brightness is at least measured: below it is stray light
/// rather than noise.
const LEAST_UNIT: f32 = 0.03;
/// Least brightness of a cell above the background, in standard deviations of the smoothed background.
const LEAST_NOISES: f32 = 3.5;
/// Brightness of the edge as part of the largest within two scales of smoothing: that of a step that was
/// blurred.
const EDGE: f32 = 0.5;

pub(super) fn segment(
    plane: &Plane,
    pixel_size: PixelSize,
    settings: &Settings,
    notes: Vec<String>,
) -> Result<Segmentation, SegmentError> {
    let Working { plane: working, factor, pixel_um: pixel } =
        Working::of(plane, pixel_size, WORKING_PIXEL_UM);
    let smooth_um = settings.smooth_um.unwrap_or(SMOOTH_UM);
    let smooth = filter::gaussian(&working, smooth_um / pixel);
    let ground = Ground::under(&smooth);
    let lifted = ground.taken_off(&smooth);
    let bright = quantile(&sample(lifted.values(), 400_000), 0.995);
    let unit = ground.noise.max(LEAST_UNIT * bright).max(f32::MIN_POSITIVE);
    // Linear in the noise, logarithmic above it.
    let levels = lifted.map(|value| (value / unit).asinh());
    let (level, separation) = match otsu(&sample(levels.values(), 400_000)) {
        Some([level, share]) => (level, share),
        None => (f32::INFINITY, 0.0),
    };
    // Otsu's level sinks into the noise where the cell is small or faint.
    let level = level.max((LEAST_NOISES * ground.noise / unit).asinh());
    // The light of a bright place spreads over the outline; half of it marks the edge.
    let near = filter::largest_nearby(&lifted, (2.0 * smooth_um / pixel).round() as usize);
    let inside = |at: usize| match settings.threshold {
        Some(threshold) => f64::from(smooth.values()[at]) > threshold,
        None => levels.values()[at] > level && lifted.values()[at] > EDGE * near.values()[at],
    };
    let count = working.values().len();
    let region = Region::new(working.width(), working.height(), (0..count).map(inside));
    let smallest = settings.smallest_cell_um2 / pixel.powi(2);
    // Specks first: they would be joined to the cell or each other.
    let speck = std::f64::consts::PI * (CLOSING_UM / 2.0 / pixel).powi(2);
    let region = region.kept(Connectivity::Eight, |island| island.pixels as f64 > speck);
    // Only around what is left: distances over a whole field of view cost more than all the rest.
    let window = region.window((2.0 * CLOSING_UM / pixel).ceil() as usize, 1);
    let region = region
        .cut(&window)
        .closed(CLOSING_UM / pixel)
        .filled(usize::MAX)
        .opened(smooth_um / pixel)
        .kept(Connectivity::Four, |island| island.pixels as f64 >= smallest)
        .smoothed(smooth_um / pixel)
        .pasted(&window, working.width(), working.height());
    let middle = ground.middle();
    let threshold = settings.threshold.unwrap_or(f64::from(middle + unit * level.sinh()));
    if region.count() == 0 {
        return Err(SegmentError::NoCell {
            modality: "fluorescence",
            threshold: format!("grey value {threshold:.4}"),
            why: format!("nothing brighter is as large as {} um^2", settings.smallest_cell_um2),
            pixel_size,
        });
    }
    let found = Found { region, factor, modality: Modality::Fluorescence, threshold, notes };
    let view = View { lifted, factor, pixel, noise: ground.noise, separation };
    let judge = |candidate: &Candidate<'_>| view.judge(candidate, plane.width());
    Ok(found.finish(plane, pixel_size, settings.smallest_cell_um2, judge))
}

/// The picture as the judge sees it.
struct View {
    lifted: Plane,
    factor: usize,
    pixel: f64,
    noise: f32,
    separation: f32,
}

impl View {
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
        // How far the brightness takes to fall, were it to fall as steeply as on the outline.
        let slopes: Vec<f32> = candidate
            .rim
            .iter()
            .map(|&pixel| place(pixel))
            .filter(|&(x, y)| x > 0 && y > 0 && x + 1 < columns && y + 1 < rows)
            .map(|(x, y)| {
                let along = self.lifted.at(x + 1, y) - self.lifted.at(x - 1, y);
                let down = self.lifted.at(x, y + 1) - self.lifted.at(x, y - 1);
                along.hypot(down) / (2.0 * self.pixel as f32)
            })
            .collect();
        let slope = f64::from(quantile(&slopes, 0.5));
        let fall_um = bright / slope.max(1e-30);
        let area = candidate.pixels.len() as f64 * (self.pixel / self.factor as f64).powi(2);
        let radius_um = (area / std::f64::consts::PI).sqrt();
        confidence.weigh(-fall_um / radius_um, -1.0, -0.35, || {
            format!("its rim is blurred: its brightness falls over some {fall_um:.1} um; is it out of focus?")
        });
        confidence.weigh(f64::from(self.separation), 0.3, 0.6, || {
            "cell and background differ little in brightness over the whole picture".to_owned()
        });
        confidence.weigh_shape(candidate, width);
        confidence
    }
}
