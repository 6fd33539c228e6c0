//! Noise, bad frames and mains hum of a curve.

use super::super::order;
use std::f64::consts::TAU;

/// The median, 0 of no values.
pub(super) fn median(list: Vec<f64>) -> f64 {
    order::median(list).unwrap_or(0.0)
}

/// Weights of the fourth difference, and the root of the sum of their squares. It vanishes for
/// curves that are smooth over five samples, but not for noise.
const FOURTH: [f64; 5] = [1.0, -4.0, 6.0, -4.0, 1.0];
const FOURTH_GAIN: f64 = 8.366_600_265_340_756;

/// From this number of differences on, a quarter of them is enough to estimate the noise.
const MANY: usize = 200;

/// If the noise estimated from steps between frames is less than this part of that from fourth
/// differences, artefacts dominate the latter.
const CROWDED: f64 = 0.6;

/// Least distance of a bad frame from the extrapolation of its neighbours, in standard deviations
/// of the noise.
const BAD_FRAME_NOISE: f64 = 6.5;

/// The same as a part of a beat's height.
const BAD_FRAME_RANGE: f64 = 0.1;

/// Least ratio of a mains line to its spectral neighbourhood.
const HUM_CONTRAST: f64 = 4.0;

/// Least number of independent differences for a lag.
const APART: usize = 8;

/// The noise of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Noise {
    /// Standard deviation.
    pub(super) sd: f64,
    /// Its correlation time, frames; 1 for white noise.
    pub(super) memory: f64,
    /// Standard deviation of white noise with the same differences from frame to frame.
    pub(super) rough: f64,
}

impl Noise {
    /// Estimates the noise of a curve from its fourth differences at doubling lags. Differences of
    /// noise grow at most by the root of 2 (a random walk), and less the more the lag exceeds the
    /// memory; those of curved beats grow faster and faster, up to 16-fold. So lags are used until
    /// the growth increases.
    pub(super) fn of(values: &[f64]) -> Self {
        Self::up_to(usize::MAX, values)
    }

    /// Like `of`, with a largest memory in frames.
    pub(super) fn up_to(longest: usize, values: &[f64]) -> Self {
        let rough = level(values);
        let rough = by_steps(values).filter(|steps| *steps < CROWDED * rough).unwrap_or(rough);
        // At least a quarter of the frames is at rest.
        let quarter = |lag: usize| {
            let mut sizes = differences(values, lag);
            sizes.sort_by(f64::total_cmp);
            sizes.get(sizes.len() / 4).copied().unwrap_or(0.0)
        };
        let first = quarter(1);
        let mut seen = vec![(1, rough)];
        let (mut lag, mut most) = (2, std::f64::consts::SQRT_2);
        while lag <= longest && lag * 4 * APART <= values.len() {
            let here = rough * quarter(lag) / first;
            let growth = here / seen.last().map_or(rough, |(_, before)| *before);
            let chance = 1.05 + (lag as f64 / values.len() as f64).sqrt();
            if growth.is_nan() || growth > most * chance {
                break;
            }
            most = most.min(growth.max(1.0));
            seen.push((lag, here));
            lag *= 2;
        }
        let sd = seen.iter().map(|(_, level)| *level).fold(0.0, f64::max);
        // An increase by a quarter may be chance.
        if sd <= 1.25 * rough {
            return Self { sd: rough, memory: 1.0, rough };
        }
        let memory = seen.iter().find(|(_, level)| *level >= 0.8 * sd).map_or(1, |(lag, _)| *lag);
        Self { sd, memory: memory as f64, rough }
    }

    /// Number of independent samples among `frames` frames after filtering with a window.
    pub(super) fn samples(&self, frames: usize, window: usize) -> f64 {
        (frames as f64 / self.memory.max(window as f64)).max(2.0)
    }

