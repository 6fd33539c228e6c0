//! Equilibria of a cell under other supports and for other stiffnesses than the run's.

use super::error::FitError;
use crate::integrate::quasi_static::Tolerance;
use crate::mechanics::support::SupportKind;
use crate::simulation::Simulation;
use crate::simulation::equilibria::TensionResponse;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, PoisonError};

/// Number of factors on the stiffness for which a held cell is solved, evenly spaced in their
/// logarithm; half as many change the standard deviation of a modulus by a tenth.
const STIFFNESSES: usize = 25;
/// Shortening up to which tables are solved.
const UP_TO: [f64; 4] = [0.1, 0.2, 0.4, 0.8];
/// The largest of these factors; the smallest is its inverse.
const STIFFEST: f64 = 16.0;

/// Solves up to a shortening, or to the largest that the cell reaches.
fn solve(simulation: &Simulation, up_to: f64) -> Result<Arc<dyn TensionResponse>, FitError> {
    let equilibria = simulation.response_to(up_to, Tolerance::default())?;
    let [most, _] = equilibria.shortening(equilibria.highest());
    // A cell whose ends are held does not shorten.
    if most.is_nan() || most <= 1e-6 {
        return Err(FitError::DoesNotShorten);
    }
    Ok(equilibria)
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
    /// The tables of a simulation up to at least this shortening, for the run's stiffness or any.
    /// Calls for one shelf may differ only in the support.
    pub(super) fn tables(
        &self,
        simulation: &Simulation,
        up_to: f64,
        any: bool,
    ) -> Result<Arc<Tables>, FitError> {
        // Only these ranges are solved, so that the table of a curve does not depend on earlier
        // requests.
        let up_to = UP_TO.into_iter().find(|reach| *reach >= up_to).unwrap_or(up_to);
        let of = (simulation.support, any, up_to);
        // The lock is free while a table is solved, since that thread may take on other work.
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
pub(super) struct Tables {
    /// By factor on every elastic constant of the cell, ascending; a single one if nothing holds
    /// the cell, since then only tension over stiffness counts.
    by_stiffness: Vec<Arc<dyn TensionResponse>>,
}

impl Tables {
    /// For the run's stiffness, or any.
    fn solve(simulation: &Simulation, up_to: f64, any: bool) -> Result<Self, FitError> {
        let held = !matches!(simulation.support, SupportKind::MassCentre | SupportKind::ClampedEnd);
        if !(any && held) {
            return Ok(Self { by_stiffness: vec![solve(simulation, up_to)?] });
        }
        let tables = (0..STIFFNESSES).into_par_iter().map(|at| {
            let mut other = simulation.clone();
            other.material.stiffen(factor(at));
            solve(&other, up_to)
        });
        Ok(Self { by_stiffness: tables.collect::<Result<_, _>>()? })
    }

    /// The equilibria of a cell of another stiffness, given as a factor, by Lagrange's cubic in the
    /// logarithm of the stiffness, at equal tension over stiffness.
    pub(super) fn at(&self, stiffness: f64) -> AtStiffness<'_> {
        let middle = &*self.by_stiffness[self.by_stiffness.len() / 2];
        if self.by_stiffness.len() == 1 {
            let part = Part { equilibria: middle, weight: 1.0, factor: 1.0 };
            return AtStiffness { middle, parts: vec![part], stiffness };
        }
        let place = f64::midpoint(stiffness.ln() / STIFFEST.ln(), 1.0) * (STIFFNESSES - 1) as f64;
        let first = (place as usize).saturating_sub(1).min(STIFFNESSES - 4);
        let part = |k: usize| {
            let others = (first..first + 4).filter(|j| *j != k);
            let weight = others.map(|j| (place - j as f64) / (k as f64 - j as f64)).product();
            Part { equilibria: &*self.by_stiffness[k], weight, factor: factor(k) }
        };
        AtStiffness { middle, parts: (first..first + 4).map(part).collect(), stiffness }
    }
}

/// Equilibria of a cell of another stiffness than the run's.
pub(super) struct AtStiffness<'a> {
    /// The equilibria of the run's stiffness.
    middle: &'a dyn TensionResponse,
    parts: Vec<Part<'a>>,
    stiffness: f64,
}

/// The equilibria of one of the stiffnesses between which others are found.
struct Part<'a> {
    equilibria: &'a dyn TensionResponse,
    weight: f64,
    factor: f64,
}

impl AtStiffness<'_> {
    /// A quantity and its derivative by the tension, from those of the tables at equal tension over stiffness.
    fn interpolated(
        &self,
        tension: f64,
        of: impl Fn(&dyn TensionResponse, f64) -> Option<[f64; 2]>,
    ) -> Option<[f64; 2]> {
        let ratio = tension / self.stiffness;
        let mut sum = [0.0; 2];
        for Part { equilibria, weight, factor } in &self.parts {
            let [value, slope] = of(*equilibria, ratio * factor)?;
            sum[0] += weight * value;
            sum[1] += weight * slope * factor / self.stiffness;
        }
        Some(sum)
    }
}

impl TensionResponse for AtStiffness<'_> {
    fn shortening(&self, tension: f64) -> [f64; 2] {
        let of = |equilibria: &dyn TensionResponse, tension| Some(equilibria.shortening(tension));
        self.interpolated(tension, of).unwrap_or([f64::NAN; 2])
    }

    fn steepest(&self) -> f64 {
        self.middle.steepest() / self.stiffness
    }

    fn highest(&self) -> f64 {
        self.middle.highest() * self.stiffness
    }

    fn stretch(&self, shortening: f64) -> f64 {
        self.middle.stretch(shortening)
    }

    fn load(&self, name: &str, tension: f64) -> Option<[f64; 2]> {
        self.interpolated(tension, |equilibria, tension| equilibria.load(name, tension))
    }
}

/// Smallest and largest factor on the stiffness.
pub(super) const STIFFNESS_BOUNDS: [f64; 2] = [1.0 / STIFFEST, STIFFEST];

fn factor(at: usize) -> f64 {
    STIFFEST.powf(2.0 * at as f64 / (STIFFNESSES - 1) as f64 - 1.0)
}
