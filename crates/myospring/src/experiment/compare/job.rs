//! What is compared: every input unchanged, then with each set of factors, then at each dose.

use super::side::{RUN_FILE, Side, check_folder, of_folder};
use crate::compare::dose::{self, Dose};
use crate::compare::factor::{self, Factor, Scaled};
use crate::experiment::input::{self, ChosenSetting, Input};
use crate::experiment::inputs::{Inputs, LARGEST_COPY};
use crate::experiment::{ExperimentError, Files, Observer};
use crate::interruption::Interruption;
use crate::run_file::RunFile;
use crate::settings::Run;
use crate::study::sha256;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Steps of progress per run: progress is in per mille of all runs.
const WHOLE: f64 = 1000.0;

/// Compares runs.
#[derive(Default)]
pub struct Compare {
    /// Inputs; if empty, the built-in cell.
    pub inputs: Vec<Source>,
    /// Names of the inputs, in their order; their own where there are fewer.
    pub labels: Vec<String>,
    /// Settings that override those of the inputs.
    pub settings: Vec<ChosenSetting>,
    /// Sets of factors on numbers of each run.
    pub scale: Vec<Dose>,
    /// Doses of drugs, which are factors, too.
    pub doses: Vec<Dose>,
    /// Runs at a time; one for each core unless given.
    pub threads: Option<usize>,
    /// Where the results go, if known; files are named relative to it.
    pub results: Option<PathBuf>,
}

/// What is compared.
pub enum Source {
    /// A run file, a picture, an outline or a folder of results.
    Path(PathBuf),
    /// A run that was simulated before.
    Run(Box<Side>),
}

/// A run that is still to be simulated.
pub(super) struct Job {
    label: String,
    what: What,
    factors: Vec<Factor>,
}

/// Where a run comes from.
#[derive(Clone)]
enum What {
    /// A run file, a picture or an outline, the built-in cell without one; and what overrides its settings.
    Path(Option<PathBuf>, Vec<ChosenSetting>),
    /// A folder of results.
    Results(PathBuf),
    /// A run that was simulated before.
    There(Box<Side>),
    /// The settings of such a run, to be simulated again.
    Settings(Box<RunFile>),
}

/// Reports how much of all runs is done.
pub(super) struct Meter<'a> {
    pub(super) observer: &'a dyn Observer,
    runs: usize,
    done: Mutex<f64>,
}

impl<'a> Meter<'a> {
    pub(super) fn new(observer: &'a dyn Observer, runs: usize) -> Self {
        observer.stage("per mille of the runs", WHOLE as u64);
        Self { observer, runs, done: Mutex::new(0.0) }
    }

    /// One that counts nothing, with the same observer.
    fn still(other: &Self) -> Self {
        Self { observer: other.observer, runs: usize::MAX, done: Mutex::new(0.0) }
    }

    /// Adds a part of a run, 0 to 1.
    fn add(&self, part: f64) {
        if let Ok(mut done) = self.done.lock() {
            let before = (WHOLE * *done) as u64;
            *done += part / self.runs as f64;
            let now = (WHOLE * *done).round() as u64;
            if now > before {
                self.observer.reached(now);
            }
        }
    }
}

impl Compare {
    /// Reads doses of drugs from a file.
    ///
    /// # Errors
    /// A file that cannot be read, or that does not describe doses.
    pub fn read_doses(path: &Path, files: &Files) -> Result<Vec<Dose>, ExperimentError> {
        dose::read(&files.text(path)?)
            .map_err(|error| ExperimentError::new(format!("{}: {error}", path.display())))
    }

    /// Reads a set of factors: `peak_tension=0.7,tau_si=1.2`.
    ///
    /// # Errors
    /// A text that is not of this form.
    pub fn read_scale(text: &str) -> Result<Dose, ExperimentError> {
        let factors = factor::parse(text)?;
        let label = |Factor { name, factor }: &Factor| format!("{name} \u{d7} {factor}");
        let label = factors.iter().map(label).collect::<Vec<_>>().join(", ");
        Ok(Dose { label, factors })
    }

    /// Refuses inputs that cannot be compared, before any of them is run.
    ///
    /// # Errors
    /// Inputs that cannot be read, settings and factors that are not possible, less than two runs.
    pub fn check(&self, files: &Files) -> Result<(), ExperimentError> {
        self.jobs(files)?.iter().try_for_each(|job| job.check(files))
    }

    pub(super) fn jobs(&self, files: &Files) -> Result<Vec<Job>, ExperimentError> {
        let doses = self.doses.iter().filter(|dose| !dose.factors.is_empty());
        let variants: Vec<&Dose> = self.scale.iter().chain(doses).collect();
        let alone = self.inputs.len() <= 1;
        let mut jobs = Vec::new();
        let inputs = self.inputs.iter().map(Some).chain(self.inputs.is_empty().then_some(None));
        for (number, source) in inputs.enumerate() {
            let (name, what, anew) = self.what(source, files)?;
            let given = self.labels.get(number);
            let control = alone && !variants.is_empty() && given.is_none();
            let name = given.cloned().unwrap_or(name);
            let label = if control { "control".to_owned() } else { name.clone() };
            jobs.push(Job { label, what, factors: Vec::new() });
            for Dose { label, factors } in &variants {
                let label = if alone { label.clone() } else { format!("{name}, {label}") };
                jobs.push(Job { label, what: anew.clone(), factors: factors.clone() });
            }
        }
        if jobs.len() < 2 {
            return Err(ExperimentError::new("a comparison needs two or more runs").advise(
                "give two or more result folders or run files, or change one with --scale or --doses",
            ));
        }
        for index in 1..jobs.len() {
            let (before, label) = (&jobs[..index], jobs[index].label.clone());
            if before.iter().any(|job| job.label == label) {
                jobs[index].label = format!("{label} ({})", index + 1);
            }
        }
        Ok(jobs)
    }

