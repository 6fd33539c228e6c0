//! Detects beats: pulses above the curve's noise.

use super::noise::{self, Noise};
use super::smooth::smooth;

/// Least height, and least size (height times width), of a beat relative to the usual one; smaller
/// pulses are bumps.
const BUMP: f64 = 0.2;

/// Least height of a beat after a stimulus, relative to the usual one.
const EXPECTED: f64 = 0.08;

/// Height from which on a pulse is a beat although noise might reach it, relative to the known
/// usual beat.
const KNOWN: f64 = 0.6;

/// A candidate for a beat.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Peak {
    /// The sample at the top.
    pub(super) at: usize,
    /// Its prominence: how far the curve falls before it rises above the top, on the side where it
    /// falls less.
    pub(super) prominence: f64,
}

/// The detected beats.
pub(super) struct Found {
    /// Tops of beats, in order of time, except at the first and last sample.
    pub(super) peaks: Vec<Peak>,
    /// Half-width of the smoothing that was used, samples.
    pub(super) half: usize,
    /// The usual height of a beat; without beats, the height of the highest pulse.
    pub(super) usual: f64,
    /// The least height that was required.
    pub(super) least: f64,
}

/// Prior knowledge of the beats.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Known<'a> {
    /// Whether beats have a plateau: tops between which the curve does not fall by half belong to
    /// one beat.
    pub(super) plateau: bool,
    /// Height of the usual beat.
    pub(super) height: Option<f64>,
    /// Width of the usual beat at half its height, frames.
    pub(super) width: Option<f64>,
    pub(super) noise: Option<Noise>,
    /// Times of stimuli, ms, each of which should be followed by a beat.
    pub(super) stimuli: &'a [f64],
}

/// Detects the beats of a curve whose beats rise.
pub(super) fn beats(times: &[f64], values: &[f64], known: Known) -> Found {
    let Known { plateau, height, width, noise, stimuli } = known;
    let noise = noise.unwrap_or_else(|| Noise::of(values));
    let count = values.len();
    // With few samples, noise is estimated less precisely.
    let sigma = |half: usize| noise.behind(half) * (1.0 + 3.0 / (count as f64).sqrt());
    // The narrowest window after which noise cannot reach the height of a beat; a window wider than
    // a beat would hide it.
    let widest = (count as f64 / 12.0).min(width.map_or(f64::INFINITY, |width| 1.5 * width));
    let mut half = 0;
    let (smoothed, least) = loop {
        let smoothed = smooth(times, values, half);
        // Expected range of this many samples of noise, with a margin.
        let [_, reach] = noise::reach(noise.samples(count, 2 * half + 1));
        let least = reach * sigma(half);
        let usual = height.unwrap_or_else(|| noise::range(&smoothed, 0.01));
        let next = half + 1 + half / 2;
        if least <= BUMP * usual || (2 * next + 1) as f64 > widest {
            break (smoothed, least);
        }
        half = next;
    };
    // If the usual beat is known, pulses of similar height are beats.
    let least = height.map_or(least, |height| least.min(KNOWN * height));
    let least = least.max(1e-9 * noise::range(&smoothed, 0.0));
    let mut all = persistent(&smoothed);
    all.retain(|peak| peak.at > 0 && peak.at + 1 < count);
    let highest = all.first().map_or(0.0, |peak| peak.prominence);
    let mut peaks = all.clone();
    peaks.retain(|peak| peak.prominence > least);
    if peaks.is_empty() && stimuli.is_empty() {
        return Found { peaks, half, usual: highest, least };
    }
    // The highest pulse alone may be an artefact, or lie on a drift.
    let second = peaks.get(1).or(peaks.first()).map_or(highest, |peak| peak.prominence);
    let second = match height {
        // A second pulse that is only a bump, such as the foot in which a recording ends, is not a
        // beat.
        Some(height) if second < BUMP * height => 0.5 * height,
        Some(height) => second.min(1.5 * height),
        None => second,
    };
    let high: Vec<f64> =
        peaks.iter().map(|peak| peak.prominence).filter(|height| *height >= 0.5 * second).collect();
    let usual = high.get(high.len() / 2).copied().unwrap_or(highest);
    peaks.retain(|peak| peak.prominence >= BUMP * usual);
    let size = |peak: &Peak| peak.prominence * width_at_half(times, &smoothed, peak);
    let mut sizes: Vec<f64> =
        peaks.iter().filter(|peak| peak.prominence >= 0.5 * second).map(size).collect();
    sizes.sort_by(f64::total_cmp);
    let usual_size = sizes.get(sizes.len() / 2).copied().unwrap_or(0.0);
    peaks.retain(|peak| size(peak) >= BUMP * usual_size);
    // Between two stimuli there are fewer noise samples, and a beat is expected.
    for (index, &stimulus) in stimuli.iter().enumerate() {
        let next = stimuli.get(index + 1).copied().unwrap_or(f64::INFINITY);
        let from = times.partition_point(|time| *time < stimulus);
        let to = times.partition_point(|time| *time < next);
        if peaks.iter().any(|peak| (from..to).contains(&peak.at)) {
            continue;
        }
        let [reach, _] = noise::reach(noise.samples(to - from, 2 * half + 1));
        let reach = reach * sigma(half);
        let is_beat = |peak: &&Peak| {
            (from..to).contains(&peak.at) && peak.prominence > reach.max(EXPECTED * usual)
        };
        peaks.extend(all.iter().find(is_beat));
    }
    peaks.sort_by_key(|peak| peak.at);
    if plateau {
        join(&mut peaks, &smoothed, usual);
    }
    Found { peaks, half, usual, least }
}

