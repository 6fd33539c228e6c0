//! Simulates the cells of many pictures: one row per cell.

mod kept;
mod members;
mod page;

pub use members::Pictures;

use super::error::ExperimentError;
use super::files::Files;
use super::folder::Folder;
use super::input::ChosenSetting;
use super::inputs;
use super::observer::Observer;
use super::watched::Watched;
use super::{Experiment, Outcome};
use crate::clock::Stopwatch;
use crate::interruption::Interruption;
use crate::output::files::{self, Manifest};
use crate::output::page::PageError;
use crate::run_file::SHAPES;
use crate::settings::{Run, Value};
use crate::study::pictures::{self, CellRow, Picture};
use crate::study::{self, Cause, Journal, Row as _, Status, Threads};
use kept::Kept;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicU64;

/// The table for people and for programs.
const CSV: &str = "cells.csv";
#[cfg(feature = "parquet")]
const PARQUET: &str = "cells.parquet";

/// Simulates the cells of many pictures.
pub struct Batch {
    /// Which pictures.
    pub pictures: Pictures,
    /// Whether each file is a stack of slices with one thick cell, as a column `stack` of a table says of its files.
    pub stacks: bool,
    /// Settings that all share; those that a table gives override them.
    pub settings: Vec<ChosenSetting>,
    /// Whether curves and figures of each cell are kept, in a folder of its own.
    pub figures: bool,
    /// Pictures at a time; `None` takes as many as there are cores.
    pub jobs: Option<usize>,
    /// The folder in which finished work is stored, so that an interrupted batch continues; without
    /// one only the rows are returned.
    pub target: Option<PathBuf>,
    /// Whether to start again in this folder.
    pub force: bool,
}

/// A batch whose settings are checked and whose folder is open.
pub struct PreparedBatch<'a> {
    batch: &'a Batch,
    /// What a person should know of the pictures.
    pub notes: Vec<String>,
    /// The pictures, each with its settings.
    pub pictures: Vec<Picture>,
    journal: Journal<Picture>,
    manifest: Option<Manifest>,
    files: &'a Files,
    interruption: Interruption,
    started: Stopwatch,
}

/// The result of a batch.
pub struct Batched {
    /// The folder of the results, if there is one.
    pub results: Option<PathBuf>,
    /// How many pictures there are.
    pub pictures: usize,
    /// How many of them were done before.
    pub resumed: usize,
    /// A row for each cell, and for each picture that failed.
    pub rows: Vec<CellRow>,
    /// Whether it was stopped before its last picture.
    pub interrupted: bool,
    /// What a person should know of the pictures.
    pub notes: Vec<String>,
    /// Time that it took, s.
    pub seconds: f64,
}

/// What happened, for machines.
#[derive(Serialize)]
struct Numbers<'a> {
    results: Option<&'a Path>,
    pictures: usize,
    resumed: usize,
    cells: usize,
    left_out: usize,
    failed: usize,
    interrupted: bool,
    seconds: f64,
}

impl Batch {
    /// Finds the pictures, checks every setting of each, and opens the folder.
    ///
    /// # Errors
    /// Pictures or settings that are not there or not possible, and a folder with other results.
    pub fn prepare<'a>(
        &'a self,
        files: &'a Files,
        interruption: &Interruption,
    ) -> Result<PreparedBatch<'a>, ExperimentError> {
        let started = Stopwatch::start();
        if let Some((setting, _)) =
            self.settings.iter().find(|(setting, _)| SHAPES.contains(&setting.key))
        {
            let option = setting.option.map_or(setting.key, |option| option.name);
            let message =
                format!("{option} names one cell, and a batch takes its cells from its files");
            return Err(ExperimentError::new(message)
                .advise("leave it out; if the files are stacks of slices, give `myospring batch FOLDER --stacks`, or stacks=True in Python"));
        }
        let (mut pictures, notes) =
            self.pictures.find(self.target.as_deref(), self.stacks, files)?;
        for picture in &mut pictures {
            picture.is_stack |= self.stacks;
        }
        // Every setting is checked once, before any picture is opened.
        for picture in &pictures {
            self.settled(picture, files, interruption)?;
        }
        let common = pictures.first().map(|first| Picture {
            is_stack: first.is_stack,
            ..Picture::new(String::new(), first.path.clone())
        });
        let common = common.unwrap_or_else(|| Picture::new(String::new(), PathBuf::new()));
        let common = self.settled(&common, files, interruption)?;
        let (mut journal, mut manifest) = (Journal::in_memory(), None);
        if let Some(target) = &self.target {
            let settings = self.settings_text(&common, target);
            journal = if self.force {
                Journal::begin_anew(target, &settings, &files.reads())?
            } else {
                Journal::open_protecting(target, &settings, &files.reads())?
            };
            manifest = Some(journal.manifest().unwrap_or_else(|| Manifest::of(target)));
        }
        let interruption = interruption.clone();
        let batch = self;
        Ok(PreparedBatch {
            batch,
            notes,
            pictures,
            journal,
            manifest,
            files,
            interruption,
            started,
        })
    }

    /// The run of a picture: its own settings override those of all.
    fn settled(
        &self,
        picture: &Picture,
        files: &Files,
        interruption: &Interruption,
    ) -> Result<Run, ExperimentError> {
        members::settled(self.pictures.table(), &self.settings, picture, files, interruption)
    }

    /// Every setting that results depend on, as text.
    fn settings_text(&self, run: &Run, target: &Path) -> String {
        let mut file = run.to_run_file();
        for shape in SHAPES {
            file.remove(shape);
        }
        for path in file.paths_mut() {
            *path = inputs::relative(Path::new(&*path), target).unwrap_or_else(|| path.clone());
        }
        let text = file.to_toml();
        let cell = self.settings.iter().find(|(setting, _)| setting.key == "segmentation.cell");
        let cells = cell.and_then(|(_, value)| Value::as_text(value)).unwrap_or("all");
        let (version, figures) = (env!("CARGO_PKG_VERSION"), self.figures);
        format!(
            "# The settings of the results in this folder; myospring batch continues only with the same ones.\n\
             # version {version}, cells {cells}, figures {figures}\n\n{text}"
        )
    }
}

