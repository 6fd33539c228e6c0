//! Which fields of a table are curves, and their numbers.

use super::column::{self, Holds, Scale, Title};
use super::curve::{Curve, Table};
use super::decode;
use super::error::ReadError;
use super::number::Cell;
use super::options::{Column, Layout, Options};
use super::sheet::{Row, Sheet};
use super::times::Clock;
use crate::analysis::kind::Kind;
use std::collections::BTreeMap;
use std::path::Path;

/// Columns from which on a table without names may have a curve in each row.
const MANY: usize = 16;

/// A file, what is in it and what was said of it.
pub(super) struct Picked<'a> {
    path: &'a str,
    sheet: Sheet,
    options: &'a Options,
    notes: Vec<String>,
}

impl<'a> Picked<'a> {
    pub(super) fn of(path: &'a str, bytes: &[u8], options: &'a Options) -> Result<Self, ReadError> {
        let text = decode::decoded(bytes)
            .map_err(|what| ReadError::NotText { path: path.to_owned(), what })?;
        let sheet = Sheet::of(&text, options.delimiter, options.decimal);
        let sheet = sheet.ok_or_else(|| ReadError::Table {
            path: path.to_owned(),
            cause: "it has no line with numbers; a table of a curve has a column of times and one of values, such as \
                    `time (ms),length (um)`"
                .to_owned(),
        })?;
        Ok(Self { path, sheet, options, notes: Vec::new() })
    }

