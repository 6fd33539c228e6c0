//! Folders of tables: each of them is one cell or several.

use super::error::ExperimentError;
use super::input::ending;
use crate::settings::PICTURE_ENDINGS;
use std::fs;
use std::path::{Path, PathBuf};

/// Endings of tables of curves.
pub const TABLES: [&str; 9] = ["csv", "txt", "tsv", "dat", "asc", "tab", "atf", "xlsx", "xlsm"];

/// Whether a path is a table of curves, or a folder that has some and no frames of a film.
pub fn is_of_tables(path: &Path) -> bool {
    if !path.is_dir() {
        return TABLES.contains(&ending(path).as_str());
    }
    let files = files(path).unwrap_or_default();
    let has = |endings: &[&str]| files.iter().any(|file| endings.contains(&ending(file).as_str()));
    has(&TABLES) && !has(PICTURE_ENDINGS)
}

/// The paths, with the tables of each folder instead of it, by their names.
///
/// # Errors
/// A folder that cannot be read, or that has no tables.
pub fn tables(paths: &[PathBuf]) -> Result<Vec<PathBuf>, ExperimentError> {
    let mut all = Vec::new();
    for path in paths {
        if !path.is_dir() {
            all.push(path.clone());
            continue;
        }
        let mut within = files(path)?;
        within.retain(|file| TABLES.contains(&ending(file).as_str()));
        within.sort();
        if within.is_empty() {
            return Err(ExperimentError::new(format!(
                "the folder `{}` has no tables",
                path.display()
            ))
            .advise(format!("tables of curves end in .{}", TABLES.join(", ."))));
        }
        all.extend(within);
    }
    Ok(all)
}

fn files(folder: &Path) -> Result<Vec<PathBuf>, ExperimentError> {
    let failed = |error| ExperimentError::unread(folder, &error);
    let entries = fs::read_dir(folder).map_err(failed)?;
    let paths = entries.map(|entry| entry.map(|entry| entry.path()));
    let all: Result<Vec<PathBuf>, _> = paths.collect();
    Ok(all.map_err(failed)?.into_iter().filter(|path| path.is_file()).collect())
}
