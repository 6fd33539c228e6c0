//! `report.html` of a fit: the page of a run, with the fitted cell, beside the curve that it was fitted to.

use super::files::{Cell, Context, drawn, profiles};
use super::words;
use crate::cite;
use crate::failure::Failure;
use crate::page::parameters;
use myospring::cell::CellModel;
use myospring::experiment::Inputs;
use myospring::fit::{Estimate, Fit, FitVerdict, Unknown};
use myospring::output::field::Field;
use myospring::output::figure::{Figure, FigureError, FittedCurve};
use myospring::output::page::{self, FittedNumber, Page, PageFigure, PageFit, PageRun};
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
    let citations = cite::bibtex(model);
    let title = format!("Fit of {}", cell.name);
    let frames: usize = fit.curves.iter().map(|curve| curve.times_ms.len()).sum();
    let facts = vec![context.name.to_owned(), model.name().to_owned(), format!("{frames} frames")];
    let shown = PageRun {
        label: "fitted",
        facts,
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
    let estimates: Vec<FittedNumber> = fit
        .estimates
        .iter()
        .zip(words::table(fit))
        .map(|(estimate, [name, value, interval, verdict])| {
            let meaning = meaning(estimate, model);
            // The verdict says it.
            let interval =
                if fit.verdict == FitVerdict::DoesNotFit { String::new() } else { interval };
            FittedNumber { name: name.replace('_', " "), meaning, value, interval, verdict }
        })
        .collect();
    let start = outcome.stimulus_times_ms.first().copied().unwrap_or_default();
    let curves: Vec<FittedCurve> =
        drawn(fit).into_iter().map(|curve| from_stimulus(curve, start)).collect();
    let mut notes: Vec<String> = fit.curves.iter().map(words::left).collect();
    notes.extend(context.notes.iter().cloned());
    let (profiles, headline) = (profiles(fit), words::headline(fit));
    let page = Page {
        title: &title,
        version: env!("CARGO_PKG_VERSION"),
        colour: Field::default(),
        warnings: &fit.verdicts,
        differences: &[],
        runs: &[shown],
        fit: Some(PageFit {
            verdict: fit.verdict.word(),
            headline: &headline,
            estimates: &estimates,
            curves: &curves,
            profiles: &profiles,
            notes: &notes,
            figures: figures(context),
        }),
    };
    Ok(page::html(&page)?)
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

/// Those of a film.
fn figures<'a>(context: &'a Context<'_>) -> Vec<PageFigure<'a>> {
    let one = |title, figure: Result<Figure, FigureError>, words: String, notes| {
        let words = format!("{words}.");
        figure.ok().map(|figure| PageFigure { title, figure, words, notes })
    };
    let shapes = context
        .shapes
        .and_then(|it| one("The film and the fitted cell", it.figure(), it.words(), &[][..]));
    let map = context
        .mapped
        .and_then(|it| one("Where the cell pulls", it.figure(), it.words(), it.verdicts()));
    shapes.into_iter().chain(map).collect()
}
