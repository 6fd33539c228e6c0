//! `myospring fit`: a cell's own parameters from its curve.

use super::{json, myospring, names, stderr, stdout};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

/// A coarse mesh: quick, and still a cell.
const SPACING: [&str; 2] = ["--spacing", "4 um"];

/// Evenly in [0, 1), the same on every machine (`SplitMix64`).
fn scattered(number: usize) -> f64 {
    let mut bits = (number as u64 + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((bits ^ (bits >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// The length of the built-in cell at 40 kPa, 250 frames a second, with noise that repeats; `columns` times.
fn measured(folder: &Path, columns: usize) {
    let beat = ["run", "--quiet", "--integrator", "quasi-static", "--peak-tension", "40 kPa"];
    let rest = ["--outputs", "none", "--output", "truth"];
    let output = myospring(folder, &[&beat[..], &SPACING, &rest].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let traces = fs::read_to_string(folder.join("truth/traces.csv")).unwrap();
    let mut lines = traces.lines();
    let place = lines.next().unwrap().split(',').position(|name| name == "length_um").unwrap();
    let mut text = "t_ms".to_owned();
    (0..columns).for_each(|column| write!(text, ",length {column} (um)").unwrap());
    for (frame, line) in lines.step_by(8).enumerate() {
        let fields: Vec<f64> =
            line.split(',').map(|field| field.parse().unwrap_or(f64::NAN)).collect();
        write!(text, "\n{}", fields[0]).unwrap();
        for column in 0..columns {
            let noise = 0.2 * scattered(frame * columns + column) - 0.1;
            // The last of several does not beat.
            let length = if columns > 1 && column + 1 == columns { 140.0 } else { fields[place] };
            write!(text, ",{:.4}", length + noise).unwrap();
        }
    }
    fs::write(folder.join("cell.csv"), text).unwrap();
}

#[test]
fn a_curve_gives_numbers_with_intervals_a_figure_and_a_run_that_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 1);
    let arguments = [&["fit", "--to", "cell.csv"][..], &SPACING].concat();
    let output = myospring(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.starts_with("coelho_2021 fits. Of the 7 models that were tried"), "{text}");
    assert!(text.contains("land_2017 ") && text.contains("does not fit"), "{text}");
    assert!(text.contains("tension_over_stiffness") && text.contains("95 % interval"), "{text}");
    // What a length alone does not tell is said.
    assert!(stderr(&output).contains("not either"), "{}", stderr(&output));
    let results = folder.path().join("results/cell_fit");
    let files = ["curve.csv", "figures", "fit.json", "models.csv", "report.html", "run.toml"];
    assert_eq!(names(&results), files);
    assert_eq!(names(&results.join("figures")), ["fit.png", "fit.svg"]);
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(results.join("fit.json")).unwrap()).unwrap();
    let ratio = record["estimates"][0]["value"].as_f64().unwrap();
    assert!((ratio / (40.0 / 308.0) - 1.0).abs() < 0.01, "{ratio}");
    assert_eq!(record["estimates"][0]["verdict"], "determined");
    assert_eq!(record["verdict"], "fits");

    let shortening = |arguments: &[&str]| {
        let common = ["--json", "--quiet", "--outputs", "none", "--output", "again", "--force"];
        let record = json(&myospring(folder.path(), &[&["run"], arguments, &common].concat()));
        let metrics = record["beats"][0]["contraction"].as_array().unwrap();
        let peak = metrics.iter().find(|metric| metric["name"] == "peak_shortening").unwrap();
        peak["value"].as_f64().unwrap()
    };
    let truth = ["--integrator", "quasi-static", "--peak-tension", "40 kPa"];
    let off =
        shortening(&["results/cell_fit/run.toml"]) - shortening(&[&truth[..], &SPACING].concat());
    assert!(off.abs() < 0.1, "{off} percentage points");
}

#[test]
fn a_model_that_does_not_fit_is_said_before_any_number_and_in_every_file() {
    let folder = tempfile::tempdir().unwrap();
    // A square wave is no beat of a cell.
    let rows: String =
        (0..160).fold("t_ms,a length (um),b length (um)".to_owned(), |text, frame| {
            let length = if (30..90).contains(&frame) { 90.0 } else { 100.0 };
            let value = length + 0.02 * scattered(frame);
            text + &format!(
                "\n{},{value:.4},{:.4}",
                4 * frame,
                value + 0.02 * scattered(frame + 999)
            )
        });
    fs::write(folder.path().join("wave.csv"), rows).unwrap();
    let of_model = [&SPACING[..], &["--model", "coelho_2021"]].concat();
    let one = ["fit", "--to", "wave.csv", "--columns", "a length (um)", "--starts", "2"];
    let output = myospring(folder.path(), &[&one[..], &of_model].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    assert!(text.starts_with("The model does not fit.\n"), "{text}");
    assert!(text.contains("none") && !text.contains("determined"), "{text}");
    assert!(stderr(&output).contains("do not use these numbers"), "{}", stderr(&output));
    let results = folder.path().join("results/wave_fit");
    let read = |name: &str| fs::read_to_string(results.join(name)).unwrap();
    let record: serde_json::Value = serde_json::from_str(&read("fit.json")).unwrap();
    assert_eq!(record["verdict"], "does-not-fit");
    for estimate in record["estimates"].as_array().unwrap() {
        assert!(estimate["interval"].as_array().unwrap().iter().all(serde_json::Value::is_null));
    }
    assert!(read("report.html").contains("The model does not fit."));
    assert!(read("figures/fit.svg").contains("The model does not fit"));
    let both = ["fit", "--to", "wave.csv", "--starts", "2"];
    let output = myospring(folder.path(), &[&both[..], &of_model].concat());
    assert_eq!(stdout(&output).matches("does not fit").count(), 2, "{}", stdout(&output));
    let table = fs::read_to_string(folder.path().join("results/wave_fits/fits.csv")).unwrap();
    assert_eq!(table.matches(",does-not-fit,").count(), 2, "{table}");
}

#[test]
fn several_columns_of_one_cell_are_one_fit_and_it_is_said_which() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 1);
    let cell = fs::read_to_string(folder.path().join("cell.csv")).unwrap();
    let mut track = "t_ms,length_um,width_um,stretch_1,stretch_2".to_owned();
    for line in cell.lines().skip(1) {
        let (time, length) = line.split_once(',').unwrap();
        let stretch = length.parse::<f64>().unwrap() / 140.0;
        write!(track, "\n{time},{length},20,{stretch:.6},{:.6}", 2.0 - stretch).unwrap();
    }
    fs::write(folder.path().join("track.csv"), track).unwrap();
    let rest = ["--until", "400 ms", "--starts", "1", "--json"];
    let output =
        myospring(folder.path(), &[&["fit", "--to", "track.csv"], &SPACING[..], &rest].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let said = stderr(&output).split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(said.contains("fitted: `stretch_1`; not fitted"), "{said}");
    let results = folder.path().join("results/track_fit");
    let curve = fs::read_to_string(results.join("curve.csv")).unwrap();
    assert!((80..=101).contains(&(curve.lines().count() - 1)), "{}", curve.lines().count());
}

#[test]
#[ignore = "slow"]
fn a_film_gives_a_map_of_where_its_cell_pulls() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("film")).unwrap();
    // One beat of 5 %, before and after it rest, whose grains differ from frame to frame.
    let beat = [0.01, 0.03, 0.045, 0.05, 0.05, 0.048, 0.04, 0.03, 0.02, 0.012, 0.006, 0.003];
    let rest = (0..12).map(|frame| 1e-4 * f64::from(frame % 5));
    let shortenings = rest.clone().chain(beat).chain(rest);
    for (at, shortening) in shortenings.enumerate() {
        super::track::frame(&folder.path().join(format!("film/t{at}.png")), shortening);
    }
    let given = ["--pixel-size", "0.25 um", "--frame-rate", "40", "--spacing", "2 um"];
    let output =
        myospring(folder.path(), &[&["fit", "film", "--starts", "1"], &given[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("tension at the peak ("), "{}", stdout(&output));
    // A stretch has small noise, which is not called none.
    assert!(!stdout(&output).contains("noise at rest 0.000\n"), "{}", stdout(&output));
    assert!(
        stderr(&output).contains("proportional to the assumed stiffness"),
        "{}",
        stderr(&output)
    );
    let results = folder.path().join("results/film_fit");
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(results.join("fit.json")).unwrap()).unwrap();
    let map = &record["tension_map"];
    assert!(map["mean_tension_kpa"].as_f64().unwrap() > 5.0, "{map}");
    let page = fs::read_to_string(results.join("report.html")).unwrap();
    // Both cells over the film, at their peak, and two of the map, each for light and for dark.
    let figures = page.matches("data:image/svg+xml;base64,").count();
    assert!(page.contains("Where the cell pulls, over a beat") && figures == 8, "{figures}");
    assert!(page.contains("The fitted cell over the film"));
    // The film is of an even contraction, which the fitted cell follows: within some hundredths of its 50 um.
    let shapes = &record["shapes"];
    let number = |key: &str| shapes[key].as_f64().unwrap();
    assert!(number("distance_root_mean_square_um") < 0.15, "{shapes}");
    assert!(number("distance_largest_um") < 0.6, "{shapes}");
    let strains = ["measured", "fitted"].map(|of| number(&format!("{of}_fibre_strain_mean_pct")));
    assert!(strains.iter().all(|strain| (-5.5..-4.0).contains(strain)), "{shapes}");
    // The model's beat has another form than this one, and a sharper peak.
    assert!((strains[0] - strains[1]).abs() < 0.6, "{shapes}");
    for figure in ["tension_map.png", "tension_over_beat.png", "overlay.png", "overlay.gif"] {
        assert!(names(&results.join("figures")).contains(&figure.to_owned()), "{figure}");
    }
    let gif = fs::read(results.join("figures/overlay.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a") && gif.len() < 3_000_000, "{}", gif.len());
    let svg = fs::read_to_string(results.join("figures/overlay.svg")).unwrap();
    for words in ["at rest, ", "contracting, ", "peak, ", "relaxing, ", "the fitted cell, peak"] {
        assert!(svg.contains(words), "{words}");
    }
    assert!(svg.contains(": the beat of the film"), "the film has one beat");
    distances_are_those_of(shapes, &results);
    let table = fs::read_to_string(results.join("tension_map.csv")).unwrap();
    let head = "triangle,x_um,y_um,tension_kPa,standard_deviation_kPa,relative_tension";
    assert!(table.starts_with(head) && table.lines().count() > 100);
}

/// Checks `distances.csv` against `shapes` in `fit.json`.
fn distances_are_those_of(shapes: &serde_json::Value, results: &Path) {
    let table = fs::read_to_string(results.join("distances.csv")).unwrap();
    let head = "frame,t_ms,distance_um,movement_um,distance_pct_of_largest_movement";
    assert_eq!(table.lines().next(), Some(head));
    let rows: Vec<Vec<f64>> = (table.lines().skip(1))
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    // 36 frames, 25 ms apart; the run may begin after the first ones.
    assert_eq!(shapes["film_frames"].as_u64(), Some(rows.len() as u64));
    assert!((25..=36).contains(&rows.len()), "{}", rows.len());
    let mean = |column: usize| {
        (rows.iter().map(|row| row[column].powi(2)).sum::<f64>() / rows.len() as f64).sqrt()
    };
    let number = |key: &str| shapes[key].as_f64().unwrap();
    assert!((mean(2) - number("film_distance_root_mean_square_um")).abs() < 1e-9, "{shapes}");
    assert!((mean(3) - number("film_movement_root_mean_square_um")).abs() < 1e-9, "{shapes}");
    let most = rows.iter().map(|row| row[3]).fold(0.0, f64::max);
    // A strip of 50 um that shortens by 5 %: 2.5 um over the square root of 12.
    assert!((most - 0.72).abs() < 0.15, "{most}");
    for row in &rows {
        assert!(row.iter().all(|value| value.is_finite()), "{row:?}");
        assert!((row[1] - 25.0 * row[0]).abs() < 1e-9, "{row:?}");
        assert!((row[4] - 100.0 * row[2] / most).abs() < 1e-9, "{row:?}");
        assert!(row[2] < 0.4 * most, "the fitted cell follows the film: {row:?}");
    }
}

#[test]
fn several_columns_are_several_cells_and_one_that_cannot_be_fitted_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 3);
    let arguments =
        [&["fit", "--to", "cell.csv", "--quiet", "--starts", "2"][..], &SPACING].concat();
    let output = myospring(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let results = folder.path().join("results/cell_fits");
    assert_eq!(names(&results.join("cells")), ["1", "2"]);
    let rows = fs::read_to_string(results.join("fits.csv")).unwrap();
    let statuses: Vec<bool> = rows.lines().skip(1).map(|row| row.contains(",ok,")).collect();
    assert_eq!(statuses, [true, true, false], "{rows}");
    assert!(rows.lines().next().unwrap().contains("c_0_from_1_per_ms"), "{rows}");
}

#[test]
#[ignore = "slow"]
fn what_cannot_be_fitted_is_said_with_how_to_mend_it() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 1);
    let said = |more: &[&str]| {
        let output = myospring(folder.path(), &[&["fit", "--to", "cell.csv"], more].concat());
        assert_eq!(output.status.code(), Some(2), "{more:?}: {}", stdout(&output));
        stderr(&output)
    };
    assert!(said(&["--free", "tau_zz"]).contains("coelho_2021 has no such parameter"));
    assert!(said(&["--fix", "x_3"]).contains("fitted are tension_over_stiffness, c_0"));
    assert!(said(&["--bounds", "c_0=3:1"]).contains("must be above 0, in ascending order"));
    assert!(said(&["--bounds", "c_0"]).contains("--bounds c_0=0.01:0.05"));
    assert!(said(&["--support", "clamped-ends"]).contains("the ends of this cell are held"));
    assert!(said(&["--loaded", "cell.csv"]).contains("100 nN/um=fibres.csv"));
    let output = myospring(folder.path(), &["fit"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("myospring fit cell.csv"), "{}", stderr(&output));
    let still: String =
        (0..99).fold("t_ms,length_um".to_owned(), |text, t| text + &format!("\n{t},100"));
    fs::write(folder.path().join("cell.csv"), still).unwrap();
    assert!(said(&[]).contains("there is no beat"));
    let results = folder.path().join("results");
    assert!(!results.exists() || names(&results).is_empty(), "nothing is left behind");
}

