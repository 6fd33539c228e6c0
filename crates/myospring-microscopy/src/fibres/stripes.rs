//! Stripes: direction and period of sarcomeres, from peaks in local power spectra.
//!
//! 1. The spectra ([`Spectra`]) are averaged over neighbours (a Gaussian of
//!    [`FibreSettings::smoothing_um`] in place, that of the window included), which keeps peaks that
//!    neighbours share and flattens the isolated ones of noise and of columns of myofibrils.
//! 2. A peak's **contrast** is its power divided by the geometric mean of the powers at shorter and
//!    longer waves in the same direction. This whitens the spectrum: any power law (noise, a single
//!    line, an edge) has contrast 1 in every direction; only a periodic pattern has more.
//! 3. Sarcomeres of one cell have about one length: the most frequent period over all places.
//! 4. The evidence of a place for a direction is the logarithm of the contrast near this period.
//!    Three times, it is multiplied by the mean of its neighbours' in place and direction (like the
//!    votes of neighbours in `guy_medioni_1996`). The direction with the most evidence is the
//!    fibre's, if its contrast is high enough and if the wave is present at the place itself, not
//!    only around it.
//! 5. The centre of the peak gives angle and period to better than the sampling.

use super::super::plane::Plane;
use super::doubt::Band;
use super::grid::{Grid, half_gaussian};
use super::reading::{Reading, Readings};
use super::settings::FibreSettings;
use super::spectra::{LONGEST_UM, ORIENTATIONS, RATIO, SHORTEST_UM, Spectra, WINDOW_UM};
use super::window::{Cut, Window};
use myospring_core::analysis::order::median;
use myospring_core::interruption::{Interrupted, Interruption};
use std::f64::consts::FRAC_1_SQRT_2;

/// Pixels are binned up to this side, um: more than five pixels per shortest sarcomere.
const ENOUGH_UM: f64 = 0.25;
/// The shortest period that can be resolved, pixels.
const LEAST_PIXELS: f64 = 2.5;
/// Least contrast of a peak: 98 of 100 places stay below it in pictures of columns of myofibrils
/// alone, and all places in pictures of noise.
const LEAST_CONTRAST: f32 = 8.0;

/// Least contrast of a peak that helps to determine the cell's period.
const SEEN_CONTRAST: f32 = 4.0;

/// Least part of a cell's places with a peak at its period, and the contrast of that peak: many
/// places with a peak, or few with a clear one. Less may be chance.
const LEAST_SHARES: [(f64, f32); 2] = [(0.08, LEAST_CONTRAST), (0.02, 2.0 * LEAST_CONTRAST)];

/// Least number of such places.
const FEWEST_PLACES: usize = 2;

/// Standard deviation of the logarithm of sarcomere length within one cell, and its largest
/// deviation.
const SPREAD: f64 = 0.12;
const WIDEST: f64 = 0.18;

/// Least ratio of the wave's amplitude at a place to that around it.
const LEAST_AMPLITUDE: f32 = 0.4;

/// Standard deviations of the Gaussians over which the wave's amplitude is measured at a place and
/// around it, um.
const WAVE_UM: f64 = 1.0;
const SURROUNDINGS_UM: f64 = 6.0;

/// Standard deviation in direction, samples of 5 degrees: 8 degrees, about the width of a peak.
const TURN: f32 = 1.6;

/// Rounds of smoothing the evidence over neighbours, and the distance over which it is smoothed,
/// um.
const ROUNDS: usize = 3;
const CONTINUITY_UM: f64 = 4.0;

/// Wave numbers of the longer and shorter waves that a peak is compared with, relative to its own.
const LONGER: [f64; 2] = [0.5, 0.72];
const SHORTER: [f64; 2] = [1.32, 1.65];

/// Result of searching stripes in a cell.
pub(super) struct Stripes {
    pub(super) readings: Readings,
    /// The periods that were searched.
    pub(super) band: Band,
    /// Median period of the places that show one, um, including periods beyond the band.
    pub(super) period_um: Option<f64>,
    /// Part of the cell that these places cover.
    pub(super) share: f64,
    /// Median power of the wave (half its squared amplitude) over the places with a direction, grey
    /// levels squared.
    pub(super) power: f32,
}

