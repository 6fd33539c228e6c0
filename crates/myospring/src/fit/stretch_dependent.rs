//! The contraction of a cell whose tension depends on its stretch.
//!
//! Only the numbers of the cell change a curve; delays and levels shift it, so computed curves are
//! stored.

use super::error::FitError;
use super::least_squares::Column;
use super::table::Tables;
use super::unknown::Physics;
use crate::cell::{CellModel, TensionKind};
use crate::simulation::{Beating, Simulation, Train};
use std::collections::HashMap;
use std::sync::{Arc, Mutex, PoisonError};

/// The largest number of stored curves.
const KEPT: usize = 256;

/// Shortening at every interval, by the bits of the physics; `None` where there was no beat.
type Made = HashMap<Vec<u64>, Option<Arc<[f64]>>>;

/// Curves of one cell for different parameters of its model.
pub(super) struct StretchDependent {
    simulation: Simulation,
    names: Vec<String>,
    train: Train,
    tables: Arc<Tables>,
    made: Mutex<Made>,
}

impl StretchDependent {
    pub(super) fn new(
        simulation: &Simulation,
        names: Vec<String>,
        train: Train,
        tables: Arc<Tables>,
    ) -> Result<Self, FitError> {
        if simulation.activation.is_some() || simulation.has_sites_in_triangles() {
            return Err(FitError::Setting {
                what: "a tension for each triangle, or another activation than a cell model",
                why: "a fit needs one cell model for the whole cell",
            });
        }
        let simulation = simulation.clone();
        Ok(Self { simulation, names, train, tables, made: Mutex::default() })
    }

    /// The equilibria of its mesh.
    pub(super) fn tables(&self) -> &Tables {
        &self.tables
    }

    /// Whether computing curves takes most of the time of a fit. Such a cell always starts from the
    /// model's published state.
    pub(super) fn is_slow(&self) -> bool {
        !Beating::repeats(&self.simulation, &*self.simulation.cell)
    }

    /// Shortening, a part of the resting length, at ascending times; `None` if the cell does not
    /// beat with these numbers.
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

    /// Derivatives of [`StretchDependent::shortening`] by each of the stimuli, 1/ms: each shifts
    /// its own beat.
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

    /// The shortening at a time after a stimulus, and its slope, 1/ms.
    fn at(&self, samples: &[f64], number: usize, since: f64) -> [f64; 2] {
        // Before the first stimulus the cell is at rest; in a pause longer than the cycle it keeps
        // the last value.
        let (cycle, interval) = (self.train.cycle_ms, self.train.interval_ms());
        let last = cycle * (1.0 - 1e-9);
        let within = since.clamp(0.0, last);
        let time = number as f64 * cycle + within;
        let place = (time / interval).clamp(0.0, (samples.len() - 1) as f64);
        let before = (place as usize).min(samples.len() - 2);
        let [value, slope] = curve_at(samples, before, place - before as f64);
        let moves = (0.0..=last).contains(&since);
        [value, if moves { slope / interval } else { 0.0 }]
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
        let made = self.changed(physics).and_then(|cell| {
            let beating = Beating {
                simulation: &self.simulation,
                cell: &cell,
                strength: physics.tension * physics.stiffness,
                response: &self.tables.at(physics.stiffness),
            };
            beating.shortening(&self.train).ok().map(Arc::from)
        });
        let mut all = self.made.lock().unwrap_or_else(PoisonError::into_inner);
        if all.len() >= KEPT {
            all.clear();
        }
        all.insert(key, made.clone());
        made
    }

    /// The cell model with these numbers; `None` if it rejects them.
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

/// The value and slope of a cubic through four samples: the two around the time, and one more on
/// either side.
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
