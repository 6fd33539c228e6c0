//! `cargo xtask bench`: how fast Myospring is, beside other programs on the same work.

mod threads;

use crate::{cargo, root, say, step};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

const HELP: &str = "\
Measure how fast Myospring is, beside other programs where they are installed, and print tables.

Usage: cargo xtask bench [--quick] [--threads | --peers SCRIPTS HOME]

Without --peers only Myospring is measured (about 2 minutes). Run it on a machine with nothing else to
do: the numbers are wall times.

Options:
  --quick               Meshes of 2000 and 20 000 masses only
  --threads             What a second thread gives, on a quiet machine and beside two busy processes
                        for each core, which it starts and ends itself (about 5 minutes)
  --peers SCRIPTS HOME  Also run the scripts bench_numba.py, bench_lammps.py and bench_ode.py in the
                        folder SCRIPTS (about 10 minutes). HOME holds what they need: peers-venv, a
                        virtual environment with numpy, numba, lammps and myokit, and
                        peers-build/lammps_gen, built from lammps_gen.cpp. SUNDIALS_PREFIX says where
                        SUNDIALS is, if not in the system.
  --help                This text
";

/// Masses, and the arguments of one size.
const SIZES: [&str; 4] = ["2k", "20k", "200k", "2M"];

/// Makes the program one of those that keep the machine busy.
const SPIN: &str = "--spin";

/// Where other programs are.
struct Peers {
    scripts: PathBuf,
    home: PathBuf,
}

pub(crate) fn run(arguments: Vec<String>) -> Result<(), String> {
    let mut sizes = &SIZES[..];
    let mut peers = None;
    let mut threads = false;
    let mut rest = arguments.into_iter();
    while let Some(argument) = rest.next() {
        match argument.as_str() {
            "--help" | "-h" => {
                say(HELP);
                return Ok(());
            }
            "--quick" => sizes = &SIZES[..2],
            "--threads" => threads = true,
            SPIN => {
                threads::spin();
                return Ok(());
            }
            "--peers" => {
                let (Some(scripts), Some(home)) = (rest.next(), rest.next()) else {
                    return Err(format!("--peers needs two folders\n\n{HELP}"));
                };
                peers = Some(Peers { scripts: folder(&scripts)?, home: folder(&home)? });
            }
            other => return Err(format!("there is no option `{other}`\n\n{HELP}")),
        }
    }
    let mut build = cargo(["build", "--release", "--locked", "-p", "myospring", "--examples"]);
    build.arg("--quiet");
    step("the programs to be measured", build)?;
    say(&format!("\n{}\n", machine()));
    if threads {
        say(&format!("\n{}", threads::tables(sizes)?));
        return Ok(());
    }
    say(&format!("\n{}", springs(sizes, peers.as_ref())?));
    say(&format!("\n{}", cells(peers.as_ref())?));
    say(&format!("\n{}", paths()?));
    Ok(())
}

fn folder(text: &str) -> Result<PathBuf, String> {
    std::path::absolute(text)
        .ok()
        .filter(|path| path.is_dir())
        .ok_or_else(|| format!("`{text}` is not a folder"))
}

/// Spring updates per second, in millions.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn springs(sizes: &[&str], peers: Option<&Peers>) -> Result<String, String> {
    let mut table = String::from(
        "Millions of spring updates per second, f64\n\n\
         | masses | threads | springs, dashpots | + area, fibre, drag | + fields | time, fields to springs |",
    );
    table.push_str(if peers.is_some() {
        " Numba | ratio | LAMMPS | ratio |\n|---|---|---|---|---|---|---|---|---|---|\n"
    } else {
        "\n|---|---|---|---|---|---|\n"
    });
    let most = std::thread::available_parallelism().map_or(1, |count| count.get().min(2));
    for size in sizes {
        for threads in 1..=most {
            let threads = threads.to_string();
            say(&format!("   {size}, {threads} thread(s)\n"));
            let own =
                |forces: &str| rate(&mut example("throughput", &[size, &threads, forces]), "sups");
            let (bare, all, fields) = (own("springs")?, own("all")?, own("fields")?);
            table.push_str(&format!(
                "| {size} | {threads} | {:.0} | {:.0} | {:.0} | {:.2} |",
                bare / 1e6,
                all / 1e6,
                fields / 1e6,
                bare / fields
            ));
            if let Some(peers) = peers {
                let numba = peers.rate("bench_numba.py", &[size, &threads, "f64", "rows"])?;
                let lammps = peers.rate("bench_lammps.py", &[size, &format!("omp{threads}")])?;
                table.push_str(&format!(
                    " {:.0} | {:.1} | {:.0} | {:.1} |",
                    numba / 1e6,
                    bare / numba,
                    lammps / 1e6,
                    bare / lammps
                ));
            }
            table.push('\n');
        }
    }
    Ok(table)
}

