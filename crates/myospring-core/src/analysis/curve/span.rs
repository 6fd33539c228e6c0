//! Where the beats of a curve lie, with the rest before each.

use super::answer::Artefact;
use super::detect::Found;
use crate::analysis::holes::Hole;
use crate::analysis::kind::Kind;
use crate::analysis::order::median;
use crate::analysis::trace::Point;
use crate::analysis::{rest, trace};

/// Largest height of the curve at rest, as a part of a beat's height.
pub(super) const AT_REST: f64 = 0.1;

/// A curve, ready to be read.
pub(super) struct Reader<'a> {
    pub(super) times: &'a [f64],
    /// The curve with sign such that beats rise, without bad frames and hum.
    pub(super) signal: &'a [f64],
    pub(super) smoothed: &'a [f64],
    /// Slopes of `signal`; `None` uses those between neighbours of `smoothed`.
    pub(super) slopes: Option<&'a [f64]>,
    /// Standard deviation of the noise of `signal`, and of `smoothed`.
    pub(super) level: f64,
    pub(super) noise: f64,
    /// Averaging time for which the mean of `signal` has little noise, ms.
    pub(super) noise_ms: f64,
    /// Factor from `signal` to the curve's values: 1 or -1.
    pub(super) sign: f64,
    pub(super) kind: Kind,
    pub(super) unit: &'static str,
    pub(super) found: &'a Found,
    pub(super) keep_drift: bool,
    pub(super) artefacts: &'a [Artefact],
    pub(super) holes: &'a [Hole],
    /// Half-width of the smoothing window, frames.
    pub(super) half: usize,
}

/// Position of a beat in the samples.
#[derive(Debug, Clone, Copy)]
pub(super) struct Span {
    pub(super) stimulus: Option<f64>,
    /// The sample at its top.
    pub(super) peak: usize,
    /// The time at which it begins: its stimulus, or its onset.
    pub(super) begin: f64,
    /// Samples of its rest, and their mean time and value.
    pub(super) rest: [usize; 2],
    pub(super) rest_at: Point,
    /// The first sample that is read.
    pub(super) from: usize,
    pub(super) cut_at_start: bool,
}

impl Reader<'_> {
    /// The beats of a curve without stimuli.
    pub(super) fn spans(&self) -> Vec<Span> {
        let peaks: Vec<usize> = self.found.peaks.iter().map(|peak| peak.at).collect();
        let cycle = median_distance(self.times, &peaks);
        let mut spans: Vec<Span> =
            (0..peaks.len()).map(|at| self.span(&peaks, at, cycle)).collect();
        // The curve before the first beat is not at rest if it is higher than later rests and drift
        // does not explain that.
        let rest = |at: usize| spans.get(at).map(|span| span.rest_at.value);
        if let (Some(first), Some(peak)) = (rest(0), peaks.first()) {
            let last = self.times.len() - 1;
            let second = rest(1).unwrap_or(self.smoothed[self.lowest(*peak, last)]);
            let drift = rest(2).map_or(0.0, |third| (second - third).max(0.0));
            let height = self.smoothed[*peak] - second;
            spans[0].cut_at_start |= first - second - 2.0 * drift > 2.0 * AT_REST * height;
        }
        spans
    }

    /// The rest of the `at`-th peak, and the time at which the curve leaves it.
    fn span(&self, peaks: &[usize], at: usize, cycle: Option<f64>) -> Span {
        let peak = peaks[at];
        let from = if at == 0 { 0 } else { self.lowest(peaks[at - 1], peak) };
        let low = if at == 0 { self.lowest(0, peak) } else { from };
        let mut rest = self.smoothed[low];
        let mut onset = self.onset(low, peak, rest);
        let before =
            if at == 0 { None } else { Some(self.times[peak] - self.times[peaks[at - 1]]) };
        let width = 2.0 * (self.times[peak] - onset).max(0.0);
        let cycle = before.or(cycle).unwrap_or(4.0 * width);
        let mut window = [low, low];
        // Rest and onset depend on each other.
        for _ in 0..3 {
            // A foot before the onset does not belong to the rest.
            let foot = 0.25 * (self.times[peak] - onset).max(0.0);
            let end = self.times.partition_point(|time| *time <= onset - foot).min(peak);
            let start =
                self.times.partition_point(|time| *time < onset - foot - rest::PART * cycle);
            // At least three frames, if there are as many after the previous beat.
            let first_free = if at == 0 { 0 } else { peaks[at - 1] + 1 };
            let start = start.min(end.saturating_sub(3)).max(first_free);
            window = [start, end.max(start + 1)];
            if at == 0 && window[1] - window[0] < 2 {
                // As much rest as available.
                window[1] = self.times.partition_point(|time| *time <= onset).clamp(1, peak.max(1));
            }
            rest = mean(&self.signal[window[0]..window[1]]);
            onset = self.onset(low.min(end), peak, rest);
        }
        if let Some(before) = at.checked_sub(1) {
            // A beat begins after the top of the previous one.
            onset = onset.max(self.times[peaks[before] + 1]);
        }
        // The first beat needs rest before it.
        let cut_at_start = at == 0 && (window[1] - window[0] < 2 || onset <= self.times[0]);
        let rest_at = Point { time: mean(&self.times[window[0]..window[1]]), value: rest };
        Span {
            stimulus: None,
            peak,
            begin: onset,
            rest: window,
            rest_at,
            from: window[0],
            cut_at_start,
        }
    }

    /// The lowest smoothed sample between two.
    pub(super) fn lowest(&self, from: usize, to: usize) -> usize {
        let low = (from..=to).reduce(
            |low, at| {
                if self.smoothed[at] < self.smoothed[low] { at } else { low }
            },
        );
        low.unwrap_or(from)
    }

    /// Time at which the line through 10 % and 50 % of the rise meets the rest, ms.
    fn onset(&self, low: usize, peak: usize, rest: f64) -> f64 {
        let height = self.smoothed[peak] - rest;
        let crossing = |part: f64| {
            let level = rest + part * height;
            let (from, to) = (self.times[low], self.times[peak]);
            trace::last_rise_through(self.times, self.smoothed, level, from, to)
        };
        match (crossing(0.1), crossing(0.5)) {
            (Some(tenth), Some(half)) => tenth - 0.25 * (half - tenth),
            (None, Some(half)) => half,
            _ => self.times[low],
        }
    }

    /// The stimulus of each beat: the last one before its onset.
    pub(super) fn owners(&self, stimuli: &[f64]) -> Vec<Option<usize>> {
        let peaks: Vec<usize> = self.found.peaks.iter().map(|peak| peak.at).collect();
        let cycle = median_distance(self.times, &peaks);
        let onset = |at: usize| {
            let begin = self.span(&peaks, at, cycle).begin;
            // Noise may shift an onset slightly before its stimulus.
            let slack = 0.15 * (self.times[peaks[at]] - begin).max(0.0);
            // An onset is known only to within one sample: an upstroke may begin between the sample
            // before its stimulus and the next one.
            let next = self.times.partition_point(|time| *time < begin + slack);
            self.times[next.min(peaks[at])]
        };
        let owner = |at: usize| stimuli.partition_point(|time| *time <= onset(at)).checked_sub(1);
        (0..peaks.len()).map(owner).collect()
    }

    /// The artefacts that overlap a time, in words; empty if there are none.
    pub(super) fn artefacts_within(&self, from: f64, to: f64) -> String {
        let within = self.artefacts.iter().filter(|it| it.from_ms <= to && it.to_ms >= from);
        let times: Vec<String> =
            within.map(|it| format!("{:.0} to {:.0} ms", it.from_ms, it.to_ms)).collect();
        match times.len() {
            0 => String::new(),
            1 => format!("an artefact at {}", times[0]),
            count if count > 3 => format!("{count} artefacts, the first at {},", times[0]),
            _ => format!("artefacts at {}", times.join(", ")),
        }
    }

    /// The gaps that overlap a time (widened by smoothing), in words; empty if there are none.
    pub(super) fn holes_within(&self, from: f64, to: f64) -> String {
        let touches = |hole: &&Hole| {
            let margin = self.half as f64 * hole.usual_ms;
            hole.from_ms - margin < to && hole.to_ms + margin > from
        };
        let within: Vec<&Hole> = self.holes.iter().filter(touches).collect();
        match within[..] {
            [] => String::new(),
            [one] => {
                format!("the gap in the times from {:.0} to {:.0} ms", one.from_ms, one.to_ms)
            }
            [first, ..] => format!(
                "{} gaps in the times, the first from {:.0} to {:.0} ms,",
                within.len(),
                first.from_ms,
                first.to_ms
            ),
        }
    }

    /// What may hide a beat within a time, in words.
    pub(super) fn hidden_within(&self, from: f64, to: f64) -> String {
        let both = [self.artefacts_within(from, to), self.holes_within(from, to)];
        both.into_iter().filter(|words| !words.is_empty()).collect::<Vec<_>>().join(" and ")
    }
}

pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Median time between neighbouring peaks.
pub(super) fn median_distance(times: &[f64], peaks: &[usize]) -> Option<f64> {
    median(peaks.windows(2).map(|pair| times[pair[1]] - times[pair[0]]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::curve::detect::{Found, Peak};
    use crate::analysis::kind::Kind;

    /// After a short beat a step, and from it a slow rise to a second one: the line through 10 % and 50 % of it meets rest
    /// before the first beat began.
    #[test]
    fn no_interval_is_negative_however_slowly_a_beat_rises_after_another() {
        let times: Vec<f64> = (0..750).map(|frame| 4.0 * f64::from(frame)).collect();
        for step in [0.17, 0.3, 0.42] {
            for slow in [500.0, 1000.0, 1290.0, 1500.0] {
                let short = |t: f64| (t / 42.0).min((50.0 - t) / 8.0).max(0.0);
                let second = |t: f64| match t {
                    t if t < 0.0 => 0.0,
                    t if t < 8.0 => step * t / 8.0,
                    t if t < slow => step + (1.0 - step) * ((t - 8.0) / (slow - 8.0)).powf(1.8),
                    t => (1.0 - (t - slow) / 200.0).max(0.0),
                };
                let pair = |t: &f64| short(t - 400.0).max(second(t - 500.0));
                let signal: Vec<f64> = times.iter().map(pair).collect();
                let peaks = [442.0, 500.0 + slow].map(|time| {
                    let at = times.partition_point(|frame| *frame < time);
                    Peak { at, prominence: signal[at] }
                });
                let found = Found { peaks: peaks.to_vec(), half: 0, usual: 1.0, least: 0.01 };
                let reader = Reader {
                    times: &times,
                    signal: &signal,
                    smoothed: &signal,
                    slopes: None,
                    level: 0.0,
                    noise: 0.0,
                    noise_ms: 0.0,
                    sign: 1.0,
                    kind: Kind::Tension,
                    unit: "kPa",
                    found: &found,
                    keep_drift: false,
                    artefacts: &[],
                    holes: &[],
                    half: 0,
                };
                let interval =
                    crate::analysis::value(&reader.found()[1].metrics, "interval").unwrap();
                assert!(interval > 0.0, "{step}, {slow}: {interval} ms");
            }
        }
    }
}