/// The stripes of a cell; `None` where no pixel is the cell.
pub(super) fn of_cell(
    plane: &Plane,
    inside: &[bool],
    pixel_um: f64,
    settings: &FibreSettings,
    interruption: &Interruption,
) -> Result<Option<Stripes>, Interrupted> {
    // Of a large picture the window alone takes most of a second.
    interruption.check()?;
    let side = ((ENOUGH_UM / pixel_um) as usize).max(1);
    let cut = Cut {
        side,
        background_um: settings.background_scale_um,
        rim_um: settings.rim_um,
        unseen_um: settings.rim_um,
        frame: 0,
    };
    let window = Window::cut(plane, inside, pixel_um, &cut);
    window.map(|window| read(&window, LEAST_PIXELS * pixel_um, settings, interruption)).transpose()
}

/// Searches stripes with a period of at least `shortest_um`.
pub(super) fn read(
    window: &Window,
    shortest_um: f64,
    settings: &FibreSettings,
    interruption: &Interruption,
) -> Result<Stripes, Interrupted> {
    let mut spectra = Spectra::of(window, interruption)?;
    // The spectra are already means over their windows.
    let own_um = FRAC_1_SQRT_2 * WINDOW_UM;
    let around_um = (settings.smoothing_um.powi(2) - own_um.powi(2)).max(0.0).sqrt();
    let around = around_um / spectra.place.block_um;
    let size = spectra.wave_numbers.len() * ORIENTATIONS;
    let power = mean_around(&spectra.place.grid, &spectra.power, &spectra.weight, size, around);
    spectra.power = Vec::new();
    interruption.check()?;
    let comparison = Comparison::of(&spectra.wave_numbers, shortest_um);
    let contrasts: Vec<f32> =
        power.chunks_exact(size).flat_map(|power| comparison.contrasts(power)).collect();
    let cell = Cell { window, spectra, power, comparison, contrasts };
    let mut at = vec![Reading::default(); cell.spectra.weight.len()];
    let band = Band { shortest_um: shortest_um.max(SHORTEST_UM), longest_um: LONGEST_UM };
    let Some(common) = cell.common_wave_number() else {
        let readings = Readings { place: cell.spectra.place, at };
        return Ok(Stripes { readings, band, period_um: None, share: 0.0, power: 0.0 });
    };
    interruption.check()?;
    let evidence = cell.evidence(common);
    let directions = cell.continuous(&evidence);
    let peaks: Vec<Option<Peak>> = (0..at.len())
        .map(|place| cell.peak(place, directions[place], common))
        .map(|peak| peak.filter(|peak| peak.contrast >= LEAST_CONTRAST))
        .collect();
    interruption.check()?;
    let (seen, power) = cell.seen_at_the_place(&peaks);
    let (mut periods, mut shown) = (Vec::new(), 0.0);
    for (place, peak) in peaks.iter().enumerate() {
        let Some(peak) = peak.filter(|_| seen[place]) else { continue };
        let reading = cell.reading(place, peak);
        let Some(period) = reading.sarcomere_um else { continue };
        periods.push(period);
        shown += f64::from(cell.spectra.place.share[place]);
        // The centre of a peak at the end of the band may lie outside.
        if band.contains(f64::from(period)) {
            at[place] = reading;
        }
    }
    // Periods beyond the band are included; otherwise the median would be biased into it.
    let period_um = median(periods).map(f64::from);
    let all: f64 = cell.spectra.place.share.iter().map(|share| f64::from(*share)).sum();
    let share = if all > 0.0 { shown / all } else { 0.0 };
    let readings = Readings { place: cell.spectra.place, at };
    Ok(Stripes { readings, band, period_um, share, power })
}

/// A peak of a spectrum, by its nearest samples.
#[derive(Debug, Clone, Copy)]
struct Peak {
    /// Index in the list of wave numbers, and in the band.
    wave: usize,
    band: usize,
    direction: usize,
    contrast: f32,
}

/// Spectra of a cell, averaged over neighbours, with their contrasts.
struct Cell<'a> {
    window: &'a Window,
    spectra: Spectra,
    /// Power averaged over neighbours; order as in [`Spectra::power`].
    power: Vec<f32>,
    comparison: Comparison,
    /// Contrast of each place, wave number of the band, and direction.
    contrasts: Vec<f32>,
}

