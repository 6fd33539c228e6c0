//! How far a cell shortens under a tension: its equilibria as a table.

use super::error::FitError;
use crate::integrate::quasi_static::Tolerance;
use crate::mechanics::material::Stiffness;
use crate::mechanics::support::SupportKind;
use crate::simulation::Simulation;
use crate::simulation::quasi_static::Equilibria;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Intervals of a table.
const INTERVALS: usize = 4000;
/// Factors on the stiffness for which a held cell is solved, evenly in their logarithm: half as many move the standard
/// deviation of a modulus by a tenth.
const STIFFNESSES: usize = 25;
/// Shortening up to which tables are solved.
const UP_TO: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// The largest of these factors; the smallest is its inverse.
const STIFFEST: f64 = 16.0;

/// Shortening, as a part of the resting length, by tension.
#[derive(Debug, Clone)]
struct Table {
    step: f64,
    shortening: Vec<f64>,
}

impl Table {
    /// Up to a shortening, or as far as the cell goes.
    fn solve(simulation: &Simulation, up_to: f64) -> Result<Self, FitError> {
        let equilibria = simulation.equilibria_to(up_to, Tolerance::default())?;
        Self::of(&equilibria)
    }

    fn of(equilibria: &Equilibria) -> Result<Self, FitError> {
        let [_, highest] = equilibria.shapes.range();
        let step = highest / INTERVALS as f64;
        let series: Vec<[f64; 2]> =
            (0..=INTERVALS).map(|at| [0.0, (at as f64 * step).min(highest)]).collect();
        let responses = equilibria.follow(&series)?;
        let shortening: Vec<f64> =
            responses.iter().map(|response| response.shortening_pct / 100.0).collect();
        // A cell whose ends are held does not show what it does.
        if shortening[INTERVALS].is_nan() || shortening[INTERVALS] <= 1e-6 {
            return Err(FitError::DoesNotShorten);
        }
        Ok(Self { step, shortening })
    }

    /// The shortening under a tension, kPa, and its slope; past either end, on the straight line.
    fn at(&self, tension: f64) -> [f64; 2] {
        let place = tension / self.step;
        let before = (place.max(0.0) as usize).min(INTERVALS - 1);
        let [from, to] = [self.shortening[before], self.shortening[before + 1]];
        [from + (place - before as f64) * (to - from), (to - from) / self.step]
    }
}

/// Tables that were solved: curves of one cell share them.
#[derive(Default)]
pub(super) struct Shelf {
    kept: Mutex<Vec<Kept>>,
}

struct Kept {
    /// Support, whether for any stiffness, and up to which shortening.
    of: (SupportKind, bool, f64),
    tables: Arc<Tables>,
}

impl Shelf {
    /// The tables of a simulation up to a shortening at least, for the run's stiffness or any; all that is asked of one
    /// shelf differs in the support alone.
    pub(super) fn tables(
        &self,
        simulation: &Simulation,
        up_to: f64,
        any: bool,
    ) -> Result<Arc<Tables>, FitError> {
        // A few of them serve all; which one a curve has must not hang on what others had asked for.
        let up_to = UP_TO.into_iter().find(|reach| *reach >= up_to).unwrap_or(up_to);
        let of = (simulation.support, any, up_to);
        // Not held while one is solved, which may take on other work meanwhile.
        let all = || self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(kept) = all().iter().find(|kept| kept.of == of) {
            return Ok(Arc::clone(&kept.tables));
        }
        let tables = Arc::new(Tables::solve(simulation, up_to, any)?);
        all().push(Kept { of, tables: Arc::clone(&tables) });
        Ok(tables)
    }
}

/// Tables for cells of other stiffness than the run's, all else as it is.
#[derive(Debug, Clone)]
pub(super) struct Tables {
    /// By factor on every elastic constant of the cell, ascending; one alone where nothing holds the cell, since there
    /// only tension over stiffness counts.
    by_stiffness: Vec<Table>,
}

impl Tables {
    /// For the run's stiffness, or any.
    fn solve(simulation: &Simulation, up_to: f64, any: bool) -> Result<Self, FitError> {
        let held = !matches!(simulation.support, SupportKind::MassCentre | SupportKind::ClampedEnd);
        if !(any && held) {
            return Ok(Self { by_stiffness: vec![Table::solve(simulation, up_to)?] });
        }
        let tables = (0..STIFFNESSES).into_par_iter().map(|at| {
            let mut other = simulation.clone();
            stiffen(&mut other, factor(at));
            Table::solve(&other, up_to)
        });
        Ok(Self { by_stiffness: tables.collect::<Result<_, _>>()? })
    }

    /// The shortening under a tension of a cell that is so many times as stiff: by Lagrange's cubic in the logarithm of
    /// the stiffness, at equal tension over stiffness.
    pub(super) fn at(&self, tension: f64, stiffness: f64) -> f64 {
        self.with_slope(tension, stiffness)[0]
    }

    /// The largest slope by the tension, at the run's stiffness, 1/kPa.
    pub(super) fn largest_slope(&self) -> f64 {
        let middle = &self.by_stiffness[self.by_stiffness.len() / 2];
        let rises = middle.shortening.windows(2).map(|pair| pair[1] - pair[0]);
        rises.fold(0.0, f64::max) / middle.step
    }

    /// [`Tables::at`] and its slope by the tension, 1/kPa.
    pub(super) fn with_slope(&self, tension: f64, stiffness: f64) -> [f64; 2] {
        let ratio = tension / stiffness;
        let [table] = self.by_stiffness.as_slice() else {
            let part = f64::midpoint(stiffness.ln() / STIFFEST.ln(), 1.0);
            let place = part * (STIFFNESSES - 1) as f64;
            let first = (place as usize).saturating_sub(1).min(STIFFNESSES - 4);
            let mut sum = [0.0; 2];
            for k in first..first + 4 {
                let others = (first..first + 4).filter(|j| *j != k);
                let weight: f64 =
                    others.map(|j| (place - j as f64) / (k as f64 - j as f64)).product();
                let [value, slope] = self.by_stiffness[k].at(ratio * factor(k));
                sum[0] += weight * value;
                sum[1] += weight * slope * factor(k) / stiffness;
            }
            return sum;
        };
        let [value, slope] = table.at(ratio);
        [value, slope / stiffness]
    }
}

/// Smallest and largest factor on the stiffness.
pub(super) const STIFFNESS_BOUNDS: [f64; 2] = [1.0 / STIFFEST, STIFFEST];

fn factor(at: usize) -> f64 {
    STIFFEST.powf(2.0 * at as f64 / (STIFFNESSES - 1) as f64 - 1.0)
}

/// Multiplies every elastic constant of the cell itself.
pub(super) fn stiffen(simulation: &mut Simulation, by: f64) {
    let material = &mut simulation.material;
    material.stiffness = match material.stiffness {
        Stiffness::YoungModulus(modulus) => Stiffness::YoungModulus(by * modulus),
        Stiffness::Spring(stiffness) => Stiffness::Spring(by * stiffness),
    };
    material.area_modulus *= by;
}
