//! A table while its curves are read, with the methods that all steps share.

use crate::analysis::kind::Kind;
use crate::measured::column::{self, Holds, Scale, Title};
use crate::measured::curve::{Curve, Table};
use crate::measured::error::ReadError;
use crate::measured::number::Cell;
use crate::measured::options::{Column, TableOptions};
use crate::measured::sheet::Sheet;
use std::collections::BTreeSet;
use std::path::Path;

/// Smallest number of columns with which each row of a table without names can be a curve.
pub(super) const MANY: usize = 16;

/// A table up to this size, rows times columns, is read however many fields are missing. Reading takes
/// time for missing fields, too.
const LARGEST: usize = 100_000_000;
/// Larger tables may have seven missing fields for each that is there.
const SPARSE: usize = 8;

/// Largest number of names that an error lists.
const LISTED: usize = 5;

/// A table of a file, with its options and the notes on it.
pub(in crate::measured) struct Picked<'a> {
    /// Its name in errors: the file, and the sheet.
    pub(super) path: &'a str,
    /// Names that may state the kind of curves without names: that of the sheet, then that of the
    /// file.
    pub(super) stems: Vec<String>,
    pub(super) sheet: Sheet,
    pub(super) options: &'a TableOptions,
    pub(super) notes: Vec<String>,
    /// Notes that concern many columns; each is stated once.
    pub(super) shared: BTreeSet<String>,
}

pub(super) fn no_numbers(path: &str) -> ReadError {
    ReadError::Table {
        path: path.to_owned(),
        cause: "it has no line with numbers; a table of a curve has a column of times and one of values, such as \
                `time (ms),length (um)`"
            .to_owned(),
    }
}

