//! A table of a file as it is picked apart: what all of its parts ask of it.

use crate::analysis::kind::Kind;
use crate::measured::column::{self, Holds, Scale, Title};
use crate::measured::curve::{Curve, Table};
use crate::measured::error::ReadError;
use crate::measured::number::Cell;
use crate::measured::options::{Column, Options};
use crate::measured::sheet::Sheet;
use std::collections::BTreeSet;
use std::path::Path;

/// Columns from which on a table without names may have a curve in each row.
pub(super) const MANY: usize = 16;

/// Names that an error lists.
const LISTED: usize = 5;

/// A table of a file, what is in it and what was said of it.
pub(in crate::measured) struct Picked<'a> {
    /// What errors call it: the file, and which sheet of it.
    pub(super) path: &'a str,
    /// What may tell of curves without names: the sheet, then the file.
    pub(super) stems: Vec<String>,
    pub(super) sheet: Sheet,
    pub(super) options: &'a Options,
    pub(super) notes: Vec<String>,
    /// Notes that many columns share, each said once.
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

/// The first few names, and how many others there are.
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
        options: &'a Options,
    ) -> Self {
        let mut notes = Vec::new();
        if sheet.above > 0 {
            notes.push(format!(
                "{} lines of numbers above the line of names are left out; if they are another part of the recording, \
                 put it into a file of its own",
                sheet.above
            ));
        }
        Self { path, stems, sheet, options, notes, shared: BTreeSet::new() }
    }

    /// The curves.
    pub(super) fn table(mut self) -> Result<Table, ReadError> {
        self.orient();
        self.check_width()?;
        self.sheet.note_names();
        if !self.sheet.again.is_empty() {
            let names: BTreeSet<String> =
                self.sheet.again.iter().map(|at| self.sheet.header[*at].clone()).collect();
            let names: Vec<String> = names.into_iter().collect();
            self.notes.push(format!(
                "several columns have one name, and are told apart by their numbers: {}",
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

    /// Refuses a number that stands beyond the last column: the columns before it may be others than their names say.
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
                "\"{}\" is one field too many: {columns}; name the column, or mend the row (a decimal comma needs another \
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

    /// Numbers of a column, as far as there are any.
    pub(super) fn numbers(&self, at: usize) -> Vec<f64> {
        let cells = self.sheet.rows.iter().map(|row| self.sheet.cell(row, at));
        cells
            .filter_map(|cell| if let Cell::Number(number) = cell { Some(number) } else { None })
            .collect()
    }

    /// What curves without a name of their own are: what was said, or what the file is called.
    pub(super) fn kind_of_file(&self) -> Kind {
        let kind =
            |stem: &String| match column::holds(&Title { name: stem.clone(), unit: String::new() })
            {
                Holds::Curve(kind) => Some(kind),
                _ => None,
            };
        self.stems.iter().find_map(kind).unwrap_or(Kind::Unknown)
    }

    /// The kind of a column of this title.
    pub(super) fn kind(&self, title: &Title) -> Kind {
        self.options.kind.unwrap_or_else(|| match column::holds(title) {
            Holds::Curve(kind) | Holds::Contradicts(kind) => kind,
            _ => self.kind_of_file(),
        })
    }

    /// Kind, factor and unit of a column of this title.
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
                "column `{name}` says that its unit is {own}, and --unit says {given}; leave --unit out, or mend the \
                 header"
            )));
        }
        let unit = given.unwrap_or_else(|| title.unit.clone());
        column::scale(kind, &unit, self.options.pixel_size_um)
            .map_err(|cause| self.error(format!("column `{name}`: {cause}")))
    }
}

/// Whether fields are numbers of which each is larger than the one before; the last may be empty.
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
