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

use crate::cell::land_2017::{Myofilaments, STATES};
use crate::cell::{CellModel, Filaments};

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
    /// At the last time that was kept, and at the last stretch that was tried.
    kept: [f64; 2],
    moved: [f64; 2],
    /// The last stretches that were kept, the latest first; none at first.
    past: Option<[f64; 3]>,
    /// What was foretold of the latest of them, and what is of the next.
    foretold: [f64; 2],
}

impl Crossbridges {
    /// Of a cell in this state whose membrane makes the calcium of its myofilaments; `None` of any other.
    pub(super) fn of(model: &dyn CellModel, state: &[f64]) -> Option<Self> {
        let Filaments { equations, first, calcium } = model.filaments()?;
        let places = ZETA.map(|place| first + place);
        let kept = places.map(|place| state[place]);
        calcium.is_none().then(|| Self {
            places,
            per_stretch: equations.distortion_per_stretch(),
            decay: decay(equations),
            kept,
            moved: kept,
            past: None,
            foretold: [1.0; 2],
        })
    }

    /// Sets the distortions in the state of the cell.
    pub(super) fn put(&self, state: &mut [f64]) {
        for (place, zeta) in self.places.into_iter().zip(self.moved) {
            state[place] = zeta;
        }
    }

    /// The stretch in the middle of the next interval (ms) and its rate (1/ms), foretold from the stretches before; `stretch` if there are
    /// none. Once an interval.
    pub(super) fn foretell(&mut self, over_ms: f64, stretch: f64) -> [f64; 2] {
        let [before, next] = &mut self.foretold;
        (*before, *next) = match self.past {
            Some([last, one, two]) => (*before, 3.0 * (last - one) + two),
            None => (stretch, stretch),
        };
        let rate = if over_ms > 0.0 { (*next - *before) / over_ms } else { 0.0 };
        [f64::midpoint(*before, *next), rate]
    }

    /// Moves the distortions with a stretch that goes evenly to this one within an interval, ms.
    pub(super) fn follow(&mut self, over_ms: f64, stretch: f64) {
        let from = self.past.map_or(stretch, |[last, ..]| last);
        self.moved = self.kept;
        for (zeta, decay) in self.moved.iter_mut().zip(self.decay).filter(|_| over_ms > 0.0) {
            let gone = -(-decay * over_ms).exp_m1();
            *zeta += gone * (self.per_stretch * (stretch - from) / (decay * over_ms) - *zeta);
        }
    }

    /// Keeps the distortions at this stretch.
    pub(super) fn keep(&mut self, stretch: f64) {
        self.kept = self.moved;
        // Before the run begins nothing was foretold.
        self.foretold[0] = if self.past.is_some() { self.foretold[1] } else { stretch };
        self.past = Some(self.past.map_or([stretch; 3], |[last, one, _]| [stretch, last, one]));
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
