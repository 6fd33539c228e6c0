//! `myospring study` as people meet it: begun, killed, gone on with, in parts.

#![allow(clippy::unwrap_used, reason = "a test may stop here")]

use std::fs;
use std::path::Path;
use std::process::{Command, Output};
use std::thread::sleep;
use std::time::{Duration, Instant};

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_myospring"));
    command.args(arguments).current_dir(folder).env_remove("COLUMNS");
    command
}

fn myospring(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = myospring(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    text(&output.stdout)
}

const STUDY: &str = "
    traces = true
    metrics = [\"peak_shortening\", \"relaxation_time_50\"]
    [run.shape]
    spacing = \"3 um\"
    [parameters]
    peak_tension = { distribution = \"uniform\", low = \"45 kPa\", high = \"55 kPa\" }
    young_modulus = { distribution = \"uniform\", low = 0.9, high = 1.1, relative = true }
    [sampling]
    sampler = \"saltelli\"
    size = 32
    [keep]
    peak_shortening = [11, 13]
";

#[test]
#[ignore = "slow"]
fn a_study_gives_the_same_bits_in_one_go_in_parts_and_after_it_was_killed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("s.toml"), STUDY).unwrap();
    let said = done(path, &["study", "run", "s.toml", "-o", "whole", "--jobs", "1"]);
    assert!(
        said.contains("128 members: 128 beat, ") && said.contains("with all interactions"),
        "{said}"
    );
    let table = fs::read(path.join("whole/members.csv")).unwrap();
    let traces = fs::read(path.join("whole/traces.npy")).unwrap();
    let figure = fs::read_to_string(path.join("whole/figures/sensitivity.svg")).unwrap();
    assert!(figure.contains("young_modulus") && figure.contains("Peak shortening"));
    assert_eq!(text(&table).lines().count(), 129);
    assert!(said.contains("rejected by this alone"), "{said}");
    let scatter = path.join("whole/figures/scatter_peak_shortening.svg");
    let drawn = fs::read(&scatter).unwrap();
    assert!(text(&drawn).contains("young_modulus (kPa)") && text(&drawn).contains(" rejected"));
    assert!(path.join("whole/figures/distributions.png").exists());
    let report = fs::read_to_string(path.join("whole/report.html")).unwrap();
    assert!(report.contains("128 of 128 members beat") && report.contains("young_modulus"));

    // Drawn anew from the table alone, a figure is the same to the last byte.
    fs::remove_dir_all(path.join("whole/figures")).unwrap();
    let again = done(path, &["study", "figures", "s.toml", "-o", "whole"]);
    assert!(again.contains("5 figures"), "{again}");
    assert_eq!(fs::read(&scatter).unwrap(), drawn);

    // Killed in the middle, and gone on with.
    let mut child = command(path, &["study", "run", "s.toml", "-o", "killed", "--jobs", "1", "-q"])
        .spawn()
        .unwrap();
    let journal = path.join("killed/progress.jsonl");
    let begun = Instant::now();
    while fs::read_to_string(&journal).unwrap_or_default().lines().count() < 10 {
        assert!(begun.elapsed() < Duration::from_secs(120), "no member was done");
        sleep(Duration::from_millis(10));
    }
    child.kill().unwrap();
    child.wait().unwrap();
    let known = fs::read_to_string(&journal).unwrap().lines().count();
    let output = myospring(path, &["study", "run", "s.toml", "-o", "killed"]);
    assert!(output.status.success());
    let note = text(&output.stderr);
    assert!(known < 128 && note.contains("of 128 members are done"), "{note}");
    assert_eq!(fs::read(path.join("killed/members.csv")).unwrap(), table);
    assert!(fs::read(path.join("killed/traces.npy")).unwrap() == traces);

    // In two parts; the second is missed first.
    let part =
        |which: &str| done(path, &["study", "run", "s.toml", "-o", "parts", "--shard", which]);
    assert!(part("1/2").contains("study merge s.toml --output parts"));
    let early = myospring(path, &["study", "merge", "s.toml", "-o", "parts"]);
    assert_eq!(early.status.code(), Some(2));
    assert!(
        text(&early.stderr).contains("64 of 128 members are not in the parts"),
        "{}",
        text(&early.stderr)
    );
    part("2/2");
    done(path, &["study", "merge", "s.toml", "-o", "parts"]);
    assert_eq!(fs::read(path.join("parts/members.csv")).unwrap(), table);
    assert!(fs::read(path.join("parts/traces.npy")).unwrap() == traces);
    assert_eq!(
        fs::read(path.join("parts/study.json")).unwrap(),
        fs::read(path.join("whole/study.json")).unwrap()
    );

    // A study with other members goes nowhere near these results.
    fs::write(path.join("s.toml"), STUDY.replace("3 um", "4 um")).unwrap();
    let other = myospring(path, &["study", "run", "s.toml", "-o", "whole"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(text(&other.stderr).contains("results of other settings"), "{}", text(&other.stderr));
}

#[test]
fn the_description_to_start_from_is_one_that_runs_and_a_bad_one_says_where() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    done(path, &["study", "init", "s.toml"]);
    let written = fs::read_to_string(path.join("s.toml")).unwrap();
    let small =
        written.replace("kind = \"beat\"", "kind = \"cell\"").replace("size = 64", "size = 4");
    let of_beats = ["metrics", "young_modulus", "peak_shortening"];
    let kept = |line: &&str| !of_beats.iter().any(|start| line.starts_with(start));
    let cell: Vec<&str> = small.lines().filter(kept).collect();
    fs::write(path.join("cell.toml"), cell.join("\n")).unwrap();
    assert!(done(path, &["study", "run", "cell.toml"]).contains("16 members: 16 beat"));
    assert!(path.join("results/cell_study/members.parquet").exists());
    fs::write(path.join("bad.toml"), written.replace("tau_so2 =", "tau_s02 =")).unwrap();
    let bad = myospring(path, &["study", "run", "bad.toml"]);
    assert_eq!(bad.status.code(), Some(2));
    let message = text(&bad.stderr);
    assert!(
        message.contains("`bad.toml`: [parameters]: `tau_s02`") && message.contains("tau_so2"),
        "{message}"
    );
    let none = myospring(path, &["study", "figures", "s.toml", "-o", "nowhere"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(text(&none.stderr).contains("study run"), "{}", text(&none.stderr));
    let shard = myospring(path, &["study", "run", "s.toml", "--shard", "3/2"]);
    assert!(text(&shard.stderr).contains("like 2/8"));
}

/// Cells whose conductances differ as those of neighbours in a heart do.
const POPULATION: &str = "
    kind = \"cell\"
    [parameters]
    tau_fi = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.1, relative = true }
    tau_si = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.03, relative = true }
    tau_so1 = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.03, relative = true }
    tau_w_plus = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.1, relative = true }
    [sampling]
    sampler = \"latin-hypercube\"
    size = 2000
    [keep]
    action_potential_duration_90 = [260, 290]
    peak_tension = [30, 70]
";

#[test]
fn a_population_says_who_is_kept_and_which_band_rejects_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    fs::write(path.join("p.toml"), POPULATION).unwrap();
    let said = done(path, &["study", "run", "p.toml", "-o", "p"]);
    let json: serde_json::Value =
        serde_json::from_slice(&fs::read(path.join("p/study.json")).unwrap()).unwrap();
    let of = |key: &str| json[key].as_u64().unwrap();
    let (beat, kept) = (of("beat"), of("kept"));
    assert_eq!((beat, of("failed")), (2000, 0));
    // What the columns of the table say.
    let table = text(&fs::read(path.join("p/members.csv")).unwrap());
    let marked = table.lines().filter(|line| line.contains(",true,ok,")).count();
    assert_eq!(marked as u64, kept);
    assert!((400..1600).contains(&kept), "{kept}");
    let bands = json["bands"].as_array().unwrap();
    let count = |band: &serde_json::Value, what: &str| band[what].as_u64().unwrap();
    let rejected = |band| count(band, "below") + count(band, "above") + count(band, "without");
    let alone: u64 = bands.iter().map(|band| count(band, "alone")).sum();
    // Each rejected member is rejected by one band alone, or by both.
    let both = rejected(&bands[0]) + rejected(&bands[1]) - (beat - kept);
    assert_eq!(alone + both, beat - kept);
    assert!(said.contains("peak tension (kPa)") && !said.contains("hardly any"), "{said}");
    // 2000 members, potential and tension, each 2.5 ms of 600 ms.
    assert_eq!(json["traces"]["times"], 241);
    let traces = fs::metadata(path.join("p/traces.npy")).unwrap().len();
    assert_eq!(traces, 128 + 2000 * 2 * 241 * 4);
    for name in ["distributions", "scatter_peak_tension", "traces"] {
        let size = fs::metadata(path.join(format!("p/figures/{name}.svg"))).unwrap().len();
        assert!(size < 300_000, "{name} has {size} bytes");
    }

    // Hardly anybody has so short an action potential; the advice says what there is.
    let narrow =
        POPULATION.replace("[260, 290]", "[100, 150]").replace("size = 2000", "size = 200");
    fs::write(path.join("n.toml"), narrow).unwrap();
    let said = done(path, &["study", "run", "n.toml", "-o", "n"]);
    assert!(said.contains("0 kept") && said.contains("rejects 100.0 %"), "{said}");
    assert!(said.contains("their median is 27"), "{said}");
}

