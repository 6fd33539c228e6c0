//! Comparisons of runs: in which settings and numbers they differ.
//!
//! An input is a run file, a picture, an outline or a folder of results. Each is compared
//! unchanged, with factors on its numbers, and at doses of drugs.

mod job;
mod page;
mod side;
mod tables;

pub use job::{Compare, Source};
pub use side::{Side, check_folder as check_results};

use super::run::FILE;
use super::{Experiment, ExperimentError, Files, Folder, Inputs, Observer, Outcome};
use crate::analysis::bands::{Band, band};
use crate::analysis::beats::Beats;
use crate::clock::Stopwatch;
use crate::compare::PHENOMENOLOGICAL;
use crate::compare::factor::Scaled;
use crate::compare::metric::{self, Row};
use crate::compare::setting::{self, Different};
use crate::output::figure::{self, ComparedRun as Drawn, ContractionOptions, Theme};
use crate::output::page::{Difference, Page, PageError, html};
use crate::output::{csv, json};
use crate::run_file::RunFile;
use crate::study::Threads;
use job::Meter;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;

/// The file of a comparison that people open: the first of these that exists.
pub const PAGE_OR_FIGURE: [&str; 2] = ["report.html", "figures/compared.png"];

/// Runs that were compared.
pub struct Compared {
    /// The runs; differences are from the first.
    pub sides: Vec<Side>,
    /// Settings in which they differ.
    pub settings: Vec<Different>,
    /// The same, as people read them.
    pub differences: Vec<Difference>,
    /// Their numbers.
    pub metrics: Vec<Row>,
    warnings: Vec<String>,
    files: Files,
    total_s: f64,
}

/// `comparison.json`.
#[derive(Serialize)]
struct Record<'a> {
    program: &'static str,
    version: &'static str,
    runs: Vec<Told<'a>>,
    warnings: &'a [String],
    /// In which the runs differ.
    settings: &'a [Different],
    metrics: &'a [Row],
    total_s: f64,
}

/// A run in `comparison.json`.
#[derive(Serialize)]
struct Told<'a> {
    label: &'a str,
    /// Where it comes from.
    source: &'a str,
    scaled: &'a [Scaled],
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    stop: Option<&'a str>,
}

impl Experiment for Compare {
    type Outcome = Compared;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Compared, ExperimentError> {
        let start = Stopwatch::start();
        let jobs = self.jobs(files)?;
        // Before any of them has taken its time.
        jobs.iter().try_for_each(|job| job.check(files))?;
        let threads = Threads::new(self.threads)?;
        let meter = Meter::new(observer, jobs.len());
        let sides: Result<Vec<Side>, ExperimentError> =
            threads.install(|| jobs.into_par_iter().map(|job| job.side(files, &meter)).collect());
        observer.interruption().check().map_err(ExperimentError::new)?;
        let mut compared = Compared::of(sides?, self, files);
        compared.total_s = start.elapsed().as_secs_f64();
        Ok(compared)
    }
}

impl Compared {
    /// Compares runs that were simulated.
    #[must_use]
    pub fn of_runs(sides: Vec<Side>, files: &Files) -> Self {
        Self::of(sides, &Compare::default(), files)
    }

