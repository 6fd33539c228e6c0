//! `cargo xtask endure`: ends the program at random moments and takes from it what it needs, and looks at what is left.

mod faults;
mod results;

use crate::tools::{cargo, program, root, say, step, temporary};
use results::Results;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

const HELP: &str = "\
Usage: cargo xtask endure [--quick | --for MINUTES] [--seed NUMBER] [--program PATH]

Kills the program (SIGKILL) at random moments of runs, films, fits, batches and studies, starts it again, and compares what it leaves
with the results of a program that nobody disturbed, byte by byte. Starts two at once on one folder. Then it takes memory, descriptors
and disk space away.

  --quick           Each work is killed three times (two to three minutes)
  --for MINUTES     Goes on so long; 10 unless stated
  --seed NUMBER     Of the random moments; the time unless stated
  --program PATH    The program; that which tests build unless stated
";

/// A work of the program that is ended early.
struct Work {
    name: &'static str,
    /// What it writes besides the folder of results is not looked at.
    arguments: &'static [&'static str],
    /// Whether the same command goes on with what an ended one has left; others begin anew, with `--force` where the folder is whole.
    resumes: bool,
}

/// A study, small enough to be made again and again.
const STUDY: &str = "study.toml";
const WORKS: [Work; 6] = [
    Work {
        name: "run",
        arguments: &["run", "--integrator", "quasi-static", "--spacing", "2 um"],
        resumes: false,
    },
    Work {
        name: "track",
        arguments: &[
            "track",
            "EXAMPLES/tutorial/strip.tif",
            "--posts",
            "--post-stiffness",
            "1 uN/um",
        ],
        resumes: false,
    },
    Work {
        name: "analyse",
        arguments: &["analyse", "EXAMPLES/tutorial/curve.csv"],
        resumes: false,
    },
    Work {
        name: "fit",
        arguments: &[
            "fit",
            "--spacing",
            "4 um",
            "--model",
            "given_tension",
            "--to",
            "EXAMPLES/tutorial/curve.csv",
        ],
        resumes: false,
    },
    Work {
        name: "batch",
        arguments: &["batch", "pictures", "--pixel-size", "0.25 um", "--spacing", "4 um"],
        resumes: true,
    },
    Work { name: "study", arguments: &["study", "run", STUDY], resumes: true },
];

/// Longest time that any of these takes, undisturbed or not.
const PATIENCE: Duration = Duration::from_mins(5);
/// Kills of each work in a round.
const KILLS: usize = 3;

pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    let options = Options::of(arguments)?;
    let Some(options) = options else {
        say(HELP);
        return Ok(());
    };
    if options.program.is_none() {
        step("the program", cargo(["build", "--locked", "-p", "myospring-cli"]))?;
    }
    let path = options.program.unwrap_or_else(|| program("debug", "myospring"));
    let folder = temporary()?;
    prepare(folder.path())?;
    let place = Place { program: path, folder: folder.path() };
    let mut random = Random(options.seed | 1);
    say(&format!("\nseed {}\n\n", options.seed));
    let mut trials: Vec<Trial> =
        WORKS.iter().map(|work| Trial::undisturbed(work, &place)).collect::<Result<_, String>>()?;
    let end = Instant::now() + options.time;
    loop {
        for trial in &mut trials {
            for _ in 0..KILLS {
                trial.kill(&place, &mut random)?;
            }
            trial.two_at_once(&place)?;
        }
        if options.quick || Instant::now() >= end {
            break;
        }
    }
    say(
        "\n| work | takes, s | killed | before it had written | after it was done |\n|---|---|---|---|---|\n",
    );
    for Trial { work, takes, killed, early, late, .. } in &trials {
        let name = work.name;
        say(&format!("| {name} | {:.1} | {killed} | {early} | {late} |\n", takes.as_secs_f64()));
    }
    let mut faults = faults::all(&place, &trials)?;
    faults.extend(trials.into_iter().flat_map(|trial| trial.faults));
    if faults.is_empty() {
        say("\nAll results were whole, and those made anew the same.\n");
        return Ok(());
    }
    Err(format!("{} faults (seed {}):\n   {}", faults.len(), options.seed, faults.join("\n   ")))
}

struct Options {
    quick: bool,
    time: Duration,
    seed: u64,
    program: Option<PathBuf>,
}

