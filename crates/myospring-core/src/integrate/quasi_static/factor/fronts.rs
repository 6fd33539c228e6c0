//! Fronts: the dense matrices in which the parts of a dissection are eliminated.
//!
//! The front of a part contains its own nodes and its border: the later nodes that interact with it
//! or with nodes eliminated below it. Its first columns come from the stiffness and from the
//! updates of its halves. After elimination they are columns of the factor, and the remainder is
//! the front's own update (multifrontal method, `liu_1992`). Everything that depends only on the
//! pattern is computed here.

use super::dissection::{Dissection, Graph};
use super::error::FactorError;
use crate::interruption::Interruption;
use crate::mechanics::stiffness::StiffnessMatrix;
use std::ops::Range;

/// Consecutive nodes of a front's border that are consecutive in the front above it, too.
struct Run {
    border: usize,
    above: usize,
    len: usize,
}

/// A block of the stiffness and its place in a front.
struct Placement {
    row: usize,
    /// Number in that row.
    number: usize,
    /// Nodes of the front.
    column: usize,
    below: usize,
    /// Whether the block's second node is the column's.
    mirrored: bool,
}

/// One part of the dissection.
pub(super) struct Front<const D: usize> {
    /// Places in the order of elimination.
    pub(super) own: Range<usize>,
    /// Later places, in order.
    pub(super) border: Vec<usize>,
    pub(super) halves: [Option<usize>; 2],
    /// Position of its columns in the factor.
    pub(super) entries: Range<usize>,
    /// On which of two stacks its update lies; the updates of its halves lie on the other.
    pub(super) stack: usize,
    /// The first of the fronts below it, which come one after the other, or itself.
    pub(super) first: usize,
    /// Products that its elimination and that of all below it take.
    pub(super) work: f64,
    placements: Vec<Placement>,
    /// Positions of the border in the front above.
    runs: Vec<Run>,
}

impl<const D: usize> Front<D> {
    /// Coordinates: all, and those that are eliminated here.
    pub(super) fn size(&self) -> [usize; 2] {
        [D * (self.own.len() + self.border.len()), D * self.own.len()]
    }

    /// Entries of its update.
    pub(super) fn update_size(&self) -> usize {
        (D * self.border.len()).pow(2)
    }

    /// Fills its columns with the stiffness between free coordinates, `free[axis][node]`.
    pub(super) fn fill(
        &self,
        panel: &mut [f64],
        stiffness: &StiffnessMatrix<D>,
        order: &[usize],
        free: &[Vec<bool>; D],
    ) {
        let [rows, _] = self.size();
        panel.fill(0.0);
        for &Placement { row, number, column, below, mirrored } in &self.placements {
            let (partners, blocks) = stiffness.row(row);
            let (other, block) = (partners[number], &blocks[number]);
            for i in 0..D {
                for j in 0..D {
                    if free[i][row] && free[j][other] {
                        let (i_column, i_below) = if mirrored { (j, i) } else { (i, j) };
                        panel[(D * column + i_column) * rows + D * below + i_below] = block[i][j];
                    }
                }
            }
        }
        for (at, &node) in order[self.own.clone()].iter().enumerate() {
            for axis in 0..D {
                if !free[axis][node] {
                    panel[(D * at + axis) * (rows + 1)] = 1.0;
                }
            }
        }
    }

    /// Adds its update to the columns and to the update of the front above.
    pub(super) fn hand_up(
        &self,
        update: &[f64],
        above: &Self,
        panel: &mut [f64],
        rest: &mut [f64],
    ) {
        let [rows, columns] = above.size();
        let stride = D * self.border.len();
        for (at, run) in self.runs.iter().enumerate() {
            for (column, to) in (D * run.border..).zip(D * run.above..D * (run.above + run.len)) {
                let from = &update[column * stride..(column + 1) * stride];
                let (to, hidden) = if to < columns {
                    (&mut panel[to * rows..(to + 1) * rows], 0)
                } else {
                    let size = rows - columns;
                    (&mut rest[(to - columns) * size..][..size], columns)
                };
                for run in &self.runs[at..] {
                    // From the diagonal on.
                    let first = column.max(D * run.border);
                    let to = &mut to[D * run.above + first - D * run.border - hidden..];
                    let from = &from[first..D * (run.border + run.len)];
                    for (sum, value) in to.iter_mut().zip(from) {
                        *sum += value;
                    }
                }
            }
        }
    }
}

