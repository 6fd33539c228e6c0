//! Sparse Cholesky factors of the stiffness between free coordinates.
//!
//! The nodes are eliminated in the order of a nested dissection ([`dissection`]), set by set in
//! dense matrices ([`fronts`], [`dense`]). Order and pattern are determined once and reused as long
//! as the same nodes interact. Held coordinates are included with a stiffness of 1, so that all
//! blocks are D x D. The halves of a large set are eliminated by two threads, since neither needs the
//! other. Every sum has a fixed order, whatever the number of threads, so results are bitwise the same: of flat bodies on
//! every machine, of thick ones where products and sums are fused: with vector units of x86-64 and ARM, not in the page ([`Blocks::LARGE`]).

mod dense;
mod dissection;
mod error;
mod fronts;

pub(super) use error::FactorError;

use crate::interruption::Interruption;
use crate::mechanics::Vectors;
use crate::mechanics::stiffness::StiffnessMatrix;
use dense::{Blocks, Eliminate, Eliminated};
use dissection::{Graph, dissect};
use fronts::{Front, Fronts};
use std::ops::Range;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// A factor that is recomputed for each stiffness.
pub(super) struct Factor<const D: usize = 2> {
    /// `free[axis][node]`
    free: [Vec<bool>; D],
    /// Number of blocks of the stiffness for which the fronts were determined.
    blocks: usize,
    fronts: Option<Fronts<D>>,
    /// Columns of the factor, front by front.
    entries: Entries,
    /// Whether the entries are those of a factor.
    made: bool,
    /// Products for each entry from which on it is costly.
    costly: f64,
    /// Whether one that is costly is rounded.
    rounds: bool,
    rooms: Rooms,
}

/// Entries of a factor. Its use is bound by memory: rounded ones take half of it, and half of the time.
enum Entries {
    Whole(Vec<f64>),
    Rounded(Vec<f32>),
}

/// A number that is an entry.
trait Entry: Copy + Into<f64> + Send + Sync {
    /// Computes entries, in `spare` memory if these are rounded.
    fn compute<R>(
        kept: &mut [Self],
        spare: &mut Vec<f64>,
        work: impl FnOnce(&mut [f64]) -> R,
    ) -> Result<R, FactorError>;
}

impl Entry for f64 {
    fn compute<R>(
        kept: &mut [Self],
        _: &mut Vec<f64>,
        work: impl FnOnce(&mut [f64]) -> R,
    ) -> Result<R, FactorError> {
        Ok(work(kept))
    }
}

impl Entry for f32 {
    fn compute<R>(
        kept: &mut [Self],
        spare: &mut Vec<f64>,
        work: impl FnOnce(&mut [f64]) -> R,
    ) -> Result<R, FactorError> {
        make_longer(spare, kept.len())?;
        let entries = &mut spare[..kept.len()];
        let result = work(entries);
        kept.iter_mut().zip(entries).for_each(|(kept, entry)| *kept = *entry as Self);
        Ok(result)
    }
}

/// Halves with less work than this, in products, are not worth a second thread.
const WORTH_A_THREAD: f64 = 1e7;

/// A half with less than this part of a factor is not left to a second thread, which has its own copy of all coordinates.
const PARTS: usize = 32;

/// A factor is costly from this many products for each of its entries on, of a flat and of a thick body. One more then takes longer than
/// the uses of the last one that replace it: elimination is bound by the processor, use by memory. Thick bodies keep their volume, so that
/// guesses are more often unstable and a factor of their own is made in vain.
const COSTLY: [f64; 2] = [500.0, 200.0];

/// Memory for some fronts that are eliminated one after the other.
#[derive(Default)]
struct Room {
    /// Updates that wait for the front above theirs.
    stacks: [Stack; 2],
    packed: [Vec<f64>; 2],
    spare: Vec<f64>,
}

/// Updates on each other, and where they end.
#[derive(Default)]
struct Stack {
    memory: Vec<f64>,
    top: usize,
}

impl Stack {
    /// Makes place for an update, whatever is in it.
    fn push(&mut self, size: usize) -> Result<&mut [f64], FactorError> {
        let start = self.top;
        make_longer(&mut self.memory, start + size)?;
        self.top += size;
        Ok(&mut self.memory[start..self.top])
    }

