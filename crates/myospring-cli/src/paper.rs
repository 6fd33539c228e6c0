//! `myospring paper`.

use crate::args::PaperArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::{self, Input};
use crate::interrupt;
use crate::print::{self, progress_bar};
use crate::table::{aligned, wrapped};
use crate::terminal::Terminal;
use myospring::experiment::Folder;
use myospring::mesh::Mesh;
use myospring::mesh::outline::Outline;
use myospring::output::comparison::{Finding, PaperRun, TENSIONS, Verdict, with_paper};
use myospring::output::field::Fields;
use myospring::output::figure::{self, Cell, ContractionOptions, FigureError, Theme};
use myospring::output::{csv, json};
use myospring::settings::{self, Places, Shaped, Value};
use myospring::simulation::{Effort, Outcome};
use myospring::study::Threads;
use rayon::prelude::*;
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

#[derive(Serialize)]
struct Record<'a> {
    version: &'static str,
    findings: &'a [Finding],
    /// What each run took, in the order of the tensions.
    integration: Vec<Effort>,
    stopped_early: Vec<String>,
    total_s: f64,
}

pub(crate) fn paper(args: &PaperArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let rows = [("shape.spacing", &args.spacing), ("numerics.integrator", &args.integrator)];
    let overrides = rows
        .into_iter()
        .filter_map(|(key, value)| Some((settings::find(key)?, Value::Text(value.clone()?))));
    let Input { run, shaped: Shaped { mesh, outline, .. }, .. } =
        input::read(None, overrides.collect(), None)?;
    let target = args.output.output.clone().unwrap_or_else(|| Path::new("results").join("paper"));
    interrupt::heed_soon("nothing is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;

    let threads = Threads::new(args.threads)?;
    let bar = progress_bar(args.output.quiet);
    bar.set_length(TENSIONS.len() as u64 * run.duration as u64);
    let fibres = run.fibre.on(&mesh, None)?;
    let one = |peak_tension: f64| -> Result<Outcome, Failure> {
        let mut simulation = run.simulation(
            mesh.clone(),
            Places {
                fibres: fibres.directions.clone(),
                myofibril_content: None,
                resting_stretch: None,
            },
        );
        simulation.peak_tension = peak_tension;
        let mut before = 0.0;
        Ok(simulation.build()?.run(|progress| {
            bar.inc((progress.time - before).round() as u64);
            before += (progress.time - before).round();
            !interrupt::asked()
        }))
    };
    // Kept in the order of the tensions, whichever run ends first.
    let outcomes: Result<Vec<Outcome>, Failure> =
        threads.install(|| TENSIONS.par_iter().map(|tension| one(*tension)).collect());
    bar.finish_and_clear();
    if interrupt::asked() {
        return Ok(ExitCode::from(1));
    }
    let outcomes = outcomes?;

    let runs: Vec<PaperRun<'_>> = TENSIONS
        .iter()
        .zip(&outcomes)
        .map(|(&peak_tension, outcome)| PaperRun { peak_tension, recording: &outcome.recording })
        .collect();
    let equations = run.cell.states().len();
    let findings = with_paper(&runs, run.protocol.start_ms, equations, &mesh.areas);
    let stopped_early: Vec<String> =
        outcomes.iter().filter_map(|outcome| Some(outcome.stop.as_ref()?.to_string())).collect();
    figures(&folder, &mesh, &outline, &runs, &run.stimulus_times())?;
    let total_s = start.elapsed().as_secs_f64();
    let record = Record {
        version: env!("CARGO_PKG_VERSION"),
        findings: &findings,
        integration: outcomes.iter().map(|outcome| outcome.effort).collect(),
        stopped_early,
        total_s,
    };
    let record_text = json::pretty(&record)?;
    folder.write("paper.json", &record_text)?;
    let target = folder.finish(&Terminal::new(true))?;

    if args.output.json {
        print::out(&record_text)?;
    } else {
        print::out(&for_people(&findings))?;
        print::out(&format!("\nresults in {} ({total_s:.1} s)", target.display()))?;
    }
    for stop in &record.stopped_early {
        print::note(&format!("error: a run stopped early: {stop}"));
    }
    let missed = findings.iter().filter(|finding| finding.verdict == Verdict::NotMet).count();
    if missed > 0 {
        print::note(&format!("error: {missed} of the paper's statements are not met"));
    }
    let good = missed == 0 && record.stopped_early.is_empty();
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

fn figures(
    folder: &Folder,
    mesh: &Mesh,
    outline: &Outline,
    runs: &[PaperRun<'_>],
    stimuli: &[f64],
) -> Result<(), Failure> {
    let labels: Vec<String> = runs.iter().map(|run| format!("{} kPa", run.peak_tension)).collect();
    for (run, label) in runs.iter().zip(&labels) {
        let name = format!("traces_{}.csv", label.replace(' ', "_"));
        folder.write(&name, csv::traces(run.recording)?)?;
    }
    let curves: Vec<_> =
        labels.iter().zip(runs).map(|(label, run)| (label.as_str(), run.recording)).collect();
    let (options, theme) = (ContractionOptions::default(), Theme::default());
    folder.figures(
        theme,
        &[("fig6_contraction", &|| figure::contraction(&curves, &options))],
        &Terminal::new(true),
    )?;
    let Some(strongest) = runs.last() else { return Ok(()) };
    let recording = strongest.recording;
    let fibres = vec![myospring::mesh::quality::long_axis(mesh); mesh.simplices.len()];
    let fields = Fields::new(mesh, &fibres, None).map_err(FigureError::from)?;
    let cell = Cell::new(fields, Some(outline))?;
    let shapes = figure::key_shapes(recording, stimuli);
    folder.figures(
        theme,
        &[
            ("fig5_cell", &|| figure::cell_shapes(&cell, &shapes)),
            ("fig3_action_potential_and_tension", &|| {
                figure::action_potential_and_tension(recording, stimuli)
            }),
        ],
        &Terminal::new(true),
    )
}

/// The table: quantity, paper, ours, verdict.
fn for_people(findings: &[Finding]) -> String {
    let heading = ["quantity", "paper", "ours", "verdict"].map(str::to_owned).to_vec();
    let mut rows = vec![heading];
    for Finding { quantity, paper, ours, verdict, .. } in findings {
        let ours = wrapped(ours, 34);
        let mut lines = ours.into_iter();
        let first = lines.next().unwrap_or_default();
        let verdict = verdict.words().to_owned();
        rows.push(vec![(*quantity).to_owned(), (*paper).to_owned(), first, verdict]);
        rows.extend(lines.map(|line| vec![String::new(), String::new(), line, String::new()]));
    }
    aligned(&rows, &[])
}