    /// The name of an input, what it is, and what it is when it is simulated again.
    fn what(
        &self,
        source: Option<&Source>,
        files: &Files,
    ) -> Result<(String, What, What), ExperimentError> {
        let path = match source {
            Some(Source::Run(side)) => {
                if !self.settings.is_empty() {
                    let message =
                        format!("`{}` is a finished run; settings do not change it", side.label);
                    return Err(ExperimentError::new(message)
                        .advise("give them to the run, or compare its run file"));
                }
                let anew = What::Settings(Box::new(side.file.clone()));
                return Ok((side.label.clone(), What::There(side.clone()), anew));
            }
            Some(Source::Path(path)) => Some(path.as_path()),
            None => None,
        };
        let folder = path.filter(|path| path.is_dir());
        let file = folder.map(|folder| folder.join(RUN_FILE));
        if let (Some(folder), Some(file)) = (folder, &file) {
            check_folder(folder, files)?;
            if !self.settings.is_empty() {
                return Err(ExperimentError::new(format!(
                    "`{}` holds results, and options cannot change them",
                    folder.display()
                ))
                .advise(format!("give {} to run it anew", file.display())));
            }
        }
        let path = file.as_deref().or(path);
        let (name, run) = input::settle(path, &self.settings, files, &Interruption::default())?;
        let name = folder
            .and_then(Path::file_name)
            .map_or(name, |name| name.to_string_lossy().into_owned());
        let name = if run.title.is_empty() { name } else { run.title };
        let anew = What::Path(path.map(Path::to_owned), self.settings.clone());
        let what = folder.map_or_else(|| anew.clone(), |folder| What::Results(folder.to_owned()));
        Ok((name, what, anew))
    }
}

impl Job {
    /// Refuses settings and factors that are not possible.
    pub(super) fn check(&self, files: &Files) -> Result<(), ExperimentError> {
        match &self.what {
            What::Path(..) | What::Settings(_) => {
                self.run(files, &Interruption::default()).map(drop)
            }
            What::Results(_) | What::There(_) => Ok(()),
        }
    }

    /// The run to be simulated, with its factors.
    fn run(
        &self,
        files: &Files,
        interruption: &Interruption,
    ) -> Result<(String, Run, Vec<Scaled>), ExperimentError> {
        let (name, mut run) = match &self.what {
            What::Path(path, overrides) => {
                input::settle(path.as_deref(), overrides, files, interruption)?
            }
            What::Settings(file) => {
                let run =
                    file.resolve().map_err(|error| ExperimentError::of_run_file(&error, None))?;
                (run.shape.name().to_owned(), run.interrupted_by(interruption))
            }
            What::Results(folder) => {
                input::settle(Some(&folder.join(RUN_FILE)), &[], files, interruption)?
            }
            What::There(side) => return Err(ExperimentError::new(&side.label)),
        };
        let scaled = factor::scale(&mut run, &self.factors)
            .map_err(|error| ExperimentError::new(format!("{}: {error}", self.label)))?;
        Ok((name, run, scaled))
    }

    /// Reads the results or simulates the cell.
    pub(super) fn side(self, files: &Files, meter: &Meter<'_>) -> Result<Side, ExperimentError> {
        let side = match &self.what {
            What::There(side) => Ok(Side { label: self.label.clone(), ..(**side).clone() }),
            What::Results(folder) => {
                let beat = || self.beaten(files, &Meter::still(meter));
                of_folder(&self.label, folder, files, &beat)
            }
            What::Path(..) | What::Settings(_) => return self.beaten(files, meter),
        };
        meter.add(1.0);
        side
    }

    fn beaten(&self, files: &Files, meter: &Meter<'_>) -> Result<Side, ExperimentError> {
        let interruption = meter.observer.interruption();
        let (name, run, scaled) = self.run(files, &interruption)?;
        let source = match &self.what {
            What::Path(Some(path), _) => path.display().to_string(),
            What::Results(folder) => folder.join(RUN_FILE).display().to_string(),
            _ => run.shape.name().to_owned(),
        };
        let Input { mut run, bytes, shaped, .. } = input::mesh(name, run, None, files)?;
        let mut made = run.make(shaped, |file| files.bytes(file))?;
        run.fibre = made.fibres.taken;
        // One thread each, since several runs are computed at the same time.
        made.simulation.numerics.engine.threads = 1;
        let mut done = 0.0;
        let outcome = made.simulation.clone().build()?.run(|progress| {
            let now = (progress.time / progress.duration.max(1e-9)).min(1.0);
            meter.add(now - done);
            done = now;
            !interruption.is_requested()
        });
        meter.add(1.0 - done);
        let shape = sha256(&bytes.shape);
        let side = Side::of(self.label.clone(), source, &run, &made, &outcome, shape)?;
        Ok(Side { scaled, ..side })
    }
}

/// Gives names to the files of a run as its results would have them, without copies; `results` is where they go.
pub(super) fn name_inputs(
    inputs: &mut Inputs,
    file: &RunFile,
    results: Option<&Path>,
    files: &Files,
) {
    for path in file.clone().paths_mut() {
        let large = std::fs::metadata(&*path).is_ok_and(|file| file.len() > LARGEST_COPY);
        match (files.bytes(&*path), results) {
            (Ok(bytes), _) if !large => drop(inputs.copy(path, &bytes, |_, _| Ok(()))),
            (_, Some(results)) => inputs.stays(path, results),
            _ => {}
        }
    }
}
