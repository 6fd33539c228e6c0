//! What `analyse` writes.

use super::Read;
use crate::failure::Failure;
use crate::table::number;
use myospring::analysis::curve::{Analysis, CurveBeat, Treatment};
use myospring::analysis::{Metric, Missing, Spread};
use myospring::output::figure::{Figure, FigureError, Measured, measured};
use myospring::output::table::{Column, Table, column_name};
use serde::Serialize;
use std::collections::{BTreeMap, BTreeSet};

/// summary.json.
#[derive(Serialize)]
pub(crate) struct Record<'a> {
    version: &'static str,
    notes: &'a [String],
    curves: Vec<OfCurve<'a>>,
}

#[derive(Serialize)]
struct OfCurve<'a> {
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
pub(crate) struct Mean {
    pub(crate) name: &'static str,
    pub(crate) mean: Option<f64>,
    /// None of one beat.
    pub(crate) standard_deviation: Option<f64>,
    pub(crate) beats: usize,
    pub(crate) unit: &'static str,
    pub(crate) definition: &'static str,
    /// Why no beat that counts has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) missing: Option<Missing>,
}

/// The metrics of a curve over the beats that count, in the order of reading.
pub(crate) fn means(analysis: &Analysis) -> Vec<Mean> {
    let spread = analysis.spread();
    let beats = analysis.counted();
    let mut means: Vec<Mean> = Vec::new();
    for metric in beats.iter().flatten() {
        if means.iter().any(|mean| mean.name == metric.name) {
            continue;
        }
        let of: Option<&Spread> = spread.iter().find(|spread| spread.name == metric.name);
        let shown = beats
            .iter()
            .filter(|beat| myospring::analysis::value(beat, metric.name).is_some())
            .count();
        means.push(Mean {
            name: metric.name,
            mean: analysis.mean(metric.name),
            standard_deviation: of.map(|spread| spread.standard_deviation),
            beats: shown,
            unit: metric.unit,
            definition: metric.definition,
            missing: metric.missing.filter(|_| shown == 0),
        });
    }
    // Times on the clock differ by the interval: their mean says nothing.
    means.retain(|mean| !mean.name.starts_with("time_of_"));
    means
}

