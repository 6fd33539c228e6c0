//! A folder on the disk that is given its name when it is whole.

use crate::experiment::error::ExperimentError;
use crate::experiment::observer::Observer;
use crate::output::files::{Draft, FileError, Manifest, Reads};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A folder on the disk in progress: files go to a hidden folder until all are written.
#[derive(Clone)]
pub(super) struct Disk {
    pub(super) target: PathBuf,
    pub(super) draft: Arc<Draft>,
    force: bool,
    /// Where the files are to be listed.
    manifest: Manifest,
    /// Whether that list is the folder's own.
    has_manifest: bool,
    reads: Reads,
}

impl Disk {
    /// As [`Folder::claim`](super::Folder::claim).
    pub(super) fn claim(target: &Path, force: bool, reads: Reads) -> Result<Self, ExperimentError> {
        check(target, force, &reads)?;
        let (draft, manifest) = (Arc::new(begin(target)?), Manifest::of(target));
        Ok(Self { target: target.to_owned(), draft, force, manifest, has_manifest: true, reads })
    }

    /// As [`Folder::claim_part`](super::Folder::claim_part).
    pub(super) fn claim_part(part: Manifest, reads: Reads) -> Result<Self, ExperimentError> {
        let target = part.folder();
        let draft = Arc::new(begin(&target)?);
        part.check_replaceable(&reads)?;
        Ok(Self { target, draft, force: true, manifest: part, has_manifest: false, reads })
    }

    /// As [`Folder::finish`](super::Folder::finish).
    pub(super) fn finish(
        self,
        names: &BTreeSet<String>,
        observer: &dyn Observer,
    ) -> Result<PathBuf, ExperimentError> {
        let target = &self.target;
        let failed = |error: std::io::Error| {
            ExperimentError::new(format!("cannot write results to `{}`: {error}", target.display()))
        };
        let work = self.draft.folder();
        let new_folder = |to: &Path| {
            let own = Manifest::of(&work);
            let manifest = if self.has_manifest { &own } else { &self.manifest };
            manifest.announce(names, &work)?;
            fs::rename(&work, to).map_err(failed)
        };
        if !target.exists() {
            new_folder(target)?;
            return Ok(target.clone());
        }
        let refused = match self.manifest.check_replaceable(&self.reads) {
            Err(error) => Some(error.to_string()),
            Ok(()) if !self.force && is_occupied(target).map_err(failed)? => Some(format!(
                "files appeared in `{}` during the run and are kept",
                target.display()
            )),
            Ok(()) => None,
        };
        if let Some(why) = refused {
            let name = target.file_name().unwrap_or_default().to_string_lossy();
            let beside = |number: u32| target.with_file_name(format!("{name}_{number}"));
            let free = (2..10_000).map(beside).find(|path| !path.exists()).unwrap_or(beside(2));
            new_folder(&free)?;
            observer.warn(&format!("{why}; the results are in `{}`", free.display()));
            return Ok(free);
        }
        // Listed before they are moved, so that a folder that is only half replaced can be
        // replaced, too.
        self.manifest.announce(names, &work)?;
        self.manifest.clear(&[]).and_then(|()| merge(&work, target)).map_err(failed)?;
        self.manifest.settle()?;
        Ok(target.clone())
    }
}

/// As [`Folder::check`](super::Folder::check).
pub(super) fn check(target: &Path, force: bool, reads: &Reads) -> Result<(), ExperimentError> {
    reads.check_folder(target)?;
    if fs::symlink_metadata(target).is_ok() && !target.is_dir() {
        let message = format!("cannot write results to `{}`: it is not a folder", target.display());
        return Err(
            ExperimentError::new(message).advise("give a folder like --output results/mine")
        );
    }
    if is_occupied(target).map_err(|error| unusable(target, &error))? {
        if !force {
            let message = format!("`{}` already holds files", target.display());
            return Err(ExperimentError::new(message).advise(
                "choose another folder with --output DIR, or replace results with --force",
            ));
        }
        Manifest::of(target).check_replaceable(reads)?;
    }
    Ok(())
}

fn begin(target: &Path) -> Result<Draft, ExperimentError> {
    Draft::begin(target).map_err(|error| match error {
        FileError::NoName { .. } => {
            ExperimentError::new(format!("`{}` names no folder", target.display()))
                .advise("give a folder like --output results/mine")
        }
        FileError::InUse { .. } => {
            ExperimentError::new(error).advise("--output DIR names another folder")
        }
        FileError::Folder { source, .. } => unusable(target, &source),
        error => error.into(),
    })
}

/// Whether a folder holds anything that is not hidden.
fn is_occupied(folder: &Path) -> std::io::Result<bool> {
    let entries = match fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(false),
        entries => entries?.collect::<std::io::Result<Vec<_>>>()?,
    };
    Ok(entries.iter().any(|entry| !entry.file_name().to_string_lossy().starts_with('.')))
}

fn unusable(target: &Path, error: &std::io::Error) -> ExperimentError {
    ExperimentError::new(format!("cannot write results to `{}`: {error}", target.display()))
        .advise("choose a folder that you may write to, like --output results/mine")
}

/// Moves every file of one folder into another.
fn merge(from: &Path, to: &Path) -> std::io::Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            merge(&entry.path(), &target)?;
        } else {
            fs::rename(entry.path(), target)?;
        }
    }
    Ok(())
}
