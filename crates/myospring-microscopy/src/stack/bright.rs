//! One cell of a fluorescence stack.

use super::above::Above;
use super::depth::{Attenuation, backgrounds};
use super::error::{MOST_VOXELS, StackError};
use super::load::{self, upward};
use super::options::{StackOptions, Stain};
use super::reading::{Scale, Stack};
use super::report::{Blur, StackReport};
use super::shape::Shape;
use super::surface;
use super::volume::Volume;
use crate::filter::{self, quantile};
use crate::plane::Plane;
use crate::region::Region;
use crate::segment::{Modality, check_settings};
use myospring_core::interruption::Interruption;
use myospring_core::mesh::voxels::{Block, DroppedParts, Voxels};

/// Finer pixels than this are averaged, um: half the scale of smoothing.
const PIXEL_UM: f64 = 0.25;
/// Default standard deviation of smoothing, um.
const SMOOTH_UM: f64 = 0.5;
/// Largest number of layers between two slices.
const MOST_PARTS: f64 = 8.0;
/// Radius by which gaps are closed, um: as in pictures.
const CLOSING_UM: f64 = 1.5;
/// Parts smaller than this are specks, um^3: a ball of 1.5 um across.
const SPECK_UM3: f64 = 1.8;
/// Part of the brightness above the background at which the surface lies, and at which the search
/// for it begins, so that dim depths are not missed.
const HALF: f32 = 0.5;
const BEGIN: f32 = 0.3;
/// Least part of the largest brightness of a column, so that stray light far from the cell is not
/// part of it. The far membrane of a thick cell can be dim, since nothing evens it.
const LEAST: f32 = 0.25;
const LEAST_OF_MEMBRANE: f32 = 0.12;
/// Distance above and below a voxel within which the brightness counts of which it must have half,
/// um: more than the blur of an optical section, less than the thickness of most cells.
const NEAR_UM: f64 = 3.0;
/// Rim of the outline from above whose columns do not count for brightness, um.
const RIM_UM: f64 = 1.0;
/// Scale over which the brightness of columns is averaged, um.
const EVEN_UM: f64 = 4.0;
/// Rounds in which attenuation and shape are improved.
const ROUNDS: usize = 3;

/// The cell that was chosen, and what is known of it.
pub(super) fn cell(
    stack: &Stack,
    scale: Scale,
    options: &StackOptions,
) -> Result<(Voxels, StackReport), StackError> {
    let settings = &options.segmentation;
    check_settings(settings)?;
    let interruption = &settings.interruption;
    let factor = ((PIXEL_UM / scale.pixel_size.um()) as usize).max(1);
    let (volume, notes) = load::volume(stack, scale, factor, interruption)?;
    let smooth_um = settings.smooth_um.unwrap_or(SMOOTH_UM);
    let volume = volume.smoothed(smooth_um);
    interruption.check()?;
    let above = Above::find(&volume, stack, factor, scale, options)?;
    let backgrounds = backgrounds(&volume, &above.around);
    let view = View::new(&volume, &above, backgrounds);
    drop(volume);
    let found = view.find(options, smooth_um)?;
    let mut report = StackReport::new(scale, Modality::Fluorescence);
    report.stain = Some(found.stain);
    report.threshold = Some(found.threshold);
    report.cells = above.cells;
    report.blur = Some(found.blur);
    report.attenuation_um = found.attenuation.length_um(scale.z_step_um);
    report.moved_inward_um = found.moved_inward_um;
    report.dropped = found.dropped;
    report.confidence = above.confidence.beside_texture();
    if above.is_brightfield {
        report.warnings.push(
            "the stack looks like brightfield, which does not show where a cell begins and ends in depth; if it is \
             fluorescence, give --modality fluorescence"
                .to_owned(),
        );
    }
    report.notes = notes;
    report.notes.extend(found.notes);
    let voxels = spread(&found.shape, &above, stack, scale, factor, options)?;
    Ok((voxels, report))
}

