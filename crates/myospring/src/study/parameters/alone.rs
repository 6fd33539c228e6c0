//! Cells without a mesh, in batches if their model supports it, with the metrics of their
//! potential, calcium and tension.

use super::super::{Cause, Interrupted};
use super::cell_metrics::{FROM_BEATS, Timed, metric_of_beat, shown, unit};
use super::course;
use super::description::{CountedBeat, Varied, run_of};
use super::member::{Variation, VariationRow};
use super::traces::TraceAxes;
use crate::cell::TensionKind;
use crate::cell::batch::{self, BatchSettings, CellBeat, CellOutcome, CellSample, Paced};
use crate::cell::solve::SolveError;
use crate::run_file::RunFile;
use crate::settings::Run;
use std::collections::BTreeMap;
use std::io;

/// What all members have in common, and the requested metrics.
pub(super) struct Wanted<'a> {
    pub(super) run: &'a RunFile,
    pub(super) varied: &'a [Varied],
    pub(super) metrics: &'a [String],
    pub(super) beat: CountedBeat,
    pub(super) axes: Option<&'a TraceAxes>,
    /// The bytes of the files that cells need, by their names as written.
    pub(super) files: &'a BTreeMap<String, Vec<u8>>,
}

/// A member's cell.
struct Alone {
    cell: Paced,
    /// kPa per unit of its tension.
    scale: f64,
}

/// The rows of some members, and their curves if requested.
pub(super) fn cells(
    wanted: &Wanted<'_>,
    members: &[&Variation],
    goes_on: &dyn Fn() -> bool,
) -> Vec<Result<(VariationRow, Vec<f32>), Cause>> {
    let run = match wanted.run.resolve() {
        Ok(run) => run,
        Err(error) => return members.iter().map(|_| Err(error.to_string().into())).collect(),
    };
    let tasks: Vec<Result<Alone, Cause>> =
        members.iter().map(|member| alone(wanted, member)).collect();
    let cells: Vec<Paced> = tasks.iter().flatten().map(|alone| alone.cell.clone()).collect();
    let outcomes = match outcomes(wanted, &run, &cells, goes_on) {
        Ok(Some(outcomes)) => outcomes,
        Ok(None) => return members.iter().map(|_| Err(Interrupted.into())).collect(),
        Err(error) => return members.iter().map(|_| Err(error.clone().into())).collect(),
    };
    let mut outcomes = outcomes.into_iter();
    let row = |(member, task): (&&Variation, Result<Alone, Cause>)| {
        let alone = task?;
        let (outcome, interval_ms, by_beats) =
            outcomes.next().ok_or("a cell without an outcome")?;
        let outcome = outcome?;
        Ok(alone.row(wanted, member, &outcome, interval_ms, by_beats))
    };
    members.iter().zip(tasks).map(row).collect()
}

/// The outcome of a cell, the time between its samples, ms, and whether its beats suffice for the
/// metrics.
type TimedOutcome = (Result<CellOutcome, SolveError>, f64, bool);

/// The outcomes of cells; `None` if interrupted.
fn outcomes(
    wanted: &Wanted<'_>,
    run: &Run,
    cells: &[Paced],
    goes_on: &dyn Fn() -> bool,
) -> Result<Option<Vec<TimedOutcome>>, SolveError> {
    let (method, often) = (run.cell_settings(), run.numerics.output_interval);
    let follow = |cells: &[Paced], sample_interval_ms| {
        batch::run_while(cells, &BatchSettings { method, sample_interval_ms }, goes_on)
    };
    // The metrics of an S2 need the curves.
    let by_beats = batch::tells_beats(&*run.cell, method)
        && run.protocol.s2_interval_ms.is_none()
        && wanted.metrics.iter().all(|name| FROM_BEATS.contains(&&**name));
    if !by_beats {
        let outcomes = follow(cells, Some(often))?;
        let sampled = |outcome| (outcome, often, false);
        return Ok(outcomes.map(|all| all.into_iter().map(sampled).collect()));
    }
    let seldom = wanted.axes.map(|axes| axes.interval_ms);
    let Some(outcomes) = follow(cells, seldom)? else { return Ok(None) };
    // A beat continues through a stimulus that is not captured, which only its samples show.
    let suffice = |outcome: &Result<CellOutcome, SolveError>| {
        outcome.as_ref().map_or(true, |it| CellBeat::suffice(&it.beats, unit(&*run.cell)))
    };
    let again: Vec<Paced> = cells
        .iter()
        .zip(&outcomes)
        .filter(|(_, outcome)| !suffice(outcome))
        .map(|(cell, _)| cell.clone())
        .collect();
    let Some(sampled) = follow(&again, Some(often))? else { return Ok(None) };
    let mut sampled = sampled.into_iter();
    let checked = |outcome| {
        if suffice(&outcome) {
            return (outcome, seldom.unwrap_or(often), true);
        }
        (sampled.next().unwrap_or(outcome), often, false)
    };
    Ok(Some(outcomes.into_iter().map(checked).collect()))
}

/// A member's cell.
fn alone(wanted: &Wanted<'_>, member: &Variation) -> Result<Alone, Cause> {
    let run = run_of(wanted.run, wanted.varied, &member.values)?.resolve()?;
    let read =
        |path: &str| wanted.files.get(path).cloned().ok_or_else(|| io::ErrorKind::NotFound.into());
    let (model, _) = run.driven(read)?;
    let scale = match model.tension_kind() {
        TensionKind::Relative { published_peak } => run.peak_tension / published_peak,
        TensionKind::Kilopascal | TensionKind::None => 1.0,
    };
    Ok(Alone { cell: Paced::new(model, run.protocol, run.duration)?, scale })
}

impl Alone {
    fn row(
        &self,
        wanted: &Wanted<'_>,
        member: &Variation,
        outcome: &CellOutcome,
        interval_ms: f64,
        by_beats: bool,
    ) -> (VariationRow, Vec<f32>) {
        let model = &**self.cell.model();
        let in_kpa = |(k, it): (usize, &CellSample)| {
            (k as f64 * interval_ms, CellSample { tension: self.scale * it.tension, ..*it })
        };
        let timed: Vec<Timed> = outcome.samples.iter().enumerate().map(in_kpa).collect();
        let curves = wanted.axes.map_or_else(Vec::new, |axes| {
            let quantities: Vec<_> = shown(model).into_iter().map(|(_, read)| read).collect();
            axes.resampled(&timed, |(t_ms, _)| *t_ms, &quantities)
        });
        if by_beats {
            let metrics = wanted.metrics.iter();
            let metrics = metrics.map(|name| self.of_beats(&outcome.beats, wanted.beat, name));
            return (VariationRow::done(member.number, metrics.collect()), curves);
        }
        let beats = course::beats(model, self.cell.protocol(), &timed);
        let metrics = course::metrics(&beats, wanted.beat, wanted.metrics);
        let row = VariationRow::done(member.number, metrics);
        (row.noting(course::no_capture(&beats)), curves)
    }

    /// A metric of the beat that counts, or its mean over the beats.
    fn of_beats(&self, beats: &[CellBeat], which: CountedBeat, name: &str) -> Option<f64> {
        let value = |beat: &CellBeat| metric_of_beat(beat, name, self.scale);
        match which {
            CountedBeat::First => value(beats.first()?),
            CountedBeat::Last => value(beats.last()?),
            CountedBeat::Mean => {
                let values: Vec<f64> = beats.iter().filter_map(value).collect();
                (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
            }
        }
    }
}
