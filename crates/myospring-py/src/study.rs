//! A study whose members are worked on by anyone's engine: what it gives to workers, and what it makes of their rows.

use crate::batch::{Matrix, Stopped, numbers_of, rows_of};
use crate::waiting::interruptible;
use crate::{errors, head, words};
use myospring::experiment::{self, ExperimentError};
use myospring::interruption::Interruption;
use myospring::output::files::{self, Manifest, Reads};
use myospring::settings::{Models, read_toml};
use myospring::study::parameters::{
    Answer, Common, MemberKind, ParameterStudy, ParameterStudyError, Rows, Shard, TRACES,
    Variation, VariationRow,
};
use myospring::study::{Journal, Status, StudyError, Threads};
use numpy::{PyArray1, PyArray2, PyArrayMethods as _, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use pyo3::types::PyBytes;
use std::collections::BTreeMap;
use std::io;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Members, their metrics (n, M), why one has none, their curves (n, L) where they are wanted, and the seconds that
/// it took.
type Worked<'py> = (
    Bound<'py, PyArray1<u64>>,
    Bound<'py, PyArray2<f64>>,
    Vec<Option<String>>,
    Bound<'py, PyArray2<f32>>,
    f64,
);

/// Metrics (N, M), status and reason of each member, and who is kept.
type Table<'py> =
    (Bound<'py, PyArray2<f64>>, Vec<String>, Vec<Option<String>>, Bound<'py, PyArray1<bool>>);

/// A study of parameters and what of it is done.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Study {
    text: String,
    /// What was read for the description itself, and what the members need.
    files: BTreeMap<String, Vec<u8>>,
    parameters: ParameterStudy,
    common: Common,
    /// Where what is done is kept.
    output: Option<PathBuf>,
    progress: Mutex<Progress>,
    stop: Arc<AtomicBool>,
}

/// A description, JSON, as TOML.
#[pyfunction]
pub(crate) fn study_toml(json: &str) -> PyResult<String> {
    let value: toml::Value = serde_json::from_str(json).map_err(errors::value)?;
    toml::to_string(&value).map_err(errors::value)
}

/// A description, TOML, whose members are the rows of a file; it says nothing about members itself.
#[pyfunction]
pub(crate) fn with_rows(py: Python<'_>, text: &str, file: &str) -> PyResult<String> {
    let table: Result<toml::Table, _> = read_toml(text);
    let mut table = table.map_err(|error| errors::of_study(py, &error.into()))?;
    if let Some(key) = ["parameters", "sampling"].into_iter().find(|key| table.contains_key(*key)) {
        let cause = format!("the members are rows, so [{key}] would not be used: leave it out");
        return Err(errors::value(cause));
    }
    let sampling = [("sampler", "table"), ("file", file)];
    let sampling = sampling.map(|(key, value)| (key.to_owned(), value.into()));
    table.insert("sampling".to_owned(), toml::Value::Table(sampling.into_iter().collect()));
    toml::to_string(&table).map_err(errors::value)
}

/// What is done.
struct Progress {
    journal: Journal<Variation>,
    /// What the journal had when it was closed.
    rows: Rows,
    /// Members that were lost with their workers: rows for now, and done anew when the study goes on.
    lost: Vec<VariationRow>,
}