    /// The curves.
    pub(super) fn table(mut self) -> Result<Table, ReadError> {
        let mut curves = match self.layout() {
            Layout::Rows => self.of_rows()?,
            Layout::Columns => self.of_columns()?,
        };
        for curve in &mut curves {
            self.settle(curve);
        }
        if self.options.mean && curves.len() > 1 {
            curves = vec![self.mean(&curves)?];
        }
        Ok(Table { curves, notes: self.notes })
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

    fn layout(&mut self) -> Layout {
        if let Some(layout) = self.options.layout {
            return layout;
        }
        // The numbers of frames may stand where names would.
        if self.sheet.header.is_empty()
            && let Some(first) = self.sheet.rows.first()
            && first.fields.len() >= MANY
            && are_frames(&first.fields)
        {
            self.sheet.header = self.sheet.rows.remove(0).fields;
        }
        if are_frames(&self.sheet.header) {
            return Layout::Rows;
        }
        let (width, rows) = (self.sheet.width(), self.sheet.rows.len());
        let rises = self.numbers(0).windows(2).all(|pair| pair[1] > pair[0]);
        if self.sheet.header.is_empty() && width >= MANY && width > rows && !(rises && rows > 1) {
            self.notes.push(format!(
                "{rows} rows of {width} numbers without names: each row is taken as a curve (--layout columns if not)"
            ));
            return Layout::Rows;
        }
        Layout::Columns
    }

    /// What curves without a name of their own are: what was said, or what the file is called.
    fn kind_of_file(&self) -> Kind {
        let stem = Path::new(self.path).file_stem().map(|stem| stem.to_string_lossy().into_owned());
        let title = Title { name: stem.unwrap_or_default(), unit: String::new() };
        match column::holds(&title) {
            Holds::Curve(kind) => kind,
            _ => Kind::Unknown,
        }
    }

    /// Kind, factor and unit of a column of this title.
    fn scale(&self, title: &Title) -> Result<Scale, ReadError> {
        let named = match column::holds(title) {
            Holds::Curve(kind) => kind,
            _ => self.kind_of_file(),
        };
        let kind = self.options.kind.unwrap_or(named);
        let unit = match &self.options.unit {
            Some(unit) => column::unit(unit).unwrap_or_else(|| unit.clone()),
            None => title.unit.clone(),
        };
        column::scale(kind, &unit, self.options.pixel_size_um).map_err(|cause| {
            self.error(format!(
                "column `{}`: {cause}",
                if title.name.is_empty() { "?" } else { &title.name }
            ))
        })
    }

    /// Each row a curve.
    fn of_rows(&mut self) -> Result<Vec<Curve>, ReadError> {
        let ms = Clock::of_rate(self.options).map_err(|cause| self.error(cause))?;
        let ms = ms.ok_or_else(|| {
            self.error("its rows are curves, without times; give the frame rate (--frame-rate 30), in frames a second")
        })?;
        // Names and numbers of the curves may stand before their frames.
        let named = |at: usize| {
            let header = self.sheet.header.get(at).is_some_and(|name| !ends_in_number(name));
            let text = |row: &Row| matches!(self.sheet.cell(row, at), Cell::Text);
            header || (!self.sheet.rows.is_empty() && self.sheet.rows.iter().all(text))
        };
        let first = (0..self.sheet.width()).take_while(|at| named(*at)).count();
        let scale = self.scale(&Title { name: String::new(), unit: String::new() })?;
        let mut curves = Vec::new();
        for (number, row) in (1..).zip(&self.sheet.rows) {
            let name = row.fields.first().filter(|_| first > 0).cloned();
            let name = name.filter(|name| !name.is_empty()).unwrap_or_else(|| number.to_string());
            if !self.wanted(number, &name) {
                continue;
            }
            let samples =
                (first..row.fields.len()).map(|at| (row, at, Some((at - first) as f64 * ms)));
            curves.push(self.curve(name, scale, samples)?);
        }
        if curves.is_empty() {
            return Err(self.error(format!(
                "none of its {} rows is one of those asked for",
                self.sheet.rows.len()
            )));
        }
        Ok(curves)
    }

    fn wanted(&self, number: usize, name: &str) -> bool {
        let is = |column: &Column| match column {
            Column::Number(wanted) => *wanted == number,
            Column::Name(wanted) => wanted.eq_ignore_ascii_case(name),
        };
        self.options.values.is_empty() || self.options.values.iter().any(is)
    }

    /// The place of a column that was asked for.
    fn find(&self, wanted: &Column, titles: &[Title]) -> Result<usize, ReadError> {
        let names = || {
            let names: Vec<String> =
                (0..titles.len()).map(|at| format!("`{}`", self.sheet.name(at))).collect();
            names.join(", ")
        };
        let found = match wanted {
            Column::Number(number) => Some(number - 1).filter(|at| *at < titles.len()),
            Column::Name(name) => (0..titles.len()).find(|&at| {
                self.sheet.name(at).eq_ignore_ascii_case(name)
                    || titles[at].name.eq_ignore_ascii_case(name)
            }),
        };
        found.ok_or_else(|| {
            let wanted = match wanted {
                Column::Number(number) => number.to_string(),
                Column::Name(name) => name.clone(),
            };
            self.error(format!("it has no column `{wanted}`; its columns are {}", names()))
        })
    }

    /// Each column a curve, or one curve after the other.
    fn of_columns(&mut self) -> Result<Vec<Curve>, ReadError> {
        let titles = self.titles();
        let held: Vec<Holds> = titles.iter().map(column::holds).collect();
        let clock = self.clock(&titles, &held)?;
        let columns = self.columns(&titles, &held, clock)?;
        let identity = held.iter().position(|held| *held == Holds::Identity);
        let identity = identity.filter(|at| {
            let repeats = |column| self.numbers(column).windows(2).any(|pair| pair[1] <= pair[0]);
            !columns.contains(at) && clock.column().is_some_and(repeats)
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
            let mut times = Vec::with_capacity(rows.len());
            for (index, row) in rows.iter().enumerate() {
                times.push(clock.time(self.path, &self.sheet, row, index)?);
            }
            self.check_times(rows, &times, clock)?;
            for &at in &columns {
                let scale = self.scale(&titles[at])?;
                let samples = rows.iter().zip(&times).map(|(row, time)| (*row, at, *time));
                let column = self.sheet.name(at);
                let name = match group {
                    Some(group) if columns.len() == 1 => group.clone(),
                    Some(group) => format!("{group}, {column}"),
                    None => column,
                };
                curves.push(self.curve(name, scale, samples)?);
            }
        }
        Ok(curves)
    }

    /// Where times come from.
    fn clock(&mut self, titles: &[Title], held: &[Holds]) -> Result<Clock, ReadError> {
        let is_frames = |at: usize| held[at] == Holds::Frame;
        let find = |what: Holds| held.iter().position(|held| *held == what);
        let chosen = match &self.options.time {
            Some(column) => Some(self.find(column, titles)?),
            None => find(Holds::Time).or_else(|| find(Holds::Frame)),
        };
        // Without names the first column is time, where it rises.
        let numbers = self.numbers(0);
        let rises = numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] > pair[0]);
        let unnamed = self.sheet.header.is_empty() && titles.len() > 1 && rises;
        let counts = numbers.windows(2).all(|pair| pair[1] - pair[0] == 1.0);
        let rate = Clock::of_rate(self.options).map_err(|cause| self.error(cause))?;
        let (at, frames) = match (chosen, rate) {
            (Some(at), _) => (at, is_frames(at)),
            (None, Some(_)) if unnamed && counts => (0, true),
            (None, _) if unnamed => (0, false),
            (None, Some(ms)) => return Ok(Clock::Rows { ms }),
            (None, None) => {
                let names: Vec<String> =
                    (0..titles.len()).map(|at| format!("`{}`", self.sheet.name(at))).collect();
                return Err(self.error(format!(
                    "it has no column of times; its columns are {}; name one (--time) or give the frame rate \
                     (--frame-rate 250), in frames a second",
                    names.join(", ")
                )));
            }
        };
        let mut notes = Vec::new();
        let clock = Clock::of_column(&self.sheet, at, frames, self.options, &mut notes);
        self.notes.append(&mut notes);
        clock.map_err(|cause| self.error(cause))
    }