    /// Hands up the update of a half and takes it from the stack, where it lies on top.
    fn pop<const D: usize>(
        &mut self,
        half: &Front<D>,
        front: &Front<D>,
        panel: &mut [f64],
        rest: &mut [f64],
    ) {
        let end = self.top;
        self.top -= half.update_size();
        half.hand_up(&self.memory[self.top..end], front, panel, rest);
    }
}

/// Memory for entries, of which the system makes pages when they are written for the first time.
fn zeros<T: Clone + Default>(size: usize) -> Result<Vec<T>, FactorError> {
    // `vec!` would end the program if there is not enough.
    let too_large = FactorError::TooLarge { bytes: size.saturating_mul(size_of::<T>()) };
    Vec::<T>::new().try_reserve_exact(size).map_err(|_| too_large)?;
    Ok(vec![T::default(); size])
}

/// Makes memory at least so long.
fn make_longer(memory: &mut Vec<f64>, size: usize) -> Result<(), FactorError> {
    if let Some(more) = size.checked_sub(memory.len()) {
        let too_large = FactorError::TooLarge { bytes: size.saturating_mul(size_of::<f64>()) };
        memory.try_reserve_exact(more).map_err(|_| too_large)?;
        memory.resize(size, 0.0);
    }
    Ok(())
}

/// Rooms that were used before.
#[derive(Default)]
struct Rooms(Mutex<Vec<Room>>);

impl Rooms {
    fn list(&self) -> MutexGuard<'_, Vec<Room>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// An empty room.
    fn take(&self) -> Room {
        let mut room = self.list().pop().unwrap_or_default();
        room.stacks.iter_mut().for_each(|stack| stack.top = 0);
        room
    }

    fn put_back(&self, room: Room) {
        self.list().push(room);
    }
}

/// The elimination of a matrix.
struct Elimination<'a, const D: usize> {
    stiffness: &'a StiffnessMatrix<D>,
    free: &'a [Vec<bool>; D],
    fronts: &'a Fronts<D>,
    rooms: &'a Rooms,
    interruption: &'a Interruption,
}

impl<const D: usize> Elimination<'_, D> {
    /// Eliminates a front and all below it, and pushes its update on the stack. `entries` are those of these fronts; the first of them is
    /// number `first` of the factor.
    fn subtree<T: Entry>(
        &self,
        front: &Front<D>,
        (first, entries): (usize, &mut [T]),
        room: &mut Room,
    ) -> Result<(), FactorError> {
        let [one, other] = front.halves.map(|half| half.map(|half| &self.fronts.list[half]));
        let end = |half: Option<&Front<D>>, start| half.map_or(start, |half| half.entries.end);
        let middle = end(one, first);
        let last = end(other, middle);
        let (below, own) = entries.split_at_mut(last - first);
        let (left, right) = below.split_at_mut(middle - first);
        let mut beside = match (one, other) {
            (Some(one), Some(other)) if one.work.min(other.work) > WORTH_A_THREAD => {
                let (a, (b, beside)) = rayon::join(
                    || self.subtree(one, (first, left), room),
                    || {
                        let mut beside = self.rooms.take();
                        (self.subtree(other, (middle, right), &mut beside), beside)
                    },
                );
                if let Err(error) = a.and(b) {
                    self.rooms.put_back(beside);
                    return Err(error);
                }
                Some(beside)
            }
            _ => {
                one.map_or(Ok(()), |one| self.subtree(one, (first, left), room))?;
                other.map_or(Ok(()), |other| self.subtree(other, (middle, right), room))?;
                None
            }
        };
        let Room { stacks: [even, odd], packed, spare } = room;
        let (stack, halves) = if front.stack == 0 { (even, odd) } else { (odd, even) };
        let rest = stack.push(front.update_size())?;
        let [rows, columns] = front.size();
        clear_lower(rest, rows - columns);
        T::compute(own, spare, |panel| {
            front.fill(panel, self.stiffness, &self.fronts.order, self.free);
            if let Some(other) = other {
                let stack = match &mut beside {
                    Some(beside) => &mut beside.stacks[1 - front.stack],
                    None => &mut *halves,
                };
                stack.pop(other, front, panel, rest);
            }
            if let Some(one) = one {
                halves.pop(one, front, panel, rest);
            }
            if let Some(beside) = beside {
                self.rooms.put_back(beside);
            }
            let interruption = self.interruption;
            let blocks = if D > 2 { Blocks::LARGE } else { Blocks::SMALL };
            Eliminate { panel, rows, columns, rest, blocks, packed, interruption }.run()
        })?
    }

    /// Eliminates all fronts.
    fn run<T: Entry>(&self, entries: &mut [T]) -> Result<(), FactorError> {
        let Some(root) = self.fronts.list.last() else { return Ok(()) };
        let mut room = self.rooms.take();
        let done = self.subtree(root, (0, entries), &mut room);
        self.rooms.put_back(room);
        done
    }
}

