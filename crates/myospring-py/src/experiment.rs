//! Experiments of the library: done while Python listens, watched by a function, saved into a folder.

use crate::waiting::interruptible;
use crate::{errors, words};
use myospring::experiment::{self, Experiment, ExperimentError, Files, Observer, Outcome};
use myospring::interruption::Interruption;
use myospring::output::json;
use myospring::study::Threads;
use pyo3::prelude::*;
use pyo3::sync::MutexExt as _;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A function that hears of each step: stage, steps that are done, all of them.
pub(crate) type Progress = Option<Py<PyAny>>;

/// Passes on what an experiment says: steps to a function, notes to the logger `myospring`, warnings to those of Python.
pub(crate) struct Watch {
    progress: Progress,
    interruption: Interruption,
    stage: Mutex<Stage>,
    /// What the function raised, which ends the experiment.
    raised: Mutex<Option<PyErr>>,
    has_raised: Arc<AtomicBool>,
    warnings: Mutex<Vec<String>>,
}

/// What is done, how many steps it has, and the last one that the function heard of.
#[derive(Default)]
struct Stage {
    what: String,
    of: u64,
    told: Option<u64>,
}

impl Watch {
    fn new(progress: Progress, stop: Arc<AtomicBool>, interruption: &Interruption) -> Self {
        let has_raised = Arc::new(AtomicBool::new(false));
        let (asked, raised) = (interruption.clone(), Arc::clone(&has_raised));
        let is_set = |flag: &AtomicBool| flag.load(Ordering::Relaxed);
        let ends = move || is_set(&raised) || is_set(&stop) || asked.is_requested();
        Self {
            progress,
            interruption: Interruption::when(ends),
            stage: Mutex::default(),
            raised: Mutex::default(),
            has_raised,
            warnings: Mutex::default(),
        }
    }

    /// Ends the experiment if a function of Python has raised something.
    fn heard(&self, answer: PyResult<()>) {
        if let Err(error) = answer {
            held(&self.raised).get_or_insert(error);
            self.has_raised.store(true, Ordering::Relaxed);
        }
    }

    fn log(&self, level: &str, text: &str) {
        let text = words::in_python(text);
        self.heard(Python::attach(|py| {
            let logger = py.import("logging")?.call_method1("getLogger", ("myospring",))?;
            logger.call_method1(level, ("%s", text)).map(drop)
        }));
    }
}

fn held<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Observer for Watch {
    fn stage(&self, what: &str, of: u64) {
        *held(&self.stage) = Stage { what: what.to_owned(), of, told: None };
    }

    fn reached(&self, done: u64) {
        let Some(progress) = &self.progress else { return };
        self.heard(Python::attach(|py| {
            // Held while the function hears of it, so that threads tell one after the other.
            let mut stage = self.stage.lock_py_attached(py).unwrap_or_else(PoisonError::into_inner);
            if stage.told >= Some(done) || self.has_raised.load(Ordering::Relaxed) {
                return Ok(());
            }
            stage.told = Some(done);
            progress.call1(py, (&stage.what, done, stage.of)).map(drop)
        }));
    }

    fn note(&self, text: &str) {
        self.log("info", text);
    }

    fn failed(&self, name: &str, reason: &str) {
        self.log("info", &format!("{name}: {reason}"));
    }

    fn warn(&self, text: &str) {
        held(&self.warnings).push(words::in_python(text));
    }

    fn interruption(&self) -> Interruption {
        self.interruption.clone()
    }
}

/// Does work that is watched; Ctrl-C, or what a function of Python raises, ends it. Then warns.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    progress: Progress,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    watched_until(py, progress, Arc::default(), work)
}

/// As [`watched`]; `stop` ends it, too, since Ctrl-C is heard on one thread alone.
pub(crate) fn watched_until<T: Send>(
    py: Python<'_>,
    progress: Progress,
    stop: Arc<AtomicBool>,
    work: impl FnOnce(&Watch) -> T + Send,
) -> PyResult<T> {
    let (done, raised, warnings) = interruptible(py, |interruption| {
        let watch = Watch::new(progress, stop, interruption);
        let done = work(&watch);
        let Watch { raised, warnings, .. } = watch;
        let raised = raised.into_inner().unwrap_or_else(PoisonError::into_inner);
        (done, raised, warnings.into_inner().unwrap_or_else(PoisonError::into_inner))
    })?;
    raised.map_or(Ok(()), Err)?;
    if !warnings.is_empty() {
        py.import("myospring._errors")?.call_method1("warn", (warnings,))?;
    }
    Ok(done)
}

/// Does an experiment.
pub(crate) fn run<E>(
    py: Python<'_>,
    description: &E,
    files: &Files,
    progress: Progress,
) -> PyResult<E::Outcome>
where
    E: Experiment + Sync,
    E::Outcome: Send,
{
    let done = watched(py, progress, |watch| {
        // Threads of its own: those of the process do not survive a fork.
        Threads::new(None)?.install(|| description.run(files, watch))
    })?;
    done.map_err(|error: ExperimentError| errors::of_experiment(&error))
}

/// Saves an outcome into a folder; where it is.
pub(crate) fn save(
    py: Python<'_>,
    outcome: &(impl Outcome + Sync),
    folder: &Path,
    force: bool,
    files: &Files,
) -> PyResult<PathBuf> {
    let saved = watched(py, None, |watch| {
        Threads::new(None)?.install(|| experiment::save(outcome, folder, force, files, watch))
    })?;
    saved.map_err(|error: ExperimentError| errors::of_saving(&error))
}

/// All numbers of an outcome, JSON.
pub(crate) fn numbers(outcome: &impl Outcome) -> PyResult<String> {
    json::pretty(&outcome.numbers()).map_err(errors::value)
}

/// What a reader of an outcome must know, in the words of Python.
pub(crate) fn warnings(outcome: &impl Outcome) -> Vec<String> {
    outcome.warnings().iter().map(|warning| words::in_python(warning)).collect()
}
