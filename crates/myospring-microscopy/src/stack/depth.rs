//! How brightness changes with depth: the background of each slice, and attenuation.

use super::shape::Shape;
use super::volume::Volume;
use crate::filter::quantile;

/// Fewest pixels around the cell for the background of a slice.
const FEWEST_PIXELS: usize = 100;
/// Part of a slice that is surely background, if the cell leaves nothing around it.
const DARK: f64 = 0.05;
/// Depth below the surface at which brightness is not blurred by it, um.
const BELOW_UM: f64 = 1.5;
/// Fewest voxels of a slice, as a number and as a part of the largest slice's.
const FEWEST_VOXELS: usize = 20;
const FEWEST_SHARE: f64 = 0.1;
/// A slope counts if it exceeds this many standard errors, and this logarithm over the cell.
const SURE: f64 = 3.0;
const LEAST_CHANGE: f64 = 0.2;
/// Largest factor by which a slice is made brighter.
const MOST: f64 = 10.0;

/// The background of each slice: its median over the columns for which `around` is true.
pub(super) fn backgrounds(volume: &Volume<f32>, around: &[bool]) -> Vec<f32> {
    let few = around.iter().filter(|&&is| is).count() < FEWEST_PIXELS;
    let of_slice = |slice: &[f32]| {
        let values: Vec<f32> = if few {
            let dark = quantile(slice, DARK);
            slice.iter().copied().filter(|&value| value <= dark).collect()
        } else {
            slice.iter().zip(around).filter(|(_, around)| **around).map(|(v, _)| *v).collect()
        };
        quantile(&values, 0.5)
    };
    volume.slices().map(of_slice).collect()
}

/// Exponential change of brightness with depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Attenuation {
    /// Change of the logarithm of brightness per slice.
    rate: f64,
    /// First and last slice from which it was found.
    range: [f64; 2],
}

impl Attenuation {
    /// No change.
    pub(super) const NONE: Self = Self { rate: 0.0, range: [0.0; 2] };

    /// The factor that makes a slice as bright as the brightest one.
    pub(super) fn factor(self, slice: usize) -> f32 {
        let [low, high] = self.range;
        let brightest = if self.rate > 0.0 { high } else { low };
        let at = (slice as f64).clamp(low, high);
        ((self.rate * (brightest - at)).exp().min(MOST)) as f32
    }

    /// Distance over which brightness falls to 1/e, um; `None` without attenuation.
    pub(super) fn length_um(self, z_step_um: f64) -> Option<f64> {
        (self.rate != 0.0).then(|| z_step_um / self.rate.abs())
    }

    /// Fits the brightness of voxels deep inside a shape; [`Attenuation::NONE`] if it shows no steady
    /// change.
    pub(super) fn of(lifted: &Volume<f32>, shape: &Shape) -> Self {
        let used = shape.shrunk(BELOW_UM).inside;
        let layer = lifted.layer();
        let counts: Vec<usize> = used
            .chunks_exact(layer)
            .map(|slice| slice.iter().filter(|&&used| used).count())
            .collect();
        let most = counts.iter().copied().max().unwrap_or(0);
        let enough = FEWEST_VOXELS.max((FEWEST_SHARE * most as f64) as usize);
        let mut points = Vec::new();
        for (z, (values, used)) in lifted.slices().zip(used.chunks_exact(layer)).enumerate() {
            let values: Vec<f32> =
                values.iter().zip(used).filter(|(_, used)| **used).map(|(v, _)| *v).collect();
            let middle = f64::from(quantile(&values, 0.5));
            if counts[z] >= enough && middle > 0.0 {
                points.push([z as f64, middle.ln()]);
            }
        }
        fitted(&points).unwrap_or(Self::NONE)
    }
}

/// The least-squares line, if its slope is certain.
fn fitted(points: &[[f64; 2]]) -> Option<Attenuation> {
    let [first, .., last] = points else { return None };
    let count = points.len() as f64;
    if count < 3.0 {
        return None;
    }
    let mean = [0, 1].map(|axis| points.iter().map(|point| point[axis]).sum::<f64>() / count);
    let sum = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>();
    let xx = sum(&|[x, _]| (x - mean[0]).powi(2));
    let rate = sum(&|[x, y]| (x - mean[0]) * (y - mean[1])) / xx;
    let squares = sum(&|[x, y]| (y - mean[1] - rate * (x - mean[0])).powi(2));
    let error = (squares / (count - 2.0) / xx).sqrt();
    let range = [first[0], last[0]];
    // Few points may lie on a line by chance.
    let sure = SURE * (count / (count - 2.0)).sqrt();
    let certain = rate.abs() > sure * error && rate.abs() * (range[1] - range[0]) > LEAST_CHANGE;
    certain.then_some(Attenuation { rate, range })
}
