//! `report.html` of a fit: the page of a run, with the fitted cell, beside the curve that it was fitted to.

use super::outcome::{Fits, Shared};
use super::shapes::Shapes;
use super::{calcium, tables, words};
use crate::analysis::summary::Summary;
use crate::cell::CellModel;
use crate::experiment::analyse::figures::loops;
use crate::experiment::analyse::means_of;
use crate::experiment::run::{parameters, thick_cell};
use crate::experiment::tension_map::FilmMap;
use crate::experiment::{ExperimentError, citations};
use crate::fit::{Estimate, Fit, FitVerdict, OF_OWN_TENSION, Unknown};
use crate::output::field::Field;
use crate::output::figure::{DrawnFit, DrawnTension, Figure, FigureError};
use crate::output::page::{
    self, Answer, Chart, Column, Drawing, Page, PageRun, Part, Quality, Row, Runs, Section, Table,
    TableCell as Entry, Tile, VerdictMark,
};
use crate::settings::Run;
use crate::simulation::{Outcome, Simulation};

/// The page of a cell that was fitted.
pub(super) fn html(
    cell: &str,
    fit: &Fit,
    shared: &Shared<'_>,
    run: &Run,
    run_file: &str,
    (simulation, outcome): (&Simulation, &Outcome),
) -> Result<String, ExperimentError> {
    let Shared { fits, work, inputs, .. } = shared;
    let model = &*run.cell;
    let report = work.report.clone();
    let summary =
        Summary::new(&outcome.recording, &outcome.stimulus_times_ms, None, report, Vec::new())
            .with_about_model(simulation.pace(&outcome.beats()).about_model());
    let citations = citations::bibtex(model);
    let title = format!("Fit of {cell}");
    let frames: usize = fit.curves.iter().map(|curve| curve.times_ms.len()).sum();
    let facts = vec![fits.name.clone(), model.name().to_owned(), format!("{frames} frames")];
    let in_space = simulation.in_space();
    let shown = PageRun {
        label: "fitted",
        summary: &summary,
        recording: &outcome.recording,
        mesh: &simulation.mesh,
        fibres: &simulation.fibres,
        myofibril_content: simulation.myofibril_content.as_deref(),
        outline: &work.outline,
        stimulus_times_ms: &outcome.stimulus_times_ms,
        parameters: parameters(run, inputs),
        run_file,
        citations: &citations,
        picture: None,
        thick: thick_cell(simulation, &outcome.recording, in_space.as_ref()),
    };
    let runs = Runs { runs: vec![shown], differences: &[] };
    let start = outcome.stimulus_times_ms.first().copied().unwrap_or_default();
    let several = fit.curves.len() > 1;
    let charts = tables::drawn(fit).into_iter().map(|curve| from_stimulus(curve, start));
    let mut charts: Vec<Chart> = charts.flat_map(|curve| Chart::of_fit(&curve, several)).collect();
    if let Some(drawn) = tables::drawn_tension(fit) {
        let by = start - drawn.stimuli_ms.first().copied().unwrap_or(start);
        let moved = |times: Vec<f64>| times.into_iter().map(|time| time + by).collect();
        let (times_ms, stimuli_ms) = (moved(drawn.times_ms), moved(drawn.stimuli_ms));
        charts.insert(0, Chart::of_tension(&DrawnTension { times_ms, stimuli_ms, ..drawn }));
    }
    charts.extend(fits.shapes.iter().filter_map(Shapes::chart));
    let mut sections = vec![numbers(fit, model), runs.beat(Field::default(), charts)];
    sections.extend(fits.shapes.as_ref().and_then(laid_over));
    sections.push(certainty(fit, &fits.notes));
    sections.extend(models(fit));
    sections.extend(with_calcium(fit)?);
    sections.extend(figures(fits));
    sections.extend(runs.record());
    let quality = match fit.verdict {
        // No model follows the curve.
        _ if fit.own_tension.is_some() && !fit.tried.is_empty() => Quality::Fair,
        FitVerdict::Fits => Quality::Good,
        FitVerdict::FitsNearly => Quality::Fair,
        FitVerdict::DoesNotFit => Quality::Poor,
    };
    let page = Page {
        kind: "A fit by Myospring, and the beat of the fitted cell",
        title: &title,
        facts,
        answer: Some(Answer { words: words::headline(fit), quality }),
        // The headline says already what an own tension is.
        warnings: (fit.verdicts.iter().filter(|verdict| *verdict != OF_OWN_TENSION).cloned())
            .chain(runs.warnings())
            .collect(),
        sections,
    };
    Ok(page::html(&page)?)
}

