//! Our side of the comparisons of Myospring with closed forms and with programs we did not write.
//!
//! Each file holds one check: what is computed, the closed form or the other program, the tolerance
//! and its reason. A check gives [`row::Row`]s; `cargo xtask verify` runs all of them, lets the Python
//! scripts in `verification/python` run the other programs, and makes `docs/verification.md`.
//! The checks use the public interface of the library only, so they hold for whatever computes behind
//! it.

pub mod beat;
pub mod chain;
pub mod conservation;
pub mod convergence;
pub mod engine;
pub mod finite_elements;
pub mod fit;
pub mod lammps;
pub mod land;
pub mod loads;
pub mod motion;
pub mod myokit;
pub mod oscillator;
pub mod parts;
pub mod patch;
pub mod row;
pub mod sarcomeres;
pub mod time_order;
pub mod tor_ord;
pub mod viscosity;
pub mod wave;

use myospring::simulation::Outcome;
use row::Row;
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

/// Every check, in the order of the table.
pub fn checks() -> Vec<Check> {
    vec![
        Check { name: "oscillator", run: oscillator::rows },
        Check { name: "time-order", run: time_order::rows },
        Check { name: "chain", run: chain::rows },
        Check { name: "wave", run: wave::rows },
        Check { name: "patch", run: patch::rows },
        Check { name: "conservation", run: conservation::rows },
        Check { name: "beat", run: beat::rows },
        Check { name: "convergence", run: convergence::rows },
        Check { name: "lammps", run: lammps::write },
        Check { name: "myokit", run: myokit::write },
        Check { name: "land", run: land::rows },
        Check { name: "tor-ord", run: tor_ord::rows },
        Check { name: "loads", run: loads::rows },
        Check { name: "viscosity", run: viscosity::rows },
        Check { name: "parts", run: parts::rows },
        Check { name: "finite-elements", run: finite_elements::rows },
        Check { name: "sarcomeres", run: sarcomeres::rows },
        Check { name: "motion", run: motion::rows },
    ]
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
fn metric(outcome: &Outcome, name: &str) -> Result<f64, Failure> {
    let beats = outcome.beats();
    let value = beats.first().and_then(|beat| beat.value(name));
    value.ok_or_else(|| format!("the beat has no {name}").into())
}
