//! The program as people meet it: output, files, exit codes.

#![allow(clippy::unwrap_used, reason = "a test may stop here")]

mod analyse;
#[path = "../../../myospring/tests/common/bead_film.rs"]
mod bead_film;
mod compare;
mod damaged;
mod drive;
mod equilibria;
mod fit;
mod loss;
mod outputs;
mod paper;
mod posts;
#[path = "../../../myospring/tests/common/skipped.rs"]
mod skipped;
#[path = "../../../myospring/tests/common/synthetic_cell.rs"]
mod synthetic_cell;
mod thick;
mod track;
mod traction;
mod tutorials;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn myospring(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_myospring"))
        .args(arguments)
        .current_dir(folder)
        .env_remove("COLUMNS")
        .output()
        .unwrap()
}

fn stdout(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

fn stderr(output: &Output) -> String {
    String::from_utf8(output.stderr.clone()).unwrap()
}

fn json(output: &Output) -> serde_json::Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|e| panic!("{e}: {}", stderr(output)))
}

/// What is in a folder, but for the list that every folder of results has.
fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.retain(|name| name != "myospring.sha256");
    names.sort();
    names
}

/// A coarse cell and a short time: quick, and still all of the program.
const QUICK: [&str; 5] = ["run", "--spacing", "4 um", "--duration", "300 ms"];

