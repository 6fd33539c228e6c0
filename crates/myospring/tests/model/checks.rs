//! What is asked of a run before it begins, and said of it afterwards.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use crate::exchange::{Toy, strip};
use myospring::analysis::bands::{self, BandPosition};
use myospring::cell::pacing::Protocol;
use myospring::cell::{self, CellModel, TensionKind};
use myospring::exchange::{Activation, Sites};
use myospring::integrate::Method;
use myospring::integrate::engine::Loops;
use myospring::integrate::verlet::Integrator;
use myospring::mechanics::active::ActiveLaw;
use myospring::mechanics::material::myofilament_material;
use myospring::mechanics::support::SupportKind;
use myospring::mesh::lattice;
use myospring::simulation::{Pace, Simulation};
use std::sync::Arc;

#[test]
fn more_shapes_than_there_is_memory_for_are_refused_with_an_interval_that_would_do() {
    let mut simulation = Simulation::new(lattice::rectangle(60, 50, 0.5).unwrap());
    simulation.numerics.frame_interval = 0.5;
    simulation.duration = 49_500.0;
    let error = simulation.build().err().unwrap().to_string();
    // 99 002 shapes of 61 x 51 masses, two numbers of 8 bytes for each.
    assert!(error.contains("99002 shapes of 3111 masses take 4.9 GB of memory"), "{error}");
    assert!(error.contains("a frame interval of 1 ms or more"), "{error}");
    simulation.numerics.frame_interval = 1.0;
    assert!(simulation.build().is_ok());
}

#[test]
fn a_cell_that_is_strained_beyond_what_the_law_was_made_for_is_said_and_no_other() {
    let beaten = |peak_tension: f64, support: SupportKind| {
        let mut simulation = Simulation::new(strip());
        simulation.numerics.method = Method::QuasiStatic;
        (simulation.peak_tension, simulation.support) = (peak_tension, support);
        let ready = simulation.build().unwrap();
        ready.warnings_after(&ready.run(|_| true))
    };
    let ends = SupportKind::ClampedEnds;
    // 12 % and 18 % shorter; what isometric tests ask of a cell.
    for (tension, support) in
        [(50.0, SupportKind::MassCentre), (75.0, SupportKind::MassCentre), (100.0, ends)]
    {
        assert_eq!(beaten(tension, support), [""; 0], "{tension} kPa");
    }
    // A quarter and more.
    for tension in [120.0, 250.0] {
        let warnings = beaten(tension, SupportKind::MassCentre);
        let [warning] = &warnings[..] else { panic!("{warnings:?}") };
        assert!(
            warning.contains("% of the cell is strained by more than 20 % along its fibres"),
            "{warning}"
        );
        assert!(
            warning.contains("% shorter): the material law was not made for that"),
            "{warning}"
        );
    }
    // One that pushes: strips grow longer.
    let warnings = beaten(-150.0, SupportKind::MassCentre);
    assert!(warnings.iter().any(|warning| warning.contains("% longer)")), "{warnings:?}");
}

/// Warnings of a beat of the strip, and how fast it shortened.
fn paced(cell: Arc<dyn CellModel>, support: SupportKind) -> (Vec<String>, Pace, Option<f64>) {
    let mut simulation = Simulation {
        protocol: Protocol::once(cell.default_stimulus()),
        support,
        ..Simulation::new(strip())
    };
    simulation.numerics.method = Method::QuasiStatic;
    if cell.feels_stretch() {
        simulation.material = myofilament_material();
    }
    simulation.cell = cell;
    let ready = simulation.build().unwrap();
    let outcome = ready.run(|_| true);
    let beats = outcome.beats();
    let ratio = beats[0].value("shortening_rate_over_peak");
    (ready.warnings_after(&outcome), simulation.pace(&beats), ratio)
}

#[test]
fn a_model_that_shortens_otherwise_than_measured_cells_says_so_of_itself_and_its_run_has_no_warning()
 {
    let band = bands::band("shortening_rate_over_peak").unwrap();
    for cell in cell::models() {
        // A membrane alone moves nothing, and ToR-ORd has its own tests.
        if cell.tension_kind() == TensionKind::None || cell.name().starts_with("tor_ord") {
            continue;
        }
        let (name, known) = (cell.name().to_owned(), cell.known_departure());
        let (warnings, pace, ratio) = paced(cell, SupportKind::MassCentre);
        let Some(ratio) = ratio else { continue };
        match known {
            Some(known) => {
                // What the model says is what its beat does: of this strip or of a cell.
                let said = known.shortening_rate_over_peak;
                assert!((ratio / said - 1.0).abs() < 0.03, "{name}: {ratio}, said are {said}");
                assert_eq!(pace, Pace::AsItsModel(known), "{name}");
            }
            None => {
                assert_eq!(
                    (band.place(ratio), pace),
                    (BandPosition::In, Pace::AsMeasured),
                    "{name}: {ratio}"
                );
            }
        }
        assert_eq!(warnings, [""; 0], "{name}");
    }
    // A cell that is held has another rate.
    let (warnings, pace, _) = paced(cell::model("coelho_2021").unwrap(), SupportKind::ClampedEnds);
    assert_eq!((warnings, pace), (Vec::new(), Pace::AsMeasured));
}

