//! A test that lacks its data says so: loudly on the terminal, and to `cargo xtask test`, which names and
//! counts such tests at its end.

#![allow(dead_code, clippy::expect_used, reason = "no test uses all of it, and tests may fail")]

use std::collections::BTreeSet;
use std::io::Write as _;
use std::panic::Location;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// What was said, so that nothing is said twice.
static SAID: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());

/// Says that the running test did not do its work, or not all of it, for want of `missing`.
#[track_caller]
pub(crate) fn skipped(missing: &str) {
    let thread = std::thread::current();
    // Where tests run one after the other, they run on the main thread: then the place stands for the name.
    let test = match thread.name() {
        Some(name) if name != "main" => name.to_owned(),
        _ => Location::caller().to_string(),
    };
    let test = format!("{}::{test}", env!("CARGO_CRATE_NAME"));
    let note = format!("{test}\t{missing}\n");
    if !SAID.lock().expect("no test panics here").insert(note.clone()) {
        return;
    }
    // Past the test harness, which would hide it.
    let line = format!("SKIPPED: {test} lacks {missing}\n");
    std::io::stderr().write_all(line.as_bytes()).ok();
    if let Some(file) = std::env::var_os("MYOSPRING_SKIPPED_TESTS") {
        let file = std::fs::OpenOptions::new().create(true).append(true).open(file);
        // In one piece, so that lines of several tests do not mix.
        file.and_then(|mut file| file.write_all(note.as_bytes()))
            .expect("the file that MYOSPRING_SKIPPED_TESTS names takes a line");
    }
}

/// Whether all cases are asked for, as by `cargo xtask test --full`; if not, says that the running test is left to that.
#[track_caller]
pub(crate) fn left_to_full() -> bool {
    let left = std::env::var_os("MYOSPRING_ALL_CASES").is_none();
    if left {
        skipped("`cargo xtask test --full`, as it takes long and others check much of it");
    }
    left
}

/// A file of the shared data, or `None` with a word about the test that is skipped.
///
/// They lie in `shared/data` beside the project, or in the folder that `MYOSPRING_SHARED_DATA` names.
#[track_caller]
pub(crate) fn shared_data(path: &str) -> Option<PathBuf> {
    let folder = std::env::var_os("MYOSPRING_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data"),
        PathBuf::from,
    );
    let file = folder.join(path);
    if file.exists() {
        return Some(file);
    }
    skipped(path);
    None
}
