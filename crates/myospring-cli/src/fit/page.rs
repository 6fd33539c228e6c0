//! `report.html` of a fit: the page of a run, with the fitted cell, beside the curve that it was fitted to.

use super::files::{Cell, Context, drawn, profiles};
use super::words;
use crate::failure::Failure;
use myospring::cell::CellModel;
use myospring::experiment::Inputs;
use myospring::experiment::citations;
use myospring::experiment::run::parameters;
use myospring::fit::{Estimate, Fit, FitVerdict, Unknown};
use myospring::output::field::Field;
use myospring::output::figure::FittedCurve;
use myospring::output::page::{
    self, Answer, Cell as Entry, Chart, Drawing, Mark, Page, PageRun, Part, Quality, Runs, Section,
    Tile,
};
use myospring::output::report::Summary;
use myospring::settings::Run;
use myospring::simulation::{Outcome, SetupError, SharedPath, Simulation};

/// The beat of a fitted cell.
pub(super) fn beaten(
    simulation: &Simulation,
    shared: Option<&SharedPath>,
) -> Result<Outcome, SetupError> {
    // The path of equilibria is that of all cells, unless stiffness was fitted, too.
    if let Some(ready) = shared.and_then(|shared| shared.prepare(simulation).ok()) {
        return Ok(ready.run(|_progress| true));
    }
    Ok(simulation.build()?.run(|_progress| true))
}

/// The page of a cell that was fitted.
pub(super) fn html(
    cell: &Cell,
    fit: &Fit,
    context: &Context<'_>,
    run: &Run,
    (run_file, inputs): (&str, &Inputs),
    (simulation, outcome): (&Simulation, &Outcome),
) -> Result<String, Failure> {
    let model = &*run.cell;
    let report = context.report.clone();
    let summary =
        Summary::new(&outcome.recording, &outcome.stimulus_times_ms, None, report, Vec::new())
            .with_pace(&simulation.pace(&outcome.beats()));
    let citations = citations::bibtex(model);
    let title = format!("Fit of {}", cell.name);
    let frames: usize = fit.curves.iter().map(|curve| curve.times_ms.len()).sum();
    let facts = vec![context.name.to_owned(), model.name().to_owned(), format!("{frames} frames")];
    let shown = PageRun {
        label: "fitted",
        summary: &summary,
        recording: &outcome.recording,
        mesh: &simulation.mesh,
        fibres: &simulation.fibres,
        myofibril_content: simulation.myofibril_content.as_deref(),
        outline: context.outline,
        stimulus_times_ms: &outcome.stimulus_times_ms,
        parameters: parameters(run, inputs),
        run_file,
        citations: &citations,
        picture: None,
    };
    let runs = Runs { runs: vec![shown], differences: &[] };
    let start = outcome.stimulus_times_ms.first().copied().unwrap_or_default();
    let several = fit.curves.len() > 1;
    let charts = drawn(fit).into_iter().map(|curve| from_stimulus(curve, start));
    let charts = charts.flat_map(|curve| Chart::of_fit(&curve, several)).collect();
    let mut sections =
        vec![numbers(fit, model), runs.beat(Field::default(), charts), certainty(fit, context)];
    sections.extend(figures(context));
    sections.extend(runs.record());
    let quality = match fit.verdict {
        FitVerdict::Fits => Quality::Good,
        FitVerdict::FitsNearly => Quality::Fair,
        FitVerdict::DoesNotFit => Quality::Poor,
    };
    let page = Page {
        kind: "A fit by Myospring, and the beat of the fitted cell",
        title: &title,
        facts,
        answer: Some(Answer { words: words::headline(fit), quality }),
        warnings: fit.verdicts.iter().cloned().chain(runs.warnings()).collect(),
        sections,
    };
    Ok(page::html(&page)?)
}

/// The numbers that were fitted, with their intervals.
fn numbers(fit: &Fit, model: &dyn CellModel) -> Section<'static> {
    let tiles = fit.estimates.iter().zip(words::table(fit));
    let tiles = tiles.map(|(estimate, [name, value, interval, verdict])| {
        // Of a model that does not fit the verdict says it.
        let has_interval = fit.verdict != FitVerdict::DoesNotFit && !interval.is_empty();
        let interval = has_interval.then(|| Entry::text(format!("95 %: {interval}")));
        let mark = Mark::new(verdict == "determined", verdict);
        Tile {
            definition: meaning(estimate, model),
            lines: interval.into_iter().chain([Entry::text("").marked(Some(mark))]).collect(),
            ..Tile::new(name.replace('_', " "), Entry::text(value))
        }
    });
    Section::new("key", "Fitted numbers", vec![Part::Tiles(tiles.collect())])
}

/// How well the numbers are determined.
fn certainty(fit: &Fit, context: &Context<'_>) -> Section<'static> {
    let mut notes: Vec<String> = fit.curves.iter().map(words::left).collect();
    notes.extend(context.notes.iter().cloned());
    let profiles = profiles(fit);
    let hint = match profiles.len() {
        0 => "",
        _ => {
            "Rise of chi squared when one number is held and the others are fitted again; the 95 % interval ends where it \
             reaches the dashed line. The green dot is the fitted value. A model that does not fit has no intervals."
        }
    };
    Section {
        id: "fit",
        title: "How sure the fitted numbers are".to_owned(),
        hint: hint.to_owned(),
        parts: vec![Part::Profiles(profiles), Part::Words(notes)],
    }
}

/// What a number is.
fn meaning(estimate: &Estimate, model: &dyn CellModel) -> String {
    match &estimate.unknown {
        Some(Unknown::TensionOverStiffness) => {
            "peak of the active tension over Young's modulus: a free cell shortens by about as much"
                .to_owned()
        }
        Some(Unknown::YoungModulus) => "Young's modulus of the cell along its fibres".to_owned(),
        Some(Unknown::Parameter(name)) => {
            let rows = model.parameters().rows();
            rows.iter()
                .find(|row| row.name == *name)
                .map_or_else(String::new, |row| row.meaning.to_string())
        }
        None => "of the recording, not of the cell".to_owned(),
    }
}

/// A curve whose first stimulus falls when that of the run does.
fn from_stimulus(curve: FittedCurve, start: f64) -> FittedCurve {
    let by = start - curve.stimuli_ms.first().copied().unwrap_or(start);
    let moved = |times: Vec<f64>| times.into_iter().map(|time| time + by).collect();
    FittedCurve { times_ms: moved(curve.times_ms), stimuli_ms: moved(curve.stimuli_ms), ..curve }
}

/// The figures of a film.
fn figures(context: &Context<'_>) -> Vec<Section<'static>> {
    let shapes = context.shapes.and_then(|it| {
        let words = format!("{}.", it.words());
        let drawing = Drawing::new(&it.figure().ok()?, &words).ok()?;
        let parts = vec![Part::Figure(drawing), Part::Words(vec![words])];
        Some(Section::new("shapes", "The film and the fitted cell", parts))
    });
    let map = context.mapped.and_then(|it| {
        let words = format!("{}.", it.words());
        let drawing = Drawing::new(&it.figure().ok()?, &words).ok()?;
        let notes = it.verdicts().to_vec();
        let parts = vec![Part::Figure(drawing), Part::Words(vec![words]), Part::Words(notes)];
        Some(Section::new("map", "Where the cell pulls", parts))
    });
    shapes.into_iter().chain(map).collect()
}
