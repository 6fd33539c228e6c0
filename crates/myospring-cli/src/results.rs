//! The folder of results: whole or not at all.

use crate::failure::Failure;
use crate::fibres;
use crate::outputs;
use myospring::output::figure::{Figure, FigureError, Theme};
use myospring::output::files::{self, Draft, FileError};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Resolution of the PNG figures, dots per inch.
const DPI: f64 = 300.0;

/// What draws a figure.
pub(crate) type Draw<'a> = &'a (dyn Fn() -> Result<Figure, FigureError> + Sync);

/// A folder under way: files go to a hidden folder until all are there.
pub(crate) struct Folder {
    target: PathBuf,
    draft: Draft,
    force: bool,
    /// Names of the files that were written, and their sizes.
    written: Mutex<BTreeMap<String, u64>>,
}

impl Folder {
    /// Makes room for results in `target`; refuses a folder that holds anything unless `force`, and one that
    /// another run is writing to.
    pub(crate) fn claim(target: &Path, force: bool) -> Result<Self, Failure> {
        let draft = Draft::begin(target).map_err(|error| match error {
            FileError::NoName { .. } => {
                Failure::new(format!("`{}` names no folder", target.display()))
                    .advise("give a folder like --output results/mine")
            }
            FileError::InUse { .. } => {
                Failure::new(error).advise("--output DIR names another folder")
            }
            FileError::Folder { source, .. } => unusable(target, &source),
            error => error.into(),
        })?;
        let written = Mutex::default();
        let folder = Self { target: target.to_owned(), draft, force, written };
        if !force && folder.is_occupied().map_err(|error| unusable(target, &error))? {
            let message = format!("`{}` already holds files", target.display());
            return Err(Failure::new(message).advise(
                "choose another folder with --output DIR, or replace results with --force",
            ));
        }
        Ok(folder)
    }

