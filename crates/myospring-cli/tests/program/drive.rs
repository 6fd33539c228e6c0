//! What drives a cell: calcium from a table, a steady state that is kept.

use std::fs;

use super::{QUICK, myospring, names, stderr};

#[test]
fn calcium_from_a_table_drives_a_cell_that_shows_it_and_no_potential() {
    let folder = tempfile::tempdir().unwrap();
    let row = |step: u32| {
        let s = 10.0 * f64::from(step);
        let rise = f64::exp(-s / 145.0) - f64::exp(-s / 24.0);
        format!("{s},{}", 70.0 + 700.0 * rise)
    };
    let rows: Vec<String> = (0..=70).map(row).collect();
    let table = format!("time (ms),calcium (nM)\n-5,70\n{}\n", rows.join("\n"));
    std::fs::write(folder.path().join("trace.csv"), table).unwrap();
    let land = ["--model", "land_2017", "--integrator", "quasi-static", "-o", "land"];
    let run = |more: &[&str]| myospring(folder.path(), &[&QUICK[..], &land, more].concat());
    let output = run(&["--calcium", "trace.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(stderr(&output), "");
    let curves = std::fs::read_to_string(folder.path().join("land/traces.csv")).unwrap();
    let header = curves.lines().next().unwrap();
    assert!(header.starts_with("t_ms,ta_kPa,") && header.contains(",Ca_i_uM,XS,"), "{header}");
    let again = std::fs::read_to_string(folder.path().join("land/run.toml")).unwrap();
    assert!(again.contains("trace.csv") && !again.contains("peak_tension"), "{again}");

    std::fs::write(folder.path().join("trace.csv"), "time (ms),calcium (nM)\n0,70\n9,x\n").unwrap();
    let refused = run(&["--calcium", "trace.csv", "--force"]);
    assert_ne!(refused.status.code(), Some(0));
    let message = stderr(&refused);
    assert!(message.contains("line 3, column `calcium (nM)`: \"x\" is not a finite"), "{message}");
}

#[test]
#[ignore = "slow"]
fn a_run_starts_from_a_steady_state_that_is_kept_and_a_damaged_one_is_told_and_made_anew() {
    let folder = tempfile::tempdir().unwrap();
    let run = |results: &str, more: &[&str]| {
        let steady = ["--steady-state", "1 %", "--steady-state-cache", "states", "-o", results];
        let output = myospring(folder.path(), &[&QUICK[..], &steady, more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
        (stderr(&output), fs::read(folder.path().join(results).join("traces.csv")).unwrap())
    };
    let kept = || names(&folder.path().join("states"));
    let (told, first) = run("first", &[]);
    assert!(!told.contains("steady state"), "{told}");
    assert_eq!(kept().len(), 1);
    let (_, again) = run("again", &[]);
    assert!(again == first && kept().len() == 1);
    let (_, other) = run("other", &["--cycle-length", "700 ms"]);
    assert!(other != first && kept().len() == 2);
    for name in kept() {
        fs::write(folder.path().join("states").join(name), "{").unwrap();
    }
    let (told, mended) = run("mended", &[]);
    assert!(told.contains("is damaged; it was computed and written again"), "{told}");
    assert!(mended == first);
    let alone = myospring(folder.path(), &["run", "--steady-state-cache", "states"]);
    assert!(stderr(&alone).contains("steady_state"), "{}", stderr(&alone));
}
