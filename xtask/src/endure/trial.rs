//! A work of the program, ended at a random moment and made again.

use super::results::Results;
use crate::tools::{root, say};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

/// A work of the program that is ended early.
pub(super) struct Work {
    pub(super) name: &'static str,
    /// What it writes besides the folder of results is not looked at.
    pub(super) arguments: &'static [&'static str],
    /// Whether the same command goes on with what an ended one has left; others begin anew, with `--force` where the folder is whole.
    pub(super) resumes: bool,
}

/// Longest time that any of these takes, undisturbed or not.
const PATIENCE: Duration = Duration::from_mins(5);

/// Random numbers (xorshift): enough for moments.
pub(super) struct Random(u64);

impl Random {
    pub(super) fn of(seed: u64) -> Self {
        Self(seed | 1)
    }

    /// From 0 to below 1.
    pub(super) fn part(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The program, and the folder in which it is started.
pub(super) struct Place<'a> {
    pub(super) program: PathBuf,
    pub(super) folder: &'a Path,
}

impl Place<'_> {
    /// A command of a work whose results go to a folder here.
    pub(super) fn command(&self, work: &Work, output: &str, force: bool) -> Command {
        let mut command = Command::new(&self.program);
        let examples = root().join("examples").to_string_lossy().into_owned();
        command.args(work.arguments.iter().map(|argument| argument.replace("EXAMPLES", &examples)));
        command.args(["--output", output, "--quiet"]).args(force.then_some("--force"));
        command.current_dir(self.folder).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }
}

