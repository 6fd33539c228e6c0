//! Sparse Cholesky factors of the stiffness between free coordinates, by `faer`.
//!
//! The order of elimination and the pattern of the factor are found once and serve as long as the
//! same nodes act on each other. One thread: the same bits everywhere.

use crate::mechanics::stiffness::StiffnessMatrix;
use faer::dyn_stack::{MemBuffer, MemStack, StackReq};
use faer::linalg::cholesky::llt::factor::{LltError, LltRegularization};
use faer::sparse::linalg::cholesky::{
    CholeskySymbolicParams, LltRef, SymbolicCholesky, SymmetricOrdering,
    factorize_symbolic_cholesky,
};
use faer::sparse::{FaerError, SparseColMatRef, SymbolicSparseColMatRef};
use faer::{Conj, MatMut, Par, Side, Spec};

/// Why there is no factor.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum FactorError {
    /// The stiffness is not positive definite.
    Indefinite,
    /// The factor does not fit into memory, or has too many entries to be numbered.
    TooLarge,
}

impl From<FaerError> for FactorError {
    fn from(_: FaerError) -> Self {
        Self::TooLarge
    }
}

/// The pattern of a stiffness and what is kept for it.
struct Pattern {
    blocks: usize,
    columns: Vec<usize>,
    rows: Vec<usize>,
    symbolic: SymbolicCholesky<usize>,
    memory: MemBuffer,
}

/// A factor that is made anew for each stiffness.
pub(super) struct Factor {
    /// Number of each coordinate in the matrix, by axis; `None` if it is held.
    coordinates: [Vec<Option<usize>>; 2],
    size: usize,
    pattern: Option<Pattern>,
    values: Vec<f64>,
    /// Of the factor.
    entries: Vec<f64>,
}

impl Factor {
    /// For bodies of which these coordinates are free: `free[axis][node]`.
    pub(super) fn new(free: &[Vec<bool>; 2]) -> Self {
        let mut size = 0;
        let mut coordinates = [vec![None; free[0].len()], vec![None; free[0].len()]];
        for node in 0..free[0].len() {
            for axis in 0..2 {
                if free[axis][node] {
                    coordinates[axis][node] = Some(size);
                    size += 1;
                }
            }
        }
        Self { coordinates, size, pattern: None, values: Vec::new(), entries: Vec::new() }
    }

    /// Calls `entry(row, column, value)` for the lower half, column by column, rows in order.
    fn walk(&self, stiffness: &StiffnessMatrix, mut entry: impl FnMut(usize, usize, f64)) {
        for a in 0..stiffness.len() {
            for i in 0..2 {
                let Some(column) = self.coordinates[i][a] else { continue };
                for &(b, block) in stiffness.row(a) {
                    for j in 0..2 {
                        if let Some(row) = self.coordinates[j][b]
                            && row >= column
                        {
                            entry(row, column, block[i][j]);
                        }
                    }
                }
            }
        }
    }

    fn find_pattern(&self, stiffness: &StiffnessMatrix) -> Result<Pattern, FactorError> {
        let (mut columns, mut rows) = (vec![0; self.size + 1], Vec::new());
        self.walk(stiffness, |row, column, _| {
            rows.push(row);
            columns[column + 1] = rows.len();
        });
        let shape =
            SymbolicSparseColMatRef::new_checked(self.size, self.size, &columns, None, &rows);
        let (order, settings) = (SymmetricOrdering::default(), CholeskySymbolicParams::default());
        let symbolic = factorize_symbolic_cholesky(shape, Side::Lower, order, settings)?;
        let memory = MemBuffer::try_new(StackReq::any_of(&[
            symbolic.factorize_numeric_llt_scratch::<f64>(Par::Seq, Spec::default()),
            symbolic.solve_in_place_scratch::<f64>(1, Par::Seq),
        ]))
        .map_err(|_| FactorError::TooLarge)?;
        Ok(Pattern { blocks: stiffness.blocks(), columns, rows, symbolic, memory })
    }

