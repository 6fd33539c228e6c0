//! Figures and tables of made-up beats.
#![allow(clippy::unwrap_used)] // In tests a panic is the message.

#[path = "../common/mod.rs"]
mod common;

mod drawn;
mod film;
mod members;
mod overlay;
mod page;
mod paraview;
mod synthetic;

use drawn::{Pixels, size};
use myospring::mesh::Mesh;
use myospring::output::csv::traces;
use myospring::output::field::Fields;
use myospring::output::figure::{
    ContractionOptions, DrawnCell, Figure, FigureError, Shape, action_potential_and_tension,
    cell_shapes, contraction, key_shapes, mesh, overview, work_loop,
};
use myospring::recording::{END_FORCE, Frame, Recording, Sample, Signal};
use synthetic::{STIMULUS, elongated, recording, roundish};

const X: [f64; 2] = [1.0, 0.0];

fn beat(mesh: &Mesh) -> Recording {
    recording(mesh, X, 50.0, false)
}

/// One fibre direction everywhere.
fn along(mesh: &Mesh, fibre: [f64; 2]) -> Vec<[f64; 2]> {
    vec![fibre; mesh.simplices.len()]
}

fn cell<'a>(mesh: &'a Mesh, fibres: &[[f64; 2]]) -> Result<DrawnCell<'a>, FigureError> {
    DrawnCell::new(Fields::new(mesh, fibres, None)?, None)
}

fn all_figures(mesh_of_run: &Mesh, run: &Recording, fibre: [f64; 2]) -> Vec<Figure> {
    let options = ContractionOptions {
        stimulus_times_ms: vec![STIMULUS],
        reference_band: Some(([7.0, 12.0], "adult ventricular myocytes, unloaded")),
    };
    let drawn = cell(mesh_of_run, &along(mesh_of_run, fibre)).unwrap();
    vec![
        action_potential_and_tension(run, &[STIMULUS]).unwrap(),
        cell_shapes(&drawn, &key_shapes(run, &[STIMULUS])).unwrap(),
        contraction(&[("50 kPa", run)], &options).unwrap(),
        mesh(mesh_of_run).unwrap(),
        overview(&drawn, run, &[STIMULUS]).unwrap(),
    ]
}

#[test]
fn every_figure_has_the_width_of_a_column_and_draws_at_the_resolution_asked_for() {
    let (round, axis) = roundish(4.0);
    let long = elongated(4.0);
    let figures = [
        all_figures(&long, &beat(&long), X),
        all_figures(&round, &recording(&round, axis, 40.0, true), axis),
    ]
    .concat();
    for figure in figures {
        let [width, height] = size(&figure);
        let mm = width * 25.4 / 96.0;
        // SVG sizes are written with two digits after the point.
        assert!((mm - 85.0).abs() < 0.01 || (mm - 178.0).abs() < 0.01, "{mm} mm");
        let png = Pixels::of(&figure, 150.0);
        let expected = [width, height].map(|length| (length * 150.0 / 96.0).round() as usize);
        assert_eq!(png.size, expected);
        assert!(png.colours.iter().any(|pixel| pixel.iter().all(|&level| level < 0x40)), "no ink");
        let edges = [[0, 0], [expected[0] - 1, 0], [0, expected[1] - 1], expected.map(|at| at - 1)];
        for edge in edges {
            assert_eq!(png.at(edge), [255; 3]);
        }
    }
}