/// Runs a command to its end; its exit code, unless a signal ended it, and what it wrote to its error output.
pub(super) fn ended(mut command: Command) -> Result<(Option<i32>, String), String> {
    let child = command.spawn().map_err(|error| format!("{command:?}: {error}"))?;
    let end = Instant::now() + PATIENCE;
    let mut child = child;
    while child.try_wait().map_err(|error| format!("{command:?}: {error}"))?.is_none() {
        if Instant::now() > end {
            child.kill().ok();
            return Err(format!("{command:?} did not end within {} s", PATIENCE.as_secs()));
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    let output = child.wait_with_output().map_err(|error| format!("{command:?}: {error}"))?;
    Ok((output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned()))
}

/// A work, what it leaves undisturbed, and how it fared.
pub(super) struct Trial<'a> {
    pub(super) work: &'a Work,
    pub(super) takes: Duration,
    pub(super) undisturbed: Results,
    pub(super) killed: usize,
    /// How often it was asked to end, by SIGTERM, SIGINT or SIGHUP.
    pub(super) asked: usize,
    /// Kills after which there was nothing, and after which all was there.
    pub(super) early: usize,
    pub(super) late: usize,
    pub(super) faults: Vec<String>,
}

impl<'a> Trial<'a> {
    /// Makes the work twice; files in which both differ, such as times, are not compared.
    pub(super) fn undisturbed(work: &'a Work, place: &Place<'_>) -> Result<Self, String> {
        let mut made = Vec::new();
        let start = Instant::now();
        for number in 1..=2 {
            let output = format!("{}_undisturbed_{number}", work.name);
            let (code, error) = ended(place.command(work, &output, false))?;
            if code != Some(0) {
                return Err(format!("{}, undisturbed, failed: {error}", work.name));
            }
            made.push(Results::of(&place.folder.join(&output))?);
        }
        let takes = start.elapsed() / 2;
        let second = made.pop().unwrap_or_default();
        let undisturbed = made.pop().unwrap_or_default().alike_in(&second);
        say(&format!(
            "{}: {} files the same each time, {:.1} s\n",
            work.name,
            undisturbed.compared(),
            takes.as_secs_f64()
        ));
        let ([killed, asked, early, late], faults) = ([0; 4], Vec::new());
        Ok(Self { work, takes, undisturbed, killed, asked, early, late, faults })
    }

    /// Ends the work at a random moment, by a random signal, and makes it again.
    pub(super) fn end(&mut self, place: &Place<'_>, random: &mut Random) -> Result<(), String> {
        const PAST_ITS_END: f64 = 1.1;
        const SIGNALS: [&str; 6] = ["KILL", "KILL", "KILL", "TERM", "INT", "HUP"];
        let output = format!("{}_ended", self.work.name);
        let target = place.folder.join(&output);
        let after = self.takes.mul_f64(PAST_ITS_END * random.part());
        let signal = SIGNALS[(SIGNALS.len() as f64 * random.part()) as usize];
        let mut command = place.command(self.work, &output, false);
        let child = command.spawn().map_err(|error| format!("{command:?}: {error}"))?;
        std::thread::sleep(after);
        let said = send(child, signal)?;
        let moment = format!("{}, SIG{signal} after {:.3} s", self.work.name, after.as_secs_f64());
        if said.contains("panicked") {
            self.faults.push(format!("{moment}: {said}"));
        }
        let is_there = target.exists();
        if signal == "KILL" {
            self.killed += 1;
            if !is_there {
                self.early += 1;
            } else if !self.work.resumes {
                self.late += 1;
                self.compare(&target, &format!("{moment}: its folder"))?;
            }
        } else {
            // What is there may be a part, and says so.
            self.asked += 1;
        }
        let (code, error) =
            ended(place.command(self.work, &output, is_there && !self.work.resumes))?;
        if code == Some(0) {
            self.compare(&target, &format!("{moment}, made again"))?;
        } else {
            self.faults.push(format!("{moment}, made again: failed: {error}"));
        }
        self.clear(place.folder, &output, &moment)
    }

    /// Starts the work twice on one folder: the results are those of one, and at least one says that it succeeded.
    pub(super) fn two_at_once(&mut self, place: &Place<'_>) -> Result<(), String> {
        let output = format!("{}_twice", self.work.name);
        let moment = format!("{}, two at once", self.work.name);
        let (one, other) = std::thread::scope(|scope| {
            let other = scope.spawn(|| ended(place.command(self.work, &output, false)));
            (ended(place.command(self.work, &output, false)), other.join())
        });
        let (one, other) = (one?, other.map_err(|_| format!("{moment}: a thread ended"))??);
        if one.0 != Some(0) && other.0 != Some(0) {
            self.faults.push(format!("{moment}: both failed: {} {}", one.1, other.1));
        }
        for (_, error) in [&one, &other] {
            if error.contains("panicked") {
                self.faults.push(format!("{moment}: {error}"));
            }
        }
        self.compare(&place.folder.join(&output), &moment)?;
        self.clear(place.folder, &output, &moment)
    }

    pub(super) fn compare(&mut self, folder: &Path, what: &str) -> Result<(), String> {
        let found = Results::of(folder)?;
        let differences = self.undisturbed.differences(&found);
        self.faults
            .extend(differences.into_iter().map(|difference| format!("{what}: {difference}")));
        Ok(())
    }

    /// Deletes results; what lies beside them then is a fault, but for other results of the same name with a number.
    pub(super) fn clear(
        &mut self,
        folder: &Path,
        output: &str,
        moment: &str,
    ) -> Result<(), String> {
        let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
        for entry in std::fs::read_dir(folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            if !name.contains(output) {
                continue;
            }
            let after = name.strip_prefix(output).unwrap_or("?");
            if !after.trim_start_matches('_').chars().all(|c| c.is_ascii_digit()) {
                self.faults.push(format!("{moment}: `{name}` is left behind"));
            }
            let is_folder = entry.file_type().map_err(failed)?.is_dir();
            if is_folder {
                std::fs::remove_dir_all(entry.path()).map_err(failed)?;
            } else {
                std::fs::remove_file(entry.path()).map_err(failed)?;
            }
        }
        Ok(())
    }
}

/// Sends a program a signal and waits for its end; what it wrote to its error output.
fn send(child: Child, signal: &str) -> Result<String, String> {
    // One that has ended is no fault.
    let mut kill = Command::new("kill");
    kill.args(["-s", signal, &child.id().to_string()]).stderr(Stdio::null());
    kill.status().map_err(|error| format!("{kill:?}: {error}"))?;
    let output = child.wait_with_output().map_err(|error| error.to_string())?;
    Ok(String::from_utf8_lossy(&output.stderr).into_owned())
}
