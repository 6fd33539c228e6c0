//! Experiments of the library: done while Python listens, watched by a function, saved into a folder.

use crate::waiting::interruptible;
use crate::{errors, words};
use myospring::experiment::{self, Experiment, ExperimentError, Files, Observer, Outcome};
use myospring::interruption::Interruption;
use myospring::output::json;
use myospring::study::Threads;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// A function that hears of each step: stage, steps that are done, all of them.
pub(crate) type Progress = Option<Py<PyAny>>;

/// Passes on what an experiment says.
struct Watch {
    progress: Progress,
    interruption: Interruption,
    stage: Mutex<(String, u64)>,
    /// What the function raised, which ends the experiment.
    raised: Mutex<Option<PyErr>>,
    has_raised: Arc<AtomicBool>,
    said: Mutex<Vec<String>>,
}

impl Watch {
    fn new(progress: Progress, interruption: &Interruption) -> Self {
        let has_raised = Arc::new(AtomicBool::new(false));
        let (asked, raised) = (interruption.clone(), Arc::clone(&has_raised));
        let ends = move || raised.load(Ordering::Relaxed) || asked.is_requested();
        Self {
            progress,
            interruption: Interruption::when(ends),
            stage: Mutex::default(),
            raised: Mutex::default(),
            has_raised,
            said: Mutex::default(),
        }
    }
}

fn held<T>(value: &Mutex<T>) -> MutexGuard<'_, T> {
    value.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Observer for Watch {
    fn stage(&self, what: &str, of: u64) {
        *held(&self.stage) = (what.to_owned(), of);
    }

    fn reached(&self, done: u64) {
        let Some(progress) = &self.progress else { return };
        let (stage, all) = held(&self.stage).clone();
        if let Err(error) = Python::attach(|py| progress.call1(py, (stage, done, all)).map(drop)) {
            held(&self.raised).get_or_insert(error);
            self.has_raised.store(true, Ordering::Relaxed);
        }
    }

    fn warn(&self, text: &str) {
        held(&self.said).push(words::in_python(text));
    }

    fn interruption(&self) -> Interruption {
        self.interruption.clone()
    }
}

/// Does an experiment; Ctrl-C, or what `progress` raises, ends it.
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
    let (done, raised) = interruptible(py, |interruption| {
        let watch = Watch::new(progress, interruption);
        let threads = Threads::new(None).map_err(ExperimentError::from);
        let done = threads.and_then(|threads| threads.install(|| description.run(files, &watch)));
        (done, held(&watch.raised).take())
    })?;
    raised.map_or(Ok(()), Err)?;
    done.map_err(|error| errors::of_experiment(&error))
}

/// Saves an outcome: the folder, and what was odd.
pub(crate) fn save(
    py: Python<'_>,
    outcome: &(impl Outcome + Sync),
    folder: &Path,
    force: bool,
    files: &Files,
) -> PyResult<(PathBuf, Vec<String>)> {
    let (saved, said) = interruptible(py, |interruption| {
        let watch = Watch::new(None, interruption);
        // Threads of its own: those of the process do not survive a fork.
        let threads = Threads::new(None).map_err(ExperimentError::from);
        let save = || experiment::save(outcome, folder, force, files, &watch);
        let saved = threads.and_then(|threads| threads.install(save));
        (saved, std::mem::take(&mut *held(&watch.said)))
    })?;
    Ok((saved.map_err(|error| errors::of_saving(&error))?, said))
}

/// All numbers of an outcome, JSON.
pub(crate) fn numbers(outcome: &impl Outcome) -> PyResult<String> {
    json::pretty(&outcome.numbers()).map_err(errors::value)
}

/// What a reader of an outcome must know, in the words of Python.
pub(crate) fn warnings(outcome: &impl Outcome) -> Vec<String> {
    outcome.warnings().iter().map(|warning| words::in_python(warning)).collect()
}
