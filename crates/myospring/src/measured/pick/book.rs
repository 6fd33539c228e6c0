//! Reads the curves of a workbook, sheet by sheet.

use super::picked::{Picked, listed, named, no_numbers, stem};
use crate::measured::curve::{Curve, Table};
use crate::measured::error::ReadError;
use crate::measured::options::{Column, TableOptions};
use crate::measured::sheet::Sheet;
use crate::measured::workbook;

/// Returns the curves of all sheets, or of the requested ones. If some sheets have curves, each
/// sheet without one is reported as a note.
pub(super) fn of_workbook(
    path: &str,
    bytes: &[u8],
    options: &TableOptions,
) -> Result<Table, ReadError> {
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
