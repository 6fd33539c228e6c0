//! Finds the curves in a table and reads their numbers.

mod book;
mod choose;
mod orient;
mod picked;
mod values;

pub(crate) use picked::listed;

use super::column::{self, Holds};
use super::curve::{Curve, Table};
use super::decode;
use super::error::ReadError;
use super::options::TableOptions;
use super::sheet::{Row, Sheet};
use super::times::Clock;
use choose::Chosen;
use picked::{Picked, no_numbers, stem};
use std::collections::BTreeMap;

/// Reads the curves from the bytes of a file.
pub(super) fn table(path: &str, bytes: &[u8], options: &TableOptions) -> Result<Table, ReadError> {
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

impl Picked<'_> {
    /// Reads a table whose columns are curves or in which one curve follows another; returns each
    /// curve and whether its unit is stated.
    pub(super) fn of_columns(&mut self) -> Result<Vec<(Curve, bool)>, ReadError> {
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