/// The numbers that were fitted, with their intervals.
fn numbers(fit: &Fit, model: &dyn CellModel) -> Section<'static> {
    let tiles = fit.estimates.iter().zip(words::estimates(fit));
    let tiles = tiles.map(|(estimate, [name, value, interval, verdict])| {
        // Of a model that does not fit the verdict says it.
        let has_interval = fit.verdict != FitVerdict::DoesNotFit && !interval.is_empty();
        let interval = has_interval.then(|| Entry::text(format!("95 %: {interval}")));
        let mark = VerdictMark::new(verdict == "determined", verdict);
        Tile {
            definition: meaning(estimate, fit, model),
            lines: interval.into_iter().chain([Entry::text("").marked(Some(mark))]).collect(),
            ..Tile::new(name.replace('_', " "), Entry::text(value))
        }
    });
    Section::new("key", "Fitted numbers", vec![Part::Tiles(tiles.collect())])
}

/// The loop of the tension that the curve needs over the calcium that was recorded with it.
fn with_calcium(fit: &Fit) -> Result<Option<Section<'static>>, ExperimentError> {
    let Some((curves, pair)) = calcium::with_tension(fit) else { return Ok(None) };
    if pair.paired.mean_loop.is_none() {
        return Ok(None);
    }
    let words = "Calcium and the tension that the curve needs, over time and over each other";
    let figure = loops(&curves, &pair).map_err(ExperimentError::new)?;
    let figure = Drawing::new(&figure, words).map_err(ExperimentError::new)?;
    let rows = means_of(&pair.paired.counted()).into_iter().map(|mean| {
        let value = mean.in_words().unwrap_or_default();
        Row {
            cells: vec![
                Entry::term(page::metric_words(mean.name), mean.definition),
                Entry::text(value),
            ],
            ..Row::default()
        }
    });
    let columns = vec![Column::text("quantity"), Column::text("mean \u{b1} SD over beats")];
    let table = Table { columns, rows: rows.collect(), ..Table::default() };
    let parts = vec![Part::Figure(figure), Part::Table(table)];
    Ok(Some(Section::new("calcium", "Tension over calcium", parts)))
}

/// What each model that was tried leaves of the curve.
fn models(fit: &Fit) -> Option<Section<'static>> {
    let columns = words::TRIED.map(Column::text);
    let rows: Vec<Row> = words::tried(fit)
        .into_iter()
        .map(|row| Row { cells: row.map(Entry::text).into(), ..Row::default() })
        .collect();
    let table = Table { columns: columns.into(), rows, ..Table::default() };
    let hint = "The model with the lowest BIC is taken among those that fit, or fit nearly; if there is none, the tension that the \
                curve needs. BIC is chi squared plus the number of fitted numbers times the logarithm of the number of frames; \
                off by is the part of the residuals that is not noise, over the height of a beat."
        .to_owned();
    let parts = vec![Part::Table(table)];
    let section = Section { hint, ..Section::new("models", "Models that were tried", parts) };
    (!fit.tried.is_empty()).then_some(section)
}

