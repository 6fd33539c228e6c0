//! The published sets against a published solution and against restitution.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::common;

use common::{falls_through, shared_data};
use myospring::cell::CellModel;
use myospring::cell::bueno_orovio_2008::{Variant, model};
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{CellMethod, SolverSettings, solve};
use std::sync::Arc;

const PULSE: Stimulus = Stimulus::Pulse { amplitude: 0.5, duration_ms: 1.0 };

/// Root mean square of the difference in u from the solution of another group, each 1 ms.
fn rms_of_u(settings: SolverSettings) -> Option<f64> {
    let file = shared_data("cell-models/bueno_2007_epi_tidy.csv")?;
    let rows: Vec<[f64; 5]> =
        csv::Reader::from_path(file).unwrap().deserialize().map(Result::unwrap).collect();
    let protocol = Protocol { start_ms: 10.0, ..Protocol::once(PULSE) };
    let duration = rows[rows.len() - 1][0];
    let trace = solve(&model(Variant::Epi), protocol, settings, duration, 1.0).unwrap();
    assert_eq!(trace.time_ms.len(), rows.len());
    let square = |(row, u): (&[f64; 5], &f64)| (row[1] - u) * (row[1] - u);
    let sum: f64 = rows.iter().zip(&trace.potential).map(square).sum();
    Some((sum / rows.len() as f64).sqrt())
}

#[test]
fn the_epicardial_set_follows_the_published_solution() {
    let Some(rms) = rms_of_u(SolverSettings::default()) else { return };
    println!("rms of u: {rms:e}");
    assert!(rms < 5e-4, "{rms:e}");
}

/// Variant, APD90 at 2000, 1000 and 500 ms, highest u at 1000 ms; as printed.
const RESTITUTION: [(Variant, [f64; 3], f64); 5] = [
    (Variant::Epi, [272.0, 268.9, 258.9], 1.464),
    (Variant::Endo, [275.2, 263.0, 236.9], 1.506),
    (Variant::M, [454.6, 412.7, 315.9], 1.552),
    (Variant::Pb, [398.6, 394.8, 361.8], 1.370),
    (Variant::Tnnp, [293.0, 293.0, 283.8], 1.487),
];

/// APD90 and highest u of the last of 30 beats, forward Euler with 0.005 ms.
///
/// The definition was found by reproducing the printed digits: from the steepest upstroke (the
/// start of the step with the largest rise) to 90 % of the way from the beat's peak back to the
/// potential just before its stimulus.
fn last_beat(variant: Variant, cycle_length_ms: f64) -> (f64, f64) {
    let step_ms = 0.005;
    let settings = SolverSettings { step_ms, ..SolverSettings::of(CellMethod::ForwardEuler) };
    let protocol = Protocol { start_ms: 0.0, cycle_length_ms, beats: 30, ..Protocol::once(PULSE) };
    let model = Arc::new(model(variant));
    let mut cell = CellIntegrator::new(model.clone(), protocol, settings).unwrap();
    let start_ms = 29.0 * cycle_length_ms;
    let steps = (cycle_length_ms / step_ms).round() as usize;
    let times: Vec<f64> = (0..=steps).map(|step| step as f64 * step_ms).collect();
    let mut course = |time: &f64| {
        cell.advance_to(start_ms + time, 1.0, 0.0).unwrap();
        model.potential(cell.state()).unwrap()
    };
    let u: Vec<f64> = times.iter().map(&mut course).collect();

    let peak = u.iter().copied().fold(0.0, f64::max);
    let rise = |step: usize| u[step + 1] - u[step];
    let upstroke =
        (0..steps).reduce(|best, i| if rise(i) > rise(best) { i } else { best }).unwrap();
    let end = falls_through(&times, &u, u[0] + 0.1 * (peak - u[0]), times[upstroke]);
    (end - times[upstroke], peak)
}

#[test]
#[ignore = "slow"]
fn the_sets_shorten_at_fast_pacing_as_computed_elsewhere() {
    if crate::common::left_to_full() {
        return;
    }
    std::thread::scope(|scope| {
        for (variant, apds, u_max) in RESTITUTION {
            scope.spawn(move || {
                for (cycle, printed) in [2000.0, 1000.0, 500.0].into_iter().zip(apds) {
                    let (apd, peak) = last_beat(variant, cycle);
                    println!("{variant:?} at {cycle} ms: APD90 {apd:.3} ms, peak {peak:.6}");
                    // Half the last printed digit, and what one step can shift.
                    assert!((apd - printed).abs() < 0.055, "{variant:?} {cycle}: {apd}");
                    if cycle == 1000.0 {
                        assert!((peak - u_max).abs() < 0.0005, "{variant:?}: {peak}");
                    }
                }
            });
        }
    });
}
