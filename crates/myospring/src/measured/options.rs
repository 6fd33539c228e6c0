//! Options of reading a table.

use crate::analysis::kind::Kind;

/// A column, chosen by its name (with or without its unit, in upper or lower case) or by its number
/// from 1.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Number, counted from 1.
    Number(usize),
    /// Name in the header.
    Name(String),
}

impl Column {
    /// Returns a number if the text is one, else a name.
    pub fn of(text: &str) -> Self {
        match text.trim().parse::<usize>() {
            Ok(number) if number > 0 => Self::Number(number),
            _ => Self::Name(text.trim().to_owned()),
        }
    }
}

/// Orientation of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Layout {
    /// Each row is a frame and each column a curve.
    Columns,
    /// Each row is a curve and each column a frame.
    Rows,
}

/// Options of reading a table; whatever is absent is detected.
#[derive(Debug, Clone, Default, PartialEq)]
#[allow(clippy::struct_excessive_bools, reason = "each is a yes or no of its own")]
pub struct TableOptions {
    /// Column of times or of frame numbers.
    pub time: Option<Column>,
    /// Columns that are curves; if empty, all recognised ones. If the rows are curves, this chooses
    /// rows.
    pub values: Vec<Column>,
    /// Kind of the curves, which overrides the names of the columns.
    pub kind: Option<Kind>,
    /// Unit of the values.
    pub unit: Option<String>,
    /// Unit of the times.
    pub time_unit: Option<String>,
    /// Frame rate in frames per second, for tables without times.
    pub frame_rate_per_s: Option<f64>,
    /// Size of a pixel, um: lengths in pixels become um.
    pub pixel_size_um: Option<f64>,
    /// Sheets of a workbook; all if empty.
    pub sheets: Vec<Column>,
    /// Start of the part of the recording to use, ms on the clock of the table.
    pub from_ms: Option<f64>,
    /// End of that part, ms on the clock of the table.
    pub until_ms: Option<f64>,
    /// Ignore the marks of a pacer.
    pub ignore_marks: bool,
    /// Delimiter of fields.
    pub delimiter: Option<char>,
    /// Decimal mark, `.` or `,`.
    pub decimal: Option<char>,
    /// Orientation of the table.
    pub layout: Option<Layout>,
    /// Skip frames in which a curve has no number; without this they are an error.
    pub skip_gaps: bool,
    /// Return one curve, the mean of all.
    pub mean: bool,
    /// Refuse times without a unit; without this, the unit that gives the frame rate of a camera is
    /// assumed, with a note.
    pub units_required: bool,
}
