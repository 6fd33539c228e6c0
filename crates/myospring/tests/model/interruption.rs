//! Long work ends early wherever it is asked to: at the first question, at the last one, and in between.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::beat::quick_twitch;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{SolveError, SolverSettings, solve_while};
use myospring::cell::steady::{self, SteadyError};
use myospring::cell::{CellModel, coelho_2021};
use myospring::integrate::Method;
use myospring::integrate::quasi_static::{Path, PathError, Tolerance};
use myospring::interruption::Interruption;
use myospring::mesh::{Mesh, built_in, lattice};
use myospring::simulation::{SetupError, Simulation, StopReason};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Ends work at the question of this number, the first is 0.
fn at(number: usize) -> (Interruption, Arc<AtomicUsize>) {
    let asked = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&asked);
    (Interruption::when(move || counted.fetch_add(1, Ordering::Relaxed) >= number), asked)
}

/// Work that says whether it was interrupted, and how often it must ask at least.
struct Trial {
    what: &'static str,
    least: usize,
    work: fn(Interruption) -> bool,
}

fn cell() -> Mesh {
    lattice::from_outline(&built_in::adult_ventricular(), Some(5.0)).unwrap().0
}

fn simulation(interruption: Interruption) -> Simulation {
    Simulation { interruption, duration: 20.0, ..quick_twitch(cell()) }
}

fn stopped(simulation: &Simulation) -> bool {
    match simulation.build() {
        Err(SetupError::Interrupted) => true,
        Err(error) => panic!("{error}"),
        Ok(ready) => {
            let outcome = ready.run(|_| true);
            // What was recorded is kept.
            let kept = outcome.recording.samples.len();
            match outcome.stop {
                Some(StopReason::Interrupted { time }) => {
                    assert!(time <= 20.0 && (kept > 0 || time == 0.0), "{time} {kept}");
                    true
                }
                Some(reason) => panic!("{reason}"),
                None => false,
            }
        }
    }
}

fn paced() -> (Arc<dyn CellModel>, Protocol) {
    let model: Arc<dyn CellModel> = Arc::new(coelho_2021::model());
    let protocol = Protocol { cycle_length_ms: 600.0, ..Protocol::once(model.default_stimulus()) };
    (model, protocol)
}

const TRIALS: [Trial; 7] = [
    Trial { what: "a run in time", least: 80, work: |asked| stopped(&simulation(asked)) },
    Trial {
        what: "a run along the path of equilibria",
        least: 100,
        work: |asked| {
            let mut simulation = simulation(asked);
            simulation.numerics.method = Method::QuasiStatic;
            stopped(&simulation)
        },
    },
    Trial {
        what: "a run from equilibrium to equilibrium",
        least: 800,
        work: |asked| {
            let mut simulation = simulation(asked);
            simulation.numerics.method = Method::QuasiStatic;
            simulation.wave_speed = Some(10.0);
            stopped(&simulation)
        },
    },
    Trial {
        what: "a path",
        least: 100,
        work: |asked| {
            let (body, system) = simulation(Interruption::default()).mechanics();
            let path = Path::start(&system, &body, Tolerance::default(), &asked);
            match path.and_then(|mut path| path.extend(50.0)) {
                Err(PathError::Interrupted) => true,
                Err(error) => panic!("{error}"),
                Ok(()) => false,
            }
        },
    },
    Trial {
        what: "equilibria up to a shortening",
        least: 100,
        work: |asked| match simulation(asked).equilibria_to(0.1, Tolerance::default()) {
            Err(SetupError::Interrupted) => true,
            Err(error) => panic!("{error}"),
            Ok(_) => false,
        },
    },
    Trial {
        what: "pacing",
        least: 500,
        work: |asked| {
            let (model, protocol) = paced();
            match steady::pace(&model, protocol, SolverSettings::default(), 1e-3, &asked) {
                Err(SteadyError::Interrupted(_)) => true,
                Err(error) => panic!("{error}"),
                Ok(_) => false,
            }
        },
    },
    Trial {
        what: "a cell alone",
        least: 600,
        work: |asked| {
            let (model, protocol) = paced();
            let settings = SolverSettings::default();
            match solve_while(&*model, protocol, settings, 600.0, 1.0, |_| !asked.is_requested()) {
                Err(SolveError::Interrupted(_)) => true,
                Err(error) => panic!("{error}"),
                Ok(_) => false,
            }
        },
    },
];

#[test]
fn long_work_asks_often_and_ends_at_whichever_question_it_is_told_to() {
    for Trial { what, least, work } in TRIALS {
        let (interruption, asked) = at(usize::MAX);
        assert!(!work(interruption), "{what}");
        let questions = asked.load(Ordering::Relaxed);
        assert!(questions >= least, "{what}: {questions} questions");
        for number in [0, questions / 2, questions - 1] {
            let (interruption, asked) = at(number);
            assert!(work(interruption), "{what}: question {number} of {questions}");
            // Those who heard of it may ask again on their way out.
            let after = asked.load(Ordering::Relaxed) - number;
            assert!(after <= 20, "{what}: {after} questions after it");
        }
    }
}

#[test]
fn a_path_goes_on_after_an_interruption_with_the_same_bits() {
    let (body, system) = simulation(Interruption::default()).mechanics();
    let tolerance = Tolerance::default();
    let (never, asked) = at(usize::MAX);
    let mut whole = Path::start(&system, &body, tolerance, &never).unwrap();
    whole.extend(50.0).unwrap();
    let (interruption, _) = at(asked.load(Ordering::Relaxed) - 10);
    let mut path = Path::start(&system, &body, tolerance, &interruption).unwrap();
    assert_eq!(path.extend(50.0), Err(PathError::Interrupted));
    assert!(!path.reaches(50.0));
    let mut path = Path::resume(&system, &body, path.into_parts(), &never);
    path.extend(50.0).unwrap();
    for tension in [10.0, 33.3, 50.0] {
        assert_eq!(path.positions(tension), whole.positions(tension));
    }
}
