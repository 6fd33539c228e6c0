//! The Python package: its wheel, as the tests have built its parts, in an environment of its own.

use super::{Checks, PACKAGE};
use crate::licences;
use crate::tools::{root, temporary};
use std::path::PathBuf;
use std::process::Command;

impl Checks {
    /// Builds the wheel and runs the package's tests with what it installs; checks its types and that what they say
    /// of the part in Rust is so.
    pub(super) fn package(&mut self) -> Result<(), String> {
        let name = "the Python package: pytest, mypy and stubtest";
        let Some(python) = self.python(name, PACKAGE) else { return Ok(()) };
        let folder = temporary()?;
        let within = |mut command: Command| {
            command.current_dir(source());
            command
        };
        let mut build = within(python.module("maturin"));
        build
            .args(["build", "--locked", "--features", "testing", "--interpreter"])
            .arg(python.interpreter());
        build.arg("--out").arg(folder.path());
        licences::run()?;
        self.step("the Python package: its wheel", build)?;
        let wheel = std::fs::read_dir(folder.path())
            .map_err(|error| format!("{}: {error}", folder.path().display()))?
            .find_map(|entry| Some(entry.ok()?.path()))
            .ok_or("maturin made no wheel")?;
        let mut install = python.module("pip");
        install.args(["install", "--quiet", "--disable-pip-version-check", "--no-deps"]);
        install.arg("--force-reinstall").arg(wheel);
        self.step("the Python package: installed", install)?;
        let mut tests = within(python.module("pytest"));
        // -rs: what is skipped is said, with the reason. Each file has one worker.
        tests.args(["--quiet", "-rs", "-p", "no:cacheprovider", "-n", "2", "--dist", "loadfile"]);
        tests.arg("--durations=10");
        self.step("the Python package: pytest", tests)?;
        // From elsewhere, so that what is installed is looked at, and not its source.
        let elsewhere = |mut command: Command| {
            command.current_dir(folder.path());
            command
        };
        let mut types = elsewhere(python.module("mypy"));
        types
            .args(["--package", "myospring", "--config-file"])
            .arg(source().join("pyproject.toml"));
        self.step("the Python package: mypy", types)?;
        let mut stubs = elsewhere(python.module("mypy.stubtest"));
        stubs.arg("myospring._native");
        self.step("the Python package: stubtest", stubs)
    }
}

/// The folder of the package.
fn source() -> PathBuf {
    root().join("crates/myospring-py")
}
