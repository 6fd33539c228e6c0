//! Elimination of the first columns of a dense symmetric matrix.

use super::error::FactorError;
use crate::interruption::Interruption;
use pulp::{Simd, WithSimd};

/// Number of columns that are eliminated one by one before the others are updated.
const BLOCK: usize = 16;

/// Columns of a tile that stays in registers; its rows fill two registers.
const TILE_COLUMNS: usize = 4;

/// Cholesky's elimination of the first columns of a front (`golub_van_loan_2013`,
/// chapter 4), by blocks of columns:
///
/// ```text
/// [ A  B' ]   [ L     ] [ L'  M' ]
/// [ B  C  ] = [ M  1  ] [     C - M M' ]
/// ```
///
/// All matrices are stored by columns as lower triangles; elements above the diagonals are not
/// read. Every sum has the same order and no fused operations, so results are bitwise the same on
/// every machine.
pub(super) struct Eliminate<'a> {
    /// `A` over `B`, becomes `L` over `M`.
    pub(super) panel: &'a mut [f64],
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// `C`, becomes `C - M M'`.
    pub(super) rest: &'a mut [f64],
    /// Memory for tiles.
    pub(super) packed: &'a mut [Vec<f64>; 2],
    /// Checked after each block of columns.
    pub(super) interruption: &'a Interruption,
}

impl Eliminate<'_> {
    /// Eliminates with the vector units of this machine; an error if a pivot is not positive.
    pub(super) fn run(self) -> Result<(), FactorError> {
        pulp::Arch::new().dispatch(self)
    }
}

impl WithSimd for Eliminate<'_> {
    type Output = Result<(), FactorError>;

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: Simd>(self, simd: S) -> Self::Output {
        let Self { panel, rows, columns, rest, packed, interruption } = self;
        if columns == 0 {
            // Parts that do not touch have no separator.
            return Ok(());
        }
        for start in (0..columns).step_by(BLOCK) {
            interruption.check()?;
            let end = columns.min(start + BLOCK);
            if !factorise(panel, rows, start, end) {
                return Err(FactorError::Indefinite);
            }
            let (block, others) = panel.split_at_mut(end * rows);
            if end < columns {
                let block = &block[start * rows..];
                let size = [rows - end, columns - end];
                subtract_square(simd, block, rows, end, size, &mut others[end..], rows, packed);
            }
        }
        let size = [rows - columns; 2];
        subtract_square(simd, panel, rows, columns, size, rest, rows - columns, packed);
        Ok(())
    }
}

/// The columns of a front that were eliminated, and the right side at them. Loops have the same order and no fused operations, so results
/// are bitwise the same with any vector units.
pub(super) struct Eliminated<'a, T> {
    /// `L` over `M`.
    pub(super) panel: &'a [T],
    /// The right side at the columns.
    pub(super) own: &'a mut [f64],
    /// At the other rows: what the columns take from it, or its solution.
    pub(super) border: &'a mut [f64],
}

impl<T: Copy + Into<f64>> Eliminated<'_, T> {
    /// Solves with `L`, and adds up what `M` takes from the other rows.
    pub(super) fn take_off(self) {
        // Parts that do not touch have no separator.
        if self.own.is_empty() {
            return;
        }
        pulp::Arch::new().dispatch(TakeOff(self));
    }

    /// Solves with the transpose of `L` over `M`, given the solution in the other rows.
    pub(super) fn put_back(self) {
        if self.own.is_empty() {
            return;
        }
        pulp::Arch::new().dispatch(PutBack(self));
    }
}

struct TakeOff<'a, T>(Eliminated<'a, T>);

impl<T: Copy + Into<f64>> WithSimd for TakeOff<'_, T> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: Simd>(self, _: S) {
        let Eliminated { panel, own, border } = self.0;
        let (columns, rows) = (own.len(), own.len() + border.len());
        for (column, entries) in panel.chunks_exact(rows).enumerate() {
            let value = own[column] / entries[column].into();
            own[column] = value;
            let (inner, outer) = entries[column + 1..].split_at(columns - column - 1);
            for (sum, entry) in own[column + 1..].iter_mut().zip(inner) {
                *sum -= value * (*entry).into();
            }
            for (sum, entry) in border.iter_mut().zip(outer) {
                *sum += value * (*entry).into();
            }
        }
    }
}

struct PutBack<'a, T>(Eliminated<'a, T>);

