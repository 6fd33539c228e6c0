//! The licences that a wheel and an archive carry: the project's own, those of every crate that is linked, and those of
//! the font of the figures and of the library of the report.

use crate::tools::{cargo, root};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Where the wheel takes them from.
const FOLDER: &str = "crates/myospring-py/licences";
/// What the wheel is made of, the program included.
const PACKAGE: &str = "myospring-py";
/// How files with licences begin.
const NAMES: [&str; 5] = ["license", "licence", "copying", "copyright", "unlicense"];

/// Texts, each with whom it is of.
#[derive(Default)]
struct Texts(BTreeMap<String, BTreeSet<String>>);

impl Texts {
    fn add(&mut self, of: String, path: &Path) -> Result<(), String> {
        let bytes = fs::read(path).map_err(|error| format!("{}: {error}", path.display()))?;
        let text = String::from_utf8_lossy(&bytes).replace("\r\n", "\n");
        // The same licence is printed once, whatever its blanks.
        let lines: Vec<&str> = text.trim().lines().map(str::trim_end).collect();
        self.0.entry(lines.join("\n")).or_default().insert(of);
        Ok(())
    }
}

/// Writes them all anew.
pub(crate) fn run() -> Result<(), String> {
    let folder = root().join(FOLDER);
    let failed = |error: std::io::Error| format!("{}: {error}", folder.display());
    fs::create_dir_all(&folder).map_err(failed)?;
    for name in ["LICENSE-MIT", "LICENSE-APACHE"] {
        fs::copy(root().join(name), folder.join(name)).map_err(failed)?;
    }
    let (mut texts, mut without) = (Texts::default(), Vec::new());
    texts.add(
        "uPlot, in report.html".to_owned(),
        &root().join("crates/myospring-output/page/vendor/LICENSE"),
    )?;
    for package in linked()? {
        let text = |key: &str| package[key].as_str().unwrap_or_default();
        let of = format!("{} {} ({})", text("name"), text("version"), text("license"));
        let files = files(&package);
        if files.is_empty() {
            without.push(format!("{of}: {}", text("repository")));
        }
        for file in files {
            let font = file.file_name().is_some_and(|name| name == "LICENSE_OFL.txt");
            if font {
                fs::copy(&file, folder.join("Noto-Sans-OFL.txt")).map_err(failed)?;
            }
            let of = if font { "Noto Sans, in figures".to_owned() } else { of.clone() };
            texts.add(of, &file)?;
        }
    }
    if !folder.join("Noto-Sans-OFL.txt").is_file() {
        return Err("the licence of Noto Sans is not in the package of the font".to_owned());
    }
    let mut all = String::from("Myospring is linked with these crates, under these licences.\n");
    for (text, of) in &texts.0 {
        let of: Vec<&str> = of.iter().map(String::as_str).collect();
        let _ = write!(all, "\n{}\n{}\n\n{text}\n", "=".repeat(80), of.join("\n"));
    }
    if !without.is_empty() {
        let rule = "=".repeat(80);
        let _ = writeln!(
            all,
            "\n{rule}\nThese carry no text; the licences that they name are above.\n"
        );
        let _ = writeln!(all, "{}", without.join("\n"));
    }
    fs::write(folder.join("THIRD-PARTY.txt"), all).map_err(failed)
}

/// The crates of others that a wheel is linked with, on any system.
fn linked() -> Result<Vec<Value>, String> {
    let output = cargo(["metadata", "--format-version", "1", "--locked"]).output();
    let output = output.map_err(|error| format!("cargo metadata: {error}"))?;
    let failed = || format!("cargo metadata: {}", String::from_utf8_lossy(&output.stderr));
    let metadata: Value = serde_json::from_slice(&output.stdout).map_err(|_| failed())?;
    let list = |value: &Value| value.as_array().cloned().unwrap_or_default();
    let id = |value: &Value| value.as_str().unwrap_or_default().to_owned();
    let packages = list(&metadata["packages"]);
    let first = packages.iter().find(|package| package["name"] == PACKAGE).ok_or_else(failed)?;
    let nodes = list(&metadata["resolve"]["nodes"]);
    let nodes: HashMap<String, &Value> = nodes.iter().map(|node| (id(&node["id"]), node)).collect();
    let (mut seen, mut next) = (BTreeSet::new(), vec![id(&first["id"])]);
    while let Some(package) = next.pop() {
        let node = nodes.get(&package).copied();
        if !seen.insert(package) {
            continue;
        }
        for dependency in node.into_iter().flat_map(|node| list(&node["deps"])) {
            // What only builds or tests is not linked.
            if list(&dependency["dep_kinds"]).iter().any(|kind| kind["kind"].is_null()) {
                next.push(id(&dependency["pkg"]));
            }
        }
    }
    let of_others =
        |package: &Value| seen.contains(&id(&package["id"])) && !package["source"].is_null();
    Ok(packages.into_iter().filter(of_others).collect())
}

/// The files with the licences of a crate, beside its manifest or in the folder of its fonts.
fn files(package: &Value) -> Vec<PathBuf> {
    let manifest = Path::new(package["manifest_path"].as_str().unwrap_or_default());
    let Some(folder) = manifest.parent() else { return Vec::new() };
    let within = |folder: PathBuf| fs::read_dir(folder).into_iter().flatten().flatten();
    let files = within(folder.to_owned()).chain(within(folder.join("fonts")));
    let named = package["license_file"].as_str().map(|file| folder.join(file));
    let is_licence = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy().to_lowercase();
        path.is_file() && NAMES.iter().any(|start| name.starts_with(start))
    };
    let all: BTreeSet<PathBuf> =
        files.map(|entry| entry.path()).filter(is_licence).chain(named).collect();
    all.into_iter().filter(|path| path.is_file()).collect()
}
