//! The tables of several cells: a row a cell, and a column a cell.

use super::found::{FilmCell, TrackedCells};
use crate::experiment::track::report::TrackReport;
use crate::microscopy::report::ShapeReport;
use crate::output::table::{Column, Table};

/// Reads a number of a cell that was followed.
type Read = fn(&TrackReport) -> Option<f64>;

/// Numbers of a cell that was followed, by their columns.
const NUMBERS: [(&str, Read); 14] = [
    ("peak_contraction_pct", |it| Some(it.headline.peak_contraction_pct)),
    ("peak_contraction_ms", |it| it.rows.get(it.headline.at).map(|row| row.t_ms)),
    ("resting_length_um", |it| Some(it.resting_length_um)),
    ("peak_shortening_pct", |it| Some(it.peak_shortening_pct)),
    ("least_stretch", |it| Some(it.least_stretch)),
    ("sarcomere_rest_um", |it| it.sarcomere_rest_um),
    ("sarcomere_shortening_pct", |it| it.sarcomere_shortening_pct),
    ("noise_error_um", |it| it.noise_error_um),
    ("interpolated_pct_mean", |it| Some(it.interpolated_pct_mean)),
    ("interpolated_pct_most", |it| Some(it.interpolated_pct_most)),
    ("points", |it| Some(it.points as f64)),
    ("spacing_um", |it| Some(it.spacing_um)),
    ("frames_followed", |it| Some(it.frames_followed as f64)),
    ("rest_frame", |it| Some(it.rest_frame as f64)),
];

/// A row a cell: `cells.csv`.
pub(super) fn of_cells(tracked: &TrackedCells) -> Table {
    let (cells, common) = (&tracked.cells, tracked.common_warnings());
    let text = |name: &str, read: &dyn Fn(&FilmCell) -> Option<String>| Column::Text {
        name: name.to_owned(),
        values: cells.iter().map(read).collect(),
    };
    let number = |name: &str, read: &dyn Fn(&FilmCell) -> Option<f64>| Column::Number {
        name: name.to_owned(),
        values: cells.iter().map(read).collect(),
    };
    let of_shape =
        |read: fn(&ShapeReport) -> f64| move |cell: &FilmCell| cell.shape.as_ref().map(read);
    let by = |cell: &FilmCell| Some(cell.found.as_ref().ok()?.report.headline.column.to_owned());
    let mut columns = vec![
        text("cell", &|cell| Some(cell.name.clone())),
        text("status", &|cell| Some(cell.status().to_string())),
        text("reason", &|cell| Some(cell.reason().to_owned())),
        text("contraction_by", &by),
    ];
    let of_track =
        |(name, read): &(&str, Read)| number(name, &|cell| read(&cell.found.as_ref().ok()?.report));
    columns.extend(NUMBERS.iter().map(of_track));
    columns.extend([
        number("confidence", &|cell| cell.confidence),
        number("area_um2", &of_shape(|shape| shape.area_um2)),
        number("length_um", &of_shape(|shape| shape.dimensions.length_um)),
        number("width_um", &of_shape(|shape| shape.dimensions.width_um)),
        number("long_axis_deg", &of_shape(|shape| shape.dimensions.long_axis_deg)),
        number("pixels_on_frame", &of_shape(|shape| shape.pixels_on_frame as f64)),
        text("warnings", &|cell| Some(cell.warnings(&common).join("; "))),
    ]);
    Table { columns }
}

/// A row a frame and a column a cell, its contraction by the measure that can be trusted: `shortenings.csv`.
pub(super) fn of_shortenings(tracked: &TrackedCells) -> Table {
    let number = |name: String, values: Vec<Option<f64>>| Column::Number { name, values };
    let rows = tracked.of_film().map_or(&[][..], |film| &film.rows);
    let mut columns = vec![
        number("frame".to_owned(), rows.iter().map(|row| Some(row.frame as f64)).collect()),
        number("t_ms".to_owned(), rows.iter().map(|row| Some(row.t_ms)).collect()),
    ];
    columns.extend(tracked.followed().map(|(cell, it)| {
        let values = it.report.headline.contraction_pct.iter().map(|value| Some(*value)).collect();
        number(format!("cell_{}_shortening_pct", cell.name), values)
    }));
    Table { columns }
}