    /// Whether the folder holds anything beside what is under way.
    fn is_occupied(&self) -> std::io::Result<bool> {
        let entries = match fs::read_dir(&self.target) {
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(false),
            entries => entries?,
        };
        for entry in entries {
            if !self.draft.is(&entry?.path()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// Writes one file.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        debug_assert!(is_ours(name), "{name} is not in the list of what runs write");
        let path = self.draft.folder().join(name);
        if let Some(parent) = path.parent() {
            files::create_folder(parent)?;
        }
        let content = content.as_ref();
        files::write(&path, content)?;
        self.written().insert(name.to_owned(), content.len() as u64);
        Ok(())
    }

    /// Where the results will be.
    pub(crate) fn target(&self) -> &Path {
        &self.target
    }

    /// Whether a file of this name was written.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.written().contains_key(name)
    }

    /// Lets `make` make one file at a path.
    pub(crate) fn made(
        &self,
        name: &str,
        make: impl FnOnce(&Path) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        debug_assert!(is_ours(name), "{name} is not in the list of what runs write");
        let path = self.draft.folder().join(name);
        let size = make(&path).and_then(|()| match fs::metadata(&path) {
            Ok(file) => Ok(file.len()),
            Err(error) => Err(Failure::new(format!("`{name}` was not made: {error}"))),
        });
        if size.is_err() {
            fs::remove_file(&path).ok();
        }
        self.written().insert(name.to_owned(), size?);
        Ok(())
    }

    /// Bytes of all files that were written.
    pub(crate) fn bytes(&self) -> u64 {
        self.written().values().sum()
    }

    /// Takes back files that were written; `*` stands for anything.
    pub(crate) fn withdraw(&self, names: &[&str]) {
        self.written().retain(|name, _| {
            let stays = !any(names.iter().copied(), name);
            if !stays {
                // One that cannot be removed is whole.
                fs::remove_file(self.draft.folder().join(name)).ok();
            }
            stays
        });
    }

    fn written(&self) -> MutexGuard<'_, BTreeMap<String, u64>> {
        // Sizes are whole whenever the lock is free, also after a panic elsewhere.
        self.written.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Draws figures, on all cores, and writes each as SVG and PNG.
    pub(crate) fn figures(
        &self,
        theme: Theme,
        figures: &[(&str, Draw<'_>)],
    ) -> Result<(), Failure> {
        let themed = |draw: Draw<'_>| draw().map(|figure| figure.themed(theme));
        figures.par_iter().try_for_each(|(name, draw)| self.figure(name, themed(*draw)))
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

    /// Gives the folder its name. Earlier results there go, all of them; what no run writes stays. Where somebody
    /// else has put files there since it was claimed, the results get a name beside it.
    pub(crate) fn finish(self) -> Result<PathBuf, Failure> {
        let target = &self.target;
        let failed = |error: std::io::Error| {
            Failure::new(format!("cannot write results to `{}`: {error}", target.display()))
        };
        let work = self.draft.folder();
        if !target.exists() {
            fs::rename(&work, target).map_err(failed)?;
            return Ok(target.clone());
        }
        if !self.force && self.is_occupied().map_err(failed)? {
            let name = target.file_name().unwrap_or_default().to_string_lossy();
            let beside = |number: u32| target.with_file_name(format!("{name}_{number}"));
            let free = (2..10_000).map(beside).find(|path| !path.exists()).unwrap_or(beside(2));
            fs::rename(&work, &free).map_err(failed)?;
            crate::print::warn(&format!(
                "`{}` has got files in the meantime, which stay; the results are in `{}`",
                target.display(),
                free.display()
            ));
            return Ok(free);
        }
        remove_ours(target, "").and_then(|()| merge(&work, target)).map_err(failed)?;
        Ok(target.clone())
    }
}

fn unusable(target: &Path, error: &std::io::Error) -> Failure {
    Failure::new(format!("cannot write results to `{}`: {error}", target.display()))
        .advise("choose a folder that you may write to, like --output results/mine")
}

/// Removes the files that runs write from a folder; `within` is its place in the results.
fn remove_ours(folder: &Path, within: &str) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{within}{}", entry.file_name().to_string_lossy());
        let inner = format!("{name}/");
        if entry.file_type()?.is_dir() {
            if ours().any(|pattern| pattern.starts_with(&inner)) {
                remove_ours(&entry.path(), &inner)?;
                // Where something else stands in it, it stays.
                fs::remove_dir(entry.path()).ok();
            }
        } else if is_ours(&name) {
            fs::remove_file(entry.path())?;
        }
    }
    Ok(())
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

/// Whether a command that makes a folder of results writes a file of this name.
fn is_ours(name: &str) -> bool {
    any(ours(), name)
}

/// Names of the files that commands write to a folder of results; `*` stands for anything.
fn ours() -> impl Iterator<Item = &'static str> {
    const FILES: [&str; 48] = [
        "inputs/*",
        "traces.csv",
        fibres::FILE,
        "summary.json",
        "run.toml",
        "run.json",
        "paper.json",
        "traces_*_kPa.csv",
        "figures/fig3_action_potential_and_tension.*",
        "figures/fig5_cell.*",
        "figures/fig6_contraction.*",
        "mesh.json",
        "outline.geojson",
        "mask.png",
        "cell.roi",
        "cells.zip",
        "overlay.png",
        "report.json",
        "comparison.json",
        "metrics.csv",
        "summary.csv",
        "fit.json",
        "track/track.csv",
        "track/rest.tif",
        "track/outline.geojson",
        "fits.csv",
        "curve.csv",
        "report.html",
        "figures/fit.*",
        "tension_map.csv",
        "tension_map.vtu",
        "figures/tension_map.*",
        "figures/shapes.*",
        "cells/*/fit.json",
        "cells/*/curve.csv",
        "cells/*/run.toml",
        "cells/*/report.html",
        "figures/fit_*.*",
        "figures/trace_*.*",
        "runs/run_*.toml",
        "runs/traces_*.csv",
        "figures/compared.*",
        "figures/contraction.*",
        "track.csv",
        "track.json",
        "track.gif",
        "rest.tif",
        "figures/track.*",
    ];
    FILES.into_iter().chain(outputs::files())
}

/// Whether a name is one of those; `*` stands for anything.
fn any<'a>(patterns: impl IntoIterator<Item = &'a str>, name: &str) -> bool {
    let matches = |pattern: &str| glob::Pattern::new(pattern).is_ok_and(|it| it.matches(name));
    patterns.into_iter().any(matches)
}
