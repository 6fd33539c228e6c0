//! `myospring paper`.

use crate::args::PaperArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input;
use crate::interrupt;
use crate::print;
use crate::table::{aligned, wrapped};
use crate::terminal::Terminal;
use myospring::experiment::paper::{Finding, Paper, StatementVerdict};
use myospring::experiment::{Experiment, Folder, Outcome};
use myospring::output::json;
use myospring::settings::{self, Value};
use std::path::Path;

pub(crate) fn paper(args: &PaperArgs) -> Result<ExitCode, Failure> {
    let rows = [("shape.spacing", &args.spacing), ("numerics.integrator", &args.integrator)];
    let overrides: Vec<_> = rows
        .into_iter()
        .filter_map(|(key, value)| Some((settings::find(key)?, Value::Text(value.clone()?))))
        .collect();
    let (_, run) = input::settle(None, &overrides)?;
    let target = args.output.output.clone().unwrap_or_else(|| Path::new("results").join("paper"));
    interrupt::heed_soon("nothing is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let observer = Terminal::new(args.output.quiet);
    let paper = Paper { run, threads: args.threads }.run(&FILES, &observer);
    observer.clear();
    if interrupt::asked() {
        return Ok(ExitCode::from(1));
    }
    let paper = paper?;
    paper.save(&folder, &observer)?;
    let target = folder.finish(&observer)?;
    if args.output.json {
        print::out(&json::pretty(&paper.numbers())?)?;
    } else {
        print::out(&for_people(&paper.findings))?;
        print::out(&format!("\nresults in {} ({:.1} s)", target.display(), paper.total_s()))?;
    }
    let stopped = paper.stopped_early();
    for stop in &stopped {
        print::note(&format!("error: a run stopped early: {stop}"));
    }
    let missed = paper.findings.iter().filter(|it| it.verdict == StatementVerdict::NotMet).count();
    if missed > 0 {
        print::note(&format!("error: {missed} of the paper's statements are not met"));
    }
    let good = missed == 0 && stopped.is_empty();
    Ok(if good { ExitCode::SUCCESS } else { ExitCode::from(1) })
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