/// Width of a peak at half its prominence, ms, as far as it was recorded.
pub(super) fn width_at_half(times: &[f64], values: &[f64], peak: &Peak) -> f64 {
    let level = values[peak.at] - 0.5 * peak.prominence;
    let left = (0..peak.at).rev().find(|&at| values[at] < level).unwrap_or(0);
    let right = (peak.at..values.len()).find(|&at| values[at] < level);
    times[right.unwrap_or(values.len() - 1)] - times[left]
}

/// Joins tops of one plateau: between them the curve falls by less than half of the usual height.
fn join(peaks: &mut Vec<Peak>, values: &[f64], usual: f64) {
    let mut kept: Vec<Peak> = Vec::new();
    for peak in peaks.iter().copied() {
        let Some(last) = kept.last_mut() else {
            kept.push(peak);
            continue;
        };
        let between = values[last.at..=peak.at].iter().copied().fold(f64::INFINITY, f64::min);
        if values[last.at].min(values[peak.at]) - between < 0.5 * usual {
            if values[peak.at] > values[last.at] {
                *last = peak;
            }
        } else {
            kept.push(peak);
        }
    }
    *peaks = kept;
}

/// Marks a sample without a hill.
const NONE: usize = usize::MAX;

/// The top of the hill to which a sample belongs.
fn top(hill: &mut [usize], mut at: usize) -> usize {
    while hill[at] != at {
        hill[at] = hill[hill[at]];
        at = hill[at];
    }
    at
}

