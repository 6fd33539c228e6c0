//! `report.html` of a run.

use super::activation;
use super::finished::Finished;
use super::record::resolved;
use crate::experiment::{ExperimentError, Folder, Inputs, citations};
use crate::output::page::{
    self, Drawing, Page, PageError, PageRun, ParameterGroup, ParameterRow, Part, Photograph, Runs,
    Section, ThickCell,
};
use crate::recording::Recording;
use crate::settings::{self, Run, Value};
use crate::simulation::{InSpace, Simulation};

/// Name of the file.
pub const FILE: &str = "report.html";

/// Writes the page.
pub(super) fn write(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    folder.write(FILE, of(finished, page::html)?)
}

/// The page in the form that `make` gives it.
pub(super) fn of(
    finished: &Finished<'_>,
    make: impl FnOnce(&Page<'_>) -> Result<String, PageError>,
) -> Result<String, ExperimentError> {
    let Finished { name, run, outcome, .. } = finished;
    let title = if run.title.is_empty() { name } else { run.title.as_str() };
    let texts = Texts::of(finished);
    let runs = Runs { runs: vec![on_page(finished, &texts)], differences: &[] };
    let stop = finished.outcome.stop.as_ref();
    let stopped = stop.map(|stop| format!("the run stopped early: {stop}"));
    let mut sections = vec![runs.key_numbers(), runs.beat(finished.colour(), Vec::new())];
    if outcome.recording.wave.is_some() {
        let words =
            "The tissue, coloured by the time of activation, and by the action potential duration.";
        let map = Part::Figure(Drawing::new(&activation::draw(finished)?, words)?);
        sections.push(Section::new("activation", "How the beat spreads", vec![map]));
    }
    sections.extend(runs.record());
    let page = Page {
        kind: "A beat by Myospring",
        title,
        facts: facts(finished),
        answer: None,
        warnings: stopped.into_iter().chain(runs.warnings()).collect(),
        sections,
    };
    Ok(make(&page)?)
}

/// What the page of a run borrows.
struct Texts {
    label: String,
    run_file: String,
    citations: String,
    /// What the tetrahedra of a thick cell have.
    in_space: Option<InSpace>,
}

impl Texts {
    fn of(finished: &Finished<'_>) -> Self {
        let Finished { run, simulation, outcome, numbers, inputs, .. } = finished;
        let spacing = numbers.summary.mesh.spacing_um;
        Self {
            label: run.strength(),
            run_file: resolved(run, (inputs, ""), simulation, spacing, outcome.effort.time_step()),
            citations: citations::bibtex(&*run.cell),
            in_space: simulation.in_space(),
        }
    }
}

/// A thick cell as its page shows it in space.
pub(in crate::experiment) fn thick_cell<'a>(
    simulation: &'a Simulation,
    recording: &'a Recording,
    in_space: Option<&'a InSpace>,
) -> Option<ThickCell<'a>> {
    let (thick, InSpace { fibres, myofibril_content }) = simulation.thick.as_ref().zip(in_space)?;
    // Results that were read have none.
    (!recording.in_space.is_empty()).then_some(ThickCell {
        mesh: &thick.mesh,
        frames: &recording.in_space,
        fibres,
        myofibril_content: myofibril_content.as_deref(),
        long_axis: simulation.long_axis,
    })
}

/// What was run, a few words each.
fn facts(finished: &Finished<'_>) -> Vec<String> {
    let Finished { name, run, numbers, .. } = finished;
    let beats = numbers.summary.captured();
    let missed = match numbers.summary.rhythm.not_captured.len() {
        0 => String::new(),
        missed => format!(", {missed} stimul{} not captured", if missed == 1 { "us" } else { "i" }),
    };
    let s2 = if numbers.summary.s2().is_some() { " and S2" } else { "" };
    let plural = if beats == 1 { "" } else { "s" };
    let mut facts = vec![
        (*name).to_owned(),
        run.cell.name().to_owned(),
        run.strength(),
        format!("{beats} beat{plural}{missed}{s2}"),
    ];
    facts.dedup();
    // The title says it already.
    facts.retain(|fact| !run.title.is_empty() || fact != name);
    facts
}

fn on_page<'a>(finished: &'a Finished<'_>, texts: &'a Texts) -> PageRun<'a> {
    let Finished { run, simulation, outline, picture, outcome, numbers, stimuli, inputs, .. } =
        finished;
    PageRun {
        label: &texts.label,
        summary: numbers.summary,
        recording: &outcome.recording,
        mesh: &simulation.mesh,
        fibres: &simulation.fibres,
        myofibril_content: simulation.myofibril_content.as_deref(),
        outline,
        stimulus_times_ms: stimuli,
        parameters: parameters(run, inputs),
        run_file: &texts.run_file,
        citations: &texts.citations,
        picture: picture.map(|(cells, _)| Photograph {
            width: cells.plane.width(),
            height: cells.plane.height(),
            values: cells.plane.values(),
            pixel_size: cells.pixel_size,
        }),
        thick: thick_cell(simulation, &outcome.recording, texts.in_space.as_ref()),
    }
}

/// Every setting that the run has, table by table, with files as the results name them, then the parameters of its cell model.
pub fn parameters(run: &Run, inputs: &Inputs) -> Vec<ParameterGroup> {
    let usual = Run::default_run();
    let mut groups: Vec<ParameterGroup> = Vec::new();
    for table in settings::tables().iter().filter(|table| !table.name.is_empty()) {
        let rows = table.settings.iter().filter_map(|setting| {
            let value = setting.get(run)?;
            let is_usual = setting.get(&usual).as_ref() == Some(&value);
            let value = match value {
                Value::Text(path) if setting.names_file(&path) => {
                    Value::Text(inputs.name(&path, ""))
                }
                value => value,
            };
            Some(ParameterRow {
                name: setting.key.to_owned(),
                value: written(&value),
                meaning: setting.doc.replace('`', ""),
                source: if is_usual { "default" } else { "of this run" }.to_owned(),
                changed: !is_usual,
                ..ParameterRow::default()
            })
        });
        let group = ParameterGroup { name: table.name.to_owned(), rows: rows.collect() };
        if !group.rows.is_empty() {
            groups.push(group);
        }
    }
    let published = run.published_cell().ok();
    let published = published.as_ref().map(|model| model.parameters());
    let rows = run.cell.parameters().rows().iter().map(|row| {
        let own = published.and_then(|set| set.get(&row.name)).filter(|own| *own != row.value);
        ParameterRow {
            name: row.name.to_string(),
            value: row.value.to_string(),
            unit: row.unit.to_string(),
            meaning: row.meaning.to_string(),
            source: match own {
                Some(own) => format!("of this run; {own} in {}", row.source),
                None => row.source.to_string(),
            },
            changed: own.is_some(),
        }
    });
    let name = format!("cell model {}", run.cell.name());
    groups.push(ParameterGroup { name, rows: rows.collect() });
    groups
}

fn written(value: &Value) -> String {
    match value {
        Value::Text(text) => text.clone(),
        value => value.to_string(),
    }
}
