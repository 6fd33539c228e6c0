//! Sparse Cholesky factors of the stiffness between free coordinates.
//!
//! The nodes are eliminated in the order of a nested dissection ([`dissection`]), set by set in
//! dense matrices ([`fronts`], [`dense`]). Order and pattern are determined once and reused as long
//! as the same nodes interact. Held coordinates are included with a stiffness of 1, so that all
//! blocks are D x D. The halves of a large set are eliminated by two threads, since neither needs the
//! other. Every sum has a fixed order, so results are bitwise the same on every machine, whatever the
//! number of threads.

mod dense;
mod dissection;
mod error;
mod fronts;

pub(super) use error::FactorError;

use crate::interruption::Interruption;
use crate::mechanics::Vectors;
use crate::mechanics::stiffness::StiffnessMatrix;
use dense::{Eliminate, Eliminated};
use dissection::{Graph, dissect};
use fronts::{Front, Fronts};
use std::ops::Range;

/// A factor that is recomputed for each stiffness.
pub(super) struct Factor<const D: usize = 2> {
    /// `free[axis][node]`
    free: [Vec<bool>; D],
    /// Number of blocks of the stiffness for which the fronts were determined.
    blocks: usize,
    fronts: Option<Fronts<D>>,
    /// Columns of the factor, front by front.
    entries: Vec<f64>,
    /// The same in half of the memory, if the factor is costly.
    rounded: Vec<f32>,
    /// Whether the entries are those of a factor.
    made: bool,
    /// Products for each entry from which on it is costly.
    costly: f64,
    room: Room,
}

/// Halves with less work than this, in products, are not worth a second thread.
const WORTH_A_THREAD: f64 = 1e7;

/// A factor is costly from this many products for each of its entries on, of a flat and of a thick body. One more then takes longer than
/// the uses of the last one that replace it: elimination is bound by the processor, use by memory. Thick bodies keep their volume, so that
/// guesses are more often unstable and a factor of their own is made in vain.
const COSTLY: [f64; 2] = [500.0, 200.0];

/// Memory of one thread.
#[derive(Default)]
struct Room {
    /// Updates that wait for the front above theirs.
    stacks: [Vec<f64>; 2],
    packed: [Vec<f64>; 2],
    /// That of the thread which eliminates the second half.
    beside: Option<Box<Self>>,
}

impl Room {
    fn clear(&mut self) {
        self.stacks.iter_mut().for_each(Vec::clear);
        if let Some(beside) = &mut self.beside {
            beside.clear();
        }
    }
}

/// Makes place for an update.
fn push(stack: &mut Vec<f64>, size: usize) -> Result<&mut [f64], FactorError> {
    let start = stack.len();
    stack.try_reserve(size).map_err(|_| FactorError::TooLarge)?;
    stack.resize(start + size, 0.0);
    Ok(&mut stack[start..])
}

/// Hands up the update of a half and takes it from the stack, where it lies on top.
fn pop<const D: usize>(
    stack: &mut Vec<f64>,
    half: &Front<D>,
    front: &Front<D>,
    panel: &mut [f64],
    rest: &mut [f64],
) {
    let start = stack.len() - half.update_size();
    half.hand_up(&stack[start..], front, panel, rest);
    stack.truncate(start);
}

/// The elimination of a matrix.
struct Elimination<'a, const D: usize> {
    stiffness: &'a StiffnessMatrix<D>,
    free: &'a [Vec<bool>; D],
    fronts: &'a Fronts<D>,
    interruption: &'a Interruption,
}

impl<const D: usize> Elimination<'_, D> {
    /// Eliminates a front and all below it, and pushes its update on the stack. `entries` are those of these fronts; the first of them is
    /// number `first` of the factor.
    fn subtree(
        &self,
        front: &Front<D>,
        (first, entries): (usize, &mut [f64]),
        room: &mut Room,
    ) -> Result<(), FactorError> {
        let [one, other] = front.halves.map(|half| half.map(|half| &self.fronts.list[half]));
        let end = |half: Option<&Front<D>>, start| half.map_or(start, |half| half.entries.end);
        let middle = end(one, first);
        let last = end(other, middle);
        let (below, panel) = entries.split_at_mut(last - first);
        let (left, right) = below.split_at_mut(middle - first);
        let apart = match (one, other) {
            (Some(one), Some(other)) if one.work.min(other.work) > WORTH_A_THREAD => {
                let mut beside = room.beside.take().unwrap_or_default();
                let (a, b) = rayon::join(
                    || self.subtree(one, (first, left), room),
                    || self.subtree(other, (middle, right), &mut beside),
                );
                room.beside = Some(beside);
                a.and(b)?;
                true
            }
            _ => {
                one.map_or(Ok(()), |one| self.subtree(one, (first, left), room))?;
                other.map_or(Ok(()), |other| self.subtree(other, (middle, right), room))?;
                false
            }
        };
        front.fill(panel, self.stiffness, &self.fronts.order, self.free);
        let Room { stacks: [even, odd], packed, beside } = room;
        let (stack, halves) = if front.stack == 0 { (even, odd) } else { (odd, even) };
        let rest = push(stack, front.update_size())?;
        if let Some(other) = other {
            let stack = match beside {
                Some(beside) if apart => &mut beside.stacks[1 - front.stack],
                _ => &mut *halves,
            };
            pop(stack, other, front, panel, rest);
        }
        if let Some(one) = one {
            pop(halves, one, front, panel, rest);
        }
        let [rows, columns] = front.size();
        let interruption = self.interruption;
        Eliminate { panel, rows, columns, rest, packed, interruption }.run()
    }
}

