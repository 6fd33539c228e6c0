//! Compares the beat of an extra stimulus, S2, with the last beat of the train before it, S1.
//!
//! At an early S2, the cell is not yet at rest. So both beats are measured from the same rest, that
//! before the last S1, and the remainder of S1 at S2 does not belong to the beat of S2: that begins
//! where its largest rise begins.

use super::capture::{self, StimulusResponse};
use super::rows::{recorded, row};
use super::{Metric, Missing, action_potential, rest, trace, value};
use std::ops::Range;

/// Least rise, as a part of S1's height; smaller ones are oscillations or rounding.
const LEAST: f64 = 0.01;

/// S2 and the last S1 in the samples of a run.
///
/// # Example
/// ```
/// use myospring::analysis::s2::S1S2;
/// // Bells 100 ms after S1 at 50 ms, and half as high 50 ms after S2 at 180 ms, which meets the first one's fall.
/// let times: Vec<f64> = (0..500).map(f64::from).collect();
/// let bell = |t: f64, at: f64| (-((t - at) / 30.0).powi(2)).exp();
/// let values: Vec<f64> = times.iter().map(|&t| bell(t, 150.0) + 0.5 * bell(t, 230.0)).collect();
/// let pair = S1S2::of(&times, &[50.0, 180.0], 180.0).unwrap();
/// assert!(pair.rest(&values).abs() < 1e-3);
/// let beat = &values[pair.beat(&values).unwrap()];
/// assert!((beat.iter().copied().fold(0.0, f64::max) - 0.5).abs() < 0.01);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct S1S2 {
    /// Time of the last S1, ms.
    pub s1_ms: f64,
    /// Time of S2, ms.
    pub s2_ms: f64,
    /// Samples whose mean is the rest.
    rest: Range<usize>,
    /// Samples from S1 to S2.
    first: Range<usize>,
    /// Samples of S1 before the next stimulus; they show its height.
    own: Range<usize>,
    /// Samples from S2 on.
    second: Range<usize>,
}

impl S1S2 {
    /// Finds S2 (the last stimulus, at `s2_ms`) and the stimulus before it in samples at these
    /// times, ms; `None` if there is no stimulus before it or no sample after it.
    pub fn of(times: &[f64], stimuli_ms: &[f64], s2_ms: f64) -> Option<Self> {
        let place = stimuli_ms.iter().rposition(|time| *time == s2_ms)?;
        Self::after(times, stimuli_ms, place.checked_sub(1)?, s2_ms)
    }

    /// Like [`S1S2::of`], with the index of S1: the last stimulus that raised an action potential.
    pub fn after(times: &[f64], stimuli_ms: &[f64], s1: usize, s2_ms: f64) -> Option<Self> {
        let s1_ms = *stimuli_ms.get(s1)?;
        let next_ms = stimuli_ms.get(s1 + 1).copied().unwrap_or(s2_ms).min(s2_ms);
        let at = |time_ms: f64| times.partition_point(|time| *time < time_ms);
        let rest = rest::before(times, stimuli_ms, s1, 0.0)?;
        let (s1, next, s2) = (at(s1_ms), at(next_ms), at(s2_ms));
        let inside = s1 < next && next <= s2 && s2 < times.len();
        let (first, own, second) = (s1..s2, s1..next, s2..times.len());
        inside.then_some(Self { s1_ms, s2_ms, rest, first, own, second })
    }

    /// The mean before the last S1.
    pub fn rest(&self, values: &[f64]) -> f64 {
        let samples = &values[self.rest.clone()];
        samples.iter().sum::<f64>() / samples.len() as f64
    }

    /// Height of S1 above rest, of values that rise in a beat.
    fn height(&self, values: &[f64]) -> f64 {
        most(&values[self.own.clone()]) - self.rest(values)
    }

    /// Whether S2 raised an action potential: the cell was repolarised by 80 % or more, and the
    /// peak is above 80 % of that of the last S1. `None` if too little was recorded to decide.
    pub fn captured(&self, times: &[f64], potential: &[f64]) -> Option<bool> {
        let rest = self.rest(potential);
        let response = StimulusResponse {
            rest,
            met: potential[self.second.start - 1],
            peak: most(&potential[self.second.clone()]),
            seen: capture::reaches(times, self.s2_ms),
        };
        response.after(rest, most(&potential[self.own.clone()]))
    }

    /// From 90 % repolarisation of the last S1 to S2, ms; `None` if S2 comes earlier.
    pub fn diastolic_interval(&self, times: &[f64], potential: &[f64]) -> Option<f64> {
        let level = self.rest(potential) + 0.1 * self.height(potential);
        let top = trace::largest(&times[self.own.clone()], &potential[self.own.clone()])?;
        let (times, values) = (&times[self.first.clone()], &potential[self.first.clone()]);
        Some(self.s2_ms - trace::falls_through(times, values, level, top.time)?)
    }

