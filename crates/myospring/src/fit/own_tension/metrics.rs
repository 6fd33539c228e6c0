//! Metrics of a tension that a curve asks for, its mean beat, and how sure both are.

use super::beats::analysis;
use super::course::{MeanBeat, NORMAL, OwnTension, TensionMetric};
use crate::analysis::curve::{Analysis, State};
use crate::analysis::kind::Kind;
use crate::analysis::monotone::MonotoneCubic;
use crate::analysis::{Spread, order, value};
use crate::fit::likelihood::rise_at_ends;
use crate::fit::observed::Stimuli;
use crate::study::sampling::{Distribution, ParameterSample, Sampler, sample};
use rayon::prelude::*;
use std::f64::consts::SQRT_2;

/// The metrics that are stated, where a tension has them.
const STATED: [&str; 8] = [
    "peak_tension",
    "time_to_peak_tension",
    "time_to_peak_tension_from_onset",
    "tension_relaxation_time_50",
    "twitch_duration_50",
    "tension_time_integral",
    "maximum_tension_rate",
    "maximum_tension_fall_rate",
];

/// Beats of copies with other noise from which the noise of a metric is taken, and the fewest copies.
const BEATS_OF_COPIES: usize = 120;
const COPIES: usize = 4;
const SEED: u64 = 1;
/// Unit of a rate. A rate that takes the tension to its peak in fewer frames is a lower bound of the true one.
const RATE: &str = "kPa/s";
const FAST: f64 = 3.0;
/// Fewest beats whose scatter is an interval.
const BEATS: usize = 3;
/// Part of the interval between beats that the mean beat has before its onset.
const BEFORE: f64 = 0.1;

/// What noise does to the mean of a metric.
struct Noise {
    /// How far it moves it: the highest of noisy frames is above the true peak.
    shift: f64,
    /// Standard deviation around that.
    scatter: f64,
}

impl OwnTension {
    /// Reads metrics and the mean beat, where the tension has beats.
    pub(super) fn read_beats(&mut self, stimuli: &Stimuli) {
        let Ok(found) = analysis(&self.times_ms, &self.unclipped_kpa, Kind::Tension, stimuli)
        else {
            return;
        };
        self.mean_beat = self.mean_of(&found);
        let spread = found.spread();
        let noise = self.by_noise(&found, stimuli);
        let peak = found.mean("peak_tension").unwrap_or(f64::INFINITY);
        let step_s = 1e-3 * median_step(&self.times_ms);
        let rows = found.beats.iter().flat_map(|beat| &beat.metrics);
        let mut rows: Vec<_> = rows.filter(|row| STATED.contains(&row.name)).collect();
        rows.sort_by_key(|row| STATED.iter().position(|name| *name == row.name));
        rows.dedup_by_key(|row| row.name);
        self.metrics = rows
            .into_iter()
            .filter_map(|row| {
                let mean = found.mean(row.name)?;
                let Noise { shift, scatter } = noise(row.name)?;
                let standard_deviation = scatter.hypot(shift);
                let around = |by: f64| [mean - by, mean + by];
                let interval_by_noise = around(NORMAL * standard_deviation);
                let of_beats = spread.iter().find(|spread| spread.name == row.name);
                let beats = of_beats.map_or(1, |spread| spread.beats);
                let interval_by_beats =
                    of_beats.filter(|spread| spread.beats >= BEATS).map(|spread: &Spread| {
                        let count = spread.beats as f64;
                        let student = rise_at_ends(count - 1.0).sqrt();
                        let by_beats = student * spread.standard_deviation / count.sqrt();
                        around(by_beats.hypot(NORMAL * shift))
                    });
                Some(TensionMetric {
                    name: row.name,
                    unit: row.unit,
                    definition: row.definition,
                    value: mean,
                    standard_deviation,
                    interval_by_noise,
                    interval_by_beats,
                    interval: interval_by_beats.unwrap_or(interval_by_noise),
                    beats,
                    is_fast: row.unit == RATE && FAST * mean * step_s > peak,
                })
            })
            .collect();
    }

