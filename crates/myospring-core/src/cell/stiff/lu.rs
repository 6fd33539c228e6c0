//! Dense linear equations of a few dozen unknowns.

/// A square matrix as the product of a lower and an upper triangle, rows exchanged for the largest pivot
/// (`golub_van_loan_2013`, Algorithm 3.4.1).
#[derive(Debug, Clone)]
pub(super) struct Lu {
    size: usize,
    /// Row by row; both triangles.
    rows: Vec<f64>,
    /// The row that was exchanged with row `k` in step `k`.
    exchanged: Vec<usize>,
}

impl Lu {
    pub(super) fn new(size: usize) -> Self {
        Self { size, rows: vec![0.0; size * size], exchanged: vec![0; size] }
    }

    /// Factorises `diagonal I - matrix`, the matrix row by row; false if it is singular or no number.
    pub(super) fn factorise(&mut self, diagonal: f64, matrix: &[f64]) -> bool {
        let Self { size, rows, exchanged } = self;
        let n = *size;
        for (entry, value) in rows.iter_mut().zip(matrix) {
            *entry = -value;
        }
        for k in 0..n {
            rows[k * n + k] += diagonal;
        }
        for k in 0..n {
            let larger = |best: usize, row: usize| {
                if rows[row * n + k].abs() > rows[best * n + k].abs() { row } else { best }
            };
            let pivot_row = (k + 1..n).fold(k, larger);
            exchanged[k] = pivot_row;
            if pivot_row != k {
                for column in 0..n {
                    rows.swap(k * n + column, pivot_row * n + column);
                }
            }
            let (above, below) = rows.split_at_mut((k + 1) * n);
            let pivot_row = &above[k * n..];
            let pivot = pivot_row[k];
            if !(pivot.is_finite() && pivot != 0.0) {
                return false;
            }
            for row in below.chunks_exact_mut(n) {
                if row[k] == 0.0 {
                    continue;
                }
                let factor = row[k] / pivot;
                row[k] = factor;
                for (entry, above) in row[k + 1..].iter_mut().zip(&pivot_row[k + 1..]) {
                    *entry -= factor * above;
                }
            }
        }
        true
    }

    /// Replaces the right-hand side by the solution.
    pub(super) fn solve(&self, vector: &mut [f64]) {
        let Self { size: n, rows, exchanged } = self;
        let dot = |row: &[f64], vector: &[f64]| -> f64 {
            row.iter().zip(vector).map(|(entry, value)| entry * value).sum()
        };
        for k in 0..*n {
            vector.swap(k, exchanged[k]);
        }
        for k in 1..*n {
            vector[k] -= dot(&rows[k * n..k * n + k], &vector[..k]);
        }
        for k in (0..*n).rev() {
            let row = &rows[k * n..(k + 1) * n];
            vector[k] = (vector[k] - dot(&row[k + 1..], &vector[k + 1..])) / row[k];
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
