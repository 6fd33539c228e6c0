//! Local power spectra: power by wave number and direction, at places 2 um apart.
//!
//! Around each place the picture is weighted with a Gaussian of [`WINDOW_UM`], and its Fourier
//! transform is taken at wave numbers up to [`HIGHEST`] by direct sums (rows first, shared by the
//! places of a column). A stripe pattern gives a Gaussian peak of standard deviation 0.08 per um at
//! its wave vector, without side lobes. The power is then sampled along rays, in [`ORIENTATIONS`]
//! directions at wave numbers in geometric progression.

use super::grid::{Grid, Lines};
use super::reading::Place;
use super::window::Window;
use myospring_core::analysis::order::median;
use myospring_core::interruption::{Interrupted, Interruption};

/// Standard deviation of the Gaussian around a place, um: the window contains about four
/// sarcomeres.
pub(super) const WINDOW_UM: f64 = 2.0;

/// Distance between places, um; larger if there would be more than [`MOST_PLACES`].
const STEP_UM: f64 = 2.0;

/// Largest number of places in the bounding box of a cell; larger cells are sampled more coarsely.
const MOST_PLACES: f64 = 20_000.0;

/// Cut-off of the Gaussian, in standard deviations.
const REACH: f64 = 3.0;

/// Directions in half a turn.
pub(super) const ORIENTATIONS: usize = 36;

/// The longest and the shortest sarcomere that is searched, um.
pub(super) const LONGEST_UM: f64 = 2.6;
pub(super) const SHORTEST_UM: f64 = 1.4;

/// Ratio of neighbouring wave numbers.
pub(super) const RATIO: f64 = 1.07;

/// Number of wave numbers below that of the longest sarcomere; they reach down to about half of it.
const BELOW: i32 = 11;

/// Largest wave number, per um: 1.65 times that of the shortest sarcomere.
const HIGHEST: f64 = 1.65 / SHORTEST_UM;

/// Part of the Nyquist wave number up to which a picture is examined.
const NYQUIST_PART: f64 = 0.92;

/// Distance of wave numbers at which the transform is taken, per um.
const SPACING: f64 = 0.05;

/// Standard deviation of the Gaussian over which contrast is normalised, um.
const CONTRAST_UM: f64 = 3.0;

/// Contrast below this part of the cell's median counts as no contrast.
const FAINT: f32 = 0.2;

/// Normalised values are clipped at this many standard deviations, so that a bright spot or line
/// has no more weight.
const LOUDEST: f32 = 2.0;

/// A place with less than this part of its Gaussian within the cell is skipped.
const LEAST_WEIGHT: f32 = 0.1;

/// Power spectra at the places of a grid.
pub(super) struct Spectra {
    pub(super) place: Place,
    /// Part of each place's Gaussian that lies in the cell, 0 for skipped places.
    pub(super) weight: Vec<f32>,
    /// Wave numbers, per um, ascending.
    pub(super) wave_numbers: Vec<f64>,
    /// Power of each place, wave number and direction, in this order, relative to the typical power
    /// of the place.
    pub(super) power: Vec<f32>,
}

impl Spectra {
    /// Computes the spectra of a cell.
    pub(super) fn of(window: &Window, interruption: &Interruption) -> Result<Self, Interrupted> {
        let [columns, rows] = window.size;
        let area_um2 = (columns * rows) as f64 * window.pixel_um.powi(2);
        let step_um = STEP_UM.max((area_um2 / MOST_PLACES).sqrt());
        let place = Place::over(window, (step_um / window.pixel_um).round().max(1.0) as usize);
        let highest = HIGHEST.min(NYQUIST_PART * 0.5 / window.pixel_um);
        let wave_numbers: Vec<f64> = (-BELOW..64)
            .map(|power| RATIO.powi(power) / LONGEST_UM)
            .take_while(|&wave_number| wave_number <= highest)
            .collect();
        let weight = weights(window, &place.grid);
        let values = evened(window);
        let rays = Rays::of(&wave_numbers, window.pixel_um);
        let size = wave_numbers.len() * ORIENTATIONS;
        let mut power = vec![0.0; weight.len() * size];
        let [across, down] = place.grid.size;
        let mut strip = Strip::new(&rays, rows);
        let mut plane = vec![0.0; rays.width * (2 * rays.reach + 1)];
        for column in 0..across {
            let used = |row: usize| weight[row * across + column] > 0.0;
            if !(0..down).any(used) {
                continue;
            }
            interruption.check()?;
            let block = place.grid.block as f64;
            let middle =
                |at: usize, count: usize| (((at as f64 + 0.5) * block) as usize).min(count - 1);
            strip.fill(&rays, &values, columns, middle(column, columns));
            for row in (0..down).filter(|&row| used(row)) {
                let at = row * across + column;
                strip.spectrum(&rays, middle(row, rows), &mut plane);
                rays.read(&plane, &mut power[at * size..(at + 1) * size]);
                relative(&mut power[at * size..(at + 1) * size]);
            }
        }
        Ok(Self { place, weight, wave_numbers, power })
    }
}

