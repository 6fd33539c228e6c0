//! `report.html` of analysed curves.

use super::curve::AnalysedCurve;
use super::figures;
use super::pairs::PairedCurves;
use super::record::{KEY, Mean, conventions, means, means_of};
use super::shown::Shown;
use crate::analysis::curve::{Analysis, CurveBeat, State};
use crate::experiment::legible::number;
use crate::output::figure::Measured;
use crate::output::page::{
    self, Answer, Chart, Column, Drawing, Look, Page, PageError, Part, Quality, Row, Section,
    Table, TableCell, Tile, VerdictMark, metric_words,
};
use std::collections::BTreeSet;

/// Curves that are drawn, and whose numbers are listed, at most.
const DRAWN: usize = 40;
/// Rows of a table of all curves or all beats, at most.
const ROWS: usize = 1000;
/// Pairs that are drawn, at most.
const PAIRS: usize = 12;

/// The page.
pub(super) fn html(
    all: &[AnalysedCurve],
    pairs: &[PairedCurves],
    shown: Option<&Shown>,
    warnings: Vec<String>,
) -> Result<String, PageError> {
    let several = files(all).len() > 1;
    let found = all.iter().filter_map(|read| {
        Some(Found { name: name(read, several), read, analysis: read.found.as_ref().ok()? })
    });
    let found: Vec<Found<'_>> = found.collect();
    let mut sections = Vec::new();
    match &found[..] {
        [Found { analysis, .. }] if all.len() == 1 => {
            sections.push(Section::new("key", "Key numbers", vec![tiles(analysis)]));
        }
        _ => sections.push(Section {
            hint: "Mean \u{b1} SD over the beats that count.".to_owned(),
            ..Section::new("all", "All curves", vec![Part::Table(by_curve(all, several))])
        }),
    }
    if let Some(Shown { id, title, words, figure, tiles, .. }) = shown {
        let figure = Part::Figure(Drawing::new(figure, words)?);
        let tiles = (!tiles.is_empty()).then(|| Part::Tiles(tiles.clone()));
        let parts = tiles.into_iter().chain([figure]).collect();
        sections.push(Section { hint: words.clone(), ..Section::new(id, title, parts) });
    }
    if !pairs.is_empty() {
        sections.push(together(all, pairs)?);
    }
    sections.push(curves(&found));
    sections.push(numbers(&found));
    sections.push(beats(&found));
    sections.push(treatment(&found));
    page::html(&Page {
        kind: "Beats of measured curves, by Myospring",
        title: &shown.map_or_else(|| title(all), |shown| format!("{}: {}", shown.of, title(all))),
        facts: facts(all),
        answer: Some(answer(all, &found)),
        warnings,
        sections,
    })
}

/// A curve with beats.
struct Found<'a> {
    name: String,
    read: &'a AnalysedCurve,
    analysis: &'a Analysis,
}

/// The name of a curve; of several files with its own.
fn name(read: &AnalysedCurve, several: bool) -> String {
    if several { read.title() } else { read.curve.name.clone() }
}

fn files(all: &[AnalysedCurve]) -> BTreeSet<&str> {
    all.iter().map(|read| read.file.as_str()).collect()
}

fn title(all: &[AnalysedCurve]) -> String {
    match (all, files(all).len()) {
        ([one], _) => one.title(),
        (curves, 1) => {
            let file = curves[0].file.rsplit(['/', '\\']).next().unwrap_or_default();
            format!("{file}: {} curves", curves.len())
        }
        (curves, files) => format!("{} curves of {files} files", curves.len()),
    }
}

fn facts(all: &[AnalysedCurve]) -> Vec<String> {
    let kinds: BTreeSet<String> = all.iter().map(|read| read.curve.kind.to_string()).collect();
    let mut facts: Vec<String> = kinds.into_iter().collect();
    if let [one] = all {
        let rate = one.curve.frame_rate_per_s().map(|rate| format!(" at {} /s", number(rate)));
        facts.push(format!("{} frames{}", one.curve.values.len(), rate.unwrap_or_default()));
    }
    facts
}

