//! The usual beat: the most frequent class of pulses of one height and width.

use super::windows::mean_over;
use crate::analysis::curve::detect::{Peak, persistent};
use crate::analysis::curve::noise::{self, Noise, median};

/// Pulses of one class differ by at most this factor in height and in width.
const ALIKE: f64 = 1.6;

/// A class of wider pulses is that of the beats if it has at least this part of the members of the
/// most frequent class.
const WIDER: f64 = 0.4;

/// Longer pulses lower than this part of the pulses that disturb them are fluctuations of the rest.
const WIGGLE: f64 = 0.07;

/// Least number of pulses that are beats although smaller pulses are more frequent.
const RARE: f64 = 3.0;

/// Factor by which two pulses must exceed more frequent ones in height and in width to be the
/// beats.
const FAR: f64 = 4.0;

/// Least number of similar pulses that show that the memory of noise was overestimated.
const MANY: f64 = 3.0;

/// The typical beat of a curve.
#[derive(Debug, Clone)]
pub(in crate::analysis::curve) struct Beats {
    /// Height of the usual beat.
    pub(in crate::analysis::curve) height: f64,
    /// Its width at half height, frames.
    pub(in crate::analysis::curve) width: f64,
    /// Frames of the tops of all pulses that may be beats; their heights follow.
    pub(super) tops: Vec<usize>,
    pub(super) heights: Vec<f64>,
    /// Which of them are as wide as the usual beat.
    pub(super) usual: Vec<bool>,
    /// Frames at which the similar ones cross half their height.
    spans: Vec<[usize; 2]>,
    /// Number of similar beats.
    pub(in crate::analysis::curve) alike: f64,
    /// Whether other pulses might be the beats.
    pub(in crate::analysis::curve) rivalled: bool,
}

impl Beats {
    /// Whether a wider window shows the same beats.
    fn shows(&self, wider: &Self) -> bool {
        let near = |top: &&usize| {
            let here = self.nearest(**top);
            self.usual[here] && self.tops[here].abs_diff(**top) as f64 <= 0.5 * wider.width
        };
        let same = wider.tops.iter().filter(near).count();
        10 * same >= 7 * wider.tops.len()
            && self.alike >= 0.6 * wider.alike
            && self.height >= 0.9 * wider.height
            && (0.35..=1.05).contains(&(self.width / wider.width))
    }

    /// Whether these, found with less assumed noise, are more of the same beats, or repeat while
    /// the others are a single drift.
    pub(super) fn replace(&self, others: &Self, longest: f64) -> bool {
        let near = |a: f64, b: f64| a.max(b) <= ALIKE * a.min(b);
        let more = self.alike >= MANY.max(1.2 * others.alike);
        let same = near(self.width, others.width) && near(self.height, others.height);
        let drift =
            others.width > longest || others.alike < 1.0 || 2.0 * self.height >= others.height;
        more && (same || others.alike < 3.0 && drift)
    }

    /// Whether these are pulses of another length that might be the beats instead: nearly as many,
    /// or fewer but far longer (as beats among artefacts are).
    fn rivals(&self, beats: &Self) -> bool {
        let apart = |top: &&usize| {
            let there = beats.tops.get(beats.nearest(**top));
            there.is_none_or(|there| there.abs_diff(**top) as f64 > self.width.max(beats.width))
        };
        let others = self.tops.iter().filter(apart).count() as f64;
        let longer = self.width / beats.width;
        let wiggles = longer * ALIKE < 1.0 && self.height * ALIKE < beats.height;
        let other = longer > ALIKE || longer * ALIKE < 1.0;
        let many = other && !wiggles && others >= 0.7 * beats.alike;
        self.alike >= 2.0 && others >= 2.0 && (many || longer > 2.0 && others >= 0.2 * beats.alike)
    }

    /// Whether most of these remain in the curve when other pulses are left out.
    fn stays_without(&self, others: &Self, values: &[f64]) -> bool {
        let near = (1.5 * others.width) as usize;
        let free = |range: std::ops::Range<usize>| -> Vec<f64> {
            let far = |at: &usize| {
                let top = others.tops.get(others.nearest(*at));
                top.is_none_or(|top| top.abs_diff(*at) > near)
            };
            range.filter(far).map(|at| values[at]).collect()
        };
        let stays = |[from, to]: &&[usize; 2]| {
            let width = to - from;
            let inside = free(*from..*to + 1);
            let sides = [
                free(from.saturating_sub(width)..*from),
                free(to + 1..(to + width + 1).min(values.len())),
            ];
            let enough =
                3 * inside.len() >= width && sides.iter().all(|side| 5 * side.len() >= width);
            let height = median(inside) - sides.map(median).into_iter().fold(f64::MIN, f64::max);
            enough && height > 0.5 * self.height
        };
        10 * self.spans.iter().filter(stays).count() >= 7 * self.spans.len()
    }

