//! The paper's statements, by the command that checks them.

use std::fs;

use super::{json, myospring, names, stderr};

#[test]
#[ignore = "slow"]
fn the_paper_is_met_in_every_statement() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &["paper", "--json"]);
    let record = json(&output);
    for finding in record["findings"].as_array().unwrap() {
        assert_ne!(finding["verdict"], "not_met", "{finding}");
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(names(&folder.path().join("results/paper/figures")).len(), 6);
}

#[test]
fn the_paper_is_met_along_the_path_of_equilibria_too() {
    let folder = tempfile::tempdir().unwrap();
    let output = myospring(folder.path(), &["paper", "--json", "--integrator", "quasi-static"]);
    let record = json(&output);
    for finding in record["findings"].as_array().unwrap() {
        assert_ne!(finding["verdict"], "not_met", "{finding}");
    }
    assert_eq!(output.status.code(), Some(0), "{}", stderr(&output));
    assert_eq!(record["integration"][2]["integrator"], "quasi-static");
}

#[test]
fn the_paper_does_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    for threads in ["1", "3"] {
        let run = ["paper", "--spacing", "4 um", "--threads", threads, "--output", threads];
        // So coarse a cell may miss a statement (exit code 1), but not differently.
        assert_ne!(myospring(folder.path(), &run).status.code(), Some(2));
    }
    for file in ["traces_30_kPa.csv", "traces_40_kPa.csv", "traces_50_kPa.csv"] {
        let [one, three] =
            ["1", "3"].map(|threads| fs::read(folder.path().join(threads).join(file)).unwrap());
        assert_eq!(one, three, "{file}");
    }
}
