//! Land's myofilaments in a cell: isometric and unloaded twitches, against numbers of independent programs.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::block::{Load, Twitch, YOUNG, rest, torord_calcium, twitch};
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::land_2017::Land2017;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::solve;
use myospring::cell::{CellModel as _, Input};
use myospring::integrate::Method;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::material::{Stiffness, myofilament_material};
use myospring::mechanics::support::SupportKind;
use myospring::mesh::{built_in, lattice};
use myospring::simulation::{Numerics, Simulation, StretchFelt};
use std::sync::Arc;

fn unloaded(model: Land2017, interval_ms: f64, lag_ms: f64, young: f64) -> Twitch {
    twitch(&Arc::new(model), &Load::None, interval_ms, lag_ms, young)
}

#[test]
fn the_block_that_the_numbers_are_for_shortens_as_published() {
    for (tension, shortening) in [(50.0, 12.0), (40.0, 9.96), (30.0, 7.75)] {
        let found = 100.0 * (1.0 - rest(tension, 348.6, &|_| 0.0));
        assert!((found - shortening).abs() < 5e-3, "{tension} kPa: {found} %");
    }
}

#[test]
fn an_unloaded_twitch_is_that_of_independent_programs() {
    // Two programs: 10.12 and 10.12 %, 1.134 and 1.132 lengths/s, 163 and 163.0 ms, 112.5 and 112.1 ms.
    let twitch = unloaded(Land2017::published(), 0.5, 1.0, YOUNG);
    assert!((twitch.peak() - 10.12).abs() < 5e-3, "{} %", twitch.peak());
    assert!((twitch.largest_rate() - 1.132).abs() < 2e-3, "{}/s", twitch.largest_rate());
    assert!((twitch.time_of_peak() - 163.0).abs() <= 0.5, "{} ms", twitch.time_of_peak());
    assert!((twitch.relaxation(0.5) - 112.3).abs() <= 0.7, "{} ms", twitch.relaxation(0.5));
    let strongest = twitch.tension.iter().copied().fold(0.0, f64::max);
    assert!((strongest - 11.83).abs() < 5e-3, "{strongest} kPa");
}

/// The built-in cell with the material for myofilaments, stimulated at 0 ms.
pub(crate) fn cell(method: Method, exchange_interval: f64, support: SupportKind) -> Simulation {
    let model = Land2017::published();
    let (mesh, _) = lattice::from_outline(&built_in::adult_ventricular(), Some(5.0)).unwrap();
    let usual = Simulation::new(mesh);
    Simulation {
        protocol: Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) },
        material: myofilament_material(),
        support,
        duration: 400.0,
        numerics: Numerics {
            method,
            exchange_interval,
            output_interval: 1.0,
            ..usual.numerics.clone()
        },
        cell: Arc::new(model),
        ..usual
    }
}

fn shortening(simulation: &Simulation) -> Vec<f64> {
    let outcome = simulation.build().unwrap().run(|_progress| true);
    assert_eq!(outcome.stop, None);
    outcome.recording.samples.iter().map(|sample| sample.shortening_pct).collect()
}

