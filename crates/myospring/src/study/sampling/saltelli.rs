//! Saltelli's design for Sobol indices (Saltelli 2002), with its rows in the order of SALib.

use super::error::SamplingError;
use super::sobol_sequence;

/// For each base point: A; A with one column of B, column by column; with `pairs` B with one column of A, column by
/// column; B.
pub(super) fn saltelli(
    size: usize,
    dimensions: usize,
    pairs: bool,
    seed: u64,
) -> Result<Vec<Vec<f64>>, SamplingError> {
    let both = sobol_sequence::shifted(size, 2 * dimensions, seed)?;
    let mut rows = Vec::with_capacity(size * (2 * dimensions + 2));
    for point in both {
        let (a, b) = point.split_at(dimensions);
        let mixed = |most: &[f64], one: &[f64], column: usize| {
            let mut row = most.to_vec();
            row[column] = one[column];
            row
        };
        rows.push(a.to_vec());
        rows.extend((0..dimensions).map(|column| mixed(a, b, column)));
        if pairs {
            rows.extend((0..dimensions).map(|column| mixed(b, a, column)));
        }
        rows.push(b.to_vec());
    }
    Ok(rows)
}
