//! How much a noisy curve is smoothed.

use super::detect::{self, Found};
use super::noise::Noise;
use super::smooth::{slopes, smooth};
use crate::analysis::order::median;
use crate::analysis::trace;

/// Noise after smoothing, as a part of a beat's height.
const SMOOTH_TO: f64 = 0.005;

/// A smoothed curve.
pub(super) struct Smoothing {
    /// Its values.
    pub(super) values: Vec<f64>,
    /// Half-width of their window, frames.
    pub(super) half: usize,
    /// Slopes of the raw curve; `None` uses those between neighbours of `values`.
    pub(super) slopes: Option<Vec<f64>>,
    /// Half-width of the lines of the slopes, frames.
    half_of_slopes: usize,
}

impl Smoothing {
    /// Smooths a curve as far as its noise and its beats ask for; `given_ms` is half of a window that the
    /// user chose.
    pub(super) fn of(
        times: &[f64],
        signal: &[f64],
        found: &Found,
        noise: Noise,
        given_ms: Option<f64>,
    ) -> Self {
        let half = half_window(times, signal, found, noise, given_ms);
        let half_of_slopes = half_of_slopes(times, signal, found, noise, given_ms);
        let slopes = (half_of_slopes > 0).then(|| slopes(times, signal, half_of_slopes));
        Self { values: smooth(times, signal, half), half, slopes, half_of_slopes }
    }

    /// Half of the widest window, frames.
    pub(super) fn widest(&self) -> usize {
        self.half.max(self.half_of_slopes)
    }

    /// What was done to the values, in words, for frames `step` ms apart.
    pub(super) fn words(&self, step: f64) -> String {
        match self.half {
            0 => "none".to_owned(),
            half => format!("local parabolas over {}", window(half, step)),
        }
    }

    /// How slopes were read, in words, for frames `step` ms apart.
    pub(super) fn words_of_slopes(&self, step: f64) -> String {
        match self.half_of_slopes {
            0 => "slopes between frames".to_owned(),
            half => format!("slopes of lines over {}", window(half, step)),
        }
    }
}

fn window(half: usize, step: f64) -> String {
    format!("{} frames, {:.1} ms", 2 * half + 1, 2.0 * half as f64 * step)
}

/// Median time between frames, ms.
pub(super) fn median_step(times: &[f64]) -> f64 {
    median(times.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(1.0)
}

/// Number of samples to each side in the smoothing window.
fn half_window(
    times: &[f64],
    signal: &[f64],
    found: &Found,
    noise: Noise,
    given_ms: Option<f64>,
) -> usize {
    let step = median_step(times);
    if let Some(half_ms) = given_ms {
        return (half_ms / step).round().max(0.0) as usize;
    }
    if noise.sd <= SMOOTH_TO * found.usual {
        return 0;
    }
    let rough = smooth(times, signal, found.half);
    let widths = found.peaks.iter().map(|peak| detect::width_at_half(times, &rough, peak));
    let width = median(widths).unwrap_or(0.0);
    // 3/2 / sqrt((2 half + 1) / memory) sd = SMOOTH_TO usual
    let wanted = (noise.memory * (1.5 * noise.sd / (SMOOTH_TO * found.usual)).powi(2) - 1.0) / 2.0;
    wanted.min(width / 8.0 / step).round().max(0.0) as usize
}

/// Number of samples to each side in the lines whose slopes are the rates: enough to reduce their
/// noise to a fiftieth of the usual rise's slope, over at most half of that rise.
fn half_of_slopes(
    times: &[f64],
    signal: &[f64],
    found: &Found,
    noise: Noise,
    given_ms: Option<f64>,
) -> usize {
    if noise.sd <= SMOOTH_TO * SMOOTH_TO * found.usual || given_ms == Some(0.0) {
        return 0;
    }
    let rough = smooth(times, signal, found.half);
    let rises = found.peaks.iter().filter_map(|peak| {
        let top = rough[peak.at];
        let crossing = |part: f64| {
            let level = top - (1.0 - part) * peak.prominence;
            trace::last_rise_through(times, &rough, level, times[0], times[peak.at])
        };
        Some(crossing(0.9)? - crossing(0.1)?)
    });
    let Some(rise) = median(rises) else { return 0 };
    let step = median_step(times);
    let slope = 0.8 * found.usual / rise.max(step);
    // sd sqrt(12 memory / frames^3) / step = slope / 50
    let wanted = (12.0 * noise.memory * (50.0 * noise.sd / (slope * step)).powi(2)).cbrt();
    let frames = wanted.min(0.5 * rise / step);
    ((frames - 1.0) / 2.0).round().max(0.0) as usize
}
