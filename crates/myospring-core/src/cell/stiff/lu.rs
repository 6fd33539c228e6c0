//! Solves dense linear equations with a few dozen unknowns.

/// Least ratio of the diagonal pivot to the largest element of its column for which rows are not
/// exchanged. Not exchanging rows keeps the zeros of the matrix; errors grow by less than the
/// inverse of this.
const ENOUGH: f64 = 1e-3;

/// LU factors of a square matrix, with a pivot off the diagonal only if the diagonal one is small
/// (`golub_van_loan_2013`, Algorithm 3.4.1), column by column: every loop adds one column to
/// another.
///
/// The caller chooses the order of elimination. If the first variables depend on few others only,
/// as gates do on the potential, nearly all elements of their columns are and stay zero, and are
/// skipped.
#[derive(Debug, Clone)]
pub(super) struct Lu {
    size: usize,
    /// The variables in the order of elimination.
    order: Vec<usize>,
    /// Both triangles.
    columns: Vec<f64>,
    /// The row that was exchanged with row `k` in step `k`.
    exchanged: Vec<usize>,
    /// For each column, the first nonzero row below the diagonal, and the first nonzero row of all.
    below: Vec<usize>,
    above: Vec<usize>,
    ordered: Vec<f64>,
}

impl Lu {
    /// Room for `size` variables, of which `first` are eliminated first.
    pub(super) fn new(size: usize, first: &[usize]) -> Self {
        let rest = (0..size).filter(|variable| !first.contains(variable));
        Self {
            size,
            order: first.iter().copied().chain(rest).collect(),
            columns: vec![0.0; size * size],
            exchanged: vec![0; size],
            below: vec![0; size],
            above: vec![0; size],
            ordered: vec![0.0; size],
        }
    }

    /// Factorises `diagonal I - matrix`, given row by row; false if it is singular or not finite.
    pub(super) fn factorise(&mut self, diagonal: f64, matrix: &[f64]) -> bool {
        let Self { size, order, columns, exchanged, below, above, .. } = self;
        let n = *size;
        for (k, column) in columns.chunks_exact_mut(n).enumerate() {
            for (entry, &row) in column.iter_mut().zip(&*order) {
                *entry = -matrix[row * n + order[k]];
            }
            column[k] += diagonal;
        }
        for k in 0..n {
            let (left, right) = columns.split_at_mut((k + 1) * n);
            let column = &mut left[k * n..];
            let larger = |best: usize, row: usize| {
                if column[row].abs() > column[best].abs() { row } else { best }
            };
            let largest = (k + 1..n).fold(k, larger);
            let stays = column[k].abs() >= ENOUGH * column[largest].abs();
            let pivot_row = if stays { k } else { largest };
            exchanged[k] = pivot_row;
            column.swap(k, pivot_row);
            let pivot = column[k];
            if !(pivot.is_finite() && pivot != 0.0) {
                return false;
            }
            let from = (k + 1..n).find(|&row| column[row] != 0.0).unwrap_or(n);
            for entry in &mut column[from..] {
                *entry /= pivot;
            }
            for other in right.chunks_exact_mut(n) {
                other.swap(k, pivot_row);
                let (head, tail) = other.split_at_mut(from);
                subtract(head[k], tail, &column[from..]);
            }
        }
        // Later row exchanges are applied to earlier columns.
        for later in 0..n {
            if exchanged[later] != later {
                for k in 0..later {
                    columns.swap(k * n + later, k * n + exchanged[later]);
                }
            }
        }
        for (k, column) in columns.chunks_exact(n).enumerate() {
            above[k] = (0..k).find(|&row| column[row] != 0.0).unwrap_or(k);
            below[k] = (k + 1..n).find(|&row| column[row] != 0.0).unwrap_or(n);
        }
        true
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&mut self, vector: &mut [f64]) {
        let Self { size: n, order, columns, exchanged, below, above, ordered } = self;
        for (entry, &place) in ordered.iter_mut().zip(&*order) {
            *entry = vector[place];
        }
        for k in 0..*n {
            ordered.swap(k, exchanged[k]);
        }
        for (k, column) in columns.chunks_exact(*n).enumerate() {
            let (head, tail) = ordered.split_at_mut(below[k]);
            subtract(head[k], tail, &column[below[k]..]);
        }
        for (k, column) in columns.chunks_exact(*n).enumerate().rev() {
            ordered[k] /= column[k];
            let value = ordered[k];
            subtract(value, &mut ordered[above[k]..k], &column[above[k]..k]);
        }
        for (entry, &place) in ordered.iter().zip(&*order) {
            vector[place] = *entry;
        }
    }
}

/// Subtracts a number times a column from another.
fn subtract(times: f64, from: &mut [f64], column: &[f64]) {
    if times != 0.0 {
        for (entry, factor) in from.iter_mut().zip(column) {
            *entry -= times * factor;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::Lu;

    #[test]
    fn the_solution_solves_the_equations_even_where_pivots_vanish() {
        for n in [1, 2, 5, 40] {
            // Weyl's sequence: numbers without pattern, the same everywhere; zero on the diagonal.
            let weyl = |k: usize| (k as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
            let mut matrix: Vec<f64> = (1..=n * n).map(weyl).collect();
            for k in 0..n {
                matrix[k * n + k] = if n == 1 { 3.0 } else { 0.0 };
            }
            let right: Vec<f64> = (1..=n).map(|k| weyl(7 * k)).collect();
            let first = [n - 1, 1];
            let mut lu = Lu::new(n, if n > 2 { &first } else { &[] });
            assert!(lu.factorise(0.0, &matrix), "{n}");
            let mut solution = right.clone();
            lu.solve(&mut solution);
            for (row, right) in matrix.chunks_exact(n).zip(&right) {
                let left: f64 = row.iter().zip(&solution).map(|(a, x)| -a * x).sum();
                // Rounding of n terms, grown by its condition, which is below 1e3, and by small pivots.
                assert!((left - right).abs() < 1e-12, "{n}: {left} {right}");
            }
        }
    }

    #[test]
    fn zeros_are_passed_over_and_change_nothing() {
        // An arrow: the first hang on the last alone.
        let n = 9;
        let mut matrix = vec![0.0; n * n];
        for k in 0..n {
            matrix[k * n + k] = -1.0 - k as f64;
            matrix[k * n + 8] += 0.3;
            matrix[8 * n + k] += 200.0;
        }
        let mut lu = Lu::new(n, &[]);
        assert!(lu.factorise(2.0, &matrix));
        assert_eq!((lu.below[0], lu.above[3], lu.above[8]), (8, 3, 0));
        let mut solution: Vec<f64> = (0..n).map(|k| k as f64 - 3.0).collect();
        lu.solve(&mut solution);
        for k in 0..n {
            let row = &matrix[k * n..(k + 1) * n];
            let left: f64 = row.iter().zip(&solution).map(|(a, x)| -a * x).sum();
            assert!((left + 2.0 * solution[k] - (k as f64 - 3.0)).abs() < 1e-11, "{k}: {left}");
        }
    }

    #[test]
    fn a_singular_matrix_is_noticed() {
        assert!(!Lu::new(2, &[]).factorise(1.0, &[1.0, 0.0, 0.0, 1.0]));
        assert!(!Lu::new(2, &[]).factorise(0.0, &[1.0, 2.0, 2.0, 4.0]));
        assert!(!Lu::new(2, &[]).factorise(f64::NAN, &[1.0, 0.0, 0.0, 1.0]));
    }
}
