//! Which pictures a batch works on: those of a folder, or those of a table with the settings of each.

use crate::experiment::input::{self, ChosenSetting};
use crate::experiment::{ExperimentError, Files};
use crate::interruption::Interruption;
use crate::run_file::Origin;
use crate::settings::{PICTURE_ENDINGS, Run, STACK_ENDINGS, Value};
use crate::study::pictures::{self, ChosenCell, Picture, read_table};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The keys that choose one cell.
const CHOICES: [&str; 3] = ["segmentation.cell", "segmentation.seed", "shape.label"];

/// Files by which results are known: of runs, fits, comparisons, batches and studies, `segment`, `track`, `analyse`.
const RESULTS: [[&str; 2]; 7] = [
    ["run.toml", "summary.json"],
    ["run.toml", "fit.json"],
    ["comparison.json", "metrics.csv"],
    ["settings.toml", "progress.jsonl"],
    ["report.json", "overlay.png"],
    ["track.json", "track.csv"],
    ["metrics.csv", "summary.json"],
];

/// Which pictures a batch works on.
#[derive(Debug, Clone)]
pub enum Pictures {
    /// Those of a folder and all folders in it.
    Folder {
        /// The folder.
        folder: PathBuf,
        /// What their names are like: `*_actinin.tif`; `None` takes all.
        pattern: Option<String>,
    },
    /// Those of a table, each with settings of its own.
    Table {
        /// The table, CSV.
        table: PathBuf,
        /// Where its files are; `None` is beside the table.
        folder: Option<PathBuf>,
    },
    /// These files.
    Files(Vec<PathBuf>),
}

impl Pictures {
    /// The table, if there is one.
    pub(super) fn table(&self) -> Option<&Path> {
        match self {
            Self::Table { table, .. } => Some(table),
            _ => None,
        }
    }

    /// The pictures and the notes on them; those within `but` are skipped.
    pub(super) fn find(
        &self,
        but: Option<&Path>,
        stacks: bool,
        files: &Files,
    ) -> Result<(Vec<Picture>, Vec<String>), ExperimentError> {
        match self {
            Self::Folder { folder, pattern } => of_folder(folder, pattern.as_deref(), but, stacks),
            Self::Table { table, folder } => of_table(table, folder.as_deref(), files),
            Self::Files(paths) if paths.is_empty() => {
                Err(ExperimentError::new("no picture was given"))
            }
            Self::Files(paths) => {
                let named = |path: &PathBuf| Picture::new(path.display().to_string(), path.clone());
                Ok((paths.iter().map(named).collect(), Vec::new()))
            }
        }
    }
}

fn of_table(
    table: &Path,
    folder: Option<&Path>,
    files: &Files,
) -> Result<(Vec<Picture>, Vec<String>), ExperimentError> {
    let bytes = files.bytes(table).map_err(|error| ExperimentError::unread(table, &error))?;
    let beside = folder.or(table.parent()).unwrap_or(Path::new(""));
    let pictures = read_table(&bytes, &table.display().to_string(), beside).map_err(|error| {
        ExperimentError::new(error).advise(
            "a table has a row for each picture, like\n  file,pixel_size,group\n  dish1/a.tif,0.27 um,control\n\
             with files named relative to the folder given, or else to the table",
        )
    })?;
    let mut notes = Vec::new();
    if let Some(folder) = folder {
        let named: Vec<PathBuf> =
            pictures.iter().filter_map(|it| it.path.canonicalize().ok()).collect();
        let found = within(folder, None)?;
        let passed_over = |path: &&PathBuf| {
            is_picture(path) && path.canonicalize().is_ok_and(|path| !named.contains(&path))
        };
        let left = found.iter().filter(passed_over).count();
        if left > 0 {
            let (folder, table) = (folder.display(), table.display());
            notes.push(format!(
                "{left} pictures in `{folder}` are not in `{table}` and were not read"
            ));
        }
    }
    Ok((pictures, notes))
}

/// The pictures of the folder and all folders in it, each with its name, in the order of the paths.
fn of_folder(
    folder: &Path,
    pattern: Option<&str>,
    but: Option<&Path>,
    stacks: bool,
) -> Result<(Vec<Picture>, Vec<String>), ExperimentError> {
    let endings = if stacks { STACK_ENDINGS } else { PICTURE_ENDINGS };
    let wanted = pattern
        .map(|text| {
            glob::Pattern::new(text).map_err(|error| {
                ExperimentError::new(format!("--pattern \"{text}\": {error}"))
                    .advise("write something like --pattern \"*_actinin.tif\"")
            })
        })
        .transpose()?;
    let files = within(folder, but)?;
    let matches = |path: &PathBuf| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        wanted.as_ref().is_none_or(|wanted| wanted.matches(&name))
    };
    let (wanted, others): (Vec<_>, Vec<_>) =
        files.into_iter().partition(|path| has_ending(path, endings) && matches(path));
    let unread = unread(&others);
    if wanted.is_empty() {
        let usual = if stacks { "*.tif, *.tiff" } else { "*.png, *.tif, *.tiff" };
        let kinds = pattern.unwrap_or(usual);
        let message = format!("`{}` holds no file like {kinds}", folder.display());
        let advice = unread.unwrap_or("give another folder or --pattern".to_owned());
        return Err(ExperimentError::new(message).advise(advice));
    }
    let named = |path: PathBuf| Picture::new(name(folder, &path), path);
    let others = others.iter().filter(|path| stacks && is_picture(path) && matches(path)).count();
    let passed_over = (others > 0).then(|| {
        format!("pictures in `{}` that are not stacks were not read: {others}", folder.display())
    });
    Ok((wanted.into_iter().map(named).collect(), unread.into_iter().chain(passed_over).collect()))
}

