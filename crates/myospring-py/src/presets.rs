//! Published experiments to start from, and beats that were saved.

use crate::beat::{self, Beat};
use crate::cell::Cell;
use crate::experiment::Progress;
use crate::settings::{is_of_cell, put};
use crate::{errors, words};
use myospring::experiment::compare::check_results;
use myospring::experiment::{ExperimentError, Files, input};
use myospring::interruption::Interruption;
use myospring::output::{csv, frames};
use myospring::run_file::{PRESETS, RunFile};
use myospring::settings::table;
use myospring::simulation::Outcome;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Name of each preset, what it is, and its run file.
#[pyfunction]
pub(crate) fn presets() -> Vec<(&'static str, &'static str, &'static str)> {
    PRESETS.iter().map(|preset| (preset.name, preset.about, preset.text)).collect()
}

/// The cell of a preset.
#[pyfunction]
pub(crate) fn preset_cell(py: Python<'_>, name: &str) -> PyResult<Cell> {
    Cell::made(py, of_cell(preset(py, name)?), BTreeMap::new())
}

/// Beats a cell as a preset says; `given` are settings by key instead of its own.
#[pyfunction]
pub(crate) fn simulate_preset(
    py: Python<'_>,
    name: &str,
    cell: &Cell,
    given: &Bound<'_, PyDict>,
    threads: Option<usize>,
    progress: Progress,
) -> PyResult<Beat> {
    let (mut file, preset) = (cell.0.file.clone(), preset(py, name)?);
    for setting in table().filter(|setting| !is_of_cell(setting)) {
        if let Some(value) = preset.get(setting.key) {
            let set = file.set(setting.key, value.clone());
            set.map_err(|error| errors::of_settings(py, &error))?;
        }
    }
    put(&mut file, given)?;
    beat::beat(py, cell, file, threads, progress)
}

fn preset(py: Python<'_>, name: &str) -> PyResult<RunFile> {
    let Some(preset) = PRESETS.iter().find(|preset| preset.name == name) else {
        return Err(errors::unknown_among(py, name, PRESETS.iter().map(|preset| preset.name)));
    };
    RunFile::from_text(preset.text).map_err(|error| errors::of_settings(py, &error))
}

/// The settings that make the cell.
fn of_cell(mut file: RunFile) -> RunFile {
    table().filter(|setting| !is_of_cell(setting)).for_each(|setting| file.remove(setting.key));
    file
}

/// The cell and the beat of a folder that `myospring run` has written.
#[pyfunction]
#[allow(clippy::needless_pass_by_value, reason = "what Python hands over is owned")]
pub(crate) fn load(py: Python<'_>, folder: PathBuf) -> PyResult<(Cell, Beat)> {
    let files = Files::default();
    let failed = |error: ExperimentError| errors::of_experiment(&error);
    check_results(&folder, &files).map_err(failed)?;
    let run_file = folder.join("run.toml");
    let (_, run) =
        input::settle(Some(&run_file), &[], &files, &Interruption::default()).map_err(failed)?;
    let file = run.to_run_file();
    let cell = Cell::made(py, of_cell(file.clone()), BTreeMap::new())?;
    let traces = folder.join("traces.csv");
    let text = files.text(&traces).map_err(failed)?;
    let mut recording = csv::read_traces(&text)
        .map_err(|error| errors::value(format!("`{}`: {error}", traces.display())))?;
    let (run, made) = beat::make(py, &cell.0, &file)?;
    let kept = files.bytes(folder.join("frames.npz")).ok().and_then(|it| frames::read(&it).ok()?);
    if let Some(kept) = kept.filter(|it| it.mesh.points == made.simulation.mesh.points) {
        recording.frames = kept.frames;
    }
    let record = json(&folder.join("run.json"))?;
    let part = |name: &str| record[name].clone();
    let outcome = Outcome {
        recording,
        stop: serde_json::from_value(part("stop")).unwrap_or_default(),
        // It stands among the other numbers of the record.
        effort: serde_json::from_value(record.clone()).map_err(errors::value)?,
        engine: serde_json::from_value(part("engine")).unwrap_or_default(),
        stimulus_times_ms: run.stimulus_times(),
        s2_ms: run.s2_ms(),
    };
    let said = json(&folder.join("summary.json"))?;
    let said = said["warnings"].as_array().into_iter().flatten();
    let warnings = said.filter_map(|text| Some(words::in_python(text.as_str()?))).collect();
    let beat = Beat::kept(&cell.0, file, run, made, outcome, warnings);
    Ok((cell, beat))
}

fn json(path: &Path) -> PyResult<serde_json::Value> {
    let failed =
        |error: &std::io::Error| errors::of_experiment(&ExperimentError::unread(path, error));
    let text = std::fs::read_to_string(path).map_err(|error| failed(&error))?;
    serde_json::from_str(&text)
        .map_err(|error| errors::value(format!("`{}`: {error}", path.display())))
}