    /// The samples of S2's beat, from the beginning of its largest rise, in values that rise in a
    /// beat; `None` if they hardly rise.
    pub fn beat(&self, values: &[f64]) -> Option<Range<usize>> {
        let (foot, rise) = trace::largest_rise(&values[self.second.clone()])?;
        let found = self.second.start + foot;
        (rise > LEAST * self.height(values)).then_some(found..self.second.end)
    }

    /// The metrics of S2's action potential, in the potential's unit, and of the intervals before it; without capture only
    /// these have values.
    pub fn metrics(&self, times: &[f64], potential: &[f64], unit: &'static str) -> Vec<Metric> {
        // The sample before the stimulus is included for the upstroke.
        let within = self.second.start - 1..self.second.end;
        let rest = Some(self.rest(potential));
        let rest_is = rest::BEFORE_S1;
        let (own_times, own) = (&times[within.clone()], &potential[within]);
        let to_end = f64::INFINITY;
        let mut all =
            action_potential::above(own_times, own, [self.s2_ms, to_end], unit, rest, rest_is);
        if self.captured(times, potential) == Some(false) {
            for metric in &mut all {
                metric.lose(Missing::NotCaptured);
            }
        }
        let diastolic = self.diastolic_interval(times, potential);
        all.extend(rows(Some(self), diastolic, &[], &[]).into_iter().take(INTERVALS));
        all
    }
}

