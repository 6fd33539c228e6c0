//! From unknowns to curves of shortening.

use super::error::FitError;
use super::least_squares::Column;
use super::stretch_dependent::StretchDependent;
use super::support_load::SupportLoad;
use super::table::{Shelf, Tables};
use super::unknown::{Physics, Unknown};
use crate::cell::CellModel;
use crate::cell::tension::lag::Lag;
use crate::cell::tension::train::Potential;
use crate::cell::tension::{Rates, Tension};
use crate::simulation::equilibria::TensionResponse;
use crate::simulation::{Beating, Simulation, Train};
use std::sync::Arc;

/// How a cell on its mesh shortens after stimuli.
pub(super) enum Contraction {
    /// Its tension follows its potential and does not depend on stretch.
    FollowsPotential {
        potential: Potential,
        rates: Rates,
        places: Vec<usize>,
        tables: Arc<Tables>,
        peak: f64,
    },
    /// Any other cell model.
    StretchDependent(Box<StretchDependent>),
}

impl Contraction {
    /// For a train of `beats` beats, on the mesh of a simulation. `names` are the fitted
    /// parameters; curves reach about this shortening.
    pub(super) fn new(
        simulation: &Simulation,
        unknowns: &[Unknown],
        train: &Train,
        up_to: f64,
        shelf: &Shelf,
    ) -> Result<Self, FitError> {
        let Train { before, beats, cycle_ms } = *train;
        let loaded = unknowns.contains(&Unknown::YoungModulus);
        let cell = &simulation.cell;
        if let Some((tension, places)) = of_potential(&**cell, unknowns) {
            let protocol = simulation.protocol;
            let potential = Potential::solve(cell, tension, protocol, before, beats, cycle_ms)?;
            let rates = Rates::of(tension, Lag::by(simulation.material.retardation_time));
            let peak = simulation.peak_tension;
            let tables = shelf.tables(simulation, up_to, loaded)?;
            return Ok(Self::FollowsPotential { potential, rates, places, tables, peak });
        }
        let tables = shelf.tables(simulation, up_to, loaded)?;
        let names = parameters(unknowns).map(str::to_owned).collect();
        let cell = StretchDependent::new(simulation, names, *train, tables)?;
        Ok(Self::StretchDependent(Box::new(cell)))
    }

    /// Shortening, a part of the resting length, at ascending times; `None` if the cell does not
    /// beat with these numbers.
    pub(super) fn shortening(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<f64>> {
        match self {
            Self::FollowsPotential { potential, rates, places, tables, peak } => {
                let mut curve = Vec::with_capacity(times.len());
                let rates = rates.with(places, physics.parameters);
                potential.tension(&rates, stimuli, times, &mut curve);
                let by = peak * physics.tension * physics.stiffness;
                let response = tables.at(physics.stiffness);
                for value in &mut curve {
                    [*value, _] = response.shortening(by * *value);
                }
                Some(curve)
            }
            Self::StretchDependent(cell) => cell.shortening(physics, stimuli, times),
        }
    }

    /// Derivatives of [`Contraction::shortening`] by each of the stimuli, 1/ms.
    pub(super) fn by_stimulus(
        &self,
        physics: &Physics<'_>,
        stimuli: &[f64],
        times: &[f64],
    ) -> Option<Vec<Column>> {
        match self {
            Self::FollowsPotential { potential, rates, places, tables, peak } => {
                let rates = rates.with(places, physics.parameters);
                let mut tension = Vec::with_capacity(times.len());
                potential.tension(&rates, stimuli, times, &mut tension);
                let by = peak * physics.tension * physics.stiffness;
                let response = tables.at(physics.stiffness);
                let slopes = |value: &f64| by * response.shortening(by * value)[1];
                let slopes: Vec<f64> = tension.iter().map(slopes).collect();
                let columns = potential.by_stimulus(&rates, stimuli, times);
                let column = |(first, mut values): (usize, Vec<f64>)| {
                    for (value, slope) in values.iter_mut().zip(&slopes[first..]) {
                        *value *= slope;
                    }
                    Column { first, values }
                };
                Some(columns.into_iter().map(column).collect())
            }
            Self::StretchDependent(cell) => cell.by_stimulus(physics, stimuli, times),
        }
    }

    /// What the cell does to its support up to a shortening, by name ([`TensionResponse::load`]);
    /// `None` if the support has no such load.
    pub(super) fn load(&self, name: &str, stiffness: f64, most: f64) -> Option<SupportLoad> {
        let tables = match self {
            Self::FollowsPotential { tables, .. } => tables,
            Self::StretchDependent(cell) => cell.tables(),
        };
        SupportLoad::new(&tables.at(stiffness), name, most)
    }

    /// Whether computing curves of these unknowns takes most of the time of a fit.
    pub(super) fn will_be_slow(simulation: &Simulation, unknowns: &[Unknown]) -> bool {
        let cell = &*simulation.cell;
        of_potential(cell, unknowns).is_none() && !Beating::repeats(simulation, cell)
    }

    /// Whether computing curves takes most of the time of a fit.
    pub(super) fn is_slow(&self) -> bool {
        matches!(self, Self::StretchDependent(cell) if cell.is_slow())
    }

    /// The factor on the run's tension at which the largest shortening is about this.
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
        // Shortening is nearly proportional to tension.
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

/// The parameters of the cell model that are sought.
fn parameters(unknowns: &[Unknown]) -> impl Iterator<Item = &str> {
    unknowns.iter().filter_map(|unknown| match unknown {
        Unknown::Parameter(name) => Some(&**name),
        _ => None,
    })
}

/// The law by which tension follows the potential, and the places of the unknowns among its rates; `None` of another cell
/// model, or if any unknown parameter is none of these.
fn of_potential<'a>(
    cell: &'a dyn CellModel,
    unknowns: &[Unknown],
) -> Option<(&'a Tension, Vec<usize>)> {
    let place = |name: &str| Rates::NAMES.iter().position(|known| *known == name);
    let places: Option<Vec<usize>> = parameters(unknowns).map(place).collect();
    Some((cell.tension_of_potential()?, places?))
}
