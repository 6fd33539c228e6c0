//! Developer commands of Myospring: the same ones that continuous integration runs.
//!
//! `cargo xtask test` checks everything; `cargo xtask help` lists the rest.

mod bench;
mod endure;
mod licences;
mod page;
mod python;
mod site;
mod test;
mod tools;
mod verify;
mod web;

use std::process::{Command, ExitCode};
use tools::{cargo, root, say, step, temporary};

const HELP: &str = "\
Developer commands of Myospring.

Usage: cargo xtask COMMAND

Commands:
  test         Format, lints, tests, documentation, licences and the example run files: all that must pass;
               `--quick` leaves out what is slow
  verify       Compare with closed forms, LAMMPS and Myokit; `cargo xtask verify --help` says more
  bench        Measure speed, beside other programs if asked; `cargo xtask bench --help` says more
  endure       Kill the program at random moments, take memory and disk space away, and compare the results;
               `cargo xtask endure --help` says more
  web          Build the page: one HTML file with the engine inside, target/web/myospring.html
  site         Build the page, the documentation with a search, and the API as a web site, target/site
  licences     Collect the licences that wheels and archives carry
  figures      Make pictures and film of README and documentation anew with the program itself
  help         This text
";

fn main() -> ExitCode {
    let command = std::env::args().nth(1);
    let result = match command.as_deref() {
        Some("test") => test::run(&std::env::args().skip(2).collect::<Vec<_>>()),
        Some("verify") => verify::run(std::env::args().skip(2).collect()),
        Some("endure") => endure::run(&std::env::args().skip(2).collect::<Vec<_>>()),
        Some("bench") => bench::run(std::env::args().skip(2).collect()),
        Some("web") => web::run(),
        Some("site") => site::run(),
        Some("licences") => licences::run(),
        Some("figures") => figures(),
        Some("help" | "--help" | "-h") => {
            say(HELP);
            Ok(())
        }
        Some(other) => Err(format!("there is no command `{other}`\n\n{HELP}")),
        None => Err(HELP.to_owned()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            say(&format!("xtask: {message}"));
            ExitCode::FAILURE
        }
    }
}

/// Pictures and film of README and documentation, made by the program and, of its report, by a browser.
fn figures() -> Result<(), String> {
    let results = temporary()?;
    let beat = results.path().join("beat");
    let mut command = cargo(["run", "--quiet", "--release", "--locked", "--", "run", "--output"]);
    command.arg(&beat).args(["--outputs", "report,figures,gif"]);
    step("the default beat", command)?;
    for (made, shown) in [("figures/overview.png", "overview.png"), ("beat.gif", "beat.gif")] {
        let (from, to) = (beat.join(made), root().join("docs/pictures").join(shown));
        std::fs::copy(&from, &to)
            .map_err(|error| format!("{} to {}: {error}", from.display(), to.display()))?;
    }
    page::installed()?;
    let browser = page::chromium()?;
    web::run()?;
    let page = tools::target().join("web/myospring.html");
    for (shown, picture) in [(beat.join("report.html"), "report.png"), (page, "page.png")] {
        let mut command = Command::new("node");
        command.arg("picture.js").arg(shown).arg(root().join("docs/pictures").join(picture));
        command.current_dir(page::folder());
        command.envs(browser.as_ref().map(|path| ("CHROMIUM", path)));
        step(picture, command)?;
    }
    Ok(())
}
