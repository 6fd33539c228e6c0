//! `myospring traction`: from the displacements of a gel to the force on it.

use super::bead_film::BeadScene;
use super::{json, myospring, names, stderr, stdout};
use myospring::output::npz::{Array, from_npy, to_npy};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

fn array(path: &Path) -> Array {
    from_npy(&fs::read(path).unwrap()).unwrap()
}

/// The number after a key in JSON.
fn number(text: &str, key: &str) -> f64 {
    let (_, rest) = text.split_once(&format!("\"{key}\": ")).unwrap();
    rest.split([',', '\n', '}']).next().unwrap().parse().unwrap()
}

#[test]
fn the_force_of_a_simulated_cell_comes_back_from_the_displacements_around_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let gel = ["--support", "gel", "--gel-modulus", "5 kPa", "--gel-thickness", "30 um"];
    let run = ["run", "--spacing", "2 um", "--outputs", "gel", "--output", "cell"];
    let made = myospring(at, &[&run[..], &gel].concat());
    assert!(made.status.success(), "{}", stderr(&made));
    let about = fs::read_to_string(at.join("cell/gel/gel.json")).unwrap();
    assert_eq!(number(&about, "pixel_size_um"), 2.0);
    // The cell is where the gel is displaced most: a region a little larger than it, as one would draw it.
    let u = array(&at.join("cell/gel/u.npy"));
    let [rows, columns] = [u.shape()[0], u.shape()[1]];
    let table = fs::read_to_string(at.join("cell/gel/tractions.csv")).unwrap();
    let first: Vec<f64> = {
        let (_, rest) = about.split_once("\"first_pixel_um\": [").unwrap();
        rest.split(']').next().unwrap().split(',').map(|x| x.trim().parse().unwrap()).collect()
    };
    let mut region = vec![0_u8; rows * columns];
    for line in table.lines().skip(1) {
        let place: Vec<f64> = line.split(',').take(2).map(|x| x.parse().unwrap()).collect();
        let [column, row] =
            [0, 1].map(|axis: usize| ((place[axis] - first[axis]) / 2.0).round() as usize);
        for (up, along) in (0..3).flat_map(|up| (0..3).map(move |along| (up, along))) {
            region[(rows - 1 - (row + up - 1)) * columns + column + along - 1] = 255;
        }
    }
    let file = fs::File::create(at.join("region.png")).unwrap();
    let mut encoder = png::Encoder::new(file, columns as u32, rows as u32).write_header().unwrap();
    encoder.write_image_data(&region).unwrap();
    drop(encoder);
    let arrays = ["cell/gel/u.npy", "cell/gel/v.npy"];
    let options = ["--pixel-size", "2 um", "--gel-modulus", "5 kPa", "--gel-thickness", "30 um"];
    let found =
        [&["traction"][..], &arrays, &options, &["--region", "region.png", "--output", "found"]];
    let found = myospring(at, &found.concat());
    assert!(found.status.success() && stderr(&found).is_empty(), "{}", stderr(&found));
    assert!(stdout(&found).contains("contractile moment"), "{}", stdout(&found));
    let summary = fs::read_to_string(at.join("cell/summary.json")).unwrap();
    let value = |name: &str| {
        let (_, rest) = summary.split_once(&format!("\"{name}\"")).unwrap();
        number(rest, "value")
    };
    let numbers = fs::read_to_string(at.join("found/summary.json")).unwrap();
    for (found, made, within) in [
        ("traction_force_nN", "peak_traction_force", 0.03),
        ("contractile_moment_fJ", "peak_contractile_moment", 0.05),
        ("gel_energy_fJ", "peak_gel_energy", 0.05),
    ] {
        let ratio = number(&numbers, found) / value(made);
        assert!((ratio - 1.0).abs() < within, "{found}: {ratio}");
    }
    for file in ["traction.csv", "tractions.npz", "figures/traction.png", "myospring.sha256"] {
        assert!(at.join("found").join(file).is_file(), "{file}");
    }
    let page = fs::read_to_string(at.join("found/report.html")).unwrap();
    assert!(page.contains("axial force") && page.contains("in a region"));
}