impl Cell<'_> {
    /// Contrasts of one place at one wave number of the band.
    fn ring(&self, place: usize, wave: usize) -> &[f32] {
        let at = place * self.comparison.band.len() + wave;
        &self.contrasts[at * ORIENTATIONS..][..ORIENTATIONS]
    }

    /// Logarithm of the ratio of a wave number of the band to another.
    fn off(&self, wave: usize, common: f64) -> f64 {
        (self.spectra.wave_numbers[self.comparison.band[wave].at] / common).ln()
    }

    /// The wave number that most places share, per um; `None` if too few do.
    fn common_wave_number(&self) -> Option<f64> {
        let share = &self.spectra.place.share;
        let mut best = Vec::new();
        for (place, &share) in share.iter().enumerate().filter(|(_, share)| **share > 0.0) {
            let waves = 0..self.comparison.band.len();
            let largest = waves
                .map(|wave| (wave, self.ring(place, wave).iter().copied().fold(0.0, f32::max)));
            if let Some((wave, contrast)) = largest.max_by(|a, b| a.1.total_cmp(&b.1)) {
                best.push((self.off(wave, 1.0), contrast, f64::from(share)));
            }
        }
        let votes = |middle: f64| -> f64 {
            let vote = |&(wave, contrast, share): &(f64, f32, f64)| {
                let weight = f64::from((contrast / SEEN_CONTRAST).max(1.0).ln());
                share * weight * (-0.5 * ((wave - middle) / (0.5 * SPREAD)).powi(2)).exp()
            };
            best.iter().map(vote).sum()
        };
        let [first, last] = [LONGEST_UM, SHORTEST_UM].map(|period| -period.ln());
        let steps = ((last - first) / 0.01) as usize;
        let candidates = (0..=steps).map(|step| first + 0.01 * step as f64);
        let common = candidates.max_by(|&a, &b| votes(a).total_cmp(&votes(b)))?;
        let area: f64 = best.iter().map(|(_, _, share)| share).sum();
        let enough = LEAST_SHARES.iter().any(|&(least, contrast)| {
            let agree = best
                .iter()
                .filter(|place| place.1 >= contrast && (place.0 - common).abs() <= WIDEST);
            let shares: Vec<f64> = agree.map(|(_, _, share)| *share).collect();
            shares.len() >= FEWEST_PLACES && shares.iter().sum::<f64>() >= least * area
        });
        enough.then(|| common.exp())
    }

    /// Evidence (logarithm of the contrast, at least 0) near the common wave number, for each place
    /// and direction.
    fn evidence(&self, common: f64) -> Vec<f32> {
        let places = 0..self.spectra.weight.len();
        places
            .flat_map(|place| {
                let mut most = [1.0_f32; ORIENTATIONS];
                for wave in 0..self.comparison.band.len() {
                    let nearness = nearness(self.off(wave, common));
                    for (most, contrast) in most.iter_mut().zip(self.ring(place, wave)) {
                        *most = most.max(nearness * contrast);
                    }
                }
                most.map(f32::ln)
            })
            .collect()
    }

    /// The direction with the most evidence at each place, after smoothing over neighbours.
    fn continuous(&self, evidence: &[f32]) -> Vec<usize> {
        let place = &self.spectra.place;
        let sigma = CONTINUITY_UM / place.block_um;
        let mut joined = evidence.to_vec();
        for _ in 0..ROUNDS {
            let weight = &self.spectra.weight;
            let mut around = mean_around(&place.grid, &joined, weight, ORIENTATIONS, sigma);
            for (at, ring) in around.chunks_exact_mut(ORIENTATIONS).enumerate() {
                turned(ring);
                let most = ring.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
                let own = &evidence[at * ORIENTATIONS..][..ORIENTATIONS];
                for (around, own) in ring.iter_mut().zip(own) {
                    *around *= own / most;
                }
            }
            joined = around;
        }
        let largest = |ring: &[f32]| {
            (0..ORIENTATIONS).max_by(|&a, &b| ring[a].total_cmp(&ring[b])).unwrap_or(0)
        };
        joined.chunks_exact(ORIENTATIONS).map(largest).collect()
    }

    /// The peak with the highest contrast in a direction, near the common wave number.
    fn peak(&self, place: usize, direction: usize, common: f64) -> Option<Peak> {
        let peak = |wave: usize| {
            let contrast = self.ring(place, wave)[direction];
            (nearness(self.off(wave, common)) * contrast, wave, contrast)
        };
        let largest = (0..self.comparison.band.len()).map(peak).max_by(|a, b| a.0.total_cmp(&b.0));
        largest.filter(|(likely, ..)| *likely > 0.0).map(|(_, wave, contrast)| Peak {
            wave: self.comparison.band[wave].at,
            band: wave,
            direction,
            contrast,
        })
    }

    /// Whether the wave of a peak is present at the place itself. Windows overlap, so a place
    /// without stripes shows the peak of its neighbours, but not their amplitude. Too near to the
    /// outline, the neighbours' results decide. Also returns the median power of the waves.
    fn seen_at_the_place(&self, peaks: &[Option<Peak>]) -> (Vec<bool>, f32) {
        let grid = &self.spectra.place.grid;
        let power: Vec<Option<f32>> = peaks
            .iter()
            .enumerate()
            .map(|(place, peak)| peak.and_then(|peak| self.power_at(place, peak)))
            .collect();
        let weight: Vec<f32> = (power.iter().zip(&self.spectra.weight))
            .map(|(power, weight)| if power.is_some() { *weight } else { 0.0 })
            .collect();
        let known: Vec<f32> = power.iter().map(|power| power.unwrap_or(0.0)).collect();
        let sigma = SURROUNDINGS_UM / self.spectra.place.block_um;
        let around = mean_around(grid, &known, &weight, 1, sigma);
        let least = LEAST_AMPLITUDE * LEAST_AMPLITUDE;
        let known: Vec<Option<bool>> = (power.iter().zip(&around))
            .map(|(power, around)| power.map(|own| own >= least * around))
            .collect();
        let [columns, rows] = grid.size;
        let beside = |place: usize| {
            let (row, column) = (place / columns, place % columns);
            let around = row.saturating_sub(1)..(row + 2).min(rows);
            around.into_iter().any(|row| {
                let line = &known[row * columns..][..columns];
                line[column.saturating_sub(1)..(column + 2).min(columns)].contains(&Some(true))
            })
        };
        let seen =
            (0..known.len()).map(|place| known[place].unwrap_or_else(|| beside(place))).collect();
        (seen, median(power.into_iter().flatten()).unwrap_or(0.0))
    }

    /// Power of a wave close around a place, without normalised contrast; `None` too near to the
    /// outline.
    fn power_at(&self, place: usize, peak: Peak) -> Option<f32> {
        let Window { size: [columns, rows], pixel_um, values, counted, .. } = self.window;
        let grid = &self.spectra.place.grid;
        let middle = [place % grid.size[0], place / grid.size[0]]
            .map(|block| (block as f64 + 0.5) * grid.block as f64 - 0.5);
        let reach = 3.0 * WAVE_UM / pixel_um;
        let (sin, cos) = angle(peak.direction as f64).sin_cos();
        let wave = std::f64::consts::TAU * self.spectra.wave_numbers[peak.wave] * pixel_um;
        let ends = |axis: usize, count: usize| {
            let first = (middle[axis] - reach).ceil().max(0.0) as usize;
            first..((middle[axis] + reach) as usize + 1).min(count)
        };
        let (mut real, mut imaginary, mut mass) = (0.0, 0.0, 0.0);
        for row in ends(1, *rows) {
            for column in ends(0, *columns) {
                let at = row * columns + column;
                if counted[at] {
                    let (x, y) = (column as f64 - middle[0], middle[1] - row as f64);
                    let square = (x * x + y * y) * (pixel_um / WAVE_UM).powi(2);
                    let weight = (-0.5 * square).exp();
                    let (sin, cos) = (wave * (cos * x + sin * y)).sin_cos();
                    mass += weight;
                    real += weight * cos * f64::from(values[at]);
                    imaginary += weight * sin * f64::from(values[at]);
                }
            }
        }
        let whole = std::f64::consts::TAU * (WAVE_UM / pixel_um).powi(2);
        // With less than a quarter of a Gaussian, a wave cannot be distinguished from an edge.
        (mass > 0.25 * whole)
            .then(|| ((real * real + imaginary * imaginary) / (mass * mass)) as f32)
    }

    /// Direction and period at the centre of a peak, and how clear they are.
    fn reading(&self, place: usize, peak: Peak) -> Reading {
        let waves = &self.spectra.wave_numbers;
        let size = waves.len() * ORIENTATIONS;
        let power = &self.power[place * size..][..size];
        let at = |wave: usize, direction: i32| {
            let direction = direction.rem_euclid(ORIENTATIONS.cast_signed() as i32) as usize;
            f64::from(power[wave * ORIENTATIONS + direction])
        };
        let background =
            at(peak.wave, peak.direction.cast_signed() as i32) / f64::from(peak.contrast);
        let mut direction = peak.direction as f64;
        for _ in 0..3 {
            let nearest = direction.round() as i32;
            let (mut sum, mut weights) = (0.0, 0.0);
            for turn in -3..=3 {
                let beside = peak.wave.saturating_sub(1)..=(peak.wave + 1).min(waves.len() - 1);
                let power: f64 = beside.map(|wave| at(wave, nearest + turn) - background).sum();
                // The window of samples moves with the nearest sample.
                sum += power.max(0.0) * f64::from(turn);
                weights += power.max(0.0);
            }
            if weights > 0.0 {
                direction = f64::from(nearest) + sum / weights;
            }
        }
        let nearest = direction.round() as i32;
        let across = |wave: usize| -> f64 {
            let turns = -1..=1;
            turns
                .map(|turn| at(wave, nearest + turn) - background)
                .sum::<f64>()
                .max(1e-3 * background)
        };
        let inner = 1..waves.len() - 1;
        let nearby = peak.wave.saturating_sub(2)..=peak.wave + 2;
        let wave = nearby
            .filter(|wave| inner.contains(wave))
            .max_by(|&a, &b| across(a).total_cmp(&across(b)))
            .unwrap_or(peak.wave);
        let wave_number = if inner.contains(&wave) {
            let points = [wave - 1, wave, wave + 1].map(|wave| (waves[wave], across(wave).ln()));
            vertex(points)
        } else {
            waves[wave]
        };
        // Contrast of the other directions at this wave number, relative to the smaller of two
        // references: their own spectral neighbours, and those of the peak. Where there is almost
        // no power, no direction has contrast.
        let mut ring = power[peak.wave * ORIENTATIONS..][..ORIENTATIONS].to_vec();
        turned(&mut ring);
        let beside = ring[peak.direction] / peak.contrast;
        let mut sum = [0.0; 3];
        for (turn, (power, contrast)) in ring.iter().zip(self.ring(place, peak.band)).enumerate() {
            let (sin, cos) = (2.0 * angle(turn as f64)).sin_cos();
            let excess = f64::from((power / beside).min(*contrast) - 1.0).max(0.0);
            sum = [sum[0] + excess * cos, sum[1] + excess * sin, sum[2] + excess];
        }
        let one_direction = if sum[2] > 0.0 { sum[0].hypot(sum[1]) / sum[2] } else { 0.0 };
        let one_period = 1.0 - f64::from(peak.contrast).recip();
        let (sin, cos) = (2.0 * angle(direction)).sin_cos();
        Reading {
            doubled: [cos as f32, sin as f32],
            part: 1.0,
            order: (one_direction * one_period) as f32,
            sarcomere_um: Some(wave_number.recip() as f32),
        }
    }
}

