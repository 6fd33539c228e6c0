//! `cargo xtask build-times`: what a build from nothing costs, beside another commit.

use crate::tools::{root, say};
use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Instant;

const HELP: &str = "\
Measure the processor time of a build from an empty target folder.

Usage: cargo xtask build-times [--base REVISION] [--tests] [--rounds N]

Builds this tree in a temporary folder, by turns with REVISION if one is given, and prints processor and
wall seconds and their ratios. Dependencies are downloaded first; so they do not count. The processor time
of other programs does not count either, but a busy machine makes every second of it do less.

Options:
  --base REVISION  Build this commit, too
  --tests          Besides `cargo build --release`, what `cargo xtask test` takes
  --rounds N       Build each N times and take the least; 1
  --help           This text
";

/// Seconds of processor and of wall time.
#[derive(Clone, Copy)]
struct Time {
    processor: f64,
    wall: f64,
}

pub(crate) fn run(arguments: Vec<String>) -> Result<(), String> {
    let (mut base, mut tests, mut rounds) = (None, false, 1_usize);
    let mut rest = arguments.into_iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--help" | "-h" => {
                say(HELP);
                return Ok(());
            }
            "--tests" => tests = true,
            "--base" => base = Some(rest.next().ok_or("--base needs a commit")?),
            "--rounds" => {
                let count = rest.next().and_then(|text| text.parse().ok());
                rounds =
                    count.filter(|&count| count > 0).ok_or("--rounds needs a number from 1")?;
            }
            other => return Err(format!("there is no option `{other}`\n\n{HELP}")),
        }
    }
    let folder = tempfile::tempdir().map_err(|error| format!("no temporary folder: {error}"))?;
    let tree = folder.path().join("base");
    if let Some(revision) = &base {
        git(&["worktree", "add", "--quiet", "--detach", &tree.to_string_lossy(), revision])?;
    }
    let mut trees = vec![("this tree", root())];
    trees.extend(base.as_deref().map(|revision| (revision, tree.as_path())));
    let outcome = measure(&trees, tests, rounds, &folder.path().join("target"));
    if base.is_some() {
        git(&["worktree", "remove", "--force", &tree.to_string_lossy()])?;
    }
    say(&outcome?);
    Ok(())
}

/// The table.
fn measure(
    trees: &[(&str, &Path)],
    tests: bool,
    rounds: usize,
    target: &Path,
) -> Result<String, String> {
    let mut jobs: Vec<(&str, &[&str])> =
        vec![("cargo build --release", &["build", "--release", "--locked", "--quiet"])];
    if tests {
        jobs.push(("cargo xtask test", &["xtask", "test"]));
    }
    for (name, tree) in trees {
        let fetched = cargo(tree, target).args(["fetch", "--locked", "--quiet"]).status();
        if !fetched.is_ok_and(|status| status.success()) {
            return Err(format!("the dependencies of {name} cannot be downloaded"));
        }
    }
    let mut lines = String::from(
        "\n| what | of | processor, s | wall, s | processor, ratio |\n|---|---|---|---|---|\n",
    );
    for (job, arguments) in jobs {
        let mut least: Vec<Option<Time>> = vec![None; trees.len()];
        for _ in 0..rounds {
            for ((name, tree), least) in trees.iter().zip(&mut least) {
                say(&format!("\n== {job}, {name}\n"));
                let time = timed(cargo(tree, target).args(arguments), target)?;
                say(&format!("-- {:.0} s of processor, {:.0} s\n", time.processor, time.wall));
                if least.is_none_or(|least| time.processor < least.processor) {
                    *least = Some(time);
                }
            }
        }
        let base = least.last().copied().flatten().filter(|_| trees.len() > 1);
        for ((name, _), time) in trees.iter().zip(least) {
            let Some(Time { processor, wall }) = time else { continue };
            let ratio =
                base.map_or_else(String::new, |base| format!("{:.2}", processor / base.processor));
            _ = writeln!(lines, "| {job} | {name} | {processor:.0} | {wall:.0} | {ratio} |");
        }
    }
    Ok(lines)
}

/// Runs a command that succeeds from an empty target folder, and takes its time.
fn timed(command: &mut Command, target: &Path) -> Result<Time, String> {
    if target.exists() {
        std::fs::remove_dir_all(target)
            .map_err(|error| format!("{}: {error}", target.display()))?;
    }
    let (start, before) = (Instant::now(), children_s()?);
    let status = command.status().map_err(|error| format!("{command:?}: {error}"))?;
    if !status.success() {
        return Err(format!("{command:?} ended with {status}"));
    }
    Ok(Time { processor: children_s()? - before, wall: start.elapsed().as_secs_f64() })
}

/// Processor seconds of all processes that this one has started and that have ended, as the shell counts
/// them.
fn children_s() -> Result<f64, String> {
    let stat = std::fs::read_to_string("/proc/self/stat").map_err(|error| {
        format!("processor times are read from /proc, which is not here: {error}")
    })?;
    // proc(5): the fields after the name in brackets begin with the third; children's user and system
    // time are the 16th and 17th, in clock ticks.
    let fields: Vec<&str> =
        stat.rsplit_once(')').map_or("", |(_, rest)| rest).split_whitespace().collect();
    let ticks: f64 = fields
        .get(13..15)
        .map_or(0.0, |fields| fields.iter().filter_map(|field| field.parse::<f64>().ok()).sum());
    // USER_HZ is 100 on every Linux that Rust's standard library runs on.
    Ok(ticks / 100.0)
}

fn cargo(tree: &Path, target: &Path) -> Command {
    let mut command = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
    command.current_dir(tree).env("CARGO_TARGET_DIR", target);
    // The tree's own: those of this program are not meant for it.
    for inherited in ["CARGO_MANIFEST_DIR", "CARGO_MANIFEST_PATH"] {
        command.env_remove(inherited);
    }
    command
}

fn git(arguments: &[&str]) -> Result<(), String> {
    let output = Command::new("git")
        .args(arguments)
        .current_dir(root())
        .stdin(Stdio::null())
        .output()
        .map_err(|error| format!("git does not start: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let words = arguments.join(" ");
    Err(format!("git {words}: {}", String::from_utf8_lossy(&output.stderr).trim()))
}
