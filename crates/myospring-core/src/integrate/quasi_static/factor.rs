//! Sparse Cholesky factors of the stiffness between free coordinates.
//!
//! The nodes are eliminated in the order of a nested dissection ([`dissection`]), set by set in
//! dense matrices ([`fronts`], [`dense`]). Order and pattern are determined once and reused as long
//! as the same nodes interact. Held coordinates are included with a stiffness of 1, so that all
//! blocks are D x D. It uses one thread and a fixed order of summation, so results are bitwise the
//! same on every machine.

mod dense;
mod dissection;
mod error;
mod fronts;

pub(super) use error::FactorError;

use crate::interruption::Interruption;
use crate::mechanics::Vectors;
use crate::mechanics::stiffness::StiffnessMatrix;
use dense::Eliminate;
use dissection::{Graph, dissect};
use fronts::{Front, Fronts};

/// A factor that is recomputed for each stiffness.
pub(super) struct Factor<'a, const D: usize = 2> {
    /// Positions, um, for the dissection.
    positions: &'a Vectors<D>,
    /// `free[axis][node]`
    free: [Vec<bool>; D],
    /// Number of blocks of the stiffness for which the fronts were determined.
    blocks: usize,
    fronts: Option<Fronts<D>>,
    /// Columns of the factor, front by front.
    entries: Vec<f64>,
    /// Updates that wait for the front above theirs.
    stacks: [Vec<f64>; 2],
    packed: [Vec<f64>; 2],
}

impl<'a, const D: usize> Factor<'a, D> {
    /// A factor for a body with its nodes near these positions (um) and these free coordinates:
    /// `free[axis][node]`.
    pub(super) fn new(positions: &'a Vectors<D>, free: [Vec<bool>; D]) -> Self {
        Self {
            positions,
            free,
            blocks: 0,
            fronts: None,
            entries: Vec::new(),
            stacks: Default::default(),
            packed: Default::default(),
        }
    }

    /// Factorises a stiffness.
    pub(super) fn factorise(
        &mut self,
        stiffness: &StiffnessMatrix<D>,
        interruption: &Interruption,
    ) -> Result<(), FactorError> {
        let fronts = match self.fronts.take() {
            Some(fronts) if self.blocks == stiffness.blocks() => fronts,
            _ => self.find_fronts(stiffness, interruption)?,
        };
        self.blocks = stiffness.blocks();
        self.stacks.iter_mut().for_each(Vec::clear);
        let mut fronts_in_order = fronts.list.iter();
        let done = fronts_in_order
            .try_for_each(|front| self.eliminate(stiffness, &fronts, front, interruption));
        self.fronts = Some(fronts);
        done
    }

    fn find_fronts(
        &mut self,
        stiffness: &StiffnessMatrix<D>,
        interruption: &Interruption,
    ) -> Result<Fronts<D>, FactorError> {
        let graph = Graph::new(stiffness);
        let fronts = Fronts::new(
            stiffness,
            &graph,
            dissect(&graph, self.positions, interruption),
            interruption,
        )?;
        let reserve = |memory: &mut Vec<f64>, size: usize| {
            memory.clear();
            memory.try_reserve_exact(size).map_err(|_| FactorError::TooLarge)
        };
        reserve(&mut self.entries, fronts.entries)?;
        self.entries.resize(fronts.entries, 0.0);
        for (stack, size) in self.stacks.iter_mut().zip(fronts.stacks) {
            reserve(stack, size)?;
        }
        Ok(fronts)
    }

    /// Eliminates a front and pushes its update on the stack.
    fn eliminate(
        &mut self,
        stiffness: &StiffnessMatrix<D>,
        fronts: &Fronts<D>,
        front: &Front<D>,
        interruption: &Interruption,
    ) -> Result<(), FactorError> {
        let panel = &mut self.entries[front.entries.clone()];
        front.fill(panel, stiffness, &fronts.order, &self.free);
        let [even, odd] = &mut self.stacks;
        let (stack, halves) = if front.stack == 0 { (even, odd) } else { (odd, even) };
        let start = stack.len();
        stack.resize(start + front.update_size(), 0.0);
        let rest = &mut stack[start..];
        for half in front.halves.iter().rev().flatten().map(|&half| &fronts.list[half]) {
            let start = halves.len() - half.update_size();
            half.hand_up(&halves[start..], front, panel, rest);
            halves.truncate(start);
        }
        let [rows, columns] = front.size();
        let packed = &mut self.packed;
        pulp::Arch::new().dispatch(Eliminate { panel, rows, columns, rest, packed, interruption })
    }

    /// Displacements (um) under forces (nN) on the free coordinates; held ones do not move.
    ///
    /// Uses the last factorised stiffness.
    pub(super) fn solve(&mut self, forces: &Vectors<D>) -> Vectors<D> {
        let mut moved = forces.each_ref().map(|axis| vec![0.0; axis.len()]);
        let Some(Fronts { order, list: fronts, .. }) = &self.fronts else { return moved };
        let mut right = vec![0.0; D * order.len()];
        for (place, &node) in order.iter().enumerate() {
            for axis in 0..D {
                if self.free[axis][node] {
                    right[D * place + axis] = forces[axis][node];
                }
            }
        }
        let mut border = Vec::new();
        for front in fronts {
            let [rows, columns] = front.size();
            border.clear();
            border.resize(rows - columns, 0.0);
            let own = &mut right[D * front.own.start..D * front.own.end];
            for column in 0..columns {
                let entries = &self.entries[front.entries.start + column * rows..][..rows];
                let value = own[column] / entries[column];
                own[column] = value;
                let (inner, outer) = entries[column + 1..].split_at(columns - column - 1);
                for (sum, entry) in own[column + 1..].iter_mut().zip(inner) {
                    *sum -= value * entry;
                }
                for (sum, entry) in border.iter_mut().zip(outer) {
                    *sum += value * entry;
                }
            }
            for (parts, &place) in border.chunks_exact(D).zip(&front.border) {
                for (axis, part) in parts.iter().enumerate() {
                    right[D * place + axis] -= part;
                }
            }
        }
        for front in fronts.iter().rev() {
            let [rows, columns] = front.size();
            border.clear();
            border.extend(front.border.iter().flat_map(|&at| &right[D * at..D * (at + 1)]));
            let own = &mut right[D * front.own.start..D * front.own.end];
            for column in (0..columns).rev() {
                let entries = &self.entries[front.entries.start + column * rows..][..rows];
                let (inner, outer) = entries[column + 1..].split_at(columns - column - 1);
                let sum = dot(inner, &own[column + 1..]) + dot(outer, &border);
                own[column] = (own[column] - sum) / entries[column];
            }
        }
        for (place, &node) in order.iter().enumerate() {
            for axis in 0..D {
                if self.free[axis][node] {
                    moved[axis][node] = right[D * place + axis];
                }
            }
        }
        moved
    }
}

/// Scalar product in eight partial sums, for vector units.
fn dot(a: &[f64], b: &[f64]) -> f64 {
    let mut lanes = [0.0; 8];
    let ((a, a_rest), (b, b_rest)) = (a.as_chunks::<8>(), b.as_chunks::<8>());
    for (a, b) in a.iter().zip(b) {
        for lane in 0..8 {
            lanes[lane] += a[lane] * b[lane];
        }
    }
    let rest: f64 = a_rest.iter().zip(b_rest).map(|(a, b)| a * b).sum();
    lanes.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests;
