//! The contraction of a cell whose tension feels its length.
//!
//! What makes a curve anew are the numbers of the cell alone; delays and levels only move it, so curves are remembered.
//! Myofilaments with given calcium have a way of their own ([`Myofilaments`]), everything else runs along the path of
//! equilibria, which all of its runs share.

use super::error::FitError;
use super::least_squares::Column;
use super::membrane::Membrane;
use super::myofilaments::Myofilaments;
use super::physics::{Physics, Train};
use super::table::Tables;
use crate::cell::pacing::Protocol;
use crate::cell::solve::Method;
use crate::cell::tension::lag::Lag;
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
    Membrane(Membrane),
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
            let lag = Lag::by(simulation.material.retardation_time);
            let own = Myofilaments::new(tables()?, *train, lag);
            let interval = own.interval();
            let (way, simulation) = (Way::Myofilaments(own), simulation.clone());
            return Ok(Self { way, simulation, names, cycle, interval, made });
        }
        if Membrane::serve(simulation) {
            let own = Membrane::new(tables()?, train, simulation);
            let interval = own.interval();
            let (way, simulation) = (Way::Membrane(own), simulation.clone());
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

    /// Whether a curve takes longer than all else of a fit. Such a cell begins as it is, whatever was before.
    pub(super) fn is_slow(&self) -> bool {
        !matches!(self.way, Way::Myofilaments(_))
    }

    /// Shortening, a part of the resting length, at ascending times; `None` where these numbers make no beat.
    pub(super) fn shortening(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<f64>> {
        let samples = self.samples(physics)?;
        let mut number = 0;
        let value = |time: &f64| {
            while number + 1 < stimuli.len() && stimuli[number + 1] <= *time {
                number += 1;
            }
            self.at(&samples, number, time - stimuli[number])[0]
        };
        Some(times.iter().map(value).collect())
    }

    /// Derivatives of [`Felt::shortening`] by each of the stimuli, 1/ms: each moves its own beat.
    pub(super) fn by_stimulus(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<Column>> {
        let samples = self.samples(physics)?;
        let column = |(number, stimulus): (usize, &f64)| {
            let first = times.partition_point(|time| time < stimulus);
            let next = stimuli.get(number + 1).copied().unwrap_or(f64::INFINITY);
            let end = times.partition_point(|time| *time < next);
            let slope = |time: &f64| -self.at(&samples, number, time - stimulus)[1];
            Column { first, values: times[first..end].iter().map(slope).collect() }
        };
        Some(stimuli.iter().enumerate().map(column).collect())
    }

    /// The shortening so long after a stimulus, and its slope, 1/ms.
    fn at(&self, samples: &[f64], number: usize, since: f64) -> [f64; 2] {
        // Before the first stimulus nothing moves; a pause longer than the cycle ends as this beat does.
        let last = self.cycle * (1.0 - 1e-9);
        let within = since.clamp(0.0, last);
        let time = number as f64 * self.cycle + within;
        let place = (time / self.interval).clamp(0.0, (samples.len() - 1) as f64);
        let before = (place as usize).min(samples.len() - 2);
        let [value, slope] = curve_at(samples, before, place - before as f64);
        let moves = (0.0..=last).contains(&since);
        [value, if moves { slope / self.interval } else { 0.0 }]
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
            Way::Membrane(own) => own.shortening(cell, physics.stiffness),
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
            let name = cell.in_fits().strength?;
            let usual = parameters.get(name)?;
            parameters.set(name, physics.tension * physics.stiffness * usual).ok()?;
        }
        cell.with_parameters(parameters).ok()
    }
}

/// A cubic through four samples, and its slope by the place: those between which the time lies, and one more on either
/// side.
fn curve_at(samples: &[f64], before: usize, part: f64) -> [f64; 2] {
    let first = before.saturating_sub(1).min(samples.len() - 4);
    let x = before as f64 + part - first as f64;
    // Newton's form, by differences.
    let [a, b, c, d] = [0, 1, 2, 3].map(|k| samples[first + k]);
    let [one, two] = [b - a, 0.5 * (c - 2.0 * b + a)];
    let three = (d - 3.0 * c + 3.0 * b - a) / 6.0;
    let value = a + x * (one + (x - 1.0) * (two + (x - 2.0) * three));
    let slope = one + (2.0 * x - 1.0) * two + ((3.0 * x - 6.0) * x + 2.0) * three;
    [value, slope]
}
