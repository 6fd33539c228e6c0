//! Fits: a cell's own parameters from its measured curves.

use crate::cell::{Cell, REST};
use crate::experiment::{self, Progress};
use crate::tension_map::{Columns, TensionMap, columns};
use crate::waiting::interruptible;
use crate::{beat, errors, settings, words};
use myospring::analysis::kind::Family;
use myospring::experiment::fit::{
    FitCell, Fits, FittableCell, Models, RecordedCalcium, Shapes, TractionCurve, between_springs,
    of_table, on_gel, scale_error, seeks_tension,
};
use myospring::experiment::tables::is_of_tables;
use myospring::experiment::{BeatOptions, ExperimentError, Files};
use myospring::fit::{Fit, FitOptions, Loaded};
use myospring::measured::{self, Column, Curve, Kind, ReadError, Table, TableOptions};
use myospring::output::files;
use myospring::output::json;
use myospring::settings::{Run, Source};
use myospring::study::Threads;
use myospring::tension_map::FrameShape;
use numpy::{PyArray1, PyArray3, PyArrayMethods as _};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A curve: name, kind, unit, times (ms), values, stimuli that its file has marks of (ms).
pub(crate) type Measured = (String, String, String, Vec<f64>, Vec<f64>, Vec<f64>);

/// A curve on its way to Python: as [`Measured`], with arrays.
type Given<'py> = (
    String,
    &'static str,
    &'static str,
    Bound<'py, PyArray1<f64>>,
    Bound<'py, PyArray1<f64>>,
    Vec<f64>,
);

/// Where calcium was read if it was asked for, its curves, the curve that was recorded together with it, and calcium at rest and at its
/// peak, uM.
type Recorded = (Option<PathBuf>, Vec<Measured>, Measured, [Option<f64>; 2]);

/// How a table is read, by name.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Reading {
    columns: Vec<String>,
    time: Option<String>,
    kind: Option<String>,
    unit: Option<String>,
    time_unit: Option<String>,
    frame_rate_per_s: Option<f64>,
    pixel_size_um: Option<f64>,
    sheets: Vec<String>,
    from_ms: Option<f64>,
    until_ms: Option<f64>,
    ignore_marks: bool,
    mean: bool,
    skip_gaps: bool,
}

impl Reading {
    /// As the library takes it.
    pub(crate) fn options(self) -> PyResult<TableOptions> {
        Ok(TableOptions {
            time: self.time.as_deref().map(Column::of),
            values: self.columns.iter().map(|name| Column::of(name)).collect(),
            kind: self.kind.as_deref().map(kind).transpose()?,
            unit: self.unit,
            time_unit: self.time_unit,
            frame_rate_per_s: self.frame_rate_per_s,
            pixel_size_um: self.pixel_size_um,
            sheets: self.sheets.iter().map(|name| Column::of(name)).collect(),
            from_ms: self.from_ms,
            until_ms: self.until_ms,
            ignore_marks: self.ignore_marks,
            mean: self.mean,
            skip_gaps: self.skip_gaps,
            ..TableOptions::default()
        })
    }
}

/// What is sought, by name.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    free: Vec<String>,
    fix: Vec<String>,
    bounds: Vec<(String, (f64, f64))>,
    starts: usize,
    seed: u64,
    peak_shortening_pct: Option<f64>,
    stimulus_times_ms: Option<Vec<f64>>,
}

impl Asked {
    fn sought(&self) -> FitOptions {
        let Self { free, fix, bounds, starts, seed, peak_shortening_pct, .. } = self;
        let bounds = bounds.iter().map(|(name, (low, high))| (name.clone(), [*low, *high]));
        let (free, fix, bounds) = (free.clone(), fix.clone(), bounds.collect());
        let peak_shortening_pct = *peak_shortening_pct;
        FitOptions { free, fix, bounds, starts: *starts, seed: *seed, peak_shortening_pct }
    }

    fn beats(&self) -> BeatOptions {
        let stimuli_ms = self.stimulus_times_ms.clone().unwrap_or_default();
        BeatOptions { stimuli_ms, ..BeatOptions::default() }
    }
}

