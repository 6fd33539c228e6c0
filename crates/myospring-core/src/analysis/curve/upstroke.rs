//! The largest slope of an action potential's upstroke, read over a window chosen by its steepness.

use crate::analysis::trace::Point;

/// Width of the window, as a part of the time that the whole upstroke would take at its largest
/// slope: in little noise, and at most. A cubic over half of that time reads the slope of a
/// logistic upstroke 0.2 % low, over 0.7 of it 0.8 %.
const PART: [f64; 2] = [0.25, 0.7];

/// Relative noise of the slope above which a wider window is used.
const NOISE: f64 = 0.01;

/// Ratio of successive window widths.
const NARROWER: f64 = 0.85;

/// Samples that a cubic needs.
const LEAST: usize = 4;

/// Variance of the slope of a least-squares cubic at the centre of `n` samples, and of a line: this
/// number divided by `n^3`, in units of the variance of white noise divided by the squared time
/// between samples (Savitzky and Golay 1964, for large `n`).
const VARIANCE: f64 = 75.0;
const LINE: f64 = 12.0;

/// Largest of thousands of slopes of noise, in standard deviations.
const BEYOND: f64 = 4.0;

/// The steepest point of an upstroke.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Upstroke {
    /// Its time, and the slope there per ms.
    pub(super) at: Point,
    /// Time over which the slope was read, ms.
    pub(super) window_ms: f64,
    /// Whether the samples are dense enough; if not, the slope is that between two samples, and the
    /// true one is larger.
    pub(super) resolved: bool,
}

/// The steepest point of samples that rise by `height`, with white noise of this standard
/// deviation; `None` for fewer than two samples, a height that is not above 0, or samples that do
/// not rise.
pub(super) fn steepest(times: &[f64], values: &[f64], height: f64, noise: f64) -> Option<Upstroke> {
    if height.is_nan() || height <= 0.0 {
        return None;
    }
    let lines = Lines::of(times, values);
    let mut ladder = vec![times.len()];
    while let Some(&count) = ladder.last().filter(|count| **count > LEAST) {
        ladder.push(((count as f64 * NARROWER) as usize).clamp(LEAST, count - 1));
    }
    let step = (times.last()? - times.first()?) / (times.len() as f64 - 1.0);
    // Wide windows flatten the upstroke and narrow ones show noise: the largest slope beyond the
    // noise of its window gives the time that the whole upstroke would take.
    let sure = ladder.iter().copied().chain([2]).filter_map(|count| {
        let (_, slope) = lines.steepest(count)?;
        Some(slope - BEYOND * noise / step * (LINE / (count as f64).powi(3)).sqrt())
    });
    let sure = sure.fold(0.0, f64::max);
    if sure > 0.0 {
        let whole = height / sure / step;
        let quiet = (VARIANCE * (noise / (NOISE * sure * step)).powi(2)).cbrt();
        let wanted = quiet.clamp(PART[0] * whole, PART[1] * whole);
        let fits = |count: &&usize| **count as f64 - 1.0 <= wanted;
        // The narrowest possible window may be wider than desired, up to a limit.
        let narrowest = LEAST as f64 - 1.0 <= PART[1] * whole && times.len() >= LEAST;
        let count = ladder.iter().find(fits).copied().or(narrowest.then_some(LEAST));
        if let Some(count) = count.filter(|count| *count >= LEAST) {
            let (first, _) = lines.steepest(count)?;
            let last = first + count;
            let at = cubic(&times[first..last], &values[first..last])?;
            let window_ms = times[last - 1] - times[first];
            return Some(Upstroke { at, window_ms, resolved: true });
        }
    }
    let (first, slope) = lines.steepest(2)?;
    let time = 0.5 * (times[first] + times[first + 1]);
    let window_ms = times[first + 1] - times[first];
    (slope > 0.0).then_some(Upstroke {
        at: Point { time, value: slope },
        window_ms,
        resolved: false,
    })
}

/// Running sums, from which the least-squares line over any samples follows.
struct Lines {
    /// Sums of time, value, time squared and time times value up to each sample.
    sums: Vec<[f64; 4]>,
}

