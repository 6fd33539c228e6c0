//! Solves the linear equations of a stiff step in all lanes at once, in an order of elimination
//! found once for the model from which entries of the Jacobian are zero.
//!
//! Lanes cannot exchange rows independently, so the pivots stay on the diagonal. Rounding errors stay
//! small if what elimination subtracts from each diagonal entry is not much larger than the entry
//! before or after; this does not depend on the units of the variables. Where it is larger in a lane,
//! its step is rejected; with a shorter step the diagonal dominates.
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]
#![allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]

/// The largest accepted ratio, which bounds the growth of rounding errors to far below any tolerance.
const LARGEST: f64 = 1e5;

/// One pivot: where its numbers are and what its elimination changes.
#[derive(Debug, Clone)]
struct Pivot {
    /// The variable.
    variable: usize,
    /// Its place on the diagonal.
    diagonal: usize,
    /// Entries below: the variable of the row, and the place.
    below: Vec<(usize, usize)>,
    /// Entries to the right: the variable of the column, and the place.
    right: Vec<(usize, usize)>,
    /// `entry -= below * right`: three places, those of one row together.
    changes: Vec<[usize; 3]>,
    /// Those of them that change the diagonal: the variable, and the places of both factors.
    diagonals: Vec<[usize; 3]>,
}

/// An order of elimination of `diagonal I - J`: next the variable whose elimination changes the
/// fewest entries (Markowitz's rule, on the diagonal).
#[derive(Debug, Clone)]
pub(super) struct Plan {
    pivots: Vec<Pivot>,
    /// Number of nonzero entries.
    entries: usize,
    /// The place of each given entry of the Jacobian.
    places: Vec<usize>,
}

impl Plan {
    /// The plan for a Jacobian with nonzero entries at these rows and columns.
    pub(super) fn new(size: usize, pattern: &[(usize, usize)]) -> Self {
        let mut filled = vec![false; size * size];
        for &(row, column) in pattern {
            filled[row * size + column] = true;
        }
        for k in 0..size {
            filled[k * size + k] = true;
        }
        let mut open: Vec<usize> = (0..size).collect();
        let mut order = Vec::with_capacity(size);
        while !open.is_empty() {
            let cost = |k: usize| {
                let others = || open.iter().filter(|other| **other != k);
                let rows = others().filter(|row| filled[**row * size + k]).count();
                let columns = others().filter(|column| filled[k * size + **column]).count();
                rows * columns
            };
            let least = open.iter().copied().min_by_key(|k| (cost(*k), *k)).unwrap_or_default();
            open.retain(|k| *k != least);
            for row in
                open.iter().filter(|row| filled[**row * size + least]).copied().collect::<Vec<_>>()
            {
                for column in &open {
                    filled[row * size + column] |= filled[least * size + column];
                }
            }
            order.push(least);
        }
        Self::in_order(&order, &filled, pattern)
    }

    fn in_order(order: &[usize], filled: &[bool], pattern: &[(usize, usize)]) -> Self {
        let size = order.len();
        let mut place = vec![usize::MAX; size * size];
        let mut entries = 0;
        for &row in order {
            for &column in order {
                if filled[row * size + column] {
                    place[row * size + column] = entries;
                    entries += 1;
                }
            }
        }
        let pivot = |(step, &k): (usize, &usize)| {
            let later = || order[step + 1..].iter().copied();
            let below: Vec<(usize, usize)> = later()
                .filter(|row| filled[row * size + k])
                .map(|row| (row, place[row * size + k]))
                .collect();
            let right: Vec<(usize, usize)> = later()
                .filter(|column| filled[k * size + column])
                .map(|column| (column, place[k * size + column]))
                .collect();
            let changes: Vec<[usize; 3]> = below
                .iter()
                .flat_map(|&(row, left)| {
                    let place = &place;
                    right.iter().map(move |&(column, up)| [place[row * size + column], left, up])
                })
                .collect();
            let same = |&(row, left): &(usize, usize)| {
                let up = right.iter().find(|(column, _)| *column == row)?.1;
                Some([row, left, up])
            };
            let diagonals = below.iter().filter_map(same).collect();
            Pivot { variable: k, diagonal: place[k * size + k], below, right, changes, diagonals }
        };
        let pivots = order.iter().enumerate().map(pivot).collect();
        let places = pattern.iter().map(|&(row, column)| place[row * size + column]).collect();
        Self { pivots, entries, places }
    }

    /// Number of nonzero entries, with those that elimination adds.
    pub(super) fn entries(&self) -> usize {
        self.entries
    }
}

/// The factorised equations of all lanes.
#[derive(Debug, Clone)]
pub(super) struct Elimination<const N: usize> {
    values: Vec<[f64; N]>,
    /// The inverse of each pivot.
    inverses: Vec<[f64; N]>,
    /// The diagonal before elimination, and the sizes of what was subtracted from it, by variable.
    before: Vec<[f64; N]>,
    taken: Vec<[f64; N]>,
    largest: [f64; N],
}

impl<const N: usize> Elimination<N> {
    pub(super) fn new(plan: &Plan) -> Self {
        Self {
            values: vec![[0.0; N]; plan.entries()],
            inverses: vec![[0.0; N]; plan.pivots.len()],
            before: vec![[0.0; N]; plan.pivots.len()],
            taken: vec![[0.0; N]; plan.pivots.len()],
            largest: [0.0; N],
        }
    }

