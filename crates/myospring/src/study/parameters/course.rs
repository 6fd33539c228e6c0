//! What was sampled of a cell without a mesh, and the metrics of its beats.

use super::description::Which;
use crate::analysis::capture::Window;
use crate::analysis::rhythm::Rhythm;
use crate::analysis::rows::Context;
use crate::analysis::s2::{self, S1S2};
use crate::analysis::{Metric, Missing, action_potential, capture, pulse, tension, trace, value};
use crate::cell::pacing::Protocol;

/// The curves of a cell over its samples.
pub(super) struct Course {
    /// Times, ms.
    pub(super) times: Vec<f64>,
    /// The potential; empty of a cell that has none.
    pub(super) potential: Vec<f64>,
    /// Its unit: mV, or nothing.
    pub(super) unit: &'static str,
    /// Active tension, kPa.
    pub(super) tension: Vec<f64>,
    /// Calcium, uM; empty of a cell that has none.
    pub(super) calcium: Vec<f64>,
}

/// A beat by the samples of it.
struct Beat {
    window: Window,
    /// Whether its stimulus raised an action potential.
    captured: Option<bool>,
    /// Of an S2.
    s2: Option<S1S2>,
}

impl Course {
    /// The metrics of these names of the beat that counts, or their means over the beats of the train.
    pub(super) fn metrics(
        &self,
        protocol: &Protocol,
        which: Which,
        names: &[String],
    ) -> Vec<Option<f64>> {
        let beats = self.beats(protocol);
        let of = |name: &String| match which {
            Which::First => self.value(&beats, 0, name),
            Which::Last => self.value(&beats, beats.len().checked_sub(1)?, name),
            Which::Mean => {
                let train = (0..beats.len()).filter(|&place| beats[place].s2.is_none());
                let values: Vec<f64> =
                    train.filter_map(|place| self.value(&beats, place, name)).collect();
                (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
            }
        };
        names.iter().map(of).collect()
    }

    /// Which stimuli raised no action potential, where some did not.
    pub(super) fn no_capture(&self, protocol: &Protocol) -> Option<String> {
        let beats = self.beats(protocol);
        let pair = beats.last().and_then(|beat| beat.s2.as_ref());
        let s2 = pair.and_then(|pair| self.is_captured(pair));
        let train = || beats.iter().filter(|beat| beat.s2.is_none());
        let stimuli: Vec<f64> = train().map(|beat| beat.window.stimulus_ms).collect();
        let captured: Vec<Option<bool>> = train().map(|beat| beat.captured).collect();
        Rhythm::of(&stimuli, &captured, &[]).no_capture(s2)
    }

    /// The beats; each ends at the next stimulus that is captured.
    fn beats(&self, protocol: &Protocol) -> Vec<Beat> {
        let stimuli: Vec<f64> = protocol.stimulus_times().collect();
        let captured = if self.potential.is_empty() {
            Vec::new()
        } else {
            capture::of(&self.times, &self.potential, self.unit, &stimuli)
        };
        let s1 = |place: usize| {
            let before = captured.get(..place)?;
            before.iter().rposition(|captured| *captured != Some(false)).or(place.checked_sub(1))
        };
        let beat = |window: Window| {
            let Window { place, stimulus_ms, .. } = window;
            let s2 = protocol.s2_ms().filter(|s2_ms| *s2_ms == stimulus_ms);
            let s2 = s2.and_then(|s2_ms| S1S2::after(&self.times, &stimuli, s1(place)?, s2_ms));
            Beat { window, captured: captured.get(place).copied().flatten(), s2 }
        };
        let windows = capture::windows(&self.times, &stimuli, &captured).into_iter();
        // One of which there is more than its rest.
        let begun =
            |window: &Window| self.times.last().is_some_and(|last| *last >= window.stimulus_ms);
        windows.filter(begun).map(beat).collect()
    }

    /// A metric of a beat by its name.
    fn value(&self, beats: &[Beat], place: usize, name: &str) -> Option<f64> {
        let beat = beats.get(place)?;
        match &beat.s2 {
            Some(pair) => {
                let s1 = beats.iter().find(|beat| beat.window.stimulus_ms == pair.s1_ms)?;
                self.of_s2(pair, s1, name)
            }
            None => self.of_train(beat, name),
        }
    }

    fn of_train(&self, beat: &Beat, name: &str) -> Option<f64> {
        let Beat { window: Window { stimulus_ms, within, next_ms, .. }, captured, .. } = beat;
        if *captured == Some(false) {
            return None;
        }
        let times = &self.times[within.clone()];
        let rest = |column: &[f64]| trace::baseline(times, column, *stimulus_ms);
        match name {
            "peak_tension" | "time_to_peak_tension" => {
                let column = &self.tension[within.clone()];
                let rest = rest(column).unwrap_or_default();
                let own = trace::twitch(times, column, *stimulus_ms);
                value(&twitch(&times[own.clone()], &column[own], *stimulus_ms, rest), name)
            }
            "diastolic_level" => rest(self.calcium.get(within.clone())?),
            "systolic_level" => Some(trace::peak(times, self.calcium.get(within.clone())?)?.value),
            _ => {
                let potential = self.potential.get(within.clone())?;
                let stimuli = [*stimulus_ms, *next_ms];
                let rest = rest(potential);
                let rows = action_potential::above(times, potential, stimuli, self.unit, rest, "");
                value(&rows, name)
            }
        }
    }

    /// The potential of a cell that has one.
    fn has_potential(&self) -> Option<&[f64]> {
        Some(&*self.potential).filter(|potential| !potential.is_empty())
    }

    /// Whether an S2 raised an action potential.
    fn is_captured(&self, pair: &S1S2) -> Option<bool> {
        pair.captured(&self.times, self.has_potential()?)
    }

    /// A metric of the beat of an S2; what needs an action potential has no value without one.
    fn of_s2(&self, pair: &S1S2, s1: &Beat, name: &str) -> Option<f64> {
        let Self { times, tension, calcium, .. } = self;
        let captured = self.is_captured(pair) != Some(false);
        let twitch = || {
            let within = pair.beat(tension).filter(|_| captured)?;
            let (times, rest) = (&times[within.clone()], pair.rest(tension));
            Some(twitch(times, &tension[within], pair.s2_ms, rest))
        };
        match name {
            "coupling_interval" | "diastolic_interval" | "relative_peak_tension" => {
                let peak = "peak_tension";
                let of_s1 = self.of_train(s1, peak);
                let of_s1 = of_s1.ok_or(Missing::NotReached);
                let of_s1 = [Metric::new(peak, of_s1, "kPa", "")];
                let diastolic =
                    self.has_potential().and_then(|it| pair.diastolic_interval(times, it));
                let of_s2 = twitch().unwrap_or_default();
                value(&s2::rows(Some(pair), diastolic, &[&of_s1], &[&of_s2]), name)
            }
            _ if !captured => None,
            "peak_tension" | "time_to_peak_tension" => value(&twitch()?, name),
            "diastolic_level" => (!calcium.is_empty()).then(|| pair.rest(calcium)),
            "systolic_level" => {
                let within =
                    Some(calcium).filter(|all| !all.is_empty()).and_then(|all| pair.beat(all))?;
                Some(trace::peak(&times[within.clone()], &calcium[within])?.value)
            }
            _ => value(&pair.metrics(times, self.has_potential()?, self.unit), name),
        }
    }
}

/// The metrics of a tension above its rest.
fn twitch(times: &[f64], column: &[f64], stimulus_ms: f64, rest: f64) -> Vec<Metric> {
    let heights: Vec<f64> = column.iter().map(|tension| tension - rest).collect();
    let pulse = pulse::Pulse::new(times, &heights, stimulus_ms, pulse::Top::Vertex);
    let context = Context { stimulus: Some(stimulus_ms), onset: None, rest: "" };
    tension::of_pulse(&pulse, rest, "kPa", &context)
}