    /// Whether they come as irregularly as artefacts: the standard deviation of an exponential
    /// distribution equals its mean.
    fn is_irregular(&self) -> bool {
        let distances = self.spans.windows(2).map(|pair| pair[1][0].abs_diff(pair[0][0]) as f64);
        let distances: Vec<f64> = distances.collect();
        let count = distances.len() as f64;
        let mean = distances.iter().sum::<f64>() / count;
        let squares = distances.iter().map(|far| (far - mean).powi(2)).sum::<f64>();
        count >= 3.0 && (squares / (count - 1.0)).sqrt() > 0.45 * mean
    }

    /// Index of the beat nearest to a frame.
    pub(super) fn nearest(&self, at: usize) -> usize {
        let right = self.tops.partition_point(|top| *top < at);
        let far = |index: usize| self.tops.get(index).map_or(usize::MAX, |top| top.abs_diff(at));
        match right.checked_sub(1) {
            Some(left) if far(left) <= far(right) => left,
            _ => right.min(self.tops.len().saturating_sub(1)),
        }
    }
}

/// Standard deviation of unit noise after the filter of a window and the mean over it.
fn kept(window: usize, memory: f64) -> f64 {
    // Measured; see the tests.
    if window == 0 { 1.0 } else { (0.72 / (window as f64 / memory).powf(0.36)).min(1.0) }
}

/// The most frequent class of similar pulses over all windows. Beats are at least as wide at half
/// height as the first of `lasts`, frames, and few are wider than the second.
pub(in crate::analysis::curve) fn usual(
    values: &[f64],
    windows: &[usize],
    filtered: &[Vec<f64>],
    noise: Noise,
    lasts: [f64; 2],
) -> Option<Beats> {
    let mut classes: Vec<Beats> = Vec::new();
    for (&window, values_here) in windows.iter().zip(filtered) {
        // The filtered curve has no details finer than the window.
        let stride = (window / 4).max(1);
        let coarse: Vec<f64> = mean_over(values_here, window).into_iter().step_by(stride).collect();
        let [_, reach] = noise::reach(noise.samples(values.len(), window + 1));
        let least = reach * kept(window, noise.memory) * noise.sd;
        let least = least.max(1e-9 * noise::range(&coarse, 0.0));
        let mut peaks = persistent(&coarse);
        peaks.retain(|peak| peak.at > 0 && peak.at + 1 < coarse.len() && peak.prominence > least);
        peaks.sort_by_key(|peak| peak.at);
        let pulses: Vec<Pulse> =
            peaks.iter().map(|peak| Pulse::of(&coarse, *peak, stride)).collect();
        classes.extend(class(values, &pulses, window, lasts[0]));
    }
    // Fluctuations a thirtieth as high as other repeating pulses come from the instrument.
    let highest = classes.iter().map(|class| class.height).fold(0.0, f64::max);
    classes.retain(|class| class.height >= 0.03 * highest);
    // Artefacts are shorter than beats, drift is lower; so pulses both higher and longer than more
    // frequent fluctuations are the beats, even if they are rare.
    let mut pool: Vec<&Beats> = classes.iter().collect();
    let frequent = loop {
        let frequent = pool
            .iter()
            .copied()
            .reduce(|most, other| if other.alike > most.alike { other } else { most })?;
        let exceeds = |class: &Beats, by: f64| {
            class.height > by * frequent.height && class.width > by * frequent.width
        };
        let least =
            |class: &Beats| if exceeds(class, FAR) { 2.0 } else { RARE.max(0.1 * frequent.alike) };
        let beats = |class: &Beats| exceeds(class, ALIKE) && class.alike >= least(class);
        let higher: Vec<&Beats> = pool.iter().copied().filter(|class| beats(class)).collect();
        if higher.is_empty() {
            break frequent;
        }
        pool = higher;
    };
    let size = |class: &Beats| class.height * class.width.powi(2);
    let seen = pool
        .into_iter()
        .filter(|class| class.alike >= WIDER * frequent.alike)
        .reduce(|best, other| if size(other) > 1.05 * size(best) { other } else { best })?;
    // Windows round beats off; the first that shows the same beats shows them best.
    let first = |of: &Beats| classes.iter().find(|class| class.shows(of));
    let mut beats = seen;
    while let Some(better) = first(beats).filter(|better| better.width < beats.width) {
        beats = better;
    }
    // Longer pulses that remain without these are the beats that these disturb.
    let least = |of: &Beats| (0.1 * of.alike).max(2.0);
    let longer = classes
        .iter()
        .filter(|class| class.width > 2.0 * beats.width && class.width <= lasts[1])
        .filter(|class| class.height > WIGGLE * beats.height)
        .filter(|class| class.alike >= least(beats) && class.stays_without(beats, values))
        .reduce(|most, other| if other.alike > most.alike { other } else { most });
    let disturbed = longer.filter(|_| beats.is_irregular());
    let mut beats = disturbed.unwrap_or(beats).clone();
    beats.rivalled = longer.is_some() || classes.iter().any(|class| class.rivals(&beats));
    Some(beats)
}

