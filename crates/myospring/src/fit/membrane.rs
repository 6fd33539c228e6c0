//! The contraction of a cell whose myofilaments feel their length while its membrane makes their calcium:
//! `tor_ord_land` along a mesh's equilibria.
//!
//! Membrane, calcium and crossbridges take whole intervals under a stretch that is foretold from those before. What a
//! stretch does at once, through overlap and distortions, is not left to that: distortions obey
//!
//! ```text
//! dzeta/dt = A dlambda/dt - c zeta
//! ```
//!
//! which a straight line between two stretches solves exactly, so the stretch at the end of an interval is that under
//! which the mesh rests with the distortions that it makes. So the equations of the membrane, which are most of the work, are solved once an
//! interval. What the foretold stretch is off by, of the third order in the interval, acts through the rates of
//! crossbridges and calcium alone.

use super::myofilaments::{is_plain, meet};
use super::physics::Train;
use super::table::Tables;
use crate::cell::integrator::CellIntegrator;
use crate::cell::land_2017::{Myofilaments, STATES};
use crate::cell::pacing::Protocol;
use crate::cell::solve::Settings;
use crate::cell::tension::lag::Lag;
use crate::cell::{CellModel, Filaments};
use crate::interruption::Interruption;
use crate::simulation::Simulation;
use std::sync::Arc;

/// Most between samples, ms: an eighth of it moves a curve by less than 1e-4 of its height.
const INTERVAL_MS: f64 = 2.0;

/// Beats of such a cell on a mesh.
pub(super) struct Membrane {
    tables: Arc<Tables>,
    protocol: Protocol,
    settings: Settings,
    lag: Lag,
    intervals: usize,
    interval: f64,
    interruption: Interruption,
}

impl Membrane {
    /// Whether a simulation's cell is such, and its mesh neither held nor begun in a way of its own.
    pub(super) fn serve(simulation: &Simulation) -> bool {
        let filaments = simulation.cell.filaments();
        filaments.is_some_and(|filaments| filaments.calcium.is_none()) && is_plain(simulation)
    }

    pub(super) fn new(tables: Arc<Tables>, train: &Train, simulation: &Simulation) -> Self {
        let a_cycle = (train.cycle / INTERVAL_MS).ceil().max(3.0);
        let protocol = Protocol {
            cycle_length_ms: train.cycle,
            beats: u32::try_from(train.beats).unwrap_or(u32::MAX),
            ..simulation.protocol
        };
        Self {
            tables,
            protocol,
            settings: simulation.numerics.cell,
            lag: Lag::by(simulation.material.retardation_time),
            intervals: train.beats * a_cycle as usize,
            interval: train.cycle / a_cycle,
            interruption: simulation.interruption.clone(),
        }
    }

    /// Between samples, ms: a cycle is a whole number of them.
    pub(super) fn interval(&self) -> f64 {
        self.interval
    }

    /// Shortening at every interval; `None` where there is no beat.
    pub(super) fn shortening(
        &self,
        cell: Arc<dyn CellModel>,
        stiffness: f64,
    ) -> Option<Arc<[f64]>> {
        let Filaments { equations, first: places, .. } = cell.filaments()?;
        let filaments = *equations;
        let a = filaments.distortion_per_stretch();
        let decay = decays(&filaments).map(|rate| (-rate * self.interval).exp());
        // What is left at the end of an interval of a distortion that came evenly over it.
        let reached = decays(&filaments)
            .map(|rate| -(-rate * self.interval).exp_m1() / (rate * self.interval));
        let mut cell = CellIntegrator::new(cell, self.protocol, self.settings).ok()?;
        let of = |cell: &CellIntegrator| -> [f64; STATES] {
            std::array::from_fn(|k| cell.state()[places + k])
        };
        // What has acted for ever before has made its shape, and its distortions are its own.
        let mut state = of(&cell);
        let at_once = [1.0, 0.0];
        let first = meet(&filaments, &self.tables, stiffness, 1.0, at_once, |_| (state, 0.0))?;
        let mut tension = filaments.tension(&state, first);
        let mut theta = tension;
        let mut foretold = first;
        let mut past = [first; 3];
        let mut samples = Vec::with_capacity(self.intervals + 1);
        samples.push(1.0 - first);
        // It waits for its first stimulus.
        let waits = (self.protocol.start_ms / self.interval).floor();
        let begin = self.protocol.start_ms - waits * self.interval;
        cell.advance_to(begin, first, 0.0).ok()?;
        for interval in 1..=waits as usize + self.intervals {
            self.interruption.check().ok()?;
            let stretch = past[0];
            let next = 3.0 * (past[0] - past[1]) + past[2];
            let (middle, rate) = (f64::midpoint(foretold, next), (next - foretold) / self.interval);
            cell.advance_to(begin + interval as f64 * self.interval, middle, rate).ok()?;
            foretold = next;
            let told = of(&cell);
            let zeta = [state[4], state[5]];
            let whole = |at: f64| {
                let by = a * (at - stretch);
                let [strong, weak] = [0, 1].map(|k| zeta[k] * decay[k] + by * reached[k]);
                let whole = [told[0], told[1], told[2], told[3], strong, weak];
                let [xs, xw, ..] = whole;
                // The stiffness counts distortions in full; of these some are gone.
                let gone = (xs * (1.0 - reached[0]) + xw * (1.0 - reached[1])) / (xs + xw);
                (whole, gone)
            };
            let [share, kept] = self.lag.over_line(self.interval, theta, tension);
            let now = meet(&filaments, &self.tables, stiffness, next, [share, kept], whole)?;
            state = whole(now).0;
            tension = filaments.tension(&state, now);
            theta = share * tension + kept;
            past = [now, past[0], past[1]];
            if interval <= waits as usize {
                samples.clear();
            }
            samples.push(1.0 - now);
        }
        Some(samples.into())
    }
}

/// Rates at which distortions go, 1/ms.
fn decays(filaments: &Myofilaments) -> [f64; 2] {
    [4, 5].map(|place| {
        let mut state = [0.0; STATES];
        state[place] = 1.0;
        -filaments.rates(&state, 0.0, 1.0, 0.0)[place]
    })
}
