//! Thick cells: from a stack, or an outline and a profile.

use super::{myospring, names, stderr, stdout};
use std::fs;
use tiff::encoder::{TiffEncoder, colortype::Gray8};

#[test]
fn a_stack_beats_in_one_command_and_its_results_repeat_it() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let file = fs::File::create(at.join("cell.tif")).unwrap();
    let mut encoder = TiffEncoder::new(file).unwrap();
    // A dome of 60 x 16 x 8 um, the mask of it.
    for slice in 0..10_u32 {
        let z = (f64::from(slice) + 0.5) / 8.0;
        let inside = |at: u32| {
            let x = 0.5 * (f64::from(at % 140) + 0.5 - 70.0) / 30.0;
            let y = 0.5 * (f64::from(at / 140) + 0.5 - 25.0) / 8.0;
            if x * x + y * y + z * z < 1.0 { 255 } else { 0 }
        };
        let pixels: Vec<u8> = (0..140 * 50).map(inside).collect();
        encoder.write_image::<Gray8>(140, 50, &pixels).unwrap();
    }
    let scale = ["--pixel-size", "0.5 um", "--z-step", "1 um", "--spacing", "1.6 um"];
    let outputs = ["--outputs", "report,figures,vtu,frames", "--frame-interval", "50 ms"];
    let run = [&["run", "--stack", "cell.tif", "--output", "beat"][..], &scale, &outputs].concat();
    let beat = myospring(at, &run);
    assert!(beat.status.success(), "{}", stderr(&beat));
    assert!(stderr(&beat).contains("--first-slice top"), "{}", stderr(&beat));
    for row in ["thickening, largest", "volume change, largest", "of the lower face"] {
        assert!(stdout(&beat).contains(row), "{row}: {}", stdout(&beat));
    }
    for figure in ["in_space.svg", "overlay.svg"] {
        assert!(names(&at.join("beat/figures")).contains(&figure.to_owned()), "{figure}");
    }
    let frame = fs::read_to_string(at.join("beat/vtu/cell_0000.vtu")).unwrap();
    assert!(frame.contains("volume_ratio"));
    let again = myospring(at, &["run", "beat/run.toml", "--output", "again", "--outputs", "none"]);
    assert!(again.status.success(), "{}", stderr(&again));
    let traces = |name: &str| fs::read_to_string(at.join(name).join("traces.csv")).unwrap();
    assert_eq!(traces("beat"), traces("again"));
    assert!(traces("again").lines().next().unwrap().contains("thickness_um"));
    let mesh =
        myospring(at, &[&["mesh", "--stack", "cell.tif", "--output", "mesh"][..], &scale].concat());
    assert!(stdout(&mesh).contains("cubes in thickness"), "{}", stdout(&mesh));
    let both = [&run[..], &["--thickness", "8 um", "--force"]].concat();
    let both = myospring(at, &both);
    assert!(!both.status.success() && stderr(&both).contains("thickness"), "{}", stderr(&both));
    let missing = myospring(at, &["run", "--stack", "cell.tif", "--pixel-size", "0.5 um"]);
    assert!(
        !missing.status.success() && stderr(&missing).contains("--z-step"),
        "{}",
        stderr(&missing)
    );
}

