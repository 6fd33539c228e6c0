//! Runs along the path of equilibria, free and supported.

use std::fs;

use super::{QUICK, json, myospring, names, stderr, stdout};

#[test]
fn a_quasi_static_run_writes_the_same_results_as_one_in_time_and_says_what_it_took() {
    let folder = tempfile::tempdir().unwrap();
    let run = |name: &str| {
        let method = ["--integrator", name, "--output", name, "--json"];
        let output = myospring(folder.path(), &[&QUICK[..], &method].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        json(&output)
    };
    let (verlet, path) = (run("verlet"), run("quasi-static"));
    let peak = |summary: &serde_json::Value| {
        let metrics = summary["beats"][0]["contraction"].as_array().unwrap();
        let peak = metrics.iter().find(|metric| metric["name"] == "peak_shortening").unwrap();
        peak["value"].as_f64().unwrap()
    };
    // A thousandth: the motion overshoots a little.
    assert!((peak(&path) / peak(&verlet) - 1.0).abs() < 1e-3);
    assert_eq!(verlet["integration"]["integrator"], "verlet");
    let took = &path["integration"];
    assert_eq!(took["integrator"], "quasi-static");
    assert!(took["load_steps"].as_u64().unwrap() < 10, "{took}");
    assert!(took["factorisations"].as_u64() >= took["newton_iterations"].as_u64(), "{took}");
    assert!(took["interpolation_error_um"].as_f64().unwrap() < 1e-3, "{took}");
    assert!(took["delay_ms"].as_f64().unwrap() < 1.0, "{took}");

    let [verlet, path] = ["verlet", "quasi-static"].map(|name| folder.path().join(name));
    assert_eq!(names(&verlet), names(&path));
    assert_eq!(names(&verlet.join("figures")), names(&path.join("figures")));
    let [one, other] = [&verlet, &path].map(|results| {
        let text = fs::read_to_string(results.join("traces.csv")).unwrap();
        (text.lines().count(), text.lines().next().unwrap().to_owned())
    });
    assert_eq!(one, other);
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(path.join("run.json")).unwrap()).unwrap();
    assert_eq!(record["load_steps"], took["load_steps"]);
    // What it wrote repeats it, to the bit.
    let again = ["run", "quasi-static/run.toml", "--output", "again"];
    let output = myospring(folder.path(), &again);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("quasi-static: "), "{}", stdout(&output));
    let [first, second] =
        ["quasi-static", "again"].map(|name| fs::read(folder.path().join(name).join("traces.csv")));
    assert_eq!(first.unwrap(), second.unwrap());
    // And the run file of the one in time, whose step is of no use, can be run the other way.
    let other = ["run", "verlet/run.toml", "--integrator", "quasi-static", "--dry-run"];
    let output = myospring(folder.path(), &other);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(stdout(&output).contains("load steps"), "{}", stdout(&output));
}

#[test]
fn a_quasi_static_run_that_buckles_says_where_and_keeps_what_it_has() {
    let folder = tempfile::tempdir().unwrap();
    // Fibres across a strip between clamps press on it lengthwise, and its middle gives way.
    let corners = "x_um,y_um\n0,0\n100,0\n100,8\n0,8\n";
    fs::write(folder.path().join("strip.csv"), corners).unwrap();
    let run = [
        "run",
        "strip.csv",
        "--spacing",
        "1 um",
        "--integrator",
        "quasi-static",
        "--support",
        "clamped-ends",
        "--fibre",
        "90 deg",
    ];
    let output = myospring(folder.path(), &run);
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    for part in ["stopped early", "unstable beyond", "kPa", "near x = 50.0 um", "t = ", "Verlet"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    let results = folder.path().join("results/strip");
    assert!(fs::read_to_string(results.join("traces.csv")).unwrap().lines().count() > 50);
    assert!(results.join("figures/contraction.png").exists());
    let output = myospring(folder.path(), &[&run[..], &["--dry-run"]].concat());
    assert!(stderr(&output).contains("will stop early"), "{}", stderr(&output));
}

#[test]
fn supports_that_give_way_shorten_less_than_none() {
    let folder = tempfile::tempdir().unwrap();
    let shortening = |support: &[&str]| {
        let run = ["run", "--spacing", "4 um", "--integrator", "quasi-static", "--json", "--force"];
        let output = myospring(folder.path(), &[&run[..], support].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let summary = json(&output);
        let metrics = summary["beats"][0]["contraction"].as_array().unwrap();
        let peak = metrics.iter().find(|metric| metric["name"] == "peak_shortening").unwrap();
        peak["value"].as_f64().unwrap()
    };
    let free = shortening(&[]);
    let gel = shortening(&["--support", "elastic-bed", "--bed-stiffness", "0.5 kPa/um"]);
    let fibres = shortening(&["--support", "spring-held-ends", "--end-stiffness", "0.3 N/m"]);
    assert!(gel < 0.95 * free && fibres < 0.95 * free, "{free}, {gel}, {fibres} %");
}

#[test]
fn end_loads_that_buckle_the_cell_are_warned_about() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &["run", "--dry-run", "--active", "ends"]);
    let message = stderr(&output);
    assert!(message.contains("buckles above about") && message.contains("fibre"), "{message}");
}
