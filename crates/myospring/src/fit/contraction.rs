//! From unknowns to curves of shortening.

use super::error::FitError;
use super::given::{OF_TENSION, Potential, Rates};
use super::table::Tables;
use super::unknown::Unknown;
use crate::cell::minimal::MinimalModel;
use crate::cell::pacing::Protocol;
use crate::cell::solve::Method;
use crate::cell::{CellModel, TensionKind};
use crate::integrate::quasi_static::Tolerance;
use crate::simulation::{Ready, SharedPath, Simulation};
use std::any::Any;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Parameters that scale a tension in kPa.
const SCALES: [&str; 1] = ["T_ref"];

/// Cell and mesh meet so often, ms: a longer interval moves a curve by 1e-4 of its height.
const EXCHANGE_MS: f64 = 2.0;
/// Steps of myofilaments alone, ms: a longer one moves a curve by less than 1e-6 of its height.
const STEP_MS: f64 = 0.4;
/// Runs that are remembered.
const KEPT: usize = 256;

/// How a cell is paced.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Train {
    /// Beats before those that were recorded.
    pub(super) before: usize,
    /// Those that were.
    pub(super) beats: usize,
    /// From stimulus to stimulus, ms.
    pub(super) cycle: f64,
}

/// A cell with some of its numbers changed.
#[derive(Debug, Clone, Copy)]
pub(super) struct Physics<'a> {
    /// Factor on the peak of tension, over stiffness.
    pub(super) tension: f64,
    /// Factor on every elastic constant.
    pub(super) stiffness: f64,
    /// Values of the parameters of [`Contraction::new`], in their order.
    pub(super) parameters: &'a [f64],
}

/// How a cell on its mesh shortens after stimuli.
pub(super) enum Contraction {
    /// Its tension follows its potential and feels nothing.
    Given { potential: Potential, rates: Rates, places: Vec<usize>, tables: Tables, peak: f64 },
    /// Anything else: runs along the path of equilibria, which all of them share.
    Felt(Box<Felt>),
}

/// Shortening at every output interval, by the bits of the physics; `None` where there was no beat.
type Made = HashMap<Vec<u64>, Option<Arc<[f64]>>>;

/// Runs that differ in the cell model.
pub(super) struct Felt {
    simulation: Simulation,
    path: SharedPath,
    names: Vec<String>,
    cycle: f64,
    /// Runs that were made, by the bits of their physics: delays and levels need no new one.
    made: Mutex<Made>,
}

impl Contraction {
    /// Of a train of so many beats, on the mesh of a simulation; `names` are the parameters that are free, and curves
    /// go up to about that shortening.
    pub(super) fn new(
        simulation: &Simulation,
        unknowns: &[Unknown],
        train: &Train,
        up_to: f64,
    ) -> Result<Self, FitError> {
        let Train { before, beats, cycle } = *train;
        let names: Vec<String> = unknowns
            .iter()
            .filter_map(|unknown| match unknown {
                Unknown::Parameter(name) => Some(name.clone()),
                _ => None,
            })
            .collect();
        let loaded = unknowns.contains(&Unknown::YoungModulus);
        let minimal = (&*simulation.cell as &dyn Any).downcast_ref::<MinimalModel>();
        let of_tension = |name: &String| OF_TENSION.iter().position(|known| known == name);
        let places: Option<Vec<usize>> = names.iter().map(of_tension).collect();
        if let (Some(model), Some(places), 0.0) =
            (minimal, places, simulation.material.retardation_time)
        {
            let potential = Potential::solve(model, simulation.protocol, before, beats, cycle)?;
            let rates = Rates::of(model);
            let peak = simulation.peak_tension;
            let tables = Tables::solve(simulation, up_to, loaded)?;
            return Ok(Self::Given { potential, rates, places, tables, peak });
        }
        if loaded {
            return Err(FitError::Unknown {
                name: "young_modulus".to_owned(),
                why: "the tension of this cell feels its length, so every stiffness would be a mesh of its own".to_owned(),
                known: "it with coelho_2021 and the sets of bueno_orovio_2008".to_owned(),
            });
        }
        let protocol = Protocol {
            start_ms: 0.0,
            cycle_length_ms: cycle,
            beats: beats as u32,
            ..simulation.protocol
        };
        let mut simulation =
            Simulation { protocol, duration: beats as f64 * cycle, ..simulation.clone() };
        // Nobody looks at the shapes in between.
        let output = simulation.numerics.output_interval;
        simulation.numerics.frame_interval =
            output * (simulation.duration / output).ceil().max(1.0);
        simulation.numerics.exchange_interval =
            simulation.numerics.exchange_interval.max(EXCHANGE_MS);
        simulation.numerics.output_interval = simulation.numerics.exchange_interval;
        let cell = &mut simulation.numerics.cell;
        // Made for the action potential's upstroke; nothing in myofilaments is as fast.
        if cell.method == Method::RungeKutta4
            && simulation.cell.potential(&simulation.cell.initial_state()).is_none()
        {
            cell.step_ms = cell.step_ms.max(STEP_MS);
        }
        let path = simulation.shared_path(Tolerance::default())?;
        Ok(Self::Felt(Box::new(Felt { simulation, path, names, cycle, made: Mutex::default() })))
    }

