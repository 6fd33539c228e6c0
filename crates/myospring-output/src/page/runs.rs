//! The sections of runs, common to all experiments.

use super::cell::BeatingCells;
use super::chart::{Chart, Series, Tone};
use super::content::{Part, Section};
use super::run::{Curve, PageRun, Read, curves};
use super::table::{Column, Look, Row, Table, TableCell, Tile, VerdictMark, metric_words};
use crate::field::Field;
use myospring_core::analysis::Missing;
use myospring_core::analysis::bands::{self, Band, BandPosition};
use std::collections::BTreeSet;

/// Runs on a page; the others are compared with the first.
#[derive(Debug, Clone)]
pub struct Runs<'a> {
    /// At least one.
    pub runs: Vec<PageRun<'a>>,
    /// Settings in which they differ.
    pub differences: &'a [Difference],
}

/// A setting in which runs differ, as a person reads it.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Difference {
    /// Its key in a run file.
    pub name: String,
    /// Its value in each run.
    pub values: Vec<String>,
}

/// Metrics that a person looks at first.
const KEY: [&str; 10] = [
    "peak_shortening",
    "peak_lengthening",
    "time_to_peak_from_stimulus",
    "relaxation_time_90",
    "maximum_shortening_rate",
    "peak_tension",
    "action_potential_duration_90",
    "conduction_velocity",
    "activation_time",
    "local_action_potential_duration_90",
];
/// Runs that have a tile for each metric, at most; more are a table.
const TILED: usize = 3;
/// Curves of the cell model that are shown with the others, at most; of more the first, and the others unfold.
const SIGNALS: usize = 3;