    /// Its standard deviation after smoothing by local parabolas over `half` frames to each side:
    /// at the centre of a parabola, a factor of 3/2 over the root of the number of independent
    /// frames.
    pub(super) fn behind(&self, half: usize) -> f64 {
        let frames = (2 * half + 1) as f64;
        let gain = if half == 0 { 1.0 } else { (1.5 / (frames / self.memory).sqrt()).min(1.0) };
        gain * self.sd
    }
}

/// Range of this number of noise samples, in standard deviations, that is exceeded in one of a
/// hundred recordings, and in one of ten thousand.
pub(super) fn reach(samples: f64) -> [f64; 2] {
    // Each end lies beyond sqrt(2 ln n) + y with the probability exp(-y sqrt(2 ln n)) (Gumbel), both together with
    // (1 + z) exp(-z). The ends of a few hundred normal deviates lie 0.3 lower each.
    let end = (2.0 * samples.max(2.0).ln()).sqrt();
    [6.6, 11.8].map(|z| 2.0 * end - 0.6 + z / end)
}

/// The standard deviation of white noise, from the median of the curve's fourth differences.
pub(super) fn level(values: &[f64]) -> f64 {
    let mut sizes = differences(values, 1);
    if sizes.is_empty() {
        return 0.0;
    }
    sizes.sort_by(f64::total_cmp);
    let part = |part: f64| sizes[((sizes.len() - 1) as f64 * part) as usize] / FOURTH_GAIN;
    let middle = part(0.5) / 0.6745;
    // In short recordings, beats bend the curve in more than half of the frames.
    let lower = part(0.25) / 0.3186;
    // In a curve in whole pixels, most differences may be 0.
    let rounding = 1e-12 * range(values, 0.0);
    if lower > rounding && lower < 0.6 * middle && sizes.len() >= MANY {
        lower
    } else if middle > rounding {
        middle
    } else {
        part(0.9) / 1.645
    }
}

/// The standard deviation of white noise and of the slopes of the quietest quarter of a curve, from
/// the steps between frames. An artefact disturbs two steps, but five fourth differences. `None` if
/// a quarter of the steps is 0, as in whole pixels.
fn by_steps(values: &[f64]) -> Option<f64> {
    let mut steps: Vec<f64> = values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).collect();
    steps.sort_by(f64::total_cmp);
    let lower = steps.get(steps.len() / 4)? / (0.3186 * std::f64::consts::SQRT_2);
    (lower > 1e-12 * range(values, 0.0)).then_some(lower)
}

/// The sizes of fourth differences between frames that lie a number of frames apart.
pub(super) fn differences(values: &[f64], lag: usize) -> Vec<f64> {
    let five = |at: usize| std::array::from_fn::<f64, 5, _>(|step| values[at + step * lag]);
    let held = |five: &[f64; 5]| five.iter().all(|value| *value == five[0]);
    let of = |five: [f64; 5]| {
        five.iter().zip(FOURTH).map(|(value, weight)| value * weight).sum::<f64>().abs()
    };
    let places = || (0..values.len().saturating_sub(4 * lag)).map(five);
    // Constant values of an instrument that lost the cell contain no noise and are left out.
    let frozen = places().filter(held).count();
    let all = 2 * frozen >= values.len();
    places().filter(|five| all || !held(five)).map(of).collect()
}

/// Distance between the lower and the upper quantile.
pub(super) fn range(values: &[f64], part: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let last = sorted.len().saturating_sub(1) as f64;
    let at = |part: f64| sorted.get((last * part).round() as usize).copied().unwrap_or(0.0);
    at(1.0 - part) - at(part)
}

