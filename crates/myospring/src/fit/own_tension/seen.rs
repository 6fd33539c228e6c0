//! A curve as shortening, with its rest and its noise.

use super::baseline::Baseline;
use super::beats::analysis;
use super::course::NORMAL;
use crate::analysis::kind::Kind;
use crate::fit::error::FitError;
use crate::fit::observed::{AT_REST, Observed, Scale};

/// Part of the frames at rest that noise takes below the band of no tension.
const BY_CHANCE: f64 = 0.025;
/// Times the noise that fits into the band that counts as rest, where that band shows all of it.
const SMALL: f64 = 4.0;
/// A cell is longer than at rest by chance up to this many standard deviations, in the worst of some hundred frames.
const LONGER: f64 = 2.5;

/// Standard deviation of the noise of a frame, from that which the whole curve shows: where it is small against the band
/// that counts as rest, the frames within that band tell it without the bends of the beats.
fn noise(observed: &Observed, whole: f64) -> f64 {
    match observed.frames() {
        Ok(frames) if SMALL * whole < AT_REST * frames.reach.abs() => frames.noise.min(whole),
        _ => whole,
    }
}

/// A curve as shortening, with its rest.
pub(super) struct Seen<'a> {
    pub(super) observed: &'a Observed,
    /// All frames with a value, ms.
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Whether each counts; the others are single bad frames.
    pub(super) used: Vec<bool>,
    /// Standard deviation of the noise of a frame, in the curve's unit.
    pub(super) noise: f64,
    pub(super) baseline: Baseline,
    /// Shortening of each frame, a part of the length at rest, and its standard deviation.
    pub(super) shortening: Vec<f64>,
    pub(super) deviation: Vec<f64>,
    /// Frames that are longer than before their beat, and by how much the length without tension is above that before a
    /// beat, a part of it: 0 where noise explains these frames.
    pub(super) longer: usize,
    pub(super) raised: f64,
}

impl<'a> Seen<'a> {
    pub(super) fn of(observed: &'a Observed) -> Result<Self, FitError> {
        if observed.scale == Scale::Arbitrary {
            return Err(FitError::NoHeight { name: observed.name.clone() });
        }
        let known = observed.times_ms.iter().zip(&observed.values);
        let (times, values): (Vec<f64>, Vec<f64>) = known
            .filter(|(_, value)| value.is_finite())
            .map(|(time, value)| (*time, *value))
            .unzip();
        let sign = if observed.scale == Scale::Length { -1.0 } else { 1.0 };
        let upwards: Vec<f64> = values.iter().map(|value| sign * value).collect();
        let analysis = analysis(&times, &upwards, Kind::Contraction, &observed.stimuli)
            .map_err(|cause| FitError::Curve { name: observed.name.clone(), cause })?;
        let mut used = vec![true; times.len()];
        for frame in &analysis.treatment.bad_frames {
            used[frame - 1] = false;
        }
        for artefact in &analysis.treatment.artefacts {
            used[artefact.frames[0] - 1..artefact.frames[1]].fill(false);
        }
        let range = upwards.iter().copied().fold(f64::NEG_INFINITY, f64::max)
            - upwards.iter().copied().fold(f64::INFINITY, f64::min);
        let noise = noise(observed, analysis.treatment.noise).max(1e-12 * range);
        let baseline = Baseline::of(&times, &values, &used, &analysis, noise)
            .ok_or_else(|| FitError::NoBeat { name: observed.name.clone() })?;
        let (mut shortening, mut deviation) = (Vec::new(), Vec::new());
        for (time, value) in times.iter().zip(&values) {
            let [rest, of_rest] = baseline.at(*time);
            let both = noise.hypot(of_rest);
            let (of, scale) = match observed.scale {
                Scale::Length => (1.0 - value / rest, rest.abs()),
                _ => ((value - rest) / 100.0, 100.0),
            };
            shortening.push(of);
            deviation.push(both / scale);
        }
        let longer = (0..times.len()).filter(|&at| used[at] && shortening[at] < 0.0).count();
        let (longer, raised) = (longer, 0.0);
        let mut seen = Self {
            observed,
            times,
            values,
            used,
            noise,
            baseline,
            shortening,
            deviation,
            longer,
            raised,
        };
        seen.raise();
        Ok(seen)
    }

    /// A cell that is longer than before its beat, more often than by chance, was not without tension then: no tension is
    /// where it is longest, and all shortening counts from there.
    fn raise(&mut self) {
        let used: Vec<usize> = (0..self.times.len()).filter(|&at| self.used[at]).collect();
        let below = |at: usize, by: f64| -self.shortening[at] - by * self.deviation[at];
        let far = used.iter().filter(|&&at| below(at, NORMAL) > 0.0).count() as f64;
        let chance = BY_CHANCE * used.len() as f64;
        if far <= chance + 3.0 * chance.sqrt().max(1.0) {
            return;
        }
        self.raised = used.iter().map(|&at| below(at, LONGER)).fold(0.0, f64::max);
        for at in 0..self.times.len() {
            self.shortening[at] = (self.shortening[at] + self.raised) / (1.0 + self.raised);
            self.deviation[at] /= 1.0 + self.raised;
        }
    }

    /// Relative standard deviation of the height of all beats by the noise of the frames, each of which counts.
    pub(super) fn noise_of_height(&self) -> f64 {
        let used = || (0..self.times.len()).filter(|&at| self.used[at]);
        let mean = used().map(|at| self.shortening[at]).sum::<f64>() / used().count() as f64;
        let seen = used().map(|at| ((self.shortening[at] - mean) / self.deviation[at]).powi(2));
        seen.sum::<f64>().sqrt().recip()
    }

    /// A shortening as the curve would show it.
    pub(super) fn value(&self, time: f64, shortening: f64) -> f64 {
        let [rest, _] = self.baseline.at(time);
        let shortening = shortening * (1.0 + self.raised) - self.raised;
        match self.observed.scale {
            Scale::Length => rest * (1.0 - shortening),
            _ => rest + 100.0 * shortening,
        }
    }
}
