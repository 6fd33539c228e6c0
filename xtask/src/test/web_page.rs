//! The page of a report: its source, and the page itself in Chromium.

use super::Checks;
use crate::page::{chromium, firefox, folder, installed, npm};
use crate::tools::program;
use crate::web;
use std::process::Command;

/// How the engine is built for tests.
const PROFILE: &str = "engine";

impl Checks {
    /// The page's engine; not as it is shipped, which takes minutes.
    pub(super) fn engine(&mut self) -> Result<(), String> {
        match web::toolchain() {
            Ok(()) => self.step("the engine", web::engine(PROFILE)),
            // The checks that need it say so.
            Err(_) => Ok(()),
        }
    }

    /// The page with the engine inside, and its numbers beside the program's.
    pub(super) fn web(&mut self) -> Result<(), String> {
        let names = ["the page", "the page: in Chromium", "the page: in Firefox"];
        if let Err(why) = web::toolchain().and_then(|()| installed()) {
            for name in names {
                self.skip(name, &why);
            }
            return Ok(());
        }
        let around = Command::new(program("debug", "myospring-web"));
        let (engine, page) = web::page(PROFILE, around).inspect_err(|_| self.failed += 1)?;
        let test = |files: &[&str]| {
            let mut command = tests(files);
            command.env("ENGINE", &engine).env("PAGE", &page);
            command
        };
        let mut files = vec!["test/engine.test.js", "test/bad_input.test.js"];
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

/// Tests in these files, two files at a time, with the program that the tests have built.
fn tests(files: &[&str]) -> Command {
    let mut command = Command::new("node");
    command.args(["--test", "--test-concurrency=2"]).args(files).current_dir(folder());
    command.env("MYOSPRING", program("debug", "myospring"));
    command
}