/// A pulse, in frames of the whole curve.
struct Pulse {
    at: usize,
    height: f64,
    /// Frames at which it crosses half its height.
    half: [usize; 2],
}

impl Pulse {
    fn of(coarse: &[f64], peak: Peak, stride: usize) -> Self {
        let level = coarse[peak.at] - 0.5 * peak.prominence;
        let left = (0..peak.at).rev().find(|&at| coarse[at] < level).unwrap_or(0);
        let right = (peak.at..coarse.len()).find(|&at| coarse[at] < level);
        let right = right.unwrap_or(coarse.len() - 1);
        let half = [left * stride, right * stride];
        Self { at: peak.at * stride, height: peak.prominence, half }
    }

    fn width(&self) -> f64 {
        (self.half[1] - self.half[0]) as f64
    }
}

/// The most frequent class of pulses behind a window; `None` if beats would not be wider than the
/// window.
fn class(values: &[f64], pulses: &[Pulse], window: usize, shortest: f64) -> Option<Beats> {
    let near = |a: f64, b: f64| a.max(b) <= ALIKE * a.min(b);
    let alike = |one: &Pulse, other: &Pulse| {
        near(one.height, other.height) && near(one.width(), other.width())
    };
    // About forty of them, spread over their heights, represent all.
    let mut centres: Vec<&Pulse> = pulses.iter().collect();
    centres.sort_by(|a, b| b.height.total_cmp(&a.height).then(a.at.cmp(&b.at)));
    let step = pulses.len().div_ceil(40).max(1);
    let mut best: Option<(f64, Vec<&Pulse>)> = None;
    for centre in centres.into_iter().step_by(step) {
        // The whole curve is not a pulse, and a window as wide as the pulses would create them.
        let least = shortest.max(1.2 * window as f64);
        if centre.width() < least || centre.width() > 0.4 * values.len() as f64 {
            continue;
        }
        let members: Vec<&Pulse> = pulses.iter().filter(|other| alike(centre, other)).collect();
        let weight = members.len() as f64 * plausible(values, pulses, &members, window);
        if best.as_ref().is_none_or(|(most, _)| weight > *most) {
            best = Some((weight, members));
        }
    }
    let (weight, members) = best?;
    let height = median(members.iter().map(|pulse| pulse.height).collect());
    let width = median(members.iter().map(|pulse| pulse.width()).collect());
    let spans = members.iter().map(|pulse| pulse.half).collect();
    let may_be = |pulse: &&Pulse| pulse.height >= 0.3 * height && pulse.width() >= 0.3 * width;
    let of_beats: Vec<&Pulse> = pulses.iter().filter(may_be).collect();
    let tops = of_beats.iter().map(|pulse| pulse.at).collect();
    let usual = of_beats.iter().map(|pulse| near(pulse.width(), width)).collect();
    // The highest pulse is measured from the lowest point of the curve, so its height is limited.
    let heights = of_beats.iter().map(|pulse| pulse.height.min(2.0 * height)).collect();
    Some(Beats { height, width, tops, heights, usual, spans, alike: weight, rivalled: false })
}

/// Least pause before the next beat, as a part of a beat's width.
const PAUSE: f64 = 0.2;

/// Plausibility of a class as beats: low for pulses that jump up and back, that have two frames, or
/// that hardly pause (like the intervals between dips). The pulses are in order of time.
fn plausible(values: &[f64], pulses: &[Pulse], members: &[&Pulse], window: usize) -> f64 {
    let pause = |pulse: &&Pulse| {
        let next = pulses.partition_point(|other| other.at <= pulse.at);
        let next = pulses.get(next)?;
        Some(next.half[0].saturating_sub(pulse.half[1]) as f64 / pulse.width())
    };
    let pauses: Vec<f64> = members.iter().filter_map(pause).collect();
    if !pauses.is_empty() && median(pauses) < PAUSE {
        return 0.1;
    }
    let width = median(members.iter().map(|pulse| pulse.width()).collect());
    if width < 2.5 {
        return 0.3;
    }
    if width < 4.0 {
        return 0.8;
    }
    // Positions at half height are known to within the window.
    let near = 2 + window;
    let jump = |at: usize, height: f64| {
        let (from, to) = (at.saturating_sub(near), (at + near).min(values.len() - 1));
        let steps = (from..to).map(|at| (values[at + 1] - values[at]).abs());
        steps.fold(0.0, f64::max) / height
    };
    let edges = members
        .iter()
        .map(|pulse| jump(pulse.half[0], pulse.height).min(jump(pulse.half[1], pulse.height)));
    if median(edges.collect()) > 0.45 { 0.1 } else { 1.0 }
}
