//! `myospring compare`: results and runs side by side, factors, doses.

use super::myospring;
use std::fs;
use std::path::Path;

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// What `compare --json` printed.
fn compared(folder: &Path, arguments: &[&str]) -> serde_json::Value {
    let quick = ["compare", "--json", "--force"];
    let output = myospring(folder, &[&quick[..], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn numbers(record: &serde_json::Value, metric: &str, of: &str) -> Vec<f64> {
    let rows = record["metrics"].as_array().unwrap();
    let row = rows.iter().find(|row| row["name"] == metric).unwrap();
    row[of].as_array().unwrap().iter().map(|value| value.as_f64().unwrap()).collect()
}

/// A coarse cell along its equilibria: quick.
const QUICK: &str = "[shape]\nspacing = \"4 um\"\n[numerics]\nintegrator = \"quasi-static\"\n";

fn run_file(folder: &Path, name: &str, more: &str) {
    fs::write(folder.join(name), format!("{more}\n{QUICK}")).unwrap();
}

fn beaten(folder: &Path, file: &str, to: &str, outputs: &str) {
    let output = myospring(folder, &["run", file, "-o", to, "--outputs", outputs]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
}

#[test]
fn three_tensions_give_the_curves_of_figure_6_over_each_other() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    for tension in ["30", "40", "50"] {
        let file = format!("{tension}.toml");
        fs::write(place.join(file), format!("[cell]\npeak_tension = \"{tension} kPa\"\n")).unwrap();
    }
    let files = ["30.toml", "40.toml", "50.toml", "--integrator", "quasi-static"];
    let record = compared(place, &files);
    let shortening = numbers(&record, "peak_shortening", "values");
    // The paper's 12 % at 50 kPa, and growing with the tension.
    assert!((shortening[2] - 12.0).abs() < 0.2, "{shortening:?}");
    assert!(shortening.windows(2).all(|pair| pair[0] < pair[1]), "{shortening:?}");
    assert_eq!(record["settings"].as_array().unwrap().len(), 1, "{}", record["settings"]);
    assert_eq!(record["warnings"], serde_json::json!([]));
    let results = place.join("results/comparison");
    for figure in ["contraction", "compared"] {
        let svg = fs::read_to_string(results.join(format!("figures/{figure}.svg"))).unwrap();
        for label in ["30: 7.6 %", "40: 9.9 %", "50: 12.0 %"] {
            assert!(svg.contains(label), "{figure}: {label}");
        }
    }
    // The same three as factors on one run.
    let scaled = ["50.toml", "--integrator", "quasi-static", "--scale", "peak_tension=0.6"];
    let scaled = compared(place, &[&scaled[..], &["--scale", "peak_tension=0.8"]].concat());
    let again = numbers(&scaled, "peak_shortening", "values");
    assert_eq!([again[1], again[2], again[0]], shortening[..]);
    assert_eq!(scaled["runs"][1]["scaled"][0]["key"], "cell.peak_tension");
}

#[test]
fn runs_that_differ_in_a_label_differ_by_nothing_and_a_result_is_its_run() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    run_file(place, "a.toml", "title = \"one\"");
    run_file(place, "b.toml", "title = \"<script>alert(1)</script>\"");
    beaten(place, "a.toml", "frames", "frames");
    beaten(place, "b.toml", "curves", "none");
    let sides = ["frames", "curves", "a.toml"];
    let record = compared(place, &sides);
    assert_eq!(record["settings"], serde_json::json!([]));
    for row in record["metrics"].as_array().unwrap() {
        for difference in row["differences"].as_array().unwrap() {
            assert!(difference.is_null() || difference == 0.0, "{row}");
        }
    }
    let results = place.join("results/comparison");
    let svg = fs::read_to_string(results.join("figures/compared.svg")).unwrap();
    assert!(svg.contains("&lt;script&gt;") && !svg.contains("<script"), "a title is only text");
    let page = fs::read_to_string(results.join("report.html")).unwrap();
    assert!(page.contains("alert(1)") && !page.contains("<script>alert(1)"), "on the page, too");
    // All three cells, two of which had to be beaten for it.
    assert!(svg.contains("at peak"));
    let output = myospring(place, &[&["compare", "--force"], &sides[..]].concat());
    let said = text(&output.stdout);
    assert!(said.contains("the runs do not differ in any number"), "{said}");
    assert!(said.contains("the runs have the same settings"), "{said}");
    assert!(said.contains("open results/comparison/report.html"), "{said}");
    let table = fs::read_to_string(results.join("metrics.csv")).unwrap();
    assert!(table.starts_with("metric,run,value,unit,difference,difference_unit,difference_pct\n"));
}

#[test]
fn other_pacing_and_another_mesh_are_compared_with_a_warning_that_says_what_else_differs() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    run_file(place, "slow.toml", "");
    let fast =
        "[stimulus]\nbeats = 2\ncycle_length = \"500 ms\"\n[cell]\npeak_tension = \"40 kPa\"";
    run_file(place, "fast.toml", fast);
    let record = compared(place, &["slow.toml", "fast.toml"]);
    let warnings = record["warnings"].as_array().unwrap();
    let [pacing] = &warnings[..] else { panic!("{warnings:?}") };
    let pacing = pacing.as_str().unwrap();
    assert!(pacing.starts_with("the runs differ in their pacing"), "{pacing}");
    assert!(
        pacing.contains("stimulus.cycle_length is") && pacing.contains("500 ms in fast"),
        "{pacing}"
    );
    let keys: Vec<&str> = record["settings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|different| different["key"].as_str().unwrap())
        .collect();
    assert!(keys.contains(&"cell.peak_tension") && keys.contains(&"run.duration"), "{keys:?}");
}

#[test]
fn a_drug_is_a_control_and_a_series_of_doses() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    run_file(place, "cell.toml", "");
    let drug = "[[drug]]\nname = \"x\"\nparameter = \"peak_tension\"\nconcentration = [\"100 nM\", \"1 uM\"]\n\
                ic50 = \"1 uM\"\nmaximal_effect = -0.8\n\
                [[drug]]\nname = \"x\"\nparameter = \"tau_si\"\nconcentration = [\"0.1 uM\", \"1 uM\"]\nic50 = \"1 uM\"\n\
                maximal_effect = 0.04\n";
    fs::write(place.join("drug.toml"), drug).unwrap();
    let record = compared(place, &["cell.toml", "--doses", "drug.toml"]);
    let labels: Vec<&str> = record["runs"]
        .as_array()
        .unwrap()
        .iter()
        .map(|run| run["label"].as_str().unwrap())
        .collect();
    assert_eq!(labels, ["control", "x 0.1 uM", "x 1 uM"]);
    let scaled = &record["runs"][2]["scaled"];
    // Half of the effect at the IC50.
    assert_eq!(scaled[0]["factor"], 0.6);
    assert!((scaled[1]["factor"].as_f64().unwrap() - 1.02).abs() < 1e-12, "{scaled}");
    let warned = record["warnings"].to_string();
    assert!(
        warned.contains("phenomenological") && warned.contains("no single channel"),
        "{warned}"
    );
    let peaks = numbers(&record, "peak_tension", "values");
    assert!(peaks[0] > peaks[1] && peaks[1] > peaks[2], "{peaks:?}");
}

#[test]
fn a_factor_changes_a_run_and_stands_in_what_repeats_it() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    run_file(place, "cell.toml", "");
    let run = ["run", "cell.toml", "--outputs", "none", "-o", "weak", "--scale"];
    let output = myospring(place, &[&run[..], &["peak_tension=0.7,tau_si=1.01"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let written = fs::read_to_string(place.join("weak/run.toml")).unwrap();
    assert!(
        written.contains("peak_tension = \"35 kPa\"") && written.contains("tau_si = "),
        "{written}"
    );
}

#[test]
fn what_cannot_be_compared_says_why_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path();
    run_file(place, "cell.toml", "");
    fs::create_dir(place.join("empty")).unwrap();
    beaten(place, "cell.toml", "results/cell", "none");
    fs::write(place.join("drug.toml"), "[drug]\nparameter = \"tau_si\"\n").unwrap();
    for (arguments, said) in [
        (&["cell.toml"][..], "a comparison needs two or more runs"),
        (&["cell.toml", "empty"], "`empty` is an empty folder"),
        (&["cell.toml", "none.toml"], "cannot read `none.toml`"),
        (&["cell.toml", "--scale", "tau_sii=2"], "the nearest are tau_si"),
        (&["cell.toml", "--scale", "tau_si"], "like tau_si=1.2"),
        // A model whose tension is in kPa has no peak tension that is given.
        (
            &["--model", "land_2017", "--scale", "peak_tension=0.6"],
            "peak_tension × 0.6: `cell.peak_tension` has no value in this run",
        ),
        (&["cell.toml", "--scale", "tau_si=2,tau_si=3"], "two factors"),
        (&["cell.toml", "--doses", "drug.toml"], "drug.toml: drug 1: missing field"),
        (&["results/cell", "cell.toml", "--spacing", "3 um"], "options cannot change them"),
    ] {
        let output = myospring(place, &[&["compare"], arguments].concat());
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        let message = text(&output.stderr);
        assert!(message.contains(said), "{arguments:?}: {message}");
        assert!(!place.join("results/comparison").exists(), "{arguments:?}");
    }
}
