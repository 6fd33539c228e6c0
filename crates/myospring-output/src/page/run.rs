//! One run on a page: its numbers, its curves, its parameters.

use super::cell::MovingCell;
use super::chart::Tone;
use super::content::Part;
use super::photograph::Photograph;
use super::table::{Column, Look, Row, Table, TableCell};
use super::thick::ThickCell;
use myospring_core::analysis::bands::{self, Band};
use myospring_core::analysis::summary::Summary;
use myospring_core::analysis::{Metric, Missing};
use myospring_core::mesh::Mesh;
use myospring_core::mesh::outline::Outline;
use myospring_core::recording::{CALCIUM, Recording, STEEPEST_RISE, Sample};

/// A run on a page.
#[derive(Debug, Clone)]
pub struct PageRun<'a> {
    /// A short label: `50 kPa`.
    pub label: &'a str,
    /// Its numbers and warnings.
    pub summary: &'a Summary,
    /// Its curves and frames.
    pub recording: &'a Recording,
    /// Its mesh at rest.
    pub mesh: &'a Mesh,
    /// Unit vector along the fibre in each triangle.
    pub fibres: &'a [[f64; 2]],
    /// Content of myofibrils of each triangle; `None` is 1 everywhere.
    pub myofibril_content: Option<&'a [f64]>,
    /// The outline that was meshed, um.
    pub outline: &'a Outline,
    /// Times of the stimuli, ms.
    pub stimulus_times_ms: &'a [f64],
    /// Parameters and settings, group by group.
    pub parameters: Vec<ParameterGroup>,
    /// The run file that repeats it, TOML.
    pub run_file: &'a str,
    /// What to cite, BibTeX.
    pub citations: &'a str,
    /// The picture that the cell was found in.
    pub picture: Option<Photograph<'a>>,
    /// The same cell in space, if it is thick.
    pub thick: Option<ThickCell<'a>>,
}

/// Parameters that belong together.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterGroup {
    /// Name of the group.
    pub name: String,
    /// In the order in which they are shown.
    pub rows: Vec<ParameterRow>,
}

/// A parameter as a person reads it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ParameterRow {
    /// Its name.
    pub name: String,
    /// Its value.
    pub value: String,
    /// Unit of the value; empty where the value has it, or has none.
    pub unit: String,
    /// What it does.
    pub meaning: String,
    /// Where the value comes from.
    pub source: String,
    /// Whether it is neither the default nor the published one; on paper only such parameters are listed.
    pub changed: bool,
}

