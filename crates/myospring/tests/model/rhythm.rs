//! Trains at any cycle length: which stimuli raise an action potential, capture ratios and alternans, for every model and
//! every way through time.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::analysis::beats::Beats;
use myospring::analysis::capture;
use myospring::cell::pacing::{Protocol, Stimulus};
use myospring::cell::solve::{CellMethod, SolverSettings, solve};
use myospring::cell::{self, CellModel};
use myospring::integrate::Method as Way;
use myospring::mesh::lattice;
use myospring::simulation::{Numerics, Simulation};

const BEATS: u32 = 10;

/// Those with a potential, ToR-ORd by one of its variants.
const MODELS: [&str; 6] = [
    "coelho_2021",
    "bueno_orovio_2008_epi",
    "bueno_orovio_2008_endo",
    "bueno_orovio_2008_m",
    "bueno_orovio_2008_tnnp",
    "tor_ord_endo",
];

fn exact(model: &dyn CellModel) -> SolverSettings {
    if model.adaptive().is_some() {
        SolverSettings { tolerance: 1e-5, ..SolverSettings::of(CellMethod::Adaptive) }
    } else {
        SolverSettings { tolerance: 1e-3, ..SolverSettings::of(CellMethod::Stiff) }
    }
}

fn train(model: &dyn CellModel, cycle_length_ms: f64) -> Protocol {
    let once = Protocol::once(model.default_stimulus());
    Protocol { start_ms: 10.0, cycle_length_ms, beats: BEATS, ..once }
}

