//! Elimination of the first columns of a dense symmetric matrix.

use super::error::FactorError;
use crate::interruption::Interruption;
use pulp::{Simd, WithSimd};

/// Number of columns that are eliminated one by one before the others are updated.
const BLOCK: usize = 16;

/// Rows of a tile with the widest registers: two of them. A tile of sums stays in registers; where they are many, it has
/// [`MANY`] columns, else [`FEW`].
const MOST_ROWS: usize = 16;
const MANY: usize = 8;
const FEW: usize = 4;

/// Rows that are updated in all columns before the next ones, so that their tiles lie in the cache.
const STRIP: usize = 32 * MOST_ROWS;

/// How the columns of a front are put together.
#[derive(Debug, Clone, Copy)]
pub(super) struct Blocks {
    /// Columns that are eliminated before the others of the front are updated.
    wide: usize,
    /// Columns that are taken from the rest at a time.
    deep: usize,
    /// Whether a product and its sum are rounded once, where the processor can do so.
    fused: bool,
}

impl Blocks {
    /// For small fronts: sums are the same on every machine.
    pub(super) const SMALL: Self = Self { wide: BLOCK, deep: usize::MAX, fused: false };
    /// For large ones: what is used again lies in the caches (`goto_2008`).
    pub(super) const LARGE: Self = Self { wide: 128, deep: 128, fused: true };
}

/// Cholesky's elimination of the first columns of a front (`golub_van_loan_2013`,
/// chapter 4), by blocks of columns:
///
/// ```text
/// [ A  B' ]   [ L     ] [ L'  M' ]
/// [ B  C  ] = [ M  1  ] [     C - M M' ]
/// ```
///
/// All matrices are stored by columns as lower triangles; elements above the diagonals are not
/// read. Every sum has the same order. With [`Blocks::SMALL`], which fuses no operations, results are bitwise the
/// same on every machine.
pub(super) struct Eliminate<'a> {
    /// `A` over `B`, becomes `L` over `M`.
    pub(super) panel: &'a mut [f64],
    pub(super) rows: usize,
    pub(super) columns: usize,
    /// `C`, becomes `C - M M'`.
    pub(super) rest: &'a mut [f64],
    pub(super) blocks: Blocks,
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
        if S::F64_LANES * 2 == MOST_ROWS {
            eliminate::<S, MANY>(simd, self)
        } else {
            eliminate::<S, FEW>(simd, self)
        }
    }
}

#[inline(always)]
#[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
fn eliminate<S: Simd, const WIDTH: usize>(
    simd: S,
    Eliminate { panel, rows, columns, rest, blocks, packed, interruption }: Eliminate<'_>,
) -> Result<(), FactorError> {
    if columns == 0 {
        // Parts that do not touch have no separator.
        return Ok(());
    }
    let mut wide = 0;
    for start in (0..columns).step_by(BLOCK) {
        interruption.check()?;
        let end = columns.min(start + BLOCK);
        if !factorise(panel, rows, start, end) {
            return Err(FactorError::Indefinite);
        }
        // First the other columns of the wide block, then all after it.
        let last = columns.min(wide + blocks.wide);
        let updates = [(start, last), (wide, columns)];
        for (from, to) in updates.into_iter().take(1 + usize::from(end == last)) {
            let (block, others) = panel.split_at_mut(end * rows);
            let taken = Taken { block: &block[from * rows..], stride: rows, first: end };
            let size = [rows - end, to - end];
            if end < to {
                let others = &mut others[end..];
                subtract_square::<S, WIDTH>(simd, taken, size, others, rows, blocks, packed);
            }
        }
        if end == last {
            wide = end;
        }
    }
    let (size, stride) = ([rows - columns; 2], rows - columns);
    let taken = Taken { block: panel, stride: rows, first: columns };
    subtract_square::<S, WIDTH>(simd, taken, size, rest, stride, blocks, packed);
    Ok(())
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

/// Columns that are eliminated, and the rows of them from `first` on: `M`.
#[derive(Clone, Copy)]
struct Taken<'a> {
    block: &'a [f64],
    stride: usize,
    first: usize,
}