impl<'a> PageRun<'a> {
    pub(super) fn cell(&self) -> MovingCell<'a> {
        let shortest = |a: &&Sample, b: &&Sample| a.shortening_pct.total_cmp(&b.shortening_pct);
        let samples =
            self.recording.samples.iter().filter(|sample| sample.shortening_pct.is_finite());
        MovingCell {
            label: self.label,
            mesh: self.mesh,
            frames: &self.recording.frames,
            fibres: self.fibres,
            myofibril_content: self.myofibril_content,
            has_tension: true,
            outline: self.outline,
            picture: self.picture,
            peak_ms: samples.max_by(shortest).map_or(0.0, |sample| sample.t_ms),
            thick: self.thick,
        }
    }

    /// Groups of metrics: of the first beat that counts, of an extra stimulus, of the whole run.
    fn groups(&self) -> Vec<(&'static str, &'a [Metric])> {
        let summary = self.summary;
        let mut groups: Vec<(&'static str, &[Metric])> = Vec::new();
        if let Some(beat) = summary.usual() {
            groups.extend([
                ("Shortening", &beat.contraction[..]),
                ("Tension", &beat.tension[..]),
                ("Shape at the peak of shortening", &beat.shape[..]),
                ("Action potential", &beat.action_potential[..]),
            ]);
        }
        groups.extend(summary.s2().map(|beat| ("Extra stimulus, S2", &beat.s2[..])));
        groups.push(("Energy over the run", &summary.energy));
        groups
    }

    pub(super) fn metrics(&self) -> Vec<(&'static str, Vec<&'static str>)> {
        let names = |metrics: &[Metric]| metrics.iter().map(|metric| metric.name).collect();
        self.groups().into_iter().map(|(name, metrics)| (name, names(metrics))).collect()
    }

    /// Whether it is no unloaded cell: something that is measured holds its ends, it is on a gel, or it is a tissue.
    pub(super) fn is_loaded(&self) -> bool {
        self.recording.wave.is_some()
            || self.summary.beats.first().is_some_and(|beat| !beat.load.is_empty())
    }

    /// A metric of the first beat that counts, or the mean over several; empty if the run does not
    /// have it.
    pub(super) fn metric(&self, name: &str) -> Read {
        let metric = self.groups().into_iter().flat_map(|(_, all)| all).find(|it| it.name == name);
        let Some(metric) = metric else { return Read::default() };
        let over_beats = self.summary.beat_to_beat.iter().find(|spread| spread.name == name);
        let value = over_beats.map(|spread| spread.mean).or(metric.value);
        // The bands are those of unloaded cells.
        let loaded = self.is_loaded();
        Read {
            value,
            spread: over_beats.map(|spread| spread.standard_deviation),
            missing: metric.missing.filter(|_| value.is_none()),
            unit: metric.unit.to_owned(),
            definition: metric.definition,
            band: bands::band(name).filter(|_| !loaded).copied(),
        }
    }

    pub(super) fn parameters(&self) -> Vec<Part<'a>> {
        let row = |row: &ParameterRow| Row {
            cells: vec![
                TableCell::text(&row.name),
                TableCell { unit: row.unit.clone(), ..TableCell::text(&row.value) },
                TableCell::text(&row.meaning),
                TableCell::text(&row.source),
            ],
            marked: row.changed,
        };
        let columns = || {
            let [value, meaning, source] =
                ["number", "meaning", "source"].map(|class| Column::of(class, class));
            vec![
                Column::text("name"),
                Column { name: "value".to_owned(), ..value },
                meaning,
                source,
            ]
        };
        let folded = |group: &ParameterGroup| {
            let changed = group.rows.iter().filter(|row| row.changed).count();
            let of_run =
                if changed > 0 { format!(", {changed} of this run") } else { String::new() };
            let table = Table {
                caption: group.name.clone(),
                look: Look::Parameters,
                columns: columns(),
                rows: group.rows.iter().map(row).collect(),
            };
            Part::Folded {
                title: format!("{} ({}{of_run})", group.name, group.rows.len()),
                on_paper: changed > 0,
                parts: vec![Part::Table(table)],
            }
        };
        self.parameters.iter().map(folded).collect()
    }

    pub(super) fn repeat(&self, several: bool) -> Vec<Part<'a>> {
        let of = if several { format!(" of {}", self.label) } else { String::new() };
        let (what, file) = (format!("run file{of}"), "run.toml");
        vec![
            Part::Words(vec!["`myospring run run.toml` repeats it with this file, which is also beside its results.".to_owned()]),
            Part::Text { what, file, text: self.run_file.to_owned() },
        ]
    }
}

/// A metric of a run.
#[derive(Default)]
pub(super) struct Read {
    pub(super) value: Option<f64>,
    pub(super) spread: Option<f64>,
    pub(super) missing: Option<Missing>,
    pub(super) unit: String,
    pub(super) definition: &'static str,
    pub(super) band: Option<Band>,
}

/// A curve of a run.
pub(super) struct Curve {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) tone: Tone,
    pub(super) values: Vec<f64>,
}

type Value = fn(&Sample) -> Option<f64>;

/// Potential, where there is one, tension, shortening and whatever else the cell model has.
pub(super) fn curves(recording: &Recording) -> Vec<Curve> {
    let samples = &recording.samples;
    let curve = |name: &str, unit: &str, tone, read: Value| Curve {
        name: name.to_owned(),
        unit: unit.to_owned(),
        tone,
        values: samples.iter().map(|sample| read(sample).unwrap_or(f64::NAN)).collect(),
    };
    let potentials: [(&str, Value); 2] = [("mV", |sample| sample.vm_mv), ("", |sample| sample.u)];
    let known = |(_, read): &(_, Value)| samples.iter().any(|sample| read(sample).is_some());
    let potential = potentials.into_iter().find(known);
    let mut all: Vec<Curve> = potential
        .map(|(unit, read)| curve("Action potential", unit, Tone::Potential, read))
        .into_iter()
        .collect();
    all.extend([
        curve("Active tension", "kPa", Tone::Tension, |sample| Some(sample.ta_kpa)),
        curve("Shortening", "%", Tone::Shortening, |sample| Some(sample.shortening_pct)),
    ]);
    // A signal that only grows from beat to beat is not drawn.
    let signals = recording.signals.iter().filter(|signal| !signal.is(STEEPEST_RISE));
    let (calcium, others): (Vec<_>, Vec<_>) = signals.partition(|signal| signal.is(CALCIUM));
    all.extend(calcium.into_iter().chain(others).map(|signal| {
        let (name, unit) = signal.title();
        Curve {
            name: name.to_owned(),
            unit: unit.to_owned(),
            tone: Tone::Signal,
            values: signal.values.clone(),
        }
    }));
    all
}
