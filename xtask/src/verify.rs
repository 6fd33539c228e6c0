//! `cargo xtask verify`: Myospring against closed forms and against programs we did not write.
//!
//! Runs each check of the member `verification`, lets the Python scripts beside it run LAMMPS and
//! Myokit on the same work, prints a table and writes it to `docs/reference/verification.md`.

mod page;

use crate::python::{self, Python};
use crate::tools::{cargo, program, root, say, step};
use page::{Row, Section};
use std::ffi::OsString;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const HELP: &str = "\
Compare Myospring with closed forms and with programs we did not write.

Usage: cargo xtask verify [--quick] [CHECK ...]

Without CHECK all checks are made and the table goes to docs/reference/verification.md; with CHECK or --quick
it is printed only. The command fails if a row fails. A row whose program is missing says SKIPPED
and what to install.

Checks:
  oscillator       Two masses on a spring: orders in time, closed form
  time-order       A whole strip in fast motion: orders in time
  chain            A hanging chain at rest: the discrete catenary
  wave             A wave along a strip: sqrt(E/rho), order in space and time
  patch            Uniform tension on a block: homogeneous shapes, E and nu, any orientation
  conservation     A million steps: momentum, angular momentum, energy
  beat             The default beat: balance of energy, mass and step do not matter
  convergence      Shortening on finer and finer lattices
  lammps           A lattice in motion, mass by mass, against LAMMPS
  myokit           All sets of the minimal model, all states, against Myokit's CVODE
  land             Myofilaments that depend on length and speed, against independent programs
  tor-ord          Action potential, calcium and tension of ToR-ORd, against Myokit's and an independent implementation
  loads            Held, against loads, between carbon fibres, against an independent program
  gel              A cell on a gel: closed forms, balances, pyTFM's forces, measured forces
  thick            A thick cell: material, locking, shortening, a bed under it, against a separate program
  tissue           Waves through tissue: conduction velocity on three lattices, against a separate program
  viscosity        A cell whose shape lags behind its tension, against an independent program
  parts            A weak half and a passive nucleus: strain against a closed form and a finer mesh
  finite-elements  A published finite-element twitch, if its data are there
  sarcomeres       Sarcomeres in published pictures, against SarcGraph's, if they are there
  motion           Motion of a cell in a published film, against scikit-image's, if it is there

Options:
  --quick          Fewer steps and beats, coarser lattices, the same tolerances
  --help           This text

What LAMMPS and Myokit need:
  Python 3.11 or newer with venv (Debian: apt-get install python3-venv). The command makes its own
  virtual environment in target/verification/venv from verification/requirements.txt.
  Myokit needs SUNDIALS and a C compiler besides (Debian: apt-get install libsundials-dev gcc;
  macOS: brew install sundials).

Environment:
  PYTHON                    The Python to make the virtual environment with; python3
  VERIFICATION_PYTHON       A Python that has LAMMPS, Myokit and NumPy already: nothing is installed
  SUNDIALS_PREFIX           Where SUNDIALS is (include/ and lib/ below it), if not in /usr or /usr/local
  MYOSPRING_SHARED_DATA     The folder with the finite-element twitch (meshes/fe_twitch_reference.csv)
                            and the pictures of cells (images/)
";

const VENV: &str = "target/verification/venv";
const REQUIREMENTS: &str = "verification/requirements.txt";

/// A check by name, and the script that lets another program repeat it.
struct Check {
    name: &'static str,
    title: &'static str,
    /// Script, and the program that it runs.
    peer: Option<(&'static str, &'static str)>,
}

const CHECKS: [Check; 21] = [
    own("oscillator", "Oscillator"),
    own("time-order", "Order in time of a strip in motion"),
    own("chain", "Hanging chain"),
    own("wave", "Wave along a strip"),
    own("patch", "Patch test"),
    own("conservation", "Conservation laws"),
    own("beat", "The default beat"),
    own("convergence", "Convergence with the lattice"),
    Check { name: "lammps", title: "LAMMPS", peer: Some(("lammps_check.py", "LAMMPS")) },
    Check { name: "myokit", title: "Myokit", peer: Some(("myokit_check.py", "Myokit")) },
    own("land", "Myofilaments that depend on length and speed"),
    own("tor-ord", "ToR-ORd"),
    own("loads", "A cell under load"),
    own("gel", "A cell on a gel"),
    own("thick", "A thick cell"),
    own("tissue", "Waves through tissue"),
    own("viscosity", "Viscosity"),
    own("parts", "Parts of a cell that differ"),
    own("finite-elements", "Finite-element twitch"),
    own("sarcomeres", "Sarcomeres in pictures"),
    own("motion", "Motion of a cell in a film"),
];

const fn own(name: &'static str, title: &'static str) -> Check {
    Check { name, title, peer: None }
}