/// Subtracts `M M'` from the lower half of the first columns of a square matrix.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn subtract_square<S: Simd, const WIDTH: usize>(
    simd: S,
    taken: Taken<'_>,
    [rows, columns]: [usize; 2],
    target: &mut [f64],
    target_stride: usize,
    blocks: Blocks,
    [left, right]: &mut [Vec<f64>; 2],
) {
    if columns == 0 {
        return;
    }
    let height = 2 * S::F64_LANES;
    let deep = blocks.deep.saturating_mul(taken.stride);
    for block in taken.block.chunks(deep) {
        let taken = Taken { block, ..taken };
        let depth = block.len() / taken.stride;
        pack(taken, rows, height, left);
        pack(taken, columns, WIDTH, right);
        for (at, left) in left.chunks(depth * STRIP).enumerate() {
            let first = at * STRIP;
            for (at, right) in right.chunks_exact(depth * WIDTH).enumerate() {
                let column = at * WIDTH;
                if column >= first + STRIP {
                    break;
                }
                // Tiles above the diagonal have no part in it.
                let skipped = column.saturating_sub(first) / height;
                let tiles = left.chunks_exact(depth * height).enumerate().skip(skipped);
                for (at, left) in tiles {
                    let row = first + at * height;
                    let tile: [_; WIDTH] = if blocks.fused {
                        product(left, right, |a, b, sum| simd.mul_add_e_f64s(a, b, sum), simd)
                    } else {
                        let mul_add = |a, b, sum| simd.add_f64s(sum, simd.mul_f64s(a, b));
                        product(left, right, mul_add, simd)
                    };
                    let whole = column + WIDTH <= columns
                        && row + height <= rows
                        && row + 1 >= column + WIDTH;
                    // By number and value, so that the sums can stay in registers.
                    for at in 0..WIDTH {
                        let (column, [upper, lower]) = (column + at, tile[at]);
                        let place = column * target_stride + row;
                        if whole {
                            let values = &mut target[place..place + height];
                            let (values, _) = S::as_mut_simd_f64s(values);
                            values[0] = simd.sub_f64s(values[0], upper);
                            values[1] = simd.sub_f64s(values[1], lower);
                        } else if column < columns {
                            let mut sums = [0.0; MOST_ROWS];
                            let (halves, _) = S::as_mut_simd_f64s(&mut sums[..height]);
                            (halves[0], halves[1]) = (upper, lower);
                            let from = column.saturating_sub(row);
                            for at in from..height.min(rows - row) {
                                target[place + at] -= sums[at];
                            }
                        }
                    }
                }
            }
        }
    }
}

/// The product of a tile's rows and columns.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn product<S: Simd, const WIDTH: usize>(
    left: &[f64],
    right: &[f64],
    mul_add: impl Fn(S::f64s, S::f64s, S::f64s) -> S::f64s,
    simd: S,
) -> [[S::f64s; 2]; WIDTH] {
    let mut sums = [[simd.splat_f64s(0.0); 2]; WIDTH];
    let (left, _) = S::as_simd_f64s(left);
    for (left, right) in left.chunks_exact(2).zip(right.chunks_exact(WIDTH)) {
        for column in 0..WIDTH {
            let factor = simd.splat_f64s(right[column]);
            for half in 0..2 {
                sums[column][half] = mul_add(left[half], factor, sums[column][half]);
            }
        }
    }
    sums
}

/// Copies rows so that tiles of this height follow each other, each by columns, filled up with zeros.
#[inline(always)]
#[allow(clippy::inline_always, reason = "belongs to the vectorised work around it")]
fn pack(taken: Taken<'_>, rows: usize, height: usize, packed: &mut Vec<f64>) {
    let Taken { block, stride, first } = taken;
    let depth = block.len() / stride;
    packed.resize(rows.next_multiple_of(height) * depth, 0.0);
    for (at, tile) in packed.chunks_exact_mut(height * depth).enumerate() {
        let start = at * height;
        let count = height.min(rows - start);
        for (to, column) in tile.chunks_exact_mut(height).zip(block.chunks_exact(stride)) {
            let from = &column[first + start..first + start + count];
            if count == height {
                to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
            } else {
                to[..count].copy_from_slice(from);
                to[count..].fill(0.0);
            }
        }
    }
}
