//! What several tests share.
#![allow(dead_code, reason = "no test uses all of it")]

use std::io::Write as _;
use std::path::PathBuf;

use myospring::analysis::trace;

/// A file of the shared data, or `None` with a loud line if it is not there.
pub(crate) fn shared_data(path: &str) -> Option<PathBuf> {
    let file =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(path);
    if file.exists() {
        return Some(file);
    }
    // Past the test harness, which would hide it.
    let line =
        format!("SKIPPED: no shared data `{path}`; the test that compares with it did not run\n");
    std::io::stderr().write_all(line.as_bytes()).ok();
    None
}

/// As in the library, NaN where the curve does not fall through the level.
pub(crate) fn falls_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    trace::falls_through(times, values, level, from).unwrap_or(f64::NAN)
}

/// As in the library, NaN where the curve does not rise through the level.
pub(crate) fn rises_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    trace::rises_through(times, values, level, from).unwrap_or(f64::NAN)
}
