//! A population gives each cell the bits that it has alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::adaptive::{self, beats};
use myospring::cell::batch::{BatchSettings, CellOutcome, CellSample, Paced, TOGETHER, run};
use myospring::cell::bueno_orovio_2008::{self, Variant};
use myospring::cell::minimal::MinimalModel;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{CellMethod, SolveError, SolverSettings};
use myospring::cell::{CellModel, Input, coelho_2021};
use std::sync::Arc;

/// More cells than lanes: all sets, two parameters varied, cycle lengths from 250 to 2000 ms, jumps and
/// pulses, runs of 0.3 to 4 s.
fn motley() -> Vec<(MinimalModel, Protocol, f64)> {
    let mut cells = Vec::new();
    for index in 0..3 * TOGETHER + 5 {
        let vary = |row: f64, k: usize| row * (0.7 + 0.6 * ((index * k) % 11) as f64 / 10.0);
        let (identity, mut parameters) = match index % 6 {
            0 => (coelho_2021::IDENTITY, coelho_2021::parameters()),
            k => {
                let set =
                    [Variant::Epi, Variant::Endo, Variant::M, Variant::Pb, Variant::Tnnp][k - 1];
                (bueno_orovio_2008::identity(set), bueno_orovio_2008::parameters(set))
            }
        };
        for (k, name) in ["tau_si", "tau_so1"].into_iter().enumerate() {
            parameters.set(name, vary(parameters.get(name).unwrap(), 3 + 4 * k)).unwrap();
        }
        let model = MinimalModel::new(identity, parameters).unwrap();
        let protocol = Protocol {
            stimulus: model.default_stimulus(),
            start_ms: (index % 4) as f64 * 12.5,
            cycle_length_ms: [250.0, 400.0, 1000.0, 2000.0][index % 4],
            beats: 1 + (index % 3) as u32,
            // Some with an extra stimulus, from within the last beat to long after it.
            s2_interval_ms: (index % 5 == 0).then_some(60.0 + 17.3 * (index % 30) as f64),
        };
        cells.push((model, protocol, 300.0 + 61.7 * (index % 60) as f64));
    }
    cells
}

fn every(sample_interval_ms: Option<f64>) -> BatchSettings {
    BatchSettings { method: SolverSettings::of(CellMethod::Adaptive), sample_interval_ms }
}

fn paced(model: &MinimalModel, protocol: Protocol, duration_ms: f64) -> Result<Paced, SolveError> {
    Paced::new(Arc::new(model.clone()), protocol, duration_ms)
}

fn run_all(cells: &[(MinimalModel, Protocol, f64)], settings: &BatchSettings) -> Vec<CellOutcome> {
    let cells: Vec<Paced> =
        cells.iter().map(|(model, pacing, ms)| paced(model, *pacing, *ms).unwrap()).collect();
    run(&cells, settings).unwrap().into_iter().map(Result::unwrap).collect()
}

#[test]
fn a_cell_has_the_same_bits_alone_and_in_any_company() {
    let cells = motley();
    let together = run_all(&cells, &every(None));
    assert_eq!(together.len(), cells.len());
    for ((model, protocol, duration), outcome) in cells.iter().zip(&together) {
        let alone =
            beats(model, *protocol, adaptive::AdaptiveSettings::default(), *duration).unwrap();
        assert_eq!(outcome.beats, alone, "{}", model.name());
    }
    let mut backwards = cells.clone();
    backwards.reverse();
    let mut reversed = run_all(&backwards, &every(None));
    reversed.reverse();
    assert_eq!(together, reversed);
}

#[test]
fn sampled_states_are_those_of_one_cell_alone() {
    let cells = motley();
    let settings = every(Some(0.7));
    for ((model, protocol, duration), outcome) in cells.iter().zip(run_all(&cells, &settings)) {
        let alone = adaptive::solve(
            model,
            *protocol,
            adaptive::AdaptiveSettings::default(),
            *duration,
            0.7,
        )
        .unwrap();
        assert_eq!(outcome.samples.len(), alone.time_ms.len());
        for (sample, k) in outcome.samples.iter().zip(0..) {
            let expected: Vec<f64> = alone.states.iter().map(|column| column[k]).collect();
            let expected = CellSample::of(model, &expected, &Input::REST);
            assert_eq!(*sample, expected, "{} sample {k}", model.name());
        }
    }
}

#[test]
fn samples_do_not_change_the_beats() {
    let cells = motley();
    let often = every(Some(0.25));
    let (with, without) = (run_all(&cells, &often), run_all(&cells, &every(None)));
    for (with, without) in with.iter().zip(&without) {
        for (a, b) in with.beats.iter().zip(&without.beats) {
            // The peak of tension is that of the same cubics: equal but for where it was looked for.
            assert_eq!((a.stimulus_ms, a.apd90_ms), (b.stimulus_ms, b.apd90_ms));
            assert!((a.peak_tension / b.peak_tension - 1.0).abs() < 1e-12);
            assert!((a.peak_potential - b.peak_potential).abs() < 1e-12);
        }
    }
}

#[test]
fn a_cell_that_fails_has_its_error_and_leaves_the_others_alone() {
    let model = coelho_2021::model();
    let good = Protocol::once(model.default_stimulus());
    let bad = Protocol::once(Stimulus::Jump { amplitude: 1e200 });
    let cells: Vec<Paced> =
        (0..20).map(|k| paced(&model, if k == 7 { bad } else { good }, 600.0).unwrap()).collect();
    let outcomes = run(&cells, &every(None)).unwrap();
    let expected = outcomes[0].as_ref().unwrap();
    for (k, outcome) in outcomes.iter().enumerate() {
        if k == 7 {
            let stalled = |error: &SolveError| matches!(error, SolveError::Stalled { model, .. } if model == "coelho_2021");
            assert!(outcome.as_ref().is_err_and(stalled), "{outcome:?}");
        } else {
            assert_eq!(outcome.as_ref().unwrap(), expected);
        }
    }
}

#[test]
fn impossible_cells_and_settings_are_refused() {
    let model = coelho_2021::model();
    let good = Protocol::once(model.default_stimulus());
    assert!(run(&[], &every(None)).unwrap().is_empty());
    assert!(matches!(paced(&model, good, 0.0), Err(SolveError::Time { .. })));
    let late = Protocol { start_ms: -1.0, ..good };
    assert!(matches!(paced(&model, late, 1.0), Err(SolveError::Protocol(_))));
    let cell = paced(&model, good, 1.0).unwrap();
    let never = every(Some(0.0));
    assert!(matches!(run(std::slice::from_ref(&cell), &never), Err(SolveError::Time { .. })));
    let method = SolverSettings { tolerance: 1.0, ..SolverSettings::of(CellMethod::Adaptive) };
    let loose = BatchSettings { method, ..every(None) };
    assert!(matches!(run(&[cell], &loose), Err(SolveError::Tolerance { .. })));
}
