//! Developer commands of Myospring: the same ones that continuous integration runs.
//!
//! `cargo xtask test` checks everything; `cargo xtask help` lists the rest.

mod bench;
mod verify;

use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};
use std::time::Instant;

const HELP: &str = "\
Developer commands of Myospring.

Usage: cargo xtask COMMAND

Commands:
  test     Format, lints, tests, documentation and the example run files: all that must pass
  verify   Compare with closed forms, LAMMPS and Myokit; `cargo xtask verify --help` says more
  bench    Measure speed, beside other programs if asked; `cargo xtask bench --help` says more
  figures  Make the README's figure anew with the program itself
  help     This text
";

fn main() -> ExitCode {
    let command = std::env::args().nth(1);
    let result = match command.as_deref() {
        Some("test") => test(),
        Some("verify") => verify::run(std::env::args().skip(2).collect()),
        Some("bench") => bench::run(std::env::args().skip(2).collect()),
        Some("figures") => figures(),
        Some("help" | "--help" | "-h") => {
            say(HELP);
            Ok(())
        }
        Some(other) => Err(format!("there is no command `{other}`\n\n{HELP}")),
        None => Err(HELP.to_owned()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            say(&format!("xtask: {message}"));
            ExitCode::FAILURE
        }
    }
}

/// Everything that must hold on every commit, cheapest first.
fn test() -> Result<(), String> {
    component("rustfmt", "fmt")?;
    component("clippy", "clippy")?;
    step("format", cargo(["fmt", "--all", "--check"]))?;
    step(
        "lints",
        cargo(["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"]),
    )?;
    step(
        "library without its features",
        cargo(["check", "-p", "myospring", "--no-default-features", "--locked"]),
    )?;
    step("tests", cargo(["test", "--workspace", "--locked"]))?;
    let mut doc =
        cargo(["doc", "--workspace", "--no-deps", "--document-private-items", "--locked"]);
    doc.env("RUSTDOCFLAGS", "-D warnings");
    step("documentation", doc)?;
    run_files()?;
    say("\nxtask: all checks passed\n");
    Ok(())
}

/// Every example run file resolves and meshes, and the main job runs to its end.
fn run_files() -> Result<(), String> {
    let mut examples: Vec<PathBuf> = std::fs::read_dir(root().join("examples"))
        .map_err(|error| format!("the folder examples cannot be read: {error}"))?
        .filter_map(|entry| entry.ok().map(|entry| entry.path()))
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    examples.sort();
    for example in &examples {
        let mut command =
            cargo(["run", "--quiet", "--release", "--locked", "--", "run", "--dry-run"]);
        command.arg(example);
        step(&format!("run file {}", example.display()), command)?;
    }
    let results = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let mut command = cargo(["run", "--quiet", "--release", "--locked", "--", "run", "--output"]);
    command.arg(results.path().join("beat"));
    step("the main job: cargo run --release -- run", command)
}

/// The README's figure, made by the program.
fn figures() -> Result<(), String> {
    let results = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let beat = results.path().join("beat");
    let mut command = cargo(["run", "--quiet", "--release", "--locked", "--", "run", "--output"]);
    command.arg(&beat);
    step("the default beat", command)?;
    let (from, to) = (beat.join("figures/overview.png"), root().join("docs/overview.png"));
    std::fs::copy(&from, &to)
        .map(|_| ())
        .map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))
}

/// Makes sure that a part of the toolchain is there.
fn component(name: &str, subcommand: &str) -> Result<(), String> {
    let present = || {
        let mut command = cargo([subcommand, "--version"]);
        command.output().is_ok_and(|output| output.status.success())
    };
    if present() {
        return Ok(());
    }
    say(&format!("xtask: {name} is missing; asking rustup for it\n"));
    let installed = Command::new("rustup").args(["component", "add", name]).status();
    if installed.is_ok_and(|status| status.success()) && present() {
        return Ok(());
    }
    Err(format!("{name} is missing; install it with `rustup component add {name}`"))
}

fn cargo<const N: usize>(arguments: [&str; N]) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.args(arguments).current_dir(root());
    command
}

fn step(name: &str, mut command: Command) -> Result<(), String> {
    say(&format!("\n== {name}\n"));
    let start = Instant::now();
    let status = command.status().map_err(|error| format!("{name}: {error}"))?;
    if !status.success() {
        return Err(format!("{name} failed ({status})"));
    }
    say(&format!("-- {name}: {:.0} s\n", start.elapsed().as_secs_f64()));
    Ok(())
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or_else(|| Path::new("."))
}

/// All that this program prints goes to the terminal here.
#[allow(clippy::print_stderr, reason = "this is the program's way to talk")]
fn say(text: &str) {
    eprint!("{text}");
}