/// One cell, ready to be fitted.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct Fitter {
    cell: FittableCell,
    /// What was assumed of recorded calcium.
    #[pyo3(get)]
    notes: Vec<String>,
    stop: Arc<AtomicBool>,
}

/// The curves of a table that are fitted, and what was taken for granted of them.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
pub(crate) fn read_curves(
    py: Python<'_>,
    path: PathBuf,
    reading: Reading,
) -> PyResult<(Vec<Given<'_>>, Vec<String>)> {
    let options = reading.options()?;
    let table = table(py, &path, &options)?;
    let (taken, notes) = of_table(table, &options);
    let notes = notes.iter().map(|note| words::in_python(note)).collect();
    Ok((taken.into_iter().map(|curve| given(py, curve)).collect(), notes))
}

/// The curves of calcium of a table.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
pub(crate) fn read_calcium(
    py: Python<'_>,
    path: PathBuf,
    reading: Reading,
) -> PyResult<Vec<Given<'_>>> {
    let table = table(py, &path, &reading.options()?)?;
    let calcium = table.curves.into_iter().filter(|it| it.kind.family() == Family::Calcium);
    Ok(calcium.map(|curve| given(py, curve)).collect())
}

fn table(py: Python<'_>, path: &Path, options: &TableOptions) -> PyResult<Table> {
    let name = path.display().to_string();
    let table = interruptible(py, |_interruption| match files::read(path) {
        Ok(bytes) => measured::read_bytes(&name, &bytes, options),
        Err(cause) => Err(ReadError::Read { path: name.clone(), cause }),
    })?;
    table.map_err(|error| errors::of_measured(&error))
}

fn given(py: Python<'_>, curve: Curve) -> Given<'_> {
    let [times, values] = [curve.times_ms, curve.values].map(|all| PyArray1::from_vec(py, all));
    (curve.name, curve.kind.word(), curve.unit, times, values, curve.stimuli_ms)
}

/// Tables of forces on gels of these moduli (kPa; `None`: that of the settings), and the relative error of their scale.
type Forces = (Vec<(Option<f64>, Vec<Measured>)>, f64);

#[pymethods]
impl Fitter {
    /// Of a cell; `given` are settings by key, `loaded` curves of it between springs of known stiffness (nN/um), `traction` tables of its
    /// force on gels of these moduli (kPa; `None`: its own), with the error of their scale.
    #[new]
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn new(
        py: Python<'_>,
        cell: &Cell,
        given: &Bound<'_, PyDict>,
        asked: Asked,
        loaded: Vec<(f64, Measured)>,
        traction: Forces,
        calcium: Option<Recorded>,
    ) -> PyResult<Self> {
        const MODEL: &str = "cell.model";
        let mut file = cell.0.file.clone();
        let mut settings = settings::list(given)?;
        let seeks_tension = seeks_tension(&mut settings);
        settings::put_all(py, &mut file, settings)?;
        let failed = |error: ExperimentError| errors::of_experiment(&error);
        let models = if seeks_tension {
            Models::Tension
        } else if file.has(MODEL) {
            Models::OfRun
        } else {
            let resolve = |name: &str| {
                let mut file = file.clone();
                let run = file.set(MODEL, name).and_then(|()| file.resolve());
                run.map_err(|error| ExperimentError::of_run_file(&error, None))
            };
            Models::all(resolve, |path| cell.0.read(path)).map_err(failed)?
        };
        if let Some(first) = models.first() {
            file.set(MODEL, first).map_err(|error| errors::of_settings(py, &error))?;
        }
        let (run, made) = beat::make(py, &cell.0, &file)?;
        let beats = asked.beats();
        let between = |(stiffness, curve): (f64, Measured)| {
            between_springs(stiffness, &self::curve(curve)?, &beats).map_err(failed)
        };
        let mut loaded = loaded.into_iter().map(between).collect::<PyResult<Vec<Loaded>>>()?;
        let (mut driving, mut notes) = (None, Vec::new());
        let (forces, error) = traction;
        let scale_error = scale_error(Some(error)).map_err(failed)?;
        for (modulus, curves) in forces {
            let curves = curves.into_iter().map(self::curve).collect::<PyResult<Vec<_>>>()?;
            let (found, note) = on_gel(&curves, (run.support, modulus), &beats).map_err(failed)?;
            loaded.push(Loaded { scale_error, ..found });
            notes.push(note);
        }
        if let Some((path, recorded, curve, [rest_um, peak_um])) = calcium {
            let of = RecordedCalcium { path, rest_um, peak_um };
            let own = recorded.into_iter().map(self::curve).collect::<PyResult<Vec<_>>>()?;
            let curve = self::curve(curve)?;
            let curves = [(curve.name.clone(), Ok(curve))];
            let (found, more) = of.among(&own, &curves, &beats).map_err(failed)?;
            driving = found;
            notes.extend(more);
        }
        let notes = notes.iter().map(|note| words::in_python(note)).collect();
        let own = (beats.clone(), loaded, driving);
        let cell = FittableCell::new(run, made, models, &asked.sought(), own);
        Ok(Self { cell: cell.map_err(failed)?, notes, stop: Arc::default() })
    }

    /// Fits the cell to a curve: the fit (JSON), and the run file that repeats it.
    fn fit(
        &self,
        py: Python<'_>,
        curve: Measured,
        threads: Option<usize>,
        progress: Progress,
    ) -> PyResult<(String, String)> {
        let curve = self::curve(curve)?;
        let curves = [(curve.name.clone(), Ok(curve))];
        let found = experiment::watched_until(py, progress, Arc::clone(&self.stop), |watch| {
            self.cell.fit(&curves, &[], &Threads::new(threads)?, watch)
        })?;
        let found = found.map_err(|error| errors::of_experiment(&error))?;
        let found = found.into_iter().next().and_then(|cell| cell.found.ok());
        answer(&found.ok_or_else(|| errors::value("the fit came to no end"))?, |fit| {
            self.cell.fitted_run(fit)
        })
    }

    /// Ends the fits that are under way, and all later ones.
    fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }
}

