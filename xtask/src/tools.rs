//! What every command uses: cargo, steps that are timed, places, messages.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

pub(crate) fn cargo<const N: usize>(arguments: [&str; N]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

pub(crate) fn step(name: &str, mut command: Command) -> Result<(), String> {
    say(&format!("\n== {name}\n"));
    let start = Instant::now();
    let status = command.status().map_err(|error| format!("{name}: {error}"))?;
    if !status.success() {
        return Err(format!("{name} failed ({status})"));
    }
    say(&format!("-- {name}: {:.0} s\n", start.elapsed().as_secs_f64()));
    Ok(())
}

/// As [`step`]; what the command prints is shown in one piece, after its end.
pub(crate) fn step_in_one_piece(name: &str, mut command: Command) -> Result<(), String> {
    let start = Instant::now();
    let output = command.output().map_err(|error| format!("{name}: {error}"))?;
    let [printed, said] =
        [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    let outcome = if output.status.success() {
        format!("-- {name}: {:.0} s\n", start.elapsed().as_secs_f64())
    } else {
        String::new()
    };
    say(&format!("\n== {name}\n\n{printed}{said}{outcome}"));
    if outcome.is_empty() {
        return Err(format!("{name} failed ({})", output.status));
    }
    Ok(())
}

/// A program of the workspace as built: `debug` has what the tests have built.
pub(crate) fn program(profile: &str, name: &str) -> PathBuf {
    target().join(profile).join(format!("{name}{}", std::env::consts::EXE_SUFFIX))
}

/// The folder of all that is built.
pub(crate) fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR")
        .map_or_else(|| root().join("target"), |folder| root().join(folder))
}

/// A folder that goes with its name.
pub(crate) fn temporary() -> Result<tempfile::TempDir, String> {
    tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))
}

pub(crate) fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or_else(|| Path::new("."))
}

/// All that this program prints goes to the terminal here.
#[allow(clippy::print_stderr, reason = "this is the program's way to talk")]
pub(crate) fn say(text: &str) {
    eprint!("{text}");
}
