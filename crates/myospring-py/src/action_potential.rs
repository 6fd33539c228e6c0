//! A cell model alone: potential and tension without a mesh.

use crate::experiment::{Progress, watched};
use crate::{errors, settings};
use myospring::analysis::action_potential as analysis;
use myospring::analysis::s2::S1S2;
use myospring::cell::solve::solve_while;
use myospring::experiment::Observer as _;
use myospring::output::files;
use myospring::run_file::RunFile;
use myospring::settings::{Run, find};
use numpy::PyArray1;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// Between shapes that nobody records, ms: so long that there are few.
const SELDOM_MS: f64 = 5e4;

/// Follows a cell model; `given` are settings by key. Columns by name, and of each stimulus the metrics: name, value,
/// unit.
#[pyfunction]
#[allow(clippy::type_complexity, reason = "taken apart at once by the layer above")]
pub(crate) fn action_potential<'py>(
    py: Python<'py>,
    given: &Bound<'py, PyDict>,
    progress: Progress,
) -> PyResult<(
    Vec<(String, Bound<'py, PyArray1<f64>>)>,
    Vec<Vec<(&'static str, Option<f64>, &'static str)>>,
)> {
    let mut file = RunFile::default();
    settings::put(&mut file, given)?;
    // A cell alone exchanges nothing with a mesh, so that samples need not be a multiple of that interval.
    file.set("numerics.exchange_interval", "0.001 ms").map_err(errors::value)?;
    // And it records no shapes, however many there would be.
    if let Some(frames) = find("numerics.frame_interval") {
        let mut run = Run::default_run();
        if let (Some(output), Some(interval)) =
            (find("numerics.output_interval"), file.get("numerics.output_interval"))
        {
            output.set(&mut run, interval).map_err(|(_, problem)| errors::value(problem))?;
        }
        let whole = (SELDOM_MS / run.numerics.output_interval).floor().max(1.0);
        let interval = settings::number(frames, whole * run.numerics.output_interval);
        file.set(frames.key, interval).map_err(errors::value)?;
    }
    let run = file.resolve().map_err(|error| errors::of_settings(py, &error))?;
    let (cell, _warning) = run.driven(|path| files::read(path.as_ref())).map_err(errors::value)?;
    let solved = watched(py, progress, |watch| {
        let interval = run.numerics.output_interval;
        let (protocol, settings) = (run.protocol, run.cell_settings());
        let interruption = watch.interruption();
        watch.stage("ms", run.duration as u64);
        solve_while(&*cell, protocol, settings, run.duration, interval, |time_ms| {
            watch.reached(time_ms as u64);
            !interruption.is_requested()
        })
    })?;
    let trace = solved.map_err(errors::value)?;
    let times = &trace.time_ms;
    let stimuli = run.stimulus_times();
    // A cell whose calcium is given has none.
    let mut of_state = trace.potential;
    of_state.resize(times.len(), f64::NAN);
    let (potential, unit) = match &trace.membrane_potential_mv {
        Some(column) => (column, "mV"),
        None => (&of_state, ""),
    };
    let beats = stimuli.iter().enumerate().map(|(index, &stimulus)| {
        let start = if index == 0 { f64::NEG_INFINITY } else { stimulus };
        let end = stimuli.get(index + 1).copied().unwrap_or(f64::INFINITY);
        let first = times.partition_point(|time| *time < start);
        let last = times.partition_point(|time| *time < end);
        let s2 = run.s2_ms().filter(|s2_ms| *s2_ms == stimulus);
        let metrics = match s2.and_then(|s2_ms| S1S2::of(times, &stimuli, s2_ms)) {
            Some(pair) => pair.metrics(times, potential, unit),
            None => analysis::metrics(&times[first..last], &potential[first..last], stimulus, unit),
        };
        metrics.into_iter().map(|metric| (metric.name, metric.value, metric.unit)).collect()
    });
    let beats = beats.collect();
    let mut columns = vec![("t_ms".to_owned(), trace.time_ms)];
    columns.push(("potential".to_owned(), of_state));
    columns.extend(trace.membrane_potential_mv.map(|column| ("vm_mv".to_owned(), column)));
    columns.push(("tension".to_owned(), trace.tension));
    let names = trace.state_names.into_iter().chain(trace.output_names);
    columns.extend(names.zip(trace.states.into_iter().chain(trace.outputs)));
    let columns = columns.into_iter().map(|(name, column)| (name, PyArray1::from_vec(py, column)));
    Ok((columns.collect(), beats))
}