/// Single frames far from the extrapolation of both sides, and from both neighbours, which agree.
pub(super) fn bad_frames(values: &[f64], noise: f64, height: f64) -> Vec<usize> {
    let least = (BAD_FRAME_NOISE * noise).max(BAD_FRAME_RANGE * height);
    let last = values.len().saturating_sub(1);
    (1..last)
        .filter(|&i| {
            let (before, here, after) = (values[i - 1], values[i], values[i + 1]);
            let left = if i > 1 { 2.0 * before - values[i - 2] } else { before };
            let right = if i + 1 < last { 2.0 * after - values[i + 2] } else { after };
            let ends = [before, after, left, right];
            let low = ends.iter().copied().fold(f64::INFINITY, f64::min);
            let high = ends.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let outside = (here - high).max(low - here);
            outside > least && (after - before).abs() < 0.5 * outside
        })
        .collect()
}

/// Mains hum: its frequency (Hz), amplitude, and values over time.
pub(super) struct Hum {
    pub(super) frequency_hz: f64,
    pub(super) amplitude: f64,
    pub(super) wave: Vec<f64>,
}

/// A curve demodulated at a frequency and summed over quarters of a second, so that nearby
/// frequencies are cheap to test.
struct Slow {
    sums: Vec<[f64; 2]>,
}

impl Slow {
    const BIN_S: f64 = 0.25;

    fn of(places: &[f64], values: &[f64], frequency: f64) -> Self {
        let bins = places.last().map_or(0, |last| (last / Self::BIN_S) as usize + 1);
        let mut sums = vec![[0.0; 2]; bins];
        for (place, value) in places.iter().zip(values) {
            let (sine, cosine) = (TAU * frequency * place).sin_cos();
            let sum = &mut sums[(place / Self::BIN_S) as usize];
            sum[0] += value * cosine;
            sum[1] -= value * sine;
        }
        Self { sums }
    }

    /// Relative amplitude at a frequency higher by `higher`.
    fn size(&self, higher: f64) -> f64 {
        let (sine, cosine) = (TAU * higher * Self::BIN_S).sin_cos();
        let (mut turn, mut total) = ([1.0, 0.0], [0.0; 2]);
        for [x, y] in &self.sums {
            total[0] += x * turn[0] + y * turn[1];
            total[1] += y * turn[0] - x * turn[1];
            turn = [turn[0] * cosine - turn[1] * sine, turn[0] * sine + turn[1] * cosine];
        }
        total[0].hypot(total[1])
    }
}

