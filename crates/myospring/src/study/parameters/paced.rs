//! Cells of ToR-ORd without a mesh: side by side, with the metrics of their potential, calcium and tension.

use super::super::{Cause, Interrupted};
use super::course::Course;
use super::description::{Varied, Which, run_of};
use super::member::{Variation, VariationRow};
use super::tor_ord::tor_ord;
use super::traces::TraceAxes;
use crate::cell::beside::{Cell, Outcome, Sampled, Settings, run_while};
use crate::cell::pacing::Protocol;
use crate::interruption::Interruption;
use crate::run_file::RunFile;

/// A sample and its time, ms.
type Timed = (f64, Sampled);

/// What all members have in common, and what is wanted of each.
pub(super) struct Wanted<'a> {
    pub(super) run: &'a RunFile,
    pub(super) varied: &'a [Varied],
    pub(super) metrics: &'a [String],
    pub(super) beat: Which,
    pub(super) axes: Option<&'a TraceAxes>,
}

/// Some members, whose cells go side by side: their rows, and their curves where they are wanted.
pub(super) fn cells(
    common: &Wanted<'_>,
    members: &[&Variation],
    interruption: &Interruption,
) -> Vec<Result<(VariationRow, Vec<f32>), Cause>> {
    let run = match common.run.resolve() {
        Ok(run) => run,
        Err(error) => return members.iter().map(|_| Err(error.to_string().into())).collect(),
    };
    let interval_ms = run.numerics.output_interval;
    let settings =
        Settings { tolerance: run.numerics.cell.tolerance, sample_interval_ms: interval_ms };
    let tasks: Vec<Result<(Cell, Protocol), Cause>> =
        members.iter().map(|member| cell(common, member)).collect();
    let cells: Vec<Cell> = tasks.iter().flatten().map(|(cell, _)| cell.clone()).collect();
    let outcomes = match run_while(&cells, &settings, &|| !interruption.is_asked()) {
        Ok(Some(outcomes)) => outcomes,
        Ok(None) => return members.iter().map(|_| Err(Interrupted.into())).collect(),
        Err(error) => return members.iter().map(|_| Err(error.clone().into())).collect(),
    };
    let mut outcomes = outcomes.into_iter();
    let row = |(member, task): (&&Variation, Result<(Cell, Protocol), Cause>)| {
        let (_, protocol) = task?;
        let Outcome { samples, .. } = outcomes.next().ok_or("a cell without an outcome")??;
        let course = course(&samples, interval_ms);
        let metrics = course.metrics(&protocol, common.beat, common.metrics);
        let curves = common.axes.map_or_else(Vec::new, |axes| {
            let timed: Vec<Timed> = timed(&samples, interval_ms).collect();
            let quantities: [fn(&Timed) -> f64; 3] =
                [|(_, it)| it.potential_mv, |(_, it)| it.calcium_um, |(_, it)| it.tension_kpa];
            axes.resampled(&timed, |(t_ms, _)| *t_ms, &quantities[..axes.quantities.len()])
        });
        let row = VariationRow::done(member.number, metrics);
        Ok((row.noting(course.no_capture(&protocol)), curves))
    };
    members.iter().zip(tasks).map(row).collect()
}

/// A member's cell, and how it is paced.
fn cell(common: &Wanted<'_>, member: &Variation) -> Result<(Cell, Protocol), Cause> {
    let run = run_of(common.run, common.varied, &member.values)?.resolve()?;
    let model = tor_ord(&run).ok_or("the model is not ToR-ORd")?;
    Ok((Cell::new(model, run.protocol, run.duration)?, run.protocol))
}

fn timed(samples: &[Sampled], interval_ms: f64) -> impl Iterator<Item = Timed> {
    samples.iter().enumerate().map(move |(index, sample)| (index as f64 * interval_ms, *sample))
}

fn course(samples: &[Sampled], interval_ms: f64) -> Course {
    let column = |read: fn(&Sampled) -> f64| samples.iter().map(read).collect();
    Course {
        times: timed(samples, interval_ms).map(|(t_ms, _)| t_ms).collect(),
        potential: column(|sample| sample.potential_mv),
        unit: "mV",
        tension: column(|sample| sample.tension_kpa),
        calcium: column(|sample| sample.calcium_um),
    }
}
