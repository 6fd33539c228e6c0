//! Runs that share a path of equilibria and the course of a cell have the bits that each has alone.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use myospring::cell::solve::SolverSettings;
use myospring::cell::{self, CellModel, TensionKind};
use myospring::exchange::{ActivationBounds, WholeCell};
use myospring::integrate::quasi_static::Tolerance;
use myospring::mesh::lattice;
use myospring::recording::Recording;
use myospring::simulation::Simulation;
use std::sync::Arc;

fn strip() -> Simulation {
    Simulation { duration: 150.0, ..Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap()) }
}

/// The run with a cell that shares nothing.
fn alone(simulation: &Simulation) -> Recording {
    let (model, peak) = (Arc::clone(&simulation.cell), simulation.peak_tension);
    let scale = match model.tension_kind() {
        TensionKind::Relative { published_peak } => peak / published_peak,
        _ => 1.0,
    };
    let bounds = ActivationBounds { tension: 3.0 * peak, ..Default::default() };
    let (start, settings) = (simulation.start_state.as_deref(), simulation.cell_settings());
    let cell = WholeCell::new(model, start, simulation.protocol, settings, scale, bounds).unwrap();
    let simulation = Simulation { activation: Some(Box::new(cell)), ..simulation.clone() };
    let outcome = simulation.run_quasi_static(Tolerance::default(), |_progress| true).unwrap();
    assert!(outcome.stop.is_none());
    outcome.recording
}

type Change<'a> = (&'a str, &'a dyn Fn(&mut Simulation));

#[test]
fn runs_one_after_another_have_the_bits_of_runs_alone() {
    let model = |name: &str| cell::model(name).unwrap();
    let slower = |model: &Arc<dyn CellModel>| {
        let mut parameters = model.parameters().clone();
        parameters.set("c_0", 0.8 * parameters.get("c_0").unwrap()).unwrap();
        model.with_parameters(parameters).unwrap()
    };
    let mut simulation = strip();
    let mut path = simulation.shared_path(Tolerance::default()).unwrap();
    let changes: [Change<'_>; 12] = [
        ("first", &|_| {}),
        ("peak tension", &|it| it.peak_tension = 30.0),
        ("the same model made anew", &|it| it.cell = model("coelho_2021")),
        ("a longer run", &|it| it.duration = 200.0),
        ("mechanics", &|it| it.material.thickness *= 1.5),
        ("a parameter", &|it| it.cell = slower(&it.cell)),
        ("peak tension of a changed model", &|it| it.peak_tension = 20.0),
        ("protocol", &|it| it.protocol.start_ms = 20.0),
        ("start", &|it| it.start_state = Some(vec![0.0, 0.9, 0.9, 0.0, 0.0, 0.1])),
        ("interval", &|it| it.numerics.exchange_interval = 0.5),
        ("method", &|it| it.numerics.cell = Some(SolverSettings::default())),
        ("another model", &|it| it.cell = model("bueno_orovio_2008_endo")),
    ];
    let mut before: Option<Recording> = None;
    for (what, change) in changes {
        change(&mut simulation);
        path = path.for_mechanics_of(&simulation, Tolerance::default()).unwrap();
        let together = path.prepare(&simulation).unwrap().run(|_progress| true).recording;
        assert!(together == alone(&simulation), "{what}");
        // Steps lie on one grid whatever the interval.
        let is_same = ["the same model made anew", "interval"].contains(&what);
        assert_eq!(before.is_some_and(|before| before == together), is_same, "{what}");
        before = Some(together);
    }
}
