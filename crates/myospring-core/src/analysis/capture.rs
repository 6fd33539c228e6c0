//! Determines which stimuli raised an action potential, by one rule for trains and extra stimuli.
//!
//! A stimulus is captured if it meets a cell that has repolarised by 80 % or more and raises its potential to more than
//! 80 % of the height of the last action potential before it, as is usual for the effective refractory period. A
//! stimulus without an action potential before it is captured if the potential rises by [`least_height`] or more.

use super::rest;
use std::ops::Range;

/// Part of the last action potential's height that the next one exceeds.
const RESPONSE: f64 = 0.8;
/// Largest potential at the stimulus, as a part of that height; from there, a stimulus alone stays
/// below [`RESPONSE`].
const REPOLARISED: f64 = 0.2;
/// An action potential has its peak within this time, ms.
pub(super) const LATEST_PEAK_MS: f64 = 50.0;

/// Rise of the potential, in its unit, that only an action potential reaches: half of its height. A
/// stimulus alone, which stays below the threshold, raises the potential by less.
pub fn least_height(unit: &str) -> f64 {
    if unit == "mV" { 50.0 } else { 0.5 }
}

/// The potential around one stimulus, in any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StimulusResponse {
    /// Potential at rest before the stimulus.
    pub rest: f64,
    /// Potential at the stimulus.
    pub met: f64,
    /// Largest potential from the stimulus to the next one.
    pub peak: f64,
    /// Whether enough was recorded after the stimulus to see an action potential.
    pub seen: bool,
}

impl StimulusResponse {
    /// Whether this stimulus raised an action potential, given rest and peak of the last one;
    /// `None` if too little was recorded to decide.
    pub fn after(&self, rest: f64, peak: f64) -> Option<bool> {
        let height = peak - rest;
        let captured =
            self.met - rest < REPOLARISED * height && self.peak - rest > RESPONSE * height;
        (captured || self.seen).then_some(captured)
    }
}

/// Whether each stimulus of a series raised an action potential; `least` is [`least_height`].
///
/// # Example
/// ```
/// use myospring::analysis::capture::{StimulusResponse, captures};
/// let response = |met, peak| StimulusResponse { rest: met, met, peak, seen: true };
/// // The second stimulus meets the plateau, the third a cell at rest.
/// let series = [response(-85.0, 35.0), response(10.0, 20.0), response(-84.0, 30.0)];
/// assert_eq!(captures(&series, 50.0), [Some(true), Some(false), Some(true)]);
/// ```
pub fn captures(responses: &[StimulusResponse], least: f64) -> Vec<Option<bool>> {
    // The lowest rest and the last peak of captured stimuli; at short cycles, each rest is above
    // the previous one.
    let mut last: Option<(f64, f64)> = None;
    responses
        .iter()
        .map(|response| {
            let captured = if let Some((rest, peak)) = last {
                response.after(rest, peak)
            } else {
                let captured = response.peak - response.rest >= least;
                (captured || response.seen).then_some(captured)
            };
            if captured == Some(true) {
                let rest = last.map_or(response.rest, |(rest, _)| rest.min(response.rest));
                last = Some((rest, response.peak));
            }
            captured
        })
        .collect()
}

/// Whether each stimulus raised an action potential, from samples of the potential at these times,
/// ms; `None` if too little was recorded to decide.
pub fn of(times: &[f64], potential: &[f64], unit: &str, stimuli_ms: &[f64]) -> Vec<Option<bool>> {
    let at = |time_ms: f64| times.partition_point(|time| *time < time_ms);
    let response = |(place, &stimulus_ms): (usize, &f64)| {
        let first = at(stimulus_ms);
        let end = stimuli_ms.get(place + 1).map_or(times.len(), |next| at(*next));
        let before = rest::before(times, stimuli_ms, place, 0.0).filter(|_| first > 0);
        let before = before.and_then(|before| potential.get(before));
        let after = potential.get(first..end).filter(|after| !after.is_empty());
        let begin = potential.get(first).copied().unwrap_or(f64::NAN);
        let mean = |list: &[f64]| list.iter().sum::<f64>() / list.len() as f64;
        StimulusResponse {
            rest: before.map_or(begin, mean),
            met: before.and_then(|before| before.last().copied()).unwrap_or(begin),
            peak: after
                .map_or(begin, |after| after.iter().copied().fold(f64::NEG_INFINITY, f64::max)),
            seen: reaches(times, stimulus_ms),
        }
    };
    let responses: Vec<StimulusResponse> = stimuli_ms.iter().enumerate().map(response).collect();
    captures(&responses, least_height(unit))
}

/// Whether the samples last long enough to show an action potential of this stimulus.
pub(super) fn reaches(times: &[f64], stimulus_ms: f64) -> bool {
    times.last().is_some_and(|last| last - stimulus_ms >= LATEST_PEAK_MS)
}

/// The samples of one stimulus's beat.
#[derive(Debug, Clone, PartialEq)]
pub struct Window {
    /// Index of the stimulus.
    pub place: usize,
    /// Its time, ms.
    pub stimulus_ms: f64,
    /// Its samples: from before the stimulus (for the resting value) to the next captured stimulus.
    /// A stimulus that is not captured does not end a beat; its own window ends at the next
    /// stimulus.
    pub within: Range<usize>,
    /// Time of the next stimulus, captured or not, ms; infinite after the last.
    pub next_ms: f64,
}

/// The window of each stimulus that is followed by samples; `captured` is the result of [`of`], or
/// empty.
pub fn windows(times: &[f64], stimuli_ms: &[f64], captured: &[Option<bool>]) -> Vec<Window> {
    let at = |time_ms: f64| times.partition_point(|time| *time < time_ms);
    let missed = |place: usize| captured.get(place) == Some(&Some(false));
    let window = |(place, &stimulus_ms): (usize, &f64)| {
        let start = rest::before(times, stimuli_ms, place, 0.0).map_or(0, |rest| rest.start);
        let mut later =
            (place + 1..stimuli_ms.len()).filter(|&next| missed(place) || !missed(next));
        let end_ms = later.next().map_or(f64::INFINITY, |next| stimuli_ms[next]);
        let next_ms = stimuli_ms.get(place + 1).copied().unwrap_or(f64::INFINITY);
        let within = start..at(end_ms).max(start);
        (!within.is_empty()).then_some(Window { place, stimulus_ms, within, next_ms })
    };
    stimuli_ms.iter().enumerate().filter_map(window).collect()
}
