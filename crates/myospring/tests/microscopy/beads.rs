//! Tractions from pictures of beads in a gel.

use super::bead_film::BeadScene;
use super::synthetic_film::FilmScene;
use myospring::experiment::fit::{FitCell, TractionCurve};
use myospring::experiment::traction::{CellPlace, FoundTractions, Source, Traction};
use myospring::experiment::{Experiment, Files, Folder, Outcome};
use myospring::microscopy::film::Film;
use myospring::microscopy::picture::Selection;
use myospring::settings::{self, Value};

fn found(scene: &BeadScene, parts: &[f64], experiment: &Traction) -> FoundTractions {
    experiment.run(&scene.files(parts, 10), &()).unwrap()
}

/// Axial force, moment and force in all directions over what they are.
fn ratios(scene: &BeadScene, found: &FoundTractions, at: usize) -> [f64; 3] {
    let (truth, frame) = (scene.truth(), &found.frames[at]);
    [
        frame.axial_force_nn / truth.axial_force_nn,
        frame.contractile_moment_fj / truth.moment_fj,
        frame.force_nn / truth.force_nn,
    ]
}

#[test]
fn force_and_moment_come_back_from_a_pair_of_pictures_over_a_grid() {
    let usual = BeadScene::default();
    for scene in [
        usual,
        BeadScene { density: 0.2, ..usual },
        BeadScene { density: 1.5, photons: 40.0, pixel_um: 0.3, ..usual },
        BeadScene { density: 1.0, photons: 400.0, pixel_um: 0.15, seed: 3, ..usual },
        // Many diameters of a bead, and further than beads are apart.
        BeadScene { drift_um: [3.1, -2.3], seed: 2, ..usual },
    ] {
        let found = found(&scene, &[1.0], &scene.with_reference());
        let [axial, moment, _] = ratios(&scene, &found, 0);
        assert!((axial - 1.0).abs() < 0.1, "{scene:?}: axial force {axial}");
        assert!((moment - 1.0).abs() < 0.1, "{scene:?}: moment {moment}");
        let followed = found.followed().unwrap();
        let stage = followed.stage_um[0];
        for (axis, drift) in scene.drift_um.into_iter().enumerate() {
            assert!((stage[axis] - drift).abs() < 0.05, "{scene:?}: stage {stage:?}");
        }
        let apart = scene.density.sqrt().recip();
        let ratio = followed.bead_distance_um / apart;
        assert!((0.7..1.5).contains(&ratio), "{scene:?}: beads {ratio} of {apart} um apart");
        assert!(found.axis.unwrap().direction[0].abs() > 0.99);
    }
}

/// Beats of a second, at rest for most of it.
fn beats(frames: usize) -> Vec<f64> {
    let part = |frame: usize| match frame % 10 {
        at @ 3..=7 => (std::f64::consts::PI * (at - 2) as f64 / 6.0).sin().powi(2),
        _ => 0.0,
    };
    (0..frames).map(part).collect()
}

#[test]
fn a_film_that_begins_in_a_beat_has_its_own_rest_and_the_beats_of_its_force() {
    let scene = BeadScene { pixel_um: 0.3, drift_um: [0.6, 0.3], ..BeadScene::default() };
    let parts = beats(35)[4..].to_vec();
    let found = found(&scene, &parts, &scene.traction());
    let followed = found.followed().unwrap();
    assert!(followed.relative_to_rest && followed.reference.contains("at rest"));
    let truth = scene.truth().axial_force_nn;
    for (frame, part) in found.frames.iter().zip(&parts) {
        let off = frame.axial_force_nn / truth - part;
        assert!(off.abs() < 0.1, "frame {}: off by {off}", frame.frame);
    }
    let read = found.beats.as_ref().unwrap();
    let analysis = read.found.as_ref().unwrap();
    let developed = analysis.mean("developed_tension").unwrap();
    assert!((developed / truth - 1.0).abs() < 0.1, "{developed} of {truth}");
    assert!(analysis.counted().len() >= 2);
    let numbers = serde_json::to_value(found.numbers()).unwrap();
    assert_eq!(numbers["beats"]["curve"], "axial_force_nN");
    assert!(numbers["beads"]["subset_um"].as_f64().unwrap() > 2.0);
}