#[test]
fn labels_carry_their_units() {
    let long = elongated(2.0);
    let run = beat(&long);
    let drawn = cell(&long, &along(&long, X)).unwrap();
    let mv = recording(&long, X, 50.0, true);
    let shapes = key_shapes(&run, &[STIMULUS]);
    let curves = [("30 kPa", &run), ("50 kPa", &run)];
    let band = ContractionOptions {
        reference_band: Some(([7.0, 12.0], "adult ventricular myocytes, unloaded")),
        ..ContractionOptions::default()
    };
    let checks = [
        (
            action_potential_and_tension(&run, &[STIMULUS]).unwrap(),
            vec![
                "Time (ms)",
                "Potential u",
                "Active tension (kPa)",
                "stimulus",
                "50.0 kPa at 171.5 ms",
            ],
        ),
        (action_potential_and_tension(&mv, &[]).unwrap(), vec!["Potential (mV)", "\u{2212}80"]),
        (
            cell_shapes(&drawn, &shapes).unwrap(),
            vec![
                "Fibre strain (%)",
                "20 \u{b5}m",
                "at rest",
                "relaxing",
                "170 ms, 50.0 kPa, shortening 12.0 %",
            ],
        ),
        (
            contraction(&curves, &band).unwrap(),
            vec!["Shortening (%)", "30 kPa: 12.0 % at 171.5 ms", "unloaded: 7\u{2013}12 % (band)"],
        ),
        (mesh(&long).unwrap(), vec!["20 \u{b5}m", "points", "springs", "spacing 2 \u{b5}m"]),
        (
            overview(&drawn, &run, &[STIMULUS]).unwrap(),
            vec!["Tension (kPa)", "Shortening (%)", "Time (ms)", "Fibre strain (%)", "peak"],
        ),
    ];
    for (figure, labels) in checks {
        let svg = figure.to_svg();
        for label in labels {
            assert!(svg.contains(label), "{label} is missing");
        }
    }
}

#[test]
fn the_same_run_gives_the_same_bytes() {
    let long = elongated(2.0);
    let run = beat(&long);
    let (first, second) = (all_figures(&long, &run, X), all_figures(&long, &run, X));
    assert!(first == second, "figures differ");
    assert!(first[4].to_svg() == second[4].to_svg(), "texts differ");
    assert!(first[4].to_png(100.0) == second[4].to_png(100.0), "pixels differ");
    assert_eq!(traces(&run).unwrap(), traces(&run).unwrap());
}

#[test]
fn a_run_cut_short_still_gives_every_figure() {
    let long = elongated(2.0);
    let whole = beat(&long);
    for (samples, frames) in [(1, 1), (2, 2), (150, 15), (400, 41)] {
        let cut = Recording {
            samples: whole.samples[..samples].to_vec(),
            frames: whole.frames[..frames].to_vec(),
            ..Recording::default()
        };
        for figure in all_figures(&long, &cut, X) {
            size(&figure);
        }
        traces(&cut).unwrap();
    }
    // Numbers that broke at the end are left out.
    let mut broken = whole;
    for sample in &mut broken.samples[300..] {
        (sample.u, sample.ta_kpa, sample.shortening_pct) =
            (Some(f64::NAN), f64::INFINITY, f64::NAN);
    }
    for frame in &mut broken.frames[30..] {
        frame.positions[0][3] = f64::NAN;
    }
    for figure in all_figures(&long, &broken, X) {
        let svg = figure.to_svg();
        assert!(!svg.contains("NaN") && !svg.contains("inf"));
        size(&figure);
    }
}

#[test]
fn the_story_of_a_beat_has_four_moments() {
    let long = elongated(4.0);
    let run = beat(&long);
    let story = |run: &Recording| -> Vec<(String, f64)> {
        key_shapes(run, &[STIMULUS, 700.0]).into_iter().map(|s| (s.name, s.frame.t_ms)).collect()
    };
    let names = |run: &Recording| -> Vec<String> { story(run).into_iter().map(|s| s.0).collect() };
    assert_eq!(names(&run), ["at rest", "contracting", "peak", "relaxing"]);
    let shapes = key_shapes(&run, &[STIMULUS]);
    let shortening: Vec<f64> = shapes.iter().map(|shape| shape.shortening_pct.unwrap()).collect();
    // Frames are 5 ms apart, in which shortening changes by up to 0.7 %.
    for (found, expected) in shortening.into_iter().zip([0.0, 6.0, 12.0, 6.0]) {
        assert!((found - expected).abs() < 0.4, "{found} {expected}");
    }
    assert_eq!(story(&run)[0].1, STIMULUS);
    assert_eq!(story(&run)[2].1, 170.0);

    let mut cut = run.clone();
    cut.frames.truncate(30);
    assert_eq!(names(&cut), ["at rest", "contracting", "end of record"]);
    cut.frames.truncate(1);
    assert_eq!(names(&cut), ["at rest"]);
    // Of a cell that is held the tension tells the moments.
    let mut held = run.clone();
    held.samples.iter_mut().for_each(|sample| sample.shortening_pct = 0.0);
    assert_eq!(names(&held), ["at rest", "contracting", "peak", "relaxing"]);
    // So it does without samples.
    let silent = Recording { samples: vec![], ..run.clone() };
    assert_eq!(story(&silent), story(&run));
    assert_eq!(key_shapes(&silent, &[STIMULUS])[0].shortening_pct, None);
}