/// Divides a spectrum by its typical power: the mean over wave numbers of the median over
/// directions.
fn relative(power: &mut [f32]) {
    let count = power.len() / ORIENTATIONS;
    let middle = |ring: &[f32]| {
        let mut ring: [f32; ORIENTATIONS] = std::array::from_fn(|at| ring[at]);
        *ring.select_nth_unstable_by(ORIENTATIONS / 2, f32::total_cmp).1
    };
    let usual = power.chunks_exact(ORIENTATIONS).map(middle).sum::<f32>() / count as f32;
    let scale = if usual > f32::MIN_POSITIVE { usual.recip() } else { 0.0 };
    for power in power {
        *power *= scale;
    }
}

/// Part of the Gaussian around each place that lies on counted pixels.
fn weights(window: &Window, grid: &Grid) -> Vec<f32> {
    let counted = counted(window);
    let mut weight = grid.zeros();
    for (row, counted) in counted.chunks_exact(window.size[0]).enumerate() {
        grid.add_row(&mut weight, row, counted);
    }
    grid.blur(&mut weight, WINDOW_UM / (window.pixel_um * grid.block as f64));
    for weight in &mut weight {
        *weight /= (grid.block * grid.block) as f32;
        if *weight < LEAST_WEIGHT {
            *weight = 0.0;
        }
    }
    weight
}

fn counted(window: &Window) -> Vec<f32> {
    window.counted.iter().map(|&counted| if counted { 1.0 } else { 0.0 }).collect()
}

/// The window's values divided by their local standard deviation, clipped at [`LOUDEST`].
fn evened(window: &Window) -> Vec<f32> {
    let columns = window.size[0];
    let sigma = CONTRAST_UM / window.pixel_um;
    let grid = Grid::over(window.size, ((sigma / 4.0) as usize).max(1));
    let (mut squares, mut counts) = (grid.zeros(), grid.zeros());
    let counted = counted(window);
    let mut line = vec![0.0; columns];
    for (row, values) in window.values.chunks_exact(columns).enumerate() {
        let counted = &counted[row * columns..][..columns];
        for ((square, value), counted) in line.iter_mut().zip(values).zip(counted) {
            *square = counted * value * value;
        }
        grid.add_row(&mut squares, row, &line);
        grid.add_row(&mut counts, row, counted);
    }
    let within: Vec<bool> = counts.iter().map(|&count| count > 0.0).collect();
    grid.blur(&mut squares, sigma / grid.block as f64);
    grid.blur(&mut counts, sigma / grid.block as f64);
    for (square, count) in squares.iter_mut().zip(&counts) {
        let mean = if *count > f32::MIN_POSITIVE { *square / count } else { 0.0 };
        *square = if mean.is_finite() { mean.sqrt() } else { 0.0 };
    }
    let known = squares.iter().zip(&within).filter(|(_, within)| **within);
    let usual = median(known.map(|(deviation, _)| *deviation)).unwrap_or(0.0);
    let faint = (FAINT * usual).max(f32::MIN_POSITIVE);
    // A slope rounded to whole grey levels has steps of 0.3 levels; those are not contrast.
    let least = 0.5 * window.grey_step as f32;
    let mut lines = Lines::new(&grid, columns);
    let mut evened = vec![0.0; window.values.len()];
    for (row, out) in evened.chunks_exact_mut(columns).enumerate() {
        let deviations = lines.at(&grid, &squares, row);
        let pixels = window.values[row * columns..].iter().zip(&window.counted[row * columns..]);
        for ((out, (value, &counted)), deviation) in out.iter_mut().zip(pixels).zip(deviations) {
            if counted && *deviation > least {
                *out = (value / (deviation + faint)).clamp(-LOUDEST, LOUDEST);
            }
        }
    }
    evened
}

