//! Tables of beats and of metrics.

use super::curve::AnalysedCurve;
use super::record::{Mean, conventions, means};
use crate::analysis::Metric;
use crate::analysis::curve::{Analysis, CurveBeat};
use crate::experiment::error::ExperimentError;
use crate::output::table::{Column, Table, column_name};

fn text(name: &str, values: impl Iterator<Item = String>) -> Column {
    let values = values.map(|value| Some(value).filter(|value| !value.is_empty()));
    Column::Text { name: name.to_owned(), values: values.collect() }
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