impl Options {
    /// `None` asks for help.
    fn of(arguments: &[String]) -> Result<Option<Self>, String> {
        const MINUTE_S: f64 = 60.0;
        let seconds = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
        let mut options = Self {
            quick: false,
            time: Duration::from_mins(10),
            seed: seconds.map_or(1, |since| since.as_secs()),
            program: None,
        };
        let mut rest = arguments.iter();
        while let Some(argument) = rest.next() {
            let mut value = || rest.next().ok_or(format!("{argument} needs a value\n\n{HELP}"));
            match argument.as_str() {
                "--help" | "-h" => return Ok(None),
                "--quick" => options.quick = true,
                "--for" => {
                    let minutes = value()?.parse().ok().filter(|it: &f64| (0.0..1e5).contains(it));
                    let minutes = minutes.ok_or(format!("--for takes minutes\n\n{HELP}"))?;
                    options.time = Duration::from_secs_f64(MINUTE_S * minutes);
                }
                "--seed" => {
                    let seed = value()?.parse();
                    options.seed = seed.map_err(|_| format!("--seed takes a number\n\n{HELP}"))?;
                }
                "--program" => options.program = Some(value()?.into()),
                other => return Err(format!("there is no option `{other}`\n\n{HELP}")),
            }
        }
        Ok(Some(options))
    }
}

/// Random numbers (xorshift): enough for moments.
struct Random(u64);

impl Random {
    /// From 0 to below 1.
    fn part(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The program, and the folder in which it is started.
struct Place<'a> {
    program: PathBuf,
    folder: &'a Path,
}

impl Place<'_> {
    /// A command of a work whose results go to a folder here.
    fn command(&self, work: &Work, output: &str, force: bool) -> Command {
        let mut command = Command::new(&self.program);
        let examples = root().join("examples").to_string_lossy().into_owned();
        command.args(work.arguments.iter().map(|argument| argument.replace("EXAMPLES", &examples)));
        command.args(["--output", output, "--quiet"]).args(force.then_some("--force"));
        command.current_dir(self.folder).stdout(Stdio::null()).stderr(Stdio::piped());
        command
    }
}

/// Runs a command to its end; its exit code, unless a signal ended it, and what it wrote to its error output.
fn ended(mut command: Command) -> Result<(Option<i32>, String), String> {
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

/// Pictures and a study.
fn prepare(folder: &Path) -> Result<(), String> {
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    let pictures = folder.join("pictures");
    std::fs::create_dir(&pictures).map_err(failed)?;
    for name in ["a.png", "b.png", "c.png", "d.png"] {
        std::fs::copy(root().join("examples/tutorial/cell.png"), pictures.join(name))
            .map_err(failed)?;
    }
    let study = "title = \"endure\"\nkind = \"cell\"\n[run.cell]\nmodel = \"coelho_2021\"\n[parameters]\n\
                 tau_fi = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.1, relative = true }\n\
                 tau_w_plus = { distribution = \"lognormal\", median = 1, log_standard_deviation = 0.1, relative = true }\n\
                 [sampling]\nsampler = \"latin-hypercube\"\nsize = 3000\n";
    std::fs::write(folder.join(STUDY), study).map_err(failed)
}

/// A work, what it leaves undisturbed, and how it fared.
struct Trial<'a> {
    work: &'a Work,
    takes: Duration,
    undisturbed: Results,
    killed: usize,
    /// Kills after which there was nothing, and after which all was there.
    early: usize,
    late: usize,
    faults: Vec<String>,
}

impl<'a> Trial<'a> {
    /// Makes the work twice; files in which both differ, such as times, are not compared.
    fn undisturbed(work: &'a Work, place: &Place<'_>) -> Result<Self, String> {
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
        let (killed, early, late, faults) = (0, 0, 0, Vec::new());
        Ok(Self { work, takes, undisturbed, killed, early, late, faults })
    }

    /// Kills the work at a random moment, and makes it again.
    fn kill(&mut self, place: &Place<'_>, random: &mut Random) -> Result<(), String> {
        const PAST_ITS_END: f64 = 1.1;
        let output = format!("{}_killed", self.work.name);
        let target = place.folder.join(&output);
        let after = self.takes.mul_f64(PAST_ITS_END * random.part());
        let mut command = place.command(self.work, &output, false);
        let child = command.spawn().map_err(|error| format!("{command:?}: {error}"))?;
        std::thread::sleep(after);
        kill(child)?;
        self.killed += 1;
        let moment = format!("{}, killed after {:.3} s", self.work.name, after.as_secs_f64());
        let is_there = target.exists();
        if !is_there {
            self.early += 1;
        } else if !self.work.resumes {
            self.late += 1;
            self.compare(&target, &format!("{moment}: its folder"))?;
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
    fn two_at_once(&mut self, place: &Place<'_>) -> Result<(), String> {
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

    fn compare(&mut self, folder: &Path, what: &str) -> Result<(), String> {
        let found = Results::of(folder)?;
        let differences = self.undisturbed.differences(&found);
        self.faults
            .extend(differences.into_iter().map(|difference| format!("{what}: {difference}")));
        Ok(())
    }

    /// Deletes results; what lies beside them then is a fault, but for other results of the same name with a number.
    fn clear(&mut self, folder: &Path, output: &str, moment: &str) -> Result<(), String> {
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

/// Ends a program at once.
fn kill(mut child: Child) -> Result<(), String> {
    // One that has ended is no fault.
    child.kill().ok();
    child.wait().map(|_| ()).map_err(|error| error.to_string())
}
