//! What every check has: its settings, the rows that it makes, what stops it.

use crate::row::Row;
use myospring::simulation::Outcome;
use std::path::{Path, PathBuf};

/// Whatever stops a check from being made; it is told and counts as a failure.
pub type Failure = Box<dyn std::error::Error>;

/// How a check is run.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'a> {
    /// Fewer steps, coarser meshes: seconds instead of minutes, the same tolerances.
    pub quick: bool,
    /// Folder for what other programs read.
    pub folder: &'a Path,
    /// Folder with published data, which may be missing.
    pub data: &'a Path,
}

/// A check by name.
pub struct Check {
    /// As chosen on the command line.
    pub name: &'static str,
    /// Makes the rows, or writes what another program compares.
    pub run: fn(&Setting<'_>) -> Result<Vec<Row>, Failure>,
}

/// The folder with published data that the project does not carry: the one that `MYOSPRING_SHARED_DATA`
/// names, or `shared/data` beside the project.
pub fn published_data() -> PathBuf {
    std::env::var_os("MYOSPRING_SHARED_DATA").map_or_else(
        || Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data"),
        PathBuf::from,
    )
}

/// A metric of the only beat.
pub(crate) fn metric(outcome: &Outcome, name: &str) -> Result<f64, Failure> {
    let beats = outcome.beats();
    let value = beats.first().and_then(|beat| beat.value(name));
    value.ok_or_else(|| format!("the beat has no {name}").into())
}