#[test]
fn thousands_of_cells_give_the_same_bits_after_kills_in_parts_and_on_other_threads() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let all = std::env::var_os("MYOSPRING_ALL_CASES").is_some();
    let size = if all { 12_000 } else { 3_000 };
    let population = POPULATION.replace("size = 2000", &format!("size = {size}"));
    fs::write(path.join("p.toml"), population).unwrap();
    done(path, &["study", "run", "p.toml", "-o", "whole", "--jobs", "1"]);
    let of = |folder: &str, file: &str| fs::read(path.join(folder).join(file)).unwrap();
    let whole = ["members.csv", "members.parquet", "study.json"].map(|file| of("whole", file));
    let same = |folder: &str| {
        whole[0] == of(folder, "members.csv")
            && whole[1] == of(folder, "members.parquet")
            && whole[2] == of(folder, "study.json")
    };
    assert_eq!(text(&whole[0]).lines().count(), size + 1);

    // Killed twice in the middle, then gone on with to the end.
    let length = || fs::metadata(path.join("killed/progress.jsonl")).map_or(0, |of| of.len());
    for _ in 0..2 {
        let before = length();
        let mut child =
            command(path, &["study", "run", "p.toml", "-o", "killed", "-q"]).spawn().unwrap();
        let begun = Instant::now();
        while length() < before + 8 * size as u64 && child.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < Duration::from_secs(120), "no member was done");
            sleep(Duration::from_millis(2));
        }
        child.kill().unwrap();
        child.wait().unwrap();
    }
    let note = text(&myospring(path, &["study", "run", "p.toml", "-o", "killed"]).stderr);
    assert!(note.contains(&format!("of {size} members are done")), "{note}");
    assert!(same("killed"));

    for part in ["1/3", "2/3", "3/3"] {
        done(path, &["study", "run", "p.toml", "-o", "parts", "--shard", part]);
    }
    done(path, &["study", "merge", "p.toml", "-o", "parts"]);
    assert!(same("parts"));
}

