//! Many cells of the minimal model at once: the adaptive method in vector registers.
//!
//! [`LANES`] cells are integrated together, each with its own parameters, pacing, time and step; a
//! cell that has reached its end is replaced by the next one. A lane does the same operations as
//! [`adaptive`](super::adaptive), none of them fused, so **the result of a cell is bitwise the
//! same** alone, in any batch, in any order and with any vector units (AVX-512, AVX2 or none,
//! chosen at run time).

use super::adaptive::{Course, Lanes, Task, stalled, task};
use super::cell_model::{BatchSettings, CellOutcome, CellSample, Paced, SideBySide};
use super::description::Input;
use super::minimal::MinimalModel;
use super::settings::{CellMethod, SolveError};
use std::any::Any;

/// Number of cells that are integrated together.
const LANES: usize = 16;

/// Number of steps of all lanes between two calls of `goes_on`: a few milliseconds.
const ASKED_EVERY: u32 = 4096;

impl SideBySide for MinimalModel {
    fn method(&self) -> CellMethod {
        CellMethod::Adaptive
    }

    fn tells_beats(&self) -> bool {
        true
    }

    fn move_all(
        &self,
        cells: &[&Paced],
        settings: &BatchSettings,
        goes_on: &dyn Fn() -> bool,
    ) -> Option<Vec<Result<CellOutcome, SolveError>>> {
        let arch = pulp::Arch::new();
        let step = |lanes: &mut Lanes<LANES>| arch.dispatch(TryStep(lanes));
        side_by_side(&members(cells), settings, goes_on, step)
    }
}

/// A cell with its constants.
type Member<'a> = (&'a MinimalModel, Task);

/// The cells with their constants.
fn members<'a>(cells: &[&'a Paced]) -> Vec<Member<'a>> {
    let member = |cell: &&'a Paced| {
        let model: &dyn Any = &*cell.model;
        let model: &MinimalModel = model.downcast_ref()?;
        Some((model, task(model, cell.protocol, cell.duration_ms, None)))
    };
    cells.iter().filter_map(member).collect()
}

fn side_by_side<const N: usize>(
    cells: &[Member<'_>],
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
    try_step: impl Fn(&mut Lanes<N>),
) -> Option<Vec<Result<CellOutcome, SolveError>>> {
    let mut lanes = Lanes::<N>::new(settings.method.tolerance);
    let mut outcomes: Vec<Option<Result<CellOutcome, SolveError>>> = vec![None; cells.len()];
    let mut queue = 0..cells.len();
    let mut next = |lanes: &mut Lanes<N>, lane| {
        let index = queue.next()?;
        let task = Task { sample_interval_ms: settings.sample_interval_ms, ..cells[index].1 };
        Some((index, Course::start(&task, lanes, lane)))
    };
    let mut courses: [Option<(usize, Course)>; N] =
        std::array::from_fn(|lane| next(&mut lanes, lane));
    let mut steps = 0_u32;
    while courses.iter().any(Option::is_some) {
        steps = steps.wrapping_add(1);
        if steps.is_multiple_of(ASKED_EVERY) && !goes_on() {
            return None;
        }
        try_step(&mut lanes);
        for lane in 0..N {
            if lanes.attention[lane] == 0 {
                continue;
            }
            let Some((index, course)) = &mut courses[lane] else { continue };
            let model = cells[*index].0;
            let outcome = match course.attend(&mut lanes, lane) {
                Ok(false) => continue,
                Ok(true) => {
                    let states = std::mem::take(&mut course.watch.samples);
                    let sample = |state: &[f64; 6]| CellSample::of(model, state, &Input::REST);
                    Ok(CellOutcome {
                        beats: std::mem::take(&mut course.watch.beats),
                        samples: states.iter().map(sample).collect(),
                        steps: lanes.taken[lane] + course.steps,
                        refused: lanes.refused[lane],
                    })
                }
                Err(stuck) => Err(stalled(model.identity().name, &stuck)),
            };
            outcomes[*index] = Some(outcome);
            courses[lane] = next(&mut lanes, lane);
            if courses[lane].is_none() {
                lanes.sleep(lane);
            }
        }
    }
    Some(outcomes.into_iter().flatten().collect())
}

/// One step of all lanes, compiled for each kind of vector unit.
struct TryStep<'a, const N: usize>(&'a mut Lanes<N>);

impl<const N: usize> pulp::WithSimd for TryStep<'_, N> {
    type Output = ();

    #[inline(always)]
    #[allow(clippy::inline_always, reason = "a call from here would lose the vector units")]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        self.0.try_step();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell::batch::run;
    use crate::cell::cell_model::CellModel as _;
    use crate::cell::pacing::Protocol;
    use crate::cell::settings::SolverSettings;
    use crate::cell::{bueno_orovio_2008, coelho_2021};
    use std::sync::Arc;

    #[test]
    fn any_number_of_lanes_and_any_vector_units_give_the_same_bits() {
        let models =
            [coelho_2021::model(), bueno_orovio_2008::model(bueno_orovio_2008::Variant::M)];
        let cells: Vec<Paced> = (0..11)
            .map(|k| {
                let model = &models[k % 2];
                let protocol = Protocol {
                    start_ms: 3.7 * k as f64,
                    cycle_length_ms: 350.0 + 10.0 * k as f64,
                    beats: 2,
                    ..Protocol::once(model.default_stimulus())
                };
                Paced::new(Arc::new(model.clone()), protocol, 900.0).unwrap()
            })
            .collect();
        let method = SolverSettings::of(CellMethod::Adaptive);
        let settings = BatchSettings { method, sample_interval_ms: Some(3.0) };
        let expected = run(&cells, &settings).unwrap();
        assert!(expected.iter().all(Result::is_ok));
        let cells = members(&cells.iter().collect::<Vec<_>>());
        assert_eq!(
            side_by_side::<1>(&cells, &settings, &|| true, Lanes::try_step).unwrap(),
            expected
        );
        assert_eq!(
            side_by_side::<5>(&cells, &settings, &|| true, Lanes::try_step).unwrap(),
            expected
        );
        assert_eq!(
            side_by_side::<8>(&cells, &settings, &|| true, Lanes::try_step).unwrap(),
            expected
        );
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = pulp::x86::V3::try_new() {
            let step = |lanes: &mut Lanes<8>| pulp::Simd::vectorize(avx2, TryStep(lanes));
            assert_eq!(side_by_side(&cells, &settings, &|| true, step).unwrap(), expected);
        }
    }
}
