//! The largest rate of the potential is that of the model's own equations, however often it is
//! sampled.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::integrator::CellIntegrator;
use myospring::cell::pacing::Protocol;
use myospring::cell::solve::{CellMethod, SolverSettings};
use myospring::cell::{self, CellModel, Input};
use myospring::integrate::Method as Way;
use myospring::mesh::lattice;
use myospring::simulation::Simulation;
use std::sync::Arc;

fn in_a_run(model: &Arc<dyn CellModel>, settings: SolverSettings, output_ms: f64) -> f64 {
    let mut simulation = Simulation {
        cell: Arc::clone(model),
        protocol: Protocol::once(model.default_stimulus()),
        ..Simulation::new(lattice::rectangle(6, 2, 10.0).unwrap())
    };
    simulation.numerics.method = Way::QuasiStatic;
    simulation.numerics.cell = Some(settings);
    simulation.numerics.output_interval = output_ms;
    let beats = simulation.build().unwrap().run(|_| true).beats();
    beats[0].value("maximum_upstroke_velocity").unwrap()
}

/// The largest ionic rate along a fine solution, in mV or without unit, per ms.
fn by_the_equations(model: &Arc<dyn CellModel>, settings: SolverSettings) -> f64 {
    let protocol = Protocol::once(model.default_stimulus());
    let mut cell = CellIntegrator::new(Arc::clone(model), protocol, settings).unwrap();
    let potential = |state: &[f64]| {
        model.membrane_potential_mv(state).or_else(|| model.potential(state)).unwrap()
    };
    let mut rates = vec![0.0; model.states().len()];
    let mut largest = f64::NEG_INFINITY;
    for step in 0..6000 {
        cell.advance_to(49.9 + 1e-3 * f64::from(step), 1.0, 0.0).unwrap();
        let state = cell.state().to_vec();
        model.derivatives(&state, &Input::REST, &mut rates);
        let mut later = state.clone();
        later.iter_mut().zip(&rates).for_each(|(value, rate)| *value += 1e-6 * rate);
        largest = largest.max((potential(&later) - potential(&state)) / 1e-6);
    }
    largest
}

#[test]
fn it_does_not_depend_on_the_sampling() {
    for (name, settings) in [
        ("coelho_2021", SolverSettings::default()),
        ("coelho_2021", SolverSettings::of(CellMethod::Adaptive)),
        ("bueno_orovio_2008_epi", SolverSettings::default()),
        ("bueno_orovio_2008_epi", SolverSettings::of(CellMethod::Adaptive)),
        ("tor_ord_land", SolverSettings::of(CellMethod::Stiff)),
    ] {
        let model = cell::model(name).unwrap();
        let expected = by_the_equations(&model, settings);
        for output_ms in [0.5, 1.0] {
            let found = in_a_run(&model, settings, output_ms);
            // The largest rate lies between two steps.
            assert!((found / expected - 1.0).abs() < 5e-3, "{name}: {found} and {expected}");
        }
    }
}