/// Beats of a cell per second.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn cells(peers: Option<&Peers>) -> Result<String, String> {
    let mut table = String::from(
        "Cell model at 1 Hz, beats per second on one thread\n\n\
         | program | beats per second | error of peak tension | error of APD90 |\n|---|---|---|---|\n",
    );
    for line in lines(&mut example("cell_throughput", &[]))? {
        table.push_str(&format!(
            "| {} | {:.0} | {:.4} % | {:.4} ms |\n",
            line["peer"].as_str().unwrap_or("?"),
            number(&line, "cbps")?,
            number(&line, "tension_error_percent")?,
            number(&line, "apd90_error_ms")?
        ));
    }
    if let Some(peers) = peers {
        let mut command = peers.command("bench_ode.py", &["myokit"]);
        if let Some(prefix) = std::env::var_os("SUNDIALS_PREFIX") {
            let places = ["lib", "lib/x86_64-linux-gnu"].map(|lib| Path::new(&prefix).join(lib));
            command
                .env("LD_LIBRARY_PATH", std::env::join_paths(places).map_err(|e| e.to_string())?);
        }
        if let Some(line) = lines(&mut command)?.first() {
            let name = line["peer"].as_str().unwrap_or("?");
            let version = line["version"].as_str().unwrap_or("?");
            let rate = number(line, "cbps")?;
            table.push_str(&format!("| {name} {version}, without tension | {rate:.0} | | |\n"));
        }
    }
    Ok(table)
}

/// The path of equilibria beside the motion in time.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn paths() -> Result<String, String> {
    let lines = lines(&mut example("quasi_static", &[]))?;
    let mut text = String::from("The quasi-static solver\n\n");
    for line in lines {
        text.push_str(&format!("{line}\n"));
    }
    Ok(text)
}

impl Peers {
    fn command(&self, script: &str, arguments: &[&str]) -> Command {
        let environment = self.home.join("peers-venv");
        let mut command = Command::new(environment.join("bin/python"));
        command
            .arg(self.scripts.join(script))
            .args(arguments)
            .current_dir(&self.home)
            .env("PYTHONDONTWRITEBYTECODE", "1")
            .env("PEERS_BUILD", self.home.join("peers-build"))
            .env("PEER_PATIENCE", "5");
        command
    }

    fn rate(&self, script: &str, arguments: &[&str]) -> Result<f64, String> {
        rate(&mut self.command(script, arguments), "sups")
    }
}

fn example(name: &str, arguments: &[&str]) -> Command {
    let mut command = Command::new(root().join("target/release/examples").join(name));
    command.args(arguments);
    command
}

/// The JSON lines that a program prints.
fn lines(command: &mut Command) -> Result<Vec<Value>, String> {
    let output = command.output().map_err(|error| format!("{command:?}: {error}"))?;
    let text = String::from_utf8_lossy(&output.stdout);
    if !output.status.success() {
        return Err(format!("{command:?}: {}", String::from_utf8_lossy(&output.stderr)));
    }
    text.lines()
        .filter(|line| line.starts_with('{'))
        .map(|line| serde_json::from_str(line).map_err(|error| format!("{command:?}: {error}")))
        .collect()
}

fn rate(command: &mut Command, key: &str) -> Result<f64, String> {
    let lines = lines(command)?;
    let line = lines.last().ok_or_else(|| format!("{command:?} printed no numbers"))?;
    number(line, key)
}

fn number(line: &Value, key: &str) -> Result<f64, String> {
    line[key].as_f64().ok_or_else(|| format!("no number `{key}` in {line}"))
}

/// The processor's name and number of cores.
fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let information = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let field = |name: &str| {
        let line = information.lines().find(|line| line.starts_with(name))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    };
    let name = field("model name").unwrap_or_else(|| std::env::consts::ARCH.to_owned());
    let family = match (field("cpu family"), field("model\t")) {
        (Some(family), Some(model)) => format!(" (family {family}, model {model})"),
        _ => String::new(),
    };
    format!("{name}{family}, {cores} cores")
}
