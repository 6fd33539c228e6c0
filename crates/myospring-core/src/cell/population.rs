//! Many cells at once: the adaptive method side by side in vector registers.
//!
//! [`LANES`] cells move together, each with parameters, pacing, time and step of its own; a cell that
//! has reached its end makes room for the next, so none waits for another. The arithmetic of a lane is
//! that of [`adaptive`], operation by operation without fused ones: **a cell has the same
//! bits** alone, in any company, in any order and with any vector units (AVX-512, AVX2 or none, chosen
//! when the program runs). Threads: call [`run`] on parts of the list; it uses the caller's only.
//!
//! # Example
//! Tension of cells whose slow inward current differs:
//! ```
//! use myospring::cell::population::{Cell, Settings, run};
//! use myospring::cell::{CellModel, coelho_2021, minimal::MinimalModel, pacing::Protocol};
//!
//! let mut cells = Vec::new();
//! for percent in [90.0, 100.0, 110.0] {
//!     let mut parameters = coelho_2021::parameters();
//!     parameters.set("tau_si", 1.76816 * percent / 100.0)?;
//!     let model = MinimalModel::new(coelho_2021::IDENTITY, parameters)?;
//!     cells.push(Cell::new(&model, Protocol::once(model.default_stimulus()), 600.0)?);
//! }
//! let outcomes = run(&cells, &Settings::default())?;
//! let apd: Vec<f64> =
//!     outcomes.iter().filter_map(|cell| cell.as_ref().ok()?.beats.last()?.apd90_ms).collect();
//! assert!(apd[0] > apd[1] && apd[1] > apd[2]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::adaptive::{self, Beat, Course, Lanes, Task, stalled, task};
use super::minimal::MinimalModel;
use super::pacing::Protocol;
use super::settings::{SolveError, validate_time};
use crate::analysis::capture::{self, Response};

/// Cells that move together.
pub const LANES: usize = 16;

/// So many steps of all lanes are made before it is asked again whether to go on: a few milliseconds.
const ASKED_EVERY: u32 = 4096;

/// One cell of a population: its constants, its pacing, and how long it is followed.
#[derive(Debug, Clone, PartialEq)]
pub struct Cell {
    model: &'static str,
    task: Task,
}

impl Cell {
    /// A cell in its initial state at 0 ms.
    ///
    /// # Errors
    /// A protocol that cannot be followed, or a duration that is not a positive finite time.
    pub fn new(
        model: &MinimalModel,
        protocol: Protocol,
        duration_ms: f64,
    ) -> Result<Self, SolveError> {
        protocol.validate()?;
        validate_time("duration", duration_ms)?;
        Ok(Self { model: model.identity().name, task: task(model, protocol, duration_ms, None) })
    }
}

/// Settings of a population.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Settings {
    /// Settings of the method; default tolerance 1e-5.
    pub method: adaptive::Settings,
    /// Time between samples of the state, ms, first at 0 ms; default none, no samples.
    pub sample_interval_ms: Option<f64>,
}

/// What one cell did.
#[derive(Debug, Clone, PartialEq)]
pub struct Outcome {
    /// Its beats, one per stimulus, in order.
    pub beats: Vec<Beat>,
    /// The sampled states `u, v, w, s, Ta_i, Ta`; sample `k` at `k` times the interval.
    pub samples: Vec<[f64; 6]>,
    /// Steps taken.
    pub steps: u64,
    /// Steps tried whose error was too large.
    pub refused: u64,
}

impl Outcome {
    /// Whether its beats are told by samples alone: a stimulus may have raised no action potential, or came while the
    /// tension of the beat before was higher than its own.
    pub fn needs_samples(&self) -> bool {
        let early = |beat: &Beat| beat.peak_tension_ms <= beat.stimulus_ms;
        let response = |beat: &Beat| {
            let (rest, peak) = (beat.resting_potential, beat.peak_potential);
            Response { rest, met: rest, peak, seen: true }
        };
        let responses: Vec<Response> = self.beats.iter().map(response).collect();
        let missed =
            capture::captures(&responses, capture::least_height("")).contains(&Some(false));
        missed || self.beats.iter().any(early)
    }
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
    settings.method.validate()?;
    if let Some(interval_ms) = settings.sample_interval_ms {
        validate_time("sample interval", interval_ms)?;
    }
    let arch = pulp::Arch::new();
    let step = |lanes: &mut Lanes<LANES>| arch.dispatch(TryStep(lanes));
    Ok(side_by_side(cells, settings, goes_on, step))
}

fn side_by_side<const N: usize>(
    cells: &[Cell],
    settings: &Settings,
    goes_on: &dyn Fn() -> bool,
    try_step: impl Fn(&mut Lanes<N>),
) -> Option<Vec<Result<Outcome, SolveError>>> {
    let mut lanes = Lanes::<N>::new(settings.method.tolerance);
    let mut outcomes: Vec<Option<Result<Outcome, SolveError>>> = vec![None; cells.len()];
    let mut queue = 0..cells.len();
    let mut next = |lanes: &mut Lanes<N>, lane| {
        let index = queue.next()?;
        let task = Task { sample_interval_ms: settings.sample_interval_ms, ..cells[index].task };
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
            let outcome = match course.attend(&mut lanes, lane) {
                Ok(false) => continue,
                Ok(true) => Ok(Outcome {
                    beats: std::mem::take(&mut course.watch.beats),
                    samples: std::mem::take(&mut course.watch.samples),
                    steps: lanes.taken[lane] + course.steps,
                    refused: lanes.refused[lane],
                }),
                Err(stuck) => Err(stalled(cells[*index].model, &stuck)),
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
    use crate::cell::cell_model::CellModel as _;
    use crate::cell::{bueno_orovio_2008, coelho_2021};

    #[test]
    fn any_number_of_lanes_and_any_vector_units_give_the_same_bits() {
        let models =
            [coelho_2021::model(), bueno_orovio_2008::model(bueno_orovio_2008::Variant::M)];
        let cells: Vec<Cell> = (0..11)
            .map(|k| {
                let model = &models[k % 2];
                let protocol = Protocol {
                    start_ms: 3.7 * k as f64,
                    cycle_length_ms: 350.0 + 10.0 * k as f64,
                    beats: 2,
                    ..Protocol::once(model.default_stimulus())
                };
                Cell::new(model, protocol, 900.0).unwrap()
            })
            .collect();
        let settings = Settings { sample_interval_ms: Some(3.0), ..Settings::default() };
        let expected = run(&cells, &settings).unwrap();
        assert!(expected.iter().all(Result::is_ok));
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
