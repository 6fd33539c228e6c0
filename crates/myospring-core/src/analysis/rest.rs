//! The resting value before a stimulus, with one definition for runs and measured curves.
//!
//! It is the mean of the samples in the last 20 ms before the stimulus, at least three of them. In
//! a noisy curve the time is longer, until the noise of the mean is a five-hundredth of a beat, but
//! at most 15 % of the previous cycle. In a curve without stimuli, whose onsets are less precise,
//! it is always the last 15 % of the cycle before the onset.

use std::ops::Range;

/// Time before a stimulus over which the rest is averaged without noise, ms.
const QUIET_MS: f64 = 20.0;

/// Largest part of the previous cycle over which the rest is averaged.
pub const PART: f64 = 0.15;

/// Least number of samples of a rest, if there are as many before the beat.
const LEAST_SAMPLES: usize = 3;

/// The definition in words, for any quantity.
pub const BEFORE_STIMULUS: &str =
    "mean over 20 ms before the stimulus, longer in noise (at most 15 % of the cycle)";

/// The definition for the beat of an extra stimulus, S2.
pub const BEFORE_S1: &str = "mean over 20 ms before the last S1";

/// The definition for a measured curve without stimuli.
pub const BEFORE_ONSET: &str = "mean over the last 15 % of the cycle before the beat's onset";

/// Time before a stimulus over which the rest is averaged, ms, after a cycle of this length, ms;
/// `noise_ms` is the averaging time that the noise needs, 0 without noise.
fn span_ms(cycle_ms: f64, noise_ms: f64) -> f64 {
    QUIET_MS.max(noise_ms).min(PART * cycle_ms.max(0.0))
}

/// The samples whose mean is the resting value before the stimulus with index `at`; if there are
/// none before it, the first sample from the stimulus on. `None` without any sample. The cycle is
/// the time since the previous stimulus; for the first stimulus the median cycle, for a single one
/// the time from it to the end. `noise_ms` is the averaging time that the noise needs, 0 without
/// noise.
///
/// # Example
/// ```
/// use myospring::analysis::rest;
/// let times: Vec<f64> = (0..2000).map(f64::from).collect();
/// assert_eq!(rest::before(&times, &[200.0, 1200.0], 1, 0.0), Some(1180..1200));
/// // In noise that needs 300 ms: 15 % of 1000 ms.
/// assert_eq!(rest::before(&times, &[200.0, 1200.0], 1, 300.0), Some(1050..1200));
/// assert_eq!(rest::before(&times, &[0.0, 1000.0], 0, 0.0), Some(0..1));
/// ```
pub fn before(
    times: &[f64],
    stimuli_ms: &[f64],
    place: usize,
    noise_ms: f64,
) -> Option<Range<usize>> {
    let stimulus_ms = *stimuli_ms.get(place)?;
    let to_end = || times.last().map_or(0.0, |last| last - stimulus_ms);
    let cycle = match place.checked_sub(1) {
        Some(before) => stimulus_ms - stimuli_ms[before],
        None => usual_cycle(stimuli_ms).unwrap_or_else(to_end),
    };
    let at = |time_ms: f64| times.partition_point(|time| *time < time_ms);
    let end = at(stimulus_ms);
    if end == 0 {
        return (!times.is_empty()).then_some(0..1);
    }
    let start = at(stimulus_ms - span_ms(cycle, noise_ms)).min(end.saturating_sub(LEAST_SAMPLES));
    Some(start..end)
}

/// The median distance between neighbours.
fn usual_cycle(stimuli_ms: &[f64]) -> Option<f64> {
    let mut cycles: Vec<f64> = stimuli_ms.windows(2).map(|pair| pair[1] - pair[0]).collect();
    cycles.sort_by(f64::total_cmp);
    cycles.get(cycles.len() / 2).copied()
}
