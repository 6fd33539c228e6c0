//! A run and what came of it.

use crate::cell::{Cell, Inner, pairs, triangles};
use crate::experiment::{self, Progress};
use crate::waiting::interruptible;
use crate::{errors, settings, words};
use ciborium::{from_reader, into_writer};
use myospring::analysis::Metric;
use myospring::analysis::beats::Beats;
use myospring::experiment::run::{ALL, FinishedRun, NONE, OUTPUTS, Output, PreparedRun, chosen};
use myospring::experiment::{ExperimentError, Folder, Observer};
use myospring::integrate::engine::EngineUsed;
use myospring::interruption::Interruption;
use myospring::output::field::Fields;
use myospring::output::figure::{self, FigureError};
use myospring::recording::{Frame, Recording, Sample, Signal, Wave};
use myospring::run_file::RunFile;
use myospring::settings::{MeshedRun, Run};
use myospring::simulation::{Effort, Outcome, StopReason};
use myospring::study::sha256;
use numpy::{PyArray1, PyArray2, PyArray3, PyArrayMethods as _};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict};
use serde::{Deserialize, Serialize};
use std::path::PathBuf;
use std::sync::Arc;

/// Numbers in a row.
type Numbers<'py> = Bound<'py, PyArray1<f64>>;

/// Name and value of a column.
type Column = (&'static str, fn(&Sample) -> f64);

/// What one sample has, by the name of its column.
const COLUMNS: [Column; 12] = [
    ("t_ms", |sample| sample.t_ms),
    ("u", |sample| sample.u.unwrap_or(f64::NAN)),
    ("ta_kpa", |sample| sample.ta_kpa),
    ("length_um", |sample| sample.length_um),
    ("width_um", |sample| sample.width_um),
    ("area_um2", |sample| sample.area_um2),
    ("shortening_pct", |sample| sample.shortening_pct),
    ("elastic_energy_fj", |sample| sample.elastic_energy_fj),
    ("kinetic_energy_fj", |sample| sample.kinetic_energy_fj),
    ("active_work_fj", |sample| sample.active_work_fj),
    ("dissipated_energy_fj", |sample| sample.dissipated_energy_fj),
    ("vm_mv", |sample| sample.vm_mv.unwrap_or(f64::NAN)),
];

/// A run that is over.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Beat {
    pub(crate) cell: Arc<Inner>,
    /// The settings that were given, those of the cell included.
    file: RunFile,
    pub(crate) beaten: FinishedRun,
    beats: Beats,
}