/// Angle of a direction in samples, radians.
fn angle(direction: f64) -> f64 {
    std::f64::consts::PI * direction / ORIENTATIONS as f64
}

/// Weight of a period by the logarithm of its ratio to the common one.
fn nearness(off: f64) -> f32 {
    if off.abs() > WIDEST { 0.0 } else { (-0.5 * (off / SPREAD).powi(2)).exp() as f32 }
}

/// The position of the maximum of a parabola through three points, limited to their range.
fn vertex([(a, fa), (b, fb), (c, fc)]: [(f64, f64); 3]) -> f64 {
    let (left, right) = ((fb - fa) / (b - a), (fc - fb) / (c - b));
    let bend = (right - left) / (c - a);
    // Slope midway between the first two points, extrapolated linearly to zero.
    if bend < 0.0 { (0.5 * (a + b) - 0.5 * left / bend).clamp(a, c) } else { b }
}

/// A wave number of the band with the shorter and longer waves it is compared with.
struct Compared {
    /// Index in the list of wave numbers.
    at: usize,
    longer: std::ops::Range<usize>,
    shorter: std::ops::Range<usize>,
}

/// The band of sarcomeres among all wave numbers.
struct Comparison {
    band: Vec<Compared>,
}

impl Comparison {
    fn of(wave_numbers: &[f64], shortest_um: f64) -> Self {
        let between = |[low, high]: [f64; 2]| {
            let first = wave_numbers.partition_point(|&wave| wave <= low);
            first..wave_numbers.partition_point(|&wave| wave < high)
        };
        let [first, last] = [LONGEST_UM, shortest_um.max(SHORTEST_UM)].map(f64::recip);
        // Half a step more at each end, against rounding.
        let half = RATIO.sqrt();
        let band = between([first / half, last * half]).map(|at| Compared {
            at,
            longer: between(LONGER.map(|part| part * wave_numbers[at])),
            shorter: between(SHORTER.map(|part| part * wave_numbers[at])),
        });
        // Wave numbers without shorter waves above the pixel size cannot be compared.
        Self { band: band.filter(|wave| wave.longer.len() > 1 && wave.shorter.len() > 1).collect() }
    }

