//! Many cells of ToR-ORd at once: stiff steps side by side in vector registers.
//!
//! Eight cells move together, each with parameters, pacing, time and step of its own; a cell that has reached its end
//! makes room for the next, so none waits for another. The method is that of [`stiff`](super::settings::Method::Stiff)
//! steps. No operation of a lane knows of another lane, and none is fused: **a cell has the same bits** alone, in any
//! company, in any order and with any vector units (AVX-512, AVX2 or none, chosen when the program runs). Against the
//! same cell by [`CellIntegrator`](super::integrator::CellIntegrator), whose elimination orders its sums in another way,
//! a result differs by far less than the tolerance. Threads: call [`run`] on parts of the list; it uses the caller's
//! only.
//!
//! # Example
//! The largest calcium of cells whose calcium current differs:
//! ```
//! use myospring::cell::beside::{Cell, Settings, run};
//! use myospring::cell::tomek_2019::{Layer, TomekModel, Variant, parameters};
//! use myospring::cell::{CellModel, pacing::Protocol};
//!
//! let mut cells = Vec::new();
//! for percent in [75.0, 100.0] {
//!     let mut set = parameters(Layer::Endo, Variant::Land);
//!     set.set("P_Ca", 8.3757e-5 * percent / 100.0)?;
//!     let model = TomekModel::new(Layer::Endo, Variant::Land, set)?;
//!     cells.push(Cell::new(&model, Protocol::once(model.default_stimulus()), 400.0)?);
//! }
//! let outcomes = run(&cells, &Settings { tolerance: 1e-4, sample_interval_ms: 1.0 })?;
//! let peak = |k: usize| -> Option<f64> {
//!     let samples = &outcomes[k].as_ref().ok()?.samples;
//!     Some(samples.iter().map(|sample| sample.calcium_um).fold(0.0, f64::max))
//! };
//! assert!(peak(0).is_some() && peak(0) < peak(1));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod cell;
mod course;
mod elimination;
mod step;

pub use cell::{Cell, Outcome, Sampled};

use super::settings::{self, SolveError, validate_time};
use super::tomek_2019::{Variant, lanes::LANES};
use course::{Course, Moved};
use step::{Lanes, TryStep};

/// So many steps of all lanes are made before it is asked again whether to go on: a few milliseconds.
const ASKED_EVERY: u32 = 256;

/// How exactly cells are followed, and how often they are looked at.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Largest error of a step over the size of each variable, dimensionless.
    pub tolerance: f64,
    /// Time between samples, ms, first at 0 ms.
    pub sample_interval_ms: f64,
}

/// Runs every cell to its end, on the caller's thread; outcomes in the order of the cells.
///
/// A cell that fails has its error in its place and does not disturb the others.
///
/// # Errors
/// A tolerance or sample interval that is not possible.
pub fn run(
    cells: &[Cell],
    settings: &Settings,
) -> Result<Vec<Result<Outcome, SolveError>>, SolveError> {
    Ok(run_while(cells, settings, &|| true)?.unwrap_or_default())
}

/// As [`run`], while `goes_on`, which is asked often, says so; `None` once it does not.
///
/// # Errors
/// Those of [`run`].
pub fn run_while(
    cells: &[Cell],
    settings: &Settings,
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<Result<Outcome, SolveError>>>, SolveError> {
    let Settings { tolerance, sample_interval_ms } = *settings;
    settings::Settings { tolerance, ..settings::Settings::default() }.validate()?;
    validate_time("sample interval", sample_interval_ms)?;
    let arch = pulp::Arch::new();
    let mut outcomes = vec![None; cells.len()];
    // Cells with myofilaments have other states than those without.
    let goes_on = moved::<true>(cells, settings, goes_on, &mut outcomes, |lanes| {
        arch.dispatch(TryStep(lanes));
    }) && moved::<false>(cells, settings, goes_on, &mut outcomes, |lanes| {
        arch.dispatch(TryStep(lanes));
    });
    Ok(goes_on.then(|| outcomes.into_iter().flatten().collect()))
}

/// Moves all cells with myofilaments, or all without; false if they were not to go on.
fn moved<const LAND: bool>(
    cells: &[Cell],
    settings: &Settings,
    goes_on: &dyn Fn() -> bool,
    outcomes: &mut [Option<Result<Outcome, SolveError>>],
    try_step: impl Fn(&mut Lanes<LAND>),
) -> bool {
    let of_this_kind = |(_, cell): &(usize, &Cell)| (cell.model.variant() == Variant::Land) == LAND;
    let mut queue = cells.iter().enumerate().filter(of_this_kind).peekable();
    if queue.peek().is_none() {
        return true;
    }
    let mut lanes = Lanes::new(settings.tolerance);
    let mut next = |lanes: &mut Lanes<LAND>, lane| {
        let (index, cell) = queue.next()?;
        Some((index, Course::start(cell, settings.sample_interval_ms, lanes, lane)))
    };
    let mut courses: [Option<(usize, Course)>; LANES] =
        std::array::from_fn(|lane| next(&mut lanes, lane));
    let mut steps = 0_u32;
    while courses.iter().any(Option::is_some) {
        steps = steps.wrapping_add(1);
        if steps.is_multiple_of(ASKED_EVERY) && !goes_on() {
            return false;
        }
        try_step(&mut lanes);
        for lane in 0..LANES {
            let Some((index, course)) = &mut courses[lane] else { continue };
            let outcome = match course.follow(&mut lanes, lane) {
                Moved::On => continue,
                Moved::ToTheEnd => Ok(course.outcome()),
                Moved::Nowhere(error) => Err(error),
            };
            outcomes[*index] = Some(outcome);
            courses[lane] = next(&mut lanes, lane);
        }
    }
    true
}

#[cfg(test)]
mod tests;
