//! The table "Who may use whom" of ARCHITECTURE.md holds for every module of the library.
#![allow(clippy::unwrap_used, reason = "helpers of tests")]

mod library;
mod reader;

use library::Library;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The crates of the library and, where a whole crate is one room, that room.
const CRATES: [(&str, Option<&str>); 5] = [
    ("myospring", None),
    ("myospring-core", None),
    ("myospring-cell-files", Some("cell_files")),
    ("myospring-microscopy", Some("microscopy")),
    ("myospring-output", Some("output")),
];

/// The other crates: no rooms of the library, but without circles, too.
const DOORS: [&str; 6] = [
    "crates/myospring-cli",
    "crates/myospring-py",
    "crates/myospring-unpack",
    "crates/myospring-web",
    "verification",
    "xtask",
];

/// A row of the table in ARCHITECTURE.md.
struct Row {
    /// The crate that the room stands in.
    package: String,
    /// The rooms that it may use.
    allowed: BTreeSet<String>,
}

fn crates() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The rooms, as ARCHITECTURE.md has them.
fn table() -> BTreeMap<String, Row> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../ARCHITECTURE.md");
    let text = std::fs::read_to_string(path).unwrap();
    let section = text.split("## Who may use whom").nth(1).unwrap();
    let section = section.split("\n## ").next().unwrap();
    let rows = section.lines().filter(|line| line.starts_with('|')).skip(2).map(|line| {
        let mut columns = line.trim_matches('|').split('|').map(|text| text.trim().to_owned());
        let (room, package) = (columns.next().unwrap(), columns.next().unwrap());
        let allowed = columns.next().unwrap();
        let allowed = allowed.split(',').map(|name| name.trim().to_owned());
        (room, Row { package, allowed: allowed.filter(|name| !name.is_empty()).collect() })
    });
    rows.collect()
}

fn library() -> Library {
    let mut library = Library::default();
    for (package, _) in CRATES {
        library.add(&package.replace('-', "_"), &crates().join(package).join("src"));
    }
    library
}

