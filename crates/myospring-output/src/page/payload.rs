//! What stands in the page as data; `page/src/payload.d.ts` says the same for the page.

use super::band::Band;
use super::cell::{self, CellData};
use super::curves::{self, Curves};
use super::fit::{self, FitData};
use super::given::{Difference, Page, PageError, PageRun, ParameterGroup};
use super::photograph::{self, PictureData};
use crate::json::JsonError;
use crate::report::Summary;
use myospring_core::analysis::beat::{self, Beat, Place};
use myospring_core::analysis::{Metric, Missing};
use serde::Serialize;

#[derive(Serialize)]
struct Payload<'a> {
    form: u32,
    title: &'a str,
    version: &'a str,
    colour: &'static str,
    warnings: &'a [String],
    differences: &'a [Difference],
    runs: Vec<Run<'a>>,
    fit: Option<FitData<'a>>,
}

#[derive(Serialize)]
#[allow(clippy::struct_field_names, reason = "the names are keys that the page reads")]
struct Run<'a> {
    label: &'a str,
    facts: &'a [String],
    stimuli_ms: Vec<f64>,
    missed_ms: Vec<f64>,
    curves: Curves,
    cell: CellData,
    metrics: Vec<MetricGroup<'a>>,
    parameters: &'a [ParameterGroup],
    warnings: &'a [String],
    about_model: Option<&'a str>,
    run_file: &'a str,
    citations: &'a str,
    picture: Option<PictureData>,
}

#[derive(Serialize)]
struct MetricGroup<'a> {
    name: &'static str,
    rows: Vec<MetricRow<'a>>,
}

#[derive(Serialize)]
struct MetricRow<'a> {
    name: &'a str,
    value: Option<f64>,
    missing: Option<&'static str>,
    spread: Option<f64>,
    unit: &'a str,
    definition: &'a str,
    band: Option<Band>,
    place: Option<Place>,
}

/// The data of a page as JSON.
pub(super) fn json(page: &Page<'_>) -> Result<String, PageError> {
    if page.runs.is_empty() {
        return Err(PageError::NoRuns);
    }
    // All runs together are one file.
    let share = page.runs.len();
    let runs = page.runs.iter().map(|run| of_run(run, share)).collect::<Result<_, _>>()?;
    let colour = page.colour.word();
    let Page { title, version, warnings, differences, .. } = *page;
    let fit = page.fit.as_ref().map(fit::of);
    let payload = Payload { form: 1, title, version, colour, warnings, differences, runs, fit };
    Ok(serde_json::to_string(&payload).map_err(JsonError::from)?)
}

fn of_run<'a>(run: &'a PageRun<'_>, share: usize) -> Result<Run<'a>, PageError> {
    let picture = run.picture.as_ref();
    let missed = run.summary.beats.iter().filter(|beat| beat.is_missed());
    let missed: Vec<f64> = missed.map(|beat| beat.stimulus_ms).collect();
    let stimuli = run.stimulus_times_ms.iter().copied().filter(|time| !missed.contains(time));
    Ok(Run {
        label: run.label,
        facts: &run.facts,
        stimuli_ms: stimuli.collect(),
        missed_ms: missed,
        curves: curves::of(run.recording),
        cell: cell::of(run, share)?,
        metrics: metrics(run.summary),
        parameters: &run.parameters,
        warnings: &run.summary.warnings,
        about_model: run.summary.about_model.as_deref(),
        run_file: run.run_file,
        citations: run.citations,
        picture: picture.map(|it| photograph::of(it, run.outline)).transpose()?.flatten(),
    })
}

/// The metrics of the first beat that counts, or, of several, their means.
fn metrics(summary: &Summary) -> Vec<MetricGroup<'_>> {
    let loaded = summary.beats.first().is_some_and(|beat| !beat.load.is_empty());
    let row = |metric: &'_ Metric| {
        let over_beats = summary.beat_to_beat.iter().find(|spread| spread.name == metric.name);
        let value = over_beats.map(|spread| spread.mean).or(metric.value);
        // What is known is of unloaded cells.
        let band = beat::band(metric.name).filter(|_| !loaded);
        MetricRow {
            name: metric.name,
            value,
            missing: value.is_none().then(|| metric.missing.map(Missing::words)).flatten(),
            spread: over_beats.map(|spread| spread.standard_deviation),
            unit: metric.unit,
            definition: metric.definition,
            band: band.map(Band::of),
            place: band.zip(value).map(|(band, value)| band.place(value)),
        }
    };
    let group =
        |name, metrics: &[Metric]| MetricGroup { name, rows: metrics.iter().map(row).collect() };
    let of_beat = |beat: &Beat| {
        [
            group("Shortening", &beat.contraction),
            group("Tension", &beat.tension),
            group("Shape at the peak of shortening", &beat.shape),
            group("Action potential", &beat.action_potential),
        ]
    };
    let mut groups: Vec<MetricGroup<'_>> =
        summary.usual().map(of_beat).into_iter().flatten().collect();
    groups.extend(summary.s2().map(|beat| group("Extra stimulus, S2", &beat.s2)));
    groups.push(group("Energy over the run", &summary.energy));
    groups
}