#[test]
fn nothing_to_draw_is_an_error_and_not_a_panic() {
    let long = elongated(4.0);
    let run = beat(&long);
    let empty = Recording::default();
    let plain = ContractionOptions::default();
    let (frame, x) = (&run.frames[0], along(&long, X));
    let shape = |frame| vec![Shape { name: "x".to_owned(), frame, shortening_pct: None }];
    let wrong = Frame { positions: [vec![], vec![]], ..frame.clone() };
    let drawn = cell(&long, &x).unwrap();
    let hollow = Mesh { simplices: vec![], ..long.clone() };
    let nowhere =
        Mesh { points: [vec![], vec![]], springs: vec![], simplices: vec![], ..long.clone() };
    for (result, message) in [
        (action_potential_and_tension(&empty, &[]), "0 samples with finite numbers"),
        (contraction(&[], &plain), "given 0 recordings"),
        (contraction(&[("40 kPa", &empty)], &plain), "the recording \"40 kPa\" has 0 samples"),
        (cell_shapes(&drawn, &[]), "given 0 frames"),
        (cell_shapes(&drawn, &shape(&wrong)), "has 0 positions along axis 0"),
        (mesh(&nowhere), "given 0 points"),
        (overview(&drawn, &empty, &[]), "given 0 frames"),
        (work_loop(&run, &[STIMULUS]), "given 0 forces at the ends"),
    ] {
        let error: FigureError = result.unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
    for (result, message) in [
        (cell(&long, &along(&long, [0.0, 0.0])), "fibre direction (0, 0)"),
        (cell(&long, &x[1..]), "one for each of the triangles"),
        (cell(&hollow, &[]), "given 0 triangles"),
    ] {
        let error: FigureError = result.unwrap_err();
        assert!(error.to_string().contains(message), "{error}");
    }
}

#[test]
fn a_loop_of_force_and_length_names_its_end_of_systole_and_the_work_up_to_there() {
    let mut run = beat(&elongated(4.0));
    // Against springs: the force is in proportion to the shortening, so half of their product is the work.
    let shortening = |sample: &Sample| 140.0 - sample.length_um;
    let values: Vec<f64> = run.samples.iter().map(|sample| 50.0 * shortening(sample)).collect();
    let most = values.iter().copied().fold(0.0, f64::max);
    let work_pj = 0.5 * most * most / 50.0 / 1000.0;
    // A run that was read back has the unit in the names of its columns.
    for (name, unit) in [(END_FORCE, "nN"), ("end_force_nn", "")] {
        let (name, unit, values) = (name.into(), unit.into(), values.clone());
        run.signals = vec![Signal { name, unit, values }];
        let figure = work_loop(&run, &[STIMULUS]).unwrap();
        let text = figure.to_svg();
        assert!(text.contains(&format!("end of systole, {most:.0} nN")), "{most}");
        assert!(text.contains(&format!("work on the load {work_pj:.2} pJ")), "{work_pj}");
        size(&figure);
        let beats = myospring::analysis::beat::beats(&run, &[STIMULUS]);
        assert!((beats[0].value("peak_end_force").unwrap() - most).abs() < 1e-2 * most);
    }
}

#[test]
fn labels_of_users_are_text_and_never_markup() {
    let long = elongated(4.0);
    let run = beat(&long);
    let label = "<script>&\"\u{1b}$x$";
    let figure = contraction(&[(label, &run)], &ContractionOptions::default()).unwrap();
    assert!(figure.to_svg().contains("&lt;script&gt;&amp;"));
    size(&figure);
}
