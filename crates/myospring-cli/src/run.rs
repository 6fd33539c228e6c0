//! `myospring run`.

mod keep;
mod plan;
mod record;
mod watch;
pub(crate) mod words;

use crate::args::RunArgs;
use crate::exit::ExitCode;
use crate::failure::{BAD_INPUT, Failure};
use crate::files::FILES;
use crate::input::{self, Input};
use crate::interrupt;
use crate::outputs;
use crate::print;
use crate::summary::Numbers;
use crate::terminal::Terminal;
use keep::Kept;
pub use keep::Over;
use myospring::compare::factor;
use myospring::experiment::Folder;
use myospring::integrate::stencil;
use myospring::output::json;
use myospring::settings::Made;
pub(crate) use record::resolved;
use record::{Stop, Timings};
use serde::Serialize;
use std::path::Path;
use std::time::Instant;

pub(crate) fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let mut timings = Timings::default();
    input::one_cell(args.settings.all_cells())?;
    let outputs = outputs::chosen(args.outputs.as_deref())?;
    let results = Some(&args.output).filter(|_| !args.dry_run);
    let (name, mut run) = input::settle(args.input.as_deref(), args.settings.overrides())?;
    if let Some(factors) = &args.scale {
        factor::scale(&mut run, &factor::parse(factors)?)?;
    }
    let target = args.output.output.clone().unwrap_or_else(|| Path::new("results").join(&name));
    if !args.dry_run {
        Folder::check(&target, args.output.force, &FILES)?;
    }
    let Input { name, mut run, bytes, shaped } = input::mesh(name, run, results)?;
    let Made { mut simulation, report, outline, fibres, picture } =
        run.make(shaped, |file| FILES.bytes(file))?;
    // What repeats the run is what was taken.
    run.fibre = fibres.taken;
    timings.mesh_s = start.elapsed().as_secs_f64();

    let stage = Instant::now();
    let default = || stencil::worthwhile_threads(simulation.mesh.len());
    simulation.numerics.engine.threads = args.threads.map_or_else(default, usize::from);
    let prepared = simulation.build()?;
    timings.preparation_s = stage.elapsed().as_secs_f64();
    let mut warnings = run.warnings(&report);
    warnings.extend(prepared.warnings());
    let quiet = args.output.quiet;
    if !quiet {
        for warning in &warnings {
            print::warn(warning);
        }
    }
    let of_picture = picture.is_some().then(|| fibres.report());
    if args.dry_run {
        let fibres = of_picture.as_ref();
        plan::plan(args, &outputs, &run, &simulation, &prepared, &report, fibres, &target)?;
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::heed("the run ends here, and what it has computed is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;

    let outcome = watch::beat(&prepared, quiet, &mut timings);

    let stage = Instant::now();
    let afterwards = prepared.warnings_after(&outcome);
    if !quiet {
        for warning in &afterwards {
            print::warn(warning);
        }
    }
    warnings.extend(afterwards);
    let over = Over {
        name: &name,
        run: &run,
        bytes: &bytes,
        simulation: &simulation,
        report: &report,
        outline: &outline,
        fibres: &fibres,
        picture: picture.as_ref(),
        outcome: &outcome,
        read: &|file| FILES.bytes(file),
    };
    let summary = over.summary(warnings);
    let numbers =
        Numbers { summary: &summary, fibres: of_picture.as_ref(), integration: outcome.effort };
    let Kept { written, recorded } =
        over.keep(&folder, &numbers, &outputs, args.look, (&mut timings, start, stage))?;
    let target = folder.finish(&Terminal::new(true))?;

    if args.output.json {
        #[derive(Serialize)]
        struct Printed<'a> {
            results: &'a Path,
            stop: Option<Stop<'a>>,
            timings: Timings,
            outputs: &'a outputs::Record,
            #[serde(flatten)]
            numbers: Numbers<'a>,
        }
        let (stop, outputs) = (Stop::of(&outcome), &written);
        let printed = Printed { results: &target, stop, timings, outputs, numbers };
        print::out(&json::for_people(&printed)?)?;
    } else {
        print::out(&words::for_people(&name, &run, &numbers))?;
        print::out(&words::in_words(&outcome.effort))?;
        if let Some(about) = &summary.about_model {
            print::out(&format!("\n{about}"))?;
        }
        print::out(&words::results(&target, timings.total_s, &written))?;
    }
    if let Some(stop) = &outcome.stop {
        print::note(&format!("error: the run stopped early: {stop}"));
        print::note(&format!("what was computed up to there is in {}", target.display()));
    }
    let errors = written.errors();
    for error in &errors {
        print::note(&format!("error: {error}"));
    }
    if !errors.is_empty() {
        print::note(&format!("curves and numbers are in {}", target.display()));
        return Ok(ExitCode::from(BAD_INPUT));
    }
    recorded?;
    Ok(if outcome.stop.is_some() { ExitCode::from(1) } else { ExitCode::SUCCESS })
}
