//! Tests that lack the shared data are not silently green.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::process::Command;

#[test]
fn a_test_without_the_shared_data_is_noted_by_name_with_what_it_lacks() {
    let folder = tempfile::tempdir().unwrap();
    let notes = folder.path().join("notes");
    let name = "segmentation::the_brightfield_cell_is_found_with_defaults";
    let output = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", name, "--test-threads", "2"])
        .env("MYOSPRING_SHARED_DATA", folder.path())
        .env("MYOSPRING_SKIPPED_TESTS", &notes)
        .output()
        .unwrap();
    assert!(output.status.success());
    let picture = "images/contrax_brightfield.tif";
    assert_eq!(std::fs::read_to_string(notes).unwrap(), format!("microscopy::{name}\t{picture}\n"));
    let loud = String::from_utf8_lossy(&output.stderr);
    assert!(loud.contains(&format!("SKIPPED: microscopy::{name} lacks {picture}")), "{loud}");
}
