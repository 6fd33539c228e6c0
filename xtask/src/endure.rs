//! `cargo xtask endure`: ends the program at random moments, takes memory and disk space away, and compares the results.

mod faults;
mod results;
mod trial;

use crate::tools::{cargo, program, root, say, step, temporary};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use trial::{Place, Random, Trial, Work};

const HELP: &str = "\
Usage: cargo xtask endure [--quick | --for MINUTES] [--seed NUMBER] [--program PATH]

Ends the program (SIGKILL, SIGTERM, SIGINT, SIGHUP) at random moments of runs, films, fits, batches and studies, starts it again, and compares what it leaves
with the results of a program that nobody disturbed, byte by byte. Starts two at once on one folder. Then it takes memory, descriptors
and disk space away, lets each call that writes fail once (with strace), and gives damaged files to each reader for a minute (ten minutes in all).

  --quick           Each work is ended three times (two to three minutes, before the damaged files)
  --for MINUTES     Goes on so long; 10 unless stated
  --seed NUMBER     Of the random moments; another each time unless given
  --program PATH    Path of the program; that which tests build unless stated
";

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

/// How often each work is ended in a round.
const ENDS: usize = 3;

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
    let mut random = Random::of(options.seed);
    say(&format!("\nseed {}\n\n", options.seed));
    let mut trials: Vec<Trial> =
        WORKS.iter().map(|work| Trial::undisturbed(work, &place)).collect::<Result<_, String>>()?;
    let end = Instant::now() + options.time;
    loop {
        for trial in &mut trials {
            for _ in 0..ENDS {
                trial.end(&place, &mut random)?;
            }
            trial.two_at_once(&place)?;
        }
        if options.quick || Instant::now() >= end {
            break;
        }
    }
    say(
        "\n| work | takes, s | asked to end | killed | before it had written | after it was done |\n|---|---|---|---|---|---|\n",
    );
    for Trial { work, takes, asked, killed, early, late, .. } in &trials {
        let (name, takes) = (work.name, takes.as_secs_f64());
        say(&format!("| {name} | {takes:.1} | {asked} | {killed} | {early} | {late} |\n"));
    }
    let mut faults = faults::all(&place, &trials, options.quick)?;
    faults.extend(trials.into_iter().flat_map(|trial| trial.faults));
    let seed = options.seed.to_string();
    let mut damaged = cargo(["run", "--release", "--locked", "-p", "myospring-verification"]);
    damaged.args(["--example", "foreign_bytes", "--", "--for", "60", "--seed", &seed]);
    faults.extend(step("damaged files", damaged).err());
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
        let mut options = Self {
            quick: false,
            time: Duration::from_mins(10),
            seed: std::process::id().into(),
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
                "--program" => {
                    let path = value()?;
                    // Works are done in folders of their own.
                    let found = std::path::absolute(path).ok().filter(|path| path.is_file());
                    options.program =
                        Some(found.ok_or_else(|| format!("--program {path}: no such file"))?);
                }
                other => return Err(format!("there is no option `{other}`\n\n{HELP}")),
            }
        }
        Ok(Some(options))
    }
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
