//! The folder of results: whole or not at all.

mod disk;

use super::error::ExperimentError;
use super::files::Files;
use super::observer::Observer;
use crate::output::figure::{Figure, FigureError, Theme};
use crate::output::files::{self, Manifest};
use disk::Disk;
use rayon::prelude::*;
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// Resolution of the PNG figures, dots per inch.
const DPI: f64 = 300.0;

/// What draws a figure.
pub type Draw<'a> = &'a (dyn Fn() -> Result<Figure, FigureError> + Sync);

/// The two files of a figure.
pub(super) struct FigureFiles {
    png: Vec<u8>,
    svg: String,
}

impl FigureFiles {
    pub(super) fn of(figure: &Figure) -> Result<Self, FigureError> {
        Ok(Self { png: figure.to_png(DPI)?, svg: figure.to_svg() })
    }
}

/// A folder of results in progress, on the disk or in memory.
#[derive(Clone)]
pub struct Folder {
    kept: Kept,
    /// Names of the files that were written, and their sizes.
    written: Arc<Mutex<BTreeMap<String, u64>>>,
    /// What stands before the names of files: empty, or the part of the folder that this is, `cells/1/`.
    place: String,
}

/// Where the files are.
#[derive(Clone)]
enum Kept {
    OnDisk(Disk),
    InMemory(Arc<Mutex<BTreeMap<String, Vec<u8>>>>),
}

impl Folder {
    /// Prepares `target` for results. Refused: what [`Folder::check`] refuses, and a folder that
    /// another run is writing to.
    ///
    /// # Errors
    ///
    /// The reason, or a folder that cannot be made.
    pub fn claim(target: &Path, force: bool, files: &Files) -> Result<Self, ExperimentError> {
        Ok(Self::of(Kept::OnDisk(Disk::claim(target, force, files.reads())?)))
    }

    /// Refuses a folder that is not empty, unless `force`. With `force` it refuses one with files
    /// that its manifest does not list, that were changed since, or that were read.
    ///
    /// # Errors
    ///
    /// The reason.
    pub fn check(target: &Path, force: bool, files: &Files) -> Result<(), ExperimentError> {
        disk::check(target, force, &files.reads())
    }

    /// Makes room in a part of a folder whose manifest lists these files, too; what it lists there is replaced.
    ///
    /// # Errors
    /// A part that another run is writing to, or that holds files which may not be replaced.
    pub fn claim_part(part: Manifest, files: &Files) -> Result<Self, ExperimentError> {
        Ok(Self::of(Kept::OnDisk(Disk::claim_part(part, files.reads())?)))
    }

    /// A folder that is on no disk: [`Folder::contents`] gives its files.
    pub fn in_memory() -> Self {
        Self::of(Kept::InMemory(Arc::default()))
    }

    fn of(kept: Kept) -> Self {
        Self { kept, written: Arc::default(), place: String::new() }
    }

    /// The files of a folder in memory, by their names; none of one on the disk.
    pub fn contents(&self) -> BTreeMap<String, Vec<u8>> {
        match &self.kept {
            Kept::InMemory(files) => files.lock().unwrap_or_else(PoisonError::into_inner).clone(),
            Kept::OnDisk(_) => BTreeMap::new(),
        }
    }

    /// A folder within this one, which is finished with it.
    pub(super) fn within(&self, place: &str) -> Self {
        Self { place: format!("{}{place}/", self.place), ..self.clone() }
    }

    /// Writes one file.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), ExperimentError> {
        let (name, content) = (format!("{}{name}", self.place), content.as_ref());
        match &self.kept {
            Kept::OnDisk(disk) => {
                let path = disk.draft.folder().join(&name);
                if let Some(parent) = path.parent() {
                    files::create_folder(parent)?;
                }
                files::write(&path, content)?;
            }
            Kept::InMemory(files) => {
                let mut files = files.lock().unwrap_or_else(PoisonError::into_inner);
                files.insert(name.clone(), content.to_vec());
            }
        }
        self.written().insert(name, content.len() as u64);
        Ok(())
    }

    /// Where the results will be; empty for a folder in memory.
    pub fn target(&self) -> &Path {
        match &self.kept {
            Kept::OnDisk(disk) => &disk.target,
            Kept::InMemory(_) => Path::new(""),
        }
    }

    /// Whether a file of this name was written.
    pub fn has(&self, name: &str) -> bool {
        self.written().contains_key(name)
    }

    /// Calls `make` to write one file at a path.
    ///
    /// # Errors
    /// What `make` gives, or that it made no file; a folder in memory has no paths.
    pub fn write_with(
        &self,
        name: &str,
        make: impl FnOnce(&Path) -> Result<(), ExperimentError>,
    ) -> Result<(), ExperimentError> {
        let Kept::OnDisk(disk) = &self.kept else {
            return Err(ExperimentError::new(format!("`{name}` can only be written to a disk")));
        };
        let path = disk.draft.folder().join(name);
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

    /// The same folder with a count of its own: [`Folder::include`] adds what it has written, or [`Folder::withdraw`] deletes it.
    pub(super) fn apart(&self) -> Self {
        Self { written: Arc::default(), ..self.clone() }
    }

    /// Counts the files of a part that was apart.
    pub(super) fn include(&self, part: &Self) {
        self.written().append(&mut part.written());
    }

    /// Deletes all files written.
    pub(super) fn withdraw(&self) {
        for name in std::mem::take(&mut *self.written()).keys() {
            self.delete(name);
        }
    }

    fn delete(&self, name: &str) {
        match &self.kept {
            // A file that cannot be deleted is complete.
            Kept::OnDisk(disk) => drop(fs::remove_file(disk.draft.folder().join(name))),
            Kept::InMemory(files) => {
                files.lock().unwrap_or_else(PoisonError::into_inner).remove(name);
            }
        }
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
            let files = themed(*draw).and_then(|figure| FigureFiles::of(&figure));
            self.figure(name, files.as_ref(), observer)
        })
    }

    /// Writes a figure as SVG and PNG; one that cannot be drawn becomes a warning.
    pub(super) fn figure(
        &self,
        name: &str,
        files: Result<&FigureFiles, &FigureError>,
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        match files {
            Ok(FigureFiles { png, svg }) => {
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
    /// so that nothing is lost. A folder in memory has no name to be given.
    ///
    /// # Errors
    ///
    /// Files that cannot be moved.
    pub fn finish(self, observer: &dyn Observer) -> Result<PathBuf, ExperimentError> {
        let names = self.names();
        match self.kept {
            Kept::OnDisk(disk) => disk.finish(&names, observer),
            Kept::InMemory(_) => Ok(PathBuf::new()),
        }
    }
}
