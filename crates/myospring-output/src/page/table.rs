//! Tables and key numbers.

use crate::table::{self, column_name};
use serde::Serialize;

/// A table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Table {
    /// Its heading.
    pub caption: String,
    /// How it is laid out.
    pub look: Look,
    /// Its columns.
    pub columns: Vec<Column>,
    /// Its rows, each with a cell for each column.
    pub rows: Vec<Row>,
}

/// Units in the names of columns; a unit that ends like another comes before it.
const UNITS: [&str; 18] = [
    "um^2", "1/um", "um/s", "um/ms", "um", "L0/s", "1/ms", "1/s", "kPa/s", "kPa ms", "kPa", "% ms",
    "%", "mV/ms", "mV", "ms", "deg", "s",
];

impl Table {
    /// A table of results that a reader sorts and filters: its first rows, and the columns that are
    /// chosen by name.
    pub fn of(
        caption: &str,
        table: &table::Table,
        most: usize,
        wanted: impl Fn(&str) -> bool,
    ) -> Self {
        let chosen = table.columns.iter().filter(|column| wanted(column.name()));
        let (mut columns, mut rows) = (Vec::new(), Vec::new());
        for column in chosen {
            let cells: Vec<TableCell> = match column {
                table::Column::Text { name, values } => {
                    columns.push(Column::text(&metric_words(name)));
                    let text =
                        |text: &Option<String>| TableCell::text(text.clone().unwrap_or_default());
                    values.iter().take(most).map(text).collect()
                }
                table::Column::Number { name, values } => {
                    let unit = UNITS.iter().find(|unit| name.ends_with(&column_name("", unit)));
                    let stem = unit.and_then(|unit| name.strip_suffix(&column_name("", unit)));
                    let words = metric_words(stem.unwrap_or(name));
                    columns.push(Column::number(&words, unit.copied().unwrap_or_default()));
                    values.iter().take(most).map(|value| TableCell::number(*value)).collect()
                }
            };
            rows.resize_with(cells.len(), Row::default);
            rows.iter_mut().zip(cells).for_each(|(row, cell)| row.cells.push(cell));
        }
        Self { caption: caption.to_owned(), look: Look::Sortable, columns, rows }
    }
}

/// How a table is laid out.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Look {
    /// Of its own width; scrolls where that is more than the page's.
    #[default]
    Wide,
    /// As [`Look::Wide`], and a reader can sort and filter its rows.
    Sortable,
    /// Few columns; two tables are side by side.
    Numbers,
    /// Names with values and meanings; on a phone each row is a block, on paper only marked rows are printed.
    Parameters,
}

/// A column of a table.
#[derive(Debug, Clone, Default, PartialEq, Eq, Serialize)]
pub struct Column {
    /// Its heading, with the unit where all its values have one.
    pub name: String,
    /// What it is; shown on hover.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub definition: String,
    /// What it holds, for its style: `number`, `unit`, `band`, `meaning`, `source`, or nothing in
    /// particular.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub class: &'static str,
}

impl Column {
    /// A column of text.
    pub fn text(name: &str) -> Self {
        Self { name: name.to_owned(), ..Self::default() }
    }

    /// A column of a class.
    pub fn of(class: &'static str, name: &str) -> Self {
        Self { class, ..Self::text(name) }
    }

    /// A column of numbers, with their unit.
    pub fn number(name: &str, unit: &str) -> Self {
        let name = if unit.is_empty() { name.to_owned() } else { format!("{name} ({unit})") };
        Self { name, class: "number", ..Self::default() }
    }
}

/// A row of a table.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Row {
    /// A cell for each column.
    pub cells: Vec<TableCell>,
    /// Whether it is highlighted: a changed parameter, a doubtful cell.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub marked: bool,
}

impl From<Vec<TableCell>> for Row {
    fn from(cells: Vec<TableCell>) -> Self {
        Self { cells, marked: false }
    }
}

/// A cell of a table, or a value of a tile.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct TableCell {
    /// Text; of a number `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    /// A number; a dash is shown where there is neither number nor text.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<f64>,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spread: Option<f64>,
    /// Its unit.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub unit: String,
    /// What the text is; shown on hover.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub definition: String,
    /// A note below it, such as why there is no number.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub note: String,
    /// A verdict on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mark: Option<VerdictMark>,
    /// The number that it is compared with, if any; `[None]` if that is missing.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<[Option<f64>; 1]>,
}

impl TableCell {
    /// Text.
    pub fn text(text: impl Into<String>) -> Self {
        Self { text: Some(text.into()), ..Self::default() }
    }

    /// A number, or a dash.
    pub fn number(number: Option<f64>) -> Self {
        Self { number: number.filter(|number| number.is_finite()), ..Self::default() }
    }

    /// A name and what it is.
    pub fn term(name: impl Into<String>, definition: impl Into<String>) -> Self {
        Self { definition: definition.into(), ..Self::text(name) }
    }

    /// With a verdict.
    #[must_use]
    pub fn marked(self, mark: Option<VerdictMark>) -> Self {
        Self { mark, ..self }
    }
}

/// A verdict in a word or two, with a dot.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct VerdictMark {
    /// Whether it is a filled, green dot; otherwise it is an orange ring.
    pub good: bool,
    /// The verdict.
    pub words: String,
}

impl VerdictMark {
    /// A verdict.
    pub fn new(good: bool, words: impl Into<String>) -> Self {
        Self { good, words: words.into() }
    }
}

/// A key number.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Tile {
    /// Its name.
    pub name: String,
    /// What it is; shown on hover.
    #[serde(skip_serializing_if = "String::is_empty")]
    pub definition: String,
    /// Its value; of several things each with its name.
    pub values: Vec<(String, TableCell)>,
    /// Notes, a line each.
    pub lines: Vec<TableCell>,
}

impl Tile {
    /// One value.
    pub fn new(name: impl Into<String>, value: TableCell) -> Self {
        Self { name: name.into(), values: vec![(String::new(), value)], ..Self::default() }
    }
}

/// The name of a metric in words: `peak_shortening` is `peak shortening`.
///
/// # Example
/// ```
/// use myospring::output::page::metric_words;
/// assert_eq!(metric_words("peak_shortening"), "peak shortening");
/// assert_eq!(metric_words("action_potential_duration_90"), "APD90");
/// assert_eq!(metric_words("relaxation_time_50"), "relaxation time 50\u{a0}%");
/// assert_eq!(metric_words("rise_time_10_90"), "rise time 10\u{2013}90\u{a0}%");
/// ```
pub fn metric_words(name: &str) -> String {
    if let Some(part) = name.strip_prefix("action_potential_duration_") {
        return format!("APD{part}");
    }
    let words =
        name.trim_end_matches("_percent").replace("10_90", "10\u{2013}90").replace('_', " ");
    match words.rsplit_once(' ') {
        Some((before, last)) if last.ends_with(|letter: char| letter.is_ascii_digit()) => {
            format!("{before} {last}\u{a0}%")
        }
        _ => words,
    }
}
