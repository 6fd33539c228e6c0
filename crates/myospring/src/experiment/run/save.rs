//! The files of a run.

use super::beaten::{FinishedRun, RunNumbers};
use super::finished::{Finished, Style};
use super::outputs::{self, Output, WrittenOutputs};
use super::page;
use super::record::{Stop, Timings, resolved};
use crate::clock::Stopwatch;
use crate::experiment::{ExperimentError, Folder, Inputs, Observer, Outcome, fibres};
use crate::integrate::engine::EngineUsed;
use crate::output::figure::{self, Figure, FigureError};
use crate::output::page::{Page, PageError};
use crate::output::{csv, json};
use crate::settings::{Fibres, Run};
use crate::simulation::{self, Effort, Simulation};
use crate::study::sha256;
use serde::Serialize;

/// run.json.
#[derive(Serialize)]
struct Record<'a> {
    program: &'static str,
    version: &'static str,
    input: Option<String>,
    shape_sha256: &'a str,
    run_file_sha256: &'a str,
    stop: Option<Stop<'a>>,
    #[serde(flatten)]
    effort: Effort,
    /// The engine of a run in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    engine: Option<EngineUsed>,
    machine_threads: usize,
    timings: Timings,
    /// Time and size of the outputs; empty until they are written.
    outputs: &'a WrittenOutputs,
}

/// What was written in addition to curves and numbers.
pub struct SavedRun {
    /// The result of each output.
    pub written: WrittenOutputs,
    /// Whether `run.json` lists the outputs.
    pub recorded: Result<(), ExperimentError>,
    /// Where the time went.
    pub timings: Timings,
}

/// Writes `traces.csv`, `summary.json` and, of a picture that shows them, `fibres.csv`.
pub(in crate::experiment) fn write_numbers(
    folder: &Folder,
    run: &Run,
    simulation: &Simulation,
    fibres: &Fibres,
    outcome: &simulation::Outcome,
    numbers: &RunNumbers<'_>,
) -> Result<(), ExperimentError> {
    folder.write("traces.csv", csv::traces(&outcome.recording)?)?;
    folder.write("summary.json", json::for_people(numbers)?)?;
    fibres::write(folder, [(run.shape.name(), &simulation.mesh, fibres)])
}

impl FinishedRun {
    /// Writes curves, numbers and the record, then these outputs. An output that fails does not
    /// affect the others.
    ///
    /// # Errors
    /// Curves or numbers that cannot be written.
    pub fn write(
        &self,
        folder: &Folder,
        outputs: &[&Output],
        style: Style,
        observer: &dyn Observer,
    ) -> Result<SavedRun, ExperimentError> {
        let start = Stopwatch::start();
        let Self { run, made, outcome, .. } = self;
        let (simulation, numbers) = (&made.simulation, self.all_numbers());
        write_numbers(folder, run, simulation, &made.fibres, outcome, &numbers)?;
        let mut inputs = Inputs::default();
        inputs.keep(folder, run.to_run_file(), |file| self.files.bytes(file))?;
        let run_file = self.run_file_with(&inputs);
        folder.write("run.toml", &run_file)?;
        let run_file_sha256 = sha256(run_file.as_bytes());
        let record = |timings, outputs: &WrittenOutputs| {
            json::pretty(&Record {
                program: "myospring",
                version: env!("CARGO_PKG_VERSION"),
                input: run.shape.file().map(|file| inputs.name(file, "")),
                shape_sha256: &self.shape_sha256,
                run_file_sha256: &run_file_sha256,
                stop: Stop::of(outcome),
                effort: outcome.effort,
                engine: outcome.engine.clone(),
                machine_threads: std::thread::available_parallelism().map_or(1, usize::from),
                timings,
                outputs,
            })
        };
        // From here on the result is complete, even if outputs fail.
        folder.write("run.json", record(self.timings, &WrittenOutputs::default())?)?;
        let stimuli = run.stimulus_times();
        let finished = self.finished(&numbers, &stimuli, style, &inputs, observer);
        if let Some(asked) = style.colour.filter(|asked| *asked != finished.colour()) {
            let (asked, colour) = (asked.word(), finished.colour().word());
            observer.warn(&format!("this run has no {asked}; it is coloured by {colour}"));
        }
        let written = outputs::write(folder, outputs, &finished);
        let mut timings = self.timings;
        timings.outputs_s = start.elapsed().as_secs_f64();
        timings.total_s += timings.outputs_s;
        // On a full disk the record without outputs stays.
        let recorded = folder.write("run.json", record(timings, &written)?);
        Ok(SavedRun { written, recorded, timings })
    }

