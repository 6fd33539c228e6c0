//! Chooses the columns that are curves, the source of their times, and the columns with marks of a
//! pacer.

use super::picked::{Picked, listed, named, rises};
use crate::analysis::kind::Kind;
use crate::measured::column::{self, Holds, Title};
use crate::measured::error::ReadError;
use crate::measured::number::Cell;
use crate::measured::options::Column;
use crate::measured::times::{Clock, Timed};
use std::collections::BTreeSet;

/// Marks closer together than this belong to one pulse, ms: no heart beats thirty times a second.
const PULSE_MS: f64 = 30.0;
/// A column that is a curve, and the source of its times.
#[derive(Debug, Clone, Copy)]
pub(super) struct Chosen {
    pub(super) at: usize,
    pub(super) clock: Clock,
}

impl Picked<'_> {
    /// Returns the names of all columns.
    pub(super) fn names(&self) -> Vec<String> {
        (0..self.sheet.width()).map(|at| self.sheet.name(at)).collect()
    }

    /// Returns the indices of a requested column; several if each cell has a column of that name.
    pub(super) fn find(&self, wanted: &Column, titles: &[Title]) -> Result<Vec<usize>, ReadError> {
        // If the rows are curves, the first row is number 1.
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

    /// Whether the first column of a transposed table contains times or frames.
    pub(super) fn has_axis(&self) -> bool {
        self.sheet.header.len() == self.sheet.turned.len()
            && matches!(
                column::holds(&column::title(&self.sheet.header[0])),
                Holds::Time | Holds::Frame
            )
    }
    /// Returns the source of the times of each column. If a table has several columns of times, a
    /// column belongs to the nearest one on its left.
    pub(super) fn clocks(
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
        // Without a name, the first column is time if it increases, or frames if it counts.
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
                notes.push(format!(
                    "column `{}` has times but no curve: ignored (choose it by --time)",
                    self.sheet.name(at)
                ));
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

    /// Returns the start of each pulse of a pacer, ms on the clock of the curves.
    pub(super) fn marks(
        &mut self,
        held: &[Holds],
        clock: Option<Clock>,
    ) -> Result<Vec<f64>, ReadError> {
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
        // A pulse is marked at its start and at its end.
        times.dedup_by(|time, before| *time - *before < PULSE_MS);
        if !times.is_empty() {
            self.notes.push(format!(
                "{} marks of a pacer in column `{}` are used as stimuli, unless others are given (--ignore-marks ignores them)",
                times.len(),
                self.sheet.name(at)
            ));
        }
        if others > 0 {
            self.notes.push(format!(
                "{others} other marks in column `{}` are ignored",
                self.sheet.name(at)
            ));
        }
        Ok(times)
    }

    /// Returns the columns that were asked for. One that is meant twice, by its name and its number, is one curve.
    fn meant(&self, titles: &[Title]) -> Result<Vec<usize>, ReadError> {
        let found = self.options.values.iter().map(|wanted| self.find(wanted, titles));
        let mut all = found.collect::<Result<Vec<_>, _>>()?.concat();
        let mut seen = BTreeSet::new();
        all.retain(|at| seen.insert(*at));
        Ok(all)
    }

    /// Returns the columns that are curves.
    pub(super) fn columns(
        &mut self,
        titles: &[Title],
        held: &[Holds],
    ) -> Result<Vec<usize>, ReadError> {
        let times: Vec<usize> = match &self.options.time {
            Some(column) => self.find(column, titles)?,
            None => Vec::new(),
        };
        if !self.options.values.is_empty() {
            return self.meant(titles);
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
        // Without a header, the first column may be time; the clock decides.
        let first_is_time = self.sheet.header.first().is_none_or(String::is_empty)
            && titles.len() > 1
            && self.options.time.is_none()
            && !held.iter().any(|held| matches!(held, Holds::Time | Holds::Frame))
            && rises(self.numbers(0).into_iter().map(Cell::Number));
        let mut others: Vec<usize> = (0..titles.len())
            .filter(free)
            .filter(|at| matches!(held[*at], Holds::Other | Holds::Contradicts(_)))
            .filter(|at| !(*at == 0 && first_is_time))
            // A first column without a name contains row numbers.
            .filter(|at| self.sheet.header.is_empty() || !titles[*at].name.is_empty())
            .filter(mostly)
            .collect();
        if !of_kind.is_empty() {
            return Ok(of_kind);
        }
        let passed_over = |at: &[usize], why: &str| {
            let names: Vec<String> = at.iter().map(|at| self.sheet.name(*at)).collect();
            format!("ignored, because {why}: {} (choose them by --columns)", listed(&names))
        };
        if !known.is_empty() {
            // If the rows are curves, their names are those of cells, so any name is accepted.
            if !self.sheet.turned.is_empty() {
                let mut all = [known, others].concat();
                all.sort_unstable();
                return Ok(all);
            }
            let (odd, others): (Vec<usize>, Vec<usize>) =
                others.into_iter().partition(|at| matches!(held[*at], Holds::Contradicts(_)));
            for (columns, why) in [
                (&others, "their names are not those of a curve"),
                (&odd, "their units do not fit their names"),
            ] {
                if !columns.is_empty() {
                    let note = passed_over(columns, why);
                    self.notes.push(note);
                }
            }
            return Ok(known);
        }
        // Numbers of rows, positions and channels.
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
            return Err(self.error("it has no column of values besides the times"));
        }
        Ok(others)
    }
}

fn counts(numbers: &[f64]) -> bool {
    numbers.len() > 1 && numbers.windows(2).all(|pair| pair[1] - pair[0] == 1.0)
}
