//! Structure tensors: products of gradients, summed over blocks of pixels, normalised and smoothed.

use super::super::plane::Plane;
use super::reading::{Place, Reading, Readings};
use super::settings::FibreSettings;
use super::window::{Cut, Window};
use myospring_core::analysis::order::median;

/// Pixels are binned until the gradient scale is at most about twice this many pixels.
const ENOUGH_PIXELS: f64 = 1.25;

/// Cut-off of a Gaussian, in standard deviations; its value there is 1/3000 of its height.
const REACH: f64 = 4.0;

/// How far into the rim the picture is used, in standard deviations of the gradient's Gaussian: a
/// step there has 1/90 of the weight of one in the middle.
const SEEN: f64 = 3.0;

/// Gradient energy below this part of the cell's median counts as faint. A place with a third of
/// the usual contrast has a ninth of the energy, and so about half the weight.
const FAINT: f64 = 0.1;

/// A place with less than this part of its neighbourhood counted has no direction.
const LEAST_SUPPORT: f32 = 0.05;

/// Sums over the blocks of a grid, from the gradient `g`, y upward.
struct Tensors {
    place: Place,
    /// `g_x^2 - g_y^2`, the trace times the coherency times the cosine of the doubled angle.
    cosine: Vec<f32>,
    /// `2 g_x g_y`, likewise with the sine.
    sine: Vec<f32>,
    /// `g_x^2 + g_y^2`, the trace.
    energy: Vec<f32>,
    /// Number of pixels counted.
    weight: Vec<f32>,
    /// Gradient energy of stripes with an amplitude of one grey step.
    least_energy: f64,
}

/// Weights of a sampled Gaussian at 0, 1, ... and of its derivative at 1, 2, ... The derivative is
/// scaled so that a slope of one per pixel has the gradient one.
fn kernels(sigma: f64, reach: usize) -> [Vec<f32>; 2] {
    let weight = |i: usize| (-0.5 * (i as f64 / sigma).powi(2)).exp();
    let sum = weight(0) + 2.0 * (1..=reach).map(weight).sum::<f64>();
    let slope = 2.0 * (1..=reach).map(|i| (i * i) as f64 * weight(i)).sum::<f64>();
    [
        (0..=reach).map(|i| (weight(i) / sum) as f32).collect(),
        (0..=reach).map(|i| (i as f64 * weight(i) / slope) as f32).collect(),
    ]
}

/// Reads directions from gradients; `None` if no pixel belongs to the cell.
pub(super) fn read(
    plane: &Plane,
    inside: &[bool],
    pixel_size_um: f64,
    settings: &FibreSettings,
) -> Option<Readings> {
    let side = ((settings.gradient_scale_um / pixel_size_um / ENOUGH_PIXELS) as usize).max(1);
    let pixel_um = pixel_size_um * side as f64;
    let sigma = (settings.gradient_scale_um / pixel_um).max(1.0);
    let cut = Cut {
        side,
        background_um: settings.background_scale_um,
        rim_um: settings.rim_um,
        // The bright, blurred membrane must not influence the counted gradients; the pixels within
        // reach of these gradients are needed for them.
        unseen_um: settings.rim_um - SEEN * sigma * pixel_um,
        frame: (REACH * sigma).ceil() as usize,
    };
    let window = Window::cut(plane, inside, pixel_size_um, &cut)?;
    Some(tensors(&window, sigma, settings).smoothed(settings))
}

/// The tensors of a window, summed over blocks of a quarter of the smoothing.
fn tensors(window: &Window, sigma: f64, settings: &FibreSettings) -> Tensors {
    let [columns, rows] = window.size;
    let block = (settings.smoothing_um / window.pixel_um / 4.0).round().max(1.0) as usize;
    let place = Place::over(window, block);
    let grid = place.grid;
    let mut tensors = Tensors {
        place,
        cosine: grid.zeros(),
        sine: grid.zeros(),
        energy: grid.zeros(),
        weight: grid.zeros(),
        // Stripes of amplitude A and wave number k have the energy A^2/2 k^2 exp(-k^2 sigma^2), which is
        // largest at k = 1/sigma.
        least_energy: 0.5 * (-1.0_f64).exp() * (window.grey_step / sigma).powi(2),
    };
    let kernels = kernels(sigma, window.frame);
    let (mut smooth, mut slope) = (vec![0.0; columns], vec![0.0; columns]);
    let (mut along_x, mut along_y) = (vec![0.0; columns], vec![0.0; columns]);
    let mut products = Products::new(columns);
    for row in window.frame..rows - window.frame {
        let counted = &window.counted[row * columns..(row + 1) * columns];
        let Some(first) = counted.iter().position(|&counted| counted) else { continue };
        let behind = counted.iter().rposition(|&counted| counted).map_or(first, |last| last + 1);
        // The frame of the window is as wide as the reach.
        let from = first - window.frame.min(first);
        let to = (behind + window.frame).min(columns);
        down_columns(window, row, [from, to], &kernels, [&mut smooth, &mut slope]);
        along_row(&smooth, [first, behind], &kernels[1], Parity::Odd, &mut along_x);
        along_row(&slope, [first, behind], &kernels[0], Parity::Even, &mut along_y);
        products.fill([&along_x, &along_y], counted, [first, behind]);
        let Products { cosine, sine, energy, weight } = &products;
        grid.add_row(&mut tensors.cosine, row, cosine);
        grid.add_row(&mut tensors.sine, row, sine);
        grid.add_row(&mut tensors.energy, row, energy);
        grid.add_row(&mut tensors.weight, row, weight);
    }
    tensors
}

/// Products of gradients along one row of pixels; zero where a pixel does not count.
struct Products {
    cosine: Vec<f32>,
    sine: Vec<f32>,
    energy: Vec<f32>,
    weight: Vec<f32>,
}