/// All maxima with their prominence, the highest first: samples are taken in order of height, and where two hills meet the
/// lower one ends.
pub(super) fn persistent(values: &[f64]) -> Vec<Peak> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|a, b| values[*b].total_cmp(&values[*a]).then(a.cmp(b)));
    // The hill of each sample, identified by its top.
    let mut hill = vec![NONE; values.len()];
    let mut peaks = Vec::new();
    for &at in &order {
        let left = if at > 0 && hill[at - 1] != NONE { Some(top(&mut hill, at - 1)) } else { None };
        let right = match hill.get(at + 1) {
            Some(&there) if there != NONE => Some(top(&mut hill, at + 1)),
            _ => None,
        };
        match (left, right) {
            (None, None) => hill[at] = at,
            (Some(one), None) | (None, Some(one)) => hill[at] = one,
            (Some(left), Some(right)) => {
                let (high, low) =
                    if values[left] >= values[right] { (left, right) } else { (right, left) };
                let prominence = values[low] - values[at];
                if prominence > 0.0 {
                    peaks.push(Peak { at: low, prominence });
                }
                hill[low] = high;
                hill[at] = high;
            }
        }
    }
    if let (Some(&highest), Some(&lowest)) = (order.first(), order.last()) {
        peaks.push(Peak { at: highest, prominence: values[highest] - values[lowest] });
    }
    peaks.sort_by(|a, b| b.prominence.total_cmp(&a.prominence).then(a.at.cmp(&b.at)));
    peaks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::noise::Noise;

    /// Triangles of height 1, 60 samples wide, every 200.
    fn triangles(count: usize) -> (Vec<f64>, Vec<f64>) {
        let times = (0..count).map(|i| i as f64).collect();
        let height = |i: usize| (1.0 - ((i % 200) as f64 - 100.0).abs() / 30.0).max(0.0);
        (times, (0..count).map(height).collect())
    }

    #[test]
    fn beats_are_found_in_any_noise_below_a_third_of_them_and_none_in_noise() {
        for seed in 0..20 {
            let mut random = Noise::new(seed);
            for sigma in [0.0, 0.01, 0.1, 0.3] {
                let (times, clean) = triangles(1000);
                let values: Vec<f64> = clean.iter().map(|v| v + sigma * random.normal()).collect();
                let found = beats(&times, &values, Known::default());
                assert_eq!(found.peaks.len(), 5, "seed {seed}, noise {sigma}");
            }
            for count in [50, 500, 5000] {
                let times: Vec<f64> = (0..count).map(f64::from).collect();
                let values: Vec<f64> = times.iter().map(|_| random.normal()).collect();
                assert!(
                    beats(&times, &values, Known::default()).peaks.is_empty(),
                    "seed {seed}, {count}"
                );
            }
        }
    }

    /// As in a published action potential of a spontaneous cell; before, the foot was a beat, and the usual height its own.
    #[test]
    fn the_foot_in_which_a_recording_ends_is_no_beat() {
        let (times, mut values) = triangles(200);
        let mut random = Noise::new(4);
        values[170..]
            .iter_mut()
            .zip(1..)
            .for_each(|(value, step)| *value += 2e-3 * f64::from(step));
        for value in &mut values {
            *value += 1e-3 * random.normal();
        }
        // The last frame is no top; the one before it may be.
        values[198] += 0.01;
        let known = Known { height: Some(1.0), ..Known::default() };
        let found = beats(&times, &values, known);
        assert_eq!(found.peaks.len(), 1);
        assert!((found.usual - 1.0).abs() < 0.05, "{}", found.usual);
    }

    #[test]
    fn prominence_is_over_the_higher_side() {
        let peaks = persistent(&[0.0, 3.0, 1.0, 2.0, 0.5]);
        assert_eq!(peaks[0], Peak { at: 1, prominence: 3.0 });
        assert_eq!(peaks[1], Peak { at: 3, prominence: 1.0 });
    }

    #[test]
    fn a_notch_does_not_make_two_beats_of_an_action_potential() {
        let values: Vec<f64> = (0..300)
            .map(|i| match i % 150 {
                20..23 => 40.0,
                23..30 => -15.0,
                30..60 => 20.0,
                _ => -85.0,
            })
            .collect();
        let times: Vec<f64> = (0..300).map(f64::from).collect();
        assert_eq!(beats(&times, &values, Known::default()).peaks.len(), 4);
        assert_eq!(
            beats(&times, &values, Known { plateau: true, ..Known::default() }).peaks.len(),
            2
        );
    }
}