/// Hum of 50 or 60 Hz, if there is a line above its spectral neighbourhood.
pub(super) fn hum(times: &[f64], values: &[f64]) -> Option<Hum> {
    let span_s = (times.last()? - times.first()?) * 1e-3;
    let rate = (times.len() - 1) as f64 / span_s;
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    // Lines 4 Hz apart must be resolved; the window makes lines four periods of the recording wide.
    if span_s < 1.0 {
        return None;
    }
    let places: Vec<f64> = times.iter().map(|time| (time - times[0]) * 1e-3).collect();
    let windowed: Vec<f64> = places
        .iter()
        .zip(values)
        .map(|(place, value)| (value - mean) * (1.0 - (TAU * place / span_s).cos()))
        .collect();
    let scale = 2.0 / times.len() as f64;
    let component = |frequency: f64| {
        let (mut cosine, mut sine) = (0.0, 0.0);
        for (place, value) in places.iter().zip(&windowed) {
            let (s, c) = (TAU * frequency * place).sin_cos();
            cosine += value * c;
            sine += value * s;
        }
        [scale * cosine, scale * sine]
    };
    let size = |frequency: f64| component(frequency).iter().map(|c| c * c).sum::<f64>().sqrt();
    [50.0, 60.0].into_iter().find_map(|mains| {
        if rate < 2.2 * mains {
            return None;
        }
        // The mains frequency varies by less than 0.2 Hz.
        let step = 0.125 / span_s;
        let steps = (0.2 / step).ceil() as i32;
        let near = (-steps..=steps).map(|i| mains + f64::from(i) * step);
        let slow = Slow::of(&places, &windowed, mains);
        let (frequency, _) = near
            .map(|frequency| (frequency, slow.size(frequency - mains)))
            .reduce(|best, other| if other.1 > best.1 { other } else { best })?;
        let amplitude = size(frequency);
        let beside = (-5..=5)
            .filter(|i: &i32| i.abs() > 1)
            .map(|i| size(mains + 2.0 * f64::from(i)))
            .fold(0.0, f64::max);
        if amplitude <= HUM_CONTRAST * beside || amplitude <= 0.0 {
            return None;
        }
        let [cosine, sine] = component(frequency);
        let wave = times.iter().map(|time| {
            let phase = TAU * frequency * (time - times[0]) * 1e-3;
            cosine * phase.cos() + sine * phase.sin()
        });
        Some(Hum { frequency_hz: frequency, amplitude, wave: wave.collect() })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::noise::Noise;

    #[test]
    fn noise_is_told_from_beats_and_from_nothing() {
        let beat = |i: usize| (std::f64::consts::PI * (i % 250) as f64 / 60.0).sin().max(0.0);
        let mut noise = Noise::new(7);
        let clean: Vec<f64> = (0..2000).map(|i| if i % 250 < 60 { beat(i) } else { 0.0 }).collect();
        assert!(level(&clean) < 1e-4, "{}", level(&clean));
        for sigma in [0.01, 0.1, 1.0] {
            let noisy: Vec<f64> =
                clean.iter().map(|value| value + sigma * noise.normal()).collect();
            let ratio = level(&noisy) / sigma;
            assert!((ratio - 1.0).abs() < 0.1, "{sigma}: {ratio}");
        }
    }

    #[test]
    fn a_stretch_that_is_held_hides_no_noise() {
        let mut noise = Noise::new(3);
        let alone: Vec<f64> = (0..1000).map(|_| noise.normal()).collect();
        for held in [10, 100, 200, 450, 900] {
            let mut values = vec![0.3; held];
            values.extend(&alone);
            let ratio = level(&values) / level(&alone);
            assert!((ratio - 1.0).abs() < 0.01, "{held}: {ratio}");
        }
    }

    #[test]
    fn bad_frames_are_single_frames_and_no_peaks_or_upstrokes() {
        let triangle: Vec<f64> =
            (0..100).map(|i| f64::from(20 - (i % 50 - 25_i32).abs()).max(0.0)).collect();
        assert!(bad_frames(&triangle, 0.0, 20.0).is_empty());
        let upstroke: Vec<f64> = (0..60)
            .map(|i| match i {
                0..20 => -80.0,
                20 => 40.0,
                _ => 20.0 - f64::from(i - 20) * 2.0,
            })
            .collect();
        assert!(bad_frames(&upstroke, 0.0, 120.0).is_empty());
        let mut bad = triangle.clone();
        bad[10] += 9.0;
        bad[60] -= 12.0;
        assert_eq!(bad_frames(&bad, 0.0, 20.0), [10, 60]);
    }

    #[test]
    fn hum_is_found_and_harmonics_of_beats_are_not() {
        let times: Vec<f64> = (0..5000).map(|i| f64::from(i) * 2.0).collect();
        // A beat a second has a harmonic at 50 Hz, too.
        let beats: Vec<f64> = times
            .iter()
            .map(|t| {
                let t = t % 1000.0;
                (t / 100.0).min((300.0 - t) / 200.0).max(0.0)
            })
            .collect();
        assert!(hum(&times, &beats).is_none());
        let wave = |t: &f64| 0.05 * (std::f64::consts::TAU * 50.03e-3 * t + 0.4).sin();
        let humming: Vec<f64> = times.iter().zip(&beats).map(|(t, b)| b + wave(t)).collect();
        let found = hum(&times, &humming).unwrap();
        assert!((found.frequency_hz - 50.03).abs() < 0.02, "{}", found.frequency_hz);
        assert!((found.amplitude - 0.05).abs() < 0.002, "{}", found.amplitude);
    }
}
