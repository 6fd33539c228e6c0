//! A curve prepared for a fit: which frames count, their noise, where beats begin.

use super::error::{FitError, MOST_SHORTENING_PCT};
use crate::analysis::curve::{Analysis, CurveOptions, State, analyse};
use crate::analysis::kind::Kind;
use crate::analysis::order;
use crate::measured::Curve;

/// Frames at rest that an estimate of the noise needs.
const ENOUGH: usize = 12;
/// A frame is at rest if it is within this part of the range from the resting level.
pub(super) const AT_REST: f64 = 0.12;
/// Standard deviation of a normal distribution over its median absolute value.
const FROM_MEDIAN: f64 = 1.4826;
/// Variance of `y_- - 2 y + y_+` over that of the noise.
const SECOND_DIFFERENCE: f64 = 6.0;

/// The quantity that a curve measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Scale {
    /// A length, in any unit: of the cell, of a sarcomere, over a length of reference. It falls in
    /// a beat.
    Length,
    /// Shortening in % of the length at rest.
    Percent,
    /// Contraction in arbitrary units: its height has no meaning.
    Arbitrary,
    /// What the cell does to its support, by the name of the signal, such as
    /// [`AXIAL_FORCE`](crate::recording::AXIAL_FORCE): a force in nN, a moment or energy in fJ.
    #[serde(untagged)]
    Load(&'static str),
}

/// When the cell was stimulated.
#[derive(Debug, Clone, PartialEq)]
pub enum Stimuli {
    /// At these times, ms; one delay is common to all.
    Given(Vec<f64>),
    /// The approximate onset of each beat, ms, found in the curve; each has its own delay.
    Seen(Vec<f64>),
    /// The calcium of the whole recording is known on the clock of the curve, so that no delay is sought.
    Clocked {
        /// When that calcium begins, ms.
        from: [f64; 1],
        /// The number of beats of the curve.
        beats: usize,
    },
}

impl Stimuli {
    pub(super) fn times(&self) -> &[f64] {
        match self {
            Self::Given(times) | Self::Seen(times) => times,
            Self::Clocked { from, .. } => from,
        }
    }

    /// The number of beats.
    pub(super) fn beats(&self) -> usize {
        match self {
            Self::Given(times) | Self::Seen(times) => times.len(),
            Self::Clocked { beats, .. } => *beats,
        }
    }
}

/// A curve that was measured.
#[derive(Debug, Clone, PartialEq)]
pub struct Observed {
    /// What it is called.
    pub name: String,
    /// Times of its frames, ms, ascending.
    pub times_ms: Vec<f64>,
    /// Its values; NaN where a frame has none.
    pub values: Vec<f64>,
    /// The quantity.
    pub scale: Scale,
    /// Their unit, for people.
    pub unit: String,
    /// When the cell was stimulated.
    pub stimuli: Stimuli,
}

/// Frames of a curve, their noise and their resting level.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frames {
    /// Those with a value.
    pub(super) times: Vec<f64>,
    pub(super) values: Vec<f64>,
    /// Places of these among all frames.
    pub(super) places: Vec<usize>,
    /// Standard deviation of the noise of a frame.
    pub(super) noise: f64,
    /// Level at rest, and how far the curve goes from it: negative for a length.
    pub(super) rest: f64,
    pub(super) reach: f64,
}

/// Stimuli are assumed this long before the onset of a beat, ms.
const BEFORE_RISE: f64 = 20.0;

impl Observed {
    /// Prepares a curve of a file: of lengths, shortening or another motion. Without stimuli, given
    /// or marked in the file, its beats are found. A partial beat before the first whole one is
    /// left out. A curve in arbitrary units becomes a shortening, %, if `peak_shortening_pct` says how far the cell shortens
    /// at its peak.
    ///
    /// # Errors
    ///
    /// A curve of any other kind, or without a beat; a peak shortening out of bounds, or of a curve that has a height.
    pub fn of(
        curve: &Curve,
        stimuli_ms: Option<&[f64]>,
        peak_shortening_pct: Option<f64>,
    ) -> Result<Self, FitError> {
        let scale = match curve.kind {
            Kind::Length | Kind::SarcomereLength | Kind::NormalisedLength => Scale::Length,
            Kind::Shortening => Scale::Percent,
            Kind::Contraction if curve.unit == "%" => Scale::Percent,
            Kind::Contraction | Kind::Unknown => Scale::Arbitrary,
            kind => {
                let (name, kind) = (curve.name.clone(), kind.to_string());
                return Err(FitError::Kind { name, kind });
            }
        };
        let (observed, analysis) = Self::of_scale(curve, stimuli_ms, scale)?;
        match peak_shortening_pct {
            Some(percent) => observed.with_peak(percent, &analysis),
            None => Ok(observed),
        }
    }

