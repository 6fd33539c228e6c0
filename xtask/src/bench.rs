//! `cargo xtask bench`: how fast Myospring is, beside other programs on the same work.

mod measured;
mod threads;

use crate::python::{self, Python};
use crate::tools::{cargo, root, say, step};
use measured::{example, lines, number, rate};
use std::path::PathBuf;
use std::process::Command;

const HELP: &str = "\
Measure how fast Myospring is, beside other programs where they are installed, and print tables.

Usage: cargo xtask bench [--quick | --cells | --tissue] [--threads | --peers]

Without --peers only Myospring is measured (about 3 minutes). Run it on a machine with nothing else to
do: the numbers are wall times.

Options:
  --quick    Meshes of 2000 and 20 000 masses, and blocks of 4000 and 20 000, only
  --cells    Cell models only (with --peers about a minute)
  --tissue   Coupled cells only (with --peers two minutes)
  --threads  What a second thread gives, on a quiet machine and beside two busy processes for each core,
             which it starts and ends itself (about 5 minutes)
  --peers    Also run Numba, LAMMPS, Myokit and Finitewave by the scripts in verification/peers (more than 10 minutes). They
             need Python 3.11 or newer with venv; the command makes its own virtual environment in
             target/peers/venv from verification/peers/requirements.txt. Myokit needs SUNDIALS and a C
             compiler besides (Debian: apt-get install libsundials-dev gcc; macOS: brew install
             sundials); without them its row is missing.
  --help     This text

Environment:
  PYTHON           The Python to make the virtual environment with; python3
  PEERS_PYTHON     A Python that has the packages already: nothing is installed
  TISSUE_PEERS_PYTHON  The same for Finitewave, which needs an older NumPy (verification/peers/tissue.txt)
  SUNDIALS_PREFIX  Where SUNDIALS is, if not in a usual place
";

/// Our programs, by their names in `verification/examples`.
const OWN: [&str; 5] =
    ["throughput", "beat_time", "cell_throughput", "quasi_static", "tissue_throughput"];

/// Masses, and the arguments of one size.
const SIZES: [&str; 4] = ["2k", "20k", "200k", "2M"];

/// Masses along the axes of blocks of cubes.
const BLOCKS: [&str; 4] = ["40x12x8", "100x20x10", "60x30x20", "200x40x25"];

/// Sides of sheets of tissue, nodes: 1 and 4 cm.
const SHEETS: [&str; 2] = ["41", "161"];

/// Other programs, by their scripts.
struct Peers {
    python: Python,
    /// Keeps what they write.
    folder: PathBuf,
}

pub(crate) fn run(arguments: Vec<String>) -> Result<(), String> {
    let mut sizes = &SIZES[..];
    let mut beside = false;
    let mut threads = false;
    let (mut cells_alone, mut tissue_alone) = (false, false);
    for argument in arguments {
        match argument.as_str() {
            "--help" | "-h" => {
                say(HELP);
                return Ok(());
            }
            "--cells" => cells_alone = true,
            "--tissue" => tissue_alone = true,
            "--quick" => sizes = &SIZES[..2],
            "--threads" => threads = true,
            threads::SPIN => {
                threads::spin();
                return Ok(());
            }
            "--peers" => beside = true,
            other => return Err(format!("there is no option `{other}`\n\n{HELP}")),
        }
    }
    let mut build =
        cargo(["build", "--release", "--locked", "-p", "myospring-verification", "--quiet"]);
    build.args(OWN.map(|name| format!("--example={name}")));
    step("the programs to be measured", build)?;
    say(&format!("\n{}\n", machine()));
    if threads {
        say(&format!("\n{}", threads::tables(sizes)?));
        return Ok(());
    }
    let of_tissue = (beside && !cells_alone).then(Peers::of_tissue).transpose()?;
    if tissue_alone {
        say(&format!("\n{}", tissue(of_tissue.as_ref())?));
        return Ok(());
    }
    let peers = beside.then(Peers::find_or_make).transpose()?;
    if cells_alone {
        say(&format!("\n{}", cells(peers.as_ref())?));
        return Ok(());
    }
    say(&format!("\n{}", springs(sizes, peers.as_ref())?));
    say(&format!("\n{}", cubes(&BLOCKS[..sizes.len()], peers.as_ref())?));
    say(&format!("\n{}", cells(peers.as_ref())?));
    say(&format!("\n{}", tissue(of_tissue.as_ref())?));
    say(&format!("\n{}", paths()?));
    Ok(())
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
                let folder = peers.folder.to_string_lossy();
                let numba = peers.rate("bench_numba.py", &[size, &threads])?;
                let lammps = peers.rate("bench_lammps.py", &[size, &threads, &folder])?;
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

/// The same of lattices in space.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn cubes(blocks: &[&str], peers: Option<&Peers>) -> Result<String, String> {
    let mut table = String::from(
        "Millions of spring updates per second in space, f64\n\n\
         | masses | threads | springs, dashpots | + volume, fibre, drag | + fields |",
    );
    let more = " LAMMPS | ratio |\n|---|---|---|---|---|---|---|\n";
    table.push_str(if peers.is_some() { more } else { "\n|---|---|---|---|---|\n" });
    let most = std::thread::available_parallelism().map_or(1, |count| count.get().min(2));
    for size in blocks {
        for threads in 1..=most {
            let threads = threads.to_string();
            say(&format!("   {size}, {threads} thread(s)\n"));
            let own =
                |forces: &str| rate(&mut example("throughput", &[size, &threads, forces]), "sups");
            let [bare, all, fields] = [own("springs")?, own("all")?, own("fields")?];
            table.push_str(&format!(
                "| {size} | {threads} | {:.0} | {:.0} | {:.0} |",
                bare / 1e6,
                all / 1e6,
                fields / 1e6
            ));
            if let Some(peers) = peers {
                let folder = peers.folder.to_string_lossy();
                let lammps = peers.rate("bench_lammps.py", &[size, &threads, &folder])?;
                table.push_str(&format!(" {:.0} | {:.1} |", lammps / 1e6, bare / lammps));
            }
            table.push('\n');
        }
    }
    Ok(table)
}

