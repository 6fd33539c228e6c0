//! Parts of a cell that differ: sarcomeres of other lengths, and a stimulus that travels.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::exchange::run;
use crate::land_2017::cell;
use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::Protocol;
use myospring::cell::toy::ToyModel;
use myospring::cell::{CellModel, Input};
use myospring::integrate::Method;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use myospring::recording::Recording;
use myospring::simulation::{Simulation, StretchFelt};
use std::sync::Arc;

/// A strip whose ends are clamped: its tension is uniform as long as its parts are alike, and nothing moves.
fn held(stretch_felt: StretchFelt, resting_stretch: impl Fn(f64) -> f64) -> Simulation {
    let mesh = lattice::rectangle(8, 2, 5.0).unwrap();
    let usual = cell(Method::QuasiStatic, 1.0, SupportKind::ClampedEnds);
    let stretch = mesh.simplices.iter().map(|triangle| resting_stretch(mesh.centre(triangle)[0]));
    Simulation {
        resting_stretch: Some(stretch.collect()),
        stretch_felt,
        support: SupportKind::ClampedEnds,
        duration: 250.0,
        numerics: usual.numerics.clone(),
        cell: usual.cell.clone(),
        protocol: usual.protocol,
        material: usual.material.clone(),
        ..Simulation::new(mesh)
    }
}

fn recorded(simulation: &Simulation) -> Recording {
    run(simulation).recording
}

/// Tension of the cell model alone, held at a stretch, kPa, each ms.
fn alone(simulation: &Simulation, stretch: f64) -> Vec<f64> {
    let model = Arc::clone(&simulation.cell);
    let settings = simulation.cell_settings();
    let mut cell = CellIntegrator::new(model, simulation.protocol, settings).unwrap();
    let input = Input { stretch, ..Input::REST };
    (0..=250)
        .map(|ms| {
            cell.advance_to(f64::from(ms), stretch, 0.0).unwrap();
            cell.model().tension(cell.state(), &input)
        })
        .collect()
}

#[test]
fn sarcomeres_longer_at_rest_pull_as_a_cell_at_that_stretch() {
    for felt in [StretchFelt::Cell, StretchFelt::Triangle] {
        for stretch in [0.92, 1.0, 1.1] {
            let simulation = held(felt, |_| stretch);
            let alone = alone(&simulation, stretch);
            let highest = alone.iter().copied().fold(0.0, f64::max);
            let recording = recorded(&simulation);
            assert!(recording.samples.len() > 100);
            for sample in recording.samples.iter().filter(|sample| sample.t_ms.fract() == 0.0) {
                let off = (sample.ta_kpa - alone[sample.t_ms as usize]).abs();
                // Ends that are clamped leave the width next to them free to a hair.
                assert!(
                    off < 1e-6 * highest,
                    "{felt:?} {stretch}: {off} kPa at {} ms",
                    sample.t_ms
                );
            }
        }
    }
}

#[test]
fn a_whole_cell_feels_the_mean_of_its_sarcomeres_and_triangles_feel_their_own() {
    let halves = |x: f64| if x < 20.0 { 1.08 } else { 0.96 };
    let whole = held(StretchFelt::Cell, halves);
    let mean = alone(&whole, 1.02);
    for sample in recorded(&whole).samples.iter().filter(|sample| sample.t_ms.fract() == 0.0) {
        let off = (sample.ta_kpa - mean[sample.t_ms as usize]).abs();
        assert!(off < 1e-6 * 30.0, "{off} kPa at {} ms", sample.t_ms);
    }
    let each = held(StretchFelt::Triangle, halves);
    let middle = each.mesh.points[0].iter().position(|x| (x - 20.0).abs() < 1e-9).unwrap();
    let each = recorded(&each);
    let strongest = each.frames.iter().max_by(|a, b| a.ta_kpa.total_cmp(&b.ta_kpa)).unwrap();
    let tensions = strongest.ta_by_triangle_kpa.as_ref().unwrap();
    // The longer half draws the shorter one out, which brings their tensions together but not across.
    let (long, short) = (tensions[0], tensions[tensions.len() - 1]);
    assert!(long > 1.05 * short && short > 0.5 * long, "{long} and {short} kPa");
    // It is shorter at the peak than at rest, the other half longer.
    assert!(strongest.positions[0][middle] < 19.9, "{}", strongest.positions[0][middle]);
}

#[test]
fn a_stimulus_travels_along_the_cell_at_its_speed_and_each_place_has_the_tension_of_its_time() {
    let speed = 0.25;
    for method in [Method::QuasiStatic, crate::exchange::IN_TIME] {
        let mesh = lattice::rectangle(20, 2, 2.0).unwrap();
        // The toy rests until its stimulus; the others drift a little, and differ by it.
        let toy = ToyModel::published();
        let mut simulation = Simulation {
            protocol: Protocol::once(toy.default_stimulus()),
            cell: Arc::new(toy),
            duration: 400.0,
            ..Simulation::new(mesh.clone())
        };
        simulation.numerics.method = method;
        simulation.numerics.output_interval = 0.25;
        let together = recorded(&simulation);
        let at = |time: f64| {
            let place = time / simulation.numerics.output_interval;
            let (below, part) = (place.floor().max(0.0) as usize, place.fract());
            let tension = |k: usize| together.samples[k].ta_kpa;
            tension(below) + part * (tension(below + 1) - tension(below))
        };
        let wave = recorded(&Simulation { wave_speed: Some(speed), ..simulation.clone() });
        for frame in &wave.frames {
            let tensions = frame.ta_by_triangle_kpa.as_ref().unwrap();
            for (triangle, tension) in mesh.simplices.iter().zip(tensions) {
                let delay = mesh.centre(triangle)[0] / speed;
                let expected = if frame.t_ms < delay { 0.0 } else { at(frame.t_ms - delay) };
                // Samples each 0.25 ms with straight lines between them, and a kink where tension sets in.
                assert!((tension - expected).abs() < 0.01, "{tension} {expected} kPa");
            }
        }
        // The cell is never as short as when all of it pulls at once.
        let most = |recording: &Recording| {
            recording.samples.iter().map(|s| s.shortening_pct).fold(0.0, f64::max)
        };
        assert!(most(&wave) < 0.9 * most(&together) && most(&wave) > 0.3 * most(&together));
    }
}

#[test]
fn a_stretch_at_rest_that_no_cell_has_and_a_wave_that_stands_are_refused() {
    let refused = |simulation: Simulation| simulation.build().err().unwrap().to_string();
    let far = refused(held(StretchFelt::Triangle, |x| if x > 30.0 { 1.6 } else { 1.0 }));
    assert!(far.contains("the stretch at rest of triangle") && far.contains("is 1.6"), "{far}");
    let few = Simulation { resting_stretch: Some(vec![1.0]), ..held(StretchFelt::Cell, |_| 1.0) };
    let few = refused(few);
    assert!(few.contains("the stretch at rest has 1 entries"), "{few}");
    let still = Simulation { wave_speed: Some(0.0), ..held(StretchFelt::Cell, |_| 1.0) };
    let still = refused(still);
    assert!(still.contains("the speed of the wave is 0 um/ms"), "{still}");
}
