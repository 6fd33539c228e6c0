//! A finished run.

use super::record::Timings;
use crate::analysis::summary::Summary;
use crate::experiment::Files;
use crate::experiment::folder::FigureFiles;
use crate::output::figure::{FigureError, Theme};
use crate::settings::{FibreReport, MeshedRun, Run};
use crate::simulation::{Effort, Outcome};
use serde::Serialize;

/// A finished run, complete or stopped early.
pub struct FinishedRun {
    /// Name of the results, for people.
    pub name: String,
    /// The settings, with the fibres that were used.
    pub run: Run,
    /// Hash of the file that holds the shape.
    pub shape_sha256: String,
    /// The cell on its mesh at rest, with outline, fibres and picture.
    pub made: MeshedRun,
    /// Curves and frames, and why it ended early, if it did.
    pub outcome: Outcome,
    /// The numbers of the run, with all warnings.
    pub summary: Summary,
    /// Where the time went, up to the end of the beat.
    pub timings: Timings,
    pub(super) files: Files,
    /// The figure of the mesh in a theme, if it is drawn already.
    pub(super) mesh_figure: Option<(Theme, Result<FigureFiles, FigureError>)>,
}

/// The numbers of a run, as `summary.json` has them.
#[derive(Serialize)]
pub struct RunNumbers<'a> {
    /// Metrics, beat by beat.
    #[serde(flatten)]
    pub summary: &'a Summary,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fibres: Option<FibreReport>,
    /// The work that the run took.
    pub integration: Effort,
}

impl FinishedRun {
    /// A run from its outcome; `warnings` are all of its warnings, `files` reads the files that it
    /// names.
    pub fn of(
        name: String,
        run: Run,
        shape_sha256: String,
        made: MeshedRun,
        outcome: Outcome,
        warnings: Vec<String>,
        files: Files,
    ) -> Self {
        let (stimuli, s2_ms) = (run.stimulus_times(), run.s2_ms());
        let summary =
            Summary::new(&outcome.recording, &stimuli, s2_ms, made.report.clone(), warnings)
                .with_about_model(made.simulation.pace(&outcome.beats()).about_model());
        let timings = Timings::default();
        let mesh_figure = None;
        Self { name, run, shape_sha256, made, outcome, summary, timings, files, mesh_figure }
    }

    /// The numbers, as `summary.json` has them.
    pub fn all_numbers(&self) -> RunNumbers<'_> {
        let fibres = self.made.fibres_of_picture();
        RunNumbers { summary: &self.summary, fibres, integration: self.outcome.effort }
    }
}
