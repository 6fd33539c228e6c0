//! What a user may say about a table.

use crate::analysis::kind::Kind;

/// A column by its name, with or without its unit and in any case, or by its number from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// From 1.
    Number(usize),
    /// As the header has it.
    Name(String),
}

impl Column {
    /// A number where the text is one, else a name.
    pub fn of(text: &str) -> Self {
        match text.trim().parse::<usize>() {
            Ok(number) if number > 0 => Self::Number(number),
            _ => Self::Name(text.trim().to_owned()),
        }
    }
}

/// What a row of the table is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// A row is a frame, and a column a curve.
    Columns,
    /// A row is a curve, and a column a frame.
    Rows,
}

/// What is said about a table; what is not said is found in it.
#[derive(Debug, Clone, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a yes or no of its own")]
pub struct Options {
    /// The column of times, or of frames.
    pub time: Option<Column>,
    /// Columns that are curves; all that are known where this is empty. Of a table whose rows are curves its rows.
    pub values: Vec<Column>,
    /// What the curves are, whatever their columns are called.
    pub kind: Option<Kind>,
    /// Unit of their values.
    pub unit: Option<String>,
    /// Unit of the times.
    pub time_unit: Option<String>,
    /// Frames a second, where there are no times.
    pub frame_rate_per_s: Option<f64>,
    /// Size of a pixel, um: lengths in pixels become um.
    pub pixel_size_um: Option<f64>,
    /// Sheets of a workbook; all where this is empty.
    pub sheets: Vec<Column>,
    /// Where the part of the recording that counts begins, ms on the clock of the table.
    pub from_ms: Option<f64>,
    /// Where it ends.
    pub until_ms: Option<f64>,
    /// Leave out the marks of a pacer.
    pub ignore_marks: bool,
    /// What parts fields.
    pub delimiter: Option<char>,
    /// What stands before the decimals, `.` or `,`.
    pub decimal: Option<char>,
    /// What a row is.
    pub layout: Option<Layout>,
    /// Leave out frames in which a curve has no number, instead of an error.
    pub skip_gaps: bool,
    /// One curve, the mean of all.
    pub mean: bool,
    /// Times without a unit are an error; else the unit that gives a camera's frame rate is taken, with a note.
    pub units_required: bool,
}
