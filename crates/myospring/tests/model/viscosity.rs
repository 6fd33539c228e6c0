//! A viscous cell along the path of equilibria: a lag of one state. How much slower it is than an elastic one stands beside
//! another program's in `verification/src/viscosity.rs`.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use super::exchange::run;
use myospring::cell::{self, pacing::Protocol};
use myospring::integrate::Method;
use myospring::integrate::quasi_static::Tolerance;
use myospring::mechanics::material::Stiffness;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use myospring::simulation::Simulation;

/// A strip, viscous or not.
fn strip(retardation_time: f64) -> Simulation {
    let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
    simulation.numerics.method = Method::QuasiStatic;
    simulation.material.retardation_time = retardation_time;
    simulation.duration = 800.0;
    simulation
}

#[test]
fn the_shape_is_that_of_a_tension_that_lags_by_the_retardation_time() {
    let time = 20.0;
    let simulation = strip(time);
    let samples = run(&simulation).recording.samples;
    let equilibria = simulation.equilibria(&[60.0], Tolerance::default()).unwrap();
    // The tension whose equilibrium has the length of a sample, by bisection.
    let shaping = |length: f64| {
        let (mut low, mut high) = (0.0, 60.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let longer = equilibria.follow(&[[0.0, middle]]).unwrap()[0].length_um > length;
            (low, high) = if longer { (middle, high) } else { (low, middle) };
        }
        low
    };
    let lagging: Vec<f64> = samples.iter().map(|sample| shaping(sample.length_um)).collect();
    for (k, sample) in samples.iter().enumerate().skip(1).step_by(25).take(23) {
        let rate = (lagging[k + 1] - lagging[k - 1]) / (samples[k + 1].t_ms - samples[k - 1].t_ms);
        let found = lagging[k] + time * rate;
        // Central differences over 2 ms of a tension that bends within some 30 ms.
        assert!((found - sample.ta_kpa).abs() < 0.1, "{} ms: {found}", sample.t_ms);
    }
}

#[test]
fn what_the_tension_has_worked_is_stored_or_lost_and_all_of_it_is_lost_in_the_end() {
    let samples = run(&strip(30.0)).recording.samples;
    let last = samples.last().unwrap();
    let most = samples.iter().map(|sample| sample.elastic_energy_fj).fold(0.0, f64::max);
    for pair in samples.windows(2) {
        // Never gained, but for the trapezoidal rule in the work.
        assert!(pair[1].dissipated_energy_fj >= pair[0].dissipated_energy_fj - 1e-9 * most);
    }
    assert!(last.elastic_energy_fj < 1e-3 * most);
    assert!((last.active_work_fj / last.dissipated_energy_fj - 1.0).abs() < 1e-3);
    assert!(last.dissipated_energy_fj > 0.1 * most);
}

#[test]
fn without_a_retardation_time_nothing_is_lost() {
    let samples = run(&strip(0.0)).recording.samples;
    assert!(samples.iter().all(|sample| sample.dissipated_energy_fj == 0.0));
}

#[test]
fn where_a_cell_cannot_lag_as_a_whole_it_is_refused() {
    let mut simulation = strip(20.0);
    simulation.support = SupportKind::ElasticBed { stiffness: 0.5 };
    let error = simulation.build().err().unwrap().to_string();
    assert!(error.contains("retardation time") && error.contains("support"), "{error}");
    simulation = strip(20.0);
    simulation.numerics.method = Simulation::new(simulation.mesh.clone()).numerics.method;
    let error = simulation.build().err().unwrap().to_string();
    assert!(error.contains("quasi-static"), "{error}");
}

#[test]
fn cells_that_feel_their_stretch_are_of_second_order_in_the_exchange_interval() {
    // A membrane that is slow to solve, given calcium, and a shape that lags.
    for (model, lag) in [("land_2017", 0.0), ("land_2017", 20.0), ("tor_ord_land", 0.0)] {
        let curve = |interval: f64| -> Vec<f64> {
            let mut simulation = strip(lag);
            simulation.cell = cell::model(model).unwrap();
            simulation.protocol =
                Protocol { start_ms: 40.0, ..Protocol::once(simulation.cell.default_stimulus()) };
            simulation.material.stiffness = Stiffness::YoungModulus(100.0);
            simulation.duration = 320.0;
            simulation.numerics.exchange_interval = interval;
            simulation.numerics.output_interval = 4.0;
            simulation.numerics.frame_interval = 320.0;
            run(&simulation).recording.samples.iter().map(|it| it.shortening_pct).collect()
        };
        let fine = curve(0.25);
        let most = fine.iter().copied().fold(0.0, f64::max);
        let off = |interval: f64| {
            let pairs = curve(interval).into_iter().zip(&fine);
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let [long, short] = [4.0, 2.0].map(off);
        assert!(long < 5e-3 * most, "{model}, lag {lag} ms: {long} of {most} %");
        // Four, but for higher orders; of first order it would be two.
        assert!(long > 3.0 * short, "{model}, lag {lag} ms: {long} and {short} %");
    }
}
