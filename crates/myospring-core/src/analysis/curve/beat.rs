//! The metrics of each beat of a curve.

use super::answer::{CurveBeat, Mark, State};
use super::span::{AT_REST, Reader, Span, mean, median_distance};
use super::upstroke::{self, Upstroke};
use crate::analysis::kind::{Family, Kind};
use crate::analysis::pulse::{Pulse, Top};
use crate::analysis::rows::{Context, row};
use crate::analysis::trace::Point;
use crate::analysis::{
    Metric, Missing, action_potential, contraction, rest, tension, transient, value,
};
use std::ops::Range;

/// Part of a cycle after the last peak from which on the end of the recording counts as rest.
const END: f64 = 0.6;

/// Metrics that need the end of a beat.
const TO_THE_END: [&str; 4] =
    ["area_under_curve", "tension_time_integral", "residual_shortening", "residual_amplitude"];

/// Metrics that need only the rest before a beat.
const AT_REST_ALONE: [&str; 5] =
    ["resting_length", "baseline", "resting_tension", "diastolic_level", "resting_potential"];

/// Least height of a beat after its drift is subtracted, relative to that with which it was found.
const LEAST: f64 = 0.1;

impl Reader<'_> {
    /// The beats of a curve without stimuli.
    pub(super) fn found(&self) -> Vec<CurveBeat> {
        self.read(&self.spans())
    }

    /// The beat after each stimulus.
    pub(super) fn after(&self, stimuli: &[f64]) -> Vec<CurveBeat> {
        let last = self.times[self.times.len() - 1];
        let owners = self.owners(stimuli);
        let mut spans = Vec::new();
        let mut beats: Vec<Option<CurveBeat>> = Vec::new();
        for (index, &stimulus) in stimuli.iter().enumerate() {
            let tops = self.found.peaks.iter().zip(&owners);
            let tops: Vec<usize> =
                tops.filter(|(_, owner)| **owner == Some(index)).map(|(peak, _)| peak.at).collect();
            // The first beat is the response to the stimulus, although a later spontaneous one may
            // be higher. A bump is not a response.
            let highest =
                tops.iter().map(|top| self.smoothed[*top]).fold(f64::NEG_INFINITY, f64::max);
            let enough = highest - 0.5 * self.found.usual;
            let top = tops.into_iter().find(|top| self.smoothed[*top] >= enough);
            let Some(peak) = top else {
                let end = stimuli.get(index + 1).copied().unwrap_or(last);
                let hidden = self.hidden_within(stimulus, end);
                let hint = if hidden.is_empty() {
                    String::new()
                } else {
                    format!("; {hidden} may hide it")
                };
                beats.push(Some(CurveBeat {
                    number: index + 1,
                    stimulus_ms: Some(stimulus),
                    onset_ms: None,
                    state: State::Missed,
                    remarks: vec![format!(
                        "no beat follows the stimulus at {stimulus:.1} ms{hint}"
                    )],
                    metrics: Vec::new(),
                    marks: Vec::new(),
                    rest_frames: None,
                    baseline: None,
                }));
                continue;
            };
            let Range { start: from, end: to } =
                rest::before(self.times, stimuli, index, self.noise_ms).unwrap_or(0..1);
            let rest = mean(&self.signal[from..to]);
            // The top of the previous beat may come after this stimulus; it does not belong to this
            // beat.
            let mut before = self.found.peaks.iter().map(|other| other.at);
            let before = before.rfind(|other| (from..peak).contains(other));
            let first = before.map_or(from, |before| self.lowest(before, peak));
            spans.push(Span {
                stimulus: Some(stimulus),
                peak,
                begin: stimulus,
                rest: [from, to],
                rest_at: Point { time: mean(&self.times[from..to]), value: rest },
                from: first,
                cut_at_start: false,
            });
            beats.push(None);
        }
        let mut read = self.read(&spans).into_iter();
        let beats = beats.into_iter().enumerate().filter_map(|(index, beat)| {
            let beat = beat.or_else(|| read.next())?;
            Some(CurveBeat { number: index + 1, ..beat })
        });
        let mut beats: Vec<CurveBeat> = beats.collect();
        for (index, &stimulus) in stimuli.iter().enumerate() {
            let count = owners.iter().filter(|owner| **owner == Some(index)).count();
            if count > 1 {
                beats[index].remarks.push(format!(
                    "{count} beats follow the stimulus at {stimulus:.1} ms before the next; the first is measured"
                ));
            }
        }
        beats
    }

    fn read(&self, spans: &[Span]) -> Vec<CurveBeat> {
        // Each rest is the median of three neighbours.
        let levels: Vec<f64> = (0..spans.len())
            .map(|at| {
                if at == 0 || at + 1 >= spans.len() || spans[at - 1].cut_at_start {
                    return spans[at].rest_at.value;
                }
                let mut three = [at - 1, at, at + 1].map(|at| spans[at].rest_at.value);
                three.sort_by(f64::total_cmp);
                three[1]
            })
            .collect();
        let end = self.end(spans);
        let between = |from: usize, to: usize| {
            let steady = from < to && !spans[from].cut_at_start && !self.keep_drift;
            let way = spans[to].rest_at.time - spans[from].rest_at.time;
            if steady && way > 0.0 { (levels[to] - levels[from]) / way } else { 0.0 }
        };
        let slope = |at: usize| {
            if at + 1 < spans.len() {
                return between(at, at + 1);
            }
            let before = between(at.saturating_sub(1), at);
            let Some(end) = end.filter(|_| !self.keep_drift) else { return before };
            let after = (end.value - levels[at]) / (end.time - spans[at].rest_at.time);
            if at == 0 {
                return after;
            }
            // For the last beat, the drift of the previous beat and that up to the end are used as
            // far as they agree.
            let mut three = [before, after, 0.0];
            three.sort_by(f64::total_cmp);
            three[1]
        };
        let tops: Vec<usize> = spans.iter().map(|span| span.peak).collect();
        let cycle = median_distance(self.times, &tops).unwrap_or(f64::INFINITY);
        let mut beats: Vec<CurveBeat> = Vec::with_capacity(spans.len());
        for (at, span) in spans.iter().enumerate() {
            let before = at.checked_sub(1).map(|before| &spans[before]);
            let interval =
                before.filter(|span| !span.cut_at_start).map(|before| span.begin - before.begin);
            let mut beat = self.beat(at + 1, span, spans.get(at + 1), slope(at), interval);
            if let (None, Some(before), Some(last)) = (span.stimulus, before, beats.last()) {
                // An artefact may hide a beat.
                let hidden = self.hidden_within(self.times[before.peak], span.begin);
                let long = interval.is_some_and(|interval| interval > 1.5 * cycle);
                if long && !hidden.is_empty() {
                    beat.remarks.push(format!("{hidden} may hide a beat before it"));
                }
                let why = [last.state, beat.state].into_iter().find_map(|state| match state {
                    State::Disturbed => Some(Missing::Artefact),
                    State::Interrupted => Some(Missing::Hole),
                    _ => None,
                });
                if let Some(why) = why.or((long && !hidden.is_empty()).then_some(Missing::Hidden)) {
                    let interval = beat.metrics.iter_mut().filter(|row| row.name == "interval");
                    interval.for_each(|row| row.lose(why));
                }
            }
            beats.push(beat);
        }
        cycles(&mut beats);
        beats
    }

    /// Rest at the end of the recording, if it is long after the last beat.
    fn end(&self, spans: &[Span]) -> Option<Point> {
        let last = spans.last()?;
        let (end, peak) = (self.times[self.times.len() - 1], self.times[last.peak]);
        let before = spans.len().checked_sub(2).map(|at| peak - self.times[spans[at].peak]);
        let cycle = before.unwrap_or(4.0 * (peak - last.begin).max(0.0));
        if end - peak < END * cycle || cycle <= 0.0 {
            return None;
        }
        let from = self.times.partition_point(|time| *time < end - rest::PART / 3.0 * cycle);
        let from = from.min(self.times.len().saturating_sub(3));
        let value = mean(&self.signal[from..]);
        let height = self.smoothed[last.peak] - last.rest_at.value;
        let near = (value - last.rest_at.value).abs() < 0.25 * height;
        near.then(|| Point { time: mean(&self.times[from..]), value })
    }

    fn beat(
        &self,
        number: usize,
        span: &Span,
        next: Option<&Span>,
        slope: f64,
        interval: Option<f64>,
    ) -> CurveBeat {
        let first = span.from;
        // It ends with the rest before the next beat.
        let last = next
            .map_or(self.times.len(), |next| next.rest[1].max(span.peak + 2))
            .min(self.times.len());
        let last = self.before_another(span, last);
        let times = &self.times[first..last];
        let base = |time: f64| span.rest_at.value + slope * (time - span.rest_at.time);
        let heights: Vec<f64> = times
            .iter()
            .zip(&self.smoothed[first..last])
            .map(|(time, value)| value - base(*time))
            .collect();
        // A beat begins within its rest; noise there is not a rise.
        let start = self.times[first];
        let rest = self.sign * span.rest_at.value;
        let top = if self.kind == Kind::Potential { Top::Sample } else { Top::Vertex };
        let slopes: Option<Vec<f64>> = self
            .slopes
            .as_ref()
            .map(|slopes| slopes[first..last].iter().map(|steep| steep - slope).collect());
        let slopes = slopes.as_deref();
        let upstroke = self.upstroke(span, slope);
        // After subtracting drift, enough of the beat must remain.
        let least = LEAST * (self.smoothed[span.peak] - span.rest_at.value).max(0.0);
        let pulse = Pulse::resting_from(start, times, &heights, span.begin, top)
            .above(least)
            .with_noise(self.noise)
            .with_slopes(slopes)
            .with_steepest(upstroke.map(|upstroke| upstroke.at));
        let onset = match span.stimulus {
            Some(_) => onset_of(&pulse),
            None => Some(span.begin),
        };
        let context = Context {
            stimulus: span.stimulus,
            onset,
            rest: if span.stimulus.is_some() { rest::BEFORE_STIMULUS } else { rest::BEFORE_ONSET },
        };
        let mut metrics = self.metrics([times, &heights], slopes, &pulse, &base, rest, &context);
        if self.kind == Kind::Potential {
            let diastolic = self.diastolic(span, next).map(|value| self.sign * value);
            let diastolic = diastolic.ok_or(Missing::Cut);
            let spontaneous = span.stimulus.is_none().then_some(diastolic);
            let window = upstroke.map(|upstroke| upstroke.window_ms).ok_or(Missing::NoRise);
            metrics.extend(action_potential::of_upstroke(window, spontaneous, self.unit));
        }
        let end = times[times.len() - 1];
        let (state, remarks) = self.state(span, next.is_none(), [start, end], &pulse);
        let over_hole = !self.holes_within(start, end).is_empty();
        lose_unread(&mut metrics, state, over_hole);
        metrics.insert(
            0,
            row(
                "interval",
                interval.ok_or(Missing::First),
                "ms",
                if span.stimulus.is_some() {
                    "from the previous stimulus, missed ones left out"
                } else {
                    "from the onset of the previous beat"
                },
            ),
        );
        let baseline = [start, end].map(|time| Point { time, value: self.sign * base(time) });
        CurveBeat {
            number,
            stimulus_ms: span.stimulus,
            onset_ms: onset,
            state,
            remarks,
            metrics,
            marks: self.marks(&pulse, onset, &base),
            rest_frames: Some(span.rest),
            baseline: Some(baseline),
        }
    }

    /// How much of a beat that is read from `start` to `end` was recorded undisturbed, and a remark.
    fn state(
        &self,
        span: &Span,
        is_last: bool,
        [start, end]: [f64; 2],
        pulse: &Pulse,
    ) -> (State, Vec<String>) {
        let back = pulse.falls(AT_REST);
        let over = back.unwrap_or(end);
        let touching = self.artefacts_within(start, over);
        let torn = self.holes_within(span.begin, over);
        let (state, remark) = if span.cut_at_start {
            (State::CutAtStart, "the recording begins within it: its rest is unknown".to_owned())
        } else if !torn.is_empty() {
            (State::Interrupted, format!("no metric is read across {torn}: it counts in no mean"))
        } else if !touching.is_empty() {
            let verb = if touching.starts_with("an ") { "touches" } else { "touch" };
            (State::Disturbed, format!("{touching} {verb} it: it counts in no mean"))
        } else if is_last && back.is_err() {
            (State::CutAtEnd, "the recording ends before it is over".to_owned())
        } else {
            return (State::Whole, Vec::new());
        };
        (state, vec![remark])
    }

    /// End of a beat that is followed by another before `last` (such as a spontaneous one after a
    /// paced one): the lowest point between them, if the curve is more than half back at rest.
    fn before_another(&self, span: &Span, last: usize) -> usize {
        let mut tops = self.found.peaks.iter().map(|peak| peak.at);
        let Some(next) = tops.find(|at| *at > span.peak) else { return last };
        let low = self.lowest(span.peak, next);
        let rest = span.rest_at.value;
        let is_back = self.smoothed[low] - rest < 0.5 * (self.smoothed[span.peak] - rest);
        if next < last && is_back { last.min((low + 1).max(span.peak + 2)) } else { last }
    }

    /// The upstroke of a potential, with the slope of the drift subtracted.
    fn upstroke(&self, span: &Span, drift: f64) -> Option<Upstroke> {
        if self.kind != Kind::Potential {
            return None;
        }
        let samples = span.rest[0]..span.peak + 1;
        let values = &self.signal[samples.clone()];
        let height = self.smoothed[span.peak] - span.rest_at.value;
        let found = upstroke::steepest(&self.times[samples], values, height, self.level)?;
        let at = Point { value: found.at.value - drift, ..found.at };
        Some(Upstroke { at, ..found })
    }

    /// The lowest mean over a fiftieth of the cycle after a peak, before the next beat; `None` if
    /// the recording ends while the potential still falls.
    fn diastolic(&self, span: &Span, next: Option<&Span>) -> Option<f64> {
        let last = self.times.len();
        let stop = next.map_or(last, |next| {
            self.times.partition_point(|time| *time < next.begin).clamp(span.peak + 1, last)
        });
        let values = &self.signal[span.peak..stop];
        let count = (values.len() / 50).max(5);
        if values.len() < 2 * count {
            return None;
        }
        let mut sum: f64 = values[..count].iter().sum();
        let (mut lowest, mut at) = (sum, 0);
        for first in 1..=values.len() - count {
            sum += values[first + count - 1] - values[first - 1];
            if sum < lowest {
                (lowest, at) = (sum, first);
            }
        }
        let turned = at + count < values.len();
        (turned || next.is_some()).then_some(lowest / count as f64)
    }

    fn metrics(
        &self,
        [times, heights]: [&[f64]; 2],
        slopes: Option<&[f64]>,
        pulse: &Pulse,
        base: &dyn Fn(f64) -> f64,
        rest: f64,
        context: &Context,
    ) -> Vec<Metric> {
        match self.kind.family() {
            Family::Contraction if self.kind.is_length() => {
                let shortening: Vec<f64> = heights.iter().map(|height| height / rest).collect();
                let slopes: Option<Vec<f64>> =
                    slopes.map(|slopes| slopes.iter().map(|slope| slope / rest).collect());
                let least = if pulse.peak().is_ok() { 0.0 } else { f64::INFINITY };
                let part =
                    Pulse::resting_from(times[0], times, &shortening, pulse.start(), Top::Vertex)
                        .above(least)
                        .with_noise(self.noise / rest)
                        .with_slopes(slopes.as_deref());
                contraction::of_length(&part, Some(rest), self.unit, context)
            }
            Family::Contraction => contraction::of_motion(pulse, rest, self.unit, context),
            Family::Tension => tension::of_pulse(pulse, rest, self.unit, context),
            Family::Calcium => {
                let under = pulse.peak().map_or(rest, |peak| self.sign * base(peak.time));
                let ground = [rest, under];
                transient::of_pulse(pulse, ground, self.kind, self.unit, context)
            }
            Family::ActionPotential => {
                action_potential::of_pulse(pulse, Some(rest), self.unit, context)
            }
        }
    }

    /// The points of the curve at which metrics were read.
    fn marks(&self, pulse: &Pulse, onset: Option<f64>, base: &dyn Fn(f64) -> f64) -> Vec<Mark> {
        let Ok(peak) = pulse.peak() else { return Vec::new() };
        let on = |name, time: Option<f64>, part: f64| {
            let time = time?;
            let value = self.sign * (base(time) + part * peak.value);
            Some(Mark { name, point: Point { time, value } })
        };
        let marks = [
            on("onset", onset, 0.0),
            on("10 % up", pulse.rises(0.1).ok(), 0.1),
            on("50 % up", pulse.rises(0.5).ok(), 0.5),
            on("90 % up", pulse.rises(0.9).ok(), 0.9),
            on("peak", Some(peak.time), 1.0),
            on("50 % down", pulse.falls(0.5).ok(), 0.5),
            on("90 % down", pulse.falls(0.1).ok(), 0.1),
        ];
        let mut marks: Vec<Mark> = marks.into_iter().flatten().collect();
        for (name, sign) in [("fastest up", 1.0), ("fastest down", -1.0)] {
            let Ok(at) = pulse.fastest(sign) else { continue };
            let right =
                self.times.partition_point(|time| *time < at.time).min(self.times.len() - 1);
            let value = 0.5 * (self.smoothed[right.saturating_sub(1)] + self.smoothed[right]);
            marks.push(Mark { name, point: Point { time: at.time, value: self.sign * value } });
        }
        marks
    }
}

