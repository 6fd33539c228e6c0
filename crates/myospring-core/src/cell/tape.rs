//! Equations compiled to a flat list of operations, for one cell and for many side by side.
//!
//! A [`graph`] holds every operation once, with constants folded; derivatives are further
//! operations of the same graph. [`compile`] turns it into a [`Tape`](compile::Tape): instructions
//! on rows of numbers, a number for each lane. What does not change while a cell is integrated is
//! computed once per cell.
//!
//! [`OnTape`] integrates many cells by the method of [`stiff`](super::settings::CellMethod::Stiff)
//! steps: eight together, each with its own parameters, pacing, time and step; a cell that has
//! reached its end is replaced by the next one. Lanes are independent, and no operation is fused,
//! so **the result of a cell is bitwise the same** alone, in any batch, in any order and with any
//! vector units (AVX-512, AVX2 or none, chosen at run time). Compared with the same cell by
//! [`CellIntegrator`](super::integrator::CellIntegrator), whose elimination sums in another order, a
//! result differs by far less than the tolerance.

mod compile;
mod course;
mod derivative;
mod elimination;
mod evaluate;
pub(super) mod graph;
mod member;
mod program;
mod step;
#[cfg(test)]
mod tests;
mod traced;
mod values;

pub(super) use member::Compiled;
pub(super) use program::{Outside, Program};
pub(super) use traced::Traced;

use super::beat::CellBeat;
use super::cell_model::{BatchSettings, CellModel, CellOutcome, Paced, SideBySide};
use super::pacer::Pacer;
use super::settings::{CellMethod, SolveError};
use course::{Course, Moved};
use member::Member;
use std::any::Any;
use std::sync::Arc;
use step::{LANES, Lanes, TryStep};

/// Number of steps of all lanes between two calls of `goes_on`: a few milliseconds.
const ASKED_EVERY: u32 = 256;
/// Sample interval from which beats are read if none was requested, ms.
const SAMPLED_MS: f64 = 0.1;

/// A model whose cells are integrated side by side on the tape of its equations.
pub(super) trait OnTape: CellModel + Sized {
    /// Its equations with its numbers.
    fn compiled(&self) -> Compiled;
}

impl<M: OnTape> SideBySide for M {
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
        let arch = pulp::Arch::new();
        moved(&members::<M>(cells), settings, goes_on, |lanes: &mut Lanes<LANES>| {
            arch.dispatch(TryStep(lanes));
        })
    }
}

/// The cells with their equations; protocols were checked when the cells were made.
fn members<'a, M: OnTape>(cells: &[&'a Paced]) -> Vec<Member<'a>> {
    let member = |cell: &&'a Paced| {
        let model: &dyn Any = &*cell.model;
        let compiled = model.downcast_ref::<M>()?.compiled();
        let pacer = Pacer::new(&cell.model.stimulation(), cell.protocol).ok()?;
        Some(Member { cell, compiled, pacer })
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

/// Integrates all cells, those of one program together; `None` if interrupted.
fn moved<const N: usize>(
    members: &[Member<'_>],
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
    try_step: impl Fn(&mut Lanes<N>),
) -> Option<Vec<Result<CellOutcome, SolveError>>> {
    let mut outcomes: Vec<Option<Result<CellOutcome, SolveError>>> = vec![None; members.len()];
    while let Some(first) = outcomes.iter().position(Option::is_none) {
        let program = &members[first].compiled.program;
        let same = |(_, it): &(usize, &Member<'_>)| Arc::ptr_eq(&it.compiled.program, program);
        let queue = members.iter().enumerate().skip(first).filter(same);
        let mut lanes = Lanes::new(program, settings.method.tolerance);
        if !of_one_program(queue, &mut lanes, settings, goes_on, &mut outcomes, &try_step) {
            return None;
        }
    }
    Some(outcomes.into_iter().flatten().collect())
}

/// Integrates cells of one program; false if interrupted.
fn of_one_program<'a, const N: usize>(
    mut queue: impl Iterator<Item = (usize, &'a Member<'a>)>,
    lanes: &mut Lanes<N>,
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
    outcomes: &mut [Option<Result<CellOutcome, SolveError>>],
    try_step: &impl Fn(&mut Lanes<N>),
) -> bool {
    let interval_ms = settings.sample_interval_ms.unwrap_or(SAMPLED_MS);
    let mut next = |lanes: &mut Lanes<N>, lane| {
        let (index, member) = queue.next()?;
        Some((index, member, Course::start(member, interval_ms, lanes, lane)))
    };
    let mut courses: [Option<(usize, &Member<'_>, Course<'_>)>; N] =
        std::array::from_fn(|lane| next(lanes, lane));
    let mut steps = 0_u32;
    while courses.iter().any(Option::is_some) {
        steps = steps.wrapping_add(1);
        if steps.is_multiple_of(ASKED_EVERY) && !goes_on() {
            return false;
        }
        try_step(lanes);
        for lane in 0..N {
            let Some((index, member, course)) = &mut courses[lane] else { continue };
            let outcome = match course.follow(lanes, lane) {
                Moved::On => continue,
                Moved::ToTheEnd => Ok(told(member, course.outcome(), settings)),
                Moved::Nowhere(error) => Err(error),
            };
            outcomes[*index] = Some(outcome);
            courses[lane] = next(lanes, lane);
        }
    }
    true
}