impl<'a> Record<'a> {
    pub(crate) fn of(all: &'a [Read], notes: &'a [String]) -> Self {
        let curves = all.iter().map(|read| {
            let found = read.found.as_ref();
            OfCurve {
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
        Self { version: env!("CARGO_PKG_VERSION"), notes, curves: curves.collect() }
    }
}

/// How baseline, drift and smoothing were treated, in one field.
pub(crate) fn conventions(treatment: &Treatment) -> String {
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
        parts.push(format!("hum of {frequency:.2} Hz taken off, amplitude {amplitude:.4}"));
    }
    parts.join("; ")
}

fn text(name: &str, values: impl Iterator<Item = String>) -> Column {
    let values = values.map(|value| Some(value).filter(|value| !value.is_empty()));
    Column::Text { name: name.to_owned(), values: values.collect() }
}

/// metrics.csv: a row for each beat.
pub(crate) fn metrics(all: &[Read]) -> Result<Vec<u8>, Failure> {
    let rows: Vec<(&Read, &Analysis, &CurveBeat)> = all
        .iter()
        .filter_map(|read| Some((read, read.found.as_ref().ok()?)))
        .flat_map(|(read, analysis)| analysis.beats.iter().map(move |beat| (read, analysis, beat)))
        .collect();
    let number = |name: &str, of: &dyn Fn(&CurveBeat) -> Option<f64>| Column::Number {
        name: name.to_owned(),
        values: rows.iter().map(|(_, _, beat)| of(beat)).collect(),
    };
    let mut columns = vec![
        text("file", rows.iter().map(|(read, ..)| read.file.clone())),
        text("curve", rows.iter().map(|(read, ..)| read.curve.name.clone())),
        text("kind", rows.iter().map(|(read, ..)| read.curve.kind.word().to_owned())),
        number("beat", &|beat| Some(beat.number as f64)),
        text("state", rows.iter().map(|(_, _, beat)| beat.state.words().to_owned())),
        number("time_of_stimulus_ms", &|beat| beat.stimulus_ms),
    ];
    let mut named: Vec<(&'static str, &'static str)> = Vec::new();
    for metric in rows.iter().flat_map(|(_, _, beat)| &beat.metrics) {
        if !named.contains(&(metric.name, metric.unit)) {
            named.push((metric.name, metric.unit));
        }
    }
    columns.extend(named.into_iter().map(|(name, unit)| {
        let is = |metric: &&Metric| (metric.name, metric.unit) == (name, unit);
        number(&column_name(name, unit), &|beat: &CurveBeat| beat.metrics.iter().find(is)?.value)
    }));
    let missing = |beat: &CurveBeat| {
        let why = |metric: &Metric| Some(format!("{}: {}", metric.name, metric.missing?.words()));
        beat.metrics.iter().filter_map(why).collect::<Vec<_>>().join("; ")
    };
    columns.push(text("not_read", rows.iter().map(|(_, _, beat)| missing(beat))));
    columns.push(text("remarks", rows.iter().map(|(_, _, beat)| beat.remarks.join("; "))));
    columns.push(text(
        "conventions",
        rows.iter().map(|(_, analysis, _)| conventions(&analysis.treatment)),
    ));
    Ok(Table { columns }.for_people().to_csv()?)
}

/// summary.csv: a row for each metric of each curve.
pub(crate) fn summary(all: &[Read]) -> Result<Vec<u8>, Failure> {
    let mut rows: Vec<(&Read, Mean)> = Vec::new();
    for read in all {
        if let Ok(analysis) = &read.found {
            rows.extend(means(analysis).into_iter().map(|mean| (read, mean)));
        } else {
            let (unit, definition) = ("", "");
            let none = Mean {
                name: "",
                mean: None,
                standard_deviation: None,
                beats: 0,
                unit,
                definition,
                missing: None,
            };
            rows.push((read, none));
        }
    }
    let number = |name: &str, of: &dyn Fn(&Mean) -> Option<f64>| Column::Number {
        name: name.to_owned(),
        values: rows.iter().map(|(_, mean)| of(mean)).collect(),
    };
    let of = |of: fn(&Mean) -> &'static str| {
        rows.iter().map(move |(_, mean)| of(mean).to_owned()).collect::<Vec<_>>()
    };
    let conventions = |read: &Read| match &read.found {
        Ok(analysis) => conventions(&analysis.treatment),
        Err(_) => String::new(),
    };
    let columns = vec![
        text("file", rows.iter().map(|(read, _)| read.file.clone())),
        text("curve", rows.iter().map(|(read, _)| read.curve.name.clone())),
        text("kind", rows.iter().map(|(read, _)| read.curve.kind.word().to_owned())),
        text("metric", of(|mean| mean.name).into_iter()),
        number("mean", &|mean| mean.mean),
        number("standard_deviation", &|mean| mean.standard_deviation),
        number("beats", &|mean| Some(mean.beats as f64)),
        text("unit", of(|mean| mean.unit).into_iter()),
        text("definition", of(|mean| mean.definition).into_iter()),
        text("conventions", rows.iter().map(|(read, _)| conventions(read))),
        text(
            "not_read",
            rows.iter().map(|(_, mean)| {
                mean.missing.map_or_else(String::new, |why| why.words().to_owned())
            }),
        ),
        text(
            "error",
            rows.iter().map(|(read, _)| read.found.as_ref().err().cloned().unwrap_or_default()),
        ),
    ];
    Ok(Table { columns }.for_people().to_csv()?)
}

/// Letters of a figure's name at most: file systems take 255 bytes, a letter has up to four, and a number and an ending follow.
const LONGEST_NAME: usize = 50;

/// Names of the figures, one for each curve: its column's, with its file's where there are several files. No two are the same,
/// not even to a file system that takes `A` for `a`.
pub(crate) fn figure_names(all: &[Read]) -> Vec<String> {
    let several = all.iter().any(|read| read.file != all[0].file);
    let titles =
        all.iter().map(|read| if several { read.title() } else { read.curve.name.clone() });
    file_names(titles)
}

fn file_names(titles: impl Iterator<Item = String>) -> Vec<String> {
    let mut taken = BTreeSet::new();
    // The number that the next curve of a name gets.
    let mut next = BTreeMap::<String, usize>::new();
    let safe = |letter: char| {
        if letter.is_alphanumeric() || "-.".contains(letter) { letter } else { '_' }
    };
    let name = |title: String| {
        let name: String = title.chars().map(safe).take(LONGEST_NAME).collect();
        let name = format!("trace_{}", name.trim_matches(['_', '.']));
        let number = next.entry(name.to_lowercase()).or_insert(1);
        let mut own = name.clone();
        while !taken.insert(own.to_lowercase()) {
            *number += 1;
            own = format!("{name}_{number}");
        }
        own
    };
    titles.map(name).collect()
}

/// Metrics that stand beside a figure, as far as a curve has them.
const BESIDE: [&str; 24] = [
    "interval",
    "resting_length",
    "baseline",
    "resting_tension",
    "diastolic_level",
    "resting_potential",
    "peak_shortening",
    "peak_amplitude",
    "developed_tension",
    "transient_amplitude",
    "amplitude_over_rest",
    "action_potential_amplitude",
    "time_to_peak_from_stimulus",
    "time_to_peak_from_onset",
    "time_to_peak_tension_from_onset",
    "rise_time_10_90",
    "relaxation_time_50",
    "tension_relaxation_time_50",
    "decay_time_50",
    "relaxation_time_90",
    "decay_time_90",
    "action_potential_duration_90",
    "maximum_shortening_rate",
    "relaxation_time_constant",
];

/// The figure of a curve.
pub(crate) fn figure(read: &Read, analysis: &Analysis) -> Result<Figure, FigureError> {
    let means = means(analysis);
    let line = |name: &str| {
        let mean = means.iter().find(|mean| mean.name == name)?;
        Some([in_words(mean.name), printed(&value(mean)?)])
    };
    let numbers: Vec<[String; 2]> = BESIDE.iter().filter_map(|name| line(name)).collect();
    measured(&Measured {
        title: &read.title(),
        kind: read.curve.kind,
        unit: read.curve.unit,
        times_ms: &read.curve.times_ms,
        values: &read.curve.values,
        analysis,
        numbers: &numbers,
    })
}

/// The name of a metric beside a figure: `rise time 10–90 %`, `APD90`.
fn in_words(metric: &str) -> String {
    if let Some(part) = metric.strip_prefix("action_potential_duration_") {
        return format!("APD{part}");
    }
    let name = metric.replace("10_90", "10\u{2013}90").replace('_', " ");
    let is_part = name.ends_with(|letter: char| letter.is_ascii_digit());
    if is_part { name + " %" } else { name }
}

/// A value with real minus signs and units as they are printed.
fn printed(value: &str) -> String {
    // The font of figures has no subscript 0.
    [("-", "\u{2212}"), ("um", "\u{b5}m"), ("uM", "\u{b5}M")]
        .iter()
        .fold(value.to_owned(), |text, (written, sign)| text.replace(written, sign))
}

/// `9.81 ± 0.12 %`; `None` where no beat shows it.
pub(crate) fn value(mean: &Mean) -> Option<String> {
    let spread = mean.standard_deviation.map(|spread| format!(" \u{b1} {}", number(spread)));
    Some(
        format!("{}{} {}", number(mean.mean?), spread.unwrap_or_default(), mean.unit)
            .trim_end()
            .to_owned(),
    )
}

#[cfg(test)]
mod tests {
    use super::{in_words, printed};

    #[test]
    fn numbers_beside_a_figure_have_the_words_of_people() {
        assert_eq!(in_words("rise_time_10_90"), "rise time 10\u{2013}90 %");
        assert_eq!(in_words("relaxation_time_50"), "relaxation time 50 %");
        assert_eq!(in_words("action_potential_duration_90"), "APD90");
        assert_eq!(in_words("peak_shortening"), "peak shortening");
        assert_eq!(printed("-72.22 mV"), "\u{2212}72.22 mV");
        assert_eq!(printed("1.63 \u{b1} 0.02 um"), "1.63 \u{b1} 0.02 \u{b5}m");
    }
}
