//! What the stretch of a tissue does to its cells: channels that it opens, and crossbridges that it distorts.

use super::crossbridges::Crossbridges;
use crate::cell::{CellModel, Input};

/// Difference of stretch for the slope of a tension: far above rounding, and small enough for the tension to be linear over it.
const APART: f64 = 1e-6;

/// Channels that stretch opens.
#[derive(Clone)]
pub(super) struct Channels {
    /// Conductance at twice the length at rest, 1/ms.
    pub(super) conductance: f64,
    /// Reversal potential, in the unit of the state that spreads.
    pub(super) reversal: f64,
    /// By how much the fibres of each node are longer than at rest, as a part; 0 where they are shorter.
    pub(super) longer: Vec<f64>,
}

impl Channels {
    /// Takes the stretch of each node.
    pub(super) fn feel(&mut self, stretch: &[f64]) {
        for (longer, stretch) in self.longer.iter_mut().zip(stretch) {
            *longer = (stretch - 1.0).max(0.0);
        }
    }

    /// Lets the current flow for some time.
    pub(super) fn flow(&self, potential: &mut [f64], over_ms: f64) {
        for (potential, longer) in potential.iter_mut().zip(&self.longer) {
            let kept = (-self.conductance * longer * over_ms).exp();
            *potential = self.reversal + (*potential - self.reversal) * kept;
        }
    }
}

/// The stretch of each node: the mean of its triangles.
pub(super) fn at_nodes(corners: &[[u32; 3]], nodes: usize, stretch: &[f64]) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); nodes];
    for (nodes, stretch) in corners.iter().zip(stretch) {
        for &node in nodes {
            let (sum, count) = &mut sums[node as usize];
            *sum += stretch;
            *count += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 1.0 }).collect()
}

/// Crossbridges of cells that feel stretch.
#[derive(Clone)]
pub(super) struct Pull {
    /// Of each node.
    pub(super) crossbridges: Vec<Crossbridges>,
    /// Stretch of each cell's model in the tissue at rest.
    pub(super) resting_stretch: Vec<f64>,
    /// Stretch of each cell, as tried last.
    pub(super) stretch: Vec<f64>,
    /// The time over which it was reached, ms.
    pub(super) over_ms: f64,
    /// Stretch and rate of the rest of each cell in this interval.
    pub(super) foretold: Vec<[f64; 2]>,
    /// When the rest of each cell was moved to last, ms, since it was kept.
    pub(super) reached: Option<f64>,
    /// By how much the tension of each triangle grows with its stretch, kPa.
    pub(super) per_stretch: Vec<f64>,
    pub(super) per_rate: Vec<f64>,
}

impl Pull {
    /// Of cells in one state; `None` if their stretch acts by other ways than crossbridges.
    pub(super) fn new(
        model: &dyn CellModel,
        state: &[f64],
        nodes: usize,
        triangles: usize,
    ) -> Option<Self> {
        Some(Self {
            crossbridges: vec![Crossbridges::of(model, state)?; nodes],
            resting_stretch: vec![1.0; nodes],
            stretch: vec![1.0; nodes],
            over_ms: 0.0,
            foretold: vec![[1.0, 0.0]; nodes],
            reached: None,
            per_stretch: vec![0.0; triangles],
            per_rate: vec![0.0; triangles],
        })
    }

    /// Takes the stretch of each node relative to its length at rest, reached within an interval.
    pub(super) fn feel(&mut self, over_ms: f64, nodes: Vec<f64>) {
        self.stretch = nodes;
        self.stretch.iter_mut().zip(&self.resting_stretch).for_each(|(it, at_rest)| *it *= at_rest);
        self.over_ms = over_ms;
        for (crossbridges, stretch) in self.crossbridges.iter_mut().zip(&self.stretch) {
            crossbridges.follow(over_ms, *stretch);
        }
    }

    /// Foretells the stretch of each cell in the next interval.
    pub(super) fn foretell(&mut self, over_ms: f64, nodes: &[f64]) {
        for (cell, crossbridges) in self.crossbridges.iter_mut().enumerate() {
            let stretch = self.resting_stretch[cell] * nodes[cell];
            self.foretold[cell] = crossbridges.foretell(over_ms, stretch);
        }
    }

    pub(super) fn keep(&mut self) {
        for (crossbridges, stretch) in self.crossbridges.iter_mut().zip(&self.stretch) {
            crossbridges.keep(*stretch);
        }
        self.reached = None;
    }

    /// The tension of a cell, in the unit of its model, and by how much it grows with the stretch of its node.
    pub(super) fn tension(
        &self,
        model: &dyn CellModel,
        cell: usize,
        state: &mut [f64],
    ) -> [f64; 2] {
        let (crossbridges, stretch) = (&self.crossbridges[cell], self.stretch[cell]);
        let at = |crossbridges: &Crossbridges, stretch: f64, state: &mut [f64]| {
            crossbridges.put(state);
            model.tension(state, &Input { stretch, ..Input::REST })
        };
        let tension = at(crossbridges, stretch, state);
        let apart = self.resting_stretch[cell] * APART;
        let mut longer = crossbridges.clone();
        longer.follow(self.over_ms, stretch + apart);
        [tension, (at(&longer, stretch + apart, state) - tension) / APART]
    }
}
