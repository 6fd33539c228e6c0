//! Cells of ToR-ORd without a mesh: side by side, with the metrics of their potential, calcium and tension.

use super::super::{Cause, Interrupted};
use super::description::{Varied, Which, run_of};
use super::member::{Variation, VariationRow};
use super::tor_ord::tor_ord;
use super::traces::TraceAxes;
use crate::analysis::rows::Context;
use crate::analysis::{action_potential, pulse, tension, trace, value};
use crate::cell::beside::{Cell, Outcome, Sampled, Settings, run_while};
use crate::cell::pacing::Protocol;
use crate::run_file::RunFile;

/// A sample and its time, ms.
type Timed = (f64, Sampled);

/// Time before a later stimulus over which its rest is taken, ms.
const BASELINE_MS: f64 = 20.0;

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
    goes_on: &dyn Fn() -> bool,
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
    let outcomes = match run_while(&cells, &settings, goes_on) {
        Ok(Some(outcomes)) => outcomes,
        Ok(None) => return members.iter().map(|_| Err(Interrupted.into())).collect(),
        Err(error) => return members.iter().map(|_| Err(error.clone().into())).collect(),
    };
    let mut outcomes = outcomes.into_iter();
    let row = |(member, task): (&&Variation, Result<(Cell, Protocol), Cause>)| {
        let (_, protocol) = task?;
        let Outcome { samples, .. } = outcomes.next().ok_or("a cell without an outcome")??;
        let beats = beats(&samples, interval_ms, &protocol);
        let of = |name: &String| match common.beat {
            Which::First => beats.first()?.value(name),
            Which::Last => beats.last()?.value(name),
            Which::Mean => {
                let values: Vec<f64> = beats.iter().filter_map(|beat| beat.value(name)).collect();
                (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
            }
        };
        let metrics = common.metrics.iter().map(of).collect();
        let curves = common.axes.map_or_else(Vec::new, |axes| {
            let timed: Vec<Timed> = timed(&samples, interval_ms).collect();
            let quantities: [fn(&Timed) -> f64; 3] =
                [|(_, it)| it.potential_mv, |(_, it)| it.calcium_um, |(_, it)| it.tension_kpa];
            axes.resampled(&timed, |(t_ms, _)| *t_ms, &quantities[..axes.quantities.len()])
        });
        Ok((VariationRow::done(member.number, metrics), curves))
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

/// A beat by what was sampled of it.
struct Beat {
    stimulus_ms: f64,
    times: Vec<f64>,
    samples: Vec<Sampled>,
}

/// The beats of a cell; each ends at the next stimulus.
fn beats(samples: &[Sampled], interval_ms: f64, protocol: &Protocol) -> Vec<Beat> {
    let stimuli: Vec<f64> = protocol.stimulus_times().collect();
    let last_ms = samples.len() as f64 * interval_ms;
    let beat = |(index, &stimulus_ms): (usize, &f64)| {
        let start = if index == 0 { f64::NEG_INFINITY } else { stimulus_ms - BASELINE_MS };
        let end = stimuli.get(index + 1).copied().unwrap_or(f64::INFINITY);
        let within = |(t, _): &Timed| (start..end).contains(t);
        let (times, samples) = timed(samples, interval_ms).filter(within).unzip();
        Beat { stimulus_ms, times, samples }
    };
    stimuli.iter().enumerate().filter(|(_, start)| **start < last_ms).map(beat).collect()
}

impl Beat {
    fn column(&self, read: fn(&Sampled) -> f64) -> Vec<f64> {
        self.samples.iter().map(read).collect()
    }

    /// A metric by its name.
    fn value(&self, name: &str) -> Option<f64> {
        let Self { stimulus_ms, ref times, .. } = *self;
        let of_tension = || {
            let column = self.column(|sample| sample.tension_kpa);
            let rest = trace::baseline(times, &column, stimulus_ms).unwrap_or_default();
            let heights: Vec<f64> = column.iter().map(|tension| tension - rest).collect();
            let pulse = pulse::Pulse::new(times, &heights, stimulus_ms, pulse::Top::Vertex);
            let context = Context { stimulus: Some(stimulus_ms), onset: None, rest: "" };
            tension::of_pulse(&pulse, rest, "kPa", &context)
        };
        let calcium = || self.column(|sample| sample.calcium_um);
        match name {
            "peak_tension" | "time_to_peak_tension" => value(&of_tension(), name),
            "diastolic_level" => trace::baseline(times, &calcium(), stimulus_ms),
            "systolic_level" => Some(trace::peak(times, &calcium())?.value),
            _ => {
                let potential = self.column(|sample| sample.potential_mv);
                let metrics = action_potential::metrics(times, &potential, stimulus_ms, "mV");
                value(&metrics, name)
            }
        }
    }
}
