//! A comparison as a table for people.

use crate::run::words::ROWS;
use crate::table::{aligned, number};
use myospring::compare::metric::Row;
use myospring::experiment::compare::Compared;

/// Settings and metrics in which runs differ; the first run's values, and those of the others with the difference in
/// the metric's unit and in per cent.
pub(super) fn for_people(compared: &Compared) -> String {
    let (labels, settings, metrics) = (compared.labels(), &compared.differences, &compared.metrics);
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

/// `10.2 (-1.80, -15.0 %)`; for the first run only the value.
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
