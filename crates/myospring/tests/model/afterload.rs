//! Cells whose ends are held: how hard they pull, stretched before the beat, and against a constant load.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::exchange::run;
use myospring::integrate::Method;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use myospring::recording::{END_FORCE, Sample};
use myospring::simulation::{Outcome, Simulation};

/// A strip of 100 x 20 um, 10 um thick.
fn strip(support: SupportKind) -> Simulation {
    let mut simulation = Simulation::new(lattice::rectangle(40, 8, 2.5).unwrap());
    simulation.numerics.method = Method::QuasiStatic;
    simulation.support = support;
    simulation
}

/// Samples, each with the force at the ends, nN.
fn pulls(outcome: &Outcome) -> Vec<(&Sample, f64)> {
    let signals = &outcome.recording.signals;
    let force = signals.iter().find(|signal| signal.name == END_FORCE).unwrap();
    outcome.recording.samples.iter().zip(force.values.iter().copied()).collect()
}

const SECTION_UM2: f64 = 20.0 * 10.0;

#[test]
fn an_isometric_cell_pulls_with_its_tension_times_its_section() {
    // Nothing moves: the active stress is the same everywhere, so it is borne by the clamps alone.
    let outcome = run(&strip(SupportKind::ClampedEnds));
    for (sample, force) in pulls(&outcome) {
        assert!(
            (force - sample.ta_kpa * SECTION_UM2).abs() < 1e-5,
            "{} ms: {force} nN",
            sample.t_ms
        );
    }
}

#[test]
fn a_cell_that_is_drawn_out_pulls_before_it_beats_and_its_tension_adds_to_that() {
    let mut simulation = Simulation { end_stretch: 1.001, ..strip(SupportKind::ClampedEnds) };
    simulation.mesh = lattice::rectangle(120, 8, 2.5).unwrap();
    simulation.fibres = vec![[1.0, 0.0]; simulation.mesh.simplices.len()];
    let outcome = run(&simulation);
    let (rest, passive) = pulls(&outcome)[0];
    // Half a grip at either end is no longer drawn out, so what lies between is by so much more.
    assert!((rest.length_um - 300.3).abs() < 1e-9 && rest.shortening_pct.abs() < 1e-9);
    // A sheet of springs (nu = 1/3) with an area modulus: bulk and shear modulus of the plane, E = 4 K G / (K + G).
    let (springs, area) = (simulation.material.young_modulus(), simulation.material.area_modulus);
    let (bulk, shear) =
        (springs / (2.0 * (1.0 - 1.0 / 3.0)) + area, springs / (2.0 * (1.0 + 1.0 / 3.0)));
    let modulus = 4.0 * bulk * shear / (bulk + shear);
    // The grips, each a twentieth of the length, do not stretch.
    let strain = 0.001 / 0.9;
    let ratio = passive / (modulus * SECTION_UM2 * strain);
    assert!((ratio - 1.0).abs() < 0.02, "{ratio}");

    let drawn = Simulation { end_stretch: 1.1, ..strip(SupportKind::ClampedEnds) };
    let outcome = run(&drawn);
    let pulls = pulls(&outcome);
    let most = pulls.iter().map(|(_, force)| *force).fold(0.0, f64::max);
    // The tension is a stress on the resting section along the stretched fibre.
    let active = (most - pulls[0].1) / (50.0 * SECTION_UM2);
    assert!((active - (1.0 + 0.1 / 0.9)).abs() < 0.03, "{active}");
}

#[test]
fn against_a_load_a_cell_waits_at_its_stop_then_shortens_under_that_force_alone() {
    let isometric = 50.0 * SECTION_UM2;
    let mut before = f64::INFINITY;
    for part in [0.1, 0.4, 0.8] {
        let load = part * isometric;
        let outcome = run(&strip(SupportKind::AfterloadedEnds { load }));
        let pulls = pulls(&outcome);
        let mut moved = 0;
        for pair in pulls.windows(2) {
            let ((last, _), (sample, force)) = (pair[0], pair[1]);
            if sample.shortening_pct > 1e-3 {
                // Between equilibria that were solved the force is interpolated.
                assert!((force / load - 1.0).abs() < 1e-5, "{} ms: {force}", sample.t_ms);
                moved += 1;
            } else {
                assert!(force < load * (1.0 + 1e-3), "{} ms: {force}", sample.t_ms);
            }
            // No leap where it leaves its stop and comes back to it.
            assert!((sample.length_um - last.length_um).abs() < 0.2);
        }
        let shortening = outcome.beats()[0].value("peak_shortening").unwrap();
        assert!(moved > 50 && shortening < before && shortening > 0.5, "{part}: {shortening} %");
        before = shortening;
        // What the tension has worked at the peak is stored in the cell or has lifted the load, and comes back.
        let last = outcome.recording.samples.last().unwrap();
        let most = pulls.iter().map(|(sample, _)| sample.active_work_fj).fold(0.0, f64::max);
        for (sample, _) in &pulls {
            let missing = sample.active_work_fj - sample.elastic_energy_fj;
            // The trapezoidal rule across the instants at which it leaves its stop and comes back.
            assert!(missing.abs() < 1e-3 * most, "{} ms: {missing} of {most} fJ", sample.t_ms);
        }
        assert!(last.shortening_pct.abs() < 1e-9);
    }
}