/// How well the numbers are determined.
fn certainty(fit: &Fit, more: &[String]) -> Section<'static> {
    let mut notes: Vec<String> = fit.curves.iter().map(words::residual).collect();
    notes.extend_from_slice(more);
    let profiles = tables::profiles(fit);
    let hint = match profiles.len() {
        0 => "",
        _ => {
            "Rise of chi squared when one number is fixed and the others are fitted again; the 95 % interval ends \
            where the curve reaches the dashed line. The green dot is the fitted value. A model that does not fit \
            has no intervals."
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
fn meaning(estimate: &Estimate, fit: &Fit, model: &dyn CellModel) -> String {
    let mut of_tension = fit.own_tension.iter().flat_map(|own| &own.metrics);
    if let Some(metric) = of_tension.find(|metric| metric.name == estimate.name) {
        return metric.definition.to_owned();
    }
    match &estimate.unknown {
        Some(Unknown::TensionOverStiffness) => {
            "peak of the active tension over Young's modulus: a free cell shortens by about as much"
                .to_owned()
        }
        Some(Unknown::YoungModulus) => "Young's modulus of the cell along its fibres".to_owned(),
        Some(Unknown::PeakTension) => "peak of the active tension".to_owned(),
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
fn from_stimulus(curve: DrawnFit, start: f64) -> DrawnFit {
    let by = start - curve.stimuli_ms.first().copied().unwrap_or(start);
    let moved = |times: Vec<f64>| times.into_iter().map(|time| time + by).collect();
    DrawnFit { times_ms: moved(curve.times_ms), stimuli_ms: moved(curve.stimuli_ms), ..curve }
}

/// The figures of a film.
fn figures(fits: &Fits) -> Vec<Section<'static>> {
    let one = |id, title, figure: Result<Figure, FigureError>, words: String, notes: &[String]| {
        let words = format!("{words}.");
        let drawing = Drawing::new(&figure.ok()?, &words).ok()?;
        let notes = (!notes.is_empty()).then(|| Part::Words(notes.to_vec()));
        let parts = [Part::Figure(drawing), Part::Words(vec![words])].into_iter().chain(notes);
        Some(Section::new(id, title, parts.collect()))
    };
    let shapes = fits.shapes.as_ref();
    let shapes = shapes
        .and_then(|it| one("shapes", "Both cells at their peak", it.figure(), it.words(), &[]));
    let map = fits.map.as_ref();
    let map = map
        .and_then(|it| one("map", "Where the cell pulls", it.figure(), it.words(), it.verdicts()));
    let course = fits.map.as_ref().and_then(over_beat);
    shapes.into_iter().chain(map).chain(course).collect()
}

/// The map of tension over a beat.
fn over_beat(map: &FilmMap) -> Option<Section<'static>> {
    let words =
        "One colour scale for all times. The tension of hatched places is not known and not drawn.";
    let drawing = Drawing::new(&map.beat_figure().ok()??, words).ok()?;
    let hint = format!("{words} `tension_frames.csv` and `tension_frames.npz` have every frame.");
    let parts = vec![Part::Figure(drawing)];
    Some(Section { hint, ..Section::new("map-beat", "Where the cell pulls, over a beat", parts) })
}

/// The fitted cell over the frames of the film.
fn laid_over(shapes: &Shapes) -> Option<Section<'static>> {
    let over = shapes.over_film().ok()??;
    let words = over.words();
    let drawing =
        Drawing::finest(FINENESS.into_iter().map(|sharp| over.figure(sharp)), &words).ok()?;
    let hint = "Yellow: the cell as it was followed. Blue, dashed: the fitted cell, shifted and rotated as a whole to it. The distance is \
                that of all points of the two, root mean square; moved is how far the film's cell is from rest. \
                `figures/overlay.gif` shows the beat, `distances.csv` has every frame."
        .to_owned();
    let parts = vec![Part::Figure(drawing), Part::Words(vec![format!("{words}.")])];
    Some(Section { hint, ..Section::new("film", "The fitted cell over the film", parts) })
}

/// Pixels of the film per px of the figure on the page, the finest first.
const FINENESS: [f64; 3] = [1.4, 1.0, 0.6];
