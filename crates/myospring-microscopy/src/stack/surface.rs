//! The surface of a cell: whether only the membrane is bright, and how wide its edges are.

use super::options::Stain;
use super::report::Blur;
use super::shape::Shape;
use super::volume::Volume;
use crate::filter::quantile;

/// Distances from the sides within which a voxel belongs to the wall, and from the surface beyond
/// which it belongs to the inside, um.
const WALL_UM: f32 = 1.25;
const INSIDE_UM: f64 = 2.0;
/// Fewest voxels of the inside; of a thinner cell, the deepest tenth is used.
const FEWEST_INSIDE: usize = 50;
const DEEPEST: f64 = 0.9;
/// Brightness of the wall over that of the inside above which only the membrane is bright. A filled
/// cell, blurred at its surface, has 0.6 to 1.
const MEMBRANE: f64 = 1.3;
/// Furthest layer from the surface that is taken for the membrane, um.
const FURTHEST_UM: f64 = 2.0;
/// Of all places on the surface, the widths at the sharpest quarter count: where the surface is
/// oblique, it seems blurred.
const SHARPEST: f64 = 0.25;
/// Full width at half maximum of a Gaussian over its standard deviation.
const FWHM: f64 = 2.3548;

/// What of the cell is bright, and the ratio of wall and inside by which it was determined.
pub(super) fn stain(lifted: &Volume<f32>, shape: &Shape) -> (Stain, f64) {
    let lateral = shape.depths([shape.pitch[0], shape.pitch[1], f64::INFINITY]);
    let depths = shape.depths(shape.pitch);
    let mut least = INSIDE_UM as f32;
    if depths.iter().filter(|&&depth| depth > least).count() < FEWEST_INSIDE {
        let own: Vec<f32> = depths.iter().copied().filter(|&depth| depth > 0.0).collect();
        least = quantile(&own, DEEPEST) * 0.999;
    }
    let layer = lifted.layer();
    let (mut wall, mut inside) = (Vec::new(), Vec::new());
    for (z, values) in lifted.slices().enumerate() {
        let [depths, lateral] = [&depths, &lateral].map(|all| &all[z * layer..][..layer]);
        // Only slices through the inside: others show the membrane from above.
        if !depths.iter().any(|&depth| depth > least) {
            continue;
        }
        for (at, &value) in values.iter().enumerate() {
            if depths[at] > least {
                inside.push(value);
            } else if lateral[at] > 0.0 && lateral[at] <= WALL_UM {
                wall.push(value);
            }
        }
    }
    let middle = f64::from(quantile(&inside, 0.5));
    let wall = f64::from(wall.iter().sum::<f32>()) / wall.len().max(1) as f64;
    let ratio = wall.max(0.0) / middle.max(1e-6 * wall.abs()).max(f64::MIN_POSITIVE);
    (if ratio > MEMBRANE { Stain::Membrane } else { Stain::Filled }, ratio)
}

/// How far below the surface the brightest layer lies, um: at the sides, and at top and bottom.
pub(super) fn brightest_layer(lifted: &Volume<f32>, shape: &Shape) -> [f64; 2] {
    let counts = shape.by_slice();
    let most = counts.iter().copied().max().unwrap_or(0);
    let layer = lifted.layer();
    let [x, y, z] = shape.pitch;
    let lateral = shape.depths([x, y, f64::INFINITY]);
    let vertical = shape.depths([f64::INFINITY, f64::INFINITY, z]);
    let high = |depths: &[f32], um: f64| depths.iter().any(|&depth| f64::from(depth) > um);
    let full = |at: usize| 10 * counts[at / layer] >= 9 * most;
    let sides = |at: usize| full(at) && lateral[at] > 0.0;
    // Not at the sides, where columns run along the wall.
    let off = if high(&lateral, 2.0 * INSIDE_UM) { INSIDE_UM } else { 0.0 };
    let caps = |at: usize| f64::from(lateral[at]) > off && vertical[at] > 0.0;
    [(lateral.as_slice(), x, &sides as &dyn Fn(usize) -> bool), (&vertical, z, &caps)].map(
        |(depths, pitch, used)| {
            let deepest = depths.iter().copied().fold(0.0, f32::max);
            let furthest = FURTHEST_UM.min(f64::from(deepest));
            peak(&lifted.values, depths, used, pitch, furthest)
        },
    )
}

/// Distance from the surface to the layer with the largest mean value, um.
fn peak(
    values: &[f32],
    depths: &[f32],
    used: &dyn Fn(usize) -> bool,
    pitch: f64,
    furthest: f64,
) -> f64 {
    let layers = (furthest / pitch).round().max(1.0) as usize;
    let mut sums = vec![[0.0_f64; 2]; layers];
    for (at, &depth) in depths.iter().enumerate().filter(|(_, depth)| **depth > 0.0) {
        let layer = (f64::from(depth) / pitch).round() as usize;
        if (1..=layers).contains(&layer) && used(at) {
            sums[layer - 1][0] += f64::from(values[at]);
            sums[layer - 1][1] += 1.0;
        }
    }
    let means: Vec<f64> = sums.iter().map(|[sum, count]| sum / count.max(1.0)).collect();
    let best = (0..layers).max_by(|&a, &b| means[a].total_cmp(&means[b])).unwrap_or(0);
    // A parabola through the largest mean and its neighbours.
    let [before, here, after] = [best.saturating_sub(1), best, (best + 1).min(layers - 1)];
    let bend = means[before] - 2.0 * means[here] + means[after];
    let shift = if before < here && here < after && bend < 0.0 {
        0.5 * (means[before] - means[after]) / bend
    } else {
        0.0
    };
    // The middle of the first layer lies half a voxel below the surface.
    (best as f64 + 0.5 + shift) * pitch
}

