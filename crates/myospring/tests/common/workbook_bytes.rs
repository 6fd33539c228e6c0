//! Any bytes as a workbook of curves: they are read or refused.

use myospring::measured::{TableOptions, read_bytes};

/// How many curves there are in them, at 50 frames a second where they have no times.
pub(crate) fn exercise(bytes: &[u8]) -> usize {
    let named = read_bytes("book.xlsx", bytes, &TableOptions::default());
    let rate = TableOptions { frame_rate_per_s: Some(50.0), ..TableOptions::default() };
    let framed = read_bytes("book.xlsx", bytes, &rate);
    let tables = [named, framed].into_iter().flatten();
    tables.map(|table| table.curves.len()).max().unwrap_or(0)
}
