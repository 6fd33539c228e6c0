//! What the README and the pages of `docs` show: commands, examples, descriptions, links.
#![allow(clippy::unwrap_used, reason = "a test may stop here")]

use crate::args::Cli;
use crate::shell;
use clap::Parser;
use clap::error::ErrorKind;
use myospring::compare::dose;
use myospring::run_file::RunFile;
use myospring::study::parameters::ParameterStudy;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn pages_below(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let pages = files.into_iter().filter(|path| path.extension().is_some_and(|end| end == "md"));
    pages.chain(folders.iter().flat_map(|folder| pages_below(folder))).collect()
}

/// The pages, each with its path.
fn pages() -> Vec<(PathBuf, String)> {
    let mut paths = pages_below(&root().join("docs"));
    paths.extend(
        ["README.md", "ARCHITECTURE.md", "RECIPES.md", "CONTRIBUTING.md"]
            .map(|name| root().join(name)),
    );
    paths.into_iter().map(|path| (path.clone(), fs::read_to_string(path).unwrap())).collect()
}

/// The blocks of a page in one language.
fn blocks<'a>(page: &'a str, language: &str) -> Vec<&'a str> {
    let opened = format!("\n```{language}\n");
    let rest = page.split(&opened).skip(1);
    rest.map(|text| text.split("\n```").next().unwrap()).collect()
}

/// The words of a command line as a shell reads them, up to a comment or the next command.
fn words(line: &str) -> Vec<String> {
    let (mut words, mut word, mut quoted, mut begun) = (Vec::new(), String::new(), false, false);
    for letter in line.chars() {
        match letter {
            '"' => (quoted, begun) = (!quoted, true),
            '#' | '&' | ';' | '|' if !quoted && !begun => return words,
            ' ' if !quoted => {
                if begun {
                    words.push(std::mem::take(&mut word));
                }
                begun = false;
            }
            _ => {
                word.push(letter);
                begun = true;
            }
        }
    }
    if begun {
        words.push(word);
    }
    words
}

/// Every command line of a page, in blocks and within its text.
fn commands(page: &str) -> Vec<Vec<String>> {
    let mut outside = page.to_owned();
    for block in page.split("```").skip(1).step_by(2) {
        outside = outside.replace(block, "");
    }
    let within = outside.replace('\n', " ");
    let within = within.split('`').skip(1).step_by(2).map(str::to_owned);
    // A backslash at the end of a line goes on in the next one, as in a shell.
    let blocks = blocks(page, "sh").into_iter().map(|block| block.replace("\\\n", " "));
    let blocks = blocks.flat_map(|block| block.lines().map(str::to_owned).collect::<Vec<_>>());
    blocks.chain(within.collect::<Vec<_>>()).map(|line| words(&line)).collect()
}

#[test]
fn every_command_that_the_pages_show_is_one_that_the_program_takes() {
    let (mut seen, mut wrong) = (0, Vec::new());
    for (path, page) in pages() {
        for mut words in commands(&page) {
            // The README runs it by cargo, before it is installed.
            if let Some(place) = words.iter().position(|word| word == "--")
                && words[..place] == ["cargo", "run", "--release"]
            {
                words.splice(..=place, ["myospring".to_owned()]);
            }
            if words.first().is_none_or(|first| first != "myospring") || words.len() < 2 {
                continue;
            }
            let shown = words.join(" ");
            let given = shell::arguments(words.into_iter().map(OsString::from));
            let Ok(given) = given else {
                wrong.push(format!("{}: {shown}", path.display()));
                continue;
            };
            if let Err(error) = Cli::try_parse_from(given) {
                // The name of a command, without what it is given, or its help.
                let is_name = error.kind() == ErrorKind::MissingRequiredArgument
                    && shown.split(' ').count() <= 3;
                if error.use_stderr() && !is_name {
                    wrong.push(format!("{}: {shown}\n{error}", path.display()));
                }
            }
            seen += 1;
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(seen > 60, "{seen}");
}

#[test]
fn every_example_that_the_pages_name_is_there() {
    let folders = ["crates/myospring/examples", "verification/examples"];
    for (path, page) in pages() {
        for after in page.split("--example ").skip(1) {
            let name: String =
                after.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
            let file = format!("{name}.rs");
            let is_there = folders.iter().any(|folder| root().join(folder).join(&file).exists());
            // A placeholder has one letter.
            assert!(name.len() < 2 || is_there, "{}: {name}", path.display());
        }
    }
}

/// Examples are compiled by the tests.
#[test]
fn every_program_in_rust_is_part_of_an_example() {
    let examples = fs::read_dir(root().join("crates/myospring/examples")).unwrap();
    let examples: Vec<String> =
        examples.map(|entry| fs::read_to_string(entry.unwrap().path()).unwrap()).collect();
    let mut seen = 0;
    for (path, page) in pages() {
        for block in blocks(&page, "rust") {
            let found = examples.iter().any(|example| example.contains(block));
            assert!(found, "{}:\n{block}", path.display());
            seen += 1;
        }
    }
    assert!(seen >= 4);
}

#[test]
fn every_description_is_read() {
    let none = |_: &str| Err(std::io::ErrorKind::NotFound.into());
    let mut seen = 0;
    for (path, page) in pages() {
        for block in blocks(&page, "toml") {
            let error = if block.contains("[[drug]]") {
                dose::read(block).err().map(|error| error.to_string())
            } else if block.contains("[sampling]") {
                ParameterStudy::from_toml(block, none).err().map(|error| error.to_string())
            } else {
                RunFile::from_text(block).err().map(|error| error.to_string())
            };
            assert_eq!(error, None, "{}:\n{block}", path.display());
            seen += 1;
        }
    }
    assert!(seen >= 5);
}

/// The anchor of a heading, as the web shows pages.
fn anchor(heading: &str) -> String {
    let letters = heading.trim().to_lowercase();
    let kept = letters.chars().filter(|c| c.is_alphanumeric() || matches!(c, ' ' | '-' | '_'));
    kept.collect::<String>().replace(' ', "-")
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let headings = |page: &str| -> BTreeSet<String> {
        page.lines()
            .filter(|line| line.starts_with('#'))
            .map(|line| anchor(line.trim_start_matches('#')))
            .collect()
    };
    for (path, page) in pages() {
        for link in page.split("](").skip(1).map(|rest| rest.split(')').next().unwrap()) {
            if link.starts_with("http") {
                continue;
            }
            let (file, heading) = link.split_once('#').unwrap_or((link, ""));
            let target =
                if file.is_empty() { path.clone() } else { path.parent().unwrap().join(file) };
            assert!(target.exists(), "{}: {link}", path.display());
            if !heading.is_empty() {
                let headings = headings(&fs::read_to_string(&target).unwrap());
                assert!(headings.contains(heading), "{}: {link}", path.display());
            }
        }
    }
}

#[test]
fn the_index_lists_every_page() {
    let index = fs::read_to_string(root().join("docs/README.md")).unwrap();
    for path in pages_below(&root().join("docs")) {
        let name = path.strip_prefix(root().join("docs")).unwrap().to_str().unwrap().to_owned();
        assert!(name == "README.md" || index.contains(&format!("]({name})")), "{name}");
    }
}