#[test]
fn a_run_writes_every_result_and_prints_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &QUICK);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    // The published tension shortens a free cell faster than any that was measured: a fact about the model, which
    // the user did nothing to cause.
    assert_eq!(stderr(&output), "");
    let text = stdout(&output);
    let row = |name: &str| text.lines().find(|line| line.starts_with(name)).unwrap();
    for (name, end) in [
        ("peak shortening", "%     7 to 12     in"),
        ("largest shortening rate", "L0/s  0.5 to 1.2  out, above"),
    ] {
        assert!(row(name).ends_with(end), "{text}");
    }
    let fact = "\nThe paper's tension curve rises faster than measured cells; \
                `--model land_2017` does not.\n";
    assert!(text.contains(fact), "{text}");

    let results = folder.path().join("results/adult_ventricular");
    let expected = ["figures", "report.html", "run.json", "run.toml", "summary.json", "traces.csv"];
    assert_eq!(names(&results), expected);
    assert_eq!(names(&folder.path().join("results")), ["adult_ventricular"], "no .part is left");
    assert_eq!(names(&results.join("figures")).len(), 10, "five figures as SVG and PNG");
    let traces = fs::read_to_string(results.join("traces.csv")).unwrap();
    assert!(traces.starts_with("t_ms,u,ta_kPa,length_um,width_um,area_um2,shortening_pct"));
    assert_eq!(traces.lines().count(), 602);
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(results.join("run.json")).unwrap()).unwrap();
    assert_eq!(record["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(record["shape_sha256"].as_str().unwrap().len(), 64);
    let stage = |name: &str| record["timings"][name].as_f64().unwrap();
    let stages =
        ["mesh_s", "preparation_s", "cell_s", "mechanics_s", "recording_s", "outputs_s"].map(stage);
    assert!(stages.iter().all(|seconds| *seconds > 0.0), "{stages:?}");
    // Each is measured on its own, so together they cannot take longer than all.
    assert!(stages.iter().sum::<f64>() <= stage("total_s"), "{stages:?}");
    let figures = &record["outputs"]["figures"];
    assert!(figures["seconds"].as_f64().unwrap() <= stage("outputs_s"), "{figures}");
    let files = names(&results.join("figures"));
    let sizes =
        files.iter().map(|name| results.join("figures").join(name).metadata().unwrap().len());
    assert_eq!(figures["bytes"].as_u64(), Some(sizes.sum()));
    assert!(
        text.contains("figures ") && text.contains("\nopen results/adult_ventricular/report.html"),
        "{text}"
    );
}

#[test]
fn the_resolved_run_file_repeats_the_run_to_the_bit() {
    let folder = tempfile::tempdir().unwrap();
    assert!(myospring(folder.path(), &QUICK).status.success());
    let first = folder.path().join("results/adult_ventricular");
    let run_file = first.join("run.toml");
    let again = ["run", run_file.to_str().unwrap(), "--output", "again"];
    let output = myospring(folder.path(), &again);
    assert!(output.status.success(), "{}", stderr(&output));
    let second = folder.path().join("again");
    for file in ["traces.csv", "run.toml", "summary.json"] {
        assert_eq!(fs::read(first.join(file)).unwrap(), fs::read(second.join(file)).unwrap());
    }
}

#[test]
fn a_beat_beyond_what_the_material_was_made_for_says_so_once_and_in_its_summary() {
    let folder = tempfile::tempdir().unwrap();
    let strong = ["--peak-tension", "500 kPa", "--integrator", "quasi-static"];
    let output = myospring(folder.path(), &[&QUICK[..], &strong].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stderr(&output);
    assert_eq!(text.matches("the material law was not made for that").count(), 1, "{text}");
    let summary = folder.path().join("results/adult_ventricular/summary.json");
    assert!(fs::read_to_string(summary).unwrap().contains("law was not made for that"));
}

#[test]
fn a_cell_that_becomes_longer_says_so_and_its_table_says_what_it_has_not() {
    let folder = tempfile::tempdir().unwrap();
    let across = ["--fibre", "90 deg", "--integrator", "quasi-static"];
    let output = myospring(folder.path(), &[&QUICK[..], &across].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let (table, warning) = (stdout(&output), stderr(&output));
    assert!(warning.contains("the cell becomes longer: by "), "{warning}");
    assert!(warning.contains("degrees from its long axis"), "{warning}");
    for words in ["peak lengthening", "none: the cell does not shorten", "peak tension"] {
        assert!(table.contains(words), "{words}: {table}");
    }
    let along = myospring(folder.path(), &[&QUICK[..], &["-o", "along"]].concat());
    assert!(!stdout(&along).contains("peak lengthening") && !stderr(&along).contains("longer"));
}

#[test]
fn results_are_not_overwritten_without_force() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("mine")).unwrap();
    fs::write(folder.path().join("mine/notes.txt"), "keep me").unwrap();
    let arguments = [&QUICK[..], &["--output", "mine"]].concat();
    let output = myospring(folder.path(), &arguments);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("`mine` already holds files"), "{}", stderr(&output));
    assert_eq!(names(&folder.path().join("mine")), ["notes.txt"]);

    let output = myospring(folder.path(), &[&arguments[..], &["--force"]].concat());
    assert_eq!(output.status.code(), Some(2), "{}", stderr(&output));
    assert_eq!(names(&folder.path().join("mine")), ["notes.txt"]);
}

