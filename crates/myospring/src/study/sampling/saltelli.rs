//! Saltelli's design for Sobol indices (Saltelli 2002), with its rows in the order of SALib.

use super::sobol_sequence::SobolSequence;

/// For each base point of a sequence of twice the dimensions: A; A with one column of B, column by column; with `pairs`
/// B with one column of A, column by column; B. The point of a row.
pub(super) fn point(both: &SobolSequence, dimensions: usize, pairs: bool, row: usize) -> Vec<f64> {
    let rows = 2 + dimensions * if pairs { 2 } else { 1 };
    let base = both.point(row / rows);
    let (a, b) = base.split_at(dimensions);
    let mixed = |most: &[f64], one: &[f64], column: usize| {
        let mut row = most.to_vec();
        row[column] = one[column];
        row
    };
    match row % rows {
        0 => a.to_vec(),
        last if last == rows - 1 => b.to_vec(),
        at if at <= dimensions => mixed(a, b, at - 1),
        at => mixed(b, a, at - 1 - dimensions),
    }
}
