//! The tangent stiffness: minus the derivative of the forces with respect to the positions.
//!
//! It is symmetric for forces with an energy. It is stored as blocks of D x D, one per pair of
//! interacting nodes, only the upper half. A force adds its part in
//! [`super::Force::add_stiffness`].

use super::vectors::{Vectors, add_scaled, zeros};
use std::ops::Range;

/// Half of a thick body with fewer nodes is not worth a second thread.
const WORTH_A_THREAD: usize = 2000;

/// The part of a stiffness between two nodes, nN/um: `block[axis of the first][axis of the
/// second]`.
pub type Block<const D: usize = 2> = [[f64; D]; D];

/// A symmetric stiffness matrix in blocks of D x D, nN/um.
///
/// # Example
/// ```
/// use myospring::mechanics::stiffness::StiffnessMatrix;
/// // A spring of 3 nN/um along x between nodes 0 and 1.
/// let mut stiffness = StiffnessMatrix::new(2);
/// stiffness.add_pair(0, 1, [[3.0, 0.0], [0.0, 0.0]]);
/// let restoring = stiffness.times(&[vec![0.0, 0.5], vec![0.0, 0.0]]);
/// assert_eq!(restoring, [vec![-1.5, 1.5], vec![0.0, 0.0]]);
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct StiffnessMatrix<const D: usize = 2> {
    rows: Vec<Row<D>>,
    blocks: usize,
}

/// The partners of a node with equal or higher index, in order, and the block of each. They lie apart: partners are searched often.
#[derive(Debug, Clone, PartialEq, Default)]
struct Row<const D: usize> {
    partners: Vec<usize>,
    blocks: Vec<Block<D>>,
}

