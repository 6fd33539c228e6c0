//! Crossbridges that a stretch distorts at once, in a cell whose membrane is slow to solve.
//!
//! Membrane, calcium and crossbridges take a whole interval under a stretch that is foretold from those before. What a
//! stretch does at once, through overlap and distortions, is not left to that: distortions obey
//!
//! ```text
//! dzeta/dt = A dlambda/dt - c zeta
//! ```
//!
//! which a straight line between two stretches solves exactly. So the equations of the membrane, which are most of the
//! work, are solved once an interval, however many stretches are tried. What the foretold stretch is off by, of the third
//! order in the interval, acts through the rates of crossbridges and calcium alone.

use crate::cell::Filaments;
use crate::cell::integrator::CellIntegrator;
use crate::cell::land_2017::{Myofilaments, STATES};
use crate::cell::solve::SolveError;
use std::sync::Arc;

/// The places of both distortions among the states of the myofilaments.
const ZETA: [usize; 2] = [4, 5];

/// The distortions of the crossbridges of a cell.
#[derive(Debug, Clone)]
pub(super) struct Crossbridges {
    /// Places of the distortions among the states of the cell.
    places: [usize; 2],
    /// `A`, and both `c`, 1/ms.
    per_stretch: f64,
    decay: [f64; 2],
    /// At the last time that was kept, and where the cell was moved to.
    kept: [f64; 2],
    moved: [f64; 2],
    /// The last stretches that were kept, the latest first; none at first.
    past: Option<[f64; 3]>,
    /// What was foretold of the latest of them, and what is of the next.
    foretold: [f64; 2],
    /// When the cell was moved to last, ms, since it was kept.
    reached: Option<f64>,
}

impl Crossbridges {
    /// Of a cell whose membrane makes the calcium of its myofilaments; `None` of any other.
    pub(super) fn of(cell: &CellIntegrator) -> Option<Self> {
        let Filaments { equations, first, calcium } = cell.model().filaments()?;
        let places = ZETA.map(|place| first + place);
        let kept = places.map(|place| cell.state()[place]);
        calcium.is_none().then(|| Self {
            places,
            per_stretch: equations.distortion_per_stretch(),
            decay: decay(equations),
            kept,
            moved: kept,
            past: None,
            foretold: [1.0; 2],
            reached: None,
        })
    }

    /// The state of a cell that was moved, with its distortions.
    pub(super) fn state(&self, cell: &CellIntegrator) -> Vec<f64> {
        let mut state = cell.state().to_vec();
        for (place, zeta) in self.places.into_iter().zip(self.moved) {
            state[place] = zeta;
        }
        state
    }

    /// Moves a cell from where it was kept to a time, unless that is done, and its distortions with a stretch that goes
    /// evenly to this one.
    ///
    /// # Errors
    /// Those of the cell.
    pub(super) fn advance(
        &mut self,
        kept: &CellIntegrator,
        moved: &mut Arc<CellIntegrator>,
        to_ms: f64,
        stretch: f64,
    ) -> Result<(), SolveError> {
        let over = to_ms - kept.time();
        let from = self.past.map_or(stretch, |[last, ..]| last);
        if self.reached != Some(to_ms) {
            let mut cell = kept.clone();
            let [before, next] = &mut self.foretold;
            (*before, *next) = match self.past {
                Some([last, one, two]) => (*before, 3.0 * (last - one) + two),
                None => (stretch, stretch),
            };
            let rate = if over > 0.0 { (*next - *before) / over } else { 0.0 };
            cell.advance_to(to_ms, f64::midpoint(*before, *next), rate)?;
            *moved = Arc::new(cell);
            self.reached = Some(to_ms);
        }
        self.moved = self.kept;
        for (zeta, decay) in self.moved.iter_mut().zip(self.decay).filter(|_| over > 0.0) {
            let gone = -(-decay * over).exp_m1();
            *zeta += gone * (self.per_stretch * (stretch - from) / (decay * over) - *zeta);
        }
        Ok(())
    }

    /// Keeps where the cell was moved to, at this stretch.
    pub(super) fn keep(&mut self, stretch: f64) {
        self.kept = self.moved;
        // Before the run begins nothing was foretold.
        self.foretold[0] = if self.past.is_some() { self.foretold[1] } else { stretch };
        self.past = Some(self.past.map_or([stretch; 3], |[last, one, _]| [stretch, last, one]));
        self.reached = None;
    }
}

/// Rates at which distortions go, 1/ms.
fn decay(equations: &Myofilaments) -> [f64; 2] {
    ZETA.map(|place| {
        let mut state = [0.0; STATES];
        state[place] = 1.0;
        -equations.rates(&state, 0.0, 1.0, 0.0)[place]
    })
}