/// The shape on the pixels of the file, y and z upward.
fn spread(
    shape: &Shape,
    above: &Above,
    stack: &Stack,
    scale: Scale,
    factor: usize,
    options: &StackOptions,
) -> Result<Voxels, StackError> {
    let [width, height] = stack.size();
    let parts = shape.size[2] / stack.slices();
    let first = above.from.map(|at| at * factor);
    let size = [
        (above.to[0] * factor).min(width) - first[0],
        (above.to[1] * factor).min(height) - first[1],
        shape.size[2],
    ];
    let mut inside = Vec::with_capacity(size.iter().product());
    for z in 0..size[2] {
        for y in 0..size[1] {
            let row = &shape.inside[(z * shape.size[1] + y / factor) * shape.size[0]..];
            inside.extend((0..size[0]).map(|x| row[x / factor]));
        }
    }
    let block = Block { first: [first[0], first[1], 0], size, inside };
    let block = upward(block, size[2], height, options.first_slice);
    let side = scale.pixel_size.um();
    let pitch = [side, side, scale.z_step_um / parts as f64];
    Ok(Voxels::of_block([width, height, size[2]], pitch, block)?)
}

/// The stack around the cell.
struct View<'a> {
    above: &'a Above,
    /// Grey values above the background of their slice.
    lifted: Volume<f32>,
    backgrounds: Vec<f32>,
}

/// The cell's voxels, on the grid of the window with layers between slices.
struct Found {
    shape: Shape,
    stain: Stain,
    threshold: f64,
    attenuation: Attenuation,
    blur: Blur,
    moved_inward_um: Option<[f64; 2]>,
    dropped: DroppedParts,
    notes: Vec<String>,
}

impl<'a> View<'a> {
    fn new(volume: &Volume<f32>, above: &'a Above, backgrounds: Vec<f32>) -> Self {
        let mut lifted = volume.cropped(above.from, above.to);
        let layer = lifted.layer();
        for (slice, ground) in lifted.values.chunks_exact_mut(layer).zip(&backgrounds) {
            for value in slice {
                *value -= ground;
            }
        }
        Self { above, lifted, backgrounds }
    }

    fn find(&self, options: &StackOptions, smooth_um: f64) -> Result<Found, StackError> {
        let settings = &options.segmentation;
        let interruption = &settings.interruption;
        let begin = self.relative(&self.lifted, 0.0, BEGIN);
        let mut shape = tidied(self.shape(&begin), interruption)?;
        let (seen, ratio) = surface::stain(&self.lifted, &shape);
        let stain = if options.stain == Stain::Auto { seen } else { options.stain };
        let membrane = stain == Stain::Membrane;
        let mut attenuation = Attenuation::NONE;
        let mut even = self.lifted.clone();
        let least = if membrane { LEAST_OF_MEMBRANE } else { LEAST };
        for _ in 0..ROUNDS {
            let before = attenuation;
            if !membrane {
                attenuation = Attenuation::of(&self.lifted, &shape);
            }
            even = self.evened(attenuation);
            shape = tidied(self.shape(&self.relative(&even, HALF, least)), interruption)?;
            if attenuation == before {
                break;
            }
        }
        let bright = quantile(&self.columns(&even), 0.5);
        let relative = self.relative(&even, HALF, least);
        let half = f64::from(quantile(&self.backgrounds, 0.5) + HALF * bright);
        let threshold = settings.threshold.unwrap_or(half);
        let parts = self.parts()?;
        let fine = match settings.threshold {
            None => relative.finer(parts),
            Some(threshold) => self.over(threshold as f32).finer(parts),
        };
        let fine_shape = tidied(self.shape(&fine), interruption)?;
        let blur = surface::blur(&relative, &shape, stain, smooth_um);
        let layers = surface::brightest_layer(&even.finer(parts), &fine_shape);
        let moved_inward_um = membrane.then_some(layers);
        let moved = match moved_inward_um {
            Some(layers) => surface::moved_inward(fine_shape, layers),
            None => fine_shape.opened(smooth_um),
        };
        let (shape, parts, voxels) = moved.largest();
        if shape.count() == 0 {
            return Err(StackError::NothingInDepth { threshold });
        }
        let mut notes = Vec::new();
        if options.stain == Stain::Auto {
            let what = if membrane { "only its membrane" } else { "its inside" };
            notes.push(format!(
                "{what} was taken as bright: its sides are {ratio:.1} times as bright as its inside; if that is wrong, give \
                 --stack-stain {}",
                if membrane { "filled" } else { "membrane" }
            ));
        }
        let dropped = DroppedParts { parts, voxels };
        Ok(Found { shape, stain, threshold, attenuation, blur, moved_inward_um, dropped, notes })
    }