    /// The page of the run in the form that `make` gives it: [`page::html`](crate::output::page::html) or
    /// [`page::data`](crate::output::page::data). Its files keep their names.
    ///
    /// # Errors
    /// A run without frames.
    pub fn page(
        &self,
        make: impl FnOnce(&Page<'_>) -> Result<String, PageError>,
    ) -> Result<String, ExperimentError> {
        let (numbers, stimuli, inputs) =
            (self.all_numbers(), self.run.stimulus_times(), Inputs::default());
        page::of(&self.finished(&numbers, &stimuli, Style::default(), &inputs, &()), make)
    }

    /// The run file that repeats the run. Its files keep their names.
    pub fn run_file(&self) -> String {
        self.run_file_with(&Inputs::default())
    }

    /// The figure `overview`: the cell at rest and contracting, beside its curves.
    ///
    /// # Errors
    /// A run without frames.
    pub fn overview(&self) -> Result<Figure, FigureError> {
        let (numbers, stimuli, inputs) =
            (self.all_numbers(), self.run.stimulus_times(), Inputs::default());
        let finished = self.finished(&numbers, &stimuli, Style::default(), &inputs, &());
        figure::overview(&finished.cell()?, &self.outcome.recording, &stimuli)
    }

    fn run_file_with(&self, inputs: &Inputs) -> String {
        let Self { run, made, outcome, .. } = self;
        let (spacing, step) = (made.report.spacing_um, outcome.effort.time_step());
        resolved(run, (inputs, ""), &made.simulation, spacing, step)
    }

    fn finished<'a>(
        &'a self,
        numbers: &'a RunNumbers<'a>,
        stimuli: &'a [f64],
        style: Style,
        inputs: &'a Inputs,
        observer: &'a dyn Observer,
    ) -> Finished<'a> {
        let Self { name, run, made, outcome, mesh_figure, .. } = self;
        Finished {
            name,
            run,
            simulation: &made.simulation,
            outline: &made.outline,
            fibres: &made.fibres,
            picture: made.picture.as_ref().or(made.above.as_ref()),
            outcome,
            numbers,
            stimuli,
            style,
            mesh_figure: mesh_figure
                .as_ref()
                .filter(|(theme, _)| *theme == style.theme)
                .map(|(_, files)| files),
            inputs,
            observer,
        }
    }

    /// As [`FinishedRun::write`], where an output that is missing is an error.
    ///
    /// # Errors
    /// Anything that cannot be written.
    pub fn write_all(
        &self,
        folder: &Folder,
        outputs: &[&Output],
        observer: &dyn Observer,
    ) -> Result<(), ExperimentError> {
        let SavedRun { written, recorded, .. } =
            self.write(folder, outputs, Style::default(), observer)?;
        recorded?;
        written.errors().first().map_or(Ok(()), |error| Err(ExperimentError::new(error)))
    }
}

impl Outcome for FinishedRun {
    fn numbers(&self) -> impl Serialize {
        self.all_numbers()
    }

    fn warnings(&self) -> Vec<String> {
        self.summary.warnings.clone()
    }

    /// Saves with the default outputs.
    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        self.write_all(folder, &outputs::chosen(None)?, observer)
    }
}