#[test]
fn arrays_that_do_not_fit_are_refused_with_the_place_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let save = |name: &str, shape: &[usize], broken: bool| {
        let count = shape.iter().product::<usize>();
        let numbers =
            (0..count).map(|k| if broken && k == 25 { f64::NAN } else { 0.01 * k as f64 });
        fs::write(at.join(name), to_npy(&Array::floats(shape, numbers))).unwrap();
    };
    save("u.npy", &[10, 12], false);
    save("film.npy", &[3, 10, 12], false);
    save("broken.npy", &[10, 12], true);
    save("small.npy", &[4, 4], false);
    fs::write(at.join("still.npy"), to_npy(&Array::floats([10, 12], [0.5; 120]))).unwrap();
    fs::write(at.join("text.npy"), "no array").unwrap();
    let size = ["--pixel-size", "2 um"];
    for (u, v, gel, said) in [
        ("u.npy", "film.npy", "10 kPa", "[3, 10, 12]"),
        ("u.npy", "broken.npy", "10 kPa", "row 2, column 1 of frame 0"),
        ("small.npy", "small.npy", "10 kPa", "at least 8"),
        ("text.npy", "u.npy", "10 kPa", "`text.npy` is no NumPy array"),
        ("still.npy", "still.npy", "10 kPa", "nothing moves"),
        ("none.npy", "u.npy", "10 kPa", "cannot read `none.npy`"),
        ("u.npy", "u.npy", "0 kPa", "must be above 0 kPa"),
        ("u.npy", "u.npy", "10 um", "--gel-modulus"),
    ] {
        let refused = [&["traction", u, v, "--gel-modulus", gel][..], &size].concat();
        let refused = myospring(at, &refused);
        assert_eq!(refused.status.code(), Some(2), "{u} {v} {gel}");
        assert!(stderr(&refused).contains(said), "{u} {v} {gel}: {}", stderr(&refused));
    }
    let solid = ["traction", "u.npy", "u.npy", "--gel-modulus", "1 kPa", "--gel-poisson", "0.5"];
    let solid = myospring(at, &[&solid[..], &size].concat());
    assert!(stderr(&solid).contains("below 0.5"), "{}", stderr(&solid));
    assert!(!at.join("results").exists());
}

/// Two beats in 24 frames, from rest to rest.
fn beats() -> Vec<f64> {
    let part = |frame: usize| match frame % 12 {
        at @ 4..=9 => (std::f64::consts::PI * (at - 3) as f64 / 7.0).sin().powi(2),
        _ => 0.0,
    };
    (0..24).map(part).collect()
}