/// How many beats count and, for a single curve, how large they are.
fn answer(all: &[AnalysedCurve], found: &[Found<'_>]) -> Answer {
    let beats: usize = found.iter().map(|Found { analysis, .. }| analysis.beats.len()).sum();
    let counted: usize = found.iter().map(|Found { analysis, .. }| analysis.counted().len()).sum();
    let of = if all.len() == 1 {
        String::new()
    } else {
        format!(" in {} of {} curves", found.len(), all.len())
    };
    let plural = if beats == 1 { "" } else { "s" };
    let mut words = if counted == beats {
        format!("{beats} beat{plural}{of}")
    } else {
        format!("{counted} of {beats} beat{plural} count{of}")
    };
    if let [Found { analysis, .. }] = found
        && let Some(mean) = Mean::first(&means(analysis), KEY[2].1)
        && let Some(value) = mean.in_words()
    {
        words = format!("{words}; {} {value}", metric_words(mean.name));
    }
    let whole = counted == beats && found.len() == all.len();
    let quality = if whole { Quality::Good } else { Quality::Fair };
    Answer { words: format!("{words}."), quality }
}

fn cell(mean: &Mean) -> TableCell {
    let unit = mean.unit.to_owned();
    TableCell { spread: mean.standard_deviation, unit, ..TableCell::number(mean.mean) }
}

fn tiles(analysis: &Analysis) -> Part<'static> {
    let means = means(analysis);
    let tile = |mean: &Mean| Tile {
        definition: mean.definition.to_owned(),
        lines: mean
            .standard_deviation
            .map(|sd| TableCell::text(format!("\u{b1} {} {}", number(sd), mean.unit)))
            .into_iter()
            .collect(),
        ..Tile::new(metric_words(mean.name), TableCell { spread: None, ..cell(mean) })
    };
    Part::Tiles(KEY.iter().filter_map(|(_, names)| Mean::first(&means, names)).map(tile).collect())
}

/// A row for each curve.
fn by_curve(all: &[AnalysedCurve], several: bool) -> Table {
    let mut columns =
        vec![Column::text("curve"), Column::text("kind"), Column::number("beats that count", "")];
    columns.extend(KEY.iter().map(|(words, _)| Column::of("number", words)));
    let row = |read: &AnalysedCurve| {
        let mut cells = vec![
            TableCell::text(name(read, several)),
            TableCell::text(read.curve.kind.to_string()),
        ];
        match &read.found {
            Err(why) => {
                let none = VerdictMark::new(false, "no beat");
                cells.push(
                    TableCell { note: why.clone(), ..TableCell::text("") }.marked(Some(none)),
                );
                cells.extend(KEY.iter().map(|_| TableCell::text("")));
            }
            Ok(analysis) => {
                let means = means(analysis);
                cells.push(TableCell::number(Some(analysis.counted().len() as f64)));
                cells.extend(KEY.iter().map(|(_, names)| {
                    Mean::first(&means, names).map_or_else(TableCell::default, cell)
                }));
            }
        }
        Row { cells, marked: read.found.is_err() }
    };
    Table {
        caption: "All curves".to_owned(),
        look: Look::Sortable,
        columns,
        rows: all.iter().take(ROWS).map(row).collect(),
    }
}

/// Calcium and motion of the same beats: loops and numbers.
fn together(all: &[AnalysedCurve], pairs: &[PairedCurves]) -> Result<Section<'static>, PageError> {
    let mut parts = Vec::new();
    for pair in pairs.iter().take(PAIRS) {
        let title = pair.title(all);
        if pair.paired.mean_loop.is_some() {
            let words = format!(
                "{title}: calcium and motion of each beat over time, and the loop of motion over calcium, {}",
                pair.paired.direction.words()
            );
            parts.push(Part::Figure(Drawing::new(&figures::loops(all, pair)?, &words)?));
        }
        let row = |mean: Mean| {
            let note = mean.missing.map_or_else(String::new, |why| why.words().to_owned());
            Row::from(vec![
                TableCell::term(metric_words(mean.name), mean.definition),
                TableCell { unit: String::new(), note, ..cell(&mean) },
                TableCell::text(mean.unit),
                TableCell::number(Some(mean.beats as f64)),
            ])
        };
        parts.push(Part::Table(Table {
            caption: title,
            columns: vec![
                Column::text("quantity"),
                Column::of("number", "mean \u{b1} SD"),
                Column::of("unit", "unit"),
                Column::of("number", "beats"),
            ],
            rows: means_of(&pair.paired.counted()).into_iter().map(row).collect(),
            ..Table::default()
        }));
    }
    Ok(Section {
        hint: "Calcium and motion of the same beats. A counter-clockwise loop: the motion follows calcium. `pairs.csv` has \
            each beat, `loops.csv` the loops."
            .to_owned(),
        ..Section::new("pairs", "Calcium and motion", parts)
    })
}

