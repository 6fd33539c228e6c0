//! Which fields of a table are curves, and their numbers.

mod book;
mod choose;
mod orient;
mod values;

use super::column::{self, Holds, Scale, Title};
use super::curve::{Curve, Table};
use super::decode;
use super::error::ReadError;
use super::number::Cell;
use super::options::{Column, Options};
use super::sheet::{Row, Sheet};
use super::times::Clock;
use crate::analysis::kind::Kind;
use choose::Chosen;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Columns from which on a table without names may have a curve in each row.
const MANY: usize = 16;

/// Names that an error lists.
const LISTED: usize = 5;

/// A table of a file, what is in it and what was said of it.
pub(super) struct Picked<'a> {
    /// What errors call it: the file, and which sheet of it.
    path: &'a str,
    /// What may tell of curves without names: the sheet, then the file.
    stems: Vec<String>,
    sheet: Sheet,
    options: &'a Options,
    notes: Vec<String>,
    /// Notes that many columns share, each said once.
    shared: BTreeSet<String>,
}

/// The curves of a file's bytes.
pub(super) fn table(path: &str, bytes: &[u8], options: &Options) -> Result<Table, ReadError> {
    if let (Some(from), Some(until)) = (options.from_ms, options.until_ms)
        && from >= until
    {
        let cause = format!(
            "the part from {from} to {until} ms has no frame: its end must come after its start"
        );
        return Err(ReadError::Table { path: path.to_owned(), cause });
    }
    if decode::is_workbook(bytes) {
        return book::of_workbook(path, bytes, options);
    }
    let text = decode::decoded(bytes)
        .map_err(|what| ReadError::NotText { path: path.to_owned(), what })?;
    let sheet = Sheet::of(&text, options.delimiter, options.decimal);
    let sheet = sheet.ok_or_else(|| no_numbers(path))?;
    Picked::of(path, vec![stem(path)], sheet, options).table()
}

fn no_numbers(path: &str) -> ReadError {
    ReadError::Table {
        path: path.to_owned(),
        cause: "it has no line with numbers; a table of a curve has a column of times and one of values, such as \
                `time (ms),length (um)`"
            .to_owned(),
    }
}

fn stem(path: &str) -> String {
    Path::new(path).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default()
}
fn named(column: &Column) -> String {
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
    fn of(path: &'a str, stems: Vec<String>, sheet: Sheet, options: &'a Options) -> Self {
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
    fn table(mut self) -> Result<Table, ReadError> {
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

    fn error(&self, cause: impl Into<String>) -> ReadError {
        ReadError::Table { path: self.path.to_owned(), cause: cause.into() }
    }

    fn titles(&self) -> Vec<Title> {
        let header = |at| self.sheet.header.get(at).map_or("", String::as_str);
        (0..self.sheet.width()).map(|at| column::title(header(at))).collect()
    }

    /// Numbers of a column, as far as there are any.
    fn numbers(&self, at: usize) -> Vec<f64> {
        let cells = self.sheet.rows.iter().map(|row| self.sheet.cell(row, at));
        cells
            .filter_map(|cell| if let Cell::Number(number) = cell { Some(number) } else { None })
            .collect()
    }

    /// What curves without a name of their own are: what was said, or what the file is called.
    fn kind_of_file(&self) -> Kind {
        let kind =
            |stem: &String| match column::holds(&Title { name: stem.clone(), unit: String::new() })
            {
                Holds::Curve(kind) => Some(kind),
                _ => None,
            };
        self.stems.iter().find_map(kind).unwrap_or(Kind::Unknown)
    }

    /// The kind of a column of this title.
    fn kind(&self, title: &Title) -> Kind {
        self.options.kind.unwrap_or_else(|| match column::holds(title) {
            Holds::Curve(kind) | Holds::Contradicts(kind) => kind,
            _ => self.kind_of_file(),
        })
    }

    /// Kind, factor and unit of a column of this title.
    fn scale(&self, title: &Title) -> Result<Scale, ReadError> {
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
    /// Each column a curve, or one curve after the other; and whether the unit of each is said.
    fn of_columns(&mut self) -> Result<Vec<(Curve, bool)>, ReadError> {
        let titles = self.titles();
        let held = column::all_hold(&titles);
        let columns = self.columns(&titles, &held)?;
        let chosen = self.clocks(&columns, &titles, &held)?;
        let marks = self.marks(&held, chosen.first().map(|chosen| chosen.clock))?;
        let identity = held.iter().position(|held| *held == Holds::Identity);
        let identity = identity.filter(|at| {
            let repeats = |column| self.numbers(column).windows(2).any(|pair| pair[1] <= pair[0]);
            let clock = chosen.first().and_then(|chosen| chosen.clock.column());
            !columns.contains(at) && clock.is_some_and(repeats)
        });
        let groups: Vec<(Option<String>, Vec<&Row>)> = match identity {
            None => vec![(None, self.sheet.rows.iter().collect())],
            Some(at) => {
                let mut order = Vec::new();
                let mut groups = BTreeMap::<String, Vec<&Row>>::new();
                for row in &self.sheet.rows {
                    let name = row.fields.get(at).cloned().unwrap_or_default();
                    if !groups.contains_key(&name) {
                        order.push(name.clone());
                    }
                    groups.entry(name).or_default().push(row);
                }
                let of = |name: String| {
                    let rows = groups.remove(&name).unwrap_or_default();
                    (Some(format!("{} {name}", self.sheet.name(at))), rows)
                };
                order.into_iter().map(of).collect()
            }
        };
        let mut curves = Vec::new();
        for (group, rows) in &groups {
            let mut known: Option<(Clock, Vec<Option<f64>>)> = None;
            for &Chosen { at, clock } in &chosen {
                if known.as_ref().is_none_or(|(other, _)| *other != clock) {
                    let mut times = Vec::with_capacity(rows.len());
                    for (index, row) in rows.iter().enumerate() {
                        times.push(clock.time(self.path, &self.sheet, row, index)?);
                    }
                    self.check_times(rows, &times, clock)?;
                    known = Some((clock, times));
                }
                let times = known.as_ref().map_or(&[][..], |(_, times)| times);
                let scale = self.scale(&titles[at])?;
                let samples = rows.iter().zip(times).map(|(row, time)| (*row, at, *time));
                let column = self.sheet.name(at);
                let name = match group {
                    Some(group) if columns.len() == 1 => group.clone(),
                    Some(group) => format!("{group}, {column}"),
                    None => column,
                };
                let curve = self.curve(name, scale, samples)?;
                let says_unit = self.options.unit.is_some() || !titles[at].unit.is_empty();
                curves.push((Curve { stimuli_ms: marks.clone(), ..curve }, says_unit));
            }
        }
        Ok(curves)
    }
}

/// Whether fields are numbers of which each is larger than the one before; the last may be empty.
fn rises(fields: impl Iterator<Item = Cell>) -> bool {
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