/// Potential of a train over time, and its unit.
fn potential(
    model: &(dyn CellModel + 'static),
    cycle_length_ms: f64,
    settings: SolverSettings,
) -> (Vec<f64>, Vec<f64>, &'static str) {
    let protocol = train(model, cycle_length_ms);
    let end = 10.0 + f64::from(BEATS) * cycle_length_ms;
    let trace = solve(model, protocol, settings, end, 0.5).unwrap();
    match trace.membrane_potential_mv {
        Some(potential) => (trace.time_ms, potential, "mV"),
        None => (trace.time_ms, trace.potential, ""),
    }
}

fn captured(
    model: &(dyn CellModel + 'static),
    cycle_length_ms: f64,
    settings: SolverSettings,
) -> String {
    let (times, potential, unit) = potential(model, cycle_length_ms, settings);
    let stimuli: Vec<f64> = train(model, cycle_length_ms).stimulus_times().collect();
    flags(&capture::of(&times, &potential, unit, &stimuli))
}

fn flags(captured: &[Option<bool>]) -> String {
    captured.iter().map(|captured| if captured.unwrap() { 'x' } else { '-' }).collect()
}

/// Whether each stimulus is followed by an upstroke, by the whole course of the potential and without the stimuli: it
/// rises through 80 % of the first action potential, after it was below 20 % of it.
fn upstrokes((times, potential): (&[f64], &[f64]), stimuli: &[f64]) -> String {
    let rest = potential[0];
    let first_end = times.partition_point(|time| *time < stimuli[1]);
    let height = potential[..first_end].iter().copied().fold(f64::MIN, f64::max) - rest;
    let (mut armed, mut at) = (true, Vec::new());
    for (time, value) in times.iter().zip(potential) {
        let part = (value - rest) / height;
        if armed && part > 0.8 {
            armed = false;
            at.push(*time);
        }
        armed |= part < 0.2;
    }
    let beat = |(place, start): (usize, &f64)| {
        let end = stimuli.get(place + 1).copied().unwrap_or(f64::INFINITY);
        if at.iter().any(|time| (*start..end).contains(time)) { 'x' } else { '-' }
    };
    stimuli.iter().enumerate().map(beat).collect()
}

#[test]
fn captured_stimuli_are_those_with_an_upstroke_for_every_model_at_every_cycle_length() {
    let cycles = [200.0, 250.0, 300.0, 350.0, 400.0, 500.0, 700.0, 1000.0];
    let mut missing = 0;
    for name in MODELS {
        let model = cell::model(name).unwrap();
        for cycle in cycles {
            let (times, potential, unit) = potential(&*model, cycle, exact(&*model));
            let stimuli: Vec<f64> = train(&*model, cycle).stimulus_times().collect();
            let expected = upstrokes((&times, &potential), &stimuli);
            let found = flags(&capture::of(&times, &potential, unit, &stimuli));
            assert_eq!(found, expected, "{name} at {cycle} ms");
            missing += usize::from(found.contains('-'));
            assert!(cycle < 700.0 || !found.contains('-'), "{name} at {cycle} ms: {found}");
        }
    }
    // The grid has both regimes.
    assert!(missing >= MODELS.len() && missing < MODELS.len() * cycles.len());
}

#[test]
#[ignore = "slow"]
fn methods_agree_on_which_stimuli_are_captured() {
    let mut sample = crate::common::Sample::one_in(2);
    for (name, cycles) in
        [("coelho_2021", [250.0, 300.0, 600.0]), ("tor_ord_endo", [200.0, 300.0, 600.0])]
    {
        let model = cell::model(name).unwrap();
        for cycle in cycles {
            if sample.leaves_out() {
                continue;
            }
            let expected = captured(&*model, cycle, exact(&*model));
            let gated = (!model.gates().is_empty()).then_some(CellMethod::RushLarsen);
            let methods = gated.into_iter().chain([model.usual_settings().method]);
            for method in methods {
                let settings = SolverSettings { method, ..model.usual_settings() };
                assert_eq!(
                    captured(&*model, cycle, settings),
                    expected,
                    "{name}, {cycle} ms, {method:?}"
                );
            }
        }
    }
}

#[test]
fn a_cell_paced_too_fast_beats_at_every_other_stimulus_in_time_and_along_equilibria() {
    let mut means = Vec::new();
    for way in [Way::QuasiStatic, Numerics::default().method] {
        let mut simulation = Simulation::new(lattice::rectangle(12, 3, 5.0).unwrap());
        let once = Protocol::once(simulation.cell.default_stimulus());
        simulation.protocol = Protocol { cycle_length_ms: 300.0, beats: 6, ..once };
        simulation.duration = 50.0 + 6.0 * 300.0;
        simulation.numerics.method = way;
        let ready = simulation.build().unwrap();
        let outcome = ready.run(|_progress| true);
        let beats: Beats = outcome.beats();
        assert_eq!(beats.rhythm.not_captured, [2, 4, 6]);
        let said = ready.warnings_after(&outcome).join("\n");
        assert!(
            said.contains("3 of 6 stimuli raised no action potential: numbers 2, 4 and 6"),
            "{said}"
        );
        assert!(said.contains("2:1 capture"), "{said}");
        let apd90 = beats.mean("action_potential_duration_90").unwrap();
        assert!((apd90 - 271.0).abs() < 5.0, "{apd90}");
        means.push(beats.mean("peak_shortening").unwrap());
    }
    // Inertia.
    assert!((means[0] / means[1] - 1.0).abs() < 0.01, "{means:?}");
}

#[test]
fn a_stimulus_below_the_threshold_is_missed() {
    let model = cell::model("coelho_2021").unwrap();
    let Stimulus::Jump { amplitude } = model.default_stimulus() else { panic!("it jumps") };
    let weak = Protocol {
        stimulus: Stimulus::Jump { amplitude: 0.2 * amplitude },
        ..train(&*model, 600.0)
    };
    let trace = solve(&*model, weak, exact(&*model), 3000.0, 0.5).unwrap();
    let stimuli: Vec<f64> = weak.stimulus_times().take(5).collect();
    let captured = capture::of(&trace.time_ms, &trace.potential, "", &stimuli);
    assert_eq!(captured, [Some(false); 5]);
}
