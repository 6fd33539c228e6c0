//! The table "Who may use whom" of ARCHITECTURE.md holds for every module of the library.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The crates of the library and, where a whole crate is one module, that module.
const CRATES: [(&str, Option<&str>); 4] = [
    ("myospring", None),
    ("myospring-core", None),
    ("myospring-microscopy", Some("microscopy")),
    ("myospring-output", Some("output")),
];

fn crates() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Module and the modules that it may use, as ARCHITECTURE.md has them.
fn table() -> BTreeMap<String, BTreeSet<String>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ARCHITECTURE.md");
    let text = std::fs::read_to_string(path).unwrap();
    let section = text.split("## Who may use whom").nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    section
        .lines()
        .filter(|line| line.starts_with('|'))
        .skip(2)
        .map(|line| {
            let mut columns = line.trim_matches('|').split('|').map(str::trim);
            let module = columns.next().unwrap().to_owned();
            let used = columns.next().unwrap_or("").split(',').map(|name| name.trim().to_owned());
            (module, used.filter(|name| !name.is_empty()).collect())
        })
        .collect()
}

fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            files.push(path);
        }
    }
    files
}

/// First path segments behind `root` (as `crate::`) in code outside comments and test modules.
fn used_modules(text: &str, root: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    code.lines()
        .filter(|line| !line.trim_start().starts_with("//"))
        .flat_map(|line| line.split(root).skip(1))
        .flat_map(|rest| {
            let group = rest.strip_prefix('{').and_then(|inner| inner.split('}').next());
            group.unwrap_or(rest).split(',').take(if group.is_some() { usize::MAX } else { 1 })
        })
        .map(|path| {
            path.trim().chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>()
        })
        .filter(|name| !name.is_empty())
        .collect()
}

#[test]
fn modules_use_only_what_the_architecture_allows() {
    let table = table();
    let mut seen = BTreeSet::new();
    for (name, whole) in CRATES {
        let root = crates().join(name).join("src");
        for file in sources(&root) {
            let relative = file.strip_prefix(&root).unwrap();
            let first = relative.components().next().unwrap().as_os_str().to_string_lossy();
            let module = whole.unwrap_or(first.trim_end_matches(".rs")).to_owned();
            if module == "lib" {
                continue;
            }
            let allowed = table.get(&module).unwrap_or_else(|| {
                panic!("module `{module}` is missing in ARCHITECTURE.md's table")
            });
            let text = std::fs::read_to_string(&file).unwrap();
            let mut used = used_modules(&text, "myospring_core::");
            if whole.is_none() {
                used.extend(used_modules(&text, "crate::"));
            }
            for used in used {
                assert!(
                    used == module || allowed.contains(&used),
                    "{} uses `{used}`, which ARCHITECTURE.md does not allow `{module}`",
                    file.display()
                );
            }
            seen.insert(module);
        }
    }
    let gone: Vec<_> = table.keys().filter(|module| !seen.contains(*module)).collect();
    assert!(gone.is_empty(), "ARCHITECTURE.md's table names modules that are not there: {gone:?}");
}

#[test]
fn the_reader_of_paths_finds_them() {
    let code = "use crate::{mesh::Mesh, units};\nuse crate::cell::{self, X};\n// crate::no\nlet x = crate::output::y();";
    let expected: BTreeSet<String> =
        ["mesh", "units", "cell", "output"].map(str::to_owned).into_iter().collect();
    assert_eq!(used_modules(code, "crate::"), expected);
}

/// A crate is published as its own folder, so no file outside may go into it.
#[test]
fn published_crates_hold_every_file_that_they_include() {
    let mut seen = 0;
    for name in CRATES.map(|(name, _)| name).into_iter().chain(["myospring-cli"]) {
        let package = crates().join(name).canonicalize().unwrap();
        for file in sources(&package.join("src")) {
            let text = std::fs::read_to_string(&file).unwrap();
            for included in text.split("include_").skip(1) {
                let Some((_, rest)) = included.split_once("!(\"") else { continue };
                let path = file.parent().unwrap().join(rest.split('"').next().unwrap());
                let path = path.canonicalize().unwrap();
                assert!(
                    path.starts_with(&package),
                    "{} takes in {}",
                    file.display(),
                    path.display()
                );
                seen += 1;
            }
        }
    }
    assert!(seen >= 2, "the built-in cell and the references are included");
}
