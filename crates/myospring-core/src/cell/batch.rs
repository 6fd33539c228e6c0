//! Many cells without a mesh, each with a model, parameters and pacing of its own.
//!
//! Models that support it ([`SideBySide`]) integrate several cells
//! at once in vector registers, for one method: `adaptive` for the minimal models, `stiff` for
//! ToR-ORd and for models read from files. All others are integrated one after the other. **The
//! result of a cell is bitwise the same** alone, in any batch and in any order. [`run`] uses only the calling thread; for several
//! threads, call it on parts of the list.
//!
//! # Example
//! Tension of cells whose slow inward current differs:
//! ```
//! use myospring::cell::batch::{BatchSettings, Paced, run};
//! use myospring::cell::solve::{CellMethod, SolverSettings};
//! use myospring::cell::{self, pacing::Protocol};
//!
//! let published = cell::model("coelho_2021")?;
//! let mut cells = Vec::new();
//! for percent in [90.0, 100.0, 110.0] {
//!     let mut parameters = published.parameters().clone();
//!     parameters.set("tau_si", 1.76816 * percent / 100.0)?;
//!     let model = published.with_parameters(parameters)?;
//!     cells.push(Paced::new(model, Protocol::once(published.default_stimulus()), 600.0)?);
//! }
//! let settings = BatchSettings { method: SolverSettings::of(CellMethod::Adaptive), ..Default::default() };
//! let outcomes = run(&cells, &settings)?;
//! let apd: Vec<f64> =
//!     outcomes.iter().filter_map(|cell| cell.as_ref().ok()?.beats.last()?.apd90_ms).collect();
//! assert!(apd[0] > apd[1] && apd[1] > apd[2]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub use super::beat::CellBeat;
pub use super::cell_model::{BatchSettings, CellOutcome, CellSample, Paced};

use super::cell_model::{CellModel, SideBySide};
use super::description::Input;
use super::integrator::Steps;
use super::settings::{SolveError, SolverSettings, validate_time};
use std::any::{Any, TypeId};

/// Number of cells from which on the vector registers are full.
pub const TOGETHER: usize = 16;
/// Sample interval from which beats are read if none was requested, ms.
const SAMPLED_MS: f64 = 0.1;

/// Runs every cell to its end, on the calling thread; outcomes are in the order of the cells.
///
/// A cell that fails has its error as outcome and does not affect the others.
///
/// # Errors
/// An invalid step, tolerance or sample interval.
pub fn run(
    cells: &[Paced],
    settings: &BatchSettings,
) -> Result<Vec<Result<CellOutcome, SolveError>>, SolveError> {
    Ok(run_while(cells, settings, &|| true)?.unwrap_or_default())
}

/// Like [`run`], as long as `goes_on`, which is called often, returns true; `None` once it does
/// not.
///
/// # Errors
/// Those of [`run`].
pub fn run_while(
    cells: &[Paced],
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<Result<CellOutcome, SolveError>>>, SolveError> {
    settings.method.validate()?;
    if let Some(interval_ms) = settings.sample_interval_ms {
        validate_time("sample interval", interval_ms)?;
    }
    let mut outcomes: Vec<Option<Result<CellOutcome, SolveError>>> = vec![None; cells.len()];
    for first in 0..cells.len() {
        if outcomes[first].is_some() {
            continue;
        }
        let Some(way) = together(&*cells[first].model, settings.method) else {
            let Some(outcome) = alone(&cells[first], settings, goes_on) else { return Ok(None) };
            outcomes[first] = Some(outcome);
            continue;
        };
        let kind = kind(&cells[first]);
        let places: Vec<usize> = (first..cells.len())
            .filter(|&place| {
                self::kind(&cells[place]) == kind
                    && together(&*cells[place].model, settings.method).is_some()
            })
            .collect();
        let group: Vec<&Paced> = places.iter().map(|&place| &cells[place]).collect();
        let Some(done) = way.move_all(&group, settings, goes_on) else { return Ok(None) };
        for (place, outcome) in places.into_iter().zip(done) {
            outcomes[place] = Some(outcome);
        }
    }
    Ok(Some(outcomes.into_iter().flatten().collect()))
}

/// Whether a model gives its beats exactly with this method, without samples.
pub fn tells_beats(model: &dyn CellModel, method: SolverSettings) -> bool {
    together(model, method).is_some_and(SideBySide::tells_beats)
}

/// The model's vectorised integration with this method, if it has one.
fn together(model: &dyn CellModel, method: SolverSettings) -> Option<&dyn SideBySide> {
    model.side_by_side().filter(|way| way.method() == method.method)
}

/// The type of a cell's model.
fn kind(cell: &Paced) -> TypeId {
    let model: &dyn Any = &*cell.model;
    model.type_id()
}

/// Runs a single cell.
fn alone(
    cell: &Paced,
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
) -> Option<Result<CellOutcome, SolveError>> {
    let Paced { model, protocol, duration_ms } = cell;
    let mut steps = match Steps::new(&**model, *protocol, settings.method) {
        Ok(steps) => steps,
        Err(error) => return Some(Err(error)),
    };
    steps.hold();
    let interval_ms = settings.sample_interval_ms.unwrap_or(SAMPLED_MS);
    // If the duration is a multiple of the interval except for rounding, the last sample is kept.
    let last = (duration_ms / interval_ms * (1.0 + 1e-12)).floor() as u64;
    let mut times = Vec::new();
    let mut samples = Vec::new();
    for sample in 0..=last {
        if !goes_on() {
            return None;
        }
        let time_ms = sample as f64 * interval_ms;
        if let Err(error) = steps.advance_to(&**model, time_ms, 1.0, 0.0) {
            return Some(Err(error));
        }
        let input = Input { stretch: 1.0, stretch_rate: 0.0, ..steps.input() };
        times.push(time_ms);
        samples.push(CellSample::of(&**model, steps.state(), &input));
    }
    let column = |read: fn(&CellSample) -> f64| samples.iter().map(read).collect::<Vec<f64>>();
    let (potential, tension) =
        (column(|it| it.potential.unwrap_or(f64::NAN)), column(|it| it.tension));
    let beats = CellBeat::of_samples(&times, &potential, &tension, protocol.stimulus_times());
    if settings.sample_interval_ms.is_none() {
        samples.clear();
    }
    Some(Ok(CellOutcome { beats, samples, steps: 0, refused: 0 }))
}
