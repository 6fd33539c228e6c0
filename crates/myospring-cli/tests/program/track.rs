//! `myospring track`.

use super::{json, myospring, names, stderr, stdout};
use std::fs;
use std::path::Path;

/// Part by which the cell of a frame is shorter than at rest.
const SHORTENING: [f64; 7] = [0.0, 0.0, 0.02, 0.05, 0.03, 0.01, 0.0];

/// A bright cell of 50 x 20 um with uneven stripes on a dark ground, 240 x 110 pixels of 0.25 um.
pub(super) fn frame(file: &Path, shortening: f64) {
    strained(file, [-shortening, 0.4 * shortening]);
}

/// The same with any strains along and across.
fn strained(file: &Path, [along, across]: [f64; 2]) {
    let value = |column: u32, row: u32| {
        let (x, y) = (0.25 * (f64::from(column) - 120.0), 0.25 * (f64::from(row) - 55.0));
        let (x, y) = (x / (1.0 + along), y / (1.0 + across));
        let edge = 1.0 / (1.0 + (((x / 25.0).powi(4) + (y / 10.0).powi(4)) * 8.0 - 8.0).exp());
        let phase = 1.3 * (0.9 * y + 0.23 * x).sin() + 0.8 * (1.7 * y - 0.11 * x).cos();
        let stripes = 0.55 + 0.35 * (x * std::f64::consts::TAU / 1.9 + phase).cos();
        let uneven = 0.75 + 0.25 * (0.31 * x + 1.1 * y).sin() * (0.17 * x - 0.6 * y).cos();
        // Grains that differ from frame to frame.
        let grain =
            f64::from((column * 7919 + row * 104_729 + (1e4 * along.abs()) as u32 * 31) % 7);
        (12.0 + 200.0 * edge * stripes * uneven + grain) as u8
    };
    let pixels: Vec<u8> = (0..240 * 110).map(|at| value(at % 240, at / 240)).collect();
    let file = fs::File::create(file).unwrap();
    png::Encoder::new(file, 240, 110).write_header().unwrap().write_image_data(&pixels).unwrap();
}

fn film(folder: &Path) {
    fs::create_dir(folder.join("film")).unwrap();
    for (at, shortening) in SHORTENING.into_iter().enumerate() {
        frame(&folder.join(format!("film/t{}.png", at + 8)), shortening);
    }
}

/// What all films here need.
const GIVEN: [&str; 6] = ["--pixel-size", "0.25 um", "--frame-rate", "40", "--spacing", "2 um"];

fn track(folder: &Path, more: &[&str]) -> std::process::Output {
    myospring(folder, &[&["track", "film"], &GIVEN[..], more].concat())
}

#[test]
fn a_folder_of_pictures_becomes_a_curve_a_film_and_figures() {
    let folder = tempfile::tempdir().unwrap();
    film(folder.path());
    let output = track(folder.path(), &["--outputs", "figures,gif,frames,vtu"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("7 of 7 frames at 40 /s (given)"), "{}", stdout(&output));
    let results = folder.path().join("results/film_track");
    let expected = [
        "cell.pvd",
        "figures",
        "frames.npz",
        "outline.geojson",
        "report.html",
        "rest.tif",
        "track.csv",
        "track.gif",
        "track.json",
        "vtu",
    ];
    assert_eq!(names(&results), expected);
    let table = fs::read_to_string(results.join("track.csv")).unwrap();
    let mut lines = table.lines();
    let header = "frame,t_ms,length_um,shortening_pct,width_um,area_um2,stretch_1,stretch_2,sarcomere_um,interpolated_pct,\
                  correlation,stage_x_um,stage_y_um";
    assert_eq!(lines.next(), Some(header));
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect())
        .collect();
    assert_eq!(rows.len(), SHORTENING.len());
    for (row, shortening) in rows.iter().zip(SHORTENING) {
        assert!((row[1] - 25.0 * row[0]).abs() < 1e-9);
        // Half of what is asked of the whole: 0.1 percentage points, for the stretch, too.
        assert!((row[3] - 100.0 * shortening).abs() < 0.1, "{row:?}");
        assert!((row[6] - 1.0 + shortening).abs() < 1e-3, "{row:?}");
        assert!((row[8] / 1.9 - 1.0 + shortening).abs() < 0.02, "{row:?}");
    }
    // The frame at rest is a picture of its own, with its pixel size.
    let rest = results.join("rest.tif");
    let segmented = myospring(folder.path(), &["segment", rest.to_str().unwrap(), "--json"]);
    assert!(segmented.status.success(), "{}", stderr(&segmented));
    assert_eq!(json(&segmented)["pixel_size_um"], 0.25);
    // Nothing is replaced unless it is asked for.
    let again = track(folder.path(), &["--outputs", "none"]);
    assert_eq!(again.status.code(), Some(2));
    assert!(stderr(&again).contains("already holds files"), "{}", stderr(&again));
    let again = track(folder.path(), &["--outputs", "none", "--force", "--json", "--frame", "0"]);
    assert!(again.status.success(), "{}", stderr(&again));
    assert_eq!(
        (json(&again)["rest_frame"].as_u64(), json(&again)["peak_frame"].as_u64()),
        (Some(0), Some(3))
    );
    assert_eq!(names(&results), ["outline.geojson", "rest.tif", "track.csv", "track.json"]);
}

