//! Dense linear equations of a few dozen unknowns.

/// A square matrix as the product of a lower and an upper triangle, rows exchanged for the largest pivot
/// (`golub_van_loan_2013`, Algorithm 3.4.1), column by column: every loop adds one column to another.
#[derive(Debug, Clone)]
pub(super) struct Lu {
    size: usize,
    /// Both triangles.
    columns: Vec<f64>,
    /// The row that was exchanged with row `k` in step `k`.
    exchanged: Vec<usize>,
}

impl Lu {
    pub(super) fn new(size: usize) -> Self {
        Self { size, columns: vec![0.0; size * size], exchanged: vec![0; size] }
    }

    /// Factorises `diagonal I - matrix`, the matrix row by row; false if it is singular or no number.
    pub(super) fn factorise(&mut self, diagonal: f64, matrix: &[f64]) -> bool {
        let Self { size, columns, exchanged } = self;
        let n = *size;
        for (k, column) in columns.chunks_exact_mut(n).enumerate() {
            for (entry, row) in column.iter_mut().zip(matrix.chunks_exact(n)) {
                *entry = -row[k];
            }
            column[k] += diagonal;
        }
        for k in 0..n {
            let (left, right) = columns.split_at_mut((k + 1) * n);
            let column = &mut left[k * n..];
            let larger = |best: usize, row: usize| {
                if column[row].abs() > column[best].abs() { row } else { best }
            };
            let pivot_row = (k + 1..n).fold(k, larger);
            exchanged[k] = pivot_row;
            column.swap(k, pivot_row);
            let pivot = column[k];
            if !(pivot.is_finite() && pivot != 0.0) {
                return false;
            }
            for entry in &mut column[k + 1..] {
                *entry /= pivot;
            }
            for other in right.chunks_exact_mut(n) {
                other.swap(k, pivot_row);
                subtract(&mut other[k..], &column[k..]);
            }
        }
        // The exchanges of later steps go through the columns before.
        for k in 0..n {
            for later in k + 1..n {
                columns.swap(k * n + later, k * n + exchanged[later]);
            }
        }
        true
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&self, vector: &mut [f64]) {
        let Self { size: n, columns, exchanged } = self;
        for k in 0..*n {
            vector.swap(k, exchanged[k]);
        }
        for (k, column) in columns.chunks_exact(*n).enumerate() {
            subtract(&mut vector[k..], &column[k..]);
        }
        for (k, column) in columns.chunks_exact(*n).enumerate().rev() {
            vector[k] /= column[k];
            let (above, value) = (&column[..k], vector[k]);
            for (entry, above) in vector[..k].iter_mut().zip(above) {
                *entry -= value * above;
            }
        }
    }
}

/// Takes the first of these numbers times the other column from what stands below them.
fn subtract(numbers: &mut [f64], column: &[f64]) {
    let Some((&mut first, below)) = numbers.split_first_mut() else { return };
    if first != 0.0 {
        for (entry, factor) in below.iter_mut().zip(&column[1..]) {
            *entry -= first * factor;
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
            let mut lu = Lu::new(n);
            assert!(lu.factorise(0.0, &matrix), "{n}");
            let mut solution = right.clone();
            lu.solve(&mut solution);
            for (row, right) in matrix.chunks_exact(n).zip(&right) {
                let left: f64 = row.iter().zip(&solution).map(|(a, x)| -a * x).sum();
                // Rounding of n terms, grown by the condition of the matrix, which is below 1e3.
                assert!((left - right).abs() < 1e-12, "{n}: {left} {right}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_is_noticed() {
        assert!(!Lu::new(2).factorise(1.0, &[1.0, 0.0, 0.0, 1.0]));
        assert!(!Lu::new(2).factorise(0.0, &[1.0, 2.0, 2.0, 4.0]));
        assert!(!Lu::new(2).factorise(f64::NAN, &[1.0, 0.0, 0.0, 1.0]));
    }
}