    /// Factorises the equations with these diagonals and entries of the Jacobian.
    #[inline(always)]
    pub(super) fn factorise(
        &mut self,
        plan: &Plan,
        diagonal: &[f64; N],
        jacobian: impl Iterator<Item = [f64; N]>,
    ) {
        let Self { values, inverses, before, taken, largest } = self;
        values.fill([0.0; N]);
        taken.fill([0.0; N]);
        for (place, entry) in plan.places.iter().zip(jacobian) {
            values[*place] = entry.map(|entry| -entry);
        }
        for pivot in &plan.pivots {
            for lane in 0..N {
                values[pivot.diagonal][lane] += diagonal[lane];
            }
            before[pivot.variable] = values[pivot.diagonal];
        }
        let mut most = [0.0; N];
        for (pivot, own) in plan.pivots.iter().zip(inverses) {
            let (now, before, taken_here) =
                (values[pivot.diagonal], before[pivot.variable], taken[pivot.variable]);
            let mut inverse = [0.0; N];
            for lane in 0..N {
                inverse[lane] = 1.0 / now[lane];
                let (now, before) = (now[lane].abs(), before[lane].abs());
                let ratio = taken_here[lane] / if now < before { now } else { before };
                // NaN stays.
                let larger = (ratio > most[lane]) | ratio.is_nan();
                most[lane] = if larger { ratio } else { most[lane] };
            }
            *own = inverse;
            for &(_, place) in &pivot.below {
                for lane in 0..N {
                    values[place][lane] *= inverse[lane];
                }
            }
            for &[variable, left, up] in &pivot.diagonals {
                let (left, up) = (values[left], values[up]);
                for lane in 0..N {
                    taken[variable][lane] += (left[lane] * up[lane]).abs();
                }
            }
            for &[to, left, up] in &pivot.changes {
                let (mut entry, left, up) = (values[to], values[left], values[up]);
                for lane in 0..N {
                    entry[lane] -= left[lane] * up[lane];
                }
                values[to] = entry;
            }
        }
        *largest = most;
    }

    /// 0 if a lane's equations can be solved, NaN if not.
    #[inline(always)]
    pub(super) fn doubt(&self) -> [f64; N] {
        self.largest.map(|largest| if largest <= LARGEST { 0.0 } else { f64::NAN })
    }

    /// Replaces the right-hand side, variable by variable, by the solution.
    #[inline(always)]
    pub(super) fn solve(&self, plan: &Plan, vector: &mut [[f64; N]]) {
        for pivot in &plan.pivots {
            let own = vector[pivot.variable];
            for &(row, place) in &pivot.below {
                let (mut entry, factor) = (vector[row], self.values[place]);
                for lane in 0..N {
                    entry[lane] -= factor[lane] * own[lane];
                }
                vector[row] = entry;
            }
        }
        for (pivot, inverse) in plan.pivots.iter().zip(&self.inverses).rev() {
            let mut own = vector[pivot.variable];
            for &(column, place) in &pivot.right {
                let (other, factor) = (vector[column], self.values[place]);
                for lane in 0..N {
                    own[lane] -= factor[lane] * other[lane];
                }
            }
            for lane in 0..N {
                own[lane] *= inverse[lane];
            }
            vector[pivot.variable] = own;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_solves_the_equations_and_zeros_stay() {
        // An arrow: only the last row and column are full.
        let size = 12;
        let mut pattern: Vec<(usize, usize)> = (0..size).map(|k| (k, k)).collect();
        pattern.extend((0..size - 1).flat_map(|k| [(k, size - 1), (size - 1, k)]));
        let plan = Plan::new(size, &pattern);
        assert_eq!(plan.entries(), pattern.len());
        let weyl = |k: usize| (k as f64 * 0.618_033_988_749_894_9).fract() - 0.5;
        let jacobian: Vec<[f64; 2]> =
            (0..pattern.len()).map(|k| [weyl(k + 1), 2.0 * weyl(3 * k + 2)]).collect();
        let diagonal = [3.0, 5.0];
        let mut elimination = Elimination::<2>::new(&plan);
        elimination.factorise(&plan, &diagonal, jacobian.iter().copied());
        assert_eq!(elimination.doubt(), [0.0; 2]);
        let right: Vec<[f64; 2]> = (0..size).map(|k| [weyl(7 * k), weyl(5 * k + 1)]).collect();
        let mut solution = right.clone();
        elimination.solve(&plan, &mut solution);
        for lane in 0..2 {
            for row in 0..size {
                let left: f64 = diagonal[lane] * solution[row][lane]
                    - pattern
                        .iter()
                        .zip(&jacobian)
                        .filter(|((own, _), _)| *own == row)
                        .map(|((_, column), entry)| entry[lane] * solution[*column][lane])
                        .sum::<f64>();
                // Rounding of a dozen terms.
                assert!((left - right[row][lane]).abs() < 1e-14, "{row} {lane}");
            }
        }
    }

    #[test]
    fn a_large_factor_is_doubted() {
        let plan = Plan::new(2, &[(0, 0), (0, 1), (1, 0), (1, 1)]);
        let mut elimination = Elimination::<1>::new(&plan);
        let jacobian = [[1.0 - 1e-6], [1.0], [1.0], [0.0]];
        elimination.factorise(&plan, &[1.0], jacobian.into_iter());
        assert!(elimination.doubt()[0].is_nan());
    }
}
