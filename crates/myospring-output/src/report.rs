//! The numbers of one run, each with unit and definition.

use myospring_core::analysis::beat::{Band, Beat, Beats};
use myospring_core::analysis::rhythm::Rhythm;
use myospring_core::analysis::{Metric, Spread};
use myospring_core::cell::KnownDeparture;
use myospring_core::mesh::quality::MeshReport;
use myospring_core::recording::Recording;
use myospring_core::simulation::Pace;
use serde::Serialize;

/// The numbers of a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Summary {
    /// One entry for each stimulus within the run; without values where it was not captured.
    pub beats: Vec<Beat>,
    /// How the beats follow their stimuli: which were not captured, capture ratio, alternans.
    pub rhythm: Rhythm,
    /// Mean and standard deviation over the beats that count, where there are several.
    pub beat_to_beat: Vec<Spread>,
    /// Whether the run ended before the last beat of the train was over; means leave it out.
    pub cut_short: bool,
    /// Where the work of the active force went, at the end of the run.
    pub energy: Vec<Metric>,
    /// Bands, not targets, from measurements on unloaded adult ventricular myocytes.
    pub reference_bands: [Band; 5],
    /// What became of the picture or outline.
    pub mesh: MeshReport,
    /// What a person should look at.
    pub warnings: Vec<String>,
    /// What is known of the cell model and seen in this run, in a sentence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub about_model: Option<String>,
    #[serde(skip)]
    usual: usize,
}

impl Summary {
    /// The numbers of a recording whose stimuli fell at these times, ms; `s2_ms` is the last of them where that is an
    /// extra one, S2.
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

    /// With what is known of the cell model, where this run shows it.
    #[must_use]
    pub fn with_pace(self, pace: &Pace) -> Self {
        Self { about_model: about_model(pace), ..self }
    }

    /// The beat whose numbers stand for the run where there is no mean: the first that counts.
    pub fn usual(&self) -> Option<&Beat> {
        self.beats.get(self.usual)
    }

    /// How many beats of the train there are: stimuli that were captured, or may have been.
    pub fn captured(&self) -> usize {
        self.rhythm.stimuli - self.rhythm.not_captured.len()
    }

    /// The beat of an extra stimulus, where there is one.
    pub fn s2(&self) -> Option<&Beat> {
        self.beats.last().filter(|last| last.is_s2())
    }
}

/// What is known of a cell model and seen in a run, in a sentence.
pub fn about_model(pace: &Pace) -> Option<String> {
    match pace {
        Pace::AsItsModel(KnownDeparture { fact, instead, .. }) => {
            Some(format!("{fact}; `--model {instead}` does not."))
        }
        Pace::AsMeasured | Pace::Unexplained { .. } => None,
    }
}
