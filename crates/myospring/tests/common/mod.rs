//! What several tests share.
#![allow(dead_code, reason = "no test uses all of it")]

use std::path::PathBuf;

/// A file of the shared data, or `None` with a loud line if it is not there.
#[allow(clippy::print_stderr, reason = "a skipped test must be seen")]
pub fn shared_data(path: &str) -> Option<PathBuf> {
    let file =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data")).join(path);
    if file.exists() {
        return Some(file);
    }
    eprintln!("SKIPPED: no shared data `{path}`; the test that compares with it did not run");
    None
}

/// First time at or after `from` when the curve falls through `level`, between samples by a line.
pub fn falls_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    crossing(times, values, from, |before, after| before >= level && after < level, level)
}

/// First time at or after `from` when the curve rises through `level`, between samples by a line.
pub fn rises_through(times: &[f64], values: &[f64], level: f64, from: f64) -> f64 {
    crossing(times, values, from, |before, after| before < level && after >= level, level)
}

fn crossing(
    times: &[f64],
    values: &[f64],
    from: f64,
    crosses: impl Fn(f64, f64) -> bool,
    level: f64,
) -> f64 {
    for i in 1..values.len() {
        if times[i - 1] >= from && crosses(values[i - 1], values[i]) {
            let part = (level - values[i - 1]) / (values[i] - values[i - 1]);
            return times[i - 1] + part * (times[i] - times[i - 1]);
        }
    }
    f64::NAN
}