#[pymethods]
impl Study {
    /// Reads a description, TOML, whose files are those of `files` or else in a folder; makes what its members share,
    /// beats the run without any change, and goes on with the journal in the folder `output`, or begins one there.
    /// `of_text` is whether a person wrote the description as text, `description` the file that the text was read from.
    #[new]
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    #[allow(clippy::too_many_arguments, reason = "the parts of a study, each once")]
    fn new(
        py: Python<'_>,
        text: String,
        files: BTreeMap<String, Vec<u8>>,
        folder: PathBuf,
        output: Option<PathBuf>,
        force: bool,
        of_text: bool,
        description: Option<PathBuf>,
    ) -> PyResult<Self> {
        let made = interruptible(py, |interruption| {
            let seen = Mutex::new(BTreeMap::new());
            let read = |path: &str| -> io::Result<Vec<u8>> {
                let bytes = files
                    .get(path)
                    .map_or_else(|| files::read(&folder.join(path)), |it| Ok(it.clone()))?;
                let mut seen = seen.lock().unwrap_or_else(PoisonError::into_inner);
                seen.insert(path.to_owned(), bytes.clone());
                Ok(bytes)
            };
            let models = Models::default().beside(&folder);
            let mut study = ParameterStudy::from_toml_knowing(&text, models, read)?;
            // Without a folder there is no place for curves.
            study.traces &= output.is_some();
            study.interruption = interruption.clone();
            let mut common = Common::new(&study, read)?;
            let mut journal = Journal::in_memory();
            let seen = seen.into_inner().unwrap_or_else(PoisonError::into_inner);
            if let Some(output) = &output {
                let settings = study.settings(&common);
                let mut reads = Reads::new();
                let on_disk = seen.keys().filter(|path| !files.contains_key(*path));
                on_disk.map(|path| folder.join(path)).for_each(|path| reads.add(&path));
                if let Some(path) = &description {
                    reads.add(path);
                }
                journal = if force {
                    Journal::begin_anew(output, &settings, &reads)?
                } else {
                    Journal::open_protecting(output, &settings, &reads)?
                };
                common = common.keeping_traces(output, Shard::WHOLE)?;
                common.check_curves(&study.members(Shard::WHOLE), &journal)?;
                let manifest = Manifest::of(output);
                manifest.write("study.toml", &text).map_err(StudyError::from)?;
                for (name, content) in &files {
                    manifest.write(name, content).map_err(StudyError::from)?;
                }
            }
            let files = seen;
            Ok::<_, ParameterStudyError>((study, common, journal, files))
        })?;
        let (parameters, common, journal, files) =
            made.map_err(|error| errors::of_description(py, &error, of_text))?;
        let progress = Progress { journal, rows: Rows::default(), lost: Vec::new() };
        let (progress, stop) = (Mutex::new(progress), Arc::default());
        Ok(Self { text, files, parameters, common, output, progress, stop })
    }

    /// The description, TOML.
    #[getter]
    fn text(&self) -> &str {
        &self.text
    }

    /// The files that it names, as they were read.
    #[getter]
    fn files(&self) -> BTreeMap<String, Vec<u8>> {
        self.files.clone()
    }

    /// Title, for people.
    #[getter]
    fn title(&self) -> &str {
        &self.parameters.title
    }

    /// How many members' kept results were damaged, and are worked on anew.
    #[getter]
    fn damaged(&self) -> usize {
        self.progress().journal.damaged()
    }

    /// How many members were done with other values than they have now, and are worked on anew.
    #[getter]
    fn changed(&self, py: Python<'_>) -> PyResult<usize> {
        let changed =
            py.detach(|| self.progress().journal.changed(&self.parameters.members(Shard::WHOLE)));
        changed.map_err(|error| errors::of_journal(&error))
    }