/// A fit (JSON), and the run file that repeats it.
fn answer(
    found: &Fit,
    fitted: impl FnOnce(&Fit) -> Result<(Run, f64), ExperimentError>,
) -> PyResult<(String, String)> {
    let text = json::pretty(found).map_err(errors::value)?;
    let (run, spacing) = fitted(found).map_err(|error| errors::of_experiment(&error))?;
    Ok((text, run.settled(spacing, None).to_toml()))
}

/// The cell of a film, fitted.
#[pyclass(frozen, module = "myospring._native")]
pub(crate) struct FilmFit {
    fits: Fits,
    cell: Py<Cell>,
    files: Files,
}

/// Whether a file is a film rather than a table of curves.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
pub(crate) fn is_film(path: PathBuf) -> bool {
    !is_of_tables(&path)
}

/// Fits the cell of a film to its own motion; `given` are settings by key, `traction` files of its force on gels of these moduli, with
/// the error of their scale.
#[pyfunction]
#[allow(
    clippy::needless_pass_by_value,
    clippy::too_many_arguments,
    reason = "what Python hands over is owned; the layer in Python names it"
)]
pub(crate) fn fit_film(
    py: Python<'_>,
    film: PathBuf,
    given: &Bound<'_, PyDict>,
    reading: Reading,
    asked: Asked,
    traction: (Vec<(Option<f64>, PathBuf)>, f64),
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<FilmFit> {
    let (forces, error) = traction;
    let on = |(gel_modulus, path)| TractionCurve { gel_modulus, path };
    let fit = FitCell {
        traction: forces.into_iter().map(on).collect(),
        traction_error: Some(error),
        to: vec![film],
        settings: settings::list(given)?,
        table: reading.options()?,
        beats: asked.beats(),
        sought: asked.sought(),
        threads,
        ..FitCell::default()
    };
    let files = Files::default();
    let fits = experiment::run(py, &fit, &files, progress)?;
    let Some(film) = &fits.film else { return Err(errors::value("this is no film")) };
    let cell = Py::new(py, Cell::of_film(&film.followed, &files))?;
    Ok(FilmFit { fits, cell, files })
}

#[pymethods]
impl FilmFit {
    /// The cell of the film at rest.
    #[getter]
    fn cell(&self, py: Python<'_>) -> Py<Cell> {
        self.cell.clone_ref(py)
    }

    /// Name of the curve, the fit (JSON), and the run file that repeats it.
    #[getter]
    fn found(&self) -> PyResult<(String, String, String)> {
        let (cell, found) =
            self.fits.fitted().next().ok_or_else(|| errors::value("nothing was fitted"))?;
        let (text, run_file) = answer(found, |fit| {
            let (mut run, spacing) = self.fits.fitted_run(fit)?;
            if let Source::Picture(source) = &mut run.shape.source {
                REST.clone_into(&mut source.path);
            }
            Ok((run, spacing))
        })?;
        Ok((cell.name.clone(), text, run_file))
    }

    /// What was assumed, and what was odd.
    #[getter]
    fn notes(&self) -> Vec<String> {
        self.fits.notes.iter().map(|text| words::in_python(text)).collect()
    }

    /// Where the cell pulls.
    #[getter]
    fn tension_map(&self, py: Python<'_>) -> Option<TensionMap> {
        let map = self.fits.map.clone()?;
        Some(TensionMap { map, cell: self.cell.clone_ref(py), files: self.files.clone() })
    }

    /// How far the fitted shape is from the film's, in a sentence.
    #[getter]
    fn shapes(&self) -> Option<String> {
        self.fits.shapes.as_ref().map(Shapes::words)
    }

    /// Columns of `distances.csv`, an entry for each frame.
    fn distances<'py>(&self, py: Python<'py>) -> Columns<'py> {
        self.fits.shapes.iter().flat_map(|shapes| columns(py, shapes.table())).collect()
    }

    /// Where the masses of the fitted cell are in these frames, um, laid over the film: (frames, nodes, 2).
    fn laid_over<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let frames: Vec<_> = self.fits.shapes.iter().flat_map(|shapes| &shapes.film).collect();
        let nodes = frames.first().map_or(0, |frame| frame.positions_um[0].len());
        let one = |frame: &&FrameShape| {
            let [x, y] = &frame.positions_um;
            x.iter().zip(y).flat_map(|(x, y)| [*x, *y]).collect::<Vec<f64>>()
        };
        let flat: Vec<f64> = frames.iter().flat_map(one).collect();
        PyArray1::from_vec(py, flat).reshape([frames.len(), nodes, 2])
    }

    /// Writes what `myospring fit` writes; the folder.
    #[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
    fn save(&self, py: Python<'_>, folder: PathBuf, force: bool) -> PyResult<PathBuf> {
        experiment::save(py, &self.fits, &folder, force, &self.files)
    }
}