    /// The columns that are curves.
    fn columns(
        &mut self,
        titles: &[Title],
        held: &[Holds],
        clock: Clock,
    ) -> Result<Vec<usize>, ReadError> {
        if !self.options.values.is_empty() {
            return self.options.values.iter().map(|wanted| self.find(wanted, titles)).collect();
        }
        let free = |at: &usize| {
            Some(*at) != clock.column()
                && !matches!(held[*at], Holds::Time | Holds::Frame | Holds::Identity)
        };
        let has_numbers = |at: &usize| 2 * self.numbers(*at).len() > self.sheet.rows.len();
        let known: Vec<usize> = (0..titles.len())
            .filter(free)
            .filter(|at| matches!(held[*at], Holds::Curve(_)))
            .collect();
        let of_kind: Vec<usize> = known
            .iter()
            .copied()
            .filter(|at| self.options.kind.is_some_and(|kind| held[*at] == Holds::Curve(kind)))
            .collect();
        let others: Vec<usize> = (0..titles.len())
            .filter(free)
            .filter(|at| held[*at] == Holds::Other)
            // The first column without a name is the number of the row.
            .filter(|at| self.sheet.header.is_empty() || !titles[*at].name.is_empty())
            .filter(has_numbers)
            .collect();
        if !of_kind.is_empty() {
            return Ok(of_kind);
        }
        if !known.is_empty() {
            if !others.is_empty() {
                let names: Vec<String> =
                    others.iter().map(|at| format!("`{}`", self.sheet.name(*at))).collect();
                self.notes.push(format!(
                    "passed over, since their names say nothing of a curve: {} (--columns takes them)",
                    names.join(", ")
                ));
            }
            return Ok(known);
        }
        if others.is_empty() {
            return Err(self.error("it has no column of values beside the times"));
        }
        Ok(others)
    }

    fn check_times(
        &self,
        rows: &[&Row],
        times: &[Option<f64>],
        clock: Clock,
    ) -> Result<(), ReadError> {
        let mut before = f64::NEG_INFINITY;
        for (row, time) in rows.iter().zip(times) {
            let Some(time) = *time else { continue };
            if time <= before {
                return Err(ReadError::Field {
                    path: self.path.to_owned(),
                    line: row.line,
                    column: self.sheet.name(clock.column().unwrap_or(0)),
                    cause: format!(
                        "time {time} ms does not come after {before} ms; times must rise from row to row (several \
                         recordings one below the other need a file each)"
                    ),
                });
            }
            before = time;
        }
        Ok(())
    }

    /// One curve from its fields and their times; a curve that ends before the table, or begins after it, is shorter.
    fn curve<'r>(
        &self,
        name: String,
        scale: Scale,
        fields: impl Iterator<Item = (&'r Row, usize, Option<f64>)>,
    ) -> Result<Curve, ReadError> {
        let (mut times_ms, mut values, mut lines) = (Vec::new(), Vec::new(), Vec::new());
        let mut gap = None;
        for (row, at, time) in fields {
            let field = |cause: String| ReadError::Field {
                path: self.path.to_owned(),
                line: row.line,
                column: self.sheet.name(at),
                cause,
            };
            let text = row.fields.get(at).map_or("", String::as_str);
            match (self.sheet.cell(row, at), time) {
                (Cell::Number(value), Some(time)) => {
                    if let Some(error) = gap.take() {
                        return Err(error);
                    }
                    times_ms.push(time);
                    values.push(value * scale.factor);
                    lines.push(row.line);
                }
                (Cell::Number(value), None) => return Err(field(format!("{value} has no time"))),
                (Cell::Missing, _) if values.is_empty() || self.options.skip_gaps => {}
                (Cell::Missing, _) => {
                    gap.get_or_insert(field(format!(
                        "\"{text}\" is no finite number; delete the row, or leave such frames out (--skip-gaps)"
                    )));
                }
                (Cell::Text, _) => {
                    return Err(field(format!(
                        "\"{text}\" is no finite number; mend or delete the row (a decimal comma needs another \
                         delimiter than the comma)"
                    )));
                }
            }
        }
        if values.is_empty() {
            return Err(self.error(format!("column `{name}` has no number")));
        }
        Ok(Curve { name, kind: scale.kind, unit: scale.unit, times_ms, values, lines })
    }