#[test]
fn a_batch_beats_the_cell_of_each_stack() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    for name in ["a.tif", "b.tif"] {
        fs::create_dir_all(at.join("stacks")).unwrap();
        let mut encoder =
            TiffEncoder::new(fs::File::create(at.join("stacks").join(name)).unwrap()).unwrap();
        // Blocks of 60 x 16 um, 8 and 12 um thick.
        let [first, last] = if name == "a.tif" { [2, 10] } else { [2, 14] };
        for slice in 0..16 {
            let inside = |at: usize| {
                let within = (10..130).contains(&(at % 140)) && (10..42).contains(&(at / 140));
                if within && (first..last).contains(&slice) { 255 } else { 0 }
            };
            let pixels: Vec<u8> = (0..140 * 52).map(inside).collect();
            encoder.write_image::<Gray8>(140, 52, &pixels).unwrap();
        }
    }
    fs::write(at.join("table.csv"), "stack,z_step,group\na.tif,1.5 um,tall\nb.tif,,usual\n")
        .unwrap();
    let scale = ["--pixel-size", "0.5 um", "--z-step", "1 um", "--spacing", "2 um"];
    let rows = |command: &[&str]| {
        let done = myospring(at, &[command, &scale[..]].concat());
        assert!(done.status.success(), "{}", stderr(&done));
        let text =
            fs::read_to_string(at.join(command[command.len() - 1]).join("cells.csv")).unwrap();
        let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
        let names = lines.next().unwrap();
        let place = names.iter().position(|name| *name == "largest_thickness_um").unwrap();
        lines.map(|row| row[place].parse::<f64>().unwrap()).collect::<Vec<f64>>()
    };
    assert_eq!(rows(&["batch", "stacks", "--stacks", "--output", "folder"]), [8.0, 12.0]);
    assert_eq!(
        rows(&["batch", "stacks", "--table", "table.csv", "--figures", "--output", "table"]),
        [12.0, 12.0]
    );
    let slices = fs::read_to_string(at.join("table/cells.csv")).unwrap();
    assert!(slices.lines().next().unwrap().contains("slices_in_cell"), "{slices}");
    for file in ["overlays/a_tif.png", "thumbnails/a_tif_1.png", "cells/a_tif_1/traces.csv"] {
        assert!(at.join("table").join(file).is_file(), "{file}");
    }
    fs::write(at.join("stacks/notes.png"), "").unwrap();
    let again = ["batch", "stacks", "--stacks", "--output", "folder"];
    let again = myospring(at, &[&again[..], &scale[..]].concat());
    let said = stderr(&again) + &stdout(&again);
    assert!(again.status.success() && said.contains("not stacks"), "{said}");
    let own = ["run", "table/cells/a_tif_1/run.toml", "--output", "own", "--outputs", "none"];
    let own = myospring(at, &own);
    assert!(own.status.success(), "{}", stderr(&own));
    let named = myospring(at, &["batch", "stacks", "--stack", "stacks/a.tif", "--output", "named"]);
    assert!(!named.status.success() && stderr(&named).contains("--stacks"), "{}", stderr(&named));
    assert!(!at.join("named").exists());
}

#[test]
fn the_mesh_of_a_thick_cell_is_as_thick_as_stated_and_that_of_a_beat() {
    let folder = tempfile::tempdir().unwrap();
    let round = ["--profile", "dome", "--thickness", "8 um", "--spacing", "3 um"];
    let done = |command: &[&str]| {
        let done = myospring(folder.path(), &[command, &round[..]].concat());
        assert!(done.status.success(), "{}", stderr(&done));
        stdout(&done)
    };
    let numbers: serde_json::Value =
        serde_json::from_str(&done(&["mesh", "--json", "--output", "mesh"])).unwrap();
    // Whole cubes: to half of one.
    let thickness = numbers["thick"]["thickness_um"].as_f64().unwrap();
    assert!((thickness - 8.0).abs() <= 1.5, "{numbers}");
    done(&["run", "--output", "beat", "--outputs", "none"]);
    let summary = fs::read_to_string(folder.path().join("beat/summary.json")).unwrap();
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    assert_eq!(summary["mesh"]["thick"], numbers["thick"]);
    let flat = ["mesh", "--thickness", "8 um", "--spacing", "3 um", "--output", "flat"];
    let flat = myospring(folder.path(), &flat);
    assert!(flat.status.success() && stderr(&flat).contains("--profile"), "{}", stderr(&flat));
}

#[test]
#[ignore = "slow"]
fn a_thick_cell_serves_studies_and_fits_and_says_what_it_cannot() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let round = ["--profile", "dome", "--thickness", "8 um", "--spacing", "3 um"];
    let beat =
        myospring(at, &[&["run", "--output", "beat", "--outputs", "none"][..], &round].concat());
    assert!(beat.status.success(), "{}", stderr(&beat));
    // Its own curve gives its own strength.
    let fit = ["fit", "--to", "beat/traces.csv", "--model", "coelho_2021", "--output", "fit"];
    let fit = myospring(at, &[&fit[..], &round].concat());
    assert!(fit.status.success(), "{}", stderr(&fit));
    let factors = ["compare", "--scale", "thickness=0.9", "--output", "thinner"];
    let thinner = myospring(at, &[&factors[..], &round].concat());
    assert!(thinner.status.success(), "{}", stderr(&thinner));
    for (options, says) in [
        (&["--profile", "dome", "--area-law", "printed"][..], "poisson_ratio"),
        (&["--helix-angle", "20 deg"], "--profile"),
        (&["--profile", "flat", "--z-step", "1 um"], "--stack"),
        (
            &["--profile", "slab", "--spacing", "12 um", "--thickness", "30 um"],
            "a third of the cell's width",
        ),
        (&["--profile", "slab", "--active", "ends"], "active = \"fibre\""),
    ] {
        let refused = myospring(at, &[&["run", "--output", "refused"][..], options].concat());
        assert!(!refused.status.success(), "{options:?}");
        assert!(stderr(&refused).contains(says), "{options:?}: {}", stderr(&refused));
        assert!(!at.join("refused").exists());
    }
}
