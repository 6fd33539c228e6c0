//! A comparison as tables.

use super::side::Side;
use crate::compare::metric::Row;
use crate::compare::setting::{Different, shown};
use crate::experiment::ExperimentError;
use crate::output::page::Difference;
use crate::output::table::{Column, Table};

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

/// metrics.csv: a row for each metric and run.
pub(super) fn metrics(labels: &[&str], metrics: &[Row]) -> Result<Vec<u8>, ExperimentError> {
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
