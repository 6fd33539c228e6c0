//! Kinds of files and folders, and the commands that take them: for messages about a file given to
//! the wrong command.

use crate::failure::Failure;
use crate::files::FILES;
use crate::input::ending;
use myospring::experiment::tables::TABLES;
use myospring::measured::{self, TableOptions};
use myospring::mesh::outline::Outline;
use myospring::mesh::pixel_size::PixelSize;
use myospring::microscopy::outlines::{CoordinateUnit, Placement, ReadOptions, read_outlines};
use myospring::settings::PICTURE_ENDINGS;
use std::fs;
use std::path::{Path, PathBuf};

/// The kind of a file or folder.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A PNG or TIFF, which may have frames.
    Picture,
    /// A file that can only be a film.
    Film,
    /// Measured curves.
    Curves,
    /// A file that can only be an outline.
    Outline,
    /// A table or archive of another kind.
    Strange,
    RunFile,
    /// The description of a study.
    Study,
    /// Drugs and their concentrations.
    Doses,
    /// A folder that a run has written.
    Results,
    /// A folder with pictures.
    Pictures,
    /// A folder with tables and no pictures.
    Tables,
    EmptyFolder,
}

const FILMS: [&str; 12] =
    ["avi", "y4m", "mp4", "m4v", "mov", "mkv", "webm", "wmv", "mpg", "mpeg", "flv", "ogv"];

/// Least number of rows at which a table without names of columns is a curve, not a list of
/// corners.
const LONG: usize = 20;

impl Kind {
    /// The kind of a path, if it is certain.
    fn of(path: &Path) -> Option<Self> {
        if path.is_dir() {
            let within = fs::read_dir(path).ok()?.flatten();
            let endings: Vec<String> = within.map(|entry| ending(&entry.path())).collect();
            let any = |of: &[&str]| endings.iter().any(|ending| of.contains(&ending.as_str()));
            let has = |file: &str| path.join(file).is_file();
            if has("run.toml") && has("traces.csv") {
                return Some(Self::Results);
            }
            return match (any(PICTURE_ENDINGS), any(&TABLES)) {
                (true, false) => Some(Self::Pictures),
                (false, true) => Some(Self::Tables),
                _ => endings.is_empty().then_some(Self::EmptyFolder),
            };
        }
        match ending(path).as_str() {
            _ if !path.exists() => None,
            "toml" => {
                let text = FILES.text(path).ok()?;
                let has = |table: &str| text.lines().any(|line| line.trim().starts_with(table));
                if has("[sampling]") || has("[parameters") {
                    return Some(Self::Study);
                }
                Some(if has("[[drug]]") { Self::Doses } else { Self::RunFile })
            }
            "geojson" | "roi" => Some(Self::Outline),
            kind if PICTURE_ENDINGS.contains(&kind) => Some(Self::Picture),
            kind if FILMS.contains(&kind) => Some(Self::Film),
            kind if TABLES.contains(&kind) && is_curves(path) => Some(Self::Curves),
            kind if TABLES.contains(&kind) || ["json", "zip"].contains(&kind) => {
                let bytes = FILES.bytes(path).ok()?;
                if is_outline(path, &bytes) {
                    return Some(Self::Outline);
                }
                let holds = |letters: &[u8]| bytes.windows(letters.len()).any(|it| it == letters);
                let strange = match kind {
                    "zip" => !holds(b".roi"),
                    "xlsx" | "xlsm" | "json" => false,
                    _ => !bytes.iter().any(u8::is_ascii_digit),
                };
                strange.then_some(Self::Strange)
            }
            _ => None,
        }
    }

    /// Its name in messages.
    const fn name(self) -> &'static str {
        match self {
            Self::Picture => "a picture",
            Self::Film => "a film",
            Self::Curves => "a table of measured curves",
            Self::Outline => "an outline",
            Self::Strange => "a file with neither curves nor an outline in it",
            Self::RunFile => "a run file",
            Self::Study => "the description of a study",
            Self::Doses => "a file of doses",
            Self::Results => "the results of a run",
            Self::Pictures => "a folder of pictures",
            Self::Tables => "a folder of tables",
            Self::EmptyFolder => "an empty folder",
        }
    }

    /// The commands that take it.
    fn answer(self, raw: &Path) -> String {
        let path = shown(raw);
        match self {
            Self::Picture => format!(
                "`myospring run {path}` simulates its cell, `myospring segment {path}` finds its outline"
            ),
            Self::Strange if ending(raw) == "zip" => {
                "unpack it, and give the file or the folder that was in it".to_owned()
            }
            Self::Strange => "a curve has a column of times and one of values, an outline one of x and one of y; \
                              myospring --help says what each command takes"
                .to_owned(),
            Self::Film => format!("`myospring track {path}` follows its cell"),
            Self::Curves => format!(
                "`myospring analyse {path}` measures its beats, `myospring fit --to {path}` fits a cell to it"
            ),
            Self::Outline | Self::RunFile => format!("`myospring run {path}` simulates it"),
            Self::Study => format!("`myospring study run {path}` runs it"),
            Self::Doses => format!("`myospring compare RUN.toml --doses {path}` runs them"),
            Self::Results => format!(
                "`myospring run {path}/run.toml` repeats it, `myospring compare` compares it with another run"
            ),
            Self::Pictures => format!(
                "`myospring batch {path}` simulates the cells of all of them; if they are frames of a film, \
                 `myospring track {path}` follows its cell"
            ),
            Self::Tables => format!(
                "`myospring analyse {path}` measures the beats of all of them, `myospring fit --to {path}` fits a \
                 cell to each"
            ),
            Self::EmptyFolder => "give a file, or a folder with files in it; --help says which kinds".to_owned(),
        }
    }
}

