//! Solves the linear equations of all lanes at once: first the gates, then the other states, in a
//! fixed order.
//!
//! A gate depends only on the potential and itself, so eliminating it costs a multiple of one
//! column. The remaining matrix is dense and is eliminated without exchanging rows, because lanes
//! cannot exchange rows independently. This is stable if no factor is large after scaling each
//! variable by its size. If a factor is large in a lane, its step is rejected; with a shorter step
//! the diagonal dominates.
#![allow(clippy::needless_bitwise_bool, reason = "no branches in the vectorised loops")]
#![allow(clippy::inline_always, reason = "what the vectorised loops call is inlined into them")]

use crate::cell::tomek_2019::lanes::{GATED, LANES, MOST, OTHERS, Together, Wide};
use pulp::Simd;

/// The largest accepted factor, which bounds the growth of rounding errors.
const LARGEST: f64 = 1e3;

const NONE: Wide = [0.0; LANES];

/// The factorised equations `(diagonal I - J) x = b` of all lanes.
pub(super) struct Elimination<const LAND: bool> {
    /// Inverse pivot of each gate, and its derivative with respect to the potential.
    gates: [Wide; GATED],
    by_potential: [Wide; GATED],
    /// Derivatives of the other rates with respect to each gate.
    by_gate: [[Wide; OTHERS]; GATED],
    /// Both triangles of the remaining matrix, column by column, and the inverse of each pivot.
    columns: [[Wide; OTHERS]; OTHERS],
    pivots: [Wide; OTHERS],
    largest: Wide,
}

impl<const LAND: bool> Elimination<LAND> {
    const UNGATED: usize = Together::<LAND>::UNGATED;
    /// Index of the first gate among all states.
    const GATES: usize = Together::<LAND>::GATES;

    #[allow(clippy::large_stack_arrays, reason = "made once for many cells, and moved to the heap")]
    pub(super) fn new() -> Self {
        Self {
            gates: [NONE; GATED],
            by_potential: [NONE; GATED],
            by_gate: [[NONE; OTHERS]; GATED],
            columns: [[NONE; OTHERS]; OTHERS],
            pivots: [NONE; OTHERS],
            largest: NONE,
        }
    }

    /// Factorises the equations with these diagonals and the Jacobian of the cells; variables are
    /// scaled by the sizes in this state.
    #[inline(always)]
    pub(super) fn factorise<S: Simd>(
        &mut self,
        simd: S,
        diagonal: &Wide,
        cells: &Together<LAND>,
        state: &[Wide; MOST],
        floors: &[Wide; MOST],
    ) {
        let diagonal = *diagonal;
        for other in 0..Self::UNGATED {
            let from = &cells.by_state[Together::<LAND>::place(other)];
            let column = &mut self.columns[other];
            for row in 0..Self::UNGATED {
                let entry = from[row];
                column[row] = entry.map(|entry| -entry);
            }
            let entry = column[other];
            column[other] = std::array::from_fn(|lane| entry[lane] + diagonal[lane]);
        }
        // x_g = (b_g + J_gv v) / (diagonal - J_gg)
        for gate in 0..GATED {
            let own = cells.gate_by_itself[gate];
            let inverse = std::array::from_fn(|lane| 1.0 / (diagonal[lane] - own[lane]));
            self.gates[gate] = inverse;
            let by_potential = cells.gate_by_potential[gate];
            self.by_potential[gate] = by_potential;
            let factor = std::array::from_fn(|lane| inverse[lane] * by_potential[lane]);
            let from = &cells.by_state[Self::GATES + gate];
            self.by_gate[gate] = *from;
            take(simd, &mut self.columns[0][..Self::UNGATED], &factor, from);
        }
        let mut largest = NONE;
        for k in 0..Self::UNGATED {
            let (left, right) = self.columns.split_at_mut(k + 1);
            let column = &mut left[k];
            let inverse = column[k].map(|pivot| 1.0 / pivot);
            self.pivots[k] = inverse;
            let place = Together::<LAND>::place(k);
            let size: Wide =
                std::array::from_fn(|lane| floors[place][lane] + state[place][lane].abs());
            for row in k + 1..Self::UNGATED {
                let entry = column[row];
                let factor: Wide = std::array::from_fn(|lane| entry[lane] * inverse[lane]);
                column[row] = factor;
                let place = Together::<LAND>::place(row);
                let (floor, value) = (floors[place], state[place]);
                for lane in 0..LANES {
                    let own = floor[lane] + value[lane].abs();
                    let scaled = factor[lane].abs() * size[lane] / own;
                    // NaN stays.
                    let larger = (scaled > largest[lane]) | scaled.is_nan();
                    largest[lane] = if larger { scaled } else { largest[lane] };
                }
            }
            for other in &mut right[..Self::UNGATED - k - 1] {
                let times = other[k];
                // Many factors are 0 in every lane; those are skipped.
                if times != NONE {
                    let rows = k + 1..Self::UNGATED;
                    take(simd, &mut other[rows.clone()], &times, &column[rows]);
                }
            }
        }
        self.largest = largest;
    }

    /// 0 if a lane's equations can be solved, NaN if not.
    #[inline(always)]
    pub(super) fn doubt(&self) -> Wide {
        self.largest.map(|largest| if largest <= LARGEST { 0.0 } else { f64::NAN })
    }

    /// Replaces the right-hand side by the solution.
    #[inline(always)]
    pub(super) fn solve<S: Simd>(&self, simd: S, vector: &mut [Wide; MOST]) {
        let mut others = [NONE; OTHERS];
        for other in 0..Self::UNGATED {
            others[other] = vector[Together::<LAND>::place(other)];
        }
        for gate in 0..GATED {
            let (value, inverse) = (vector[Self::GATES + gate], self.gates[gate]);
            let freed: Wide = std::array::from_fn(|lane| -(value[lane] * inverse[lane]));
            take(simd, &mut others[..Self::UNGATED], &freed, &self.by_gate[gate]);
        }
        for k in 0..Self::UNGATED {
            let times = others[k];
            let rows = k + 1..Self::UNGATED;
            take(simd, &mut others[rows.clone()], &times, &self.columns[k][rows]);
        }
        for k in (0..Self::UNGATED).rev() {
            let (value, inverse) = (others[k], self.pivots[k]);
            let times: Wide = std::array::from_fn(|lane| value[lane] * inverse[lane]);
            others[k] = times;
            take(simd, &mut others[..k], &times, &self.columns[k]);
        }
        let v = others[0];
        for gate in 0..GATED {
            let (value, inverse) = (vector[Self::GATES + gate], self.gates[gate]);
            let by_potential = self.by_potential[gate];
            vector[Self::GATES + gate] = std::array::from_fn(|lane| {
                (value[lane] + by_potential[lane] * v[lane]) * inverse[lane]
            });
        }
        for other in 0..Self::UNGATED {
            vector[Together::<LAND>::place(other)] = others[other];
        }
    }
}

/// Subtracts a number of each lane times a column from another column.
#[inline(always)]
fn take<S: Simd>(simd: S, from: &mut [Wide], times: &Wide, column: &[Wide]) {
    let (times, _) = S::as_simd_f64s(times);
    for (from, entry) in from.iter_mut().zip(column) {
        let (from, _) = S::as_mut_simd_f64s(from);
        let (entry, _) = S::as_simd_f64s(entry);
        for ((from, times), entry) in from.iter_mut().zip(times).zip(entry) {
            *from = simd.sub_f64s(*from, simd.mul_f64s(*times, *entry));
        }
    }
}
