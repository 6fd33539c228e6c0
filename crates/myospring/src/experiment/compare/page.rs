//! `report.html` of a comparison: the same page as that of a run, with all of them.

use super::side::{Shown, Side};
use crate::analysis::summary::Summary;
use crate::experiment::run::{parameters, thick_cell};
use crate::experiment::{ExperimentError, Inputs, citations};
use crate::output::field::Field;
use crate::output::page::{Difference, Page, PageError, PageRun, Runs};
use crate::simulation::Pace;

/// Text and numbers of a run that its page borrows.
struct Owned {
    summary: Summary,
    run_file: String,
    citations: String,
}

impl Owned {
    fn of(side: &Side, shown: &Shown, inputs: &Inputs) -> Self {
        let Side { recording, stimuli, s2_ms, .. } = side;
        let pace = Pace::of(&*shown.run.cell, shown.run.support, &side.beats());
        let report = shown.report.clone();
        Self {
            summary: Summary::new(recording, stimuli, *s2_ms, report, Vec::new())
                .with_about_model(pace.about_model()),
            run_file: inputs.renamed(side.file.clone(), "../").to_toml(),
            citations: citations::bibtex(&*shown.run.cell),
        }
    }
}

/// As many labels make a title; of more runs it has the first.
const NAMED: usize = 3;

/// The page in the form that `make` gives it, if every run can be shown.
pub(super) fn of(
    sides: &[Side],
    differences: &[Difference],
    warnings: &[String],
    inputs: &Inputs,
    make: impl FnOnce(&Page<'_>) -> Result<String, PageError>,
) -> Result<Option<String>, ExperimentError> {
    let shown: Option<Vec<(&Side, &Shown)>> = sides
        .iter()
        .map(|side| {
            Some((side, side.shown.as_ref()?)).filter(|_| !side.recording.frames.is_empty())
        })
        .collect();
    let Some(shown) = shown else {
        return Ok(None);
    };
    let owned: Vec<Owned> =
        shown.iter().map(|(side, shown)| Owned::of(side, shown, inputs)).collect();
    let runs = shown.iter().zip(&owned);
    let runs = runs.map(|((side, shown), owned)| on_page(side, shown, owned, inputs)).collect();
    let runs = Runs { runs, differences };
    // The curves come first: they show the difference.
    let mut sections = vec![runs.beat(Field::default(), Vec::new()), runs.key_numbers()];
    sections.extend(runs.record());
    let labels: Vec<&str> = sides.iter().map(|side| side.label.as_str()).collect();
    let title = match labels.as_slice() {
        [first, others @ ..] if others.len() >= NAMED => {
            format!("{first} and {} others", others.len())
        }
        labels => labels.join(" \u{b7} "),
    };
    let page = Page {
        kind: "Beats compared by Myospring",
        title: &title,
        // The legend names the runs.
        facts: Vec::new(),
        answer: None,
        warnings: warnings.iter().cloned().chain(runs.warnings()).collect(),
        sections,
    };
    Ok(Some(make(&page)?))
}

fn on_page<'a>(side: &'a Side, shown: &'a Shown, owned: &'a Owned, inputs: &Inputs) -> PageRun<'a> {
    PageRun {
        label: &side.label,
        summary: &owned.summary,
        recording: &side.recording,
        mesh: &shown.simulation.mesh,
        fibres: &shown.simulation.fibres,
        myofibril_content: shown.simulation.myofibril_content.as_deref(),
        outline: &shown.outline,
        stimulus_times_ms: &side.stimuli,
        parameters: parameters(&shown.run, inputs),
        run_file: &owned.run_file,
        citations: &owned.citations,
        picture: None,
        thick: thick_cell(&shown.simulation, &side.recording, shown.in_space.as_ref()),
    }
}