#[test]
fn a_film_of_beads_gives_forces_that_other_commands_read() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = BeadScene { pixel_um: 0.3, ..BeadScene::default() };
    fs::write(at.join("beads.y4m"), scene.film(&beats(), 12)).unwrap();
    fs::write(at.join("relaxed.y4m"), scene.reference()).unwrap();
    fs::write(at.join("cell.geojson"), BeadScene::region()).unwrap();
    let gel = ["--gel-modulus", "5 kPa"];
    let options = ["--pixel-size", "0.3 um", "--region", "cell.geojson"];
    let found = myospring(at, &[&["traction", "beads.y4m"], &gel[..], &options].concat());
    assert!(found.status.success(), "{}", stderr(&found));
    let said = stdout(&found);
    for words in
        ["relative to the cell at rest", "axial force", "beats of the axial force: 2 whole"]
    {
        assert!(said.contains(words), "{words}: {said}");
    }
    let results = at.join("results/beads_traction");
    let page = fs::read_to_string(results.join("report.html")).unwrap();
    assert!(page.contains("Tractions of beads.y4m") && page.contains("Beats of the axial force"));
    for file in ["figures", "summary.json", "traction.csv", "tractions.npz", "u.npy", "v.npy"] {
        assert!(names(&results).contains(&file.to_owned()), "{file}");
    }
    // The table has the same beats.
    let table = "results/beads_traction/traction.csv";
    let read = json(&myospring(at, &["analyse", table, "--json", "--output", "read"]));
    let numbers: serde_json::Value =
        serde_json::from_slice(&fs::read(results.join("summary.json")).unwrap()).unwrap();
    let curves = read["curves"].as_array().unwrap();
    let kinds: Vec<[&str; 3]> = curves
        .iter()
        .map(|curve| ["curve", "kind", "unit"].map(|key| curve[key].as_str().unwrap()))
        .collect();
    assert_eq!(
        kinds,
        [
            ["traction_force_nN", "force", "nN"],
            ["axial_force_nN", "force", "nN"],
            ["contractile_moment_fJ", "moment", "fJ"]
        ]
    );
    let developed = |curve: &serde_json::Value| {
        let metrics = curve["metrics"].as_array().unwrap();
        let found = metrics.iter().find(|metric| metric["name"] == "developed_tension");
        found.unwrap()["mean"].as_f64().unwrap()
    };
    let [own, of_table] = [developed(&numbers["beats"]), developed(&curves[1])];
    assert!((own / of_table - 1.0).abs() < 1e-3, "{own} {of_table}");
    // The displacements are those that arrays give, in pixels of the film.
    let spacing = 0.3 * numbers["beads"]["spacing_px"].as_f64().unwrap();
    let arrays = ["results/beads_traction/u.npy", "results/beads_traction/v.npy"];
    let size = format!("{spacing} um");
    let subset = format!("{} um", numbers["beads"]["subset_um"]);
    let size =
        ["--pixel-size", &size, "--unit", "0.3 um", "--subset", &subset, "--output", "again"];
    let again = json(&myospring(at, &[&["traction", "--json"], &arrays[..], &gel, &size].concat()));
    let smoothing = |of: &serde_json::Value| of["smoothing_um_per_kpa"].as_f64().unwrap();
    assert!((smoothing(&again) / smoothing(&numbers) - 1.0).abs() < 1e-6);
    // So are those of a table of places, in pixels.
    let [u, v] = ["u.npy", "v.npy"].map(|name| array(&results.join(name)));
    let (rows, columns) = (u.shape()[1], u.shape()[2]);
    let step = numbers["beads"]["spacing_px"].as_u64().unwrap() as usize;
    let mut table = "frame,x,y,u,v\n".to_owned();
    for (at, (u, v)) in u.as_floats().unwrap().iter().zip(v.as_floats().unwrap()).enumerate() {
        let (frame, place) = (at / (rows * columns), at % (rows * columns));
        let [x, y] = [place % columns, place / columns].map(|at| at * step);
        writeln!(table, "{frame},{x},{y},{u},{v}").unwrap();
    }
    fs::write(at.join("piv.csv"), table).unwrap();
    let size = ["--pixel-size", "0.3 um", "--subset", &subset, "--output", "of_table"];
    let of_table = [&["traction", "--json", "piv.csv"], &gel[..], &size].concat();
    let of_table = json(&myospring(at, &of_table));
    assert!((smoothing(&of_table) / smoothing(&numbers) - 1.0).abs() < 1e-6);
    let found = ["traction", "piv.csv", "--cell-channel", "1", "--gel-modulus", "1 kPa"];
    assert_eq!(myospring(at, &found).status.code(), Some(2));
    // A pair.
    fs::write(at.join("pulled.y4m"), scene.film(&[1.0], 12)).unwrap();
    let pair = ["traction", "pulled.y4m", "--reference", "relaxed.y4m", "--json"];
    let pair = json(&myospring(at, &[&pair, &gel[..], &options].concat()));
    let force = pair["largest_force"]["axial_force_nN"].as_f64().unwrap();
    assert!((force / scene.truth().axial_force_nn - 1.0).abs() < 0.1, "{force}");
    let u = array(&at.join("results/pulled_traction/u.npy"));
    assert_eq!(u.shape().len(), 2);
}

#[test]
fn options_and_files_that_do_not_go_together_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let scene = BeadScene { pixel_um: 0.5, ..BeadScene::default() };
    fs::write(at.join("pulled.y4m"), scene.film(&[1.0], 1)).unwrap();
    fs::write(at.join("u.npy"), to_npy(&Array::floats([10, 12], [0.5; 120]))).unwrap();
    for (arguments, said) in [
        (&["u.npy"][..], "is one array"),
        (&["pulled.y4m", "pulled.y4m"], "--reference pulled.y4m"),
        (&["u.npy", "u.npy"], "--pixel-size is missing"),
        (
            &["u.npy", "u.npy", "--pixel-size", "1 um", "--channel", "1"],
            "--channel is for pictures",
        ),
        (&["pulled.y4m", "--unit", "1 um"], "--unit is for displacements"),
        (&["pulled.y4m"], "is one picture"),
        (&["pulled.y4m", "--reference", "pulled.y4m"], "does not say how large its pixels are"),
        (&["pulled.y4m", "--reference", "none.tif", "--pixel-size", "0.5 um"], "none.tif"),
    ] {
        let refused = myospring(at, &[&["traction", "--gel-modulus", "1 kPa"], arguments].concat());
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(stderr(&refused).contains(said), "{arguments:?}: {}", stderr(&refused));
    }
    assert!(!at.join("results").exists());
}