/// Sampling rays of the transform, and the waves from which it is computed.
struct Rays {
    /// Half-width of the window, pixels.
    half: usize,
    /// Largest index of a wave number along y.
    reach: usize,
    /// Number of wave numbers along x; the first two are below zero.
    width: usize,
    /// The Gaussian times cosine and sine, `[offset][wave number]`, along x and along y.
    across: [Vec<f32>; 2],
    down: [Vec<f32>; 2],
    /// For each wave number and direction the first of 4 x 4 values of the transform, and their weights.
    samples: Vec<(usize, [f32; 4], [f32; 4])>,
}

/// Number of wave numbers below zero, needed for interpolation.
const MARGIN: usize = 2;

impl Rays {
    fn of(wave_numbers: &[f64], pixel_um: f64) -> Self {
        let half = (REACH * WINDOW_UM / pixel_um).ceil() as usize;
        let last = wave_numbers.last().copied().unwrap_or(0.0);
        let reach = (last / SPACING).ceil() as usize + MARGIN;
        let width = reach + 1 + MARGIN;
        let waves = |first: f64, count: usize| -> [Vec<f32>; 2] {
            let table = |wave: fn(f64) -> f64| {
                let value = |at: usize| {
                    let x = (at / count) as f64 * pixel_um;
                    let phase = std::f64::consts::TAU * x * SPACING * (first + (at % count) as f64);
                    (wave(phase) * (-0.5 * (x / WINDOW_UM).powi(2)).exp()) as f32
                };
                (0..(half + 1) * count).map(value).collect()
            };
            [table(f64::cos), table(f64::sin)]
        };
        let across = waves(-(MARGIN as f64), width);
        let down = waves(0.0, reach + 1);
        let samples = wave_numbers
            .iter()
            .flat_map(|&wave_number| {
                (0..ORIENTATIONS).map(move |direction| {
                    let angle = std::f64::consts::PI * direction as f64 / ORIENTATIONS as f64;
                    // Rows run downward. A wave and its reverse are the same; the one with x at
                    // least 0 is used.
                    let (mut x, mut y) = (angle.cos(), -angle.sin());
                    if x < 0.0 {
                        (x, y) = (-x, -y);
                    }
                    let [x, y] = [x, y].map(|x| x * wave_number / SPACING);
                    let (column, row) = (x + MARGIN as f64, y + reach as f64);
                    let first = (row.floor() as usize - 1) * width + column.floor() as usize - 1;
                    (first, cubic(column.fract()), cubic(row.fract()))
                })
            })
            .collect();
        Self { half, reach, width, across, down, samples }
    }

    /// The power along the rays, from that of the transform.
    fn read(&self, plane: &[f32], power: &mut [f32]) {
        for (power, (first, across, down)) in power.iter_mut().zip(&self.samples) {
            let mut sum = 0.0;
            for (row, weight) in down.iter().enumerate() {
                let line = &plane[first + row * self.width..][..4];
                let along: f32 =
                    line.iter().zip(across).map(|(value, weight)| value * weight).sum();
                sum += weight * along;
            }
            *power = sum.max(0.0);
        }
    }
}

/// Weights of the cubic interpolation through four values (Catmull and Rom), at a fraction of the
/// way from the second to the third.
fn cubic(t: f64) -> [f32; 4] {
    let (t2, t3) = (t * t, t * t * t);
    [-t + 2.0 * t2 - t3, 2.0 - 5.0 * t2 + 3.0 * t3, t + 4.0 * t2 - 3.0 * t3, t3 - t2]
        .map(|weight| (0.5 * weight) as f32)
}

