//! Pages without their data, assembled from their source: style, drawing and the library for curves
//! in one file.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};
use std::fmt::Write as _;
use std::sync::LazyLock;

/// A module of the page: its name and text.
macro_rules! modules {
    ($($name:literal),* $(,)?) => {
        [$(($name, include_str!(concat!("../../page/src/", $name)))),*]
    };
}

/// The modules that draw, each after those that it imports.
const MODULES: [(&str, &str); 23] = modules![
    "numbers.js",
    "colours.js",
    "elements.js",
    "data.js",
    "fields.js",
    "drawing.js",
    "cell-view.js",
    "camera.js",
    "pixels.js",
    "space-view.js",
    "overlay-view.js",
    "player.js",
    "curves.js",
    "charts.js",
    "controls.js",
    "profiles.js",
    "tables.js",
    "header.js",
    "sections.js",
    "layout.js",
    "paper.js",
    "beat.js",
    "whole.js",
];

/// The module that begins a report.
const REPORT: [(&str, &str); 1] = modules!["report.js"];

/// The modules of the page that simulates.
const WEB: [(&str, &str); 10] = modules![
    "engine.js",
    "form.js",
    "link.js",
    "measured.js",
    "outline.js",
    "samples.js",
    "video.js",
    "files.js",
    "tour.js",
    "web.js"
];

/// The library for curves, as its authors publish it (`page/vendor`).
const CURVES: [&str; 2] = [
    include_str!("../../page/vendor/uPlot.min.css"),
    include_str!("../../page/vendor/uPlot.iife.min.js"),
];

/// With places for title and data.
pub(super) static TEMPLATE: LazyLock<String> = LazyLock::new(|| assembled(&REPORT, "", "", ""));

/// The page that simulates, around its engine, a WebAssembly module packed as `.lzma`, and the one that unpacks it, with a
/// tutorial in Markdown whose numbered parts are its tour.
pub fn around_engine(packed: &[u8], unpacker: &[u8], tour: &str) -> String {
    let aside = include_str!("../../page/src/web.html")
        .replacen("{{tour}}", tour, 1)
        .replacen("{{worker}}", include_str!("../../page/src/worker.js"), 1)
        .replacen("{{unpacker}}", &STANDARD.encode(unpacker), 1)
        .replacen("{{engine}}", &STANDARD.encode(packed), 1);
    let style = include_str!("../../page/src/web.css");
    let page =
        assembled(&WEB, style, &aside, "'wasm-unsafe-eval'; worker-src blob:; media-src blob:");
    // Its engine gives the data.
    page.replace("{{title}}", "Myospring").replacen("{{data}}", "null", 1)
}

/// A page with its own modules, its style in addition to that of reports, what comes before its results, and sources of
/// scripts that its content policy allows in addition to its own.
fn assembled(own: &[(&str, &str)], style: &str, aside: &str, sources: &str) -> String {
    let common = without_imports(include_str!("../../page/src/report.css"), &["@import "]);
    let style = format!("{}\n{common}{style}", CURVES[0]);
    let script = script(own);
    // Only content of the file: no network, no other script.
    let policy = format!(
        "default-src 'none'; script-src {} {sources}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&script),
        hash(&style)
    );
    let page = include_str!("../../page/src/report.html");
    let page = page.replacen("{{policy}}", &policy, 1).replacen("{{style}}", &style, 1);
    page.replacen("{{aside}}", aside, 1).replacen("{{script}}", &script, 1)
}

/// All modules in one scope, so that imports are not needed.
fn script(own: &[(&str, &str)]) -> String {
    let mut all = String::from("(() => {\n\"use strict\";\n");
    all.push_str(CURVES[1]);
    for (name, text) in MODULES.iter().chain(own) {
        // Types in comments are only for the type checker.
        let text = without_imports(text, &["import ", "/** @import "]);
        let text = text.strip_prefix("export ").unwrap_or(&text).replace("\nexport ", "\n");
        let _ = write!(all, "\n// {name}\n{text}");
    }
    all.push_str("})();");
    // A script element must not contain its own end tag.
    all.replace("</script", "<\\/script")
}

/// A text without its lines that import something.
fn without_imports(text: &str, imports: &[&str]) -> String {
    let brings = |line: &str| imports.iter().any(|import| line.starts_with(import));
    let kept = text.lines().filter(|line| !brings(line));
    kept.flat_map(|line| [line, "\n"]).collect()
}

fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn the_page_has_a_place_for_title_and_data_and_forbids_itself_the_network() {
        assert_eq!(TEMPLATE.matches("{{title}}").count(), 2);
        assert_eq!(TEMPLATE.matches("{{data}}").count(), 1);
        for place in ["{{policy}}", "{{style}}", "{{aside}}", "{{script}}"] {
            assert!(!TEMPLATE.contains(place), "{place}");
        }
        assert!(TEMPLATE.contains("default-src 'none'"));
        assert!(!TEMPLATE.contains("src=\"http") && !TEMPLATE.contains("href=\"http"));
    }

    #[test]
    fn every_module_stands_after_those_that_it_imports_and_shares_no_name_with_another() {
        let (mut before, mut names) = (BTreeSet::from(["uplot"]), BTreeSet::new());
        for (module, text) in MODULES.into_iter().chain(REPORT).chain(WEB) {
            for line in text.lines().filter(|line| line.starts_with("import ")) {
                // A whole import on one line, without another name for what it brings.
                let (brought, from) = line.split_once(" from ").unwrap();
                let from = from.trim_matches(['"', ';']).trim_start_matches("./");
                assert!(before.contains(from), "{module} imports {from}, which stands after it");
                assert!(!brought.contains(" as "), "{module}: {line}");
            }
            before.insert(module);
            for line in text.lines() {
                let line = line.strip_prefix("export ").unwrap_or(line);
                let declares = ["function ", "class ", "const ", "let "];
                let declared = declares.iter().find_map(|word| line.strip_prefix(word));
                let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
                if let Some(name) = declared.and_then(|rest| rest.split(|c| !is_name(c)).next()) {
                    assert!(
                        name.is_empty() || names.insert(name),
                        "{module}: {name} is another's, too"
                    );
                }
            }
        }
        let script = script(&REPORT);
        assert!(
            !script.lines().any(|line| line.starts_with("import ") || line.starts_with("export "))
        );
    }
}
