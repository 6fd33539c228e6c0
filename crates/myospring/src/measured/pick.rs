//! Which fields of a table are curves, and their numbers.

use super::column::{self, Holds, Scale, Title};
use super::curve::{Curve, Table};
use super::decode;
use super::error::ReadError;
use super::number::{self, Cell};
use super::options::{Column, Layout, Options};
use super::sheet::{Row, Sheet};
use super::times::{Clock, Timed};
use super::workbook;
use crate::analysis::kind::Kind;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Columns from which on a table without names may have a curve in each row.
const MANY: usize = 16;

/// Marks closer to each other are of one pulse, ms: no heart beats thirty times a second.
const PULSE_MS: f64 = 30.0;

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
        return of_workbook(path, bytes, options);
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

/// The curves of all sheets, or of those that were asked for; a sheet that has none is a note where another has some.
fn of_workbook(path: &str, bytes: &[u8], options: &Options) -> Result<Table, ReadError> {
    let whole = |cause: String| ReadError::Table { path: path.to_owned(), cause };
    let mut sheets = workbook::sheets(bytes).map_err(|what| whole(format!("it is {what}")))?;
    if sheets.is_empty() {
        return Err(whole("all sheets of the workbook are empty".to_owned()));
    }
    let names: Vec<String> = sheets.iter().map(|sheet| sheet.name.clone()).collect();
    let place = |wanted: &Column| match wanted {
        Column::Number(number) => Some(number - 1).filter(|at| *at < names.len()),
        Column::Name(name) => {
            names.iter().position(|other| other.eq_ignore_ascii_case(name.trim()))
        }
    };
    if !options.sheets.is_empty() {
        let mut kept = Vec::new();
        for wanted in &options.sheets {
            kept.push(place(wanted).ok_or_else(|| {
                whole(format!(
                    "it has no sheet `{}`; its sheets are {}",
                    named(wanted),
                    listed(&names)
                ))
            })?);
        }
        let mut at = 0..;
        sheets.retain(|_| at.next().is_some_and(|at| kept.contains(&at)));
    }
    let several = sheets.len() > 1;
    let (mut curves, mut notes, mut left_out) = (Vec::new(), Vec::new(), Vec::new());
    for sheet in sheets {
        let name = sheet.name;
        let place = format!("{path}`, sheet `{name}");
        let read = Sheet::of_rows(sheet.rows).ok_or_else(|| no_numbers(&place)).and_then(|rows| {
            Picked::of(&place, vec![name.clone(), stem(path)], rows, options).table()
        });
        match read {
            Ok(table) => {
                let of =
                    |note: String| if several { format!("sheet `{name}`: {note}") } else { note };
                notes.extend(table.notes.into_iter().map(of));
                curves.extend(table.curves.into_iter().map(|curve| {
                    let own = if several { format!("{name}: {}", curve.name) } else { curve.name };
                    Curve { name: own, ..curve }
                }));
            }
            Err(error) => left_out.push((name, error)),
        }
    }
    if curves.is_empty() {
        let first = left_out.into_iter().next().map(|(_, error)| error);
        return Err(first.unwrap_or_else(|| whole("it has no sheet with a curve".to_owned())));
    }
    if let Some((name, error)) = left_out.first() {
        let others: Vec<String> = left_out.iter().skip(1).map(|(name, _)| name.clone()).collect();
        let others = if others.is_empty() {
            String::new()
        } else {
            format!("; nor has {}", listed(&others))
        };
        let why = error.cause();
        notes.push(format!("sheet `{name}` has no curve that can be read: {why}{others}"));
    }
    Ok(Table { curves, notes })
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

/// A column that is a curve, and where its times come from.
#[derive(Debug, Clone, Copy)]
struct Chosen {
    at: usize,
    clock: Clock,
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
        let mut curves = self.of_columns()?;
        for curve in &mut curves {
            self.settle(curve);
        }
        if self.options.mean && curves.len() > 1 {
            curves = vec![self.mean(&curves)?];
        }
        let (from, until) = (self.options.from_ms, self.options.until_ms);
        let part = |curve: Curve| curve.part(from, until).map_err(|cause| self.error(cause));
        let curves = curves.into_iter().map(part).collect::<Result<_, _>>()?;
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

    /// Turns a table over whose rows are curves.
    fn orient(&mut self) {
        if self.options.layout == Some(Layout::Columns) {
            return;
        }
        let (width, rows) = (self.sheet.width(), self.sheet.rows.len());
        let first = self.sheet.rows.first().map_or(&[][..], |row| &row.fields);
        let unnamed = self.sheet.header.is_empty();
        // Names and numbers of the curves stand before their frames.
        let text = |row: &Row, at: usize| matches!(self.sheet.cell(row, at), Cell::Text);
        let is_label = |at: usize| {
            let header = self.sheet.header.get(at).is_some_and(|name| !ends_in_number(name));
            let blank = unnamed && first.get(at).is_some_and(|field| !has_digit(field));
            header || blank || (rows > 0 && self.sheet.rows.iter().all(|row| text(row, at)))
        };
        let labels = (0..width).take_while(|at| is_label(*at)).count();
        // Frames or times may stand where names would.
        if are_frames(&self.sheet.header) || (unnamed && first.len() >= MANY && are_frames(first)) {
            self.turn(Some("frame"), labels);
        } else if unnamed
            && rows > 1
            && width > rows
            && 2 * labels < width
            && (width >= MANY || labels > 0)
            && rises(
                first[labels.min(first.len())..]
                    .iter()
                    .map(|field| number::cell(field, self.sheet.decimal)),
            )
        {
            let is_time = |field: &&String| column::holds(&column::title(field)) == Holds::Time;
            let axis = first[..labels].iter().find(is_time);
            let axis = axis.cloned().unwrap_or_else(|| "time".to_owned());
            self.notes.push(
                "times stand in the first row, and each further row is a curve (--layout columns if not)"
                    .to_owned(),
            );
            self.turn(Some(&axis), labels);
        } else if self.options.layout == Some(Layout::Rows) {
            self.turn(None, labels);
        } else if unnamed && width >= MANY && width > rows {
            let down = self.sheet.rows.iter().map(|row| self.sheet.cell(row, 0));
            if rows < 2 || !rises(down) {
                self.notes.push(format!(
                    "{rows} rows of {width} numbers without names: each row is taken as a curve (--layout columns if not)"
                ));
                self.turn(None, labels);
            }
        }
    }

    fn turn(&mut self, axis: Option<&str>, labels: usize) {
        let empty = Sheet {
            header: Vec::new(),
            groups: Vec::new(),
            rows: Vec::new(),
            turned: Vec::new(),
            ..self.sheet
        };
        let sheet = std::mem::replace(&mut self.sheet, empty);
        self.sheet = sheet.turn(axis, labels);
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
            Holds::Curve(kind) => kind,
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

    /// The names of all columns.
    fn names(&self) -> Vec<String> {
        (0..self.sheet.width()).map(|at| self.sheet.name(at)).collect()
    }

    /// The places of a column that was asked for: several where it is named alike for each cell.
    fn find(&self, wanted: &Column, titles: &[Title]) -> Result<Vec<usize>, ReadError> {
        // Of rows that are curves the first is 1.
        let axis = usize::from(self.sheet.turned.len() > 1 && self.has_axis());
        let all = 0..titles.len();
        let found: Vec<usize> = match wanted {
            Column::Number(number) => all.filter(|at| at + 1 == number + axis).collect(),
            Column::Name(name) => {
                let exact = |at: &usize| self.sheet.name(*at).eq_ignore_ascii_case(name);
                let alike = |at: &usize| {
                    let header = self.sheet.header.get(*at);
                    header.is_some_and(|header| header.eq_ignore_ascii_case(name))
                        || titles[*at].name.eq_ignore_ascii_case(name)
                };
                let exact: Vec<usize> = all.clone().filter(exact).collect();
                if exact.is_empty() { all.filter(alike).collect() } else { exact }
            }
        };
        if found.is_empty() {
            return Err(self.error(format!(
                "it has no column `{}`; its columns are {}",
                named(wanted),
                listed(&self.names())
            )));
        }
        Ok(found)
    }

    /// Whether the first column of a table that was turned over has times or frames.
    fn has_axis(&self) -> bool {
        self.sheet.header.len() == self.sheet.turned.len()
            && matches!(
                column::holds(&column::title(&self.sheet.header[0])),
                Holds::Time | Holds::Frame
            )
    }

    /// Each column a curve, or one curve after the other.
    fn of_columns(&mut self) -> Result<Vec<Curve>, ReadError> {
        let titles = self.titles();
        let held: Vec<Holds> = titles.iter().map(column::holds).collect();
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
                curves.push(Curve { stimuli_ms: marks.clone(), ..curve });
            }
        }
        Ok(curves)
    }

    /// Where the times of each column come from: where a table has several columns of times, from the nearest on its left.
    fn clocks(
        &mut self,
        columns: &[usize],
        titles: &[Title],
        held: &[Holds],
    ) -> Result<Vec<Chosen>, ReadError> {
        let all = |what: Holds| -> Vec<usize> {
            (0..held.len()).filter(|at| held[*at] == what && !columns.contains(at)).collect()
        };
        let chosen = match &self.options.time {
            Some(column) => self.find(column, titles)?,
            None if !all(Holds::Time).is_empty() => all(Holds::Time),
            None => all(Holds::Frame).into_iter().take(1).collect(),
        };
        let rate = Clock::of_rate(self.options).map_err(|cause| self.error(cause))?;
        // Without a name the first column is time, where it rises; one that counts has frames.
        let numbers = self.numbers(0);
        let rises = numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] > pair[0]);
        let nameless = self.sheet.header.first().is_none_or(String::is_empty);
        let unnamed = nameless && titles.len() > 1 && rises && !columns.contains(&0);
        let counts = counts(&numbers);
        let sources: Vec<(usize, bool)> = match (&chosen[..], rate) {
            ([_, ..], _) => chosen.iter().map(|at| (*at, held[*at] == Holds::Frame)).collect(),
            ([], Some(_)) if unnamed && counts => vec![(0, true)],
            ([], _) if unnamed && (!counts || self.sheet.header.is_empty()) => vec![(0, false)],
            ([], Some(ms)) => {
                let clock = Clock::Rows { ms };
                return Ok(columns.iter().map(|&at| Chosen { at, clock }).collect());
            }
            ([], None) if !self.sheet.turned.is_empty() => {
                return Err(self.error(
                    "its rows are curves, without times; give the frame rate (--frame-rate 30), in frames a second",
                ));
            }
            ([], None) => {
                return Err(self.error(format!(
                    "it has no column of times; its columns are {}; name one (--time) or give the frame rate \
                     (--frame-rate 250), in frames a second",
                    listed(&self.names())
                )));
            }
        };
        let mut clocks: Vec<(usize, Clock)> = Vec::new();
        let mut notes = Vec::new();
        for (place, &(at, frames)) in sources.iter().enumerate() {
            let end = sources.get(place + 1).map_or(usize::MAX, |(next, _)| *next);
            let start = if place == 0 { 0 } else { at };
            let own: Vec<usize> =
                columns.iter().copied().filter(|column| (start..end).contains(column)).collect();
            if own.is_empty() && sources.len() > 1 {
                continue;
            }
            let kinds: Vec<Kind> = own.iter().map(|at| self.kind(&titles[*at])).collect();
            let values = own.first().map_or_else(Vec::new, |at| self.numbers(*at));
            let timed = Timed { at, frames, kinds: &kinds, values: &values };
            let clock = Clock::of_column(&self.sheet, &timed, self.options, &mut notes);
            clocks.push((start, clock.map_err(|cause| self.error(cause))?));
        }
        self.notes.append(&mut notes);
        let of = |at: usize| {
            let found = clocks.iter().rev().find(|(start, _)| *start <= at).or(clocks.first());
            found.map(|(_, clock)| Chosen { at, clock: *clock })
        };
        Ok(columns.iter().filter_map(|at| of(*at)).collect())
    }

    /// When a pacer's marks stand, ms on the clock of the curves: the beginning of each pulse.
    fn marks(&mut self, held: &[Holds], clock: Option<Clock>) -> Result<Vec<f64>, ReadError> {
        let place = held.iter().position(|held| *held == Holds::MarkTime);
        let place = place.filter(|_| !self.options.ignore_marks);
        let (Some(at), Some(clock)) = (place, clock) else { return Ok(Vec::new()) };
        let clock = clock.of_other(at);
        if !matches!(clock, Clock::Times { .. }) {
            return Ok(Vec::new());
        }
        let mut times = Vec::new();
        let mut others = 0;
        for row in &self.sheet.rows {
            let label = row.fields.get(at + 1).map_or("", String::as_str).to_lowercase();
            let Some(time) = clock.time(self.path, &self.sheet, row, 0)? else { continue };
            let is_text = label.chars().any(char::is_alphabetic);
            if !is_text || ["pac", "stim", "ttl"].iter().any(|word| label.contains(word)) {
                times.push(time);
            } else {
                others += 1;
            }
        }
        times.sort_by(f64::total_cmp);
        // A pulse is marked where it begins and where it ends.
        times.dedup_by(|time, before| *time - *before < PULSE_MS);
        if !times.is_empty() {
            self.notes.push(format!(
                "{} marks of a pacer in column `{}` are taken as stimuli, unless others are given (--ignore-marks leaves them out)",
                times.len(),
                self.sheet.name(at)
            ));
        }
        if others > 0 {
            self.notes.push(format!(
                "{others} other marks in column `{}` are passed over",
                self.sheet.name(at)
            ));
        }
        Ok(times)
    }

    /// The columns that are curves.
    fn columns(&mut self, titles: &[Title], held: &[Holds]) -> Result<Vec<usize>, ReadError> {
        let times: Vec<usize> = match &self.options.time {
            Some(column) => self.find(column, titles)?,
            None => Vec::new(),
        };
        if !self.options.values.is_empty() {
            let found = self.options.values.iter().map(|wanted| self.find(wanted, titles));
            return Ok(found.collect::<Result<Vec<_>, _>>()?.concat());
        }
        let free = |at: &usize| {
            !times.contains(at)
                && !matches!(
                    held[*at],
                    Holds::Time | Holds::Frame | Holds::Identity | Holds::MarkTime
                )
        };
        let has_numbers = |at: &usize| !self.numbers(*at).is_empty();
        let mostly = |at: &usize| 2 * self.numbers(*at).len() > self.sheet.rows.len();
        let known: Vec<usize> = (0..titles.len())
            .filter(free)
            .filter(|at| matches!(held[*at], Holds::Curve(_)))
            .filter(has_numbers)
            .collect();
        let of_kind: Vec<usize> = known
            .iter()
            .copied()
            .filter(|at| self.options.kind.is_some_and(|kind| held[*at] == Holds::Curve(kind)))
            .collect();
        // Without a header the first column may be time, which only the clock can tell.
        let first_is_time = self.sheet.header.first().is_none_or(String::is_empty)
            && titles.len() > 1
            && self.options.time.is_none()
            && !held.iter().any(|held| matches!(held, Holds::Time | Holds::Frame))
            && rises(self.numbers(0).into_iter().map(Cell::Number));
        let mut others: Vec<usize> = (0..titles.len())
            .filter(free)
            .filter(|at| held[*at] == Holds::Other && !(*at == 0 && first_is_time))
            // The first column without a name is the number of the row.
            .filter(|at| self.sheet.header.is_empty() || !titles[*at].name.is_empty())
            .filter(mostly)
            .collect();
        if !of_kind.is_empty() {
            return Ok(of_kind);
        }
        let passed_over = |at: &[usize], why: &str| {
            let names: Vec<String> = at.iter().map(|at| self.sheet.name(*at)).collect();
            format!("passed over, since {why}: {} (--columns takes them)", listed(&names))
        };
        if !known.is_empty() {
            // Rows that are curves are called as their cells are.
            if !self.sheet.turned.is_empty() {
                let mut all = [known, others].concat();
                all.sort_unstable();
                return Ok(all);
            }
            if !others.is_empty() {
                let note = passed_over(&others, "their names say nothing of a curve");
                self.notes.push(note);
            }
            return Ok(known);
        }
        // Numbers of rows, places and channels.
        let still = |at: &usize| {
            let numbers = self.numbers(*at);
            numbers.len() > 2
                && (counts(&numbers) || numbers.iter().all(|number| *number == numbers[0]))
        };
        let dead: Vec<usize> = others.iter().copied().filter(still).collect();
        if dead.len() < others.len() && !dead.is_empty() {
            let note = passed_over(&dead, "they only count, or never change");
            others.retain(|at| dead.binary_search(at).is_err());
            self.notes.push(note);
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
                let (line, column) = self.sheet.place(row, clock.column().unwrap_or(0));
                return Err(ReadError::Field {
                    path: self.path.to_owned(),
                    line,
                    column,
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
            let (line, column) = self.sheet.place(row, at);
            let field = |cause: String| ReadError::Field {
                path: self.path.to_owned(),
                line,
                column: column.clone(),
                cause,
            };
            let text = row.fields.get(at).map_or("", String::as_str);
            match (self.sheet.cell(row, at), time) {
                (Cell::Number(value), Some(time)) => {
                    if let Some(error) = gap.take() {
                        return Err(error);
                    }
                    if let Some(cause) = number::is_too_large(value) {
                        return Err(field(cause));
                    }
                    times_ms.push(time);
                    values.push(value * scale.factor);
                    lines.push(line);
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
        if let Some(cause) = number::are_too_small(&values) {
            return Err(self.error(format!("column `{name}`: {cause}")));
        }
        Ok(Curve {
            name,
            kind: scale.kind,
            unit: scale.unit,
            times_ms,
            values,
            lines,
            stimuli_ms: Vec::new(),
        })
    }

    /// Values that may have been meant in two ways.
    fn settle(&mut self, curve: &mut Curve) {
        let count = curve.values.len().max(1) as f64;
        let mean = curve.values.iter().sum::<f64>() / count;
        let most = curve.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
        let says_unit = self.options.unit.is_some()
            || !column::title(&curve.name).unit.is_empty()
                && self.sheet.header.contains(&curve.name);
        let mut note = |text: String| {
            if self.shared.insert(text.clone()) {
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

fn counts(numbers: &[f64]) -> bool {
    numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}

fn has_digit(text: &str) -> bool {
    text.chars().any(|letter| letter.is_ascii_digit())
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
