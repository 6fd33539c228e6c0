//! The folder of results: whole or not at all.

use crate::failure::Failure;
use myospring::output::figure::{Figure, FigureError};
use myospring::output::files;
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Resolution of the PNG figures, dots per inch.
const DPI: f64 = 300.0;

/// What draws a figure.
pub(crate) type Draw<'a> = &'a (dyn Fn() -> Result<Figure, FigureError> + Sync);

/// A folder under way: files go to a sibling that takes the folder's name in the end.
pub(crate) struct Folder {
    target: PathBuf,
    work: PathBuf,
    done: bool,
}

impl Folder {
    /// Makes room for results in `target`; refuses a folder that holds anything unless `force`.
    pub(crate) fn claim(target: &Path, force: bool) -> Result<Self, Failure> {
        let unusable = |error: &std::io::Error| {
            Failure::new(format!("cannot write results to `{}`: {error}", target.display()))
                .advise("choose a folder that you may write to, like --output results/mine")
        };
        let occupied = match fs::read_dir(target) {
            Ok(mut entries) => entries.next().is_some(),
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => false,
            Err(error) => return Err(unusable(&error)),
        };
        if occupied && !force {
            let message = format!("`{}` already holds files", target.display());
            return Err(Failure::new(message).advise(
                "choose another folder with --output DIR, or replace results with --force",
            ));
        }
        let Some(name) = target.file_name() else {
            let message = format!("`{}` names no folder", target.display());
            return Err(Failure::new(message).advise("give a folder like --output results/mine"));
        };
        let part = format!(".{}.{}.part", name.to_string_lossy(), std::process::id());
        let work = target.with_file_name(part);
        fs::create_dir_all(&work).map_err(|error| unusable(&error))?;
        Ok(Self { target: target.to_owned(), work, done: false })
    }

    /// Writes one file.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        let path = self.work.join(name);
        if let Some(parent) = path.parent() {
            files::create_folder(parent)?;
        }
        Ok(files::write(&path, content)?)
    }

    /// Draws figures, on all cores, and writes each as SVG and PNG.
    pub(crate) fn figures(&self, figures: &[(&str, Draw<'_>)]) -> Result<(), Failure> {
        figures.par_iter().try_for_each(|(name, draw)| self.figure(name, draw()))
    }

    /// Writes a figure as SVG and PNG; one that cannot be drawn becomes a warning.
    fn figure(&self, name: &str, figure: Result<Figure, FigureError>) -> Result<(), Failure> {
        match figure.and_then(|figure| Ok((figure.to_png(DPI)?, figure.to_svg()))) {
            Ok((png, svg)) => {
                self.write(&format!("figures/{name}.svg"), svg)?;
                self.write(&format!("figures/{name}.png"), png)
            }
            Err(error) => {
                crate::print::warn(&format!("figure {name} is left out: {error}"));
                Ok(())
            }
        }
    }

    /// Gives the folder its name; files of earlier results are replaced one by one.
    pub(crate) fn finish(mut self) -> Result<PathBuf, Failure> {
        let failed = |error: &std::io::Error| {
            Failure::new(format!("cannot write results to `{}`: {error}", self.target.display()))
        };
        let outcome = if self.target.exists() {
            merge(&self.work, &self.target).and_then(|()| fs::remove_dir_all(&self.work))
        } else {
            fs::rename(&self.work, &self.target)
        };
        outcome.map_err(|error| failed(&error))?;
        self.done = true;
        Ok(self.target.clone())
    }
}

/// Moves every file of one folder into another, over those of the same name.
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

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.done {
            // Nothing half-written stays; a failure here leaves a folder named `.part`.
            fs::remove_dir_all(&self.work).ok();
        }
    }
}
