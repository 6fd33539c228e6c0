//! What was read of curves, in numbers.

use super::curve::AnalysedCurve;
use super::pairs::PairedCurves;
use crate::analysis::curve::{Analysis, CurveBeat, Treatment};
use crate::analysis::paired::{Direction, PairedBeat};
use crate::analysis::{self, Metric, Missing, Spread, beat_to_beat};
use crate::experiment::legible::number;
use serde::Serialize;

/// The metrics that a reader looks at first; of the alternatives in a row, the one that the curve has.
pub const KEY: [(&str, &[&str]); 6] = [
    ("interval", &["interval"]),
    (
        "at rest",
        &["resting_length", "baseline", "resting_tension", "diastolic_level", "resting_potential"],
    ),
    (
        "amplitude",
        &[
            "peak_shortening",
            "peak_amplitude",
            "developed_tension",
            "transient_amplitude",
            "action_potential_amplitude",
        ],
    ),
    (
        "time to peak",
        &[
            "time_to_peak_from_stimulus",
            "time_to_peak_tension",
            "time_to_peak_from_onset",
            "time_to_peak_tension_from_onset",
        ],
    ),
    (
        "half back",
        &[
            "relaxation_time_50",
            "tension_relaxation_time_50",
            "decay_time_50",
            "action_potential_duration_50",
        ],
    ),
    (
        "90 % back",
        &[
            "relaxation_time_90",
            "tension_relaxation_time_90",
            "decay_time_90",
            "action_potential_duration_90",
        ],
    ),
];

/// All numbers of an analysis: `summary.json`.
#[derive(Serialize)]
pub struct AnalysisRecord<'a> {
    version: &'static str,
    notes: &'a [String],
    curves: Vec<CurveRecord<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pairs: Vec<PairRecord<'a>>,
}

/// Calcium and a motion of the same beats.
#[derive(Serialize)]
struct PairRecord<'a> {
    calcium: CurveName<'a>,
    motion: CurveName<'a>,
    /// Unit of the motion in the loops.
    motion_unit: &'static str,
    direction: Direction,
    remarks: &'a [String],
    metrics: Vec<Mean>,
    mean_loop: Option<LoopRecord<'a>>,
    beats: &'a [PairedBeat],
}

#[derive(Serialize)]
struct CurveName<'a> {
    file: &'a str,
    curve: &'a str,
    kind: &'static str,
    unit: &'a str,
}

#[derive(Serialize)]
struct LoopRecord<'a> {
    times_ms: &'a [f64],
    calcium: &'a [f64],
    motion: &'a [f64],
}

#[derive(Serialize)]
struct CurveRecord<'a> {
    file: &'a str,
    curve: &'a str,
    kind: &'static str,
    unit: &'a str,
    frames: usize,
    frame_rate_per_s: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
    #[serde(skip_serializing_if = "Option::is_none")]
    treatment: Option<&'a Treatment>,
    remarks: &'a [String],
    metrics: Vec<Mean>,
    beats: &'a [CurveBeat],
}

/// A metric over the beats that count.
#[derive(Debug, Clone, Serialize)]
#[allow(clippy::struct_field_names, reason = "`mean` is what the file calls it")]
pub struct Mean {
    /// Its name.
    pub name: &'static str,
    /// The mean; none where no beat shows it.
    pub mean: Option<f64>,
    /// Over beats; none of one beat.
    pub standard_deviation: Option<f64>,
    /// Beats that show it.
    pub beats: usize,
    /// Its unit.
    pub unit: &'static str,
    /// What it is.
    pub definition: &'static str,
    /// Why no beat that counts has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub missing: Option<Missing>,
}

/// The metrics of a curve over the beats that count, in the order of reading.
pub fn means(analysis: &Analysis) -> Vec<Mean> {
    means_of(&analysis.counted())
}

/// The metrics of some beats over all of them, in the order of reading.
pub fn means_of(beats: &[Vec<Metric>]) -> Vec<Mean> {
    let spread = beat_to_beat(beats);
    let mut means: Vec<Mean> = Vec::new();
    for metric in beats.iter().flatten() {
        if means.iter().any(|mean| mean.name == metric.name) {
            continue;
        }
        let of: Option<&Spread> = spread.iter().find(|spread| spread.name == metric.name);
        let values: Vec<f64> =
            beats.iter().filter_map(|beat| analysis::value(beat, metric.name)).collect();
        let shown = values.len();
        means.push(Mean {
            name: metric.name,
            mean: (shown > 0).then(|| values.iter().sum::<f64>() / shown as f64),
            standard_deviation: of.map(|spread| spread.standard_deviation),
            beats: shown,
            unit: metric.unit,
            definition: metric.definition,
            missing: metric.missing.filter(|_| shown == 0),
        });
    }
    // Times on the clock differ by the interval, so their mean has no meaning.
    means.retain(|mean| !mean.name.starts_with("time_of_"));
    means
}

