//! Metrics of a tension that a curve asks for, its mean beat, and how sure both are.

use super::beats::analysis;
use super::course::{MeanBeat, NORMAL, OwnTension, TensionMetric};
use crate::analysis::curve::{Analysis, State};
use crate::analysis::kind::Kind;
use crate::analysis::monotone::MonotoneCubic;
use crate::analysis::{Spread, value};
use crate::fit::likelihood::rise_at_ends;
use crate::fit::observed::Stimuli;
use crate::study::sampling::{Distribution, ParameterSample, Sampler, sample};
use rayon::prelude::*;

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
const BEATS_OF_COPIES: usize = 40;
const COPIES: usize = 4;
const SEED: u64 = 1;
/// Fewest beats whose scatter is an interval.
const BEATS: usize = 3;
/// Part of the interval between beats that the mean beat has before its onset.
const BEFORE: f64 = 0.1;

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
        let rows = found.beats.iter().flat_map(|beat| &beat.metrics);
        let mut rows: Vec<_> = rows.filter(|row| STATED.contains(&row.name)).collect();
        rows.sort_by_key(|row| STATED.iter().position(|name| *name == row.name));
        rows.dedup_by_key(|row| row.name);
        self.metrics = rows
            .into_iter()
            .filter_map(|row| {
                let mean = found.mean(row.name)?;
                let standard_deviation = noise(row.name)?;
                let around = |by: f64| [mean - by, mean + by];
                let interval_by_noise = around(NORMAL * standard_deviation);
                let of_beats = spread.iter().find(|spread| spread.name == row.name);
                let beats = of_beats.map_or(1, |spread| spread.beats);
                let interval_by_beats =
                    of_beats.filter(|spread| spread.beats >= BEATS).map(|spread: &Spread| {
                        let count = spread.beats as f64;
                        let student = rise_at_ends(count - 1.0).sqrt();
                        around(student * spread.standard_deviation / count.sqrt())
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
                })
            })
            .collect();
    }

    /// Standard deviation of the mean of a metric, by copies of the smooth tension with other noise. The noise of all beats is
    /// taken as one, so that many beats need few copies.
    fn by_noise(
        &self,
        found: &Analysis,
        stimuli: &Stimuli,
    ) -> impl Fn(&str) -> Option<f64> + use<> {
        let normal = Distribution::Normal { mean: 0.0, standard_deviation: 1.0 };
        let frames = vec![normal; self.times_ms.len()];
        let beats = found.beats.len();
        let size = BEATS_OF_COPIES.div_ceil(beats.max(1)).max(COPIES);
        let draws = sample(&Sampler::LatinHypercube { size }, &frames, SEED);
        let draws: Vec<Vec<f64>> = draws.iter().flat_map(ParameterSample::iter).collect();
        let copy = |draw: &Vec<f64>| {
            let noise = draw.iter().zip(&self.standard_deviation_kpa);
            let copy = found.read.iter().zip(noise).map(|(at, (draw, sigma))| at + draw * sigma);
            let copy: Vec<f64> = copy.collect();
            analysis(&self.times_ms, &copy, Kind::Tension, stimuli).ok()
        };
        let copies: Vec<Analysis> = draws.par_iter().filter_map(copy).collect();
        move |name| {
            // Of copies with other beats none is known to be the same.
            let same: Vec<&Analysis> =
                copies.iter().filter(|copy| copy.beats.len() == beats).collect();
            let (mut squares, mut free, mut counted) = (0.0, 0.0, 0.0);
            for beat in 0..beats {
                let of = |copy: &&Analysis| value(&copy.beats[beat].metrics, name);
                let values: Vec<f64> = same.iter().filter_map(of).collect();
                let count = values.len() as f64;
                // Fewer say nothing of it.
                if 2 * values.len() < size || values.len() < 2 {
                    continue;
                }
                let mean = values.iter().sum::<f64>() / count;
                squares += values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
                (free, counted) = (free + count - 1.0, counted + 1.0);
            }
            (counted > 0.0).then(|| (squares / free / counted).sqrt())
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
