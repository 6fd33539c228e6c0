//! The contraction of a cell whose tension feels its length.
//!
//! What makes a curve anew are the numbers of the cell alone; delays and levels only move it, so curves are remembered.
//! Myofilaments with given calcium have a way of their own ([`Myofilaments`]), everything else runs along the path of
//! equilibria, which all of its runs share.

use super::error::FitError;
use super::myofilaments::Myofilaments;
use super::physics::{Physics, Train, scale_of};
use super::table::Tables;
use crate::cell::pacing::Protocol;
use crate::cell::solve::Method;
use crate::cell::{CellModel, TensionKind};
use crate::integrate::quasi_static::Tolerance;
use crate::simulation::{Ready, SharedPath, Simulation};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Cell and mesh meet so often, ms: a longer interval moves a curve by 1e-4 of its height.
const EXCHANGE_MS: f64 = 2.0;
/// Steps of myofilaments alone, ms: a longer one moves a curve by less than 1e-6 of its height.
const STEP_MS: f64 = 0.4;
/// Curves that are remembered.
const KEPT: usize = 256;

/// Shortening at every interval, by the bits of the physics; `None` where there was no beat.
type Made = HashMap<Vec<u64>, Option<Arc<[f64]>>>;

/// Curves that differ in the cell model.
pub(super) struct Felt {
    way: Way,
    simulation: Simulation,
    names: Vec<String>,
    cycle: f64,
    /// Between samples, ms.
    interval: f64,
    made: Mutex<Made>,
}

/// How a curve is made.
enum Way {
    Myofilaments(Myofilaments),
    Runs(Box<SharedPath>),
}

impl Felt {
    pub(super) fn new(
        simulation: &Simulation,
        names: Vec<String>,
        train: &Train,
        loaded: bool,
        tables: impl Fn() -> Result<Arc<Tables>, FitError>,
    ) -> Result<Self, FitError> {
        let cycle = train.cycle;
        let made = Mutex::default();
        if Myofilaments::serve(simulation) {
            let own = Myofilaments::new(tables()?, *train);
            let interval = own.interval();
            let (way, simulation) = (Way::Myofilaments(own), simulation.clone());
            return Ok(Self { way, simulation, names, cycle, interval, made });
        }
        if loaded {
            return Err(FitError::Unknown {
                name: "young_modulus".to_owned(),
                why: "the tension of this cell feels its length, so every stiffness would be a mesh of its own".to_owned(),
                known: "it with coelho_2021, the sets of bueno_orovio_2008 and land_2017".to_owned(),
            });
        }
        let protocol = Protocol {
            start_ms: 0.0,
            cycle_length_ms: cycle,
            beats: train.beats as u32,
            ..simulation.protocol
        };
        let interval = simulation.numerics.exchange_interval.max(EXCHANGE_MS);
        // Measured cycles are no multiples of anything.
        let exchanges = (train.beats as f64 * cycle / interval).ceil().max(1.0);
        let duration = exchanges * interval;
        let mut simulation = Simulation { protocol, duration, ..simulation.clone() };
        simulation.numerics.exchange_interval = interval;
        simulation.numerics.output_interval = interval;
        // Nobody looks at the shapes in between.
        simulation.numerics.frame_interval = duration;
        let cell = &mut simulation.numerics.cell;
        // Made for the action potential's upstroke; nothing in myofilaments is as fast.
        if cell.method == Method::RungeKutta4
            && simulation.cell.potential(&simulation.cell.initial_state()).is_none()
        {
            cell.step_ms = cell.step_ms.max(STEP_MS);
        }
        let way = Way::Runs(Box::new(simulation.shared_path(Tolerance::default())?));
        Ok(Self { way, simulation, names, cycle, interval, made })
    }

    /// Shortening, a part of the resting length, at ascending times; `None` where these numbers make no beat.
    pub(super) fn shortening(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<f64>> {
        let samples = self.samples(physics)?;
        let at = |time: f64| {
            let place = (time / self.interval).clamp(0.0, (samples.len() - 1) as f64);
            let before = (place as usize).min(samples.len() - 2);
            curve_at(&samples, before, place - before as f64)
        };
        let mut number = 0;
        let value = |time: &f64| {
            while number + 1 < stimuli.len() && stimuli[number + 1] <= *time {
                number += 1;
            }
            let start = number as f64 * self.cycle;
            // A pause longer than the cycle ends as this beat does.
            let since = (time - stimuli[number]).clamp(0.0, self.cycle * (1.0 - 1e-9));
            at(start + since)
        };
        Some(times.iter().map(value).collect())
    }

    /// Shortening at every interval.
    fn samples(&self, physics: &Physics<'_>) -> Option<Arc<[f64]>> {
        let key: Vec<u64> = physics
            .parameters
            .iter()
            .chain([&physics.tension, &physics.stiffness])
            .map(|value| value.to_bits())
            .collect();
        let known = |made: &Made| made.get(&key).cloned();
        if let Some(known) = known(&self.made.lock().unwrap_or_else(PoisonError::into_inner)) {
            return known;
        }
        let cell = self.changed(physics);
        let made = cell.and_then(|cell| match &self.way {
            Way::Myofilaments(own) => own.shortening(&*cell, physics.stiffness),
            Way::Runs(path) => self.run(path, cell, physics),
        });
        let mut all = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() >= KEPT {
            all.clear();
        }
        all.insert(key, made.clone());
        made
    }

    fn run(
        &self,
        path: &SharedPath,
        cell: Arc<dyn CellModel>,
        physics: &Physics<'_>,
    ) -> Option<Arc<[f64]>> {
        let mut simulation = Simulation { cell, ..self.simulation.clone() };
        if matches!(simulation.cell.tension_kind(), TensionKind::Relative { .. }) {
            simulation.peak_tension *= physics.tension;
        }
        let outcome = Ready::AlongPath(path.prepare(&simulation).ok()?).run(|_| true);
        let samples = &outcome.recording.samples;
        let whole = outcome.stop.is_none() && samples.len() > 3;
        whole.then(|| samples.iter().map(|sample| sample.shortening_pct / 100.0).collect())
    }

    /// The cell model with these numbers; `None` where it does not take them.
    fn changed(&self, physics: &Physics<'_>) -> Option<Arc<dyn CellModel>> {
        let cell = &self.simulation.cell;
        let mut parameters = cell.parameters().clone();
        for (name, value) in self.names.iter().zip(physics.parameters) {
            parameters.set(name, *value).ok()?;
        }
        if cell.tension_kind() == TensionKind::Kilopascal {
            let name = scale_of(&**cell)?;
            let usual = parameters.get(name)?;
            parameters.set(name, physics.tension * physics.stiffness * usual).ok()?;
        }
        cell.with_parameters(parameters).ok()
    }
}

/// A cubic through four samples: those between which the time lies, and one more on either side.
fn curve_at(samples: &[f64], before: usize, part: f64) -> f64 {
    let first = before.saturating_sub(1).min(samples.len() - 4);
    let x = before as f64 + part - first as f64;
    let weight = |k: usize| {
        (0..4).filter(|j| *j != k).map(|j| (x - j as f64) / (k as f64 - j as f64)).product::<f64>()
    };
    (0..4).map(|k| weight(k) * samples[first + k]).sum()
}