/// All fronts of a pattern.
pub(super) struct Fronts<const D: usize> {
    /// The node at each place of the order of elimination.
    pub(super) order: Vec<usize>,
    /// The fronts; halves come before the front that joins them.
    pub(super) list: Vec<Front<D>>,
    /// Entries of the factor.
    pub(super) entries: usize,
}

impl<const D: usize> Fronts<D> {
    /// Products that the elimination of all takes.
    pub(super) fn work(&self) -> f64 {
        self.list.last().map_or(0.0, |root| root.work)
    }

    pub(super) fn new(
        stiffness: &StiffnessMatrix<D>,
        graph: &Graph,
        Dissection { order, parts }: Dissection,
        interruption: &Interruption,
    ) -> Result<Self, FactorError> {
        let mut places = vec![0; order.len()];
        for (place, &node) in order.iter().enumerate() {
            places[node] = place;
        }
        let mut fronts: Vec<Front<D>> = Vec::with_capacity(parts.len());
        let mut seen = vec![usize::MAX; order.len()];
        let mut entries = 0_usize;
        for (number, part) in parts.into_iter().enumerate() {
            interruption.check()?;
            let later = order[part.own.clone()].iter().flat_map(|&node| graph.partners(node));
            let later = later.map(|&partner| places[partner]);
            let left = part.halves.iter().flatten().flat_map(|&half| &fronts[half].border);
            let mut border = Vec::new();
            for place in later.chain(left.copied()) {
                if place >= part.own.end && seen[place] != number {
                    seen[place] = number;
                    border.push(place);
                }
            }
            border.sort_unstable();
            let mut front = Front {
                own: part.own,
                border,
                halves: part.halves,
                runs: Vec::new(),
                entries: 0..0,
                placements: Vec::new(),
                stack: part.depth % 2,
                first: part
                    .halves
                    .into_iter()
                    .flatten()
                    .map(|half| fronts[half].first)
                    .min()
                    .unwrap_or(number),
                work: 0.0,
            };
            let [rows, columns] = front.size();
            let below = front.halves.iter().flatten().map(|&half| fronts[half].work);
            front.work = (rows as f64).powi(2) * columns as f64 + below.sum::<f64>();
            let end = rows.checked_mul(columns).and_then(|size| entries.checked_add(size));
            front.entries = entries..end.ok_or(FactorError::TooLarge { bytes: usize::MAX })?;
            entries = front.entries.end;
            for &half in front.halves.iter().flatten() {
                fronts[half].runs = runs(&fronts[half].border, &front);
            }
            fronts.push(front);
        }
        place_blocks(stiffness, &places, &mut fronts);
        Ok(Self { order, list: fronts, entries })
    }
}

/// Index of a place among the nodes of a front.
fn number_in<const D: usize>(front: &Front<D>, place: usize) -> usize {
    if place < front.own.end {
        place - front.own.start
    } else {
        front.own.len() + front.border.partition_point(|&other| other < place)
    }
}

/// Positions of a border in the front above it.
fn runs<const D: usize>(border: &[usize], above: &Front<D>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    for (number, &place) in border.iter().enumerate() {
        let there = number_in(above, place);
        match runs.last_mut() {
            Some(run) if run.above + run.len == there => run.len += 1,
            _ => runs.push(Run { border: number, above: there, len: 1 }),
        }
    }
    runs
}

/// Assigns each block of the stiffness to the front in which the first of its nodes is eliminated.
fn place_blocks<const D: usize>(
    stiffness: &StiffnessMatrix<D>,
    places: &[usize],
    fronts: &mut [Front<D>],
) {
    let mut front_of = vec![0; places.len()];
    for (number, front) in fronts.iter().enumerate() {
        front_of[front.own.clone()].fill(number);
    }
    for row in 0..stiffness.len() {
        for (number, &other) in stiffness.row(row).0.iter().enumerate() {
            let mirrored = places[other] < places[row];
            let [first, second] = if mirrored { [other, row] } else { [row, other] };
            let front = &mut fronts[front_of[places[first]]];
            let [column, below] = [first, second].map(|node| number_in(front, places[node]));
            front.placements.push(Placement { row, number, column, below, mirrored });
        }
    }
}