    /// What noise does to the mean of a metric. Copies of the smooth tension with other noise show how it scatters. Copies of the
    /// tension itself have twice the variance of its noise, so they are moved further, by about the root of two where noise moves a
    /// metric in proportion (`cook_1994`). The noise of all beats is taken as one, so that many beats need few copies.
    fn by_noise(
        &self,
        found: &Analysis,
        stimuli: &Stimuli,
    ) -> impl Fn(&str) -> Option<Noise> + use<> {
        let normal = Distribution::Normal { mean: 0.0, standard_deviation: 1.0 };
        let frames = vec![normal; self.times_ms.len()];
        let beats = found.beats.len();
        let size = BEATS_OF_COPIES.div_ceil(beats.max(1)).max(COPIES);
        let draws = sample(&Sampler::LatinHypercube { size }, &frames, SEED);
        let draws: Vec<Vec<f64>> = draws.iter().flat_map(ParameterSample::iter).collect();
        let copies_of = |values: &[f64]| -> Vec<Analysis> {
            let copy = |draw: &Vec<f64>| {
                let noise = draw.iter().zip(&self.standard_deviation_kpa);
                let copy = values.iter().zip(noise).map(|(at, (draw, sigma))| at + draw * sigma);
                let copy: Vec<f64> = copy.collect();
                analysis(&self.times_ms, &copy, Kind::Tension, stimuli).ok()
            };
            // Of copies with other beats none is known to be the same.
            let is_same = |copy: &Analysis| copy.beats.len() == beats;
            draws.par_iter().filter_map(copy).filter(is_same).collect()
        };
        let (once, twice) = (copies_of(&found.read), copies_of(&self.unclipped_kpa));
        let read: Vec<_> = found.beats.iter().map(|beat| beat.metrics.clone()).collect();
        move |name| {
            let (mut squares, mut free, mut shifts) = (0.0, 0.0, Vec::new());
            for (beat, read) in read.iter().enumerate() {
                let of = |copies: &[Analysis]| -> Option<(Vec<f64>, f64)> {
                    let of = |copy: &Analysis| value(&copy.beats[beat].metrics, name);
                    let values: Vec<f64> = copies.iter().filter_map(of).collect();
                    let mean = values.iter().sum::<f64>() / values.len() as f64;
                    // Fewer say nothing of it.
                    (2 * values.len() >= size && values.len() > 1).then_some((values, mean))
                };
                let found = value(read, name).zip(of(&once)).zip(of(&twice));
                let Some(((read, (once, mean)), (_, of_twice))) = found else { continue };
                squares += once.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                free += once.len() as f64 - 1.0;
                shifts.push((of_twice - read) / (SQRT_2 - 1.0));
            }
            let counted = shifts.len() as f64;
            (counted > 0.0).then(|| Noise {
                shift: beyond_chance(&shifts),
                scatter: (squares / free / counted).sqrt(),
            })
        }
    }

    /// The mean of the whole beats, aligned by their onset.
    fn mean_of(&self, found: &Analysis) -> Option<MeanBeat> {
        let whole = found.beats.iter().filter(|beat| beat.state == State::Whole);
        let mut onsets: Vec<f64> = whole.filter_map(|beat| beat.onset_ms).collect();
        let (first, last) = (*self.times_ms.first()?, *self.times_ms.last()?);
        let intervals: Vec<f64> =
            found.beats.iter().filter_map(|beat| value(&beat.metrics, "interval")).collect();
        let onset = *onsets.first()?;
        let cycle = intervals.iter().copied().fold(f64::INFINITY, f64::min).min(last - onset);
        let before = (BEFORE * cycle).min(onset - first);
        let after = cycle - before;
        let step = (last - first) / (self.times_ms.len() - 1) as f64;
        onsets.retain(|onset| onset + after <= last + step && onset - before >= first - step);
        let beats = onsets.len();
        if beats == 0 || after <= 0.0 {
            return None;
        }
        let tension = MonotoneCubic::new(self.times_ms.clone(), self.unclipped_kpa.clone());
        let deviation =
            MonotoneCubic::new(self.times_ms.clone(), self.standard_deviation_kpa.clone());
        let count = beats as f64;
        let times_ms: Vec<f64> = (0..=((before + after) / step) as usize)
            .map(|number| number as f64 * step - before)
            .collect();
        let (mut means, mut errors) = (Vec::new(), Vec::new());
        for time in &times_ms {
            let all: Vec<f64> = onsets.iter().map(|onset| tension.at(onset + time)).collect();
            let mean = all.iter().sum::<f64>() / count;
            let squares: f64 = all.iter().map(|value| (value - mean).powi(2)).sum();
            means.push(mean.max(0.0));
            errors.push(if beats > 1 {
                (squares / (count - 1.0) / count).sqrt()
            } else {
                deviation.at(onset + time)
            });
        }
        Some(MeanBeat { times_ms, tension_kpa: means, standard_error_kpa: errors, beats })
    }
}

/// Median time between frames, ms.
fn median_step(times_ms: &[f64]) -> f64 {
    order::median(times_ms.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(0.0)
}

/// The size of the mean of values beyond that which their scatter explains.
fn beyond_chance(values: &[f64]) -> f64 {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    let by_chance = if count > 1.0 { squares / (count - 1.0) / count } else { 0.0 };
    (mean * mean - by_chance).max(0.0).sqrt()
}