    /// Contrast at each wave number of the band and direction.
    fn contrasts(&self, power: &[f32]) -> Vec<f32> {
        let mut power = power.to_vec();
        power.chunks_exact_mut(ORIENTATIONS).for_each(turned);
        let mut contrasts = Vec::with_capacity(self.band.len() * ORIENTATIONS);
        for wave in &self.band {
            for direction in 0..ORIENTATIONS {
                let at = |wave: usize| power[wave * ORIENTATIONS + direction];
                let mean = |waves: &std::ops::Range<usize>| {
                    waves.clone().map(at).sum::<f32>() / waves.len() as f32
                };
                let beside = (mean(&wave.longer) * mean(&wave.shorter)).sqrt();
                let contrast = at(wave.at) / beside;
                contrasts.push(if beside > f32::MIN_POSITIVE && contrast.is_finite() {
                    contrast
                } else {
                    0.0
                });
            }
        }
        contrasts
    }
}

/// A Gaussian of [`TURN`] over directions.
fn turned(ring: &mut [f32]) {
    let half = half_gaussian(f64::from(TURN), ORIENTATIONS / 2);
    let before: [f32; ORIENTATIONS] = std::array::from_fn(|at| ring[at]);
    for (at, out) in ring.iter_mut().enumerate() {
        *out = half[0] * before[at];
        for (turn, weight) in half.iter().enumerate().skip(1) {
            let [left, right] =
                [at + ORIENTATIONS - turn, at + turn].map(|turned| before[turned % ORIENTATIONS]);
            *out += weight * (left + right);
        }
    }
}