impl<const D: usize> Factor<D> {
    /// A factor for a body with these free coordinates: `free[axis][node]`.
    pub(super) fn new(free: [Vec<bool>; D]) -> Self {
        Self {
            free,
            blocks: 0,
            fronts: None,
            entries: Vec::new(),
            rounded: Vec::new(),
            made: false,
            costly: COSTLY[usize::from(D > 2)],
            room: Room::default(),
        }
    }

    /// Takes factors to be costly or not, whatever they cost.
    #[cfg(test)]
    pub(super) fn is_to_be_costly(&mut self, costly: bool) {
        self.costly = if costly { 0.0 } else { f64::INFINITY };
    }

    /// Whether there is a factor: the last one could be made.
    pub(super) fn is_made(&self) -> bool {
        self.made
    }

    /// Whether order and pattern are known.
    pub(super) fn is_analysed(&self) -> bool {
        self.fronts.is_some()
    }

    /// Determines order and pattern of a stiffness between nodes near these positions (um), as far as they are not known; the factor is
    /// then still to be made.
    pub(super) fn analyse(
        &mut self,
        positions: &Vectors<D>,
        stiffness: &StiffnessMatrix<D>,
        interruption: &Interruption,
    ) -> Result<(), FactorError> {
        if self.fronts.is_none() || self.blocks != stiffness.blocks() {
            self.fronts = None;
            self.fronts = Some(self.find_fronts(positions, stiffness, interruption)?);
            self.blocks = stiffness.blocks();
            if self.is_costly() {
                self.rounded.clear();
                let reserved = self.rounded.try_reserve_exact(self.entries.len());
                reserved.map_err(|_| FactorError::TooLarge)?;
            }
        }
        Ok(())
    }

    /// Factorises a stiffness between nodes near these positions (um).
    pub(super) fn factorise(
        &mut self,
        positions: &Vectors<D>,
        stiffness: &StiffnessMatrix<D>,
        interruption: &Interruption,
    ) -> Result<(), FactorError> {
        self.made = false;
        self.analyse(positions, stiffness, interruption)?;
        self.room.clear();
        let Self { free, fronts, entries, room, .. } = self;
        let Some(fronts) = fronts else { return Ok(()) };
        let elimination = Elimination { stiffness, free, fronts, interruption };
        if let Some(root) = fronts.list.last() {
            elimination.subtree(root, (0, entries), room)?;
        }
        if self.is_costly() {
            self.rounded.clear();
            self.rounded.extend(self.entries.iter().map(|entry| *entry as f32));
        }
        self.made = true;
        Ok(())
    }

    /// Whether a new factor costs much more than some uses of the last one.
    pub(super) fn is_costly(&self) -> bool {
        let root = self.fronts.as_ref().and_then(|fronts| fronts.list.last());
        root.is_some_and(|root| root.work > self.costly * self.entries.len() as f64)
    }

    /// Sets held coordinates to 0.
    pub(super) fn hold(&self, vectors: &mut Vectors<D>) {
        for (axis, free) in vectors.iter_mut().zip(&self.free) {
            axis.iter_mut()
                .zip(free)
                .filter(|(_, free)| !**free)
                .for_each(|(value, _)| *value = 0.0);
        }
    }

    fn find_fronts(
        &mut self,
        positions: &Vectors<D>,
        stiffness: &StiffnessMatrix<D>,
        interruption: &Interruption,
    ) -> Result<Fronts<D>, FactorError> {
        let graph = Graph::new(stiffness);
        let fronts =
            Fronts::new(stiffness, &graph, dissect(&graph, positions, interruption), interruption)?;
        let reserve = |memory: &mut Vec<f64>, size: usize| {
            memory.clear();
            memory.try_reserve_exact(size).map_err(|_| FactorError::TooLarge)
        };
        reserve(&mut self.entries, fronts.entries)?;
        self.entries.resize(fronts.entries, 0.0);
        for (stack, size) in self.room.stacks.iter_mut().zip(fronts.stacks) {
            reserve(stack, size)?;
        }
        Ok(fronts)
    }

