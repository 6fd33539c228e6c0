//! Methods, events and errors of the cell integrator, against the toy model's exact solution.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{CellMethod, SolveError, SolverSettings, solve};
use myospring::cell::{self, CellModel, Input, toy::ToyModel};
use std::sync::Arc;

const JUMP: Stimulus = Stimulus::Jump { amplitude: 1.0 };

fn error_of(method: CellMethod, step_ms: f64) -> f64 {
    let toy = ToyModel::published();
    let settings = SolverSettings { step_ms, ..SolverSettings::of(method) };
    let trace = solve(&toy, Protocol::once(JUMP), settings, 200.0, 10.0).unwrap();
    let error = |(t, ta): (&f64, &f64)| (ta - toy.tension_after_jump(1.0, t - 50.0)).abs();
    trace.time_ms.iter().zip(&trace.tension).map(error).fold(0.0, f64::max)
}

#[test]
fn every_method_has_its_order_on_smooth_equations() {
    for (method, order, step) in
        [(CellMethod::RungeKutta4, 4.0, 5.0), (CellMethod::ForwardEuler, 1.0, 0.1)]
    {
        let measured = (error_of(method, step) / error_of(method, step / 2.0)).log2();
        // The next term of the error shifts the measured order by a few per cent.
        assert!((measured - order).abs() < 0.06 * order, "{method:?}: {measured}");
    }
}

#[test]
fn stiff_steps_solve_the_toy_as_exactly_as_asked_between_their_ends_too() {
    let toy = ToyModel::published();
    for tolerance in [1e-3, 1e-5, 1e-7] {
        let settings = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
        let trace = solve(&toy, Protocol::once(JUMP), settings, 200.0, 0.3).unwrap();
        let error = |(t, ta): (&f64, &f64)| (ta - toy.tension_after_jump(1.0, t - 50.0)).abs();
        let largest = trace.time_ms.iter().zip(&trace.tension).map(error).fold(0.0, f64::max);
        assert!(largest < 5.0 * tolerance, "{tolerance:e}: {largest:e}");
    }
}

#[test]
fn the_default_settings_solve_the_toy_to_rounding() {
    let SolverSettings { method, step_ms, .. } = SolverSettings::default();
    // 40000 steps, each rounding by an epsilon of values below 1.
    assert!(error_of(method, step_ms) < 40_000.0 * f64::EPSILON);
}

#[test]
fn a_jump_acts_at_its_time_and_shows_in_the_state_at_that_time() {
    let toy: Arc<dyn CellModel> = Arc::new(ToyModel::published());
    let settings = SolverSettings { step_ms: 0.05, ..SolverSettings::of(CellMethod::ForwardEuler) };
    let mut cell = CellIntegrator::new(Arc::clone(&toy), Protocol::once(JUMP), settings).unwrap();
    cell.advance_to(49.999, 1.0, 0.0).unwrap();
    assert_eq!(cell.state(), [0.0, 0.0]);
    cell.advance_to(50.0, 1.0, 0.0).unwrap();
    assert_eq!((cell.time(), cell.state()), (50.0, &[1.0, 0.0][..]));
    let at_once = Protocol { start_ms: 0.0, ..Protocol::once(JUMP) };
    assert_eq!(
        CellIntegrator::new(Arc::clone(&toy), at_once, settings).unwrap().state(),
        [1.0, 0.0]
    );
}

/// Integrates the stimulus alone: a time constant so long that nothing else moves.
fn charge(protocol: Protocol, step_ms: f64, stops: &[f64]) -> f64 {
    let mut parameters = cell::toy::parameters();
    parameters.set("tau", 1e6).unwrap();
    let toy: Arc<dyn CellModel> = Arc::new(ToyModel::new(parameters).unwrap());
    let settings = SolverSettings { step_ms, ..SolverSettings::of(CellMethod::ForwardEuler) };
    let mut cell = CellIntegrator::new(Arc::clone(&toy), protocol, settings).unwrap();
    for stop in stops {
        cell.advance_to(*stop, 1.0, 0.0).unwrap();
        assert!((cell.time() - stop).abs() <= 1e-6 * step_ms);
    }
    cell.state()[0]
}

#[test]
fn no_event_is_missed_or_doubled_whatever_the_step_and_the_stops() {
    for duration_ms in [0.1, 0.3, 1.0, 1.0 / 3.0] {
        for step_ms in [0.05, 0.1, 0.07, 0.25, 3.0] {
            let train = Protocol {
                stimulus: Stimulus::Pulse { amplitude: 0.5, duration_ms },
                start_ms: 0.3,
                cycle_length_ms: 1.1,
                beats: 99,
                s2_interval_ms: Some(1.7),
            };
            let awkward: Vec<f64> = (1..=1500).map(|i| 0.1 * f64::from(i)).collect();
            for stops in [&[150.0][..], &awkward] {
                let expected = 100.0 * 0.5 * duration_ms;
                let given = charge(train, step_ms, stops);
                // The time constant of 1e6 ms leaks 1.5e-4 of the charge at most.
                assert!((given / expected - 1.0).abs() < 1.5e-4, "{step_ms}: {given} {expected}");
            }
        }
    }
}

#[test]
fn a_pulse_acts_at_its_start_and_not_at_its_end() {
    let pulse = Protocol {
        stimulus: Stimulus::Pulse { amplitude: 2.0, duration_ms: 1.0 },
        start_ms: 1.0,
        ..Protocol::once(Stimulus::Jump { amplitude: 0.0 })
    };
    let leak = 1e-5;
    for (until, expected) in [(1.0, 0.0), (1.5, 1.0), (2.0, 2.0), (3.0, 2.0)] {
        assert!((charge(pulse, 0.5, &[until]) - expected).abs() < leak, "at {until} ms");
    }
}