/// Sets the lower triangle of a square matrix to 0, column by column.
fn clear_lower(square: &mut [f64], size: usize) {
    for (number, column) in square.chunks_exact_mut(size.max(1)).enumerate() {
        column[number..].fill(0.0);
    }
}

impl<const D: usize> Factor<D> {
    /// A factor for a body with these free coordinates: `free[axis][node]`.
    pub(super) fn new(free: [Vec<bool>; D]) -> Self {
        Self {
            free,
            blocks: 0,
            fronts: None,
            entries: Entries::Whole(Vec::new()),
            made: false,
            costly: COSTLY[usize::from(D > 2)],
            rounds: true,
            rooms: Rooms::default(),
        }
    }

    /// A factor that keeps all digits, whatever it costs.
    pub(super) fn whole(free: [Vec<bool>; D]) -> Self {
        Self { rounds: false, ..Self::new(free) }
    }

    /// Takes factors to be costly or not, whatever they cost.
    #[cfg(test)]
    pub(super) fn is_to_be_costly(&mut self, costly: bool) {
        self.costly = if costly { 0.0 } else { f64::INFINITY };
        (self.fronts, self.made) = (None, false);
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
            // Nothing stands until all is known and has its memory.
            self.fronts = None;
            self.entries = Entries::Whole(Vec::new());
            let graph = Graph::new(stiffness);
            let dissection = dissect(&graph, positions, interruption);
            let fronts = Fronts::new(stiffness, &graph, dissection, interruption)?;
            let rounded = self.rounds && fronts.work() > self.costly * fronts.entries as f64;
            self.entries = if rounded {
                Entries::Rounded(zeros(fronts.entries)?)
            } else {
                Entries::Whole(zeros(fronts.entries)?)
            };
            self.blocks = stiffness.blocks();
            self.fronts = Some(fronts);
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
        let Self { free, fronts, entries, rooms, .. } = self;
        let Some(fronts) = fronts else { return Ok(()) };
        let elimination = Elimination { stiffness, free, fronts, rooms, interruption };
        match entries {
            Entries::Whole(entries) => {
                elimination.run(entries).map_err(|error| error.beside(size_of_val(&**entries)))
            }
            Entries::Rounded(entries) => {
                elimination.run(entries).map_err(|error| error.beside(size_of_val(&**entries)))
            }
        }?;
        self.made = true;
        Ok(())
    }

    /// Whether a new factor costs much more than some uses of the last one.
    pub(super) fn is_costly(&self) -> bool {
        let costly = |fronts: &Fronts<D>| fronts.work() > self.costly * fronts.entries as f64;
        self.fronts.as_ref().is_some_and(costly)
    }

    /// Whether solutions have some digits only, because the entries are rounded.
    pub(super) fn is_rounded(&self) -> bool {
        matches!(self.entries, Entries::Rounded(_))
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

    /// Displacements (um) under forces (nN) on the free coordinates; held ones do not move. With rounded
    /// entries they are right to some 6e-8 times the root of the stiffness's condition.
    ///
    /// Uses the last factorised stiffness.
    pub(super) fn solve(&self, forces: &Vectors<D>) -> Vectors<D> {
        match &self.entries {
            Entries::Whole(entries) => self.solve_by(entries, forces),
            Entries::Rounded(entries) => self.solve_by(entries, forces),
        }
    }

    fn solve_by<T: Entry>(&self, entries: &[T], forces: &Vectors<D>) -> Vectors<D> {
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

impl<T: Entry, const D: usize> Substitution<'_, T, D> {
    /// Both halves of a front, if they are worth two threads.
    fn halves(&self, front: &Front<D>) -> Option<[usize; 2]> {
        let [Some(one), Some(other)] = front.halves else { return None };
        let least = self.entries_of(one).min(self.entries_of(other));
        (self.apart && least > self.entries.len() / PARTS).then_some([one, other])
    }

    /// The entries of a front and of all below it.
    fn entries_of(&self, front: usize) -> usize {
        let first = &self.fronts[self.fronts[front].first];
        self.fronts[front].entries.end - first.entries.start
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