    /// Displacements (um) under forces (nN) on the free coordinates; held ones do not move.
    ///
    /// Uses the last factorised stiffness.
    pub(super) fn solve(&self, forces: &Vectors<D>) -> Vectors<D> {
        self.solve_by(&self.entries, forces)
    }

    /// The same to some six digits, for a costly factor in half of the time: its use is bound by memory.
    pub(super) fn solve_roughly(&self, forces: &Vectors<D>) -> Vectors<D> {
        self.solve_by(&self.rounded, forces)
    }

    fn solve_by<T: Copy + Into<f64> + Sync>(
        &self,
        entries: &[T],
        forces: &Vectors<D>,
    ) -> Vectors<D> {
        let mut moved = forces.each_ref().map(|axis| vec![0.0; axis.len()]);
        let Some(Fronts { order, list, .. }) = &self.fronts else { return moved };
        let mut right = vec![0.0; D * order.len()];
        for (place, &node) in order.iter().enumerate() {
            for axis in 0..D {
                if self.free[axis][node] {
                    right[D * place + axis] = forces[axis][node];
                }
            }
        }
        let substitution = Substitution { fronts: list, entries, apart: self.is_costly() };
        if let Some(root) = list.len().checked_sub(1) {
            substitution.forward(root, &mut right);
            substitution.backward(root, &mut right);
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

/// The use of a factor: what each front does to the right side, from below and then from above.
struct Substitution<'a, T, const D: usize> {
    fronts: &'a [Front<D>],
    entries: &'a [T],
    /// Whether halves of large sets are left to two threads.
    apart: bool,
}

impl<T: Copy + Into<f64> + Sync, const D: usize> Substitution<'_, T, D> {
    /// Both halves of a front, if they are worth two threads.
    fn halves(&self, front: &Front<D>) -> Option<[usize; 2]> {
        let [Some(one), Some(other)] = front.halves else { return None };
        let least = self.fronts[one].work.min(self.fronts[other].work);
        (self.apart && least > WORTH_A_THREAD).then_some([one, other])
    }

    /// The coordinates of a front and of all below it.
    fn coordinates(&self, front: usize) -> Range<usize> {
        let first = &self.fronts[self.fronts[front].first];
        D * first.own.start..D * self.fronts[front].own.end
    }

    /// A front and all below it, from the first.
    fn forward(&self, at: usize, right: &mut [f64]) {
        let front = &self.fronts[at];
        let mut border = Vec::new();
        let Some([one, other]) = self.halves(front) else {
            for front in &self.fronts[front.first..=at] {
                self.eliminate(front, right, &mut border);
            }
            return;
        };
        // What the second half takes from the fronts above is added later.
        let own = self.coordinates(other);
        let mut beside = vec![0.0; right.len()];
        beside[own.clone()].copy_from_slice(&right[own.clone()]);
        rayon::join(|| self.forward(one, right), || self.forward(other, &mut beside));
        right[own.clone()].copy_from_slice(&beside[own.clone()]);
        for (value, taken) in right[own.end..].iter_mut().zip(&beside[own.end..]) {
            *value += taken;
        }
        self.eliminate(front, right, &mut border);
    }

    fn eliminate(&self, front: &Front<D>, right: &mut [f64], border: &mut Vec<f64>) {
        let [rows, columns] = front.size();
        border.clear();
        border.resize(rows - columns, 0.0);
        let own = &mut right[D * front.own.start..D * front.own.end];
        let panel = &self.entries[front.entries.clone()];
        Eliminated { panel, own, border }.take_off();
        for (parts, &place) in border.chunks_exact(D).zip(&front.border) {
            for (axis, part) in parts.iter().enumerate() {
                right[D * place + axis] -= part;
            }
        }
    }

    /// A front and all below it, from the last.
    fn backward(&self, at: usize, right: &mut [f64]) {
        let front = &self.fronts[at];
        let mut border = Vec::new();
        let Some([one, other]) = self.halves(front) else {
            for front in self.fronts[front.first..=at].iter().rev() {
                self.put_back(front, right, &mut border);
            }
            return;
        };
        self.put_back(front, right, &mut border);
        let own = self.coordinates(other);
        let mut beside = right.to_vec();
        rayon::join(|| self.backward(one, right), || self.backward(other, &mut beside));
        right[own.clone()].copy_from_slice(&beside[own]);
    }

    fn put_back(&self, front: &Front<D>, right: &mut [f64], border: &mut Vec<f64>) {
        border.clear();
        border.extend(front.border.iter().flat_map(|&at| &right[D * at..D * (at + 1)]));
        let own = &mut right[D * front.own.start..D * front.own.end];
        let panel = &self.entries[front.entries.clone()];
        Eliminated { panel, own, border }.put_back();
    }
}

#[cfg(test)]
mod tests;