/// Whether a folder is one that a command of this program has written.
fn holds_results(folder: &Path) -> bool {
    RESULTS.iter().any(|files| files.iter().all(|file| folder.join(file).is_file()))
}

/// What to do about pictures of kinds that are not read.
fn unread(files: &[PathBuf]) -> Option<String> {
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    for ending in files.iter().map(|path| input::ending(path)) {
        if input::unread_picture(&ending).is_some() {
            *kinds.entry(ending).or_default() += 1;
        }
    }
    let (ending, _) = kinds.iter().max_by_key(|(_, count)| **count)?;
    let advice = input::unread_picture(ending)?;
    let kinds: Vec<String> =
        kinds.iter().map(|(ending, count)| format!("{count} .{ending}")).collect();
    Some(format!("not read: {} (a {advice})", kinds.join(", ")))
}

/// Every file in a folder and all folders in it, sorted, without hidden files, without one folder,
/// and without results, whose figures are not pictures of cells.
fn within(folder: &Path, but: Option<&Path>) -> Result<Vec<PathBuf>, ExperimentError> {
    let but = but.and_then(|but| std::path::absolute(but).ok());
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let failed = |error: std::io::Error| {
            ExperimentError::new(format!("cannot read the folder `{}`: {error}", folder.display()))
                .advise("give a folder that holds pictures")
        };
        for entry in std::fs::read_dir(&folder).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
            if entry.file_name().to_string_lossy().starts_with('.') {
                continue;
            }
            // A link to a folder could lead in a circle.
            if !kind.is_dir() {
                found.push(path);
            } else if (but.is_none() || std::path::absolute(&path).ok() != but)
                && !holds_results(&path)
            {
                folders.push(path);
            }
        }
    }
    found.sort();
    Ok(found)
}

fn is_picture(path: &Path) -> bool {
    has_ending(path, PICTURE_ENDINGS)
}

fn has_ending(path: &Path, endings: &[&str]) -> bool {
    endings.contains(&input::ending(path).as_str())
}

/// A picture's name within the folder, with `/` on every system.
fn name(folder: &Path, picture: &Path) -> String {
    let within = picture.strip_prefix(folder).unwrap_or(picture);
    let parts: Vec<_> =
        within.components().map(|part| part.as_os_str().to_string_lossy()).collect();
    parts.join("/")
}

/// The run of a picture: its own settings override those of all.
pub(super) fn settled(
    table: Option<&Path>,
    settings: &[ChosenSetting],
    picture: &Picture,
    files: &Files,
    interruption: &Interruption,
) -> Result<Run, ExperimentError> {
    let file = table.unwrap_or(Path::new("")).display().to_string();
    let own = picture.given.iter().filter(|given| !is_every(given)).map(|given| {
        let pictures::TableSetting { key, value, line, column } = given.clone();
        (Origin::Table { file: file.clone(), line, column }, key, value)
    });
    let mut settings: Vec<ChosenSetting> =
        settings.iter().filter(|given| !input::is_all_cells(given)).cloned().collect();
    if picture.given.iter().any(is_every) {
        settings.retain(|(setting, _)| !CHOICES.contains(&setting.key));
    }
    let path = picture.path.to_string_lossy().into_owned();
    let stack =
        picture.is_stack.then(|| (Origin::Option(path.clone()), "shape.stack", Value::Text(path)));
    let shape = Some(&*picture.path).filter(|_| !picture.is_stack);
    Ok(input::settle_with(shape, &settings, stack.into_iter().chain(own), files, interruption)?.1)
}

/// All cells unless the picture's settings or those of all name one.
pub(super) fn which(settings: &[ChosenSetting], picture: &Picture) -> ChosenCell {
    if picture.given.iter().any(is_every) {
        return ChosenCell::Every;
    }
    let own = picture.given.iter().any(|given| CHOICES.contains(&given.key));
    let named = settings.iter().any(|(setting, _)| CHOICES.contains(&setting.key));
    let all = settings.iter().any(input::is_all_cells);
    if own || named && !all { ChosenCell::Chosen } else { ChosenCell::Every }
}

fn is_every(given: &pictures::TableSetting) -> bool {
    given.key == "segmentation.cell" && given.value.as_text() == Some("all")
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn figures_of_results_are_no_pictures_of_cells() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        for (within, files) in [
            ("results/a", &["run.toml", "summary.json", "figures/cell.png"][..]),
            ("results/b", &["report.json", "overlay.png"]),
            ("dish", &["b.png", "run.toml", "metrics.csv"]),
            (".", &["a.png"]),
        ] {
            for file in files {
                let path = at(within).join(file);
                fs::create_dir_all(path.parent().unwrap()).unwrap();
                fs::write(path, "").unwrap();
            }
        }
        let found = within(folder.path(), None).unwrap();
        let pictures = found.iter().filter(|path| is_picture(path));
        let names: Vec<String> = pictures.map(|path| name(folder.path(), path)).collect();
        assert_eq!(names, ["a.png", "dish/b.png"]);
    }
}