fn most(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

/// This number of the first [`rows`] are intervals.
const INTERVALS: usize = 2;

/// Metrics of an S2 beat relative to the last S1: intervals, and ratios of their strengths.
pub fn rows(
    pair: Option<&S1S2>,
    diastolic_interval: Option<f64>,
    s1: &[&[Metric]],
    s2: &[&[Metric]],
) -> Vec<Metric> {
    let of = |beat: &[&[Metric]], name| beat.iter().find_map(|metrics| value(metrics, name));
    let part =
        |name| recorded(of(s2, name)).and_then(|own| Ok(100.0 * own / recorded(of(s1, name))?));
    vec![
        row(
            "coupling_interval",
            recorded(pair.map(|pair| pair.s2_ms - pair.s1_ms)),
            "ms",
            "from the last S1 that raised an action potential to S2",
        ),
        row(
            "diastolic_interval",
            diastolic_interval.ok_or(Missing::NotReached),
            "ms",
            "from 90 % repolarisation of the last S1 to S2",
        ),
        row(
            "relative_peak_tension",
            part("peak_tension"),
            "%",
            "largest tension of S2, relative to that of the last S1",
        ),
        row(
            "relative_peak_shortening",
            part("peak_shortening"),
            "%",
            "peak shortening of S2, relative to that of the last S1, both from the length before S1",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use crate::analysis::beat::Beat;
    use crate::analysis::beats::Beats;
    use crate::recording::{Recording, Sample};

    /// An upstroke to 100 that goes straight back to 0 within a time.
    fn potential(since_ms: f64, lasts_ms: f64) -> f64 {
        let falls = 100.0 * (1.0 - since_ms / lasts_ms);
        if since_ms > 0.0 { falls.max(0.0) } else { 0.0 }
    }

    /// Three S1 every 500 ms from 50 ms on, and an S2: potential and twitches, whose heights are given. Twitches rise for
    /// 100 ms and decay with 120 ms, so that an early S2 meets the last one's fall.
    fn recording(interval_ms: f64, s2: f64, twitch: f64) -> (Recording, [f64; 4]) {
        let stimuli = [50.0, 550.0, 1050.0, 1050.0 + interval_ms];
        let one = |since: f64| match since {
            since if since <= 0.0 => 0.0,
            since if since < 100.0 => since / 100.0,
            since => (-(since - 100.0) / 120.0).exp(),
        };
        let sample = |index: i32| {
            let t_ms = 0.5 * f64::from(index);
            let sum = |one: &dyn Fn(f64) -> f64, last: f64| {
                let train = stimuli[..3].iter().map(|stimulus| one(t_ms - stimulus));
                train.sum::<f64>() + last * one(t_ms - stimuli[3])
            };
            let tension = sum(&one, twitch);
            Sample {
                t_ms,
                vm_mv: Some(sum(&|since| potential(since, 200.0), s2) - 80.0),
                ta_kpa: 20.0 * tension,
                length_um: 100.0 * (1.0 - 0.1 * tension),
                width_um: 20.0,
                area_um2: 2000.0,
                shortening_pct: 10.0 * tension,
                ..Sample::STILL
            }
        };
        (Recording { samples: (0..4000).map(sample).collect(), ..Recording::default() }, stimuli)
    }

    fn beats(interval_ms: f64, s2: f64, twitch: f64) -> Beats {
        let (recording, stimuli) = recording(interval_ms, s2, twitch);
        Beats::of(&recording, &stimuli, Some(stimuli[3]))
    }

    #[test]
    fn an_early_s2_is_counted_from_the_rest_before_the_last_s1_and_is_in_no_mean() {
        for interval in [210.0, 300.0, 700.0] {
            let beats = beats(interval, 0.95, 0.6);
            let s2 = beats.s2().unwrap();
            assert_eq!((beats.len(), beats.counted().count(), s2.captured), (4, 3, Some(true)));
            // What is left of the train: of three twitches before, or of two at the rest before the last S1.
            let left = |since: f64| (-(since - 100.0) / 120.0_f64).exp();
            let rest = left(500.0);
            let peak = 0.6 + left(100.0 + interval);
            let ratio = 100.0 * peak / (1.0 + left(600.0));
            let expected = [
                ("coupling_interval", interval, 1e-9),
                // 90 % of the way back, 180 ms after the upstroke.
                ("diastolic_interval", interval - 180.0, 1.0),
                ("action_potential_duration_90", 180.0, 1.0),
                ("resting_tension", 20.0 * rest, 0.1),
                ("peak_tension", 20.0 * peak, 0.1),
                ("time_to_peak_tension", 100.0, 0.5),
                ("relative_peak_tension", ratio, 1.0),
                ("peak_shortening", 10.0 * peak, 0.6),
            ];
            for (name, expected, tolerance) in expected {
                let found = s2.value(name).unwrap();
                assert!((found - expected).abs() < tolerance, "{interval}, {name}: {found}");
            }
            // As of the train alone.
            let (recording, stimuli) = recording(interval, 0.95, 0.6);
            let train = Beats::of(&recording, &stimuli[..3], None);
            let first = |beats: &Beats| {
                beats[..2].iter().map(|b| b.value("peak_tension")).collect::<Vec<_>>()
            };
            assert_eq!(first(&beats), first(&train));
            let spread = beats.spread();
            let tension = spread.iter().find(|spread| spread.name == "peak_tension").unwrap();
            assert_eq!(tension.beats, 3);
            assert_eq!(beats.mean("peak_tension"), Some(tension.mean));
            assert_eq!(beats.mean("coupling_interval"), Some(interval));
        }
    }

    #[test]
    fn a_stimulus_that_raises_no_action_potential_is_no_capture_and_has_no_numbers() {
        // Too small an answer, and one on the plateau of S1, whatever its height.
        for (interval, s2) in [(300.0, 0.5), (80.0, 1.0), (150.0, 1.0)] {
            let beats = beats(interval, s2, 0.6);
            let missed = beats.s2().unwrap();
            assert_eq!(missed.captured, Some(false), "{interval} ms");
            let known: Vec<&str> =
                missed.metrics().filter(|row| row.value.is_some()).map(|row| row.name).collect();
            let intervals = ["coupling_interval", "diastolic_interval"];
            assert!(known.iter().all(|name| intervals.contains(name)), "{known:?}");
            assert_eq!(beats.counted().count(), 3);
        }
    }

    #[test]
    fn an_action_potential_without_a_twitch_of_its_own_has_no_peak_of_tension() {
        let beats = beats(220.0, 1.0, 0.0);
        let s2 = beats.s2().unwrap();
        assert_eq!(s2.captured, Some(true));
        assert!(s2.value("action_potential_duration_90").is_some());
        for name in ["peak_tension", "peak_shortening", "relative_peak_tension"] {
            assert_eq!(s2.value(name), None, "{name}");
        }
    }

    #[test]
    fn nothing_is_said_of_an_s2_that_the_recording_hardly_reaches() {
        let (mut recording, stimuli) = recording(300.0, 1.0, 1.0);
        recording.samples.retain(|sample| sample.t_ms < stimuli[3] + 0.2);
        let beats = Beats::of(&recording, &stimuli, Some(stimuli[3]));
        assert_eq!(beats.s2().map(|beat: &Beat| beat.captured), Some(None));
        recording.samples.retain(|sample| sample.t_ms < stimuli[3]);
        let beats = Beats::of(&recording, &stimuli[..3], Some(stimuli[3]));
        assert_eq!((beats.len(), beats.s2()), (3, None));
    }
}