    /// Number of layers for each slice: as thick as pixels are wide, if that fits.
    fn parts(&self) -> Result<usize, StackError> {
        let [x, _, z] = self.lifted.pitch;
        let parts = (z / x.max(PIXEL_UM)).round().clamp(1.0, MOST_PARTS) as usize;
        let most = MOST_VOXELS / 4 / self.lifted.values.len().max(1);
        if most == 0 {
            return Err(StackError::TooLarge { voxels: self.lifted.values.len() as f64 });
        }
        Ok(parts.min(most))
    }

    /// Brightness with the attenuation divided out.
    fn evened(&self, attenuation: Attenuation) -> Volume<f32> {
        let mut even = self.lifted.clone();
        let layer = even.layer();
        for (z, slice) in even.values.chunks_exact_mut(layer).enumerate() {
            let factor = attenuation.factor(z);
            for value in slice {
                *value *= factor;
            }
        }
        even
    }

    /// Largest brightness of each column of the cell, without the rim of its outline.
    fn columns(&self, even: &Volume<f32>) -> Vec<f32> {
        let core = self.core();
        even.largest_down()
            .into_iter()
            .zip(core.inside())
            .filter(|(_, is)| *is)
            .map(|(v, _)| v)
            .collect()
    }

    fn core(&self) -> Region {
        let core = self.above.cell.shrunk(RIM_UM / self.lifted.pitch[0]);
        if core.count() > 0 { core } else { self.above.cell.clone() }
    }

    /// Brightness over its threshold: the part `near` of the largest brightness within some um above
    /// and below, at least the part `far` of the largest in the whole column; both are averaged
    /// over some um in the plane.
    fn relative(&self, even: &Volume<f32>, near: f32, far: f32) -> Volume<f32> {
        let [width, height, _] = even.size;
        let weights: Vec<f32> = self.core().inside().map(|is| if is { 1.0 } else { 0.0 }).collect();
        let sigma = EVEN_UM / even.pitch[0];
        let spread = |values: Vec<f32>| {
            let plane = Plane::new(width, height, values);
            plane.map(|plane| filter::slow_part(&plane, sigma).values().to_vec())
        };
        let all = quantile(&self.columns(even), 0.5);
        let averaged = |values: &[f32], otherwise: f32| {
            let sums = spread(values.iter().zip(&weights).map(|(v, w)| v * w).collect());
            let means = sums
                .unwrap_or_default()
                .into_iter()
                .zip(spread(weights.clone()).unwrap_or_default());
            let mean =
                |(sum, weight): (f32, f32)| if weight > 1e-3 { sum / weight } else { otherwise };
            means.map(mean).collect::<Vec<f32>>()
        };
        let least = averaged(&even.largest_down(), all);
        let reach = (NEAR_UM / even.pitch[2]).round() as usize;
        let largest = even.largest_near(reach);
        let mut relative = even.clone();
        let slices = relative.values.chunks_exact_mut(width * height);
        for (slice, largest) in slices.zip(largest.slices()) {
            let level = if near > 0.0 { averaged(largest, 0.0) } else { vec![0.0; least.len()] };
            for ((value, level), least) in slice.iter_mut().zip(level).zip(&least) {
                *value /= (near * level).max(far * least).max(f32::MIN_POSITIVE);
            }
        }
        relative
    }

    /// Grey values minus a threshold, plus 1, so that 1 is the threshold.
    fn over(&self, threshold: f32) -> Volume<f32> {
        let mut over = self.lifted.clone();
        let layer = over.layer();
        for (slice, ground) in over.values.chunks_exact_mut(layer).zip(&self.backgrounds) {
            for value in slice {
                *value += ground - threshold + 1.0;
            }
        }
        over
    }

    /// The voxels above 1 in columns in which the cell may lie.
    fn shape(&self, relative: &Volume<f32>) -> Shape {
        let allowed: Vec<bool> = self.above.allowed.inside().collect();
        let slices = relative.slices();
        let inside =
            slices.flat_map(|slice| slice.iter().zip(&allowed).map(|(&v, &is)| is && v > 1.0));
        Shape { size: relative.size, pitch: relative.pitch, inside: inside.collect() }
    }
}

/// The largest part of a shape without specks, gaps and holes.
fn tidied(shape: Shape, interruption: &Interruption) -> Result<Shape, StackError> {
    interruption.check()?;
    let closed = shape.without_specks(SPECK_UM3).closed(CLOSING_UM);
    interruption.check()?;
    Ok(closed.filled().largest().0)
}
