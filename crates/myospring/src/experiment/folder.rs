//! The folder of results: whole or not at all.

use super::error::ExperimentError;
use super::files::Files;
use super::observer::Observer;
use crate::output::figure::{Figure, FigureError, Theme};
use crate::output::files::{self, Draft, FileError, Manifest, Reads};
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Resolution of the PNG figures, dots per inch.
const DPI: f64 = 300.0;

/// What draws a figure.
pub type Draw<'a> = &'a (dyn Fn() -> Result<Figure, FigureError> + Sync);

/// A folder of results in progress: files go to a hidden folder until all are written.
pub struct Folder {
    target: PathBuf,
    draft: Arc<Draft>,
    force: bool,
    /// Where the files are to be listed.
    manifest: Manifest,
    /// Whether that list is the folder's own.
    has_manifest: bool,
    reads: Reads,
    /// Names of the files that were written, and their sizes.
    written: Arc<Mutex<BTreeMap<String, u64>>>,
    /// What stands before the names of files: empty, or the part of the folder that this is, `cells/1/`.
    place: String,
}

impl Folder {
    /// Prepares `target` for results. Refused: what [`Folder::check`] refuses, and a folder that
    /// another run is writing to.
    ///
    /// # Errors
    ///
    /// The reason, or a folder that cannot be made.
    pub fn claim(target: &Path, force: bool, files: &Files) -> Result<Self, ExperimentError> {
        let reads = files.reads();
        Self::check_beside(target, force, &reads)?;
        let (draft, manifest) = (Self::begin(target)?, Manifest::of(target));
        let (target, draft) = (target.to_owned(), Arc::new(draft));
        let (written, place) = (Arc::default(), String::new());
        Ok(Self { target, draft, force, manifest, has_manifest: true, reads, written, place })
    }

    /// Refuses a folder that is not empty, unless `force`. With `force` it refuses one with files
    /// that its manifest does not list, that were changed since, or that were read.
    ///
    /// # Errors
    ///
    /// The reason.
    pub fn check(target: &Path, force: bool, files: &Files) -> Result<(), ExperimentError> {
        Self::check_beside(target, force, &files.reads())
    }