/// Beats a cell; `given` are settings by key. What stopped it early is the beat's to tell.
#[pyfunction]
pub(crate) fn simulate(
    py: Python<'_>,
    cell: &Cell,
    given: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Beat> {
    let mut file = cell.0.file.clone();
    settings::put(&mut file, given)?;
    beat(py, cell, file, threads, progress)
}

/// As [`simulate`], with the settings of a run file.
#[pyfunction]
pub(crate) fn repeat(
    py: Python<'_>,
    cell: &Cell,
    run_file: &str,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Beat> {
    let file = RunFile::from_text(run_file).map_err(|error| errors::of_settings(py, &error))?;
    beat(py, cell, file, threads, progress)
}

/// Beats a cell by a run file.
pub(crate) fn beat(
    py: Python<'_>,
    cell: &Cell,
    file: RunFile,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Beat> {
    let cell = &cell.0;
    let run = resolved(py, cell, &file)?;
    let beaten = experiment::watched(py, progress, |watch| {
        let named = (cell.name.clone(), Run { interruption: watch.interruption(), ..run });
        let shape = (cell.shaped.clone(), sha256(&cell.bytes.shape));
        Ok::<_, ExperimentError>(
            PreparedRun::new(named, shape, threads, &cell.files())?.beat(watch),
        )
    })?;
    let mut beaten = beaten.map_err(|error| errors::of_experiment(&error))?;
    // That of the work that follows is another.
    beaten.run.interruption = Interruption::default();
    beaten.made.simulation.interruption = Interruption::default();
    Ok(Beat::of(cell, file, beaten))
}

/// The run of a run file on a cell that is meshed already.
fn resolved(py: Python<'_>, cell: &Inner, file: &RunFile) -> PyResult<Run> {
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let of_cell = cell.file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    if run.shape.form == of_cell.shape.form {
        return Ok(run);
    }
    let meshed = of_cell.material.thickness;
    let text = format!(
        "`thickness_um`: the thick cell was meshed with {meshed} um; give the thickness where the cell is made"
    );
    Err(PyValueError::new_err(text))
}

/// The run of a run file and its simulation on a cell.
pub(crate) fn make(py: Python<'_>, cell: &Inner, file: &RunFile) -> PyResult<(Run, MeshedRun)> {
    let mut run = resolved(py, cell, file)?;
    let made = interruptible(py, |interruption| {
        let run = run.clone().interrupted_by(interruption);
        run.make(cell.shaped.clone(), |path| cell.read(path))
    })?;
    let mut made = made.map_err(|error| errors::of_making(&error))?;
    // That of the work that follows is another.
    made.simulation.interruption = Interruption::default();
    // What repeats the run is what was taken.
    run.fibre = made.fibres.taken;
    Ok((run, made))
}

impl Beat {
    /// Vectors of all nodes in each frame: (frames, nodes, 2).
    fn by_frame<'a, 'py>(
        &self,
        py: Python<'py>,
        frames: impl ExactSizeIterator<Item = &'a [Vec<f64>; 2]>,
    ) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let (count, nodes) = (frames.len(), self.beaten.made.simulation.mesh.len());
        let mut flat = Vec::with_capacity(2 * nodes * count);
        for [x, y] in frames {
            flat.extend(x.iter().zip(y).flat_map(|(x, y)| [*x, *y]));
        }
        PyArray1::from_vec(py, flat).reshape([count, nodes, 2])
    }
}

#[pymethods]
impl Beat {
    /// Positions of the points of a thick cell, um: (frames, points, 3). A flat cell has `None`.
    #[getter]
    fn positions_in_space<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let frames = &self.beaten.outcome.recording.in_space;
        let Some(points) = frames.first().map(|frame| frame.positions[0].len()) else {
            return Ok(None);
        };
        let mut flat = Vec::with_capacity(3 * points * frames.len());
        for Frame { positions: [x, y, z], .. } in frames {
            for point in 0..points {
                flat.extend([x[point], y[point], z[point]]);
            }
        }
        PyArray1::from_vec(py, flat).reshape([frames.len(), points, 3]).map(Some)
    }

    /// Of a tissue, when each node was activated, ms after the stimulus, and the duration of its action potential, ms: (nodes,) each,
    /// NaN where it has none. A single cell has `None`.
    #[getter]
    fn activation<'py>(&self, py: Python<'py>) -> Option<(Numbers<'py>, Numbers<'py>)> {
        let map = self.beaten.outcome.wave_map()?;
        let array = |values: Vec<Option<f64>>| {
            let numbers = values.into_iter().map(|value| value.unwrap_or(f64::NAN));
            PyArray1::from_vec(py, numbers.collect())
        };
        Some((array(map.activation_ms), array(map.duration_ms)))
    }

    /// Of a tissue, where waves ended: time, ms, x and y, um, (tips, 3). A single cell has `None`.
    #[getter]
    fn wave_tips<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let Some(wave) = &self.beaten.outcome.recording.wave else { return Ok(None) };
        let flat: Vec<f64> =
            wave.tips.iter().flat_map(|tip| [tip.t_ms, tip.x_um, tip.y_um]).collect();
        PyArray1::from_vec(py, flat).reshape([wave.tips.len(), 3]).map(Some)
    }

    /// The cell that beat.
    #[getter]
    fn cell(&self) -> Cell {
        Cell(Arc::clone(&self.cell))
    }

    /// Names of the columns: what a sample has, then what the cell model tells besides.
    #[getter]
    fn columns(&self) -> Vec<String> {
        let potential =
            self.beaten.outcome.recording.samples.first().and_then(|sample| sample.vm_mv);
        let own = COLUMNS.iter().filter(|(name, _)| *name != "vm_mv" || potential.is_some());
        let signals =
            self.beaten.outcome.recording.signals.iter().map(|signal| signal.name.clone());
        own.map(|(name, _)| (*name).to_owned()).chain(signals).collect()
    }

    /// A column: (samples,).
    fn column<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let Recording { samples, signals, .. } = &self.beaten.outcome.recording;
        let values = match COLUMNS.iter().find(|(known, _)| *known == name) {
            Some((_, read)) => samples.iter().map(read).collect(),
            None => match signals.iter().find(|signal| signal.name == name) {
                Some(signal) => signal.values.clone(),
                None => return Err(errors::unknown(py, format!("there is no column `{name}`"))),
            },
        };
        Ok(PyArray1::from_vec(py, values))
    }

    /// Times of the frames, ms.
    #[getter]
    fn frame_t_ms<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let frames = &self.beaten.outcome.recording.frames;
        PyArray1::from_vec(py, frames.iter().map(|frame| frame.t_ms).collect())
    }

    /// Positions, um: (frames, nodes, 2).
    #[getter]
    fn positions<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames = &self.beaten.outcome.recording.frames;
        self.by_frame(py, frames.iter().map(|frame| &frame.positions))
    }

    /// Forces on the gel, nN: (frames, nodes, 2); `None` of a cell that adheres to none.
    #[getter]
    fn forces_on_gel<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray3<f64>>>> {
        let frames = &self.beaten.outcome.recording.frames;
        let forces: Option<Vec<_>> = frames.iter().map(|frame| frame.on_gel_nn.as_ref()).collect();
        let forces = forces.filter(|forces| !forces.is_empty());
        forces.map(|forces| self.by_frame(py, forces.into_iter())).transpose()
    }

    /// Membrane potential of each node, mV: (frames, nodes); `None` of a single cell.
    #[getter]
    fn potentials<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyArray2<f64>>>> {
        let frames = &self.beaten.outcome.recording.frames;
        let all: Option<Vec<_>> = frames.iter().map(|frame| frame.potential_mv.clone()).collect();
        let all = all.filter(|all| !all.is_empty());
        all.map(|all| Ok(PyArray2::from_vec2(py, &all)?)).transpose()
    }

    /// Nodes of each triangle: (triangles, 3).
    #[getter]
    fn triangles<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<u32>>> {
        triangles(py, &self.beaten.made.simulation.mesh)
    }

    /// Fibre direction in each triangle, unit vectors: (triangles, 2).
    #[getter]
    fn fibres<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        pairs(py, self.beaten.made.simulation.fibres.iter().copied())
    }

    /// Name, value and unit of all metrics; of several beats of a train their mean, then what an S2 is against them.
    #[getter]
    fn metrics(&self) -> Vec<(&'static str, Option<f64>, &'static str)> {
        let Some(first) = self.beats.usual() else { return Vec::new() };
        let s2 = self.beats.s2().into_iter().flat_map(|beat| &beat.s2);
        let all = first.metrics().chain(s2).chain(&self.beats.energy);
        let row = |metric: &Metric| (metric.name, self.beats.mean(metric.name), metric.unit);
        all.map(row).collect()
    }

    /// Name of each metric that has no value, and why.
    #[getter]
    fn missing(&self) -> Vec<(&'static str, &'static str)> {
        let Some(first) = self.beats.usual() else { return Vec::new() };
        let s2 = self.beats.s2().into_iter().flat_map(|beat| &beat.s2);
        let all = first.metrics().chain(s2).chain(&self.beats.energy);
        let without = all.filter(|metric| self.beats.mean(metric.name).is_none());
        without.filter_map(|metric| Some((metric.name, metric.missing?.words()))).collect()
    }

    /// Name and value of the metrics of each beat.
    #[getter]
    fn metrics_by_beat(&self) -> Vec<Vec<(&'static str, Option<f64>)>> {
        let of = |beat: &myospring::analysis::beat::Beat| {
            beat.metrics().map(|metric| (metric.name, metric.value)).collect()
        };
        self.beats.iter().map(of).collect()
    }

    /// Number of stimuli, numbers of those that raised no action potential, capture ratio and alternans in words.
    #[getter]
    fn rhythm(&self) -> (usize, Vec<usize>, Option<String>, Option<String>) {
        let rhythm = self.beats.rhythm.clone();
        (rhythm.stimuli, rhythm.not_captured, rhythm.capture_ratio, rhythm.alternans)
    }

    /// Times of the stimuli, ms.
    #[getter]
    fn stimulus_times_ms(&self) -> Vec<f64> {
        self.beaten.outcome.stimulus_times_ms.clone()
    }

    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.beaten.summary.warnings.iter().map(|text| words::in_python(text)).collect()
    }

    /// What is known of the cell model and seen in this beat, in a sentence.
    #[getter]
    fn about_model(&self) -> Option<String> {
        let about = self.beaten.made.simulation.pace(&self.beats).about_model()?;
        Some(words::in_python(&about))
    }

    /// Why it stopped early, and when, ms.
    #[getter]
    fn stop(&self) -> Option<(String, Option<f64>)> {
        self.beaten.outcome.stop.as_ref().map(|stop| (stop.to_string(), stop.time_ms()))
    }

    /// The run file that repeats this run.
    #[getter]
    fn run_file(&self) -> String {
        let spacing = self.beaten.made.report.spacing_um;
        self.beaten.run.settled(spacing, self.beaten.outcome.effort.time_step()).to_toml()
    }

    /// Name of the cell model, and how long it ran, ms.
    #[getter]
    fn facts(&self) -> (String, f64) {
        (self.beaten.run.cell.name().to_owned(), self.beaten.run.duration)
    }

    /// The cell at rest and at its peak beside its curves, SVG.
    fn overview_svg(&self, py: Python<'_>) -> PyResult<String> {
        let draw = || -> Result<String, FigureError> {
            let simulation = &self.beaten.made.simulation;
            let content = simulation.myofibril_content.as_deref();
            let fields = Fields::new(&simulation.mesh, &simulation.fibres, content)?;
            let frames = &self.beaten.outcome.recording.frames;
            let cell =
                figure::DrawnCell::new(fields, Some(&self.beaten.made.outline))?.scaled_to(frames);
            let stimuli = &self.beaten.outcome.stimulus_times_ms;
            Ok(figure::overview(&cell, &self.beaten.outcome.recording, stimuli)?.to_svg())
        };
        py.detach(draw).map_err(errors::value)
    }

    /// Writes what `myospring run` writes into a folder; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(
        &self,
        py: Python<'_>,
        folder: PathBuf,
        force: bool,
        outputs: Option<Vec<String>>,
    ) -> PyResult<PathBuf> {
        let known: Vec<&str> =
            OUTPUTS.iter().map(|output| output.word).chain([ALL, NONE]).collect();
        if let Some(word) = outputs.iter().flatten().find(|word| !known.contains(&word.as_str())) {
            return Err(errors::unknown_among(py, word, known.iter().copied()));
        }
        let outputs = chosen(outputs.as_deref()).map_err(|error| errors::of_saving(&error))?;
        let saved = Saved { beaten: &self.beaten, outputs };
        let files = self.cell.files();
        for path in self.beaten.run.to_run_file().paths_mut() {
            files.note(path.as_ref());
        }
        experiment::save(py, &saved, &folder, force, &files)
    }

    /// All that makes the beat again, but for the cell.
    fn state<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let Outcome { recording, stop, effort, engine, stimulus_times_ms, s2_ms } =
            &self.beaten.outcome;
        let state = State {
            run_file: self.file.to_toml(),
            samples: recording.samples.clone(),
            signals: recording.signals.clone(),
            wave: recording.wave.clone(),
            frames: recording.frames.iter().map(shape).collect(),
            in_space: recording.in_space.iter().map(shape).collect(),
            stop: stop.clone(),
            effort: *effort,
            engine: engine.clone(),
            stimulus_times_ms: stimulus_times_ms.clone(),
            s2_ms: *s2_ms,
            warnings: self.beaten.summary.warnings.clone(),
        };
        let mut written = Vec::new();
        into_writer(&state, &mut written).map_err(errors::value)?;
        Ok(PyBytes::new(py, &written))
    }

    /// The beat of a state and its cell.
    #[staticmethod]
    fn of_state(py: Python<'_>, cell: &Cell, state: &[u8]) -> PyResult<Self> {
        let state: State = from_reader(state).map_err(errors::value)?;
        let file =
            RunFile::from_text(&state.run_file).map_err(|error| errors::of_settings(py, &error))?;
        let (run, made) = make(py, &cell.0, &file)?;
        let recording = Recording {
            samples: state.samples,
            frames: state.frames.into_iter().map(frame).collect(),
            in_space: state.in_space.into_iter().map(frame).collect(),
            signals: state.signals,
            wave: state.wave,
        };
        let outcome = Outcome {
            recording,
            stop: state.stop,
            effort: state.effort,
            engine: state.engine,
            stimulus_times_ms: state.stimulus_times_ms,
            s2_ms: state.s2_ms,
        };
        Ok(Self::kept(&cell.0, file, run, made, outcome, state.warnings))
    }
}