    /// Prepares a curve of what the cell does to its support, by the name of the signal ([`Scale::Load`]), in nN or fJ.
    ///
    /// # Errors
    ///
    /// A curve without a beat.
    pub fn of_load(
        curve: &Curve,
        stimuli_ms: Option<&[f64]>,
        load: &'static str,
    ) -> Result<Self, FitError> {
        Self::of_scale(curve, stimuli_ms, Scale::Load(load)).map(|(observed, _)| observed)
    }

    fn of_scale(
        curve: &Curve,
        stimuli_ms: Option<&[f64]>,
        scale: Scale,
    ) -> Result<(Self, Analysis), FitError> {
        let name = || curve.name.clone();
        let marked = Some(curve.stimuli_ms.as_slice()).filter(|marked| !marked.is_empty());
        let stimuli_ms = stimuli_ms.or(marked);
        let options = CurveOptions {
            stimuli_ms: stimuli_ms.unwrap_or_default().to_vec(),
            ..CurveOptions::default()
        };
        let analysis = analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options)
            .map_err(|cause| FitError::Curve { name: name(), cause })?;
        let mut values = curve.values.clone();
        // Artefacts are not fitted.
        for artefact in &analysis.treatment.artefacts {
            let [from, to] = artefact.frames;
            values[from - 1..to].fill(f64::NAN);
        }
        // An unknown curve that falls in a beat is an inverted contraction.
        if scale == Scale::Arbitrary && !analysis.treatment.rises {
            for value in &mut values {
                *value = -*value;
            }
        }
        // The remaining frames of a beat with an artefact or a hole are used.
        let whole = |state: State| !matches!(state, State::CutAtStart | State::Missed);
        let beats: Vec<f64> = analysis
            .beats
            .iter()
            .filter(|beat| whole(beat.state))
            .filter_map(|beat| Some(beat.onset_ms? - BEFORE_RISE))
            .collect();
        let first = beats.first().copied().ok_or_else(|| FitError::NoBeat { name: name() })?;
        if analysis.beats.iter().any(|beat| beat.state == State::CutAtStart) {
            for (value, time) in values.iter_mut().zip(&curve.times_ms) {
                if *time < first {
                    *value = f64::NAN;
                }
            }
        }
        let stimuli = match stimuli_ms {
            Some(times) => Stimuli::Given(times.to_vec()),
            None => Stimuli::Seen(beats),
        };
        let (times_ms, unit) = (curve.times_ms.clone(), curve.unit.to_owned());
        Ok((Self { name: name(), times_ms, values, scale, unit, stimuli }, analysis))
    }

    /// The frames of the first beats.
    pub(super) fn first_beats(&self, beats: usize) -> Self {
        let stimuli = self.stimuli.times();
        let Some(end) = stimuli.get(beats) else { return self.clone() };
        let frames = self.times_ms.partition_point(|time| time < end).min(self.values.len());
        Self {
            times_ms: self.times_ms[..frames].to_vec(),
            values: self.values[..frames].to_vec(),
            stimuli: Stimuli::Given(stimuli[..beats].to_vec()),
            ..self.clone()
        }
    }

    /// The shortening, %, of a curve in arbitrary units whose mean beat is this high.
    fn with_peak(self, percent: f64, analysis: &Analysis) -> Result<Self, FitError> {
        if self.scale != Scale::Arbitrary {
            return Err(FitError::HasHeight { name: self.name });
        }
        if !(percent > 0.0 && percent <= MOST_SHORTENING_PCT) {
            return Err(FitError::PeakShortening { percent });
        }
        let no_beat = || FitError::NoBeat { name: self.name.clone() };
        let height = analysis.mean("peak_amplitude").filter(|height| *height > 0.0);
        let share = percent / height.ok_or_else(no_beat)?;
        let levels = analysis.beats.iter().filter_map(|beat| Some(beat.baseline?[0].value));
        let rest = order::median(levels).ok_or_else(no_beat)?;
        let rest = if analysis.treatment.rises { rest } else { -rest };
        let values = self.values.into_iter().map(|value| share * (value - rest)).collect();
        Ok(Self { values, scale: Scale::Percent, unit: "%".to_owned(), ..self })
    }

    /// Stretches without a value between frames that have one: first and last time, ms.
    pub(super) fn gaps(&self) -> Vec<[f64; 2]> {
        let known: Vec<bool> = self.values.iter().map(|value| value.is_finite()).collect();
        let from = known.iter().position(|known| *known).unwrap_or(0);
        let to = known.iter().rposition(|known| *known).unwrap_or(0);
        let mut gaps: Vec<[f64; 2]> = Vec::new();
        for at in (from..to).filter(|at| !known[*at]) {
            match gaps.last_mut() {
                Some(gap) if !known[at - 1] => gap[1] = self.times_ms[at],
                _ => gaps.push([self.times_ms[at]; 2]),
            }
        }
        gaps
    }

    pub(super) fn frames(&self) -> Result<Frames, FitError> {
        let name = || self.name.clone();
        if self.times_ms.len() != self.values.len() {
            return Err(FitError::Frames { name: name(), frames: self.values.len() });
        }
        let known = self.times_ms.iter().zip(&self.values).enumerate();
        let known: Vec<(usize, f64, f64)> = known
            .filter(|(_, (_, value))| value.is_finite())
            .map(|(place, (time, value))| (place, *time, *value))
            .collect();
        let places: Vec<usize> = known.iter().map(|known| known.0).collect();
        let times: Vec<f64> = known.iter().map(|known| known.1).collect();
        let values: Vec<f64> = known.iter().map(|known| known.2).collect();
        if values.len() < ENOUGH {
            return Err(FitError::Frames { name: name(), frames: values.len() });
        }
        if self.stimuli.times().is_empty() {
            return Err(FitError::NoBeat { name: name() });
        }
        // A length is at its maximum at rest, all else at its minimum.
        let sign = if self.scale == Scale::Length { -1.0 } else { 1.0 };
        let mut upwards: Vec<f64> = values.iter().map(|value| sign * value).collect();
        upwards.sort_by(f64::total_cmp);
        let part = |part: f64| upwards[(part * (upwards.len() - 1) as f64).round() as usize];
        let (low, high) = (part(0.1), part(0.99));
        let range = high - low;
        if range.is_nan() || range <= 0.0 {
            return Err(FitError::NoBeat { name: name() });
        }
        let rests: Vec<bool> =
            values.iter().map(|value| sign * value < low + AT_REST * range).collect();
        let noise = noise(&values, &rests).max(1e-9 * range);
        let mut resting: Vec<f64> = values
            .iter()
            .zip(&rests)
            .filter(|(_, rests)| **rests)
            .map(|(value, _)| *value)
            .collect();
        resting.sort_by(f64::total_cmp);
        let rest = resting[resting.len() / 2];
        Ok(Frames { times, values, places, noise, rest, reach: sign * high - rest })
    }
}

/// Standard deviation of the noise, from the differences between frames at rest and the line
/// through their neighbours; from all frames if too few are at rest.
fn noise(values: &[f64], rests: &[bool]) -> f64 {
    let bent = |at: usize| (values[at - 1] - 2.0 * values[at] + values[at + 1]).abs();
    let inner = 1..values.len() - 1;
    let still = |at: &usize| rests[at - 1..=at + 1].iter().all(|rests| *rests);
    let mut found: Vec<f64> = inner.clone().filter(still).map(bent).collect();
    if found.len() < ENOUGH {
        found = inner.map(bent).collect();
    }
    found.sort_by(f64::total_cmp);
    FROM_MEDIAN * found[found.len() / 2] / SECOND_DIFFERENCE.sqrt()
}
