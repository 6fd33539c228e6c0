//! `report.html` of a batch: every cell, small, and the table of all numbers.

use crate::output::page::{
    self, Answer, Page, PageError, Part, Quality, Section, Table, TableCell, Thumbnail, Tile,
    VerdictMark,
};
use crate::study::pictures::CellRow;
use crate::study::{Row as _, Status};
use statrs::statistics::{Data, OrderStatistics};
use std::fmt::Write as _;

/// Name of the file.
pub(super) const FILE: &str = "report.html";
/// Bytes of all small pictures, and rows of the table, at most.
const LARGEST: usize = 3_000_000;
const ROWS: usize = 1000;
/// Columns that are listed, as far as a batch has them.
const COLUMNS: [&str; 17] = [
    "picture",
    "cell",
    "group",
    "status",
    "confidence",
    "length_um",
    "width_um",
    "area_um2",
    "sarcomere_um",
    "peak_shortening_pct",
    "peak_lengthening_pct",
    "time_to_peak_from_stimulus_ms",
    "relaxation_time_90_ms",
    "maximum_shortening_rate_L0_per_s",
    "peak_tension_kPa",
    "reason",
    "warnings",
];
/// Numbers that a reader looks at first: column, what it is, unit.
const KEY: [(&str, &str, &str); 5] = [
    ("length_um", "length", "um"),
    ("area_um2", "area", "um\u{b2}"),
    ("sarcomere_um", "sarcomere length", "um"),
    ("peak_shortening_pct", "peak shortening", "%"),
    ("time_to_peak_from_stimulus_ms", "time to peak", "ms"),
];

/// The page; `small` gives the small picture of a row, PNG, where there is one.
pub(super) fn html(
    title: &str,
    (rows, pictures): (&[CellRow], usize),
    notes: &[String],
    small: impl Fn(&CellRow) -> Option<Vec<u8>>,
) -> Result<String, PageError> {
    let count = |status| rows.iter().filter(|row| row.status == status).count();
    let [beat, left_out, failed] = [Status::Ok, Status::LeftOut, Status::Failed].map(count);
    let of = if pictures == 1 { "1 picture".to_owned() } else { format!("{pictures} pictures") };
    let mut words = format!("{beat} cell{} of {of} beat", if beat == 1 { "" } else { "s" });
    for (count, what) in [(left_out, "left out"), (failed, "failed")] {
        if count > 0 {
            let _ = write!(words, ", {count} {what}");
        }
    }
    let quality = match (beat, failed) {
        (0, _) => Quality::Poor,
        (_, 0) => Quality::Good,
        _ => Quality::Fair,
    };
    let reason = |row: &CellRow| format!("{}: {}", row.picture, row.reason);
    let failures = rows.iter().filter(|row| row.status == Status::Failed).map(reason);
    // Sentences come after the numbers.
    let mut table = CellRow::table(rows);
    table.columns.sort_by_key(|column| ["reason", "warnings"].contains(&column.name()));
    let table = Table::of("All cells", &table, ROWS, |name| COLUMNS.contains(&name));
    let table = Section {
        hint: match rows.len() {
            count if count > ROWS => {
                format!(
                    "The first {ROWS} of {count} rows; `cells.csv` and `cells.parquet` have all rows and columns."
                )
            }
            _ => "`cells.csv` and `cells.parquet` have all columns.".to_owned(),
        },
        ..Section::new("table", "Numbers of every cell", vec![Part::Table(table)])
    };
    page::html(&Page {
        kind: "Cells of many pictures, by Myospring",
        title,
        facts: vec![of],
        answer: Some(Answer { words: format!("{words}."), quality }),
        warnings: notes.iter().cloned().chain(failures).collect(),
        sections: vec![
            Section {
                hint: "Median over the cells that beat, and the quartiles below it.".to_owned(),
                ..Section::new("key", "Key numbers", vec![Part::Tiles(tiles(rows))])
            },
            gallery(rows, small),
            table,
        ],
    })
}

/// Medians and quartiles.
fn tiles(rows: &[CellRow]) -> Vec<Tile> {
    let of = |column: &str| -> Vec<f64> {
        let beat = rows.iter().filter(|row| row.status == Status::Ok);
        beat.filter_map(|row| row.numbers.iter().find(|(name, _)| name == column)?.1).collect()
    };
    let tile = |(column, words, unit): &(&str, &str, &str)| {
        let values = of(column);
        if values.is_empty() {
            return None;
        }
        let mut values = Data::new(values);
        let [low, middle, high] =
            [values.lower_quartile(), values.median(), values.upper_quartile()];
        let cell = TableCell { unit: (*unit).to_owned(), ..TableCell::number(Some(middle)) };
        let range = TableCell::text(format!("{low:.2} to {high:.2} {unit}"));
        Some(Tile { lines: vec![range], ..Tile::new(*words, cell) })
    };
    KEY.iter().filter_map(tile).collect()
}

/// Every cell, small, as far as there is room.
fn gallery(rows: &[CellRow], small: impl Fn(&CellRow) -> Option<Vec<u8>>) -> Section<'static> {
    let (mut thumbnails, mut size, mut missing) = (Vec::new(), 0, 0);
    for row in rows {
        let Some(cell) = &row.cell else { continue };
        let png = if size < LARGEST { small(row) } else { None };
        let Some(png) = png else {
            missing += 1;
            continue;
        };
        let number = |column: &str| row.numbers.iter().find(|(name, _)| name == column)?.1;
        let (words, mark) = match row.status {
            Status::Ok => {
                let shortening = number("peak_shortening_pct");
                let words = shortening.map(|value| format!("shortens by {value:.1} %"));
                (words.unwrap_or_default(), None)
            }
            Status::LeftOut => (row.reason.clone(), Some(VerdictMark::new(false, "left out"))),
            Status::Failed => (row.reason.clone(), Some(VerdictMark::new(false, "failed"))),
        };
        let name = format!("{}, cell {cell}", row.picture);
        let thumbnail = Thumbnail::new(&name, &words, mark, &png);
        size += thumbnail.size();
        thumbnails.push(thumbnail);
    }
    let hint = match missing {
        0 => "The cell's outline. The folder `overlays` has the whole pictures.".to_owned(),
        missing => {
            format!("{missing} more cells are not shown; the folder `overlays` has all of them.")
        }
    };
    Section { hint, ..Section::new("cells", "Cells", vec![Part::Gallery(thumbnails)]) }
}
