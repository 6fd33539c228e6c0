//! The numbers of one run, each with unit and definition.

use super::bands::Band;
use super::beat::Beat;
use super::beats::Beats;
use super::rhythm::Rhythm;
use super::{Metric, Spread};
use crate::mesh::quality::MeshReport;
use crate::recording::Recording;
use serde::Serialize;

/// The numbers of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// One entry for each stimulus within the run, without values if it was not captured.
    pub beats: Vec<Beat>,
    /// How the beats follow their stimuli: which were not captured, capture ratio, alternans.
    pub rhythm: Rhythm,
    /// Mean and standard deviation over the beats that count, if there are several.
    pub beat_to_beat: Vec<Spread>,
    /// Whether the run ended before the last beat of the train was over; means exclude that beat.
    pub cut_short: bool,
    /// The energy balance at the end of the run: where the work of the active force went.
    pub energy: Vec<Metric>,
    /// Reference bands (not targets) from measurements on unloaded adult ventricular myocytes.
    pub reference_bands: [Band; 5],
    /// Report on the mesh made from the picture or outline.
    pub mesh: MeshReport,
    /// Warnings.
    pub warnings: Vec<String>,
    /// A known property of the cell model that this run shows, in a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about_model: Option<String>,
    #[serde(skip)]
    usual: usize,
}

impl Summary {
    /// The numbers of a recording with these stimulus times, ms; `s2_ms` is the time of the extra
    /// stimulus S2, if the last one is such.
    pub fn new(
        recording: &Recording,
        stimulus_times_ms: &[f64],
        s2_ms: Option<f64>,
        mesh: MeshReport,
        warnings: Vec<String>,
    ) -> Self {
        let beats = Beats::of(recording, stimulus_times_ms, s2_ms);
        let usual = beats.usual().map(|usual| usual.stimulus_ms);
        let is_usual = |beat: &Beat| Some(beat.stimulus_ms) == usual;
        Self {
            usual: beats.iter().position(is_usual).unwrap_or_default(),
            beat_to_beat: beats.spread(),
            rhythm: beats.rhythm.clone(),
            cut_short: beats.cut_short,
            energy: beats.energy,
            reference_bands: beats.bands,
            beats: beats.list,
            mesh,
            warnings,
            about_model: None,
        }
    }

    /// Adds a known property of the cell model that this run shows, in a sentence.
    #[must_use]
    pub fn with_about_model(self, about_model: Option<String>) -> Self {
        Self { about_model, ..self }
    }

    /// The beat that represents the run if there is no mean: the first that counts.
    pub fn usual(&self) -> Option<&Beat> {
        self.beats.get(self.usual)
    }

    /// Number of beats: stimuli that were captured, or may have been; all action potentials of a cell that beats by itself.
    pub fn captured(&self) -> usize {
        let of_stimuli = self.rhythm.stimuli - self.rhythm.not_captured.len();
        self.rhythm.spontaneous.as_ref().map_or(of_stimuli, |own| own.action_potentials)
    }

    /// The beat of the extra stimulus, if there is one.
    pub fn s2(&self) -> Option<&Beat> {
        self.beats.last().filter(|last| last.is_s2())
    }
}