    fn check_beside(target: &Path, force: bool, reads: &Reads) -> Result<(), ExperimentError> {
        reads.check_folder(target)?;
        if fs::symlink_metadata(target).is_ok() && !target.is_dir() {
            let message =
                format!("cannot write results to `{}`: it is not a folder", target.display());
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

    /// Makes room in a part of a folder whose manifest lists these files, too; what it lists there is replaced.
    ///
    /// # Errors
    /// A part that another run is writing to, or that holds files which may not be replaced.
    pub fn claim_part(part: Manifest, files: &Files) -> Result<Self, ExperimentError> {
        let target = part.folder();
        let (draft, reads) = (Arc::new(Self::begin(&target)?), files.reads());
        part.check_replaceable(&reads)?;
        let (written, place, manifest) = (Arc::default(), String::new(), part);
        Ok(Self {
            target,
            draft,
            force: true,
            manifest,
            has_manifest: false,
            reads,
            written,
            place,
        })
    }

    /// A folder within this one, which is finished with it.
    pub(super) fn within(&self, place: &str) -> Self {
        Self {
            target: self.target.clone(),
            draft: Arc::clone(&self.draft),
            force: self.force,
            manifest: self.manifest.clone(),
            has_manifest: self.has_manifest,
            reads: self.reads.clone(),
            written: Arc::clone(&self.written),
            place: format!("{}{place}/", self.place),
        }
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

    /// Writes one file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), ExperimentError> {
        let name = format!("{}{name}", self.place);
        let path = self.draft.folder().join(&name);
        if let Some(parent) = path.parent() {
            files::create_folder(parent)?;
        }
        let content = content.as_ref();
        files::write(&path, content)?;
        self.written().insert(name, content.len() as u64);
        Ok(())
    }

    /// Where the results will be.
    pub fn target(&self) -> &Path {
        &self.target
    }

    /// Whether a file of this name was written.
    pub fn has(&self, name: &str) -> bool {
        self.written().contains_key(name)
    }

    /// Calls `make` to write one file at a path.
    ///
    /// # Errors
    /// What `make` gives, or that it made no file.
    pub fn write_with(
        &self,
        name: &str,
        make: impl FnOnce(&Path) -> Result<(), ExperimentError>,
    ) -> Result<(), ExperimentError> {
        let path = self.draft.folder().join(name);
        let size = make(&path).and_then(|()| match fs::metadata(&path) {
            Ok(file) => Ok(file.len()),
            Err(error) => Err(ExperimentError::new(format!("`{name}` was not written: {error}"))),
        });
        if size.is_err() {
            fs::remove_file(&path).ok();
        }
        self.written().insert(name.to_owned(), size?);
        Ok(())
    }

    /// Bytes of all files that were written.
    pub fn bytes(&self) -> u64 {
        self.written().values().sum()
    }

    /// Names of all files that were written.
    pub fn names(&self) -> BTreeSet<String> {
        self.written().keys().cloned().collect()
    }

    /// Deletes all files written except these.
    pub fn withdraw_all_but(&self, names: &BTreeSet<String>) {
        self.written().retain(|name, _| {
            let stays = names.contains(name);
            if !stays {
                // A file that cannot be deleted is complete.
                fs::remove_file(self.draft.folder().join(name)).ok();
            }
            stays
        });
    }

    fn written(&self) -> MutexGuard<'_, BTreeMap<String, u64>> {
        // Sizes are complete whenever the lock is free, also after a panic elsewhere.
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws figures, on all cores, and writes each as SVG and PNG.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn figures(
        &self,
        theme: Theme,
        figures: &[(&str, Draw<'_>)],
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let themed = |draw: Draw<'_>| draw().map(|figure| figure.themed(theme));
        figures.par_iter().try_for_each(|(name, draw)| {
            // Results that were computed are written even if their figures are not.
            if observer.is_late() {
                observer.warn(&format!("figure {name} is left out: the program was interrupted"));
                return Ok(());
            }
            self.figure(name, themed(*draw), observer)
        })
    }

    /// Writes a figure as SVG and PNG; one that cannot be drawn becomes a warning.
    fn figure(
        &self,
        name: &str,
        figure: Result<Figure, FigureError>,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        match figure.and_then(|figure| Ok((figure.to_png(DPI)?, figure.to_svg()))) {
            Ok((png, svg)) => {
                self.write(&format!("figures/{name}.svg"), svg)?;
                self.write(&format!("figures/{name}.png"), png)
            }
            Err(error) => {
                observer.warn(&format!("figure {name} is left out: {error}"));
                Ok(())
            }
        }
    }

    /// Gives the folder its name. Earlier results that the manifest lists are deleted. If another
    /// file appeared in the folder since it was claimed, the results get another name next to it,
    /// so that nothing is lost.
    ///
    /// # Errors
    ///
    /// Files that cannot be moved.
    pub fn finish(self, observer: &dyn Observer) -> Result<PathBuf, ExperimentError> {
        let target = &self.target;
        let failed = |error: std::io::Error| {
            ExperimentError::new(format!("cannot write results to `{}`: {error}", target.display()))
        };
        let work = self.draft.folder();
        let names = self.names();
        let new_folder = |to: &Path| {
            let own = Manifest::of(&work);
            let manifest = if self.has_manifest { &own } else { &self.manifest };
            manifest.announce(&names, &work)?;
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
        self.manifest.announce(&names, &work)?;
        self.manifest.clear(&[]).and_then(|()| merge(&work, target)).map_err(failed)?;
        self.manifest.settle()?;
        Ok(target.clone())
    }
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
