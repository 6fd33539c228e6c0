//! Figures 3, 5 and 6 of Coelho et al. 2021, and every number that the paper states, compared with
//! ours.

mod statements;

pub use statements::{Finding, StatementVerdict};

use super::error::ExperimentError;
use super::files::Files;
use super::folder::Folder;
use super::observer::Observer;
use super::{Experiment, Outcome};
use crate::clock::Stopwatch;
use crate::mesh::Mesh;
use crate::mesh::outline::Outline;
use crate::mesh::quality::long_axis;
use crate::output::field::Fields;
use crate::output::figure::{self, ContractionOptions, DrawnCell, FigureError, Theme};
use crate::output::{csv, json};
use crate::settings::{Places, Run, Shaped};
use crate::simulation::{self, Effort};
use crate::study::Threads;
use rayon::prelude::*;
use serde::Serialize;
use statements::{PaperRun, TENSIONS, with_paper};
use std::sync::atomic::{AtomicU64, Ordering};

/// Simulates the paper's cell at each of its tensions.
pub struct Paper {
    /// The settings without the tension.
    pub run: Run,
    /// Runs at a time; `None` takes as many as there are cores.
    pub threads: Option<usize>,
}

/// The runs of the paper, and what it says of them.
pub struct Reproduced {
    run: Run,
    mesh: Mesh,
    outline: Outline,
    /// In the order of the tensions.
    outcomes: Vec<simulation::Outcome>,
    /// What the paper states, and our result.
    pub findings: Vec<Finding>,
    started: Stopwatch,
}

/// paper.json.
#[derive(Serialize)]
struct Record<'a> {
    version: &'static str,
    findings: &'a [Finding],
    /// What each run took, in the order of the tensions.
    integration: Vec<Effort>,
    stopped_early: Vec<String>,
    total_s: f64,
}

impl Experiment for Paper {
    type Outcome = Reproduced;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Reproduced, ExperimentError> {
        let started = Stopwatch::start();
        let run = self.run.clone();
        let bytes = run.shape.bytes(|file| files.bytes(file))?;
        let shaped = run.shape.mesh(&bytes)?;
        let fibres = run.fibres(&shaped)?;
        let Shaped { mesh, thick, outline, .. } = shaped;
        let threads = Threads::new(self.threads)?;
        observer.stage("ms", TENSIONS.len() as u64 * run.duration as u64);
        let (interruption, done) = (observer.interruption(), AtomicU64::new(0));
        let one = |peak_tension: f64| -> Result<simulation::Outcome, ExperimentError> {
            let places = Places {
                fibres: fibres.directions.clone(),
                fibres_in_space: None,
                myofibril_content: None,
                resting_stretch: None,
                adhesion: None,
                tissue: None,
            };
            let mut simulation = run.simulation(mesh.clone(), thick.clone(), places);
            simulation.peak_tension = peak_tension;
            let mut before = 0.0;
            Ok(simulation.build()?.run(|progress| {
                let step = (progress.time - before).round();
                observer.reached(done.fetch_add(step as u64, Ordering::Relaxed) + step as u64);
                before += step;
                !interruption.is_requested()
            }))
        };
        // In the order of the tensions, whichever run ends first.
        let outcomes: Result<Vec<_>, ExperimentError> =
            threads.install(|| TENSIONS.par_iter().map(|tension| one(*tension)).collect());
        let outcomes = outcomes?;
        let equations = run.cell.states().len();
        let findings =
            with_paper(&paired(&outcomes), run.protocol.start_ms, equations, &mesh.areas);
        Ok(Reproduced { run, mesh, outline, outcomes, findings, started })
    }
}

fn paired(outcomes: &[simulation::Outcome]) -> Vec<PaperRun<'_>> {
    let runs = TENSIONS.iter().zip(outcomes);
    runs.map(|(&peak_tension, outcome)| PaperRun { peak_tension, recording: &outcome.recording })
        .collect()
}

impl Reproduced {
    /// Why runs ended early, those that did.
    pub fn stopped_early(&self) -> Vec<String> {
        let stops = self.outcomes.iter().filter_map(|outcome| outcome.stop.as_ref());
        stops.map(ToString::to_string).collect()
    }

    /// Time since it began, s.
    pub fn total_s(&self) -> f64 {
        self.started.elapsed().as_secs_f64()
    }
}

impl Outcome for Reproduced {
    fn numbers(&self) -> impl Serialize {
        Record {
            version: env!("CARGO_PKG_VERSION"),
            findings: &self.findings,
            integration: self.outcomes.iter().map(|outcome| outcome.effort).collect(),
            stopped_early: self.stopped_early(),
            total_s: self.total_s(),
        }
    }

    fn warnings(&self) -> Vec<String> {
        let stops = self.stopped_early().into_iter();
        stops.map(|stop| format!("a run stopped early: {stop}")).collect()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        let runs = paired(&self.outcomes);
        let label = |run: &PaperRun<'_>| format!("{} kPa", run.peak_tension);
        let labels: Vec<String> = runs.iter().map(label).collect();
        for (run, label) in runs.iter().zip(&labels) {
            let name = format!("traces_{}.csv", label.replace(' ', "_"));
            folder.write(&name, csv::traces(run.recording)?)?;
        }
        let curves: Vec<_> =
            labels.iter().zip(&runs).map(|(label, run)| (label.as_str(), run.recording)).collect();
        let (options, theme) = (ContractionOptions::default(), Theme::default());
        let contraction = || figure::contraction(&curves, &options);
        folder.figures(theme, &[("fig6_contraction", &contraction)], observer)?;
        if let Some(PaperRun { recording, .. }) = runs.last() {
            let stimuli = self.run.stimulus_times();
            let fibres = vec![long_axis(&self.mesh); self.mesh.simplices.len()];
            let fields = Fields::new(&self.mesh, &fibres, None).map_err(FigureError::from)?;
            let cell = DrawnCell::new(fields, Some(&self.outline))?;
            let shapes = figure::key_shapes(recording, &stimuli);
            let potential = || figure::action_potential_and_tension(recording, &stimuli);
            folder.figures(
                theme,
                &[
                    ("fig5_cell", &|| figure::cell_shapes(&cell, &shapes)),
                    ("fig3_action_potential_and_tension", &potential),
                ],
                observer,
            )?;
        }
        folder.write("paper.json", json::pretty(&self.numbers())?)
    }
}
