//! Films of several cells: all are followed together, and none stops the others.

use crate::common::Sample;
use myospring::experiment::input::ChosenSetting;
use myospring::experiment::track::{FilmCell, Track, TrackCells, TrackedCells};
use myospring::experiment::{Experiment, ExperimentError, Files, Outcome, save};
use myospring::settings::{self, Value};
use myospring::study::Status;
use std::fs;

use super::cells_film::{CellsFilm, cell};

/// Shortening of the two that beat; the third rests, the fourth is cut by the right edge.
const SHORTENING: [f64; 2] = [0.09, 0.05];

/// Four cells, `apart` um from each other in addition to 16 um.
fn dish(apart: f64, noise: f64) -> CellsFilm {
    let (right, up) = (78.0 + apart, 32.0 + apart);
    CellsFilm {
        size_um: [164.0 + apart, 66.0 + apart],
        cells: vec![
            (cell(SHORTENING[0], 3), [2.0, 2.0]),
            (cell(SHORTENING[1], 4), [right, 2.0]),
            (cell(0.0, 5), [2.0, up]),
            (cell(0.07, 6), [right + 26.0, up]),
        ],
        stage_um: 0.8,
        noise,
        flat: None,
    }
}

fn setting(key: &str, value: Value) -> ChosenSetting {
    (settings::find(key).unwrap(), value)
}

fn followed(
    film: &CellsFilm,
    more: &[ChosenSetting],
) -> (Result<TrackedCells, ExperimentError>, tempfile::TempDir) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("dish.y4m");
    fs::write(&path, film.bytes()).unwrap();
    let mut track = Track::of(path);
    track.settings = vec![
        setting("shape.pixel_size", Value::Text("0.25 um".to_owned())),
        setting("shape.spacing", Value::Text("2 um".to_owned())),
        setting("segmentation.frame", Value::Whole(0)),
    ];
    track.settings.extend(more.iter().cloned());
    (TrackCells(track).run(&Files::default(), &()), folder)
}

/// The cell of a film whose middle is nearest to a place.
fn at(found: &TrackedCells, place: [f64; 2]) -> &FilmCell {
    let away = |cell: &&FilmCell| {
        let tracked = cell.found.as_ref().ok();
        let [low, high] = tracked.map_or([[1e9; 2]; 2], |it| it.followed.shaped.outline.bounds());
        let middle = [0, 1].map(|axis: usize| 0.5 * (low[axis] + high[axis]));
        (middle[0] - place[0]).hypot(middle[1] - place[1])
    };
    found.cells.iter().min_by(|a, b| away(a).total_cmp(&away(b))).unwrap()
}

#[test]
fn cells_of_one_film_are_followed_apart_over_noise_and_distance() {
    let mut sample = Sample::one_in(2);
    for (apart, noise) in [(-9.0, 0.3), (0.0, 0.0)] {
        if sample.leaves_out() {
            continue;
        }
        let film = dish(apart, noise);
        let (found, _folder) = followed(&film, &[]);
        let found = found.unwrap();
        assert_eq!(found.cells.len(), 4, "{apart} um, noise {noise}: {:?}", found.warnings());
        assert_eq!(found.followed().count(), 3, "{:?}", found.warnings());
        for (number, expected) in SHORTENING.into_iter().chain([0.0]).enumerate() {
            let (scene, corner) = &film.cells[number];
            let middle = scene.middle();
            let cell = at(&found, [corner[0] + middle[0], corner[1] + middle[1]]);
            let tracked = cell.found.as_ref().unwrap();
            let percent = tracked.report.peak_shortening_pct;
            // A single cell alone is found within 0.1; noise of 30 % adds as much.
            assert!(
                (percent - 100.0 * expected * scene.strength_most()).abs() < 0.25,
                "{apart} um, noise {noise}, cell {number}: {percent} %"
            );
            assert_eq!(tracked.followed.motion.hardly_moves(), expected == 0.0, "cell {number}");
            // The stage is the same for all.
            let stage = tracked.report.stage_largest_um;
            assert!((stage - 0.8 * 1.36_f64.sqrt()).abs() < 0.25, "{stage} um");
        }
        let cut = found.cells.iter().find(|cell| cell.status() == Status::LeftOut).unwrap();
        assert!(cut.reason().contains("cut"), "{}", cut.reason());
        assert!(cut.shape.as_ref().unwrap().pixels_on_frame > 0);
    }
}

#[test]
fn a_cell_cut_by_the_frame_is_followed_on_request_and_said_to_be_cut() {
    if crate::common::left_to_full() {
        return;
    }
    let (found, _folder) =
        followed(&dish(0.0, 0.1), &[setting("segmentation.allow_cut", Value::Flag(true))]);
    let found = found.unwrap();
    assert_eq!(found.followed().count(), 4);
    let cut: Vec<&FilmCell> = found
        .cells
        .iter()
        .filter(|cell| cell.shape.as_ref().unwrap().pixels_on_frame > 0)
        .collect();
    assert_eq!(cut.len(), 1);
    let warnings = cut[0].warnings(&found.common_warnings());
    assert!(warnings.iter().any(|warning| warning.contains("cut")), "{warnings:?}");
}

#[test]
#[ignore = "slow"]
fn a_cell_without_texture_is_a_row_with_the_reason() {
    let mut film = dish(0.0, 0.02);
    // So small strength of stripes that none of its points can be followed.
    film.flat = Some(1);
    let (found, folder) = followed(&film, &[]);
    let found = found.unwrap();
    assert_eq!(found.followed().count(), 2, "{:?}", found.warnings());
    let failed = found.cells.iter().find(|cell| cell.status() == Status::Failed).unwrap();
    assert!(failed.reason().contains("texture"), "{}", failed.reason());
    let target = folder.path().join("results");
    save(&found, &target, false, &Files::default(), &()).unwrap();
    let table = fs::read_to_string(target.join("cells.csv")).unwrap();
    assert_eq!(table.lines().count(), 5, "{table}");
    assert!(table.contains("failed") && table.contains("left out"), "{table}");
    let curves = fs::read_to_string(target.join("shortenings.csv")).unwrap();
    let [one, other] = [0, 1].map(|at| found.followed().nth(at).unwrap().0);
    let header =
        format!("frame,t_ms,cell_{}_shortening_pct,cell_{}_shortening_pct\n", one.name, other.name);
    assert!(curves.starts_with(&header), "{curves}");
    assert!(target.join(format!("cells/{}/track.csv", one.name)).exists());
    assert!(!target.join(format!("cells/{}/track.csv", failed.name)).exists());
}

#[test]
fn one_cell_where_all_were_asked_for_may_be_several_and_one_of_several_says_what_follows_all() {
    let mut film = dish(0.0, 0.0);
    film.cells.truncate(2);
    let (found, folder) = followed(&film, &[]);
    assert!(found.unwrap().warnings().iter().all(|it| !it.contains("one cell was found")));
    let mut track = Track::of(folder.path().join("dish.y4m"));
    track.settings = vec![
        setting("shape.pixel_size", Value::Text("0.25 um".to_owned())),
        setting("shape.spacing", Value::Text("2 um".to_owned())),
    ];
    let warnings = track.run(&Files::default(), &()).unwrap().warnings();
    let hint = "`myospring track --cell all` follows each of the 2 cells";
    assert!(warnings.iter().any(|it| it == hint), "{warnings:?}");
    film.cells.truncate(1);
    let (found, _folder) = followed(&film, &[]);
    let warnings = found.unwrap().warnings();
    assert!(warnings[0].starts_with("one cell was found in the film"), "{warnings:?}");
}