impl<T: Copy + Into<f64>> WithSimd for PutBack<'_, T> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: Simd>(self, _: S) {
        let Eliminated { panel, own, border } = self.0;
        let (columns, rows) = (own.len(), own.len() + border.len());
        for (column, entries) in panel.chunks_exact(rows).enumerate().rev() {
            let (inner, outer) = entries[column + 1..].split_at(columns - column - 1);
            let sum = dot(inner, &own[column + 1..]) + dot(outer, border);
            own[column] = (own[column] - sum) / entries[column].into();
        }
    }
}

/// Scalar product in eight partial sums, for vector units.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn dot<T: Copy + Into<f64>>(a: &[T], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            lanes[lane] += a[lane].into() * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| (*a).into() * b).sum();
    lanes.iter().sum::<f64>() + rest
}

/// Eliminates columns `start..end` one by one, in all rows.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn factorise(panel: &mut [f64], rows: usize, start: usize, end: usize) -> bool {
    for column in start..end {
        let (before, here) = panel.split_at_mut(column * rows);
        let here = &mut here[column..rows];
        for earlier in start..column {
            let earlier = &before[earlier * rows + column..(earlier + 1) * rows];
            let factor = earlier[0];
            for (value, other) in here.iter_mut().zip(earlier) {
                *value -= factor * other;
            }
        }
        let pivot = here[0];
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        let scale = 1.0 / pivot.sqrt();
        for value in here {
            *value *= scale;
        }
    }
    true
}

/// Subtracts `M M'` from the lower half of the first columns of a square matrix, where `M` are the rows of `block` from
/// `first` on.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
#[allow(clippy::too_many_arguments, reason = "two matrices by their parts")]
fn subtract_square<S: Simd>(
    simd: S,
    block: &[f64],
    stride: usize,
    first: usize,
    [rows, columns]: [usize; 2],
    target: &mut [f64],
    target_stride: usize,
    [left, right]: &mut [Vec<f64>; 2],
) {
    let depth = block.len() / stride;
    let height = 2 * S::F64_LANES;
    pack(block, stride, first, rows, height, left);
    pack(block, stride, first, columns, TILE_COLUMNS, right);
    for (at, left) in left.chunks_exact(depth * height).enumerate() {
        let row = at * height;
        for (at, right) in right.chunks_exact(depth * TILE_COLUMNS).enumerate() {
            let column = at * TILE_COLUMNS;
            if column >= row + height {
                break;
            }
            let tile = product(simd, left, right);
            let whole = column + TILE_COLUMNS <= columns
                && row + height <= rows
                && row + 1 >= column + TILE_COLUMNS;
            if whole {
                for (at, sums) in tile.iter().enumerate() {
                    let place = (column + at) * target_stride + row;
                    let (values, _) = S::as_mut_simd_f64s(&mut target[place..place + height]);
                    for (value, sum) in values.iter_mut().zip(sums) {
                        *value = simd.sub_f64s(*value, *sum);
                    }
                }
            } else {
                for (at, sums) in tile.iter().enumerate().take(columns - column) {
                    let sums: &[f64] = pulp::bytemuck::cast_slice(sums);
                    let column = column + at;
                    for i in row.max(column)..rows.min(row + height) {
                        target[column * target_stride + i] -= sums[i - row];
                    }
                }
            }
        }
    }
}

/// The product of a tile's rows and columns.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn product<S: Simd>(simd: S, left: &[f64], right: &[f64]) -> [[S::f64s; 2]; TILE_COLUMNS] {
    let mut sums = [[simd.splat_f64s(0.0); 2]; TILE_COLUMNS];
    let (left, _) = S::as_simd_f64s(left);
    for (left, right) in left.chunks_exact(2).zip(right.chunks_exact(TILE_COLUMNS)) {
        for column in 0..TILE_COLUMNS {
            let factor = simd.splat_f64s(right[column]);
            for half in 0..2 {
                let term = simd.mul_f64s(left[half], factor);
                sums[column][half] = simd.add_f64s(sums[column][half], term);
            }
        }
    }
    sums
}

/// Copies rows so that tiles of this height follow each other, each by columns, filled up with zeros.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn pack(
    block: &[f64],
    stride: usize,
    first: usize,
    rows: usize,
    height: usize,
    packed: &mut Vec<f64>,
) {
    packed.clear();
    for start in (0..rows).step_by(height) {
        let count = height.min(rows - start);
        for column in block.chunks_exact(stride) {
            packed.extend_from_slice(&column[first + start..first + start + count]);
            packed.resize(packed.len() + height - count, 0.0);
        }
    }
}