/// Time at which the line through 10 % and 50 % of a pulse's rise meets its rest.
fn onset_of(pulse: &Pulse) -> Option<f64> {
    let (tenth, half) = (pulse.rises(0.1).ok()?, pulse.rises(0.5).ok()?);
    Some(tenth - 0.25 * (half - tenth))
}

/// Removes the values that a beat in this state does not show.
fn lose_unread(metrics: &mut [Metric], state: State, over_hole: bool) {
    let needs_the_end = |metric: &Metric| TO_THE_END.contains(&metric.name);
    for metric in metrics {
        if state == State::Interrupted {
            if !AT_REST_ALONE.contains(&metric.name) {
                metric.lose(Missing::Hole);
            }
        } else if over_hole && needs_the_end(metric) {
            metric.lose(Missing::Hole);
        } else if state == State::CutAtEnd && needs_the_end(metric) {
            metric.lose(Missing::Cut);
        }
    }
}

/// Fills in the time from each upstroke to the next.
fn cycles(beats: &mut [CurveBeat]) {
    let upstrokes: Vec<Option<f64>> = beats
        .iter()
        .map(|beat| {
            let whole = matches!(beat.state, State::Whole | State::CutAtEnd);
            value(&beat.metrics, "time_of_upstroke").filter(|_| whole)
        })
        .collect();
    for (at, beat) in beats.iter_mut().enumerate().skip(1) {
        // Without an interval, there may be another beat in between.
        if value(&beat.metrics, "interval").is_none() {
            continue;
        }
        if let Some(cycle) = beat.metrics.iter_mut().find(|metric| metric.name == "cycle_length") {
            if let (Some(before), Some(own)) = (upstrokes[at - 1], upstrokes[at]) {
                (cycle.value, cycle.missing) = (Some(own - before), None);
            } else {
                cycle.lose(Missing::Artefact);
            }
        }
    }
}
