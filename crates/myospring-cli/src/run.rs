//! `myospring run`.

mod plan;
mod record;
mod watch;
pub(crate) mod words;

use crate::args::RunArgs;
use crate::failure::{BAD_INPUT, Failure};
use crate::input::{self, Input};
use crate::interrupt;
use crate::outputs::{self, Finished};
use crate::print;
use crate::results::Folder;
use crate::summary::{self, Numbers};
use myospring::compare::factor;
use myospring::integrate::stencil;
use myospring::output::json;
use myospring::output::report::Summary;
use myospring::settings::Made;
use myospring::study::sha256;
use record::{Record, Stop, Timings};
pub(crate) use record::{repeating, resolved};
use serde::Serialize;
use std::path::Path;
use std::process::ExitCode;
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
    let Input { name, mut run, bytes, shaped } = input::mesh(name, run, results)?;
    let Made { mut simulation, report, outline, fibres, picture } =
        run.make(shaped, |file| std::fs::read(file))?;
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
    let target = args.output.output.clone().unwrap_or_else(|| Path::new("results").join(&name));
    let of_picture = picture.is_some().then(|| fibres.report());
    if args.dry_run {
        let fibres = of_picture.as_ref();
        plan::plan(args, &outputs, &run, &simulation, &prepared, &report, fibres, &target)?;
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::heed("the run ends here, and what it has computed is written");
    let folder = Folder::claim(&target, args.output.force)?;

    let outcome = watch::beat(&prepared, quiet, &mut timings);

    let stage = Instant::now();
    let afterwards = prepared.warnings_after(&outcome);
    if !quiet {
        for warning in &afterwards {
            print::warn(warning);
        }
    }
    warnings.extend(afterwards);
    let stimuli = run.stimulus_times();
    let summary = Summary::new(&outcome.recording, &stimuli, report.clone(), warnings);
    let numbers =
        Numbers { summary: &summary, fibres: of_picture.as_ref(), integration: outcome.effort };
    summary::write(&folder, &run, &simulation, &fibres, &outcome, &numbers)?;
    let run_file = resolved(&run, &simulation, report.spacing_um, outcome.effort.time_step());
    folder.write("run.toml", &run_file)?;
    let hashes = [sha256(&bytes.shape), sha256(run_file.as_bytes())];
    let record = |timings, outputs: &outputs::Record| {
        let [shape_sha256, run_file_sha256] = hashes.clone();
        json::pretty(&Record {
            program: "myospring",
            version: env!("CARGO_PKG_VERSION"),
            input: run.shape.file(),
            shape_sha256,
            run_file_sha256,
            stop: Stop::of(&outcome),
            effort: outcome.effort,
            engine: outcome.engine.clone(),
            machine_threads: std::thread::available_parallelism().map_or(1, usize::from),
            timings,
            outputs,
        })
    };
    // From here on there is a whole result, whatever becomes of the outputs.
    folder.write("run.json", record(timings, &outputs::Record::default())?)?;
    let written = outputs::write(
        &folder,
        &outputs,
        &Finished {
            name: &name,
            run: &run,
            simulation: &simulation,
            outline: &outline,
            fibres: &fibres,
            picture: picture.as_ref(),
            outcome: &outcome,
            numbers: &numbers,
            stimuli: &stimuli,
            look: args.look,
        },
    );
    timings.outputs_s = stage.elapsed().as_secs_f64();
    timings.total_s = start.elapsed().as_secs_f64();
    // On a full disk the one without outputs stays.
    let recorded = folder.write("run.json", record(timings, &written)?);
    let target = folder.finish()?;

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
        print::out(&json::pretty(&printed)?)?;
    } else {
        print::out(&words::for_people(&name, &run, &numbers))?;
        print::out(&words::in_words(&outcome.effort))?;
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