pub(super) fn stem(path: &str) -> String {
    Path::new(path).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
pub(super) fn named(column: &Column) -> String {
    match column {
        Column::Number(number) => number.to_string(),
        Column::Name(name) => name.clone(),
    }
}

/// Lists the first few names and the number of others.
pub(crate) fn listed(names: &[String]) -> String {
    let first: Vec<String> = names.iter().take(LISTED).map(|name| format!("`{name}`")).collect();
    match names.len().saturating_sub(LISTED) {
        0 => first.join(", "),
        1 => format!("{}, `{}`", first.join(", "), names[LISTED]),
        others => format!("{} and {others} others", first.join(", ")),
    }
}
impl<'a> Picked<'a> {
    pub(super) fn of(
        path: &'a str,
        stems: Vec<String>,
        sheet: Sheet,
        options: &'a TableOptions,
    ) -> Self {
        let mut notes = Vec::new();
        if sheet.above > 0 {
            notes.push(format!(
                "{} lines of numbers above the line of names are ignored; if they are another part of the recording, \
                 put it into a file of its own",
                sheet.above
            ));
        }
        Self { path, stems, sheet, options, notes, shared: BTreeSet::new() }
    }

    /// Reads the curves.
    pub(super) fn table(mut self) -> Result<Table, ReadError> {
        self.orient()?;
        self.check_width()?;
        if self.sheet.turned.is_empty() {
            self.check_gaps(
                LARGEST,
                "correct that line, or delete the fields that it has too many",
            )?;
        }
        self.sheet.note_names();
        if !self.sheet.again.is_empty() {
            let names: BTreeSet<String> =
                self.sheet.again.iter().map(|at| self.sheet.header[*at].clone()).collect();
            let names: Vec<String> = names.into_iter().collect();
            self.notes.push(format!(
                "several columns share a name, so each name gets the number of its column: {}",
                listed(&names)
            ));
        }
        let mut curves = Vec::new();
        for (mut curve, says_unit) in self.of_columns()? {
            self.settle(&mut curve, says_unit);
            curves.push(curve);
        }
        if self.options.mean && curves.len() > 1 {
            curves = vec![self.mean(&curves)?];
        }
        let (from, until) = (self.options.from_ms, self.options.until_ms);
        let part = |curve: Curve| curve.part(from, until).map_err(|cause| self.error(cause));
        let curves = curves.into_iter().map(part).collect::<Result<_, _>>()?;
        Ok(Table { curves, notes: self.notes })
    }

    /// Refuses a table in which nearly all fields are missing, because one line is much longer than the
    /// others. Tables up to `large`, rows times columns, are never refused; `mend` says what to do.
    pub(super) fn check_gaps(&self, large: usize, mend: &str) -> Result<(), ReadError> {
        let (rows, width) = (self.sheet.rows.len(), self.sheet.width());
        let fields: usize = self.sheet.rows.iter().map(|row| row.fields.len()).sum();
        let there = fields + self.sheet.header.len();
        if rows.saturating_mul(width) <= large + SPARSE * there {
            return Ok(());
        }
        let longest = self.sheet.rows.iter().find(|row| row.fields.len() == width);
        let longest =
            longest.map_or("the line of names".to_owned(), |row| format!("line {}", row.line));
        Err(self.error(format!(
            "nearly all its fields are missing: {longest} has {width} fields, the {rows} rows have {:.1} on average; {mend}",
            fields as f64 / rows as f64
        )))
    }

    /// Refuses a number beyond the last column: the other fields of its row may then be in the
    /// wrong columns.
    fn check_width(&self) -> Result<(), ReadError> {
        let Some((row, at)) = self.sheet.beyond().filter(|_| self.sheet.turned.is_empty()) else {
            return Ok(());
        };
        let columns = match self.sheet.header.len() {
            0 => format!("most rows have {} fields", self.sheet.usual),
            names => format!("the line of names has {names}"),
        };
        Err(ReadError::Field {
            path: self.path.to_owned(),
            line: row.line,
            column: (at + 1).to_string(),
            cause: format!(
                "\"{}\" is one field too many: {columns}; name the column, or correct the row (a decimal comma needs another \
                 delimiter than the comma)",
                row.fields[at]
            ),
        })
    }

    pub(super) fn error(&self, cause: impl Into<String>) -> ReadError {
        ReadError::Table { path: self.path.to_owned(), cause: cause.into() }
    }

    pub(super) fn titles(&self) -> Vec<Title> {
        let header = |at| self.sheet.header.get(at).map_or("", String::as_str);
        (0..self.sheet.width()).map(|at| column::title(header(at))).collect()
    }

    /// Returns the numbers of a column, without missing ones.
    pub(super) fn numbers(&self, at: usize) -> Vec<f64> {
        let cells = self.sheet.rows.iter().map(|row| self.sheet.cell(row, at));
        cells
            .filter_map(|cell| if let Cell::Number(number) = cell { Some(number) } else { None })
            .collect()
    }

    /// Returns the kind of curves without a name: the one given as an option, or the one that the
    /// name of the sheet or file states.
    pub(super) fn kind_of_file(&self) -> Kind {
        let kind =
            |stem: &String| match column::holds(&Title { name: stem.clone(), unit: String::new() })
            {
                Holds::Curve(kind) => Some(kind),
                _ => None,
            };
        self.stems.iter().find_map(kind).unwrap_or(Kind::Unknown)
    }

    /// Returns the kind of a column with this title.
    pub(super) fn kind(&self, title: &Title) -> Kind {
        self.options.kind.unwrap_or_else(|| match column::holds(title) {
            Holds::Curve(kind) | Holds::Contradicts(kind) => kind,
            _ => self.kind_of_file(),
        })
    }

    /// Returns kind, factor and unit of a column with this title.
    pub(super) fn scale(&self, title: &Title) -> Result<Scale, ReadError> {
        let kind = self.kind(title);
        let name = if title.name.is_empty() { "?" } else { &title.name };
        let own = column::unit(&title.unit).filter(|unit| !["", "a.u."].contains(&unit.as_str()));
        let given = self
            .options
            .unit
            .as_ref()
            .map(|unit| column::unit(unit).unwrap_or_else(|| unit.clone()));
        if let (Some(own), Some(given)) = (&own, &given)
            && own != given
        {
            return Err(self.error(format!(
                "column `{name}` says that its unit is {own}, and --unit says {given}; leave --unit out, or correct the \
                 header"
            )));
        }
        let unit = given.unwrap_or_else(|| title.unit.clone());
        column::scale(kind, &unit, self.options.pixel_size_um)
            .map_err(|cause| self.error(format!("column `{name}`: {cause}")))
    }
}

/// Whether fields are increasing numbers; the last may be empty.
pub(super) fn rises(fields: impl Iterator<Item = Cell>) -> bool {
    let mut before = f64::NEG_INFINITY;
    let (mut count, mut ended) = (0, false);
    for field in fields {
        match field {
            Cell::Number(number) if number > before && !ended => {
                before = number;
                count += 1;
            }
            Cell::Missing => ended = true,
            _ => return false,
        }
    }
    count > 2
}