impl Beat {
    /// A beat that was kept somewhere.
    pub(crate) fn kept(
        cell: &Arc<Inner>,
        file: RunFile,
        run: Run,
        made: MeshedRun,
        outcome: Outcome,
        warnings: Vec<String>,
    ) -> Self {
        let (name, sha256) = (cell.name.clone(), sha256(&cell.bytes.shape));
        let beaten = FinishedRun::of(name, run, sha256, made, outcome, warnings, cell.files());
        Self::of(cell, file, beaten)
    }

    fn of(cell: &Arc<Inner>, file: RunFile, beaten: FinishedRun) -> Self {
        let (cell, beats) = (Arc::clone(cell), beaten.outcome.beats());
        Self { cell, file, beaten, beats }
    }
}

/// A beat with the outputs that are to be written.
struct Saved<'a> {
    beaten: &'a FinishedRun,
    outputs: Vec<&'static Output>,
}

impl myospring::experiment::Outcome for Saved<'_> {
    fn numbers(&self) -> impl Serialize {
        self.beaten.all_numbers()
    }

    fn warnings(&self) -> Vec<String> {
        self.beaten.summary.warnings.clone()
    }

    fn save(&self, folder: &Folder, observer: &dyn Observer) -> Result<(), ExperimentError> {
        self.beaten.write_all(folder, &self.outputs, observer)
    }
}

