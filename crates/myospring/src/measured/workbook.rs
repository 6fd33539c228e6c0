//! Reads workbooks of spreadsheets (.xlsx) into rows of fields, with limits on their size: a few
//! kilobytes can inflate to gigabytes.

use super::sheet::Row;
use calamine::{Data, DataRef, Reader, SheetType, Xlsx};
use std::io::{self, Cursor, Read};

/// Largest total size of the inflated parts of a workbook, bytes; enough for ten million numbers.
const INFLATED: u64 = 512 << 20;

/// Largest number of parts of a workbook.
const PARTS: usize = 10_000;

/// Largest number of fields of a sheet, rows times columns, including empty ones.
const FIELDS: usize = 10_000_000;

/// A sheet and its name.
#[derive(Debug)]
pub(super) struct Worksheet {
    pub(super) name: String,
    /// Rows that are not empty, all of the same length.
    pub(super) rows: Vec<Row>,
}

/// Returns the sheets of a workbook that are not empty, in order; or what is wrong with the file.
pub(super) fn sheets(bytes: &[u8]) -> Result<Vec<Worksheet>, String> {
    check(bytes)?;
    // The library panics if a row number overflows, such as that of a cell `A99999999999`.
    let read = std::panic::catch_unwind(|| read(bytes));
    read.unwrap_or_else(|_| Err("a damaged workbook: save it again".to_owned()))
}

fn read(bytes: &[u8]) -> Result<Vec<Worksheet>, String> {
    let damaged = |error: calamine::XlsxError| format!("a workbook that cannot be read: {error}");
    let mut book = Xlsx::new(Cursor::new(bytes)).map_err(damaged)?;
    let names: Vec<String> = book
        .sheets_metadata()
        .iter()
        .filter(|sheet| sheet.typ == SheetType::WorkSheet)
        .map(|sheet| sheet.name.clone())
        .collect();
    let mut sheets = Vec::new();
    for name in names {
        let large = || format!("a workbook whose sheet `{name}` has more than {FIELDS} fields");
        let mut cells = book.worksheet_cells_reader(&name).map_err(damaged)?;
        let (mut rows, mut width) = (Vec::<Row>::new(), 0);
        while let Some(cell) = cells.next_cell().map_err(damaged)? {
            let text = text(cell.get_value());
            if text.is_empty() {
                continue;
            }
            let (row, column) = cell.get_position();
            let (line, column) = (u64::from(row) + 1, column as usize);
            width = width.max(column + 1);
            // Every spreadsheet program writes rows in order.
            if rows.last().is_none_or(|last| last.line != line) {
                if rows.last().is_some_and(|last| last.line > line) {
                    return Err(format!(
                        "a workbook whose sheet `{name}` has its rows in disorder"
                    ));
                }
                rows.push(Row { line, fields: Vec::new() });
            }
            if rows.len().saturating_mul(width) > FIELDS {
                return Err(large());
            }
            if let Some(last) = rows.last_mut() {
                if last.fields.len() <= column {
                    last.fields.resize(column + 1, String::new());
                }
                last.fields[column] = text;
            }
        }
        for row in &mut rows {
            row.fields.resize(width, String::new());
        }
        if !rows.is_empty() {
            sheets.push(Worksheet { name, rows });
        }
    }
    Ok(sheets)
}

/// Returns a field as a table of text would contain it; durations and dates in seconds.
fn text(value: &DataRef<'_>) -> String {
    match Data::from(value.clone()) {
        Data::Int(number) => number.to_string(),
        Data::Float(number) => number.to_string(),
        Data::String(text) => text.trim().to_owned(),
        Data::DateTime(time) => (time.as_f64() * 86_400.0).to_string(),
        Data::DateTimeIso(text) | Data::DurationIso(text) => text,
        _ => String::new(),
    }
}

/// Inflates every part once, within the limits and without storing it.
fn check(bytes: &[u8]) -> Result<(), String> {
    let damaged = |error: &dyn std::fmt::Display| {
        format!("an archive that cannot be read as a workbook: {error}; save the sheet as CSV")
    };
    let mut archive = zip::ZipArchive::new(Cursor::new(bytes)).map_err(|error| damaged(&error))?;
    if archive.len() > PARTS {
        return Err(format!(
            "a workbook of {} parts; at most {PARTS} are read: save the sheet as CSV",
            archive.len()
        ));
    }
    let mut left = INFLATED;
    for at in 0..archive.len() {
        let part = archive.by_index(at).map_err(|error| damaged(&error))?;
        let name = part.name().map_err(|error| damaged(&error))?;
        let strings = name.to_lowercase().ends_with("sharedstrings.xml");
        let mut part = part.take(left + 1);
        let mut kept = Vec::new();
        let read = if strings {
            part.read_to_end(&mut kept).map(|read| read as u64)
        } else {
            io::copy(&mut part, &mut io::sink())
        };
        let read = read.map_err(|error| damaged(&error))?;
        left = left.checked_sub(read).ok_or_else(|| {
            format!(
                "a workbook that inflates to more than {} MiB: save the sheet of the curves as CSV",
                INFLATED >> 20
            )
        })?;
        if promises_too_much(&kept) {
            return Err("a workbook whose list of texts is damaged: save it again".to_owned());
        }
    }
    Ok(())
}

/// Whether a list of texts states a number of texts that is larger than its size in bytes; the
/// library would allocate memory for that number.
fn promises_too_much(list: &[u8]) -> bool {
    const COUNT: &[u8] = b"uniqueCount";
    let most = list.len() as u64;
    let said = list.windows(COUNT.len()).enumerate().filter(|(_, part)| *part == COUNT);
    said.map(|(at, _)| &list[at + COUNT.len()..]).any(|after| {
        let digits = after.iter().skip_while(|byte| b" \t\r\n=\"'+0".contains(byte));
        let digits: Vec<u8> = digits.take_while(|byte| byte.is_ascii_digit()).copied().collect();
        let number = std::str::from_utf8(&digits).ok().filter(|digits| !digits.is_empty());
        number.is_some_and(|number| number.parse::<u64>().map_or(true, |number| number > most))
    })
}