#[test]
fn what_cannot_be_followed_says_why_and_leaves_nothing() {
    let folder = tempfile::tempdir().unwrap();
    film(folder.path());
    let path = folder.path();
    let refused = |arguments: &[&str], says: &[&str]| {
        let output = myospring(path, &[&["track"], arguments].concat());
        let text = stderr(&output).split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(output.status.code(), Some(2), "{text}");
        for say in says {
            assert!(text.contains(say), "`{say}` is not in: {text}");
        }
        assert!(
            !path.join("results").exists() || names(&path.join("results")).is_empty(),
            "{text}"
        );
    };
    let pixels = ["--pixel-size", "0.25 um"];
    refused(&["nothing.avi"], &["cannot read `nothing.avi`", "check the path"]);
    refused(&["film", "--pixel-size", "0.25 um"], &["how many frames a second", "--frame-rate 30"]);
    refused(&["film", "--frame-rate", "40"], &["--pixel-size"]);
    for rate in ["0", "-30", "fast", "nan"] {
        refused(
            &[&["film", "--frame-rate", rate], &pixels[..]].concat(),
            &[&format!("--frame-rate is `{rate}`"), "above 0"],
        );
    }
    refused(&[&["film", "--subset", "4 ms"], &GIVEN[..]].concat(), &["--subset", "4 ms"]);
    refused(&[&["film", "--subset", "0.1 um"], &GIVEN[..]].concat(), &["between 0.5 and 100 um"]);
    refused(
        &[&["film", "--frame", "7"], &GIVEN[..]].concat(),
        &["frame 7", "the film has 7, 0 to 6"],
    );
    refused(&[&["film/t8.png"], &GIVEN[..]].concat(), &["only one frame", "at least 3"]);
    fs::create_dir(path.join("empty")).unwrap();
    refused(&[&["empty"], &GIVEN[..]].concat(), &["`empty` is an empty folder"]);
    fs::write(path.join("film.czi"), b"ZISRAWFILE").unwrap();
    refused(&[&["film.czi"], &GIVEN[..]].concat(), &["Zeiss CZI", "OME-TIFF"]);
    fs::write(path.join("film.avi"), b"RIFF....AVI ").unwrap();
    refused(&[&["film.avi"], &GIVEN[..]].concat(), &["`film.avi`", "AVI film cannot be read"]);
    fs::write(path.join("film.mkv"), b"no film").unwrap();
    refused(&[&["film.mkv"], &GIVEN[..]].concat(), &["`film.mkv` is no TIFF, AVI", "ffmpeg"]);
    // A frame of another size.
    let pixels = vec![9_u8; 100];
    let file = fs::File::create(path.join("film/t11.png")).unwrap();
    png::Encoder::new(file, 10, 10).write_header().unwrap().write_image_data(&pixels).unwrap();
    refused(
        &[&["film"], &GIVEN[..]].concat(),
        &["frame 3 (`t11.png`) has 10 x 10 pixels", "240 x 110"],
    );
}

#[test]
fn a_film_without_motion_says_so() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("film")).unwrap();
    for at in 0..4 {
        frame(&folder.path().join(format!("film/{at}.png")), 0.0);
    }
    let output = track(folder.path(), &["--outputs", "none"]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stderr(&output).contains("the cell hardly moves"), "{}", stderr(&output));
}

#[test]
fn a_cell_that_contracts_without_becoming_shorter_is_told_to_be_read_by_its_stretch() {
    // Across only; and one that is longer whenever it is not in the frame that was taken for rest.
    for (strains, printed, said) in [
        ([0.0, -0.05], "(frame 3), read from stretch_1: the cell contracts at 90 degrees", ""),
        ([0.05, -0.02], "read from stretch_1", "longer than in frame 0"),
    ] {
        let folder = tempfile::tempdir().unwrap();
        fs::create_dir(folder.path().join("film")).unwrap();
        for (at, part) in [0.0, 0.0, 0.5, 1.0, 0.6, 0.0].into_iter().enumerate() {
            let file = folder.path().join(format!("film/t{}.png", at + 8));
            strained(&file, strains.map(|strain| strain * part));
        }
        let output = track(folder.path(), &["--outputs", "none", "--frame", "0"]);
        assert!(output.status.success(), "{}", stderr(&output));
        assert!(stderr(&output).contains(said), "{}", stderr(&output));
        assert!(stdout(&output).contains(printed), "{}", stdout(&output));
    }
}

#[test]
fn frames_that_were_written_twice_are_said_and_left_out() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("film")).unwrap();
    // Never the same twice: the noise of a film.
    let parts = [0.0, 0.001, 0.002, 0.02, 0.05, 0.03, 0.01, 0.003];
    let taken = |at: usize| at - usize::from(at > 3);
    for at in 0..=parts.len() {
        frame(&folder.path().join(format!("film/{at}.png")), parts[taken(at)]);
    }
    let output = track(folder.path(), &["--outputs", "figures", "--frame", "0"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let said = stderr(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    let wanted = "1 of 9 frames repeat the frame before them and are left out: 4.";
    assert!(said.contains(wanted), "{said}");
    let results = folder.path().join("results/film_track");
    let table = fs::read_to_string(results.join("track.csv")).unwrap();
    let frames: Vec<&str> =
        table.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(frames, ["0", "1", "2", "3", "5", "6", "7", "8"]);
    let report = fs::read_to_string(results.join("track.json")).unwrap();
    let report: serde_json::Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["repeated_frames"], serde_json::json!([4]));
    assert_eq!(report["headline"]["column"], "length_um");
    assert!((report["headline"]["peak_contraction_pct"].as_f64().unwrap() - 5.0).abs() < 0.1);
}
