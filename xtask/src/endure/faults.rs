//! What the program needs, taken away: it must say so, and what it leaves must be whole files.

use super::results::Results;
use super::trial::{Place, Trial, Work, ended};
use crate::tools::say;
use std::path::Path;
use std::process::{Command, Stdio};

/// A limit of the shell under which the program is started.
struct Limit {
    name: &'static str,
    /// `ulimit` and its value.
    ulimit: &'static str,
}

const LIMITS: [Limit; 3] = [
    Limit { name: "150 MB of address space", ulimit: "-v 150000" },
    Limit { name: "12 open files", ulimit: "-n 12" },
    // Blocks of 512 bytes.
    Limit { name: "files of at most 8 kB", ulimit: "-f 16" },
];

/// Calls of the system that write, of which one fails as on a full disk.
const CALLS: [&str; 6] = [
    "write",
    "pwrite64",
    "ftruncate",
    "fsync,fdatasync",
    "rename,renameat,renameat2",
    "mkdir,mkdirat",
];

/// Exit code where the shell refuses a limit.
const REFUSED: i32 = 99;

/// Size of a disk that is full soon, kB.
const DISKS_KB: [u32; 3] = [4, 64, 400];

/// Tries all; what went wrong. `quick`: fewer calls fail.
pub(super) fn all(
    place: &Place<'_>,
    trials: &[Trial<'_>],
    quick: bool,
) -> Result<Vec<String>, String> {
    let mut faults = Vec::new();
    if !cfg!(unix) {
        say("\nSKIPPED: limits and full disks, which take Unix\n");
        return Ok(faults);
    }
    for trial in trials {
        for Limit { name, ulimit } in LIMITS {
            let output = format!("{}_limited", trial.work.name);
            let command = under(&format!("ulimit {ulimit}"), place, trial.work, &output);
            let again = place.command(trial.work, &output, false);
            faults.extend(looked_at(command, Some(again), place.folder, &output, trial, name)?);
        }
        for kilobytes in DISKS_KB {
            faults.extend(on_a_small_disk(place, trial, kilobytes)?);
        }
    }
    faults.extend(failing_calls(place, trials, quick)?);
    Ok(faults)
}

/// Each work, with the first, second, ... call that writes failing in each of its threads, until it makes no more of them.
fn failing_calls(
    place: &Place<'_>,
    trials: &[Trial<'_>],
    quick: bool,
) -> Result<Vec<String>, String> {
    let traces = |command: &mut Command| command.output().is_ok_and(|it| it.status.success());
    if !traces(Command::new("strace").args(["-f", "-o", "/dev/null", "true"])) {
        say("\nSKIPPED: calls that fail: strace is not installed, or may not trace\n");
        return Ok(Vec::new());
    }
    let (mut faults, trace) = (Vec::new(), place.folder.join("trace"));
    for trial in trials {
        let mut tried = 0;
        for call in CALLS {
            let mut number = 1_u32;
            loop {
                let output = format!("{}_failing", trial.work.name);
                let usual = place.command(trial.work, &output, false);
                let mut command = Command::new("strace");
                command.args(["-f", "-qq", "--seccomp-bpf", "-e", &format!("trace={call}"), "-e"]);
                command.arg(format!("inject={call}:error=ENOSPC:when={number}"));
                command.arg("-o").arg(&trace).arg(usual.get_program()).args(usual.get_args());
                command.current_dir(place.folder).stdout(Stdio::null()).stderr(Stdio::piped());
                let again = place.command(trial.work, &output, false);
                let fault = format!("{call} {number} fails");
                let found = looked_at(command, Some(again), place.folder, &output, trial, &fault)?;
                faults.extend(found);
                let traced = std::fs::read_to_string(&trace)
                    .map_err(|error| format!("{}: {error}", trace.display()))?;
                if !traced.contains("(INJECTED)") {
                    break;
                }
                tried += 1;
                number += if quick { number } else { 1 };
            }
        }
        say(&format!("{}: {tried} calls failed\n", trial.work.name));
    }
    Ok(faults)
}

/// The work, started by a shell after a command of the shell.
fn under(first: &str, place: &Place<'_>, work: &Work, output: &str) -> Command {
    let usual = place.command(work, output, false);
    let mut command = Command::new("sh");
    // A signal that a limit sends is ignored: then the limit is an error of the call.
    command.arg("-c").arg(format!("trap '' XFSZ; {first} || exit {REFUSED}; exec \"$0\" \"$@\""));
    command.arg(usual.get_program()).args(usual.get_args());
    command.current_dir(place.folder).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Runs a command: where it fails it says why, in words, and what it leaves is whole, file by file. What resumes is made again by `again`,
/// to the same results.
fn looked_at(
    command: Command,
    again: Option<Command>,
    folder: &Path,
    output: &str,
    trial: &Trial<'_>,
    fault: &str,
) -> Result<Vec<String>, String> {
    let (code, error) = ended(command)?;
    let succeeded = code == Some(0);
    let target = folder.join(output);
    let what = format!("{}, {fault}", trial.work.name);
    if code == Some(REFUSED) {
        say(&format!("SKIPPED: {what}: the shell refuses it\n"));
        return Ok(Vec::new());
    }
    let mut faults = Vec::new();
    if error.contains("panicked") {
        faults.push(format!("{what}: {error}"));
    }
    if !succeeded && error.trim().is_empty() {
        faults.push(format!("{what}: it ended without a word"));
    }
    let mut left = Results::of(&target)?;
    let again = again.filter(|_| trial.work.resumes && !succeeded);
    let is_done = succeeded || again.is_some();
    if let Some(again) = again {
        let (code, error) = ended(again)?;
        if code != Some(0) {
            faults.push(format!("{what}: it does not go on: {error}"));
        }
        left = Results::of(&target)?;
    }
    if is_done {
        faults
            .extend(trial.undisturbed.differences(&left).iter().map(|it| format!("{what}: {it}")));
    } else if !trial.work.resumes {
        faults.extend(trial.undisturbed.others(&left).iter().map(|it| format!("{what}: {it}")));
    }
    if target.exists() {
        std::fs::remove_dir_all(&target).map_err(|error| format!("{what}: {error}"))?;
    }
    for fault in &faults {
        say(&format!("{fault}\n"));
    }
    Ok(faults)
}

/// The same with a disk that is soon full, where this user may make one.
fn on_a_small_disk(
    place: &Place<'_>,
    trial: &Trial<'_>,
    kilobytes: u32,
) -> Result<Vec<String>, String> {
    let disk = place.folder.join("disk");
    std::fs::create_dir_all(&disk).map_err(|error| format!("{}: {error}", disk.display()))?;
    let mut mount = Command::new("mount");
    mount.args(["-t", "tmpfs", "-o"]).arg(format!("size={kilobytes}k")).arg("tmpfs").arg(&disk);
    if !mount.stderr(Stdio::null()).status().is_ok_and(|status| status.success()) {
        say(&format!("SKIPPED: {}, a full disk: only root mounts one\n", trial.work.name));
        return Ok(Vec::new());
    }
    let output = format!("disk/{}", trial.work.name);
    let command = under("true", place, trial.work, &output);
    let fault = format!("a disk of {kilobytes} kB");
    let faults = looked_at(command, None, place.folder, &output, trial, &fault);
    Command::new("umount").arg(&disk).status().ok();
    faults
}
