//! A comparison as tables: for people, and as comma-separated values.

use super::side::Side;
use crate::failure::Failure;
use crate::run::words::ROWS;
use crate::table::{aligned, number};
use myospring::compare::metric::Row;
use myospring::compare::setting::{Different, shown};
use myospring::output::page::Difference;
use myospring::output::table::{Column, Table};

/// Settings in which runs differ, as people read them; parameters of the cell model with the value that the model has
/// of itself, and their unit.
pub(super) fn differences(settings: &[Different], sides: &[Side]) -> Vec<Difference> {
    let value = |different: &Different, index: usize| {
        let own = different.values[index].as_deref();
        match (different.key.strip_prefix("cell.parameters."), own) {
            (Some(name), _) => sides[index]
                .parameter(name)
                .unwrap_or_else(|| own.map_or_else(|| "as published".to_owned(), |_| shown(own))),
            (None, _) => shown(own),
        }
    };
    let row = |different: &Different| Difference {
        name: different.key.clone(),
        values: (0..sides.len()).map(|index| value(different, index)).collect(),
    };
    settings.iter().map(row).collect()
}

/// Settings and metrics in which runs differ; the first run's values, and those of the others with the difference in
/// the metric's unit and in per cent.
pub(super) fn for_people(labels: &[&str], settings: &[Difference], metrics: &[Row]) -> String {
    let mut text = String::new();
    let row = |first: [&str; 2], rest: &mut dyn Iterator<Item = String>| -> Vec<String> {
        first.map(str::to_owned).into_iter().chain(rest).collect()
    };
    let head = |first: [&str; 2]| row(first, &mut labels.iter().map(|label| (*label).to_owned()));
    if settings.is_empty() {
        text.push_str("the runs have the same settings\n");
    } else {
        let mut rows = vec![head(["setting", ""])];
        rows.extend(
            settings
                .iter()
                .map(|setting| row([&setting.name, ""], &mut setting.values.iter().cloned())),
        );
        text.push_str(&aligned(&rows, &[]));
    }
    text.push('\n');
    let mut rows = vec![head(["quantity", "unit"])];
    for (name, words) in ROWS {
        let Some(metric) = metrics.iter().find(|metric| metric.name == name) else { continue };
        if metric.values.iter().all(Option::is_none) {
            continue;
        }
        let mut cells = (0..metric.values.len()).map(|index| cell(metric, index));
        rows.push(row([words, metric.unit], &mut cells));
    }
    text.push_str(&aligned(&rows, &[]));
    let none = |difference: &Option<f64>| difference.is_none_or(|difference| difference == 0.0);
    if metrics.iter().all(|metric| metric.differences.iter().all(none)) {
        text.push_str("the runs do not differ in any number\n");
    }
    text
}

/// `10.2 (-1.80, -15.0 %)`; of the first run the value alone.
fn cell(metric: &Row, index: usize) -> String {
    let Some(value) = metric.values[index] else { return "-".to_owned() };
    let value = number(value);
    match (metric.differences[index], metric.differences_pct[index]) {
        _ if index == 0 => value,
        (Some(difference), Some(percent)) if signed(difference) != "0" => {
            format!("{value} ({}, {} %)", signed(difference), signed(percent))
        }
        (Some(difference), _) => format!("{value} ({})", signed(difference)),
        (None, _) => value,
    }
}

fn signed(value: f64) -> String {
    let text = number(value);
    match value {
        _ if text.chars().all(|c| matches!(c, '0' | '.')) => "0".to_owned(),
        _ if value > 0.0 => format!("+{text}"),
        _ => text,
    }
}

/// metrics.csv: a row for each metric and run.
pub(super) fn csv(labels: &[&str], metrics: &[Row]) -> Result<Vec<u8>, Failure> {
    let places = || metrics.iter().flat_map(|row| (0..labels.len()).map(move |run| (row, run)));
    let text = |name: &str, of: &dyn Fn(&Row, usize) -> String| Column::Text {
        name: name.to_owned(),
        values: places().map(|(row, run)| Some(of(row, run))).collect(),
    };
    let numbers = |name: &str, of: fn(&Row) -> &[Option<f64>]| Column::Number {
        name: name.to_owned(),
        values: places().map(|(row, run)| of(row)[run]).collect(),
    };
    let table = Table {
        columns: vec![
            text("metric", &|row, _| row.name.to_owned()),
            text("run", &|_, run| labels[run].to_owned()),
            numbers("value", |row| &row.values),
            text("unit", &|row, _| row.unit.to_owned()),
            numbers("difference", |row| &row.differences),
            text("difference_unit", &|row, _| row.difference_unit.to_owned()),
            numbers("difference_pct", |row| &row.differences_pct),
        ],
    };
    Ok(table.for_people().to_csv()?)
}