fn curves(found: &[Found<'_>]) -> Section<'static> {
    let charts = found.iter().take(DRAWN).map(|Found { name, read, analysis }| {
        Part::Charts(Chart::of_curve(&Measured {
            title: name,
            kind: read.curve.kind,
            unit: read.curve.unit,
            times_ms: &read.curve.times_ms,
            values: &read.curve.values,
            analysis,
            numbers: &[],
        }))
    });
    let shown = match found.len() {
        count if count > DRAWN => {
            format!(
                " The first {DRAWN} of {count} curves are shown; the folder `figures` has the others."
            )
        }
        _ => String::new(),
    };
    Section {
        hint: format!(
            "Drag over a part of a curve to enlarge it; a double click shows all.{shown}"
        ),
        ..Section::new("curves", "Curves", charts.collect())
    }
}

/// The parts of the only curve, or those of each of several curves under its name.
fn each(found: &[Found<'_>], part: impl Fn(&Analysis) -> Part<'static>) -> Vec<Part<'static>> {
    match found {
        [Found { analysis, .. }] => vec![part(analysis)],
        several => several
            .iter()
            .take(DRAWN)
            .map(|Found { name, analysis, .. }| Part::Folded {
                title: name.clone(),
                on_paper: true,
                parts: vec![part(analysis)],
            })
            .collect(),
    }
}

fn numbers(found: &[Found<'_>]) -> Section<'static> {
    let table = |analysis: &Analysis| {
        let row = |mean: Mean| {
            let values: Vec<f64> = analysis
                .counted()
                .iter()
                .filter_map(|beat| crate::analysis::value(beat, mean.name))
                .collect();
            let low = values.iter().copied().fold(f64::INFINITY, f64::min);
            let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
            let note = mean.missing.map_or_else(String::new, |why| why.words().to_owned());
            Row::from(vec![
                TableCell::term(metric_words(mean.name), mean.definition),
                TableCell { unit: String::new(), note, ..cell(&mean) },
                TableCell::text(mean.unit),
                TableCell::number(Some(low)),
                TableCell::number(Some(high)),
                TableCell::number(Some(mean.beats as f64)),
            ])
        };
        Part::Table(Table {
            caption: "Means over the beats that count".to_owned(),
            columns: vec![
                Column::text("quantity"),
                Column::of("number", "mean \u{b1} SD"),
                Column::of("unit", "unit"),
                Column::of("number", "least"),
                Column::of("number", "largest"),
                Column::of("number", "beats"),
            ],
            rows: means(analysis).into_iter().map(row).collect(),
            ..Table::default()
        })
    };
    Section {
        hint: "Mean, standard deviation and range over the beats that count. Beats cut at the end count in the \
            numbers that they show."
            .to_owned(),
        ..Section::new("metrics", "Numbers", each(found, table))
    }
}

fn beats(found: &[Found<'_>]) -> Section<'static> {
    let table = |analysis: &Analysis| {
        let means = means(analysis);
        let mut columns = vec![Column::text("beat"), Column::text("state")];
        columns.extend(means.iter().map(|mean| Column {
            definition: mean.definition.to_owned(),
            ..Column::number(&metric_words(mean.name), mean.unit)
        }));
        let row = |beat: &CurveBeat| {
            let counts = matches!(beat.state, State::Whole | State::CutAtEnd);
            let state =
                TableCell { note: beat.remarks.join("; "), ..TableCell::text(beat.state.words()) };
            let mut cells = vec![TableCell::text(beat.number.to_string()), state];
            let value =
                |mean: &Mean| TableCell::number(crate::analysis::value(&beat.metrics, mean.name));
            cells.extend(means.iter().map(value));
            Row { cells, marked: !counts }
        };
        let rows = analysis.beats.iter().take(ROWS / found.len().min(DRAWN)).map(row).collect();
        Part::Table(Table { caption: "Beats".to_owned(), look: Look::Sortable, columns, rows })
    };
    let folded = |part| match part {
        part @ Part::Folded { .. } => part,
        part => Part::Folded { title: "All beats".to_owned(), on_paper: false, parts: vec![part] },
    };
    let parts = each(found, table).into_iter().map(folded);
    let parts = parts.map(|part| match part {
        Part::Folded { title, parts, .. } => Part::Folded { title, on_paper: false, parts },
        part => part,
    });
    Section {
        hint: "Beats on orange do not count in means. `metrics.csv` has all.".to_owned(),
        ..Section::new("beats", "Beat by beat", parts.collect())
    }
}

fn treatment(found: &[Found<'_>]) -> Section<'static> {
    let words = |analysis: &Analysis| {
        Part::Words(conventions(&analysis.treatment).split("; ").map(str::to_owned).collect())
    };
    Section::new("treatment", "How the curves were read", each(found, words))
}