impl PreparedBatch<'_> {
    /// Processes every picture that is not done.
    ///
    /// # Errors
    ///
    /// Errors of the disk; an error of a picture is in its row.
    pub fn run(self, observer: &dyn Observer) -> Result<Batched, ExperimentError> {
        let Self { batch, notes, pictures, journal, manifest, files, interruption, started } = self;
        let write = |rows: &[CellRow]| {
            let Some(manifest) = &manifest else { return Ok(()) };
            write_table(rows, |name, content| Ok(manifest.write(name, content)?))
        };
        let watched = Watched {
            observer,
            interruption: interruption.clone(),
            words: |picture: &Picture, row: &CellRow| (picture.name.clone(), row.reason.clone()),
            table: Some(&write),
            done: AtomicU64::new(0),
        };
        let kept = Kept { figures: batch.figures, manifest: manifest.as_ref(), files, observer };
        let threads = Threads::new(batch.jobs)?;
        let report = study::run(&pictures, &journal, &threads, &watched, |picture| {
            let run = batch.settled(picture, files, &interruption)?;
            pictures::rows(picture, &run, members::which(&batch.settings, picture), &kept)
        })?;
        let mut batched = Batched {
            results: batch.target.clone(),
            pictures: pictures.len(),
            resumed: report.resumed,
            rows: report.rows,
            interrupted: report.stopped,
            notes,
            seconds: 0.0,
        };
        if let Some(manifest) = &manifest {
            if !batched.interrupted {
                manifest.write(page::FILE, batched.page()?)?;
            }
            manifest.settle()?;
        }
        batched.seconds = started.elapsed().as_secs_f64();
        Ok(batched)
    }
}

impl Experiment for Batch {
    type Outcome = Batched;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Batched, ExperimentError> {
        self.prepare(files, &observer.interruption())?.run(observer)
    }
}

impl Batched {
    /// The report, with the small pictures that are in the folder of the results.
    fn page(&self) -> Result<String, PageError> {
        let name = self.results.as_deref().and_then(Path::file_name);
        let title = name.map_or_else(|| "Cells".to_owned(), |name| name.to_string_lossy().into());
        let small = |row: &CellRow| {
            let file = kept::thumbnail(&row.picture, row.cell.as_deref()?);
            files::read(&self.results.as_deref()?.join(file)).ok()
        };
        page::html(&title, (&self.rows, self.pictures), &self.notes, small)
    }

    /// How many rows have this status.
    pub fn count(&self, status: Status) -> usize {
        self.rows.iter().filter(|row| row.status == status).count()
    }
}

impl Outcome for Batched {
    fn numbers(&self) -> impl Serialize {
        Numbers {
            results: self.results.as_deref(),
            pictures: self.pictures,
            resumed: self.resumed,
            cells: self.count(Status::Ok),
            left_out: self.count(Status::LeftOut),
            failed: self.count(Status::Failed),
            interrupted: self.interrupted,
            seconds: self.seconds,
        }
    }

    fn warnings(&self) -> Vec<String> {
        self.notes.clone()
    }

    fn save(&self, folder: &Folder, _: &dyn Observer) -> Result<(), ExperimentError> {
        folder.write(page::FILE, self.page()?)?;
        write_table(&self.rows, |name, content| Ok(folder.write(name, content)?))
            .map_err(ExperimentError::new)
    }
}

/// Writes the table for people and for programs.
fn write_table(
    rows: &[CellRow],
    write: impl Fn(&str, &[u8]) -> Result<(), Cause>,
) -> Result<(), Cause> {
    let table = CellRow::table(rows);
    #[cfg(feature = "parquet")]
    write(PARQUET, &table.to_parquet()?)?;
    write(CSV, &table.for_people().to_csv()?)
}