/// The crate and the room of a module; no room for the roots of crates that have several.
fn place(module: &[String]) -> (&'static str, Option<String>) {
    let (package, whole) =
        CRATES.into_iter().find(|(package, _)| package.replace('-', "_") == module[0]).unwrap();
    (package, whole.map(str::to_owned).or_else(|| module.get(1).cloned()))
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

#[test]
fn rooms_use_only_what_the_architecture_allows() {
    let (table, library) = (table(), library());
    for used in library.uses() {
        let (Some(room), (_, other)) = (place(used.module).1, place(&used.used)) else { continue };
        let file = used.from.display();
        let row = table.get(&room).unwrap_or_else(|| {
            panic!("{file}: the room `{room}` is missing in ARCHITECTURE.md's table")
        });
        let other = other.unwrap_or_else(|| panic!("{file}: `{}` is in no room", used.path));
        assert!(
            other == room || row.allowed.contains(&other),
            "{file}: `{}` is of `{other}`, which ARCHITECTURE.md does not allow `{room}`",
            used.path
        );
    }
}

#[test]
fn the_table_names_every_room_and_its_crate_and_no_other() {
    let library = library();
    let rooms: BTreeMap<String, &str> = library
        .files()
        .filter_map(|(_, module)| {
            let (package, room) = place(module);
            Some((room?, package))
        })
        .collect();
    let table = table();
    let named: BTreeMap<String, &str> =
        table.iter().map(|(room, row)| (room.clone(), row.package.as_str())).collect();
    assert_eq!(named, rooms);
}

#[test]
fn every_file_of_a_crate_is_read() {
    let library = library();
    let read: BTreeSet<&Path> = library.files().map(|(path, _)| path).collect();
    for (package, _) in CRATES {
        for file in sources(&crates().join(package).join("src")) {
            let is_test = file.file_name().is_some_and(|name| name == "tests.rs")
                || file.parent().is_some_and(|folder| folder.ends_with("tests"));
            assert!(is_test != read.contains(file.as_path()), "{}", file.display());
        }
    }
}

/// The paths that a text is read to have, in order; in brackets what a `use` calls them.
fn read(text: &str) -> Vec<String> {
    let path = |written: &reader::Written| {
        let name = written
            .bound
            .as_ref()
            .map(|bound| format!(" [{}{}]", if bound.passed_on { "pub " } else { "" }, bound.name));
        let place = [written.scope.join(": "), written.path.join("::")];
        let place: Vec<String> = place.into_iter().filter(|part| !part.is_empty()).collect();
        place.join(": ") + &name.unwrap_or_default()
    };
    reader::read(text).written.iter().map(path).collect()
}

#[test]
fn the_reader_sees_every_form_of_a_path() {
    for (text, expected) in [
        ("use crate::cell::{self, X as Y};", vec!["crate::cell [cell]", "crate::cell::X [Y]"]),
        (
            "use crate::{\n    mesh::{\n        lattice::{self, Lattice},\n    },\n    units,\n};",
            vec![
                "crate::mesh::lattice [lattice]",
                "crate::mesh::lattice::Lattice [Lattice]",
                "crate::units [units]",
            ],
        ),
        ("pub use a::B; pub(super) use a::*;", vec!["a::B [pub B]", "a::* [pub *]"]),
        ("fn f(x: super::super::X) -> impl Y + use<'_> {}", vec!["super::super::X"]),
        ("let x = crate::output::y::<u8>(z.a());", vec!["crate::output::y"]),
        ("const X: f64 = <A as b::C>::D::E;", vec!["b::C"]),
        ("format!(\"{}\", myospring_core::cell::models())", vec!["myospring_core::cell::models"]),
        ("#[schemars(transform = bounds::STEP)] x: f64,", vec!["bounds::STEP"]),
        ("mod a { use super::b; } use c::d;", vec!["a: super::b [b]", "c::d [d]"]),
        ("pub(in crate::cell) fn f() {}", vec![]),
        ("/// See [`crate::a::B`].\n// crate::a\nconst X: &str = \"crate::a\";", vec![]),
        ("#[cfg(test)]\nmod tests { use crate::a; }\nuse b::c;", vec!["b::c [c]"]),
        ("struct X { #[cfg(test)] a: tests::A, b: b::B }", vec!["b::B"]),
    ] {
        assert_eq!(read(text), expected, "{text}");
    }
}

/// A library of one crate with these files.
fn built(files: &[(&str, &str)]) -> (tempfile::TempDir, Library) {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }
    let mut library = Library::default();
    library.add("own", folder.path());
    (folder, library)
}

