//! The course of a cell that does not feel stretch, kept for runs that share it.

use crate::cell::integrator::CellIntegrator;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Greatest number of intervals that are kept: 2.5 s at the usual one, some 15 MB for the minimal model.
const MOST: usize = 10_000;

/// A cell at the end of each exchange interval, as far as a run has needed it.
///
/// Runs whose cells have the same equations, parameters, protocol, method, start and intervals may share it. A copy
/// refers to the same course; runs on several threads may extend it.
#[derive(Clone, Default)]
pub(crate) struct CellCourse(Arc<Mutex<Vec<Instant>>>);

/// A time (ms) with the cell at it.
type Instant = (f64, Arc<CellIntegrator>);

impl CellCourse {
    /// Returns the cell at the end of an interval, counted from 0, if that is known and ends at this time (ms).
    pub(super) fn at(&self, interval: usize, to_ms: f64) -> Option<Arc<CellIntegrator>> {
        let cells = self.cells();
        let (time, cell) = cells.get(interval)?;
        (*time == to_ms).then(|| Arc::clone(cell))
    }

    /// Keeps the cell at the end of an interval, at this time (ms), and returns whether the course has it.
    pub(super) fn keep(&self, interval: usize, to_ms: f64, cell: &Arc<CellIntegrator>) -> bool {
        let mut cells = self.cells();
        if interval == cells.len() && interval < MOST {
            cells.push((to_ms, Arc::clone(cell)));
        }
        cells.get(interval).is_some_and(|(time, _)| *time == to_ms)
    }

    fn cells(&self) -> MutexGuard<'_, Vec<Instant>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