impl Lines {
    fn of(times: &[f64], values: &[f64]) -> Self {
        // Relative to the middle, to keep precision.
        let middle = times.len() / 2;
        let (origin, level) = match (times.get(middle), values.get(middle)) {
            (Some(time), Some(value)) => (*time, *value),
            _ => (0.0, 0.0),
        };
        let mut sum = [0.0; 4];
        let mut sums = vec![sum];
        for (time, value) in times.iter().zip(values) {
            let (t, v) = (time - origin, value - level);
            for (sum, term) in sum.iter_mut().zip([t, v, t * t, t * v]) {
                *sum += term;
            }
            sums.push(sum);
        }
        Self { sums }
    }

    /// The first of `count` samples whose line is steepest upward, and its slope.
    fn steepest(&self, count: usize) -> Option<(usize, f64)> {
        let n = count as f64;
        let slope = |first: usize| {
            let [from, to] = [self.sums[first], self.sums[first + count]];
            let [t, v, tt, tv] = [0, 1, 2, 3].map(|term| to[term] - from[term]);
            (n * tv - t * v) / (n * tt - t * t)
        };
        let firsts = 0..(self.sums.len()).checked_sub(count)?;
        let slopes = firsts.map(|first| (first, slope(first)));
        slopes
            .filter(|(_, slope)| slope.is_finite())
            .reduce(|best, other| if other.1 > best.1 { other } else { best })
    }
}