#[test]
fn steps_hit_round_times_exactly_and_stops_on_the_grid_do_not_change_a_bit() {
    let model = cell::coelho_2021::model();
    let protocol = Protocol::once(model.default_stimulus());
    for settings in [SolverSettings::default(), cell::coelho_2021::authors_step()] {
        let run = |stop_ms: f64| {
            let mut cell =
                CellIntegrator::new(Arc::new(model.clone()), protocol, settings).unwrap();
            let stops = (60.0 / stop_ms).round() as u32;
            for stop in 1..=stops {
                cell.advance_to(f64::from(stop) * stop_ms, 1.0, 0.0).unwrap();
            }
            assert_eq!(cell.time(), f64::from(stops) * stop_ms);
            cell.state().to_vec()
        };
        assert_eq!(run(60.0), run(0.05));
        assert_eq!(run(60.0), run(0.15));
    }
}

#[test]
fn stops_between_grid_points_keep_the_accuracy() {
    let model = cell::coelho_2021::model();
    let protocol = Protocol::once(model.default_stimulus());
    let run = |stop_ms: f64| {
        let mut cell =
            CellIntegrator::new(Arc::new(model.clone()), protocol, SolverSettings::default())
                .unwrap();
        let mut stop = 0;
        while cell.time() < 150.0 {
            stop += 1;
            cell.advance_to((f64::from(stop) * stop_ms).min(150.0), 1.0, 0.0).unwrap();
        }
        model.tension(cell.state(), &Input::REST)
    };
    let (plain, cut) = (run(150.0), run(0.0113));
    assert!((cut / plain - 1.0).abs() < 5e-4, "{plain} {cut}");
}

#[test]
fn a_state_that_leaves_the_numbers_is_named_with_value_and_time() {
    let model = cell::coelho_2021::model();
    let protocol = Protocol::once(model.default_stimulus());
    let settings = SolverSettings { step_ms: 50.0, ..SolverSettings::default() };
    let error = solve(&model, protocol, settings, 60_000.0, 50.0).unwrap_err();
    let SolveError::NotFinite { variable, value, time_ms, .. } = &error else {
        panic!("{error}");
    };
    assert!(!value.is_finite());
    let text = error.to_string();
    for part in [format!("`{variable}`"), "coelho_2021".into(), format!("{time_ms} ms")] {
        assert!(text.contains(&part), "{text}");
    }
}

#[test]
fn impossible_requests_are_refused() {
    let toy: Arc<dyn CellModel> = Arc::new(ToyModel::published());
    let rest = Protocol::rest();
    for step_ms in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let settings = SolverSettings { step_ms, ..SolverSettings::default() };
        assert!(matches!(solve(&*toy, rest, settings, 1.0, 1.0), Err(SolveError::Step { .. })));
    }
    let settings = SolverSettings::default();
    for (duration, interval) in [(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
        let result = solve(&*toy, rest, settings, duration, interval);
        assert!(matches!(result, Err(SolveError::Time { .. })));
    }
    let mut cell = CellIntegrator::new(Arc::clone(&toy), rest, settings).unwrap();
    cell.advance_to(1.0, 1.0, 0.0).unwrap();
    assert!(matches!(cell.advance_to(0.5, 1.0, 0.0), Err(SolveError::BackInTime { .. })));
    assert!(matches!(cell.advance_to(f64::NAN, 1.0, 0.0), Err(SolveError::BackInTime { .. })));
    assert!(matches!(cell.advance_to(2.0, 0.0, 0.0), Err(SolveError::Stretch { .. })));
    let rate = cell.advance_to(2.0, 1.0, f64::NAN);
    assert!(matches!(rate, Err(SolveError::StretchRate { .. })));
    for tolerance in [0.0, 1.0, f64::NAN] {
        let settings = SolverSettings { tolerance, ..SolverSettings::of(CellMethod::Stiff) };
        let refused = solve(&*toy, rest, settings, 1.0, 1.0);
        assert!(matches!(refused, Err(SolveError::Tolerance { .. })));
    }
    let endless = Protocol { start_ms: f64::NAN, ..Protocol::once(JUMP) };
    assert!(matches!(
        CellIntegrator::new(Arc::clone(&toy), endless, settings),
        Err(SolveError::Protocol(_))
    ));
}

#[test]
fn a_parameter_set_must_be_complete_and_its_peak_above_rest() {
    let model = cell::coelho_2021::model();
    let mut rows = model.parameters().rows().to_vec();
    rows.retain(|row| row.name != "tau_si");
    let set = myospring::parameter::ParameterSet::new(rows);
    let error = model.with_parameters(set).err().unwrap().to_string();
    assert!(error.contains("`coelho_2021` needs parameter `tau_si`"), "{error}");
    let mut set = model.parameters().clone();
    set.set("u_peak", -0.5).unwrap();
    let error = model.with_parameters(set).err().unwrap().to_string();
    assert!(error.contains("u_peak = -0.5 must be above u_rest = 0"), "{error}");
}

#[test]
fn a_changed_parameter_changes_the_beat() {
    let model = cell::model("coelho_2021").unwrap();
    let mut set = model.parameters().clone();
    set.set("c_0", 0.02).unwrap();
    let changed = model.with_parameters(set).unwrap();
    let (before, after) =
        (cell::solve::reference_beat(model.as_ref(), SolverSettings::default()).unwrap(), {
            cell::solve::reference_beat(changed.as_ref(), SolverSettings::default()).unwrap()
        });
    assert!(after.peak_tension > 1.1 * before.peak_tension, "{before:?} {after:?}");
}