#[test]
fn tension_and_stretch_are_found_together_at_any_exchange_interval() {
    let free = |method, interval| shortening(&cell(method, interval, SupportKind::MassCentre));
    let fine = free(Method::QuasiStatic, 0.05);
    let peak = fine.iter().copied().fold(0.0, f64::max);
    // The flat cell widens a little otherwise than the block.
    assert!((peak - 10.12).abs() < 0.05, "{peak} %");
    for interval in [1.0, 0.25] {
        let off = largest_difference(&free(Method::QuasiStatic, interval), &fine);
        // Second order: 2.4e-5 and 1.5e-6 of the peak.
        assert!(off < 1e-4 * peak, "{interval} ms: {off} of {peak} %");
    }
    let moving = free(Method::Verlet(Integrator::StoermerVerlet), 0.25);
    // It begins without the little that calcium at rest pulls, and lags by some 0.02 ms: 2.1e-4.
    let off = largest_difference(&moving[20..], &fine[20..]);
    assert!(off < 1e-3 * peak, "in time: {off} of {peak} %");
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

#[test]
fn a_cell_without_a_potential_records_none_but_its_calcium_and_its_crossbridges() {
    let outcome = cell(Method::QuasiStatic, 1.0, SupportKind::MassCentre).build().unwrap();
    let outcome = outcome.run(|_progress| true);
    let samples = &outcome.recording.samples;
    assert!(samples.iter().all(|sample| sample.u.is_none() && sample.vm_mv.is_none()));
    let beats = outcome.beats();
    assert!(beats[0].action_potential.is_empty());
    let signals = &outcome.recording.signals;
    let names: Vec<&str> = signals.iter().map(|signal| &*signal.name).collect();
    assert_eq!(names, ["Ca_i", "XS", "XW", "CaTRPN", "TmB", "zeta_s", "zeta_w"]);
    let calcium = &signals[0].values;
    // From the start of the stimulus on: 0.0632 uM at rest, 0.4391 above it after 51.6 ms.
    assert_eq!(calcium[0], 0.0632);
    let highest = calcium.iter().copied().fold(0.0, f64::max);
    assert!((highest - 0.5023).abs() < 1e-4 && calcium[52] == highest, "{highest} uM");
    assert!(signals[1].values[150] > 5.0 * signals[1].values[0]);
}

#[test]
fn a_cell_with_tension_at_rest_stands_still_until_it_is_stimulated() {
    // Ten times as soft, so that the tension at rest shortens it visibly.
    let soft = |method, interval| {
        let cell = cell(method, interval, SupportKind::MassCentre);
        let mut material = cell.material.clone();
        material.stiffness = Stiffness::YoungModulus(0.1 * material.young_modulus());
        material.area_modulus *= 0.1;
        let protocol = Protocol { start_ms: 20.0, ..cell.protocol };
        Simulation { protocol, material, duration: 300.0, ..cell }
    };
    let at_rest = |felt| {
        let moving = soft(Method::Verlet(Integrator::StoermerVerlet), 0.25);
        let moving = Simulation { stretch_felt: felt, duration: 20.0, ..moving };
        let outcome = moving.build().unwrap().run(|_progress| true);
        assert!(outcome.stop.is_none(), "{:?}", outcome.stop);
        let samples = outcome.recording.samples;
        let energy = samples.iter().map(|sample| sample.kinetic_energy_fj).fold(0.0, f64::max);
        (samples[0], energy)
    };
    let resting = soft(Method::QuasiStatic, 0.25);
    let resting = resting.build().unwrap().run(|_progress| true);
    let rest = &resting.recording.samples[0];
    assert!(rest.shortening_pct > 0.1, "{}", rest.shortening_pct);
    for felt in [StretchFelt::Cell, StretchFelt::Triangle] {
        let (first, kinetic) = at_rest(felt);
        // Along equilibria lengths are interpolated between load steps.
        assert!((first.length_um - rest.length_um).abs() < 1e-4, "{first:?} {rest:?}");
        assert!(kinetic < 1e-6 * first.elastic_energy_fj, "{kinetic} {first:?}");
    }
}

#[test]
fn calcium_begins_anew_with_each_stimulus() {
    let model = Land2017::published();
    let protocol = Protocol {
        start_ms: 10.0,
        cycle_length_ms: 400.0,
        beats: 3,
        ..Protocol::once(model.default_stimulus())
    };
    let trace = solve(&model, protocol, model.usual_settings(), 1400.0, 1.0).unwrap();
    let calcium = trace.variable("Ca_i").unwrap();
    assert_eq!(calcium[..10], [0.0632; 10]);
    for at in [0, 50, 399] {
        // At the stimulus itself the course is at its start.
        assert_eq!(calcium[10 + at], calcium[410 + at]);
        assert!((calcium[10 + at] - calcium[810 + at]).abs() < 1e-12);
    }
    assert!(trace.potential.is_empty() && trace.membrane_potential_mv.is_none());
}

/// A strip with half as many myofibrils in one half.
fn weak_half() -> Simulation {
    let mesh = lattice::rectangle(16, 3, 5.0).unwrap();
    let usual = cell(Method::QuasiStatic, 1.0, SupportKind::MassCentre);
    let half = |triangle| if mesh.centre(triangle)[0] < 40.0 { 0.5 } else { 1.0 };
    Simulation {
        myofibril_content: Some(mesh.simplices.iter().map(half).collect()),
        stretch_felt: StretchFelt::Triangle,
        duration: 300.0,
        numerics: Numerics { frame_interval: 150.0, ..usual.numerics.clone() },
        cell: usual.cell.clone(),
        protocol: usual.protocol,
        material: usual.material.clone(),
        ..Simulation::new(mesh)
    }
}

#[test]
fn triangles_that_feel_their_own_stretch_are_the_whole_cell_where_all_are_alike() {
    let whole =
        Simulation { myofibril_content: None, stretch_felt: StretchFelt::Cell, ..weak_half() };
    let each = Simulation { stretch_felt: StretchFelt::Triangle, ..whole.clone() };
    let (whole, each) = (shortening(&whole), shortening(&each));
    let peak = whole.iter().copied().fold(0.0, f64::max);
    // A uniform strip deforms homogeneously: what is left is the path's interpolation.
    let off = largest_difference(&whole, &each);
    assert!(off < 1e-5 * peak, "{off} of {peak} %");
}

#[test]
#[ignore = "slow"]
fn triangles_that_differ_are_found_at_any_exchange_interval_and_in_time() {
    let run = |method, exchange_interval: f64| {
        let simulation = weak_half();
        let numerics = Numerics { method, exchange_interval, ..simulation.numerics.clone() };
        shortening(&Simulation { numerics, ..simulation })
    };
    let fine = run(Method::QuasiStatic, 0.25);
    let peak = fine.iter().copied().fold(0.0, f64::max);
    let off = largest_difference(&run(Method::QuasiStatic, 1.0), &fine);
    assert!(off < 1e-3 * peak, "{off} of {peak} %");
    if crate::common::left_to_full() {
        return;
    }
    let moving = run(Method::Verlet(Integrator::StoermerVerlet), 0.25);
    let off = largest_difference(&moving[20..], &fine[20..]);
    // 1.7e-3: the halves swing a little where the motion is in time.
    assert!(off < 4e-3 * peak, "in time: {off} of {peak} %");
}

#[test]
fn held_at_three_lengths_on_the_calcium_of_torord_it_twitches_as_in_an_independent_program() {
    let model = Arc::new(Land2017::published().with_trace(torord_calcium()));
    for (stretch, peak, at, steepest) in
        [(0.9, 9.73, 155.1, 11.9), (1.0, 24.03, 169.3, 10.8), (1.1, 56.12, 188.9, 9.7)]
    {
        let protocol = Protocol { start_ms: 0.0, ..Protocol::once(model.default_stimulus()) };
        let settings = model.usual_settings();
        let mut cell = CellIntegrator::new(model.clone(), protocol, settings).unwrap();
        let tensions: Vec<f64> = (0..=7000)
            .map(|step| {
                cell.advance_to(0.1 * f64::from(step), stretch, 0.0).unwrap();
                model.tension(cell.state(), &Input { stretch, ..Input::REST })
            })
            .collect();
        let highest = tensions.iter().copied().fold(0.0, f64::max);
        let time = 0.1 * tensions.iter().position(|value| *value == highest).unwrap() as f64;
        let rise = tensions.windows(2).map(|pair| (pair[1] - pair[0]) / 0.1).fold(0.0, f64::max);
        // That program took its own translation of ToR-ORd, whose first beat is 0.1 % off its hundredth.
        assert!((highest / peak - 1.0).abs() < 1e-3, "{stretch}: {highest} kPa");
        assert!((time - at).abs() < 0.2, "{stretch}: {time} ms");
        let found = 1e3 * rise / highest;
        assert!((found - steepest).abs() < 0.06, "{stretch}: {found} 1/s");
    }
}

#[test]
fn an_unloaded_twitch_on_the_calcium_of_torord_is_that_of_an_independent_program() {
    let with_trace = || Land2017::published().with_trace(torord_calcium());
    let twitch = unloaded(with_trace(), 0.5, 1.0, YOUNG);
    assert!((twitch.peak() - 9.93).abs() < 0.02, "{} %", twitch.peak());
    // Printed twice, 1.114 and 1.116 lengths/s, 166 and 167 ms, 120 and 119.5 ms.
    assert!((twitch.largest_rate() - 1.115).abs() < 4e-3, "{}/s", twitch.largest_rate());
    assert!((twitch.time_of_peak() - 166.5).abs() <= 1.0, "{} ms", twitch.time_of_peak());
    assert!((twitch.relaxation(0.5) - 119.8).abs() <= 1.0, "{} ms", twitch.relaxation(0.5));
    assert!((twitch.relaxation(0.9) - 230.0).abs() <= 2.0, "{} ms", twitch.relaxation(0.9));
    let back = twitch.largest_relengthening();
    assert!((back - 0.593).abs() < 4e-3, "{back} lengths/s");
    // Stiffer and softer cells.
    for (young, peak) in [(40.0, 14.6), (80.0, 11.1), (150.0, 8.0)] {
        let found = unloaded(with_trace(), 1.0, 1.0, young).peak();
        assert!((found - peak).abs() < 0.06, "{young} kPa: {found} %");
    }
}