    fn of(mut sides: Vec<Side>, description: &Compare, files: &Files) -> Self {
        let mut named = Inputs::default();
        for side in &mut sides {
            job::name_inputs(&mut named, &side.file, description.results.as_deref(), files);
            if let Some(target) = &description.results
                && Path::new(&side.source).is_absolute()
                && let Some(source) = super::inputs::relative(Path::new(&side.source), target)
            {
                side.source = source;
            }
        }
        let labels: Vec<&str> = sides.iter().map(|side| side.label.as_str()).collect();
        let run_files: Vec<RunFile> =
            sides.iter().map(|side| named.renamed(side.file.clone(), "../")).collect();
        let run_files: Vec<&RunFile> = run_files.iter().collect();
        let settings = setting::different(&run_files);
        let mut warnings: Vec<String> = sides.iter().flat_map(|side| side.notes.clone()).collect();
        warnings.extend(setting::warnings(&settings, &labels));
        warnings.extend(side::other_pictures(&sides, &run_files));
        let parameters = settings.iter().any(|it| it.key.starts_with("cell.parameters."));
        let lumped = |file: &&RunFile| file.resolve().is_ok_and(|run| run.cell.lumps_currents());
        if (!description.doses.is_empty() || parameters) && run_files.iter().any(lumped) {
            warnings.push(PHENOMENOLOGICAL.to_owned());
        }
        let beats: Vec<Beats> = sides.iter().map(Side::beats).collect();
        let metrics = metric::rows(&beats.iter().collect::<Vec<_>>());
        let differences = tables::differences(&settings, &sides);
        let files = files.clone();
        Self { sides, settings, differences, metrics, warnings, files, total_s: 0.0 }
    }

    /// What the runs are called.
    #[must_use]
    pub fn labels(&self) -> Vec<&str> {
        self.sides.iter().map(|side| side.label.as_str()).collect()
    }

    /// How long the comparison took, s.
    #[must_use]
    pub fn total_s(&self) -> f64 {
        self.total_s
    }

    /// The page of the comparison in the form that `make` gives it, as [`FinishedRun::page`](super::run::FinishedRun::page)
    /// does; `None` if a cell cannot be meshed as in its run.
    ///
    /// # Errors
    /// Runs without frames.
    pub fn page(
        &self,
        make: impl FnOnce(&Page<'_>) -> Result<String, PageError>,
    ) -> Result<Option<String>, ExperimentError> {
        page::of(&self.sides, &self.differences, &self.warnings, &Inputs::default(), make)
    }

    fn figures(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let drawn: Vec<Drawn<'_>> = self.sides.iter().map(Side::drawn).collect();
        let curves: Vec<_> =
            self.sides.iter().map(|side| (side.label.as_str(), &side.recording)).collect();
        let reference = band("peak_shortening")
            .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
        let options =
            ContractionOptions { stimulus_times_ms: Vec::new(), reference_band: reference };
        folder.figures(
            Theme::default(),
            &[
                ("compared", &|| figure::compared(&drawn)),
                ("contraction", &|| figure::contraction(&curves, &options)),
            ],
            observer,
        )
    }
}

impl Outcome for Compared {
    fn numbers(&self) -> impl Serialize {
        Record {
            program: "myospring",
            version: env!("CARGO_PKG_VERSION"),
            runs: self
                .sides
                .iter()
                .map(|side| Told {
                    label: &side.label,
                    source: &side.source,
                    scaled: &side.scaled,
                    stop: side.stop.as_deref(),
                })
                .collect(),
            warnings: &self.warnings,
            settings: &self.settings,
            metrics: &self.metrics,
            total_s: self.total_s,
        }
    }

    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let mut inputs = Inputs::default();
        for (number, side) in (1..).zip(&self.sides) {
            inputs.keep(folder, side.file.clone(), |file| self.files.bytes(file))?;
            let run_file = inputs.renamed(side.file.clone(), "../");
            folder.write(&format!("runs/traces_{number}.csv"), csv::traces(&side.recording)?)?;
            folder.write(&format!("runs/run_{number}.toml"), run_file.to_toml())?;
        }
        folder.write("metrics.csv", tables::metrics(&self.labels(), &self.metrics)?)?;
        self.figures(folder, observer)?;
        match page::of(&self.sides, &self.differences, &self.warnings, &inputs, html)? {
            Some(page) => folder.write(FILE, page)?,
            None => {
                observer
                    .warn("report.html is left out: not every cell can be meshed as in its run");
            }
        }
        folder.write("comparison.json", json::for_people(&self.numbers())?)
    }
}