#[test]
fn a_sequence_made_longer_or_shorter_keeps_the_members_that_it_has() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    // The points of this sequence do not depend on their number.
    let sequence = POPULATION.replace("latin-hypercube", "sobol-sequence");
    for (name, size) in [("small.toml", "size = 40"), ("large.toml", "size = 100")] {
        fs::write(path.join(name), sequence.replace("size = 2000", size)).unwrap();
    }
    let run = |study: &str, results: &str| {
        text(&myospring(path, &["study", "run", study, "-o", results]).stderr)
    };
    let files = |results: &str| {
        ["members.csv", "members.parquet", "study.json"]
            .map(|file| fs::read(path.join(results).join(file)).unwrap())
    };
    run("small.toml", "small");
    run("large.toml", "large");
    run("small.toml", "changing");
    let said = run("large.toml", "changing");
    assert!(said.contains("40 of 100 members are done"), "{said}");
    assert!(files("changing") == files("large"), "grown");
    let said = run("small.toml", "changing");
    assert!(said.contains("40 of 40 members are done"), "{said}");
    assert!(files("changing") == files("small"), "made smaller");
}

#[test]
fn response_curves_are_drawn_for_grids_and_for_one_parameter_at_a_time() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let two = "
        kind = \"cell\"
        metrics = [\"peak_tension\"]
        [parameters]
        tau_si = { distribution = \"uniform\", low = 0.95, high = 1.05, relative = true }
        tau_so1 = { distribution = \"uniform\", low = 0.95, high = 1.05, relative = true }
        [sampling]
        sampler = \"grid\"
        levels = 4
    ";
    let one = two.lines().filter(|line| !line.contains("tau_so1")).collect::<Vec<_>>().join("\n");
    for (name, study, file, words) in [
        ("map", two.replace("levels = 4", "levels = 8"), "response", "tau_so1 (ms)"),
        ("lines", two.to_owned(), "response", "tau_so1 (ms):"),
        ("curve", one, "response", "usual value"),
        ("each", two.replace("grid", "one-at-a-time"), "response_peak_tension", "usual value"),
    ] {
        fs::write(path.join("s.toml"), study).unwrap();
        done(path, &["study", "run", "s.toml", "-o", name]);
        let svg = fs::read(path.join(format!("{name}/figures/{file}.svg"))).unwrap();
        assert!(text(&svg).contains(words) && text(&svg).contains("Peak tension (kPa)"), "{name}");
    }
}

/// Smaller than it is shipped.
fn small(study: &str) -> String {
    let mesh = "[run.shape]\nspacing = \"7 um\"\n[run.cell]";
    let study = study.replace("[run.shape]\nspacing = \"4 um\"\n", "");
    let beats = study.contains("kind = \"beat\"") && !study.contains("[run.shape]");
    let study = if beats { study.replace("[run.cell]", mesh) } else { study };
    let less = [
        "trajectories = 50",
        "size = 1024",
        "size = 2000",
        "size = 1000",
        "levels = 23",
        "levels = 24",
        "levels = 15",
        "levels = 9",
        "steady_state = 0.001",
        "spacing = \"200 um\"",
        "levels = 7",
        "duration = \"2 s\"",
    ];
    less.into_iter()
        .zip([
            "trajectories = 2",
            "size = 2",
            "size = 20",
            "size = 20",
            "levels = 3",
            "levels = 3",
            "levels = 3",
            "levels = 2",
            "steady_state = 0.1",
            "spacing = \"400 um\"",
            "levels = 2",
            "duration = \"400 ms\"",
        ])
        .fold(study, |study, (usual, small)| study.replace(usual, small))
}

#[test]
#[ignore = "slow"]
fn every_study_of_the_examples_runs_and_all_parameters_of_the_paper_are_looked_at() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path();
    let studies = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/studies");
    let mut known = Vec::new();
    for entry in fs::read_dir(&studies).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        let text = fs::read_to_string(studies.join(&name)).unwrap();
        assert!(text.contains(&format!("myospring study run examples/studies/{name}")), "{name}");
        fs::write(path.join(&name), small(&text)).unwrap();
        let said = done(path, &["study", "run", &name, "-o", &format!("{name}.out")]);
        let members = match name.as_str() {
            "population.toml" | "tor_ord_population.toml" => "20 members: 20 beat",
            "force_frequency.toml" => "2 members: 2 beat",
            "s1_s2.toml" | "restitution.toml" => "3 members: 3 beat, 1 with stimuli that raised no",
            _ => " beat\n",
        };
        assert!(said.contains(members), "{name}: {said}");
        known.push(name);
    }
    known.sort();
    let all = [
        "contraction_morris.toml",
        "contraction_sobol.toml",
        "force_clamp.toml",
        "force_frequency.toml",
        "population.toml",
        "restitution.toml",
        "s1_s2.toml",
        "spiral_drift.toml",
        "tor_ord_population.toml",
    ];
    assert_eq!(known, all);
    let models = done(path, &["models", "coelho_2021"]);
    let rows = models.lines().skip_while(|line| !line.starts_with("parameter")).skip(1);
    let parameters: Vec<&str> = rows.filter_map(|line| line.split_whitespace().next()).collect();
    assert_eq!(parameters.len(), 35);
    for study in ["contraction_morris.toml", "contraction_sobol.toml"] {
        let json: serde_json::Value = serde_json::from_slice(
            &fs::read(path.join(format!("{study}.out/study.json"))).unwrap(),
        )
        .unwrap();
        let looked_at = json["sensitivity"][0]["parameters"].as_array().unwrap();
        for parameter in &parameters {
            let key = format!("cell.parameters.{parameter}");
            assert!(looked_at.iter().any(|one| one["parameter"] == key.as_str()), "{key}");
        }
    }
}
