//! The tools of the page: Node.js with its packages, and browsers.

use crate::tools::{root, say};
use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Names of Chromium and of browsers that are built from it.
const BROWSERS: [&str; 4] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

/// The folder of the page's source.
pub(crate) fn folder() -> PathBuf {
    root().join("crates/myospring-output/page")
}

/// A command of npm in the folder of the page.
pub(crate) fn npm(arguments: &[&str]) -> Command {
    let mut command = Command::new(if cfg!(windows) { "npm.cmd" } else { "npm" });
    command.args(arguments).current_dir(folder());
    command
}

/// Makes sure that the tools of the page are there, in the versions of its lock file; the error says what is missing
/// and how to get it.
pub(crate) fn installed() -> Result<(), String> {
    let answers = |mut command: Command| {
        command.arg("--version").stdout(Stdio::null()).stderr(Stdio::null());
        command.status().is_ok_and(|status| status.success())
    };
    if !answers(Command::new("node")) || !answers(npm(&[])) {
        return Err("node or npm is not installed: Node.js 20.19 or newer has both".to_owned());
    }
    let read = |name: &str| std::fs::read_to_string(folder().join(name)).unwrap_or_default();
    // Written last, so what was left half made is made again.
    let stamp = "node_modules/installed.json";
    let lock = read("package-lock.json");
    if read(stamp) == lock {
        return Ok(());
    }
    say("\n== tools of the page, from the npm registry\n");
    let installed = npm(&["ci", "--no-audit", "--no-fund"]).status();
    if !installed.is_ok_and(|status| status.success()) {
        return Err("`npm ci` failed: it needs the npm registry, once".to_owned());
    }
    let stamp = folder().join(stamp);
    std::fs::write(&stamp, lock).map_err(|error| format!("{}: {error}", stamp.display()))
}

/// Chromium: the one that `CHROMIUM` names, one that is installed, Debian's if that can be installed, or, as `None`,
/// Playwright's own.
pub(crate) fn chromium() -> Result<Option<PathBuf>, String> {
    if let Some(path) = browser("CHROMIUM", &BROWSERS, "chromium") {
        return Ok(Some(path));
    }
    say("\n== Chromium, from Playwright\n");
    let mut own = Command::new("node");
    own.args(["node_modules/playwright-core/cli.js", "install", "--only-shell", "chromium"]);
    if own.current_dir(folder()).status().is_ok_and(|status| status.success()) {
        return Ok(None);
    }
    Err("no Chromium is here and none could be installed: `apt-get install chromium`, or set CHROMIUM to a browser"
        .to_owned())
}

/// Firefox: the one that `FIREFOX` names, one that is installed, or Debian's if that can be installed.
pub(crate) fn firefox() -> Result<PathBuf, String> {
    browser("FIREFOX", &["firefox", "firefox-esr"], "firefox-esr").ok_or_else(|| {
        "no Firefox is here and none could be installed: `apt-get install firefox-esr`, or set FIREFOX to one".to_owned()
    })
}

/// The browser that a variable names, one that is installed under any of these names, or a package of Debian.
fn browser(variable: &str, names: &[&str], package: &str) -> Option<PathBuf> {
    let there = || {
        let paths = env::var_os("PATH").unwrap_or_default();
        let all = env::split_paths(&paths);
        all.flat_map(|folder| names.iter().map(move |name| folder.join(name)))
            .find(|path| path.is_file())
    };
    let named = || env::var_os(variable).map(PathBuf::from);
    if let Some(path) = named().or_else(there) {
        return Some(path);
    }
    say(&format!("\n== {package}, from Debian\n"));
    let apt = |arguments: &[&str]| {
        let mut command = Command::new("apt-get");
        command.args(["-qq", "-y"]).args(arguments).env("DEBIAN_FRONTEND", "noninteractive");
        command.stdout(Stdio::null()).status().is_ok_and(|status| status.success())
    };
    let install = ["install", "--no-install-recommends", package];
    (apt(&["update"]) && apt(&install)).then(there).flatten()
}