fn kind(word: &str) -> PyResult<Kind> {
    Kind::of_word(word).ok_or_else(|| {
        let words: Vec<&str> = Kind::ALL.iter().map(|kind| kind.word()).collect();
        errors::value(format!("`{word}` is no kind of curve; there are: {}", words.join(", ")))
    })
}

/// Units that curves may have; a name of theirs is what the library keeps.
const UNITS: [&str; 12] = ["um", "px", "%", "", "a.u.", "nN", "kPa", "uM", "mV", "1", "nm", "mm"];

/// A curve of arrays.
pub(crate) fn curve(curve: Measured) -> PyResult<Curve> {
    let (name, word, unit, times_ms, values, stimuli_ms) = curve;
    let Some(unit) = UNITS.into_iter().find(|known| *known == unit) else {
        let known = UNITS.map(|unit| format!("\"{unit}\"")).join(", ");
        return Err(errors::value(format!("`{unit}` is no unit of a curve; there are: {known}")));
    };
    if times_ms.len() != values.len() {
        let message = format!("`{name}` has {} times and {} values", times_ms.len(), values.len());
        return Err(errors::value(message));
    }
    if times_ms.iter().any(|time| !time.is_finite())
        || times_ms.windows(2).any(|pair| pair[1] <= pair[0])
    {
        return Err(errors::value(format!(
            "the times of `{name}` do not rise from frame to frame"
        )));
    }
    let lines = (1..=times_ms.len() as u64).collect();
    Ok(Curve { name, kind: kind(&word)?, unit, times_ms, values, lines, stimuli_ms })
}