/// The weighted mean around each place, a Gaussian of `sigma` places, of `size` values a place.
fn mean_around(grid: &Grid, values: &[f32], weight: &[f32], size: usize, sigma: f64) -> Vec<f32> {
    let [columns, rows] = grid.size;
    let half = half_gaussian(sigma, columns.max(rows));
    let reach = half.len() - 1;
    let mut along = vec![0.0_f32; values.len()];
    let add = |sum: &mut [f32], values: &[f32], weight: f32| {
        if weight > 0.0 {
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += weight * value;
            }
        }
    };
    for (at, sum) in along.chunks_exact_mut(size).enumerate() {
        let (row, column) = (at / columns, at % columns);
        for other in column.saturating_sub(reach)..(column + reach + 1).min(columns) {
            let place = row * columns + other;
            add(sum, &values[place * size..][..size], weight[place] * half[column.abs_diff(other)]);
        }
    }
    let mut means = vec![0.0_f32; values.len()];
    for (at, sum) in means.chunks_exact_mut(size).enumerate() {
        let (row, column) = (at / columns, at % columns);
        for other in row.saturating_sub(reach)..(row + reach + 1).min(rows) {
            let place = other * columns + column;
            add(sum, &along[place * size..][..size], half[row.abs_diff(other)]);
        }
    }
    let mut weights = weight.to_vec();
    grid.blur(&mut weights, sigma);
    for (mean, weight) in means.chunks_exact_mut(size).zip(&weights) {
        let scale = if *weight > 1e-6 { weight.recip() } else { 0.0 };
        for mean in mean {
            *mean *= scale;
        }
    }
    means
}