    /// Shortening, a part of the resting length, at ascending times; `None` where these numbers make no beat.
    pub(super) fn shortening(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<f64>> {
        match self {
            Self::Given { potential, rates, places, tables, peak } => {
                let mut all = [rates.c_0, rates.x_1, rates.x_3, rates.sigma];
                for (place, value) in places.iter().zip(physics.parameters) {
                    all[*place] = *value;
                }
                let [c_0, x_1, x_3, sigma] = all;
                let mut curve = Vec::with_capacity(times.len());
                potential.tension(&Rates { c_0, x_1, x_3, sigma }, stimuli, times, &mut curve);
                let by = peak * physics.tension * physics.stiffness;
                for value in &mut curve {
                    *value = tables.at(by * *value, physics.stiffness);
                }
                Some(curve)
            }
            Self::Felt(felt) => {
                let samples = felt.samples(physics)?;
                let interval = felt.simulation.numerics.output_interval;
                let at = |time: f64| {
                    let place = (time / interval).clamp(0.0, (samples.len() - 1) as f64);
                    let before = (place as usize).min(samples.len() - 2);
                    curve_at(&samples, before, place - before as f64)
                };
                let mut number = 0;
                let value = |time: &f64| {
                    while number + 1 < stimuli.len() && stimuli[number + 1] <= *time {
                        number += 1;
                    }
                    let start = number as f64 * felt.cycle;
                    // A pause longer than the cycle ends as this beat does.
                    let since = (time - stimuli[number]).clamp(0.0, felt.cycle * (1.0 - 1e-9));
                    at(start + since)
                };
                Some(times.iter().map(value).collect())
            }
        }
    }

    /// The tension over the run's own, such that the largest shortening is about this.
    pub(super) fn tension_for(
        &self,
        shortening: f64,
        physics: &Physics<'_>,
        cycle: f64,
    ) -> Option<f64> {
        let times: Vec<f64> = (0..300).map(|at| f64::from(at) * cycle / 300.0).collect();
        let peak = |tension: f64| {
            let curve = self.shortening(&Physics { tension, ..*physics }, &[0.0], &times)?;
            Some(curve.into_iter().fold(0.0, f64::max))
        };
        let mut tension = 1.0;
        // The answer to a tension is nearly a straight line.
        for _ in 0..8 {
            let found = peak(tension)?;
            if found.is_nan() || found <= 0.0 {
                return None;
            }
            let by = (shortening / found).clamp(0.1, 10.0);
            tension *= by;
            if (by - 1.0).abs() < 0.01 {
                break;
            }
        }
        Some(tension)
    }
}

impl Felt {
    /// Shortening at every output interval.
    fn samples(&self, physics: &Physics<'_>) -> Option<Arc<[f64]>> {
        let key: Vec<u64> = physics
            .parameters
            .iter()
            .chain([&physics.tension])
            .map(|value| value.to_bits())
            .collect();
        let known = |made: &Made| made.get(&key).cloned();
        if let Some(known) = known(&self.made.lock().unwrap_or_else(PoisonError::into_inner)) {
            return known;
        }
        let made = self.run(physics);
        let mut all = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() >= KEPT {
            all.clear();
        }
        all.insert(key, made.clone());
        made
    }

    fn run(&self, physics: &Physics<'_>) -> Option<Arc<[f64]>> {
        let mut simulation = self.simulation.clone();
        simulation.cell = changed(&simulation, &self.names, physics)?;
        if matches!(simulation.cell.tension_kind(), TensionKind::Relative { .. }) {
            simulation.peak_tension *= physics.tension;
        }
        let outcome = Ready::AlongPath(self.path.prepare(&simulation).ok()?).run(|_| true);
        let samples = &outcome.recording.samples;
        let whole = outcome.stop.is_none() && samples.len() > 3;
        whole.then(|| samples.iter().map(|sample| sample.shortening_pct / 100.0).collect())
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

fn changed(
    simulation: &Simulation,
    names: &[String],
    physics: &Physics<'_>,
) -> Option<Arc<dyn CellModel>> {
    let mut parameters = simulation.cell.parameters().clone();
    for (name, value) in names.iter().zip(physics.parameters) {
        parameters.set(name, *value).ok()?;
    }
    if simulation.cell.tension_kind() == TensionKind::Kilopascal {
        let name = scale_of(&*simulation.cell)?;
        let usual = parameters.get(name)?;
        parameters.set(name, physics.tension * usual).ok()?;
    }
    simulation.cell.with_parameters(parameters).ok()
}

/// The parameter that scales the tension of a model in kPa.
pub(super) fn scale_of(cell: &dyn CellModel) -> Option<&'static str> {
    SCALES.into_iter().find(|name| cell.parameters().get(name).is_some())
}