impl<'a> AnalysisRecord<'a> {
    pub(super) fn of(
        all: &'a [AnalysedCurve],
        pairs: &'a [PairedCurves],
        notes: &'a [String],
    ) -> Self {
        let curves = all.iter().map(|read| {
            let found = read.found.as_ref();
            CurveRecord {
                file: &read.file,
                curve: &read.curve.name,
                kind: read.curve.kind.word(),
                unit: read.curve.unit,
                frames: read.curve.values.len(),
                frame_rate_per_s: read.curve.frame_rate_per_s(),
                error: found.err().map(String::as_str),
                treatment: found.ok().map(|analysis| &analysis.treatment),
                remarks: found.map_or(&[], |analysis| &analysis.remarks),
                metrics: found.map_or_else(|_| Vec::new(), means),
                beats: found.map_or(&[], |analysis| &analysis.beats),
            }
        });
        let name = |at: usize| {
            let AnalysedCurve { file, curve, .. } = &all[at];
            CurveName { file, curve: &curve.name, kind: curve.kind.word(), unit: curve.unit }
        };
        let pairs = pairs.iter().map(|PairedCurves { calcium, motion, paired }| PairRecord {
            calcium: name(*calcium),
            motion: name(*motion),
            motion_unit: paired.motion_unit,
            direction: paired.direction,
            remarks: &paired.remarks,
            metrics: means_of(&paired.counted()),
            mean_loop: paired.mean_loop.as_ref().map(|mean| LoopRecord {
                times_ms: &mean.times_ms,
                calcium: &mean.calcium,
                motion: &mean.motion,
            }),
            beats: &paired.beats,
        });
        Self {
            version: env!("CARGO_PKG_VERSION"),
            notes,
            curves: curves.collect(),
            pairs: pairs.collect(),
        }
    }
}

/// How baseline, drift and smoothing were treated, in one field.
pub fn conventions(treatment: &Treatment) -> String {
    let mut parts = vec![
        format!("baseline: {}", treatment.baseline),
        format!("drift: {}", treatment.drift),
        format!("smoothing: {}", treatment.smoothing),
        format!("rates: {}", treatment.rates),
    ];
    if !treatment.bad_frames.is_empty() {
        let frames: Vec<String> = treatment.bad_frames.iter().map(usize::to_string).collect();
        parts.push(format!("bad frames replaced: {}", frames.join(" ")));
    }
    if !treatment.artefacts.is_empty() {
        let times: Vec<String> = treatment
            .artefacts
            .iter()
            .map(|artefact| format!("{:.0}-{:.0}", artefact.from_ms, artefact.to_ms))
            .collect();
        parts.push(format!("artefacts left out, ms: {}", times.join(" ")));
    }
    if !treatment.holes.is_empty() {
        let times: Vec<String> = treatment
            .holes
            .iter()
            .map(|hole| format!("{:.0}-{:.0}", hole.from_ms, hole.to_ms))
            .collect();
        parts.push(format!("frames are missing, ms: {}", times.join(" ")));
    }
    if let Some([frequency, amplitude]) = treatment.hum {
        parts.push(format!("hum of {frequency:.2} Hz removed, amplitude {amplitude:.4}"));
    }
    parts.join("; ")
}

impl Mean {
    /// The first of these metrics that has a value.
    pub fn first<'a>(means: &'a [Self], names: &[&str]) -> Option<&'a Self> {
        means.iter().find(|mean| names.contains(&mean.name) && mean.mean.is_some())
    }

    /// `9.81 ± 0.12 %`; `None` where no beat shows it.
    pub fn in_words(&self) -> Option<String> {
        let spread = self.standard_deviation.map(|spread| format!(" \u{b1} {}", number(spread)));
        Some(
            format!("{}{} {}", number(self.mean?), spread.unwrap_or_default(), self.unit)
                .trim_end()
                .to_owned(),
        )
    }
}
