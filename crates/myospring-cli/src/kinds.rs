//! What a file or folder is, and which command takes it: the answer to the right file at the wrong command.

use crate::failure::Failure;
use crate::input::{ending, text};
use myospring::measured::{self, Options};
use myospring::settings::PICTURE_ENDINGS;
use std::fs;
use std::path::{Path, PathBuf};

/// What a file or folder is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A PNG or TIFF, which may have frames.
    Picture,
    /// What can be nothing but a film.
    Film,
    /// Measured curves.
    Curves,
    /// An outline that can be nothing else.
    Outline,
    RunFile,
    /// The description of a study.
    Study,
    /// Drugs and their concentrations.
    Doses,
    /// A folder that a run has written.
    Results,
    /// A folder with pictures.
    Pictures,
}

const FILMS: [&str; 12] =
    ["avi", "y4m", "mp4", "m4v", "mov", "mkv", "webm", "wmv", "mpg", "mpeg", "flv", "ogv"];

const TABLES: [&str; 5] = ["csv", "txt", "tsv", "dat", "xlsx"];

impl Kind {
    /// What is there, where that is certain.
    fn of(path: &Path) -> Option<Self> {
        if path.is_dir() {
            let within = fs::read_dir(path).ok()?.flatten();
            let endings: Vec<String> = within.map(|entry| ending(&entry.path())).collect();
            let any = |of: &[&str]| endings.iter().any(|ending| of.contains(&ending.as_str()));
            let has = |file: &str| path.join(file).is_file();
            if has("run.toml") && has("traces.csv") {
                return Some(Self::Results);
            }
            return (any(PICTURE_ENDINGS) && !any(&TABLES)).then_some(Self::Pictures);
        }
        match ending(path).as_str() {
            _ if !path.exists() => None,
            "toml" => {
                let text = text(path).ok()?;
                let has = |table: &str| text.lines().any(|line| line.trim().starts_with(table));
                if has("[sampling]") || has("[parameters") {
                    return Some(Self::Study);
                }
                Some(if has("[[drug]]") { Self::Doses } else { Self::RunFile })
            }
            "geojson" | "roi" => Some(Self::Outline),
            kind if PICTURE_ENDINGS.contains(&kind) => Some(Self::Picture),
            kind if FILMS.contains(&kind) => Some(Self::Film),
            kind if TABLES.contains(&kind) => {
                let table = measured::read(path, &Options::default()).ok()?;
                let known = |curve: &measured::Curve| curve.kind != measured::Kind::Unknown;
                table.curves.iter().any(known).then_some(Self::Curves)
            }
            _ => None,
        }
    }

    /// What it is, in a sentence.
    const fn name(self) -> &'static str {
        match self {
            Self::Picture => "a picture",
            Self::Film => "a film",
            Self::Curves => "a table of measured curves",
            Self::Outline => "an outline",
            Self::RunFile => "a run file",
            Self::Study => "the description of a study",
            Self::Doses => "a file of doses",
            Self::Results => "the results of a run",
            Self::Pictures => "a folder of pictures",
        }
    }

    /// The commands that take it.
    fn answer(self, path: &Path) -> String {
        let path = shown(path);
        match self {
            Self::Picture => format!(
                "`myospring run {path}` beats its cell, `myospring segment {path}` finds its outline"
            ),
            Self::Film => format!("`myospring track {path}` follows its cell"),
            Self::Curves => format!(
                "`myospring analyse {path}` measures its beats, `myospring fit --to {path}` fits a cell to it"
            ),
            Self::Outline | Self::RunFile => format!("`myospring run {path}` beats it"),
            Self::Study => format!("`myospring study run {path}` runs it"),
            Self::Doses => format!("`myospring compare RUN.toml --doses {path}` runs them"),
            Self::Results => format!(
                "`myospring run {path}/run.toml` repeats it, `myospring compare` lays it beside another"
            ),
            Self::Pictures => format!(
                "`myospring batch {path}` beats the cells of all of them; if they are frames of a film, \
                 `myospring track {path}` follows its cell"
            ),
        }
    }
}

/// The failure of a file or folder where a command was to be.
pub(crate) fn without_command(path: &Path) -> Option<Failure> {
    let kind = Kind::of(path)?;
    let failure = Failure::new(format!("`{}` is {}, and no command", path.display(), kind.name()));
    Some(failure.advise(kind.answer(path)))
}

/// A path as it is written on a command line.
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
