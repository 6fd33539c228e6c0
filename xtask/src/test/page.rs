//! The page of a report: its source, and the page itself in Chromium.

use super::Checks;
use crate::tools::{program, root, say};
use crate::web;
use std::env;
use std::path::PathBuf;
use std::process::{Command, Stdio};

/// Names of Chromium and of browsers that are built from it.
const BROWSERS: [&str; 4] =
    ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];

impl Checks {
    /// The page with the engine inside, and its numbers beside the program's.
    pub(super) fn web(&mut self) -> Result<(), String> {
        let names = ["the page", "the page: in Chromium", "the page: in Firefox"];
        if let Err(why) = web::toolchain().and_then(|()| installed()) {
            for name in names {
                self.skip(name, &why);
            }
            return Ok(());
        }
        // Not as it is shipped, which takes minutes.
        let around = Command::new(program("debug", "myospring-web"));
        let (engine, page) = web::build("engine", around).inspect_err(|_| self.failed += 1)?;
        let test = |files: &[&str]| {
            let mut command = tests(files);
            command.env("ENGINE", &engine).env("PAGE", &page);
            command
        };
        let mut files = vec!["test/engine.test.js"];
        let browser = chromium();
        match &browser {
            Ok(_) => files.extend(["test/web.test.js", "test/web_files.test.js"]),
            Err(why) => self.skip(names[1], why),
        }
        let mut command = test(&files);
        command.envs(browser.ok().flatten().map(|path| ("CHROMIUM", path)));
        self.step(names[0], command)?;
        match firefox() {
            Ok(path) => {
                let mut command = test(&["test/firefox.test.js"]);
                command.env("FIREFOX", path);
                self.step(names[2], command)
            }
            Err(why) => {
                self.skip(names[2], &why);
                Ok(())
            }
        }
    }

    /// What a web developer would check, with tools from the npm registry; looks at pages that the program, as the tests
    /// have built it, writes.
    pub(super) fn page(&mut self) -> Result<(), String> {
        let source = "page: lints and types";
        let (data, browser) = ("page: its numbers", "page: in Chromium");
        if let Err(why) = installed() {
            for name in [source, data, browser] {
                self.skip(name, &why);
            }
            return Ok(());
        }
        self.step(source, npm(&["run", "check"]))?;
        self.step(data, tests(&["test/data.test.js"]))?;
        match chromium() {
            Ok(path) => {
                let mut command = tests(&["test/report.test.js", "test/space.test.js"]);
                command.envs(path.map(|path| ("CHROMIUM", path)));
                self.step(browser, command)
            }
            Err(why) => {
                self.skip(browser, &why);
                Ok(())
            }
        }
    }
}

/// The folder of the page's source.
pub(crate) fn folder() -> PathBuf {
    root().join("crates/myospring-output/page")
}

/// Tests in these files, two files at a time, with the program that the tests have built.
fn tests(files: &[&str]) -> Command {
    let mut command = Command::new("node");
    command.args(["--test", "--test-concurrency=2"]).args(files).current_dir(folder());
    command.env("MYOSPRING", program("debug", "myospring"));
    command
}

fn npm(arguments: &[&str]) -> Command {
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
pub(super) fn firefox() -> Result<PathBuf, String> {
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