/// The steepest point of the least-squares cubic, in the middle half of its samples.
fn cubic(times: &[f64], values: &[f64]) -> Option<Point> {
    let (first, last) = (times.first()?, times.last()?);
    let (middle, half) = (0.5 * (first + last), 0.5 * (last - first));
    let level = values[values.len() / 2];
    let mut rows = [[0.0; 5]; 4];
    for (time, value) in times.iter().zip(values) {
        let x = (time - middle) / half;
        let powers = [1.0, x, x * x, x * x * x];
        for (row, power) in rows.iter_mut().zip(powers) {
            for (term, other) in row.iter_mut().zip(powers) {
                *term += power * other;
            }
            row[4] += power * (value - level);
        }
    }
    // Gaussian elimination; the matrix is positive definite.
    for pivot in 0..4 {
        let row = rows[pivot];
        for other in &mut rows[pivot + 1..] {
            let factor = other[pivot] / row[pivot];
            for (term, above) in other.iter_mut().zip(row) {
                *term -= factor * above;
            }
        }
    }
    let mut terms = [0.0; 4];
    for at in (0..4).rev() {
        let known: f64 = (at + 1..4).map(|other| rows[at][other] * terms[other]).sum();
        terms[at] = (rows[at][4] - known) / rows[at][at];
    }
    let [_, a, b, c] = terms;
    // a + 2 b x + 3 c x^2
    let slope = |x: f64| a + 2.0 * b * x + 3.0 * c * x * x;
    let top = if c < 0.0 { (-b / (3.0 * c)).clamp(-0.5, 0.5) } else { 0.0 };
    let value = slope(top) / half;
    value.is_finite().then_some(Point { time: middle + half * top, value })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::noise::Noise;

    /// Logistic upstrokes of 100 mV from 0 mV: `10 % to 90 %` takes `time`, so the largest slope is 100 ln(81) / (4 time).
    fn upstroke(rate_khz: f64, time: f64, noise: f64, seed: u64) -> (Vec<f64>, Vec<f64>, f64) {
        let tau = time / 81.0_f64.ln();
        // Its middle lies anywhere between two samples.
        let middle = 4.0 * time + 10.0 + 0.37 / rate_khz;
        let count = ((2.0 * middle) * rate_khz) as usize;
        let times: Vec<f64> = (0..count).map(|i| i as f64 / rate_khz).collect();
        let mut random = Noise::new(seed);
        let value = |t: &f64| 100.0 / (1.0 + (-(t - middle) / tau).exp()) + noise * random.normal();
        let values = times.iter().map(value).collect();
        (times, values, 25.0 / tau)
    }

    #[test]
    fn known_slopes_are_read_over_a_grid_of_rates_upstrokes_and_noise() {
        let mut seed = 0;
        for rate_khz in [1.0, 2.0, 5.0, 10.0, 25.0, 50.0] {
            for time in [0.3, 1.0, 3.0, 10.0, 30.0] {
                for noise in [0.0, 0.1, 0.5, 1.0] {
                    seed += 1;
                    let (times, values, slope) = upstroke(rate_khz, time, noise, seed);
                    let found = steepest(&times, &values, 100.0, noise).unwrap();
                    let error = found.at.value / slope - 1.0;
                    let place = format!(
                        "{rate_khz} kHz, {time} ms, noise {noise} mV: {} of {slope}, window {} ms",
                        found.at.value, found.window_ms
                    );
                    // The whole potential at its largest slope takes `100 / slope`.
                    let frames = 100.0 / slope * rate_khz;
                    if !found.resolved {
                        assert!(frames < 5.0, "{place}");
                        // Two samples never tell too much, but for their noise.
                        let noise = 4.0 * noise * 2.0_f64.sqrt() * rate_khz / slope;
                        assert!(error < noise + 1e-9, "{place}");
                        continue;
                    }
                    // Noise that is set aside makes an upstroke seem slower, but the window never leaves it.
                    assert!(found.window_ms <= 100.0 / slope, "{place}");
                    // 2 % for the shape, and four standard deviations of the noise.
                    let n = found.window_ms * rate_khz + 1.0;
                    let spread = noise * rate_khz * (VARIANCE / n.powi(3)).sqrt() / slope;
                    assert!(error.abs() < 0.02 + 4.0 * spread, "{place}");
                }
            }
        }
    }

    #[test]
    fn a_slow_foot_does_not_widen_the_window() {
        // 40 mV in 200 ms, then 60 mV in 2 ms.
        let times: Vec<f64> = (0..3000).map(|i| 0.1 * f64::from(i)).collect();
        let value = |t: &f64| (t / 5.0).min(40.0) + (30.0 * (t - 200.0)).clamp(0.0, 60.0);
        let values: Vec<f64> = times.iter().map(value).collect();
        let found = steepest(&times, &values, 100.0, 0.0).unwrap();
        assert!((found.at.value - 30.0).abs() < 1e-6, "{found:?}");
        assert!((found.at.time - 201.0).abs() < 1.0 && found.window_ms < 1.0, "{found:?}");
    }

    #[test]
    fn an_upstroke_at_the_end_of_a_long_rest_is_read_as_one_alone() {
        // 500 ms of rest, then 100 mV in 2 ms, with which the samples end.
        let times: Vec<f64> = (0..5021).map(|i| 0.1 * f64::from(i)).collect();
        for noise in [0.0, 0.2] {
            let mut random = Noise::new(3);
            let value = |t: &f64| (50.0 * (t - 500.0)).clamp(0.0, 100.0) + noise * random.normal();
            let values: Vec<f64> = times.iter().map(value).collect();
            let found = steepest(&times, &values, 100.0, noise).unwrap();
            assert!((found.at.value / 50.0 - 1.0).abs() < 0.03, "{found:?}");
            assert!(found.resolved && found.window_ms < 1.5, "{found:?}");
        }
    }

    #[test]
    fn an_upstroke_between_two_samples_is_said_not_to_be_resolved() {
        let times: Vec<f64> = (0..20).map(f64::from).collect();
        let values: Vec<f64> = times.iter().map(|t| if *t < 9.5 { 0.0 } else { 100.0 }).collect();
        let found = steepest(&times, &values, 100.0, 0.0).unwrap();
        assert_eq!((found.resolved, found.at.value, found.at.time), (false, 100.0, 9.5));
        assert_eq!(steepest(&times[..1], &values[..1], 100.0, 0.0), None);
        // A peak that lies below its rest.
        assert_eq!(steepest(&times, &values, -10.0, 0.0), None);
        assert_eq!(steepest(&times[..8], &values[..8], 100.0, 0.0), None);
    }
}