    /// What every member is: `"beat"` or `"cell"`.
    #[getter]
    fn kind(&self) -> &'static str {
        match self.parameters.kind {
            MemberKind::Beat => "beat",
            MemberKind::Cell => "cell",
        }
    }

    /// How many members there are.
    #[getter]
    fn size(&self) -> usize {
        self.parameters.values.members()
    }

    /// What varies: name, key, unit.
    #[getter]
    fn varied(&self) -> Vec<(&str, &str, &str)> {
        let numbers = self.parameters.varied.iter().map(|varied| &varied.number);
        numbers.map(|number| (number.name(), number.key.as_str(), number.unit.as_str())).collect()
    }

    /// The metrics: name, unit, and the value of the run without any change.
    #[getter]
    fn metrics(&self) -> Vec<(&str, &str, Option<f64>)> {
        let named = self.parameters.metrics.iter().zip(&self.common.units).zip(&self.common.usual);
        named.map(|((name, unit), usual)| (name.as_str(), *unit, *usual)).collect()
    }

    /// All values: (N, K).
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let values = &self.parameters.values;
        let rows = (1..=values.members()).filter_map(|member| values.of(member));
        let flat: Vec<f64> = rows.flat_map(std::borrow::Cow::into_owned).collect();
        PyArray1::from_vec(py, flat).reshape([self.size(), self.parameters.varied.len()])
    }

    /// The values of some members, by their numbers from 1: (n, K).
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn values_of<'py>(
        &self,
        py: Python<'py>,
        numbers: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let members = self.members(numbers_of(&numbers)?);
        let count = members.len();
        let flat = members.into_iter().flat_map(|member| member.values).collect();
        PyArray1::from_vec(py, flat).reshape([count, self.parameters.varied.len()])
    }

    /// Numbers of the members that are not done.
    fn left<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let left = py.detach(|| self.parameters.left(Shard::WHOLE, &self.progress().journal));
        let left = left.map_err(|error| errors::of_journal(&error))?;
        Ok(PyArray1::from_iter(py, left.into_iter().map(|number| number as u64)))
    }

    /// All that a worker needs beside the members' values: what [`Members`] are made of.
    fn head<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let written = head::write(&self.parameters, &self.common).map_err(errors::value)?;
        Ok(PyBytes::new(py, &written))
    }

    /// Works on some members on this thread, until [`Study::stop`] is called.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn work<'py>(
        &self,
        py: Python<'py>,
        numbers: PyReadonlyArray1<'py, u64>,
    ) -> PyResult<Worked<'py>> {
        let members = self.members(numbers_of(&numbers)?);
        let begun = Instant::now();
        let rows = py.detach(|| {
            let threads = Threads::new(Some(1))?;
            let stop = Arc::clone(&self.stop);
            let interruption = Interruption::when(move || stop.load(Ordering::Relaxed));
            rows_of(&self.common, &members, &threads, &Stopped(&interruption))
        });
        let rows = rows.map_err(errors::value)?;
        back(py, rows, self.parameters.metrics.len(), &self.common, begun)
    }

    /// Ends the work on members.
    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Notes the rows of members that a worker has done.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn note(
        &self,
        py: Python<'_>,
        numbers: PyReadonlyArray1<'_, u64>,
        metrics: PyReadonlyArray2<'_, f64>,
        reasons: Vec<Option<String>>,
        curves: PyReadonlyArray2<'_, f32>,
    ) -> PyResult<()> {
        let numbers = numbers_of(&numbers)?;
        let metrics = metrics.as_array();
        if metrics.dim() != (numbers.len(), self.parameters.metrics.len())
            || reasons.len() != numbers.len()
            || numbers.iter().any(|&number| number == 0 || number > self.size())
        {
            return Err(errors::value("these rows are not of this study"));
        }
        let curves = curves.as_array();
        let done = numbers.iter().zip(curves.outer_iter()).zip(&reasons).map(
            |((&number, curves), reason)| {
                let curves = if reason.is_none() { curves.to_vec() } else { Vec::new() };
                (Variation::new(number, Vec::new()), curves)
            },
        );
        let (members, curves): (Vec<Variation>, Vec<Vec<f32>>) = done.unzip();
        let rows = numbers.into_iter().zip(metrics.outer_iter()).zip(reasons);
        let mut rows: Vec<VariationRow> = rows
            .map(|((member, metrics), reason)| match reason {
                None => {
                    let metrics = metrics.iter().map(|&it| Some(it).filter(|it| !it.is_nan()));
                    let (status, reason) = (Status::Ok, String::new());
                    let (metrics, curves) = (metrics.collect(), String::new());
                    VariationRow { member, status, reason, metrics, curves }
                }
                Some(reason) => failed(member, reason),
            })
            .collect();
        let noted = py.detach(|| {
            let hashes = self.common.keep(&members.iter().collect::<Vec<_>>(), &curves)?;
            for (row, hash) in rows.iter_mut().zip(hashes) {
                row.curves = hash;
            }
            self.parameters.note(&self.progress().journal, rows)
        });
        noted.map_err(|error| errors::of_journal(&error))
    }

    /// Members that were lost with their workers: rows with a reason, which are not kept for another time.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn lose(&self, numbers: PyReadonlyArray1<'_, u64>, reason: &str) -> PyResult<()> {
        let lost =
            numbers_of(&numbers)?.into_iter().map(|member| failed(member, reason.to_owned()));
        self.progress().lost.extend(lost);
        Ok(())
    }

    /// Leaves the folder to others; what is done stays known.
    fn close(&self, py: Python<'_>) -> PyResult<()> {
        let closed = py.detach(|| {
            let Progress { journal, rows, .. } = &mut *self.progress();
            self.parameters.add_noted(Shard::WHOLE, journal, rows)?;
            *journal = Journal::in_memory();
            Ok(())
        });
        closed.map_err(|error: StudyError| errors::of_journal(&error))
    }

    /// What is known of each member that is done or lost, in their order.
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Table<'py>> {
        let answer = py.detach(|| self.answer()).map_err(|error| errors::of_journal(&error))?;
        let width = self.parameters.metrics.len();
        let kept: Vec<bool> = answer.rows().iter().map(|row| answer.is_kept(row)).collect();
        let mut flat = Vec::with_capacity(width * kept.len());
        let (mut statuses, mut reasons) = (Vec::new(), Vec::new());
        for row in answer.rows().iter() {
            let value = |at| row.metric(at).unwrap_or(f64::NAN);
            flat.extend((0..width).map(value));
            statuses.push(row.status.to_string());
            reasons.push(Some(words::in_python(row.reason)).filter(|reason| !reason.is_empty()));
        }
        let metrics = PyArray1::from_vec(py, flat).reshape([kept.len(), width])?;
        Ok((metrics, statuses, reasons, PyArray1::from_vec(py, kept)))
    }

    /// How much each metric hangs on each parameter, JSON.
    fn sensitivity(&self, py: Python<'_>) -> PyResult<String> {
        let found = py.detach(|| self.answer()?.sensitivity());
        let found = found.map_err(|error| errors::of_study(py, &error))?;
        myospring::output::json::pretty(&found).map_err(errors::value)
    }

    /// Writes the files of `myospring study run` into a folder; what stands in the way of some of them.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf) -> PyResult<Vec<String>> {
        let saved = py.detach(|| {
            let answer = self.answer()?;
            let traces = self.output.as_ref().filter(|_| self.common.axes.is_some());
            let traces =
                traces.filter(|output| output.canonicalize().ok() != folder.canonicalize().ok());
            let traces = traces.map(|output| output.join(TRACES));
            let threads = Threads::new(None)?;
            threads.install(|| {
                experiment::study::save(
                    &self.parameters,
                    &self.common,
                    &answer,
                    &folder,
                    &self.text,
                    traces.as_deref(),
                )
            })
        });
        saved.map_err(|error: ExperimentError| errors::of_saving(&error))
    }
}