/// Whether it is one in any form, whatever the size of its pixels.
fn is_outline(path: &Path, bytes: &[u8]) -> bool {
    let of_points = str::from_utf8(bytes).is_ok_and(|text| Outline::from_csv(text).is_ok());
    let drawn = || {
        let placement = Placement::Bounds { pixel_size: PixelSize::new(1.0).ok()? };
        let options = ReadOptions { placement, silent_unit: CoordinateUnit::default() };
        read_outlines(bytes, &path.to_string_lossy(), &options).ok()
    };
    of_points || drawn().is_some()
}

/// Whether a table has curves: known ones by their names, others by a column of times that is long.
fn is_curves(path: &Path) -> bool {
    let Ok(table) = FILES.table(path, &TableOptions::default()) else { return false };
    let is_curve = |curve: &measured::Curve| {
        curve.kind != measured::Kind::Unknown || curve.values.len() >= LONG
    };
    table.curves.iter().any(is_curve)
}

/// The failure of a file or folder given instead of a command.
pub(crate) fn without_command(path: &Path) -> Option<Failure> {
    let kind = Kind::of(path)?;
    let failure = Failure::new(format!("`{}` is {}, not a command", path.display(), kind.name()));
    Some(failure.advise(kind.answer(path)))
}

/// A path, quoted for a command line.
fn shown(path: &Path) -> String {
    let path = path.display().to_string();
    if path.contains(' ') { format!("\"{path}\"") } else { path }
}

/// Which command takes a file of a kind that this one does not take.
pub(crate) fn refusal<'a>(
    command: &str,
    paths: impl IntoIterator<Item = &'a PathBuf>,
    takes: &[Kind],
) -> Option<Failure> {
    let strange =
        |path: &'a PathBuf| Some((path, Kind::of(path).filter(|it| !takes.contains(it))?));
    let (path, kind) = paths.into_iter().find_map(strange)?;
    let (file, what) = (path.display(), kind.name());
    let message = format!("`{file}` is {what}, which `myospring {command}` does not take");
    Some(Failure::new(message).advise(kind.answer(path)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_what_it_holds_and_is_told_its_command() {
        let folder = tempfile::tempdir().unwrap();
        let beat = |i: u32| f64::from(i % 30).min(10.0);
        let lines = |all: Vec<String>| all.join("\n");
        let curve = (0..90).map(|i| format!("{}\t{}", 16.7 * f64::from(i), beat(i)));
        let corner = |angle: f64| format!("{},{}", 30.0 * angle.cos(), 30.0 * angle.sin());
        let circle = (0..60).map(|i| corner(0.1 * f64::from(i)));
        let (curve, circle) = (lines(curve.collect()), lines(circle.collect()));
        let square = r#"{"type":"Polygon","coordinates":[[[0,0],[60,0],[60,60],[0,60],[0,0]]]}"#;
        for (name, content, kind, answer) in [
            ("unnamed.tsv", curve.as_str(), Some(Kind::Curves), "myospring analyse"),
            ("circle.csv", &circle, Some(Kind::Outline), "myospring run"),
            ("named.csv", "x_um,y_um\n0,0\n60,0\n60,60\n", Some(Kind::Outline), "myospring run"),
            ("square.json", square, Some(Kind::Outline), "myospring run"),
            ("notes.txt", "the first dish\n", Some(Kind::Strange), "column of times"),
            ("pictures.zip", "PK\u{3}\u{4} a.png", Some(Kind::Strange), "unpack"),
            // Whatever is wrong with these, their own command says.
            ("damaged.csv", "x_um,y_um\n0,0\n60,zero\n", None, ""),
            ("damaged.zip", "PK\u{3}\u{4} a.roi", None, ""),
        ] {
            let path = folder.path().join(name);
            fs::write(&path, content).unwrap();
            assert_eq!(Kind::of(&path), kind, "{name}");
            let said = kind.map_or_else(String::new, |kind| kind.answer(&path));
            assert!(said.contains(answer), "{name}: {said}");
        }
        let within = |name: &str| folder.path().join(name);
        assert_eq!(Kind::of(folder.path()), Some(Kind::Tables));
        fs::create_dir(within("empty")).unwrap();
        assert_eq!(Kind::of(&within("empty")), Some(Kind::EmptyFolder));
    }
}
