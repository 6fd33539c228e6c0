//! The shortening of a cell model on the equilibria of a mesh in trains of beats, as fits need it.
//!
//! Cell and equilibria are coupled as in a run ([`Coupler`]), with an interval that suffices for a
//! curve. A cell with prescribed calcium uses a method of higher order and repeats a steady beat
//! (`given_calcium`).

use super::coupler::{Coupler, Shaping};
use super::equilibria::TensionResponse;
use super::given_calcium::{self, GivenCalcium};
use super::observer::Samples;
use super::train::Train;
use super::{Simulation, StopReason};
use crate::cell::pacing::Protocol;
use crate::cell::solve::{CellMethod, SolveError};
use crate::cell::tension::lag::Lag;
use crate::cell::{CellModel, TensionKind};
use crate::exchange::{ActivationBounds, WholeCell};
use crate::mechanics::Tension;
use std::sync::Arc;

/// Fixed steps of a cell without a potential, ms: this step changes a curve by less than 1e-6 of
/// its height.
const STEP_MS: f64 = 0.4;

/// A cell model on the equilibria of a mesh.
pub struct Beating<'a> {
    /// Protocol, peak tension of a relative tension, start state, material, and integration of the
    /// cell model.
    pub simulation: &'a Simulation,
    /// The model, instead of that of the simulation.
    pub cell: &'a Arc<dyn CellModel>,
    /// Factor on the peak of a relative tension.
    pub strength: f64,
    /// The mesh.
    pub response: &'a dyn TensionResponse,
}

impl Beating<'_> {
    /// Whether steady beats of a model are repeated, so that trains cost little. Other cells start from
    /// their initial state; earlier beats are left out.
    pub fn repeats(simulation: &Simulation, cell: &dyn CellModel) -> bool {
        given_calcium::serves(simulation, cell)
    }

    /// Shortening, a part of the length before a beat, at every interval of a train from the first
    /// requested stimulus on.
    ///
    /// # Errors
    /// Why there is no such curve.
    pub fn shortening(&self, train: &Train) -> Result<Vec<f64>, StopReason> {
        let lag = Lag::by(self.simulation.material.retardation_time);
        if Self::repeats(self.simulation, &**self.cell)
            && let Some(given) = GivenCalcium::of(&**self.cell, self.response, lag)
        {
            return given.shortening(train);
        }
        let interval = train.interval_ms();
        // The first stimulus falls on an exchange.
        let waits = (self.simulation.protocol.start_ms / interval).floor();
        let protocol = Protocol {
            start_ms: waits * interval,
            cycle_length_ms: train.cycle_ms,
            beats: u32::try_from(train.beats).unwrap_or(u32::MAX),
            ..self.simulation.protocol
        };
        let bounds = ActivationBounds { tension: self.response.highest(), ..Default::default() };
        let failed = |error: SolveError| StopReason::CellModel { cause: error.to_string() };
        let cell = self.whole_cell(protocol, bounds).map_err(failed)?;
        let mut coupler = Coupler::new(Box::new(cell), bounds, interval, &[]);
        let response = self.response;
        let mut shape = OnResponse { response, lag, interval, tension: 0.0, marked: 0.0 };
        coupler.begin(&mut shape)?;
        let mut samples = vec![shape.shortening()];
        for number in 1..=waits as usize + train.beats * train.intervals() {
            let time = number as f64 * interval;
            let asked = self.simulation.interruption.check();
            asked.map_err(|_| StopReason::Interrupted { time })?;
            coupler.pass(time, &mut shape, &mut Samples(|_| true))?;
            if number <= waits as usize {
                samples.clear();
            }
            samples.push(shape.shortening());
        }
        Ok(samples)
    }

    fn whole_cell(
        &self,
        protocol: Protocol,
        bounds: ActivationBounds,
    ) -> Result<WholeCell, SolveError> {
        let Self { simulation, cell, strength, .. } = *self;
        let mut settings = simulation.cell_settings();
        // A step of 0.005 ms is for the upstroke of the action potential; myofilaments are slower.
        if settings.method == CellMethod::RungeKutta4
            && cell.potential(&cell.initial_state()).is_none()
        {
            settings.step_ms = settings.step_ms.max(STEP_MS);
        }
        let scale = match cell.tension_kind() {
            TensionKind::Relative { published_peak } => {
                strength * simulation.peak_tension / published_peak
            }
            _ => 1.0,
        };
        let start = simulation.start_state.as_deref();
        let (cell, stretch) = (Arc::clone(cell), simulation.mean_resting_stretch());
        let cell = WholeCell::new(cell, start, protocol, settings, scale, bounds)?;
        Ok(cell.at_resting_stretch(stretch))
    }
}

/// A mesh in equilibrium, of which only the stretch is known.
struct OnResponse<'a> {
    response: &'a dyn TensionResponse,
    lag: Lag,
    /// Exchange interval, ms.
    interval: f64,
    /// The tension at which it is in equilibrium, kPa.
    tension: f64,
    marked: f64,
}

impl OnResponse<'_> {
    fn shortening(&self) -> f64 {
        self.response.shortening(self.tension)[0]
    }
}

impl Shaping for OnResponse<'_> {
    fn is_static(&self) -> bool {
        true
    }

    fn follow(&mut self, time: f64, tensions: [Tension<'_>; 2]) -> Result<(), StopReason> {
        let [from, to] = tensions.map(|tension| tension.at(0));
        self.tension = self.lag.over_line(self.interval.min(time), self.tension, [from, to]);
        if self.shortening().is_finite() {
            return Ok(());
        }
        let cause = "its shortening is not a number".to_owned();
        Err(StopReason::NoEquilibrium { time, tension: self.tension, cause })
    }

    fn mark(&mut self) {
        self.marked = self.tension;
    }

    fn back(&mut self) {
        self.tension = self.marked;
    }

    fn stretch_now(&self) -> Vec<f64> {
        vec![self.response.stretch(self.shortening())]
    }
}
