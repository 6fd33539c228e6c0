//! The page of a report: its source, and the page itself in Chromium.

use super::Checks;
use crate::page::{chromium, firefox, folder, installed, npm};
use crate::tools::program;
use crate::web;
use std::path::PathBuf;
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

    /// What a web developer would check, with tools from the npm registry; the numbers of pages that the program, as the tests have
    /// built it, writes.
    pub(super) fn page(&mut self) -> Result<(), String> {
        let (source, data) = ("page: lints and types", "page: its numbers");
        if let Err(why) = installed() {
            for name in [source, data] {
                self.skip(name, &why);
            }
            return Ok(());
        }
        self.step(source, npm(&["run", "check"]))?;
        self.step(data, tests(&["test/data.test.js"]))
    }

    /// The report's page in Chromium; the page with the engine inside, and its numbers beside the program's.
    pub(super) fn browsers(&mut self) -> Result<(), String> {
        let (engine, in_chromium) = ("the page's engine", "pages in Chromium");
        if let Err(why) = installed() {
            self.skip(engine, &why);
            self.skip(in_chromium, &why);
            return Ok(());
        }
        let page = match web::toolchain() {
            Ok(()) => Some(self.with_engine()?),
            Err(why) => {
                self.skip(engine, &why);
                None
            }
        };
        let browser = chromium();
        if let Err(why) = &browser {
            self.skip(in_chromium, why);
        }
        let mut files = Vec::new();
        if page.is_some() {
            files.extend(["test/engine.test.js", "test/bad_input.test.js"]);
        }
        if browser.is_ok() {
            files.extend(["test/report.test.js", "test/space.test.js"]);
        }
        if page.is_some() && browser.is_ok() {
            files.extend(["test/web.test.js", "test/web_files.test.js"]);
        }
        if files.is_empty() {
            return Ok(());
        }
        let mut command = tests(&files);
        if let Some((engine, page)) = &page {
            command.env("ENGINE", engine).env("PAGE", page);
        }
        command.envs(browser.ok().flatten().map(|path| ("CHROMIUM", path)));
        self.step("pages and their engine", command)
    }

    /// The page with the engine inside, in Firefox.
    pub(super) fn in_firefox(&mut self) -> Result<(), String> {
        let name = "the page in Firefox";
        let browser = match installed().and_then(|()| web::toolchain()).and_then(|()| firefox()) {
            Ok(path) => path,
            Err(why) => {
                self.skip(name, &why);
                return Ok(());
            }
        };
        let (engine, page) = self.with_engine()?;
        let mut command = tests(&["test/firefox.test.js"]);
        command.env("ENGINE", engine).env("PAGE", page).env("FIREFOX", browser);
        self.step(name, command)
    }

    /// The engine and the page around it, which is packed once.
    fn with_engine(&mut self) -> Result<(PathBuf, PathBuf), String> {
        if let Some(page) = &self.page {
            return Ok(page.clone());
        }
        let around = Command::new(program("debug", "myospring-web"));
        let page = web::page(PROFILE, around).inspect_err(|_| self.failed += 1)?;
        Ok(self.page.insert(page).clone())
    }
}

/// Tests in these files, two files at a time, with the program that the tests have built.
fn tests(files: &[&str]) -> Command {
    let mut command = Command::new("node");
    command.args(["--test", "--test-concurrency=2"]).args(files).current_dir(folder());
    command.env("MYOSPRING", program("debug", "myospring"));
    command
}