#[test]
fn parameters_that_shorten_a_cell_as_nothing_measured_does_are_warned_of() {
    let with = |model: &str, changes: &[(&str, f64)]| {
        let published = cell::model(model).unwrap();
        let mut parameters = published.parameters().clone();
        for &(name, factor) in changes {
            let value = parameters.get(name).unwrap();
            parameters.set(name, factor * value).unwrap();
        }
        paced(published.with_parameters(parameters).unwrap(), SupportKind::MassCentre)
    };
    // The rate constant of the tension twice as large; cross-bridges and troponin thrice as fast.
    let fast = [("k_uw", 3.0), ("k_ws", 3.0), ("k_u", 3.0), ("k_TRPN", 3.0)];
    for (model, changes) in [("coelho_2021", &[("c_0", 2.0)][..]), ("land_2017", &fast[..])] {
        let (warnings, pace, ratio) = with(model, changes);
        assert!(matches!(pace, Pace::Unexplained { .. }), "{model}: {ratio:?} {pace:?}");
        let said = warnings.iter().find(|warning| warning.starts_with("no measured cell")).unwrap();
        assert!(said.contains("this fast") && said.contains("8 to 13 1/s"), "{said}");
    }
    // Slower, and still faster than measured: as its model.
    let (warnings, pace, ratio) = with("coelho_2021", &[("c_0", 0.8)]);
    assert!(matches!(pace, Pace::AsItsModel(_)) && warnings.is_empty(), "{ratio:?} {warnings:?}");
}

#[test]
fn a_run_that_cannot_be_is_refused_with_the_setting_its_value_and_its_bound() {
    type Change = Box<dyn Fn(&mut Simulation)>;
    let mesh = strip();
    let triangles = mesh.simplices.len();
    let error = |change: &dyn Fn(&mut Simulation)| {
        let mut simulation = Simulation::new(mesh.clone());
        change(&mut simulation);
        simulation.build().err().map(|error| error.to_string()).unwrap_or_default()
    };
    let field = move |count: usize| -> Option<Box<dyn Activation>> {
        Some(Box::new(Toy::new(Sites::PerElement(count), 1.0, |_, _| 1.0)))
    };
    let cases: Vec<(Change, &str)> = vec![
        (Box::new(|s| s.numerics.time_step = Some(0.0)), "the time step is 0 ms"),
        (Box::new(|s| s.numerics.time_step = Some(f64::NAN)), "the time step is NaN ms"),
        (Box::new(|s| s.numerics.exchange_interval = 0.0), "the exchange interval is 0 ms"),
        (Box::new(|s| s.numerics.output_interval = 0.6), "no multiple of the exchange interval"),
        (Box::new(|s| s.numerics.frame_interval = 5.2), "no multiple of the output interval"),
        (Box::new(|s| s.duration = 600.1), "no multiple of the exchange interval"),
        (Box::new(|s| s.duration = 200_000.1), "no multiple of the exchange interval"),
        (Box::new(|s| s.duration = 1e7), "at most 5e6 samples"),
        (Box::new(|s| s.duration = -1.0), "the duration is -1 ms"),
        (Box::new(|s| s.fibres.truncate(3)), "the list of fibres has 3 entries"),
        (Box::new(|s| s.fibres[7] = [2.0, 0.0]), "the length of the fibre of triangle 7 is 2"),
        (Box::new(|s| s.long_axis = [1.0, 1.0]), "the length of the long axis"),
        (Box::new(|s| s.material.thickness = f64::INFINITY), "the thickness is inf um"),
        (Box::new(|s| s.peak_tension = f64::NAN), "the peak tension is NaN kPa"),
        (Box::new(|s| s.myofibril_content = Some(vec![1.0; 2])), "content of myofibrils has 2"),
        (
            Box::new(move |s| s.myofibril_content = Some(vec![0.0; triangles])),
            "of all triangles together is 0",
        ),
        (
            Box::new(|s| {
                let toy = Toy::new(Sites::Whole, f64::NAN, |_, _| 0.0);
                s.activation = Some(Box::new(toy));
            }),
            "the strongest tension of the activation is NaN kPa",
        ),
        (
            Box::new(|s| {
                s.numerics.method = Method::QuasiStatic;
                s.numerics.engine.loops = Loops::Fused;
            }),
            "equilibria need no engine",
        ),
        (
            Box::new(move |s| s.myofibril_content = Some(vec![-0.5; triangles])),
            "the content of myofibrils of triangle 0 is -0.5",
        ),
        (Box::new(move |s| s.activation = field(5)), "the activation has 5 entries"),
        (
            Box::new(move |s| {
                s.activation = field(triangles);
                s.active = ActiveLaw::Ends;
            }),
            "do not go together",
        ),
        (
            Box::new(move |s| {
                s.activation = field(triangles);
                s.numerics.engine.loops = Loops::Fused;
            }),
            "engine = \"fused\"",
        ),
        (
            Box::new(|s| {
                s.numerics.method = Method::Verlet(Integrator::VelocityVerlet);
                s.numerics.engine.loops = Loops::Fused;
            }),
            "velocity Verlet",
        ),
    ];
    for (change, message) in cases {
        let said = error(&*change);
        assert!(said.contains(message), "{message}: {said}");
    }
    assert_eq!(error(&|_| ()), "");
}
