//! `myospring run`.

mod plan;
pub(crate) mod words;

use crate::args::RunArgs;
use crate::exit::ExitCode;
use crate::failure::{BAD_INPUT, Failure};
use crate::files::FILES;
use crate::input;
use crate::interrupt;
use crate::print;
use crate::terminal::Terminal;
use myospring::compare::factor;
use myospring::experiment::Folder;
use myospring::experiment::run::{
    BeatCell, FinishedRun, RunNumbers, SavedRun, Stop, Style, Timings, WrittenOutputs, chosen,
};
use myospring::output::json;
use serde::Serialize;
use std::path::Path;

pub(crate) fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let outputs = chosen(args.outputs.as_deref())?;
    let (name, mut run) = input::settle(args.input.as_deref(), &args.settings.overrides())?;
    if let Some(factors) = &args.scale {
        factor::scale(&mut run, &factor::parse(factors)?)?;
    }
    let target = args.output.output.clone().unwrap_or_else(|| Path::new("results").join(&name));
    let mut refused = None;
    if !args.dry_run {
        Folder::check(&target, args.output.force, &FILES)?;
        refused = Some(input::refusals(&args.output, &name));
    }
    let threads = args.threads.map(usize::from);
    let draws = !args.dry_run && outputs.iter().any(|output| output.draws_mesh());
    let look = Style::from(args.look);
    let mesh_figure = draws.then_some(look.theme);
    let prepared = BeatCell { name, run, threads, refused, mesh_figure }.prepare(&FILES)?;
    let warn = |warnings: &[String]| {
        for warning in warnings.iter().filter(|_| !args.output.quiet) {
            print::warn(warning);
        }
    };
    warn(&prepared.warnings);
    if args.dry_run {
        plan::plan(args, &outputs, &prepared, &target)?;
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::heed("the run ends here, and what it has computed is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let (observer, warned) = (Terminal::new(args.output.quiet), prepared.warnings.len());
    let beaten = prepared.beat(&observer);
    observer.clear();
    warn(&beaten.summary.warnings[warned..]);
    let kept = beaten.write(&folder, &outputs, look, &observer)?;
    let target = folder.finish(&observer)?;
    told(args, &beaten, &kept, &target)?;
    let stop = &beaten.outcome.stop;
    if let Some(stop) = stop {
        print::note(&format!("error: the run stopped early: {stop}"));
        print::note(&format!("what was computed up to there is in {}", target.display()));
    }
    let errors = kept.written.errors();
    for error in &errors {
        print::note(&format!("error: {error}"));
    }
    if !errors.is_empty() {
        print::note(&format!("curves and numbers are in {}", target.display()));
        return Ok(ExitCode::from(BAD_INPUT));
    }
    kept.recorded?;
    Ok(if stop.is_some() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// Prints the numbers, and where the results are.
fn told(
    args: &RunArgs,
    beaten: &FinishedRun,
    kept: &SavedRun,
    target: &Path,
) -> Result<(), Failure> {
    let numbers = beaten.all_numbers();
    if args.output.json {
        #[derive(Serialize)]
        struct Printed<'a> {
            results: &'a Path,
            stop: Option<Stop<'a>>,
            timings: Timings,
            outputs: &'a WrittenOutputs,
            #[serde(flatten)]
            numbers: RunNumbers<'a>,
        }
        let (stop, outputs) = (Stop::of(&beaten.outcome), &kept.written);
        let printed = Printed { results: target, stop, timings: kept.timings, outputs, numbers };
        return print::out(&json::for_people(&printed)?);
    }
    print::out(&words::for_people(&beaten.name, &beaten.run, &numbers))?;
    print::out(&words::in_words(&beaten.outcome.effort))?;
    if let Some(about) = &beaten.summary.about_model {
        print::out(&format!("\n{about}"))?;
    }
    print::out(&words::results(target, kept.timings.total_s, &kept.written))
}
