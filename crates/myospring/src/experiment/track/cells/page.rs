//! `report.html` of several cells: the frame at rest with their numbers, a row a cell, a curve a cell.

use super::found::TrackedCells;
use crate::experiment::ExperimentError;
use crate::experiment::track::page::how_measured;
use crate::output::page::{
    self, Answer, Chart, Drawing, Page, Part, Quality, Section, Series, Table as PageTable, Tone,
};
use crate::output::table::Table;
use crate::output::track::TrackRow;
use crate::study::Status;

/// Cells whose curves are drawn: as many lines differ.
const DRAWN: usize = 36;
/// Rows of the table.
const ROWS: usize = 1000;
/// Columns that are listed.
const COLUMNS: [&str; 14] = [
    "cell",
    "status",
    "peak_contraction_pct",
    "contraction_by",
    "peak_contraction_ms",
    "resting_length_um",
    "peak_shortening_pct",
    "sarcomere_rest_um",
    "sarcomere_shortening_pct",
    "interpolated_pct_mean",
    "confidence",
    "area_um2",
    "reason",
    "warnings",
];

/// The page; `all` is the table of all cells.
pub(super) fn html(tracked: &TrackedCells, all: &Table) -> Result<String, ExperimentError> {
    let words = "the frame at rest with the outlines of the cells and their numbers";
    let figure = Drawing::new(&tracked.overlay()?, words)?;
    // Sentences come after the numbers.
    let mut all = all.clone();
    all.columns.sort_by_key(|column| ["reason", "warnings"].contains(&column.name()));
    let table = PageTable::of("All cells", &all, ROWS, |name| COLUMNS.contains(&name));
    let film = tracked.of_film();
    let others = tracked.followed().count().saturating_sub(DRAWN);
    let hint = match others {
        0 => "One colour a cell. `shortenings.csv` has these curves, the folder `cells` all of each cell.".to_owned(),
        others => format!("The {DRAWN} largest cells; `shortenings.csv` has {others} more."),
    };
    let quality = match (tracked.followed().count(), tracked.count(Status::Failed)) {
        (0, _) => Quality::Poor,
        (_, 0) => Quality::Good,
        _ => Quality::Fair,
    };
    let sections = vec![
        Section {
            hint: "Yellow: followed; purple: not followed, the table says why. The names are those of the table. Cells that touch or \
                   overlap without a visible border count as one: look at the outlines."
                .to_owned(),
            ..Section::new("cells", "Cells in the frame at rest", vec![Part::Figure(figure)])
        },
        Section { hint, ..Section::new("curves", "Curves", vec![Part::Charts(charts(tracked))]) },
        Section {
            hint: "`cells.csv` has all columns. `cells/NAME/report.html` shows one cell move."
                .to_owned(),
            ..Section::new("table", "Numbers of every cell", vec![Part::Table(table)])
        },
        Section::new(
            "notes",
            "How it was measured",
            vec![Part::Words(film.map(how_measured).unwrap_or_default())],
        ),
    ];
    let facts = film.map(|film| {
        vec![
            format!("{} of {} frames", film.frames_followed, film.frames),
            format!("{:.4} /s", film.frames_per_second),
            format!("{} cells", tracked.cells.len()),
        ]
    });
    let page = Page {
        kind: "The cells of a film, followed by Myospring",
        title: tracked.film.rsplit(['/', '\\']).next().unwrap_or(&tracked.film),
        facts: facts.unwrap_or_default(),
        answer: Some(Answer { words: format!("{}.", tracked.words()), quality }),
        warnings: tracked.common_warnings(),
        sections,
    };
    Ok(page::html(&page)?)
}

fn charts(tracked: &TrackedCells) -> Vec<Chart> {
    let chart = |name: &str, unit: &str, of: &dyn Fn(&TrackRow, f64) -> Option<f64>| {
        let series = tracked.followed().take(DRAWN).enumerate().map(|(at, (cell, it))| Series {
            label: format!("cell {}", cell.name),
            tone: Tone::Run(at),
            dotted: false,
            times_ms: it.report.rows.iter().map(|row| row.t_ms).collect(),
            values: (it.report.rows.iter().zip(&it.report.headline.contraction_pct))
                .map(|(row, contraction)| of(row, *contraction).unwrap_or(f64::NAN))
                .collect(),
        });
        let series: Vec<Series> = series.collect();
        let (name, unit) = (name.to_owned(), unit.to_owned());
        let is_shown = series.iter().any(|it| it.values.iter().any(|value| value.is_finite()));
        is_shown.then(|| Chart { name, unit, series, ..Chart::default() })
    };
    let charts = [
        chart("Contraction", "%", &|_, contraction| Some(contraction)),
        chart("Length", "um", &|row, _| Some(row.length_um)),
        chart("Smaller stretch of the whole cell", "", &|row, _| Some(row.stretch_1)),
        chart("Sarcomere length", "um", &|row, _| row.sarcomere_um),
    ];
    charts.into_iter().flatten().collect()
}