impl Study {
    fn progress(&self) -> MutexGuard<'_, Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn members(&self, numbers: Vec<usize>) -> Vec<Variation> {
        numbers.into_iter().filter_map(|number| self.parameters.member(number)).collect()
    }

    fn answer(&self) -> Result<Answer<'_>, StudyError> {
        let progress = self.progress();
        let mut rows = progress.rows.clone();
        self.parameters.add_noted(Shard::WHOLE, &progress.journal, &mut rows)?;
        rows.extend(progress.lost.iter().cloned());
        Ok(Answer::new(&self.parameters, &self.common.units, rows))
    }
}

fn failed(member: usize, reason: String) -> VariationRow {
    let curves = String::new();
    VariationRow { member, status: Status::Failed, reason, metrics: Vec::new(), curves }
}

/// What members share, in a worker.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Members {
    common: Common,
    width: usize,
}

#[pymethods]
impl Members {
    /// Of what [`Study::head`] has written.
    #[new]
    fn new(py: Python<'_>, head: &[u8]) -> PyResult<Self> {
        let made = py.detach(|| {
            let (study, files) = head::read(head)?;
            let read =
                |path: &str| files.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into());
            let common = Common::still(&study, read, None).map_err(|error| error.to_string())?;
            Ok::<_, String>(Self { common: common.handing_on(), width: study.metrics.len() })
        });
        made.map_err(errors::value)
    }

    /// The rows of some members, by their numbers and their values (n, K).
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn rows<'py>(
        &self,
        py: Python<'py>,
        numbers: PyReadonlyArray1<'py, u64>,
        values: PyReadonlyArray2<'py, f64>,
        threads: usize,
    ) -> PyResult<Worked<'py>> {
        let values = values.as_array();
        let members = numbers_of(&numbers)?.into_iter().zip(values.outer_iter());
        let members: Vec<Variation> =
            members.map(|(number, values)| Variation::new(number, values.to_vec())).collect();
        let begun = Instant::now();
        let rows = interruptible(py, |interruption| {
            let threads = Threads::new(Some(threads))?;
            rows_of(&self.common, &members, &threads, &Stopped(interruption))
        })?;
        back(py, rows.map_err(errors::value)?, self.width, &self.common, begun)
    }
}

/// Rows on their way back.
fn back<'py>(
    py: Python<'py>,
    rows: Vec<VariationRow>,
    width: usize,
    common: &Common,
    begun: Instant,
) -> PyResult<Worked<'py>> {
    let seconds = begun.elapsed().as_secs_f64();
    let curves: Vec<Vec<f32>> = rows.iter().map(|row| common.handed(row.member)).collect();
    let length = curves.iter().map(Vec::len).max().unwrap_or(0);
    let missing = |mut curves: Vec<f32>| {
        curves.resize(length, f32::NAN);
        curves
    };
    let flat: Vec<f32> = curves.into_iter().flat_map(missing).collect();
    let curves = PyArray1::from_vec(py, flat).reshape([rows.len(), length])?;
    let numbers = PyArray1::from_iter(py, rows.iter().map(|row| row.member as u64));
    let mut matrix = Matrix::new(width, rows.len());
    matrix.add(rows, str::to_owned);
    let (metrics, reasons) = matrix.into_python(py)?;
    Ok((numbers, metrics, reasons, curves, seconds))
}