#[test]
fn a_gel_at_rest_has_no_beats_and_a_force_within_its_noise() {
    let scene = BeadScene { pixel_um: 0.3, ..BeadScene::default() };
    let found = found(&scene, &[0.0; 12], &scene.traction());
    assert!(found.beats.as_ref().unwrap().found.is_err());
    let truth = scene.truth();
    assert!(found.strongest().axial_force_nn.abs() < 0.03 * truth.axial_force_nn);
    let warnings = found.warnings().join("\n");
    assert!(warnings.contains("it may be noise"), "{warnings}");
}

#[test]
fn pictures_that_show_no_motion_of_beads_are_refused_with_the_reason() {
    let scene = BeadScene { pixel_um: 0.3, ..BeadScene::default() };
    let [columns, rows] = scene.size();
    let still = |frames: usize, size: [usize; 2], value: &dyn Fn(usize) -> u8| {
        let [columns, rows] = size;
        let mut bytes = format!("YUV4MPEG2 W{columns} H{rows} F10:1 Cmono\n").into_bytes();
        for _ in 0..frames {
            bytes.extend(b"FRAME\n");
            bytes.extend((0..columns * rows).map(value));
        }
        bytes
    };
    let pair = scene.film(&[1.0], 10);
    let files: [(&str, Vec<u8>); 7] = [
        ("pulled.y4m", pair),
        ("relaxed.y4m", scene.reference()),
        ("two.y4m", scene.film(&[0.0, 1.0], 10)),
        ("other.y4m", scene.film_of_others()),
        ("black.y4m", still(5, [columns, rows], &|_| 0)),
        ("small.y4m", still(1, [40, 30], &|at| (at * 7919 % 251) as u8)),
        ("grain.y4m", still(1, [columns, rows], &|at| (at * 7919 % 3) as u8)),
    ];
    let files = Files::holding(files.map(|(name, bytes)| (name.to_owned(), bytes)).into());
    for (film, reference, said) in [
        ("pulled.y4m", None, "is one picture"),
        ("two.y4m", None, "has only 2 frames"),
        ("black.y4m", None, "shows no beads"),
        ("black.y4m", Some("relaxed.y4m"), "squares are found again"),
        ("pulled.y4m", Some("black.y4m"), "it has 5 frames"),
        ("pulled.y4m", Some("small.y4m"), "it has 40 x 30 pixels"),
        ("small.y4m", Some("small.y4m"), "has room for"),
        ("relaxed.y4m", Some("relaxed.y4m"), "nothing moves"),
        ("other.y4m", Some("relaxed.y4m"), "squares are found again"),
    ] {
        let mut experiment = scene.traction();
        experiment.cell = None;
        if let Source::Beads(beads) = &mut experiment.source {
            beads.film = film.into();
            beads.reference = reference.map(Into::into);
        }
        let refused = experiment.run(&files, &()).map(|found| found.frames);
        let refused = refused.expect_err(film).to_string();
        assert!(refused.contains(said), "{film} {reference:?}: {refused}");
    }
}

/// A film of the cell in the window of the beads, which beats in every frame as the beads say.
struct Beside {
    cell: FilmScene,
    beads: BeadScene,
}

impl Beside {
    fn new() -> Self {
        let cell = FilmScene {
            pixel_um: 0.25,
            cell_um: [48.0, 14.0],
            frames: 20,
            beat: 14,
            shortening: 0.08,
            noise: 0.05,
            bits: 8,
            ..FilmScene::default()
        };
        Self { cell, beads: BeadScene { pixel_um: 0.25, ..BeadScene::default() } }
    }

    /// The film of the cell on a wider ground.
    fn film(&self) -> Vec<u8> {
        let (film, [columns, rows]) = (self.cell.film(), self.beads.size());
        let [width, height] = film.size();
        let [left, top] = [(columns - width) / 2, (rows - height) / 2];
        let mut bytes = format!("YUV4MPEG2 W{columns} H{rows} F50:1 Cmono\n").into_bytes();
        for frame in 0..film.len() {
            bytes.extend(b"FRAME\n");
            let plane = film.frame(frame).unwrap();
            // The ground of the film itself, moved about.
            let ground = |at: usize| plane.at(at * 7919 % width, at * 104_729 % 8) as u8;
            let pixel = |at: usize| {
                let (column, row) = (at % columns, at / columns);
                let inside =
                    (left..left + width).contains(&column) && (top..top + height).contains(&row);
                if inside { plane.at(column - left, row - top) as u8 } else { ground(at) }
            };
            bytes.extend((0..columns * rows).map(pixel));
        }
        bytes
    }