    /// Values that may have been meant in two ways.
    fn settle(&mut self, curve: &mut Curve) {
        let count = curve.values.len().max(1) as f64;
        let mean = curve.values.iter().sum::<f64>() / count;
        let most = curve.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let says_unit = self.options.unit.is_some()
            || self
                .sheet
                .header
                .iter()
                .any(|name| name == &curve.name && !column::title(name).unit.is_empty());
        let mut note = |text: String| {
            if !self.notes.contains(&text) {
                self.notes.push(text);
            }
        };
        match curve.kind {
            Kind::Shortening if !says_unit && most <= 1.0 => {
                curve.values.iter_mut().for_each(|value| *value *= 100.0);
                note("a shortening without a unit that is at most 1 is taken as a fraction (--unit % if not)".to_owned());
            }
            Kind::NormalisedLength if mean.abs() < 0.5 => {
                curve.values.iter_mut().for_each(|value| *value += 1.0);
                note(
                    "a normalised length around 0 is taken as the change from its mean, (L - mean) / mean".to_owned(),
                );
            }
            Kind::NormalisedLength if !says_unit && mean > 20.0 => {
                curve.values.iter_mut().for_each(|value| *value *= 0.01);
                note("a normalised length near 100 is taken as % (--unit % says so)".to_owned());
            }
            Kind::Length | Kind::SarcomereLength
                if curve.unit == "um" && !says_unit && self.options.pixel_size_um.is_none() =>
            {
                note(format!(
                    "{} without a unit: taken as um (--unit px, with --pixel-size, if not)",
                    curve.kind
                ));
            }
            Kind::Unknown => note(format!(
                "column `{}` does not say what it is: taken as a motion of arbitrary unit, whichever way it goes \
                 (--kind length, shortening, calcium-ratio, ... says it)",
                curve.name
            )),
            _ => {}
        }
    }

    /// The mean of curves with the same times.
    fn mean(&self, curves: &[Curve]) -> Result<Curve, ReadError> {
        let first = &curves[0];
        if let Some(other) = curves.iter().find(|curve| {
            (curve.kind, curve.unit) != (first.kind, first.unit) || curve.times_ms != first.times_ms
        }) {
            return Err(self.error(format!(
                "`{}` and `{}` have no mean: it needs curves of one kind and unit at the same times",
                first.name, other.name
            )));
        }
        let count = curves.len() as f64;
        let value = |at: usize| curves.iter().map(|curve| curve.values[at]).sum::<f64>() / count;
        Ok(Curve {
            name: format!("mean of {}", curves.len()),
            values: (0..first.values.len()).map(value).collect(),
            ..first.clone()
        })
    }
}

/// Whether names are numbers of frames: `frame0, frame1, ...`, or numbers alone, after at most two other columns.
fn are_frames(names: &[String]) -> bool {
    let skip = names.iter().take(2).take_while(|name| !ends_in_number(name)).count();
    let names = &names[skip..];
    let parts: Option<Vec<(&str, i64)>> = names
        .iter()
        .map(|name| {
            let prefix = name.trim_end_matches(|letter: char| letter.is_ascii_digit());
            name[prefix.len()..]
                .parse::<i64>()
                .ok()
                .map(|number| (prefix.trim_end_matches(['_', ' ']), number))
        })
        .collect();
    let Some(parts) = parts.filter(|parts| parts.len() > 2) else { return false };
    let prefix = parts[0].0.to_lowercase();
    (["frame", "frames", "f", "t", "img", "image"].contains(&prefix.as_str())
        || (prefix.is_empty() && parts.len() >= MANY))
        && parts.windows(2).all(|pair| pair[1].0 == pair[0].0 && pair[1].1 == pair[0].1 + 1)
}

fn ends_in_number(name: &str) -> bool {
    name.ends_with(|letter: char| letter.is_ascii_digit())
}