#[test]
fn a_table_alone_is_the_curve() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 1);
    let numbers = |command: &[&str]| {
        let output = myospring(folder.path(), &[command, &["--json", "--force"]].concat());
        assert!(output.status.success(), "{}", stderr(&output));
        stdout(&output)
    };
    let model = ["--model", "coelho_2021", "--output", "fitted"];
    let alone = numbers(&[&["fit", "cell.csv"][..], &model].concat());
    assert_eq!(alone, numbers(&[&["fit", "--to", "cell.csv"][..], &model].concat()));
}

#[test]
fn a_folder_of_tables_is_several_cells_and_one_that_cannot_be_read_is_a_row() {
    let folder = tempfile::tempdir().unwrap();
    measured(folder.path(), 1);
    let cells = folder.path().join("cells");
    fs::create_dir(&cells).unwrap();
    for name in ["a.csv", "c.csv"] {
        fs::copy(folder.path().join("cell.csv"), cells.join(name)).unwrap();
    }
    fs::write(cells.join("b.csv"), "no table\n").unwrap();
    let output = myospring(folder.path(), &["fit", "--to", "cells", "--starts", "1"]);
    assert_eq!(output.status.code(), Some(1), "{}", stderr(&output));
    let said = stdout(&output);
    let places = ["a ", "b", "c "].map(|name| said.find(&format!("\n{name}")));
    assert!(places.is_sorted() && places[0].is_some(), "{said}");
    let analysed = myospring(folder.path(), &["analyse", "cells"]);
    assert_eq!(analysed.status.code(), Some(1));
    assert!(stderr(&analysed).contains("b.csv"), "{}", stderr(&analysed));
    assert!(stdout(&analysed).contains("c.csv"), "{}", stdout(&analysed));
    fs::remove_file(cells.join("a.csv")).unwrap();
    fs::remove_file(cells.join("c.csv")).unwrap();
    let none = myospring(folder.path(), &["fit", "--to", "cells"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(stderr(&none).contains("b.csv"), "{}", stderr(&none));
}