    /// Factorises a stiffness.
    pub(super) fn factorise(&mut self, stiffness: &StiffnessMatrix) -> Result<(), FactorError> {
        if self.size == 0 {
            return Ok(());
        }
        if self.pattern.as_ref().is_none_or(|pattern| pattern.blocks != stiffness.blocks()) {
            self.pattern = Some(self.find_pattern(stiffness)?);
        }
        let mut values = std::mem::take(&mut self.values);
        values.clear();
        self.walk(stiffness, |_, _, value| values.push(value));
        self.values = values;
        if self.values.iter().any(|value| !value.is_finite()) {
            return Err(FactorError::Indefinite);
        }
        let Some(Pattern { columns, rows, symbolic, memory, .. }) = &mut self.pattern else {
            return Err(FactorError::TooLarge);
        };
        let shape = SymbolicSparseColMatRef::new_checked(self.size, self.size, columns, None, rows);
        self.entries.resize(symbolic.len_val(), 0.0);
        let done = symbolic
            .factorize_numeric_llt(
                &mut self.entries,
                SparseColMatRef::new(shape, &self.values),
                Side::Lower,
                LltRegularization::default(),
                Par::Seq,
                MemStack::new(memory),
                Spec::default(),
            )
            .map(|_| ());
        match done {
            Ok(()) if self.entries.iter().all(|value| value.is_finite()) => Ok(()),
            Ok(()) | Err(LltError::NonPositivePivot { .. }) => Err(FactorError::Indefinite),
        }
    }

    /// Displacements (um) under forces (nN) on the free coordinates; held ones stay.
    ///
    /// Uses the last stiffness that was factorised.
    pub(super) fn solve(&mut self, forces: &[Vec<f64>; 2]) -> [Vec<f64>; 2] {
        let mut right = vec![0.0; self.size];
        for (numbers, force) in self.coordinates.iter().zip(forces) {
            for (number, value) in numbers.iter().zip(force) {
                if let Some(number) = number {
                    right[*number] = *value;
                }
            }
        }
        if let Some(Pattern { symbolic, memory, .. }) = &mut self.pattern {
            let column = MatMut::from_column_major_slice_mut(&mut right, self.size, 1);
            LltRef::new(symbolic, &self.entries).solve_in_place_with_conj(
                Conj::No,
                column,
                Par::Seq,
                MemStack::new(memory),
            );
        }
        [0, 1].map(|axis| {
            let numbers = self.coordinates[axis].iter();
            numbers.map(|number| number.map_or(0.0, |number| right[number])).collect()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A chain of springs of unit stiffness along x, stiffness 2 across.
    fn chain(count: usize) -> StiffnessMatrix {
        let mut stiffness = StiffnessMatrix::new(count);
        for node in 1..count {
            stiffness.add_pair(node - 1, node, [[1.0, 0.0], [0.0, 2.0]]);
        }
        stiffness
    }

    #[test]
    fn a_chain_held_at_one_end_stretches_as_springs_in_series() {
        let mut free = [vec![true; 5], vec![true; 5]];
        (free[0][0], free[1][0]) = (false, false);
        let mut factor = Factor::new(&free);
        factor.factorise(&chain(5)).unwrap();
        let mut forces = [vec![0.0; 5], vec![0.0; 5]];
        (forces[0][4], forces[1][4]) = (3.0, 4.0);
        let moved = factor.solve(&forces);
        for node in 0..5 {
            assert!((moved[0][node] - 3.0 * node as f64).abs() < 1e-12);
            assert!((moved[1][node] - 2.0 * node as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn a_negative_spring_is_found_out() {
        let mut factor = Factor::new(&[vec![false, true], vec![false, true]]);
        let mut stiffness = StiffnessMatrix::new(2);
        stiffness.add_pair(0, 1, [[1.0, 0.0], [0.0, -0.1]]);
        assert_eq!(factor.factorise(&stiffness), Err(FactorError::Indefinite));
        stiffness.add_pair(0, 1, [[0.0, 0.0], [0.0, 0.2]]);
        assert_eq!(factor.factorise(&stiffness), Ok(()));
    }
}