impl<const D: usize> StiffnessMatrix<D> {
    /// A matrix of zeros for `count` nodes.
    pub fn new(count: usize) -> Self {
        Self { rows: vec![Row::default(); count], blocks: 0 }
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no nodes.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Number of stored blocks; it grows only when a new pair of nodes interacts.
    pub fn blocks(&self) -> usize {
        self.blocks
    }

    /// Sets all values to zero and keeps the pattern.
    pub fn clear(&mut self) {
        for row in &mut self.rows {
            row.blocks.fill([[0.0; D]; D]);
        }
    }

    /// Adds a block between nodes `a` and `b`, nN/um, and its mirror image between `b` and `a`.
    ///
    /// # Panics
    /// If a node does not exist.
    #[inline]
    pub fn add(&mut self, a: usize, b: usize, block: Block<D>) {
        let sum = self.block(a.min(b), a.max(b));
        for i in 0..D {
            for j in 0..D {
                sum[i][j] += if a <= b { block[i][j] } else { block[j][i] };
            }
        }
    }

    /// The block of two nodes, the second of which is not less; of zeros if they have not interacted yet.
    #[inline]
    fn block(&mut self, row: usize, column: usize) -> &mut Block<D> {
        assert!(column < self.rows.len(), "node {column} of {}", self.rows.len());
        let Row { partners, blocks } = &mut self.rows[row];
        let place = partners.iter().position(|other| *other >= column).unwrap_or(partners.len());
        if partners.get(place) != Some(&column) {
            partners.insert(place, column);
            // A sum that starts with -0 has the bits of its first part.
            blocks.insert(place, [[-0.0; D]; D]);
            self.blocks += 1;
        }
        &mut blocks[place]
    }

    /// Adds a symmetric block that acts on the vector between two nodes, nN/um.
    ///
    /// # Panics
    /// If a node does not exist.
    pub fn add_pair(&mut self, a: usize, b: usize, block: Block<D>) {
        self.add(a, a, block);
        self.add(b, b, block);
        let sum = self.block(a.min(b), a.max(b));
        for i in 0..D {
            for j in 0..D {
                sum[i][j] -= block[i][j];
            }
        }
    }

    /// Adds another matrix.
    ///
    /// # Panics
    /// If it has more nodes.
    pub(crate) fn add_all(&mut self, other: &Self) {
        for (a, row) in other.rows.iter().enumerate() {
            if self.rows[a].partners == row.partners {
                for (sum, block) in self.rows[a].blocks.iter_mut().zip(&row.blocks) {
                    for (sum, part) in sum.iter_mut().flatten().zip(block.iter().flatten()) {
                        *sum += part;
                    }
                }
            } else {
                for (&b, block) in row.partners.iter().zip(&row.blocks) {
                    self.add(a, b, *block);
                }
            }
        }
    }

    /// The partners of a node with equal or higher index, in order, and their blocks.
    pub fn row(&self, node: usize) -> (&[usize], &[Block<D>]) {
        let Row { partners, blocks } = &self.rows[node];
        (partners, blocks)
    }

    /// The product with one vector per node (um gives nN).
    pub fn times(&self, vectors: &Vectors<D>) -> Vectors<D> {
        let part = |rows| {
            let mut product = zeros(self.len());
            self.add_product(rows, vectors, &mut product);
            product
        };
        let (count, half) = (self.len(), self.len() / 2);
        if D == 2 || half < WORTH_A_THREAD {
            return part(0..count);
        }
        let (mut product, other) = rayon::join(|| part(0..half), || part(half..count));
        add_scaled(&mut product, 1.0, &other);
        product
    }

    /// Adds the product with the blocks of some rows.
    fn add_product(&self, rows: Range<usize>, vectors: &Vectors<D>, product: &mut Vectors<D>) {
        for (a, row) in rows.clone().zip(&self.rows[rows]) {
            for (&b, block) in row.partners.iter().zip(&row.blocks) {
                for i in 0..D {
                    for j in 0..D {
                        product[i][a] += block[i][j] * vectors[j][b];
                        if a != b {
                            product[j][b] += block[i][j] * vectors[i][a];
                        }
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::array::from_fn;

    /// Blocks between a node and some after it, all different.
    fn some(count: usize, distances: &[usize]) -> StiffnessMatrix<3> {
        let mut stiffness = StiffnessMatrix::new(count);
        for a in 0..count {
            for b in distances.iter().map(|distance| a + distance).filter(|b| *b < count) {
                let value = |i, j| (((a + 3 * b) * 9 + 3 * i + j) as f64 * 0.618_034).fract();
                stiffness.add(a, b, from_fn(|i| from_fn(|j| value(i.min(j), i.max(j)))));
            }
        }
        stiffness
    }

    #[test]
    fn a_sum_of_matrices_has_the_blocks_of_both_whatever_their_patterns() {
        let vectors: Vectors<3> =
            from_fn(|axis| (0..40).map(|i| (i * (axis + 1)) as f64).collect());
        for distances in [&[0, 1, 5][..], &[0, 2, 7], &[3]] {
            let (first, second) = (some(40, &[0, 1, 5]), some(40, distances));
            let mut sum = first.clone();
            sum.add_all(&second);
            let mut expected = first.times(&vectors);
            add_scaled(&mut expected, 1.0, &second.times(&vectors));
            let got = sum.times(&vectors);
            for (a, b) in got.iter().flatten().zip(expected.iter().flatten()) {
                assert!((a - b).abs() < 1e-12 * b.abs().max(1.0), "{distances:?}: {a} {b}");
            }
            let mut pairs: Vec<_> = [&[0, 1, 5][..], distances].concat();
            pairs.sort_unstable();
            pairs.dedup();
            let blocks: usize = pairs.iter().map(|distance| 40 - distance).sum();
            assert_eq!(sum.blocks(), blocks);
        }
    }

    #[test]
    fn two_threads_give_the_product_of_one() {
        let count = 2 * WORTH_A_THREAD + 101;
        let stiffness = some(count, &[0, 1, 70]);
        let vectors: Vectors<3> =
            from_fn(|axis| (0..count).map(|i| ((i + axis) as f64).sin()).collect());
        let mut alone = zeros(count);
        stiffness.add_product(0..count, &vectors, &mut alone);
        for (a, b) in stiffness.times(&vectors).iter().flatten().zip(alone.iter().flatten()) {
            assert!((a - b).abs() < 1e-13, "{a} {b}");
        }
    }
}
