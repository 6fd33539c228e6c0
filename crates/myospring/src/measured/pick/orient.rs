//! Detects tables whose rows are curves and transposes them.

use super::picked::{MANY, Picked, rises};
use crate::measured::column::{self, Holds};
use crate::measured::error::ReadError;
use crate::measured::number::{self, Cell};
use crate::measured::options::Layout;
use crate::measured::sheet::{Row, Sheet};
use std::collections::BTreeSet;

/// A table up to this size, rows times columns, is transposed however many fields are missing. Missing fields
/// take memory once it is transposed.
const MOST_TURNED: usize = 10_000_000;

impl Picked<'_> {
    /// Transposes a table whose rows are curves.
    ///
    /// # Errors
    /// A large table to transpose in which nearly all fields are missing.
    pub(super) fn orient(&mut self) -> Result<(), ReadError> {
        if self.options.layout == Some(Layout::Columns) {
            return Ok(());
        }
        let (width, rows) = (self.sheet.width(), self.sheet.rows.len());
        let first = self.sheet.rows.first().map_or(&[][..], |row| &row.fields);
        let unnamed = self.sheet.header.is_empty();
        // The names and numbers of the curves come before their frames.
        let text = |row: &Row, at: usize| matches!(self.sheet.cell(row, at), Cell::Text);
        let is_label = |at: usize| {
            let header = self.sheet.header.get(at).is_some_and(|name| !ends_in_number(name));
            let blank = unnamed && first.get(at).is_some_and(|field| !has_digit(field));
            header || blank || (rows > 0 && self.sheet.rows.iter().all(|row| text(row, at)))
        };
        let labels = (0..width).take_while(|at| is_label(*at)).count();
        // The header may contain frames or times instead of names.
        if are_frames(&self.sheet.header) || (unnamed && first.len() >= MANY && are_frames(first)) {
            self.turn(Some("frame"), labels)?;
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
                "the first row contains times, and each further row is a curve (--layout columns if not)"
                    .to_owned(),
            );
            self.turn(Some(&axis), labels)?;
        } else if self.options.layout == Some(Layout::Rows) {
            self.turn(None, labels)?;
        } else if unnamed && width >= MANY && width > rows {
            let down = self.sheet.rows.iter().map(|row| self.sheet.cell(row, 0));
            if rows < 2 || !rises(down) {
                self.notes.push(format!(
                    "{rows} rows of {width} numbers without names: each row is read as a curve (--layout columns if not)"
                ));
                self.turn(None, labels)?;
            }
        }
        Ok(())
    }

    pub(super) fn turn(&mut self, axis: Option<&str>, labels: usize) -> Result<(), ReadError> {
        self.check_gaps(
            MOST_TURNED,
            "correct that line, or use --layout columns if the columns are curves",
        )?;
        let empty = Sheet {
            header: Vec::new(),
            groups: Vec::new(),
            rows: Vec::new(),
            turned: Vec::new(),
            again: BTreeSet::new(),
            ..self.sheet
        };
        let sheet = std::mem::replace(&mut self.sheet, empty);
        self.sheet = sheet.turn(axis, labels);
        Ok(())
    }
}

fn has_digit(text: &str) -> bool {
    text.chars().any(|letter| letter.is_ascii_digit())
}

/// Whether names are frame numbers (`frame0, frame1, ...`, or numbers alone) after at most two
/// other columns.
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
