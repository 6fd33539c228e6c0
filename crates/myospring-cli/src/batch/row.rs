//! One row of the table: a cell, or a picture that failed.

use myospring::output::table::{Column, Table};
use serde::{Deserialize, Serialize};
use std::fmt;

/// What became of a cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub(super) enum Status {
    /// It beat.
    Ok,
    /// It was found but not beaten: cut by the frame, or doubtful.
    LeftOut,
    /// The picture gave no cell, or the beat stopped early.
    Failed,
}

impl fmt::Display for Status {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str(match self {
            Self::Ok => "ok",
            Self::LeftOut => "left out",
            Self::Failed => "failed",
        })
    }
}

/// A cell, or a picture that failed.
#[derive(Debug, Clone, Serialize, Deserialize)]
pub(super) struct Row {
    /// The picture, within the folder.
    pub(super) picture: String,
    pub(super) cell: Option<String>,
    pub(super) status: Status,
    /// Why it is not ok; else empty.
    pub(super) reason: String,
    pub(super) modality: Option<String>,
    /// Numbers by column, in the order of reading.
    pub(super) numbers: Vec<(String, Option<f64>)>,
    pub(super) warnings: String,
}

impl Row {
    /// A picture that failed before any cell was seen.
    pub(super) fn failed(picture: &str, reason: String) -> Self {
        Self {
            picture: picture.to_owned(),
            cell: None,
            status: Status::Failed,
            reason,
            modality: None,
            numbers: Vec::new(),
            warnings: String::new(),
        }
    }

    /// Adds a number.
    pub(super) fn number(&mut self, column: impl Into<String>, value: impl Into<Option<f64>>) {
        self.numbers.push((column.into(), value.into()));
    }
}

/// The table of all rows. Columns of numbers stand in the order of the row that has most of them.
pub(super) fn table(rows: &[Row]) -> Table {
    let text = |name: &str, read: fn(&Row) -> Option<String>| Column::Text {
        name: name.to_owned(),
        values: rows.iter().map(read).collect(),
    };
    let longest = rows.iter().max_by_key(|row| row.numbers.len());
    let mut names: Vec<&String> =
        longest.into_iter().flat_map(|row| row.numbers.iter().map(|(name, _)| name)).collect();
    for (name, _) in rows.iter().flat_map(|row| &row.numbers) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let mut columns = vec![
        text("picture", |row| Some(row.picture.clone())),
        text("cell", |row| row.cell.clone()),
        text("status", |row| Some(row.status.to_string())),
        text("reason", |row| Some(row.reason.clone())),
        text("modality", |row| row.modality.clone()),
    ];
    columns.extend(names.into_iter().map(|name| {
        Column::Number {
            name: name.clone(),
            values: rows
                .iter()
                .map(|row| {
                    row.numbers.iter().find(|(other, _)| other == name).and_then(|row| row.1)
                })
                .collect(),
        }
    }));
    columns.push(text("warnings", |row| Some(row.warnings.clone())));
    Table { columns }
}
