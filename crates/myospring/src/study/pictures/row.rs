//! One row of the table: a cell, or a picture that failed.

use crate::analysis::summary::Summary;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::stack::StackFibres;
use crate::output::table::{Column, Table, column_name};
use crate::settings::{FibreReport, SeenReport, Shaped};
use crate::study::{Row, Status};
use serde::{Deserialize, Serialize};

/// A cell of a picture, or a picture that failed.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct CellRow {
    /// The picture's name.
    pub picture: String,
    /// The cell's name; none where the picture failed.
    pub cell: Option<String>,
    /// The group to which the picture belongs.
    pub group: Option<String>,
    /// Its status.
    pub status: Status,
    /// Why it is not ok; else empty.
    pub reason: String,
    /// How the picture was read, in a word.
    pub modality: Option<String>,
    /// Numbers by column, with the unit in its name, in the order of reading.
    pub numbers: Vec<(String, Option<f64>)>,
    /// Warnings.
    pub warnings: String,
}

impl CellRow {
    /// The row of a cell before its simulation.
    pub(super) fn of(picture: &str, cells: &PictureCells, cell: &PictureCell) -> Self {
        let (shape, size) = (&cell.shape, &cell.shape.dimensions);
        let mut row = Self {
            picture: picture.to_owned(),
            cell: Some(cell.name.clone()),
            group: None,
            status: Status::Ok,
            reason: String::new(),
            modality: Some(cells.modality().to_owned()),
            numbers: Vec::new(),
            warnings: cells.notes.join("; "),
        };
        row.number("pixel_size_um", cells.pixel_size.um());
        row.number("confidence", cell.confidence.score);
        row.number("contrast", cell.confidence.contrast);
        row.number("area_um2", shape.area_um2);
        row.number("perimeter_um", shape.perimeter_um);
        row.number("length_um", size.length_um);
        row.number("width_um", size.width_um);
        row.number("mean_width_um", size.mean_width_um);
        row.number("aspect_ratio", size.aspect_ratio);
        row.number("long_axis_deg", size.long_axis_deg);
        row.number("solidity", shape.solidity);
        row.number("circularity", shape.circularity);
        row.number("pixels_on_frame", shape.pixels_on_frame as f64);
        row
    }

    /// The row of the cell of a stack before its simulation.
    pub(super) fn of_stack(file: &str, shaped: &Shaped) -> Self {
        let (found, size) =
            (shaped.stack.as_deref().map(|it| &it.report), &shaped.report.dimensions);
        let mut row = Self {
            cell: Some("1".to_owned()),
            status: Status::Ok,
            modality: found.map(|found| found.modality.seen_as().to_owned()),
            ..Self::failed(file, String::new())
        };
        row.number("pixel_size_um", found.map(|found| found.pixel_um));
        row.number("z_step_um", found.map(|found| found.z_step_um));
        row.number("confidence", found.map(|found| found.confidence.score));
        row.number("contrast", found.and_then(|found| found.confidence.contrast));
        row.number("area_um2", found.map(|found| found.area_um2));
        row.number("length_um", size.length_um);
        row.number("width_um", size.width_um);
        row.number("mean_width_um", size.mean_width_um);
        row.number("aspect_ratio", size.aspect_ratio);
        row.number("long_axis_deg", size.long_axis_deg);
        row.number("largest_thickness_um", found.map(|found| found.thickness_um));
        row.number("volume_um3", found.map(|found| found.volume_um3));
        row.number("slices_in_cell", found.map(|found| found.slices_in_cell as f64));
        row
    }

    /// Adds a number.
    pub(super) fn number(&mut self, column: impl Into<String>, value: impl Into<Option<f64>>) {
        self.numbers.push((column.into(), value.into()));
    }

    /// Adds what the picture, or the slices of a stack, show of the fibres; empty if they were not searched.
    pub(super) fn fibres(&mut self, report: &FibreReport, is_stack: bool) {
        let seen = report.seen.as_ref();
        let none_read = report.not_read.as_ref().map(|_| 0.0);
        if is_stack {
            let slices = report.slices.as_ref();
            let helix = slices.and_then(|slices| slices.helix.as_ref());
            let shown = slices.map(|slices| slices.shown() as f64);
            self.number("slices_with_fibres", shown.or(none_read));
            self.number("fibre_turn_deg", helix.map(|helix| helix.turn_deg));
            self.number("fibre_turn_error_deg", helix.map(|helix| helix.error_deg));
            self.number("sarcomere_um", slices.and_then(StackFibres::sarcomere_um));
            return;
        }
        self.number("fibres_from_picture_pct", seen.map(|seen| seen.read_pct).or(none_read));
        self.number("sarcomere_um", seen.and_then(|seen| seen.sarcomere_um));
        self.number("sarcomere_q1_um", seen.and_then(|seen| seen.sarcomere_q1_um));
        self.number("sarcomere_q3_um", seen.and_then(|seen| seen.sarcomere_q3_um));
        let is_doubtful = |seen: &SeenReport| {
            seen.sarcomere_um.map(|_| f64::from(u8::from(seen.sarcomere_doubt.is_some())))
        };
        self.number("sarcomere_doubtful", seen.and_then(is_doubtful));
        self.number("fibre_order", seen.map(|seen| seen.order));
        self.number("fibre_alignment", seen.map(|seen| seen.alignment));
        self.number("fibre_angle_to_axis_deg", seen.map(|seen| seen.angle_to_axis_deg));
    }

    /// Adds the metrics of the first beat that counts, or the means over several, and those of an
    /// S2 relative to them.
    pub(super) fn metrics(&mut self, summary: &Summary) {
        let Some(first) = summary.usual() else { return };
        for metric in first.metrics() {
            let mean = summary.beat_to_beat.iter().find(|spread| spread.name == metric.name);
            let value = mean.map(|spread| spread.mean).or(metric.value);
            self.number(column_name(metric.name, metric.unit), value);
        }
        for metric in summary.s2().into_iter().flat_map(|beat| &beat.s2) {
            self.number(column_name(metric.name, metric.unit), metric.value);
        }
    }

    /// Notes that it is not ok, and why.
    pub(super) fn is_not_ok(&mut self, status: Status, reason: String) {
        (self.status, self.reason) = (status, reason);
    }
}

impl Row for CellRow {
    fn failed(picture: &str, reason: String) -> Self {
        Self {
            picture: picture.to_owned(),
            cell: None,
            group: None,
            status: Status::Failed,
            reason,
            modality: None,
            numbers: Vec::new(),
            warnings: String::new(),
        }
    }

    fn status(&self) -> Status {
        self.status
    }

    /// Columns are in the order of the row that has most of them.
    fn table(rows: &[Self]) -> Table {
        let text = |name: &str, read: fn(&Self) -> Option<String>| Column::Text {
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
        ];
        if rows.iter().any(|row| row.group.is_some()) {
            columns.push(text("group", |row| row.group.clone()));
        }
        columns.extend([
            text("status", |row| Some(row.status.to_string())),
            text("reason", |row| Some(row.reason.clone())),
            text("modality", |row| row.modality.clone()),
        ]);
        columns.extend(names.into_iter().map(|name| {
            let value = |row: &Self| row.numbers.iter().find(|(other, _)| other == name)?.1;
            Column::Number { name: name.clone(), values: rows.iter().map(value).collect() }
        }));
        columns.push(text("warnings", |row| Some(row.warnings.clone())));
        Table { columns }
    }
}