    fn files(&self) -> Files {
        let parts: Vec<f64> = (0..self.cell.frames).map(|at| self.cell.strength(at)).collect();
        let film = self.film();
        let first = Film::read(film.clone(), &Selection::default()).unwrap().picture(0).unwrap();
        let held = [
            ("beads.y4m", self.beads.film(&parts, 50)),
            ("relaxed.y4m", self.beads.reference()),
            ("around.geojson", BeadScene::region()),
            ("cell.y4m", film),
            ("cell.tif", first),
            ("small.y4m", self.cell.bytes()),
        ];
        Files::holding(held.map(|(name, bytes)| (name.to_owned(), bytes)).into())
    }
}

#[test]
fn a_film_or_a_picture_of_the_cell_says_where_it_is() {
    if crate::common::left_to_full() {
        return;
    }
    let beside = Beside::new();
    let files = beside.files();
    let force = |cell: &str| {
        let cell = Some(CellPlace::of(cell));
        let found = Traction { cell, ..beside.beads.traction() }.run(&files, &());
        found.map(|found| found.strongest().axial_force_nn)
    };
    let around = force("around.geojson").unwrap();
    for place in ["cell.y4m", "cell.tif"] {
        let found = force(place).unwrap();
        assert!((found / around - 1.0).abs() < 0.05, "{place}: {found}, {around}");
    }
    let whole = Traction { cell: None, ..beside.beads.traction() }.run(&files, &()).unwrap();
    assert!((whole.strongest().axial_force_nn / around - 1.0).abs() > 0.05);
    let refused = force("small.y4m").unwrap_err().to_string();
    assert!(refused.contains("`small.y4m` has 256 columns and 120 rows"), "{refused}");
    assert!(force("none.y4m").unwrap_err().to_string().contains("none.y4m"));
}

#[test]
fn films_of_a_cell_and_of_the_beads_under_it_give_its_tension_in_kpa() {
    if crate::common::left_to_full() {
        return;
    }
    let beside = Beside::new();
    let files = beside.files();
    let given = |key: &str, value: Value| (settings::find(key).unwrap(), value);
    let mut fit = FitCell {
        to: vec!["cell.y4m".into()],
        settings: vec![
            given("cell.model", Value::Text("given_tension".into())),
            given("shape.pixel_size", Value::Text("0.25 um".into())),
            given("shape.spacing", Value::Text("3 um".into())),
        ],
        traction: vec![TractionCurve { gel_modulus: Some(5.0), path: "beads.y4m".into() }],
        ..FitCell::default()
    };
    fit.table.pixel_size_um = Some(0.25);
    let found = fit.run(&files, &()).unwrap();
    let (_, one) = found.fitted().next().unwrap();
    assert_eq!(one.curves.len(), 2);
    let force = &one.curves[1];
    let most = force.measured.iter().copied().fold(0.0, f64::max);
    let truth = beside.beads.truth().axial_force_nn;
    assert!((most / truth - 1.0).abs() < 0.1, "{most}, {truth}");
    let modulus = one.estimate("young_modulus").unwrap();
    assert!(modulus.value > 0.0 && one.estimate("peak_tension").is_some(), "{modulus:?}");
    let folder = Folder::in_memory();
    found.save(&folder, &()).unwrap();
    for file in ["traction/traction.csv", "traction/report.html", "run.toml", "tension.csv"] {
        assert!(folder.has(file), "{file}: {:?}", folder.names());
    }
    // The window of the beads is that of the film, so that tractions are sought at the cell alone.
    let summary = String::from_utf8(folder.contents()["traction/summary.json"].clone()).unwrap();
    assert!(summary.contains("\"confined_to_a_region\": true"), "{summary}");
}