/// How accurate a program must be to be compared: peak tension in per cent, APD90 in ms.
const ACCURATE: [f64; 2] = [0.1, 0.1];

/// Beats of a cell per second of processor time, and times those of the fastest run of Myokit that is accurate.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn cells(peers: Option<&Peers>) -> Result<String, String> {
    let own = lines(&mut example("cell_throughput", &[]))?;
    let mut others = Vec::new();
    if let Some(peers) = peers {
        match lines(&mut peers.command("bench_myokit.py", &[])) {
            Ok(lines) => others = lines,
            Err(error) => say(&format!("SKIPPED: Myokit: {error}\n")),
        }
    }
    let mut fastest: Option<f64> = None;
    for line in &others {
        let errors = [number(line, "tension_error_percent")?, number(line, "apd90_error_ms")?];
        if errors.iter().zip(ACCURATE).all(|(error, bound)| *error <= bound) {
            fastest = Some(number(line, "cbps_cpu")?.max(fastest.unwrap_or(0.0)));
        }
    }
    let mut table = String::from(
        "Cell model with tension at 1 Hz, beats per second on one thread\n\n\
         | program | per second | per second of processor time | error of peak tension | of APD90 | over Myokit |\n\
         |---|---|---|---|---|---|\n",
    );
    for line in own.iter().chain(&others) {
        let name = line["peer"].as_str().unwrap_or("?");
        let name = match (line["version"].as_str(), line["relative_tolerance"].as_f64()) {
            (Some(version), Some(relative)) => {
                format!("{name} {version}, {relative:e}, {:e}", number(line, "absolute_tolerance")?)
            }
            _ => name.to_owned(),
        };
        let rate = number(line, "cbps_cpu")?;
        let ratio = fastest.map_or_else(String::new, |fastest| format!("{:.1}", rate / fastest));
        table.push_str(&format!(
            "| {name} | {:.0} | {rate:.0} | {:.4} % | {:.4} ms | {ratio} |\n",
            number(line, "cbps")?,
            number(line, "tension_error_percent")?,
            number(line, "apd90_error_ms")?
        ));
    }
    Ok(table)
}

/// Steps of a node of coupled cells per second, in millions, and velocities of their waves.
#[allow(clippy::format_push_string, reason = "rows of a table")]
fn tissue(peers: Option<&Peers>) -> Result<String, String> {
    let mut table = String::from(
        "Tissue: millions of steps of a node per second, forward Euler of 0.02 ms, and velocity of the wave\n\n\
         | nodes | threads | steps | velocity |",
    );
    table.push_str(if peers.is_some() {
        " Finitewave | its velocity | ratio |\n|---|---|---|---|---|---|---|\n"
    } else {
        "\n|---|---|---|---|\n"
    });
    for side in SHEETS {
        for threads in ["1", "2"] {
            let both = |command: &mut Command| -> Result<[f64; 2], String> {
                let lines = lines(command)?;
                let line = lines.last().ok_or("no numbers")?;
                Ok([number(line, "node_steps")?, number(line, "velocity_cm_per_s")?])
            };
            let [own, velocity] = both(&mut example("tissue_throughput", &[side, threads]))?;
            table.push_str(&format!(
                "| {side} x {side} | {threads} | {:.1} | {velocity:.1} cm/s |",
                own / 1e6
            ));
            if let Some(peers) = peers {
                let mut command = peers.command("bench_finitewave.py", &[side, threads]);
                let [other, velocity] = both(&mut command)?;
                table.push_str(&format!(
                    " {:.1} | {velocity:.1} cm/s | {:.1} |",
                    other / 1e6,
                    own / other
                ));
            }
            table.push('\n');
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
    fn find_or_make() -> Result<Self, String> {
        let requirements = "verification/peers/requirements.txt";
        Self::of("PEERS_PYTHON", "target/peers/venv", requirements)
    }

    /// Finitewave alone.
    fn of_tissue() -> Result<Self, String> {
        Self::of("TISSUE_PEERS_PYTHON", "target/peers/tissue", "verification/peers/tissue.txt")
    }

    fn of(variable: &str, folder: &str, requirements: &str) -> Result<Self, String> {
        let python = python::find_or_make(variable, folder, requirements)?;
        let folder = root().join("target/peers");
        std::fs::create_dir_all(&folder)
            .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display()))?;
        Ok(Self { python, folder })
    }

    fn command(&self, script: &str, arguments: &[&str]) -> Command {
        let mut command = self.python.script(&root().join("verification/peers").join(script));
        command.args(arguments);
        command
    }

    fn rate(&self, script: &str, arguments: &[&str]) -> Result<f64, String> {
        rate(&mut self.command(script, arguments), "sups")
    }
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
