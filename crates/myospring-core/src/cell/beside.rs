//! Many cells of ToR-ORd at once: stiff steps in vector registers.
//!
//! Eight cells are integrated together, each with its own parameters, pacing, time and step; a cell
//! that has reached its end is replaced by the next one. The method is that of
//! [`stiff`](super::settings::CellMethod::Stiff) steps. Lanes are independent, and no operation is
//! fused, so **the result of a cell is bitwise the same** alone, in any batch, in any order and
//! with any vector units (AVX-512, AVX2 or none, chosen at run time). Compared with the same cell
//! by [`CellIntegrator`](super::integrator::CellIntegrator), whose elimination sums in another
//! order, a result differs by far less than the tolerance.

mod course;
mod elimination;
mod step;

use super::beat::CellBeat;
use super::cell_model::{BatchSettings, CellModel as _, CellOutcome, Paced, SideBySide};
use super::pacer::Pacer;
use super::settings::{CellMethod, SolveError};
use super::tomek_2019::{TomekModel, Variant, lanes::LANES};
use course::{Course, Moved};
use std::any::Any;
use step::{Lanes, TryStep};

/// Number of steps of all lanes between two calls of `goes_on`: a few milliseconds.
const ASKED_EVERY: u32 = 256;
/// Sample interval from which beats are read if none was requested, ms.
const SAMPLED_MS: f64 = 0.1;

/// A cell with its constants.
struct Member<'a> {
    model: &'a TomekModel,
    cell: &'a Paced,
    pacer: Pacer,
}

impl SideBySide for TomekModel {
    fn method(&self) -> CellMethod {
        CellMethod::Stiff
    }

    fn tells_beats(&self) -> bool {
        false
    }

    fn move_all(
        &self,
        cells: &[&Paced],
        settings: &BatchSettings,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<Result<CellOutcome, SolveError>>> {
        let members = members(cells);
        let arch = pulp::Arch::new();
        let mut outcomes = vec![None; cells.len()];
        // Cells with and without myofilaments have different states.
        let goes_on = moved::<true>(&members, settings, goes_on, &mut outcomes, |lanes| {
            arch.dispatch(TryStep(lanes));
        }) && moved::<false>(&members, settings, goes_on, &mut outcomes, |lanes| {
            arch.dispatch(TryStep(lanes));
        });
        goes_on.then(|| outcomes.into_iter().flatten().collect())
    }
}

/// The cells with their constants; protocols were checked when the cells were made.
fn members<'a>(cells: &[&'a Paced]) -> Vec<Member<'a>> {
    let member = |cell: &&'a Paced| {
        let model: &dyn Any = &*cell.model;
        let model: &TomekModel = model.downcast_ref()?;
        let pacer = Pacer::new(&model.stimulation(), cell.protocol).ok()?;
        Some(Member { model, cell, pacer })
    };
    cells.iter().filter_map(member).collect()
}

/// Adds the beats read from its samples to the outcome of a cell.
fn told(member: &Member<'_>, mut outcome: CellOutcome, settings: &BatchSettings) -> CellOutcome {
    let interval_ms = settings.sample_interval_ms.unwrap_or(SAMPLED_MS);
    let samples = &outcome.samples;
    let times: Vec<f64> = (0..samples.len()).map(|k| k as f64 * interval_ms).collect();
    let potential: Vec<f64> = samples.iter().map(|it| it.potential.unwrap_or(f64::NAN)).collect();
    let tension: Vec<f64> = samples.iter().map(|sample| sample.tension).collect();
    let stimuli = member.cell.protocol.stimulus_times();
    outcome.beats = CellBeat::of_samples(&times, &potential, &tension, stimuli);
    if settings.sample_interval_ms.is_none() {
        outcome.samples.clear();
    }
    outcome
}

/// Integrates all cells with myofilaments, or all without; false if interrupted.
fn moved<const LAND: bool>(
    members: &[Member<'_>],
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
    outcomes: &mut [Option<Result<CellOutcome, SolveError>>],
    try_step: impl Fn(&mut Lanes<LAND>),
) -> bool {
    let of_this_kind =
        |(_, it): &(usize, &Member<'_>)| (it.model.variant() == Variant::Land) == LAND;
    let interval_ms = settings.sample_interval_ms.unwrap_or(SAMPLED_MS);
    let mut queue = members.iter().enumerate().filter(of_this_kind).peekable();
    if queue.peek().is_none() {
        return true;
    }
    let mut lanes = Lanes::new(settings.method.tolerance);
    let mut next = |lanes: &mut Lanes<LAND>, lane| {
        let (index, Member { model, cell, pacer }) = queue.next()?;
        let course = Course::start(model, pacer, cell.duration_ms, interval_ms, lanes, lane);
        Some((index, course))
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
                Moved::ToTheEnd => Ok(told(&members[*index], course.outcome(), settings)),
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
