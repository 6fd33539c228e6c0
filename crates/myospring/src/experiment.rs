//! Experiments: each takes files and options to numbers, figures and a folder of results.
//!
//! An experiment is a module with a description that implements [`Experiment`]. Its result is an
//! [`Outcome`], which has numbers and warnings and writes itself into a [`Folder`]. The program and
//! Python parse options, show progress through an [`Observer`], and print. Nothing here prints, and
//! there is no global state: [`Files`] remembers what was read.

pub mod analyse;
pub mod batch;
mod beats;
pub mod citations;
pub mod compare;
mod error;
mod fibres;
mod files;
mod film_beat;
pub mod fit;
mod folder;
pub mod input;
pub mod inputs;
pub mod legible;
pub mod mesh;
mod observer;
pub mod optical;
mod overlay;
pub mod paper;
pub mod posts;
pub mod refused;
pub mod run;
pub mod segment;
pub mod study;
pub mod tables;
pub mod tension_map;
pub mod track;
pub mod traction;
mod watched;
mod waves;

pub use beats::BeatOptions;
pub use error::{ExperimentError, Passage};
pub use files::Files;
pub use folder::{Draw, Folder};
pub use inputs::Inputs;
pub use observer::Observer;

use serde::Serialize;
use std::path::{Path, PathBuf};

/// The description of an experiment: its files and options.
pub trait Experiment {
    /// The result.
    type Outcome: Outcome;

    /// Runs the experiment. Nothing is written.
    ///
    /// # Errors
    ///
    /// Files that cannot be read or do not hold what the experiment needs, and options that do not
    /// fit them.
    fn run(&self, files: &Files, observer: &dyn Observer)
    -> Result<Self::Outcome, ExperimentError>;
}

/// The result of an experiment.
pub trait Outcome {
    /// All numbers, in the form of `summary.json`.
    fn numbers(&self) -> impl Serialize;

    /// What a reader of the numbers must know, the most important first.
    fn warnings(&self) -> Vec<String>;

    /// Writes tables, numbers, figures and page.
    ///
    /// # Errors
    /// A file that cannot be written.
    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError>;
}

/// Writes an outcome into a folder and returns where the results are; with `force` they replace
/// earlier results.
///
/// # Errors
/// Those of [`Folder::claim`], [`Outcome::save`] and [`Folder::finish`]; the folder is then as it was before.
pub fn save(
    outcome: &impl Outcome,
    target: &Path,
    force: bool,
    files: &Files,
    observer: &dyn Observer,
) -> Result<PathBuf, ExperimentError> {
    let folder = Folder::claim(target, force, files)?;
    outcome.save(&folder, observer)?;
    folder.finish(observer)
}