/// Makes the checks that the arguments name, or all.
pub(crate) fn run(arguments: Vec<String>) -> Result<(), String> {
    let (mut quick, mut wanted) = (false, Vec::new());
    for argument in arguments {
        match argument.as_str() {
            "--quick" => quick = true,
            "--help" | "-h" | "help" => {
                say(HELP);
                return Ok(());
            }
            name => match CHECKS.iter().find(|check| check.name == name) {
                Some(check) => wanted.push(check),
                None => return Err(format!("there is no check or option `{name}`\n\n{HELP}")),
            },
        }
    }
    let complete = wanted.is_empty() && !quick;
    let checks: Vec<&Check> = if wanted.is_empty() { CHECKS.iter().collect() } else { wanted };

    step("build", cargo(["build", "--release", "--locked", "-p", "myospring-verification"]))?;
    let folder = root().join("target/verification");
    std::fs::create_dir_all(&folder)
        .map_err(|error| format!("the folder {} cannot be made: {error}", folder.display()))?;
    // A figure of an earlier run may not stand in for this one.
    std::fs::remove_file(folder.join("finite_elements.svg")).ok();
    let python = checks
        .iter()
        .any(|check| check.peer.is_some())
        .then(|| python::find_or_make("VERIFICATION_PYTHON", VENV, REQUIREMENTS));

    let mut sections = Vec::new();
    for check in checks {
        say(&format!("\n== {}\n", check.title));
        let start = Instant::now();
        let rows = make(check, &folder, quick, python.as_ref());
        let seconds = start.elapsed().as_secs_f64();
        for row in &rows {
            say(&page::line(row));
        }
        sections.push(Section { title: check.title, rows, seconds });
    }
    say(&page::summary(&sections));
    if complete {
        write_page(&sections, &folder)?;
    }
    match page::count(&sections, "fail") {
        0 => Ok(()),
        failed => Err(format!("{failed} rows of the verification failed")),
    }
}

/// Writes the page, and the figure that a check may have left.
fn write_page(sections: &[Section], folder: &Path) -> Result<(), String> {
    let docs = root().join("docs");
    let drawn = folder.join("finite_elements.svg");
    if drawn.exists() {
        let figure = docs.join(page::FIGURE);
        std::fs::copy(&drawn, &figure)
            .map_err(|error| format!("{} cannot be written: {error}", figure.display()))?;
    }
    let file = docs.join("reference/verification.md");
    std::fs::write(&file, page::page(sections, &machine(), drawn.exists()))
        .map_err(|error| format!("{} cannot be written: {error}", file.display()))?;
    say(&format!("written to {}\n", file.display()));
    Ok(())
}

/// The rows of a check; whatever goes wrong on the way is a row that fails.
fn make(
    check: &Check,
    folder: &Path,
    quick: bool,
    python: Option<&Result<Python, String>>,
) -> Vec<Row> {
    let mut ours = Command::new(program("release", "myospring-verification"));
    ours.arg(check.name).arg(folder).args(quick.then_some("--quick"));
    let Some((script, peer)) = check.peer else {
        return rows_of(ours, check, folder);
    };
    match python {
        Some(Ok(python)) => {
            if let Err(error) = finished(&mut ours) {
                return vec![Row::failed(check.title, &error)];
            }
            let mut theirs = python.script(&root().join("verification/python").join(script));
            theirs.arg(folder).env("OMP_NUM_THREADS", "1");
            rows_of(theirs, check, folder)
        }
        Some(Err(missing)) => vec![Row::skipped(check.title, peer, missing)],
        None => vec![Row::failed(check.title, "no Python was looked for")],
    }
}

/// Runs a command and reads the rows that it has written.
fn rows_of(mut command: Command, check: &Check, folder: &Path) -> Vec<Row> {
    let file = folder.join(format!("{}.json", check.name));
    let mut read = || -> Result<Vec<Row>, String> {
        // What an earlier run has left may not stand in for this one.
        if file.exists() {
            std::fs::remove_file(&file).map_err(|error| error.to_string())?;
        }
        finished(&mut command)?;
        let text = std::fs::read_to_string(&file)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        serde_json::from_str(&text).map_err(|error| format!("{}: {error}", file.display()))
    };
    read().unwrap_or_else(|error| vec![Row::failed(check.title, &error)])
}

fn finished(command: &mut Command) -> Result<(), String> {
    let name = command.get_program().to_string_lossy().into_owned();
    let output = command.output().map_err(|error| format!("{name} does not start: {error}"))?;
    if output.status.success() {
        return Ok(());
    }
    let errors = String::from_utf8_lossy(&output.stderr);
    let end: Vec<&str> = errors.lines().rev().take(3).collect();
    let end: Vec<&str> = end.into_iter().rev().collect();
    Err(format!("{name} ended with {}: {}", output.status, end.join(" / ")))
}

/// The machine and the compiler, in words.
fn machine() -> String {
    let processor = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split(':').nth(1)?.trim().to_owned())
    });
    let compiler = std::env::var_os("RUSTC").unwrap_or_else(|| OsString::from("rustc"));
    let version = Command::new(compiler).arg("--version").output().ok();
    let version = version.map(|output| String::from_utf8_lossy(&output.stdout).trim().to_owned());
    format!(
        "{} ({}), {}",
        processor.unwrap_or_else(|| "an unnamed processor".to_owned()),
        std::env::consts::OS,
        version.unwrap_or_else(|| "an unnamed compiler".to_owned()),
    )
}