impl<'a> Runs<'a> {
    /// Warnings, run by run.
    pub fn warnings(&self) -> Vec<String> {
        let several = self.runs.len() > 1;
        let of = |run: &PageRun<'_>| {
            let (label, texts) = (run.label.to_owned(), run.summary.warnings.clone());
            texts
                .into_iter()
                .map(move |text| if several { format!("{label}: {text}") } else { text })
        };
        self.runs.iter().flat_map(of).collect()
    }

    /// The numbers that a person looks at first.
    pub fn key_numbers(&self) -> Section<'a> {
        let has = |name: &str| self.runs.iter().any(|run| run.metric(name).value.is_some());
        // Lengthening is shown only if no cell becomes shorter.
        let usual = |name: &str| name != "peak_lengthening" || !has("peak_shortening");
        let names = KEY.into_iter().filter(|name| has(name) && usual(name));
        let several = self.runs.len() > 1;
        let part = if self.runs.len() > TILED {
            self.key_table(&names.collect::<Vec<_>>())
        } else {
            Part::Tiles(names.map(|name| self.tile(name, several)).collect())
        };
        Section::new("key", "Key numbers", vec![part])
    }

    fn tile(&self, name: &'static str, several: bool) -> Tile {
        let value = |run: &PageRun<'_>| {
            let Read { value, unit, band, .. } = run.metric(name);
            let mark = band.filter(|_| several).zip(value).map(mark);
            let label = if several { run.label.to_owned() } else { String::new() };
            (label, TableCell { unit, ..TableCell::number(value) }.marked(mark))
        };
        let Read { value: first, unit, band, .. } = self.runs[0].metric(name);
        let line = |band: Band| {
            if several {
                return TableCell::text(format!("measured {} {unit}", range(&band)));
            }
            TableCell::text(range(&band)).marked(first.map(|value| mark((band, value))))
        };
        Tile {
            name: metric_words(name),
            values: self.runs.iter().map(value).collect(),
            lines: band.map(line).into_iter().collect(),
            ..Tile::default()
        }
    }

    /// A row for each of many runs.
    fn key_table(&self, names: &[&'static str]) -> Part<'a> {
        let column = |name: &&'static str| Column::number(&metric_words(name), &self.unit(name));
        let row = |run: &PageRun<'_>| {
            let values = names.iter().map(|name| TableCell::number(run.metric(name).value));
            Row::from([TableCell::text(run.label)].into_iter().chain(values).collect::<Vec<_>>())
        };
        let columns = [Column::text("run")].into_iter().chain(names.iter().map(column));
        Part::Table(Table {
            caption: "Key numbers of each run".to_owned(),
            columns: columns.collect(),
            rows: self.runs.iter().map(row).collect(),
            ..Table::default()
        })
    }

    fn unit(&self, name: &str) -> String {
        let units = self.runs.iter().map(|run| run.metric(name).unit);
        units.into_iter().find(|unit| !unit.is_empty()).unwrap_or_default()
    }

    /// The beating cells and their curves, after additional charts.
    pub fn beat(&self, colour: Field, mut charts: Vec<Chart>) -> Section<'a> {
        let mut own = self.charts();
        let signals = own.len() - own.iter().position(|(signal, _)| *signal).unwrap_or(own.len());
        let split = if signals > SIGNALS { own.len() - signals + 1 } else { own.len() };
        let folded: Vec<Chart> = own.split_off(split).into_iter().map(|(_, chart)| chart).collect();
        charts.extend(own.into_iter().map(|(_, chart)| chart));
        if charts.iter().any(|chart| !chart.missed_ms.is_empty())
            && let Some(first) = charts.first_mut()
        {
            let in_all = if self.runs.len() > 1 { " in every run" } else { "" };
            let says = format!("\u{25bc} stimulus, \u{25bd} not captured{in_all}");
            let notes = [std::mem::take(&mut first.note), says];
            first.note =
                notes.into_iter().filter(|note| !note.is_empty()).collect::<Vec<_>>().join("; ");
        }
        let title = format!("{} more curves of the cell model", folded.len());
        let about: BTreeSet<&str> =
            self.runs.iter().filter_map(|run| run.summary.about_model.as_deref()).collect();
        let beat = BeatingCells {
            colour,
            cells: self.runs.iter().map(PageRun::cell).collect(),
            charts,
            folded: (title, folded),
            words: about.into_iter().collect::<Vec<_>>().join(" "),
        };
        Section::new("beat", "The beat", vec![Part::Beat(beat)])
    }

    /// A chart for each quantity that the first run has, and whether it is a signal of the cell model.
    fn charts(&self) -> Vec<(bool, Chart)> {
        let all: Vec<Vec<Curve>> = self.runs.iter().map(|run| curves(run.recording)).collect();
        let missed = self.stimuli(true);
        let captured = self.stimuli(false).into_iter().filter(|time| !missed.contains(time));
        let captured: Vec<f64> = captured.collect();
        let chart = |first: &Curve| {
            let is_same = |other: &&Curve| (&other.name, &other.unit) == (&first.name, &first.unit);
            let series =
                self.runs.iter().zip(&all).enumerate().filter_map(|(index, (run, all))| {
                    let curve = all.iter().find(is_same)?;
                    Some(Series {
                        label: run.label.to_owned(),
                        tone: if self.runs.len() > 1 { Tone::Run(index) } else { curve.tone },
                        dotted: false,
                        times_ms: run.recording.samples.iter().map(|sample| sample.t_ms).collect(),
                        values: curve.values.clone(),
                    })
                });
            // Measured peaks are those of unloaded cells.
            let is_free = self.runs.iter().all(|run| !run.is_loaded());
            let band = (first.tone == Tone::Shortening && is_free)
                .then(|| bands::band("peak_shortening"))
                .flatten();
            let chart = Chart {
                name: first.name.clone(),
                unit: first.unit.clone(),
                note: band.map_or_else(String::new, |band| {
                    format!("grey: measured peaks, {} to {} {}", band.low, band.high, first.unit)
                }),
                band: band.map(|band| [band.low, band.high]),
                series: series.collect(),
                stimuli_ms: captured.clone(),
                missed_ms: missed.clone(),
                ..Chart::default()
            };
            (first.tone == Tone::Signal, chart)
        };
        all[0].iter().map(chart).collect()
    }

    /// Stimuli of all runs that raised no action potential, or the others.
    fn stimuli(&self, missed: bool) -> Vec<f64> {
        let mut times = Vec::new();
        for run in &self.runs {
            let is_missed = |time: f64| {
                run.summary.beats.iter().any(|beat| beat.is_missed() && beat.stimulus_ms == time)
            };
            times.extend(run.stimulus_times_ms.iter().filter(|time| is_missed(**time) == missed));
        }
        times.sort_unstable_by(f64::total_cmp);
        times.dedup();
        times
    }

    /// All numbers, the settings that differ, parameters, and how to repeat and to cite the runs.
    pub fn record(&self) -> Vec<Section<'a>> {
        let mut sections = vec![self.numbers()];
        if self.runs.len() > 1 {
            sections.push(self.settings_that_differ());
        }
        let parameters = Section {
            hint: "On paper only what was changed is listed; `run.toml` has all.".to_owned(),
            ..Section::new(
                "parameters",
                "Parameters and their sources",
                self.each(PageRun::parameters),
            )
        };
        sections.push(parameters);
        sections.push(Section::new(
            "repeat",
            "Repeat this run",
            self.each(|run| run.repeat(self.runs.len() > 1)),
        ));
        let citations: BTreeSet<&str> = self.runs.iter().map(|run| run.citations).collect();
        let (what, file) = ("BibTeX", "myospring.bib");
        let text = |text: &str| Part::Text { what: what.to_owned(), file, text: text.to_owned() };
        sections.push(Section::new("cite", "Cite", citations.into_iter().map(text).collect()));
        sections
    }

    /// The parts of the only run, or those of each of several under its name; on paper only those
    /// of the first, since a table lists the differences.
    fn each(&self, parts: impl Fn(&PageRun<'a>) -> Vec<Part<'a>>) -> Vec<Part<'a>> {
        let folded = |(index, run): (usize, &PageRun<'a>)| {
            let (title, parts) = (run.label.to_owned(), parts(run));
            Part::Folded { title, on_paper: index == 0, parts }
        };
        match &self.runs[..] {
            [one] => parts(one),
            several => several.iter().enumerate().map(folded).collect(),
        }
    }

    /// All metrics, group by group.
    fn numbers(&self) -> Section<'a> {
        let several = self.runs.len() > 1;
        let changes = "Below a value: its difference from the first run, also in per cent. ";
        let hint = format!(
            "{}Measured: the range in unloaded adult ventricular myocytes. Being inside or outside it does not make a cell \
             right or wrong.",
            if several { changes } else { "" }
        );
        let parts = self.runs[0].metrics().into_iter().map(|group| Part::Table(self.group(group)));
        Section { hint, ..Section::new("metrics", "Numbers", parts.collect()) }
    }

    fn group(&self, (caption, names): (&'static str, Vec<&'static str>)) -> Table {
        let several = self.runs.len() > 1;
        let spread = self.runs.iter().any(|run| !run.summary.beat_to_beat.is_empty());
        let firsts: Vec<Read> = names.iter().map(|name| self.runs[0].metric(name)).collect();
        let banded = firsts.iter().any(|first| first.band.is_some());
        let mut columns = vec![Column::text("quantity")];
        let title = if spread { "mean \u{b1} sd of beats" } else { "value" };
        let label =
            |run: &PageRun<'_>| Column::of("number", if several { run.label } else { title });
        columns.extend(self.runs.iter().map(label));
        columns.insert(if several { 1 } else { 2 }, Column::of("unit", "unit"));
        columns.extend(banded.then(|| Column::of("band", "measured")));
        let row = |(name, first): (&'static str, Read)| {
            let mut cells = vec![TableCell::term(metric_words(name), first.definition)];
            cells.extend(self.runs.iter().enumerate().map(|(index, run)| {
                let Read { value, spread, missing, band, .. } = run.metric(name);
                let mark = band.filter(|_| several).zip(value).map(mark);
                let against = (index > 0).then_some([first.value]);
                let note = missing.map(Missing::words).unwrap_or_default().to_owned();
                TableCell { spread, note, mark, against, ..TableCell::number(value) }
            }));
            cells.insert(if several { 1 } else { 2 }, TableCell::text(first.unit));
            let own =
                |band: &Band| first.value.filter(|_| !several).map(|value| mark((*band, value)));
            let band = first.band.map(|band| TableCell::text(range(&band)).marked(own(&band)));
            cells.extend(banded.then(|| band.unwrap_or_else(|| TableCell::text(""))));
            Row::from(cells)
        };
        Table {
            caption: caption.to_owned(),
            look: if several { Look::Wide } else { Look::Numbers },
            columns,
            rows: names.into_iter().zip(firsts).map(row).collect(),
        }
    }

    fn settings_that_differ(&self) -> Section<'a> {
        let columns = self.runs.iter().map(|run| Column::text(run.label));
        let row = |Difference { name, values }: &Difference| {
            let cells = [name].into_iter().chain(values).map(TableCell::text);
            Row::from(cells.collect::<Vec<_>>())
        };
        let part = if self.differences.is_empty() {
            Part::Words(vec!["The runs have the same settings.".to_owned()])
        } else {
            Part::Table(Table {
                caption: "Settings".to_owned(),
                columns: [Column::text("setting")].into_iter().chain(columns).collect(),
                rows: self.differences.iter().map(row).collect(),
                ..Table::default()
            })
        };
        Section::new("differences", "Settings that differ", vec![part])
    }
}

/// Whether a value is within what is measured.
fn mark((band, value): (Band, f64)) -> VerdictMark {
    let place = band.place(value);
    VerdictMark::new(place == BandPosition::In, place.words())
}

fn range(band: &Band) -> String {
    format!("{} to {}", band.low, band.high).replace('-', "\u{2212}")
}