/// Time, tension, tension by triangle, forces on a gel, potentials, positions.
type Shape<const D: usize> =
    (f64, f64, Option<Vec<f64>>, Option<[Vec<f64>; D]>, Option<Vec<f64>>, [Vec<f64>; D]);

fn shape<const D: usize>(frame: &Frame<D>) -> Shape<D> {
    let Frame { t_ms, ta_kpa, ta_by_triangle_kpa, on_gel_nn, potential_mv, positions } =
        frame.clone();
    (t_ms, ta_kpa, ta_by_triangle_kpa, on_gel_nn, potential_mv, positions)
}

fn frame<const D: usize>(shape: Shape<D>) -> Frame<D> {
    let (t_ms, ta_kpa, ta_by_triangle_kpa, on_gel_nn, potential_mv, positions) = shape;
    Frame { t_ms, ta_kpa, ta_by_triangle_kpa, on_gel_nn, potential_mv, positions }
}

#[derive(Serialize, Deserialize)]
struct State {
    run_file: String,
    samples: Vec<Sample>,
    signals: Vec<Signal>,
    wave: Option<Wave>,
    frames: Vec<Shape<2>>,
    in_space: Vec<Shape<3>>,
    stop: Option<StopReason>,
    effort: Effort,
    engine: Option<EngineUsed>,
    stimulus_times_ms: Vec<f64>,
    s2_ms: Option<f64>,
    warnings: Vec<String>,
}