/// The shape with its surface moved inward: by `sides` um along x and y, by `caps` um along z, and
/// in between by the radius of an ellipsoid.
pub(super) fn moved_inward(shape: Shape, [sides, caps]: [f64; 2]) -> Shape {
    let [x, y, z] = shape.pitch;
    if sides < 0.25 * x && caps < 0.25 * z {
        return shape;
    }
    let [sides, caps] = [sides.max(0.1 * x), caps.max(0.1 * z)];
    let scaled = [x / sides, y / sides, z / caps];
    // Depths are from the middles of voxels outside, half a voxel beyond the surface.
    let least = 1.0 + 0.25 * (scaled[0] + scaled[2]);
    let inside: Vec<bool> =
        shape.depths(scaled).into_iter().map(|depth| f64::from(depth) > least).collect();
    Shape { inside, ..shape }
}

/// Widths of the edges of a cell: `relative` is brightness over its threshold, 2 inside.
pub(super) fn blur(relative: &Volume<f32>, shape: &Shape, stain: Stain, smooth_um: f64) -> Blur {
    // Height over the largest slope: of a step, blurred by a Gaussian, sqrt(2 pi) of its standard
    // deviation; of a Gaussian exp(1/2).
    let per_width = match stain {
        Stain::Membrane => 0.5_f64.exp(),
        Stain::Filled | Stain::Auto => std::f64::consts::TAU.sqrt(),
    };
    let sharp = |slopes: &[f32]| {
        let slope = f64::from(quantile(slopes, 1.0 - SHARPEST));
        (slopes.len() >= FEWEST_INSIDE && slope > 0.0).then(|| 2.0 / slope / per_width)
    };
    // Smoothing has blurred the edges, too, unless voxels are too long for it.
    let own = |sigma: f64, pitch: f64| {
        let smooth = if smooth_um / pitch < 0.3 { 0.0 } else { smooth_um };
        FWHM * (sigma * sigma - smooth * smooth).max(0.0).sqrt()
    };
    let [x, _, z] = relative.pitch;
    // The wall of a membrane, seen from its edge, is brighter than its columns' mean.
    let lateral = (stain == Stain::Filled).then(|| lateral_slopes(relative, shape));
    let plane_um = lateral.and_then(|slopes| sharp(&slopes)).map(|sigma| own(sigma, x));
    let depth_um = sharp(&vertical_slopes(relative, shape)).map(|sigma| own(sigma, z));
    Blur { plane_um, depth_um }
}

/// Slopes within the fullest slice at its rim, per um.
fn lateral_slopes(relative: &Volume<f32>, shape: &Shape) -> Vec<f32> {
    let [width, height, _] = relative.size;
    let counts = shape.by_slice();
    let Some(z) = (0..counts.len()).max_by_key(|&z| counts[z]) else { return Vec::new() };
    let layer = relative.layer();
    let values = &relative.values[z * layer..][..layer];
    let inside = &shape.inside[z * layer..][..layer];
    let mut slopes = Vec::new();
    for row in 1..height.max(2) - 1 {
        for column in 1..width.max(2) - 1 {
            let at = row * width + column;
            let sides = [at - 1, at + 1, at - width, at + width];
            if inside[at] && sides.iter().any(|&side| !inside[side]) {
                let [left, right, above, below] = sides.map(|side| values[side]);
                let um = 2.0 * relative.pitch[0] as f32;
                slopes.push((right - left).hypot(below - above) / um);
            }
        }
    }
    slopes
}

/// Slopes along columns where they enter and leave the cell, per um, away from its sides.
fn vertical_slopes(relative: &Volume<f32>, shape: &Shape) -> Vec<f32> {
    let layer = relative.layer();
    let [x, y, _] = shape.pitch;
    let lateral = shape.depths([x, y, f64::INFINITY]);
    let mut widest = vec![0.0_f32; layer];
    for slice in lateral.chunks_exact(layer) {
        for (widest, depth) in widest.iter_mut().zip(slice) {
            *widest = widest.max(*depth);
        }
    }
    let half = 0.5 * widest.iter().copied().fold(0.0, f32::max);
    let mut slopes = Vec::new();
    for at in (0..layer).filter(|&at| widest[at] > half) {
        let values: Vec<f32> = relative.column(at).collect();
        let first = values.windows(2).find(|two| two[0] <= 1.0 && two[1] > 1.0);
        let last = values.windows(2).rev().find(|two| two[0] > 1.0 && two[1] <= 1.0);
        let steep = |two: &[f32]| (two[1] - two[0]).abs() / relative.pitch[2] as f32;
        slopes.extend(first.into_iter().chain(last).map(steep));
    }
    slopes
}
