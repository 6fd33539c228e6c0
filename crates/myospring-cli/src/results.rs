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

/// A folder under way: files go to a hidden folder until all are there.
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
        // Beside a folder that is yet to be made; in one that is there, which may be a disk of its own.
        let work = if target.is_dir() { target.join(part) } else { target.with_file_name(part) };
        fs::create_dir_all(&work).map_err(|error| unusable(&error))?;
        Ok(Self { target: target.to_owned(), work, done: false })
    }

    /// Writes one file.
    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) -> Result<(), Failure> {
        debug_assert!(is_ours(name), "{name} is not in the list of what runs write");
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

    /// Gives the folder its name. Earlier results there go, all of them; what no run writes stays.
    pub(crate) fn finish(mut self) -> Result<PathBuf, Failure> {
        let failed = |error: &std::io::Error| {
            Failure::new(format!("cannot write results to `{}`: {error}", self.target.display()))
        };
        let outcome = if self.target.exists() {
            remove_ours(&self.target, "")
                .and_then(|()| merge(&self.work, &self.target))
                .and_then(|()| fs::remove_dir_all(&self.work))
        } else {
            fs::rename(&self.work, &self.target)
        };
        outcome.map_err(|error| failed(&error))?;
        self.done = true;
        Ok(self.target.clone())
    }
}

/// Removes the files that runs write from a folder; `within` is its place in the results.
fn remove_ours(folder: &Path, within: &str) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{within}{}", entry.file_name().to_string_lossy());
        if name == "figures" && entry.file_type()?.is_dir() {
            remove_ours(&entry.path(), "figures/")?;
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
    const FILES: [&str; 12] = [
        "traces.csv",
        "summary.json",
        "run.toml",
        "run.json",
        "paper.json",
        "mesh.json",
        "outline.geojson",
        "mask.png",
        "cell.roi",
        "cells.zip",
        "overlay.png",
        "report.json",
    ];
    const FIGURES: [&str; 9] = [
        "overlay",
        "overview",
        "cell",
        "mesh",
        "action_potential_and_tension",
        "contraction",
        "fig3_action_potential_and_tension",
        "fig5_cell",
        "fig6_contraction",
    ];
    let figure = name
        .strip_prefix("figures/")
        .and_then(|name| name.strip_suffix(".svg").or_else(|| name.strip_suffix(".png")));
    FILES.contains(&name)
        || name.starts_with("traces_") && name.ends_with("_kPa.csv")
        || figure.is_some_and(|name| FIGURES.contains(&name))
}

impl Drop for Folder {
    fn drop(&mut self) {
        if !self.done {
            // Nothing half-written stays; a failure here leaves a folder named `.part`.
            fs::remove_dir_all(&self.work).ok();
        }
    }
}