#[test]
fn a_path_leads_to_the_file_where_the_thing_stands() {
    let (folder, library) = built(&[
        ("lib.rs", "pub mod room;\npub mod door { pub use crate::room::Thing as It; }"),
        ("room.rs", "mod inner;\nmod other;\npub use inner::Thing;\nuse std::fmt;"),
        ("room/inner.rs", "pub struct Thing;\nfn f() { super::super::room::other::g::<fmt::X>() }"),
        ("room/other.rs", "use own::door;\npub fn g<T>() { door::It::new(self::h) }"),
    ]);
    let name = |path: &Path| path.strip_prefix(folder.path()).unwrap().display().to_string();
    let uses: BTreeSet<(String, String)> = library
        .uses()
        .iter()
        .filter(|used| !used.is_name_only)
        .map(|used| (name(used.from), name(used.to)))
        .collect();
    // The root passes on what stands below it, and `room` its child's thing: names only.
    let expected = [("room/inner.rs", "room/other.rs"), ("room/other.rs", "room/inner.rs")];
    let expected = expected.map(|(from, to)| (from.to_owned(), to.to_owned()));
    assert_eq!(uses, BTreeSet::from(expected));
    let (uses, files) = (library.uses(), ["room/inner.rs", "room/other.rs"]);
    let circles = library::circles(&uses);
    let files = files.map(|file| folder.path().join(file));
    assert_eq!(
        circles.into_keys().collect::<Vec<_>>(),
        [files.iter().map(PathBuf::as_path).collect()]
    );
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

#[test]
fn files_use_each_other_without_a_circle() {
    let mut library = library();
    let root = crates().parent().unwrap();
    for folder in DOORS {
        let name = folder.rsplit('/').next().unwrap().replace('-', "_");
        library.add(&name, &root.join(folder).join("src"));
    }
    let name = |path: &Path| path.strip_prefix(root).unwrap().display().to_string();
    let uses = library.uses();
    let circles: Vec<String> = library::circles(&uses)
        .into_values()
        .map(|circle| {
            // One path says enough of each pair.
            let pairs: BTreeMap<_, _> =
                circle.iter().rev().map(|used| ((used.from, used.to), &used.path)).collect();
            let lines = pairs
                .into_iter()
                .map(|((from, to), path)| format!("{} uses {}: {path}", name(from), name(to)));
            lines.collect::<Vec<_>>().join("\n")
        })
        .collect();
    assert!(circles.is_empty(), "files use each other in circles:\n{}", circles.join("\n\n"));
}

/// Where a file is split at the latest.
const LONGEST_FILE: usize = 800;

#[test]
fn no_file_is_longer_than_anyone_reads() {
    let root = crates().parent().unwrap();
    let files = ["crates", "verification", "xtask"].map(|folder| sources(&root.join(folder)));
    for file in files.iter().flatten() {
        let lines = std::fs::read_to_string(file).unwrap().lines().count();
        assert!(lines <= LONGEST_FILE, "{}: {lines} lines", file.display());
    }
}

/// Lines of code of a file outside of its tests and comments.
fn code(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let tests = text.find("#[cfg(test)]\nmod tests").unwrap_or(text.len());
    let lines = text[..tests].lines().enumerate();
    lines.filter(|(_, line)| !line.trim_start().starts_with("//")).map(|(at, line)| (at + 1, line))
}

/// Files of the library and the program that are not of these folders of the core.
fn outside(of_core: &[&str]) -> Vec<PathBuf> {
    let core = crates().join("myospring-core/src");
    let own = |file: &Path| {
        of_core.iter().any(|room| {
            file.starts_with(core.join(room)) || *file == core.join(format!("{room}.rs"))
        })
    };
    let packages =
        CRATES.iter().map(|(package, _)| *package).chain(["myospring-cli", "myospring-py"]);
    let files = packages.flat_map(|package| sources(&crates().join(package).join("src")));
    let is_test = |file: &Path| {
        file.ends_with("tests.rs") || file.components().any(|part| part.as_os_str() == "tests")
    };
    files.filter(|file| !own(file) && !is_test(file)).collect()
}

#[test]
fn nobody_asks_which_cell_model_or_force_it_is() {
    let models: Vec<String> =
        myospring::cell::models().iter().map(|model| format!("\"{}\"", model.name())).collect();
    let mut asked = Vec::new();
    for file in outside(&["cell", "mechanics", "testing"]) {
        let text = std::fs::read_to_string(&file).unwrap();
        for (line, code) in code(&text) {
            let casts = ["downcast_ref", "downcast_mut", "dyn Any", ".is::<"];
            // An error that says that somebody stopped the work; Python's own objects.
            let other = ["is::<Interrupted>", "PyAny", "Bound<", "is_exact_instance"];
            let casts = casts.iter().any(|cast| code.contains(cast))
                && !other.iter().any(|known| code.contains(known));
            let types = ["MinimalModel", "TomekModel", "Land2017"];
            let named = types.iter().any(|name| code.contains(name));
            let compared = models.iter().any(|name| {
                code.contains(&format!("== {name}")) || code.contains(&format!("{name} =>"))
            });
            if casts || named || compared {
                asked.push(format!("{}:{line}: {}", file.display(), code.trim()));
            }
        }
    }
    assert!(asked.is_empty(), "ask for what it can do (ARCHITECTURE.md):\n{}", asked.join("\n"));
}