impl Products {
    fn new(columns: usize) -> Self {
        let zeros = || vec![0.0; columns];
        Self { cosine: zeros(), sine: zeros(), energy: zeros(), weight: zeros() }
    }

    /// Fills in the products from the gradients of a row (rows run downward), between two columns.
    fn fill(&mut self, [gx, gy]: [&[f32]; 2], counted: &[bool], [from, to]: [usize; 2]) {
        let Self { cosine, sine, energy, weight } = self;
        for out in [&mut *cosine, &mut *sine, &mut *energy, &mut *weight] {
            out[..from].fill(0.0);
            out[to..].fill(0.0);
        }
        let (cosine, sine) = (&mut cosine[from..to], &mut sine[from..to]);
        let (energy, weight) = (&mut energy[from..to], &mut weight[from..to]);
        let (gx, gy, counted) = (&gx[from..to], &gy[from..to], &counted[from..to]);
        for i in 0..to - from {
            // Not by multiplying with zero: NaN and infinity would remain.
            let (x, y) = if counted[i] { (gx[i], -gy[i]) } else { (0.0, 0.0) };
            cosine[i] = x * x - y * y;
            sine[i] = 2.0 * x * y;
            energy[i] = x * x + y * y;
            weight[i] = if counted[i] { 1.0 } else { 0.0 };
        }
    }
}

/// Gaussian and derivative down the columns, at one row and some columns.
fn down_columns(
    window: &Window,
    row: usize,
    [from, to]: [usize; 2],
    [gaussian, derivative]: &[Vec<f32>; 2],
    [smooth, slope]: [&mut [f32]; 2],
) {
    let columns = window.size[0];
    let line = |row: usize| &window.values[row * columns + from..row * columns + to];
    let (smooth, slope) = (&mut smooth[from..to], &mut slope[from..to]);
    for (out, value) in smooth.iter_mut().zip(line(row)) {
        *out = gaussian[0] * value;
    }
    slope.fill(0.0);
    for offset in 1..gaussian.len() {
        let (g, d) = (gaussian[offset], derivative[offset]);
        let lines = line(row - offset).iter().zip(line(row + offset));
        for ((smooth, slope), (above, below)) in smooth.iter_mut().zip(&mut *slope).zip(lines) {
            *smooth += g * (above + below);
            *slope += d * (below - above);
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Parity {
    Even,
    Odd,
}

/// Convolves a row with an even or odd kernel, from one column to another.
fn along_row(
    values: &[f32],
    [from, to]: [usize; 2],
    kernel: &[f32],
    parity: Parity,
    out: &mut [f32],
) {
    let out = &mut out[from..to];
    let shifted = |shift: usize| &values[shift..shift + (to - from)];
    for (out, value) in out.iter_mut().zip(shifted(from)) {
        *out = kernel[0] * value;
    }
    for (offset, &weight) in kernel.iter().enumerate().skip(1) {
        let sides = shifted(from - offset).iter().zip(shifted(from + offset));
        if parity == Parity::Even {
            for (out, (left, right)) in out.iter_mut().zip(sides) {
                *out += weight * (left + right);
            }
        } else {
            for (out, (left, right)) in out.iter_mut().zip(sides) {
                *out += weight * (right - left);
            }
        }
    }
}

impl Tensors {
    /// Normalises the contrast and averages over the neighbourhood.
    fn smoothed(self, settings: &FibreSettings) -> Readings {
        let Self { place, mut cosine, mut sine, mut energy, mut weight, least_energy } = self;
        let grid = place.grid;
        let local = settings.background_scale_um / place.block_um;
        let (mut around, mut support) = (energy.clone(), weight.clone());
        grid.blur(&mut around, local);
        grid.blur(&mut support, local);
        for (energy, weight) in around.iter_mut().zip(&support) {
            *energy = if *weight > f32::MIN_POSITIVE { *energy / weight } else { 0.0 };
        }
        let counted = around.iter().zip(&weight).filter(|(_, weight)| **weight > 0.0);
        let usual = median(counted.map(|(energy, _)| *energy)).unwrap_or(0.0);
        let faint = (FAINT * f64::from(usual)).max(least_energy) as f32;
        // Coherency is |sum of the doubled vectors| / sum of the traces; the faint energy is added
        // to the traces like noise, which has no direction.
        for at in 0..around.len() {
            let whole = around[at] + faint;
            let scale = if whole > 0.0 { whole.recip() } else { 0.0 };
            cosine[at] *= scale;
            sine[at] *= scale;
            energy[at] = (energy[at] + faint * weight[at]) * scale;
        }
        let sigma = settings.smoothing_um / place.block_um;
        for values in [&mut cosine, &mut sine, &mut energy, &mut weight] {
            grid.blur(values, sigma);
        }
        let least_weight = LEAST_SUPPORT * (grid.block * grid.block) as f32;
        let reading = |at: usize| {
            let trace = energy[at];
            if !(trace.is_finite() && trace > f32::MIN_POSITIVE) {
                return Reading::default();
            }
            let trust = (weight[at] / least_weight).min(1.0) / trace;
            let vector = [cosine[at] * trust, sine[at] * trust];
            let order = vector[0].hypot(vector[1]);
            if order <= 0.0 {
                return Reading::default();
            }
            Reading {
                // The eigenvector of the small eigenvalue lies along the threads.
                doubled: vector.map(|x| -x / order),
                part: smooth_step(order / settings.least_coherency as f32 - 0.5),
                order: order.min(1.0),
                sarcomere_um: None,
            }
        };
        let at = (0..energy.len()).map(reading).collect();
        Readings { place, at }
    }
}

/// Smooth step from 0 at 0 to 1 at 1, with zero slope at both.
fn smooth_step(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}
