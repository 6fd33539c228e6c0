//! Tables of beats and of metrics.

use super::curve::AnalysedCurve;
use super::pairs::PairedCurves;
use super::record::{Mean, conventions, means};
use crate::analysis::Metric;
use crate::analysis::curve::{Analysis, CurveBeat};
use crate::analysis::paired::PairedBeat;
use crate::experiment::error::ExperimentError;
use crate::output::table::{Column, Table, column_name};

fn text(name: &str, values: impl Iterator<Item = String>) -> Column {
    let values = values.map(|value| Some(value).filter(|value| !value.is_empty()));
    Column::Text { name: name.to_owned(), values: values.collect() }
}

/// Names and units of metrics, each once.
fn named<'a>(metrics: impl Iterator<Item = &'a Metric>) -> Vec<(&'static str, &'static str)> {
    let mut named = Vec::new();
    for metric in metrics {
        if !named.contains(&(metric.name, metric.unit)) {
            named.push((metric.name, metric.unit));
        }
    }
    named
}

/// The metrics without a value, each with its reason.
fn missing(metrics: &[Metric]) -> String {
    let why = |metric: &Metric| Some(format!("{}: {}", metric.name, metric.missing?.words()));
    metrics.iter().filter_map(why).collect::<Vec<_>>().join("; ")
}

/// pairs.csv: a row for each beat of calcium and motion that were recorded together.
pub(in crate::experiment) fn pairs(
    all: &[AnalysedCurve],
    pairs: &[PairedCurves],
) -> Result<Vec<u8>, ExperimentError> {
    let rows: Vec<(&PairedCurves, &PairedBeat)> = pairs
        .iter()
        .flat_map(|pair| pair.paired.beats.iter().map(move |beat| (pair, beat)))
        .collect();
    let number = |name: &str, of: &dyn Fn(&PairedBeat) -> Option<f64>| Column::Number {
        name: name.to_owned(),
        values: rows.iter().map(|(_, beat)| of(beat)).collect(),
    };
    let mut columns = names(all, rows.iter().map(|(pair, _)| *pair));
    columns.extend([
        number("beat", &|beat| Some(beat.number as f64)),
        number("beat_of_calcium", &|beat| Some(beat.calcium_beat? as f64)),
        number("beat_of_motion", &|beat| Some(beat.motion_beat? as f64)),
        text(
            "counts",
            rows.iter().map(|(_, beat)| if beat.counts { "yes" } else { "no" }.to_owned()),
        ),
    ]);
    let named = named(rows.iter().flat_map(|(_, beat)| &beat.metrics));
    columns.extend(named.into_iter().map(|(name, unit)| {
        let is = |metric: &&Metric| (metric.name, metric.unit) == (name, unit);
        number(&column_name(name, unit), &|beat| beat.metrics.iter().find(is)?.value)
    }));
    columns.push(text("not_read", rows.iter().map(|(_, beat)| missing(&beat.metrics))));
    columns.push(text("remarks", rows.iter().map(|(_, beat)| beat.remark.clone())));
    Ok(Table { columns }.for_people().to_csv()?)
}

/// loops.csv: calcium and motion of each beat that counts, and of the mean beat.
pub(in crate::experiment) fn loops(
    all: &[AnalysedCurve],
    pairs: &[PairedCurves],
) -> Result<Vec<u8>, ExperimentError> {
    let mut rows = Vec::new();
    for pair in pairs {
        let mean = pair.paired.mean_loop.iter().map(|mean| ("mean".to_owned(), mean));
        let beats = pair.paired.loops.iter().map(|(beat, course)| (beat.to_string(), course));
        for (beat, course) in mean.chain(beats) {
            let points = course.times_ms.iter().zip(course.calcium.iter().zip(&course.motion));
            rows.extend(points.map(|(time, values)| (pair, beat.clone(), *time, values)));
        }
    }
    let number = |name: &str, values: Vec<f64>| Column::Number {
        name: name.to_owned(),
        values: values.into_iter().map(Some).collect(),
    };
    let mut columns = names(all, rows.iter().map(|row| row.0));
    columns.extend([
        text("beat", rows.iter().map(|row| row.1.clone())),
        number("time_from_onset_of_calcium_ms", rows.iter().map(|row| row.2).collect()),
        number("calcium", rows.iter().map(|row| *row.3.0).collect()),
        text("unit_of_calcium", rows.iter().map(|row| all[row.0.calcium].curve.unit.to_owned())),
        number("motion", rows.iter().map(|row| *row.3.1).collect()),
        text("unit_of_motion", rows.iter().map(|row| row.0.paired.motion_unit.to_owned())),
    ]);
    Ok(Table { columns }.for_people().to_csv()?)
}

/// Files and names of paired curves.
fn names<'a>(
    all: &[AnalysedCurve],
    pairs: impl Iterator<Item = &'a PairedCurves> + Clone,
) -> Vec<Column> {
    let file = |pair: &PairedCurves| {
        let [calcium, motion] = [&all[pair.calcium].file, &all[pair.motion].file];
        if calcium == motion { calcium.clone() } else { format!("{calcium}; {motion}") }
    };
    vec![
        text("file", pairs.clone().map(file)),
        text("calcium_curve", pairs.clone().map(|pair| all[pair.calcium].curve.name.clone())),
        text("motion_curve", pairs.map(|pair| all[pair.motion].curve.name.clone())),
    ]
}

/// metrics.csv: a row for each beat.
pub(super) fn metrics(all: &[AnalysedCurve]) -> Result<Vec<u8>, ExperimentError> {
    let rows: Vec<(&AnalysedCurve, &Analysis, &CurveBeat)> = all
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
    let named = named(rows.iter().flat_map(|(_, _, beat)| &beat.metrics));
    columns.extend(named.into_iter().map(|(name, unit)| {
        let is = |metric: &&Metric| (metric.name, metric.unit) == (name, unit);
        number(&column_name(name, unit), &|beat: &CurveBeat| beat.metrics.iter().find(is)?.value)
    }));
    columns.push(text("not_read", rows.iter().map(|(_, _, beat)| missing(&beat.metrics))));
    columns.push(text("remarks", rows.iter().map(|(_, _, beat)| beat.remarks.join("; "))));
    columns.push(text(
        "conventions",
        rows.iter().map(|(_, analysis, _)| conventions(&analysis.treatment)),
    ));
    Ok(Table { columns }.for_people().to_csv()?)
}

/// summary.csv: a row for each metric of each curve.
pub(super) fn summary(all: &[AnalysedCurve]) -> Result<Vec<u8>, ExperimentError> {
    let mut rows: Vec<(&AnalysedCurve, Mean)> = Vec::new();
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
    let conventions = |read: &AnalysedCurve| match &read.found {
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
