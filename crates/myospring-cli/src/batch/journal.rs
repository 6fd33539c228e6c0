//! What is done, line by line, so that an interrupted batch goes on where it was.

use super::row::Row;
use crate::failure::Failure;
use myospring::output::files;
use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

const FILE: &str = "progress.jsonl";
const SETTINGS: &str = "settings.toml";

/// One finished picture.
#[derive(Debug, Clone, Serialize, Deserialize)]
struct Entry {
    picture: String,
    /// SHA-256 of the file: a picture that has changed is done anew.
    sha256: String,
    rows: Vec<Row>,
}

/// The journal of a batch.
pub(super) struct Journal {
    path: PathBuf,
    state: Mutex<State>,
}

struct State {
    file: File,
    entries: BTreeMap<String, Entry>,
}

impl Journal {
    /// Opens the journal in the folder of results, or begins one.
    ///
    /// A folder that holds results of other settings, or anything else, is refused unless `force`.
    pub(super) fn open(target: &Path, settings: &str, force: bool) -> Result<Self, Failure> {
        files::create_folder(target)?;
        let path = target.join(FILE);
        let failed = |error: std::io::Error| {
            Failure::new(format!("cannot write `{}`: {error}", path.display()))
                .advise("choose a folder that you may write to, like --output results/mine")
        };
        let settings_path = target.join(SETTINGS);
        let text = format!(
            "# What the results in this folder depend on; myospring batch goes on only with the same.\n# {}",
            settings.replacen('\n', "\n\n", 1)
        );
        let before = std::fs::read_to_string(&settings_path).ok();
        let occupied = std::fs::read_dir(target).map_err(failed)?.next().is_some();
        let same = before.as_deref() == Some(text.as_str());
        if occupied && !same && !force {
            let what = if before.is_some() { "results of other settings" } else { "files" };
            let message = format!("`{}` already holds {what}", target.display());
            return Err(Failure::new(message).advise(
                "choose another folder with --output DIR, or begin anew there with --force",
            ));
        }
        let entries =
            if same && !force { entries(&path).map_err(failed)? } else { BTreeMap::new() };
        if before.is_some() && force {
            // Nothing of an earlier batch stays beside this one.
            for name in ["overlays", "cells", "cells.csv", "cells.parquet"] {
                remove(&target.join(name)).map_err(failed)?;
            }
        }
        files::write(&settings_path, &text)?;
        // Written anew, which also drops a line that was cut off.
        let mut lines = String::new();
        for entry in entries.values() {
            lines.push_str(&line(entry)?);
        }
        files::write(&path, lines)?;
        let file = OpenOptions::new().append(true).open(&path).map_err(failed)?;
        Ok(Self { path, state: Mutex::new(State { file, entries }) })
    }

    /// Names of those pictures, given with their names, that are done and have not changed since.
    pub(super) fn done(&self, pictures: &[(String, PathBuf)]) -> BTreeSet<String> {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let unchanged = |(name, path): &&(String, PathBuf)| {
            state.entries.get(name).is_some_and(|entry| {
                std::fs::read(path).is_ok_and(|bytes| crate::run::hash(&bytes) == entry.sha256)
            })
        };
        pictures.iter().filter(unchanged).map(|(name, _)| name.clone()).collect()
    }

    /// Adds a finished picture; it is on the disk when this returns.
    pub(super) fn add(&self, picture: &str, sha256: &str, rows: Vec<Row>) -> Result<(), Failure> {
        let (picture, sha256) = (picture.to_owned(), sha256.to_owned());
        let entry = Entry { picture, sha256, rows };
        let line = line(&entry)?;
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.file.write_all(line.as_bytes()).and_then(|()| state.file.sync_data()).map_err(
            |error| Failure::new(format!("cannot write `{}`: {error}", self.path.display())),
        )?;
        state.entries.insert(entry.picture.clone(), entry);
        Ok(())
    }

    /// The rows of these pictures, in their order, as far as they are done.
    pub(super) fn rows(&self, pictures: &[(String, PathBuf)]) -> Vec<Row> {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let entries = pictures.iter().filter_map(|(name, _)| state.entries.get(name));
        entries.flat_map(|entry| entry.rows.iter().cloned()).collect()
    }
}

/// Removes a file, or a folder with all in it, if it is there.
fn remove(path: &Path) -> std::io::Result<()> {
    let removed =
        if path.is_dir() { std::fs::remove_dir_all(path) } else { std::fs::remove_file(path) };
    removed.or_else(
        |error| {
            if error.kind() == std::io::ErrorKind::NotFound { Ok(()) } else { Err(error) }
        },
    )
}

fn line(entry: &Entry) -> Result<String, Failure> {
    let line = serde_json::to_string(entry).map_err(Failure::new)?;
    Ok(line + "\n")
}

/// The entries of a journal; the last line may have been cut off.
fn entries(path: &Path) -> std::io::Result<BTreeMap<String, Entry>> {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => String::new(),
        Err(error) => return Err(error),
    };
    let entries = text.lines().filter_map(|line| serde_json::from_str::<Entry>(line).ok());
    Ok(entries.map(|entry| (entry.picture.clone(), entry)).collect())
}