/// The transforms of all rows around one column of places.
struct Strip {
    /// Real and imaginary parts, `[row][wave number]`, with empty rows above and below.
    rows: [Vec<f32>; 2],
    /// Even and odd sums of rows at equal distance above and below a place, for real and imaginary
    /// parts.
    sums: [Vec<f32>; 4],
}

impl Strip {
    fn new(rays: &Rays, rows: usize) -> Self {
        let zeros = || vec![0.0; (rows + 2 * rays.half + 1) * rays.width];
        let line = || vec![0.0; rays.width];
        Self { rows: [zeros(), zeros()], sums: [line(), line(), line(), line()] }
    }

    /// Computes the transforms along the rows, around a column of pixels.
    fn fill(&mut self, rays: &Rays, values: &[f32], columns: usize, middle: usize) {
        let width = rays.width;
        for (row, line) in values.chunks_exact(columns).enumerate() {
            let at = (row + rays.half) * width;
            let [real, imaginary] = &mut self.rows;
            let (real, imaginary) = (&mut real[at..at + width], &mut imaginary[at..at + width]);
            real.fill(0.0);
            imaginary.fill(0.0);
            for offset in 0..=rays.half {
                let right = line.get(middle + offset).copied().unwrap_or(0.0);
                let left = match middle.checked_sub(offset) {
                    Some(left) if offset > 0 => line.get(left).copied().unwrap_or(0.0),
                    _ => 0.0,
                };
                let (even, odd) = (right + left, right - left);
                if even == 0.0 && odd == 0.0 {
                    continue;
                }
                let cosine = &rays.across[0][offset * width..][..width];
                let sine = &rays.across[1][offset * width..][..width];
                for ((real, imaginary), (cosine, sine)) in
                    real.iter_mut().zip(&mut *imaginary).zip(cosine.iter().zip(sine))
                {
                    *real += even * cosine;
                    *imaginary -= odd * sine;
                }
            }
        }
    }

    /// The power of the transform around a row of pixels.
    fn spectrum<'a>(&'a mut self, rays: &Rays, middle: usize, plane: &mut [f32]) {
        let (width, reach, half) = (rays.width, rays.reach, rays.half);
        let [rows_real, rows_imaginary] = &self.rows;
        let [even_real, even_imaginary, odd_real, odd_imaginary] = &mut self.sums;
        for wave in 0..=reach {
            for sum in [&mut *even_real, &mut *even_imaginary, &mut *odd_real, &mut *odd_imaginary]
            {
                sum.fill(0.0);
            }
            for offset in 0..=half {
                let cosine = rays.down[0][offset * (reach + 1) + wave];
                let sine = rays.down[1][offset * (reach + 1) + wave];
                let below = (middle + half + offset) * width;
                let above = (middle + half - offset) * width;
                // The central row is added only once.
                let both = if offset == 0 { 0.0 } else { 1.0 };
                let lines = |rows: &'a [f32]| [&rows[below..][..width], &rows[above..][..width]];
                let wave = [cosine, sine];
                add(even_real, odd_real, wave, both, lines(rows_real));
                add(even_imaginary, odd_imaginary, wave, both, lines(rows_imaginary));
            }
            // The sum of f(x, y) exp(-i k y) is C - i D, where C comes from the even and D from the
            // odd part.
            for at in 0..width {
                let (a, b, c, d) =
                    (even_real[at], even_imaginary[at], odd_real[at], odd_imaginary[at]);
                plane[(reach + wave) * width + at] = (a + d).powi(2) + (b - c).powi(2);
                plane[(reach - wave) * width + at] = (a - d).powi(2) + (b + c).powi(2);
            }
        }
    }
}

/// Adds two lines to the sums of their even part and of their odd part.
fn add(
    even: &mut [f32],
    odd: &mut [f32],
    [cosine, sine]: [f32; 2],
    both: f32,
    [below, above]: [&[f32]; 2],
) {
    let lines = below.iter().zip(above);
    for ((even, odd), (below, above)) in even.iter_mut().zip(odd).zip(lines) {
        *even += cosine * (below + both * above);
        *odd += sine * (below - both * above);
    }
}