#[test]
fn replaced_results_are_of_one_command() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    let output = myospring(folder.path(), &["mesh", "--spacing", "6 um", "-o", "mine"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(mine.join("mesh.json").exists());
    let output = myospring(folder.path(), &[&QUICK[..], &["-o", "mine", "--force"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(
        names(&mine),
        ["figures", "report.html", "run.json", "run.toml", "summary.json", "traces.csv"]
    );
    assert_eq!(names(&mine.join("figures")).len(), 10, "five figures twice");
}

#[test]
fn a_weaker_cell_shortens_less_and_a_strong_one_is_said_with_the_peak_tension_that_makes_it_usual()
{
    let folder = tempfile::tempdir().unwrap();
    let text = "[cell.parameters]\nx_3 = 0.0\nc_0 = \"0.012 1/ms\"\n";
    fs::write(folder.path().join("weak.toml"), text).unwrap();
    let peak = |more: &[&str]| {
        let run = ["run", "weak.toml", "--integrator", "quasi-static", "--json", "-o"];
        let output = myospring(folder.path(), &[&run[..], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let printed = json(&output);
        let metrics = printed["beats"][0].as_object().unwrap().values();
        let metrics: Vec<_> = metrics.filter_map(|group| group.as_array()).flatten().collect();
        let of = |name: &str| {
            let metric = metrics.iter().find(|metric| metric["name"] == name).unwrap();
            metric["value"].as_f64().unwrap()
        };
        [of("peak_tension"), of("peak_shortening")]
    };
    let weak = peak(&["weak"]);
    assert!(weak[0] < 49.0 && weak[1] < 11.8, "{weak:?}");
    let wanted = format!("{} kPa", 50.0 * 50.0 / weak[0]);
    let scaled = peak(&["scaled", "--peak-tension", &wanted]);
    assert!((scaled[0] - 50.0).abs() < 0.01 && (scaled[1] - 12.0).abs() < 0.1, "{scaled:?}");

    // A small change of the calcium current takes the tension to five times as much; that is said.
    fs::write(folder.path().join("strong.toml"), "[cell.parameters]\ntau_si = 1.4\n").unwrap();
    let strong = ["run", "strong.toml", "--integrator", "quasi-static", "--dry-run"];
    let said = stderr(&myospring(folder.path(), &strong));
    assert!(said.contains("times as strong") && said.contains("peak_tension = \""), "{said}");
}

#[test]
fn json_is_the_only_thing_on_stdout_when_asked_for() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &[&QUICK[..], &["--json"]].concat());
    let summary = json(&output);
    let metrics = summary["beats"][0]["contraction"].as_array().unwrap();
    let peak = metrics.iter().find(|metric| metric["name"] == "peak_shortening").unwrap();
    assert!((peak["value"].as_f64().unwrap() - 12.0).abs() < 1.0, "{peak}");
    assert_eq!(peak["unit"], "%");
    assert!(!peak["definition"].as_str().unwrap().is_empty());
    assert!(summary["stop"].is_null());
}

#[test]
fn a_dry_run_prints_the_plan_and_writes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &["run", "--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let text = stdout(&output);
    for line in ["masses", "time step", "stability limit", "steps", "nothing was written"] {
        assert!(text.contains(line), "{line}: {text}");
    }
    assert!(names(folder.path()).is_empty());
    let plan = json(&myospring(folder.path(), &["run", "--dry-run", "--json"]));
    assert!(plan["steps"].as_u64().unwrap() > 10_000);
}

#[test]
fn every_example_runs_dry() {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    let mut count = 0;
    for name in names(&examples)
        .iter()
        .filter(|name| Path::new(name).extension().is_some_and(|ending| ending == "toml"))
    {
        let output = myospring(&examples, &["run", name, "--dry-run"]);
        assert_eq!(output.status.code(), Some(0), "{name}: {}", stderr(&output));
        count += 1;
    }
    assert!(count >= 4);
}

#[test]
fn a_train_of_beats_comes_with_mean_and_deviation() {
    let folder = tempfile::tempdir().unwrap();
    let train = ["--beats", "2", "--cycle-length", "500 ms", "--model", "bueno_orovio_2008_epi"];
    let output =
        myospring(folder.path(), &[&["run", "--spacing", "5 um", "--json"], &train[..]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let summary = json(&output);
    assert_eq!(summary["beats"].as_array().unwrap().len(), 2);
    let spread = summary["beat_to_beat"].as_array().unwrap();
    assert!(spread.iter().any(|row| row["name"] == "peak_shortening" && row["beats"] == 2));
    let traces = folder.path().join("results/adult_ventricular/traces.csv");
    assert!(fs::read_to_string(traces).unwrap().starts_with("t_ms,u,vm_mV,"));
}

#[test]
fn a_run_that_stops_early_writes_what_it_has_and_exits_with_1() {
    let folder = tempfile::tempdir().unwrap();
    // So soft a cell is pulled inside out.
    let soft = ["run", "--young-modulus", "0.5 kPa", "--peak-tension", "500 kPa", "--quiet"];
    let output = myospring(folder.path(), &[&soft[..], &["--spacing", "4 um"]].concat());
    let message = stderr(&output);
    assert_eq!(output.status.code(), Some(1), "{message}");
    assert!(message.contains("the run stopped early") && message.contains("t = "), "{message}");
    let results = folder.path().join("results/adult_ventricular");
    let traces = fs::read_to_string(results.join("traces.csv")).unwrap();
    assert!(traces.lines().count() > 50, "what was computed is kept");
    let record: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(results.join("run.json")).unwrap()).unwrap();
    assert!(record["stop"]["message"].as_str().unwrap().contains("t = "), "{record}");
    let page = fs::read_to_string(results.join("report.html")).unwrap();
    assert!(page.contains("the run stopped early: "), "its page says so, too");
}

#[test]
fn a_run_that_the_fast_kernel_does_not_serve_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let dry = |more: &[&str]| {
        let run = ["run", "--spacing", "4 um", "--dry-run"];
        stderr(&myospring(folder.path(), &[&run[..], more].concat()))
    };
    for (options, hindrance) in [
        (["--active", "ends"], "`end tension`"),
        (["--area-law", "barycentric"], "`barycentric area preservation`"),
        (["--integrator", "velocity-verlet"], "velocity Verlet"),
    ] {
        let said = dry(&options);
        assert!(said.contains("plain loops") && said.contains(hindrance), "{said}");
    }
    for served in [&["--support", "clamped-ends"][..], &["--integrator", "quasi-static"], &[]] {
        assert_eq!(dry(served), "");
    }
}

#[test]
fn the_engine_that_moves_the_masses_is_the_one_that_was_asked_for_and_stands_in_the_record() {
    let folder = tempfile::tempdir().unwrap();
    let engine = |name: &str| {
        let quick = ["--spacing", "5 um", "--duration", "60 ms", "-q", "-o", name];
        let output = myospring(folder.path(), &[&["run", "--engine", name], &quick[..]].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let record = std::fs::read(folder.path().join(name).join("run.json")).unwrap();
        let record: serde_json::Value = serde_json::from_slice(&record).unwrap();
        record["engine"].clone()
    };
    assert_eq!(engine("plain"), serde_json::json!({ "loops": "plain" }));
    for fused in [engine("fused"), engine("auto")] {
        assert_eq!((&fused["loops"], &fused["threads"]), (&"fused".into(), &1.into()), "{fused}");
        assert!(fused["vector_units"].is_string(), "{fused}");
    }
    // The same beat, whoever makes it; the fused kernel rounds otherwise.
    let [plain, fused] = ["plain", "fused"].map(|name| {
        let traces = std::fs::read_to_string(folder.path().join(name).join("traces.csv")).unwrap();
        let last: Vec<f64> =
            traces.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
        last[3]
    });
    assert!((plain - fused).abs() < 1e-6, "{plain} um, {fused} um");
}

#[test]
fn a_table_of_myofibrils_makes_the_tension_uneven() {
    let folder = tempfile::tempdir().unwrap();
    // Half as many in the left half of the cell, whose middle is the origin.
    let table = "# drawn by hand\nx_um,y_um,content\n-35,0,0.5\n35,0,1.0\n";
    std::fs::write(folder.path().join("content.csv"), table).unwrap();
    let shortening = |more: &[&str]| {
        let name = format!("out{}", more.len());
        let quick =
            ["run", "--integrator", "quasi-static", "--spacing", "4 um", "--json", "-q", "-o"];
        let output = myospring(folder.path(), &[&quick[..], &[&name], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        let said = json(&output);
        let contraction = said["beats"][0]["contraction"].as_array().unwrap().clone();
        let row = contraction.iter().find(|row| row["name"] == "peak_shortening").unwrap().clone();
        row["value"].as_f64().unwrap()
    };
    let (even, uneven) = (shortening(&[]), shortening(&["--myofibril-content", "content.csv"]));
    // One half shortens as before, the other by half as much, but that the law is not quite linear.
    assert!((uneven / even - 0.75).abs() < 0.02, "{uneven} % of {even} %");
    // What was written runs again.
    let again = myospring(folder.path(), &["run", "out2/run.toml", "--json", "-q", "-o", "again"]);
    assert_eq!(again.status.code(), Some(0), "{}", stderr(&again));
    let traces = |name: &str| std::fs::read(folder.path().join(name).join("traces.csv")).unwrap();
    assert_eq!(traces("out2"), traces("again"));
}

#[test]
fn mesh_reports_and_draws() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &["mesh", "--rotate", "30 deg"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert!(stdout(&output).contains("long axis"));
    let results = folder.path().join("results/adult_ventricular_mesh");
    assert_eq!(names(&results), ["figures", "mesh.json", "outline.geojson"]);
    let report = json(&myospring(folder.path(), &["mesh", "--json", "--force"]));
    assert!((report["length_um"].as_f64().unwrap() - 140.0).abs() < 2.0);
    // What was written reads back.
    let outline = results.join("outline.geojson");
    let output = myospring(folder.path(), &["mesh", outline.to_str().unwrap(), "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
}

#[test]
fn models_init_schema_and_cite_print_what_they_say() {
    let folder = tempfile::tempdir().unwrap();
    let models = stdout(&myospring(folder.path(), &["models"]));
    assert!(models.contains("coelho_2021") && models.contains("bueno_orovio_2008_tnnp"));
    let model = stdout(&myospring(folder.path(), &["models", "coelho_2021"]));
    assert!(model.contains("tau_si") && model.contains("1.76816") && model.contains("Table 1"));
    let model = json(&myospring(folder.path(), &["models", "coelho_2021", "--json"]));
    assert!(model["parameters"]["rows"].as_array().unwrap().len() >= 33);
    assert_eq!(json(&myospring(folder.path(), &["schema"]))["title"], "Myospring run file");

    assert_eq!(myospring(folder.path(), &["init", "beat.toml"]).status.code(), Some(0));
    let output = myospring(folder.path(), &["run", "beat.toml", "--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let listed = stdout(&myospring(folder.path(), &["init", "--preset", "list"]));
    assert!(listed.contains("hipsc-on-gel") && listed.contains("13.9 nN"), "{listed}");
    let gel = ["init", "--preset", "hipsc-on-gel", "gel.toml"];
    assert_eq!(myospring(folder.path(), &gel).status.code(), Some(0));
    let output = myospring(folder.path(), &["run", "gel.toml", "--dry-run"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    let unknown = myospring(folder.path(), &["init", "--preset", "giraffe"]);
    assert!(stderr(&unknown).contains("hipsc-on-gel"), "{}", stderr(&unknown));
    let output = myospring(folder.path(), &["init", "beat.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(stderr(&output).contains("`beat.toml` exists already"), "{}", stderr(&output));

    let cite = stdout(&myospring(folder.path(), &["--cite"]));
    assert!(cite.contains("@software{myospring,") && cite.contains("{coelho_2021,"), "{cite}");
    let cite = ["run", "--model", "bueno_orovio_2008_m", "--cite"];
    assert!(stdout(&myospring(folder.path(), &cite)).contains("{bueno_orovio_2008,"));
    // The model of the run file, unless an option says otherwise; the toy has no paper.
    fs::write(folder.path().join("toy.toml"), "[cell]\nmodel = \"toy_alpha\"\n").unwrap();
    let toy = stdout(&myospring(folder.path(), &["run", "toy.toml", "--cite"]));
    assert!(toy.contains("{coelho_2021,") && !toy.contains("{bueno_orovio_2008,"), "{toy}");
    let cite = ["run", "toy.toml", "--model", "bueno_orovio_2008_m", "--cite"];
    assert!(stdout(&myospring(folder.path(), &cite)).contains("{bueno_orovio_2008,"));
    assert_eq!(myospring(folder.path(), &["run", "none.toml", "--cite"]).status.code(), Some(2));
}
