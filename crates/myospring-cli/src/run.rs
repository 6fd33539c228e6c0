//! `myospring run`.

use crate::args::RunArgs;
use crate::failure::Failure;
use crate::fibres;
use crate::input::{self, Input};
use crate::interrupt;
use crate::overlay::{self, Lattice};
use crate::print;
use crate::results::Folder;
use crate::table::{aligned, number};
use indicatif::{ProgressBar, ProgressStyle};
use myospring::analysis::Metric;
use myospring::analysis::beat::{Band, Beat, band};
use myospring::integrate::engine::EngineUsed;
use myospring::integrate::stencil;
use myospring::output::figure::{self, ContractionOptions};
use myospring::output::report::Summary;
use myospring::output::{csv, json};
use myospring::settings::{FibreReport, Fibres, Made, Run};
use myospring::simulation::{
    Effort, Observer, Outcome, Part, Progress, Ready, Simulation, StopReason,
};
use myospring::study::sha256;
use serde::Serialize;
use std::fmt::Write as _;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Instant;

/// Where the time went.
#[derive(Debug, Clone, Copy, Default, Serialize)]
#[allow(clippy::struct_field_names, reason = "the names are keys of run.json and carry the unit")]
struct Timings {
    /// Reading the shape and meshing it.
    mesh_s: f64,
    /// Finding the stable time step, or solving the path of equilibria; a reference beat of the cell model
    /// where its parameters are not the published ones.
    preparation_s: f64,
    /// The cell model during the beat.
    cell_s: f64,
    /// The mesh following its tension.
    mechanics_s: f64,
    /// Measuring shapes and keeping samples during the beat.
    recording_s: f64,
    /// Drawing and writing.
    figures_s: f64,
    /// From start to end.
    total_s: f64,
}

#[derive(Serialize)]
struct Record<'a> {
    program: &'static str,
    version: &'static str,
    input: Option<&'a str>,
    shape_sha256: String,
    run_file_sha256: String,
    stop: Option<Stop<'a>>,
    #[serde(flatten)]
    effort: Effort,
    /// What moved the masses, where they were moved in time.
    #[serde(skip_serializing_if = "Option::is_none")]
    engine: Option<EngineUsed>,
    machine_threads: usize,
    timings: Timings,
}

#[derive(Serialize)]
struct Stop<'a> {
    #[serde(flatten)]
    reason: &'a StopReason,
    message: String,
}

impl<'a> Stop<'a> {
    fn of(outcome: &'a Outcome) -> Option<Self> {
        outcome.stop.as_ref().map(|reason| Self { reason, message: reason.to_string() })
    }
}

/// summary.json.
#[derive(Serialize)]
pub(crate) struct Numbers<'a> {
    #[serde(flatten)]
    pub(crate) summary: &'a Summary,
    /// Of a picture.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) fibres: Option<&'a FibreReport>,
    pub(crate) integration: Effort,
}

pub(crate) fn run(args: &RunArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let mut timings = Timings::default();
    input::one_cell(args.settings.all_cells())?;
    let results = Some(&args.output).filter(|_| !args.dry_run);
    let Input { name, mut run, bytes, shaped } =
        input::read(args.input.as_deref(), args.settings.overrides(), results)?;
    let Made { mut simulation, report, fibres, picture } =
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
    if args.dry_run {
        let fibres = picture.is_some().then(|| fibres.report());
        plan(args, &run, &simulation, &prepared, &report, fibres.as_ref(), &target)?;
        return Ok(ExitCode::SUCCESS);
    }
    interrupt::heed("the run ends here, and what it has computed is written");
    let folder = Folder::claim(&target, args.output.force)?;

    let outcome = beat(&prepared, quiet, &mut timings);

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
    if let Some((cells, cell)) = &picture {
        let lattice = Some(Lattice { mesh: &simulation.mesh, fibres: &fibres });
        let draw = || overlay::draw(&name, cells, &[cell], lattice, &summary.warnings);
        folder.figures(&[("overlay", &draw)])?;
    }
    let of_picture = picture.is_some().then(|| fibres.report());
    let numbers =
        Numbers { summary: &summary, fibres: of_picture.as_ref(), integration: outcome.effort };
    write(&folder, &run, &simulation, &fibres, &outcome, &numbers, &stimuli)?;
    timings.figures_s = stage.elapsed().as_secs_f64();
    timings.total_s = start.elapsed().as_secs_f64();
    let run_file = resolved(&run, &simulation, report.spacing_um, outcome.effort.time_step());
    let record = Record {
        program: "myospring",
        version: env!("CARGO_PKG_VERSION"),
        input: run.shape.file(),
        shape_sha256: sha256(&bytes.shape),
        run_file_sha256: sha256(run_file.as_bytes()),
        stop: Stop::of(&outcome),
        effort: outcome.effort,
        engine: outcome.engine.clone(),
        machine_threads: std::thread::available_parallelism().map_or(1, usize::from),
        timings,
    };
    folder.write("run.toml", &run_file)?;
    folder.write("run.json", json::pretty(&record)?)?;
    let target = folder.finish()?;

    if args.output.json {
        #[derive(Serialize)]
        struct Printed<'a> {
            results: &'a Path,
            stop: Option<Stop<'a>>,
            timings: Timings,
            #[serde(flatten)]
            numbers: Numbers<'a>,
        }
        let stop = Stop::of(&outcome);
        let printed = Printed { results: &target, stop, timings, numbers };
        print::out(&json::pretty(&printed)?)?;
    } else {
        print::out(&for_people(&name, &run, &numbers))?;
        print::out(&in_words(&outcome.effort))?;
        print::out(&format!("\nresults in {} ({:.2} s)", target.display(), timings.total_s))?;
    }
    if let Some(stop) = &outcome.stop {
        print::note(&format!("error: the run stopped early: {stop}"));
        print::note(&format!("what was computed up to there is in {}", target.display()));
        return Ok(ExitCode::from(1));
    }
    Ok(ExitCode::SUCCESS)
}

/// Runs with a progress bar where there is a terminal to show it, and measures what the parts take.
fn beat(prepared: &Ready, quiet: bool, timings: &mut Timings) -> Outcome {
    let mut watch = Watch { bar: progress_bar(quiet), timings, at: None };
    let outcome = prepared.run_observed(&mut watch);
    watch.turn(None);
    watch.bar.finish_and_clear();
    outcome
}

/// Shows how far a run has come and adds up what its parts take.
struct Watch<'a> {
    bar: ProgressBar,
    timings: &'a mut Timings,
    /// What the run is at, and since when.
    at: Option<(Part, Instant)>,
}

impl Watch<'_> {
    fn turn(&mut self, next: Option<Part>) {
        let now = Instant::now();
        if let Some((part, since)) = self.at {
            let total = match part {
                Part::Cell => &mut self.timings.cell_s,
                Part::Mechanics => &mut self.timings.mechanics_s,
                Part::Recording => &mut self.timings.recording_s,
            };
            *total += (now - since).as_secs_f64();
        }
        self.at = next.map(|part| (part, now));
    }
}

impl Observer for Watch<'_> {
    fn sample(&mut self, Progress { time, duration }: Progress) -> bool {
        self.bar.set_length(duration as u64);
        self.bar.set_position(time as u64);
        !interrupt::asked()
    }

    fn begins(&mut self, part: Part) {
        self.turn(Some(part));
    }
}

/// A bar on a terminal, else one that is not seen.
pub(crate) fn progress_bar(quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new(0);
    let style = ProgressStyle::with_template("beating {wide_bar:.cyan} {pos}/{len} ms, {eta} left");
    if let Ok(style) = style {
        bar.set_style(style);
    }
    bar
}

/// The run file that repeats this run: spacing, time step and files spelled out.
fn resolved(run: &Run, simulation: &Simulation, spacing: f64, time_step: Option<f64>) -> String {
    let mut file = run.settled(spacing, time_step);
    for path in file.paths_mut() {
        if let Ok(absolute) = std::path::absolute(&*path) {
            *path = absolute.to_string_lossy().into_owned();
        }
    }
    let text = file.to_toml();
    let model = simulation.cell.name();
    format!(
        "# Written by myospring {}: every setting of this run ({model}).\n{text}",
        env!("CARGO_PKG_VERSION")
    )
}

pub(crate) fn write(
    folder: &Folder,
    run: &Run,
    simulation: &Simulation,
    fibres: &Fibres,
    outcome: &Outcome,
    numbers: &Numbers<'_>,
    stimuli: &[f64],
) -> Result<(), Failure> {
    let Outcome { recording, .. } = outcome;
    folder.write("traces.csv", csv::traces(recording)?)?;
    folder.write("summary.json", json::pretty(numbers)?)?;
    fibres::write(folder, [(run.shape.name(), &simulation.mesh, fibres)])?;
    let (mesh, fibres) = (&simulation.mesh, &simulation.fibres);
    let reference = band("peak_shortening")
        .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
    let options =
        ContractionOptions { stimulus_times_ms: stimuli.to_vec(), reference_band: reference };
    let label = format!("{} kPa", run.peak_tension);
    folder.figures(&[
        ("overview", &|| figure::overview(mesh, recording, fibres, stimuli)),
        ("cell", &|| figure::cell_shapes(mesh, &figure::key_shapes(recording, stimuli), fibres)),
        ("mesh", &|| figure::mesh(mesh)),
        ("action_potential_and_tension", &|| {
            figure::action_potential_and_tension(recording, stimuli)
        }),
        ("contraction", &|| figure::contraction(&[(&label, recording)], &options)),
    ])
}

/// Shown where the cell becomes longer rather than shorter.
const LENGTHENING: &str = "peak_lengthening";

/// Rows of the table after a run: metric and what people call it.
const ROWS: [(&str, &str); 15] = [
    ("peak_tension", "peak tension"),
    ("time_to_peak_tension", "time to peak tension, from stimulus"),
    ("resting_length", "resting length"),
    ("peak_shortening", "peak shortening"),
    (LENGTHENING, "peak lengthening"),
    ("time_to_peak_from_stimulus", "time to peak shortening, from stimulus"),
    ("lag_of_shortening", "lag of shortening behind tension"),
    ("maximum_shortening_rate", "largest shortening rate"),
    ("maximum_relengthening_rate", "largest relengthening rate"),
    ("relaxation_time_50", "peak to 50 % relengthened"),
    ("relaxation_time_90", "peak to 90 % relengthened"),
    ("width_change_at_peak", "width change at peak"),
    ("isovolumic_width_change", "  that would keep the volume"),
    ("area_change_at_peak", "projected area change at peak"),
    ("action_potential_duration_90", "APD90"),
];

/// The table after a run; of several beats, mean and standard deviation.
fn for_people(name: &str, run: &Run, numbers: &Numbers<'_>) -> String {
    let summary = numbers.summary;
    let title = if run.title.is_empty() { name } else { &run.title };
    let beats = summary.beats.len();
    let mut text = format!(
        "{title}: {beats} beat{} of {} at {} kPa\n\n",
        if beats == 1 { "" } else { "s" },
        run.cell.name(),
        run.peak_tension
    );
    let spread = beats > 1;
    let mut header = vec!["quantity".to_owned(), "value".to_owned()];
    if spread {
        header.push("+- sd".to_owned());
    }
    header.extend(["unit".to_owned(), "band*".to_owned()]);
    let mut rows = vec![header];
    let Some(first) = summary.beats.first() else {
        text.push_str("no stimulus, so nothing to measure\n");
        return text;
    };
    for (metric, words) in ROWS {
        let Some(Metric { value, unit, .. }) = first.metrics().find(|m| m.name == metric) else {
            continue;
        };
        let shorter = first.value("peak_shortening").unwrap_or(0.0);
        if metric == LENGTHENING && value.is_none_or(|longer| longer <= shorter) {
            continue;
        }
        let over_beats = summary.beat_to_beat.iter().find(|spread| spread.name == metric);
        let value = over_beats.map(|spread| spread.mean).or(*value);
        let mut row = vec![words.to_owned(), value.map_or_else(|| "-".to_owned(), number)];
        if spread {
            row.push(over_beats.map_or_else(String::new, |s| number(s.standard_deviation)));
        }
        let reference = band(metric).map(|Band { low, high, .. }| format!("{low} to {high}"));
        let last = match value {
            Some(_) => reference.unwrap_or_default(),
            None => why_not(first, metric).to_owned(),
        };
        row.extend([(*unit).to_owned(), last]);
        rows.push(row);
    }
    let right: &[usize] = if spread { &[1, 2] } else { &[1] };
    let fibres = numbers.fibres;
    if let Some(length) = fibres.and_then(|report| report.seen?.sarcomere_um) {
        let mut row = vec!["sarcomere length at rest, median".to_owned(), number(length)];
        row.extend(spread.then(String::new));
        row.extend(["um".to_owned(), String::new()]);
        rows.push(row);
    }
    text.push_str(&aligned(&rows, right));
    text.push_str("* bands of unloaded adult ventricular myocytes: what is seen, not a target\n");
    if let Some(fibres) = fibres {
        let _ = writeln!(text, "fibres: {fibres}");
    }
    text
}

/// Why a beat has no such metric.
fn why_not(beat: &Beat, metric: &str) -> &'static str {
    let of_shortening = beat.contraction.iter().chain(&beat.shape).any(|row| row.name == metric)
        || metric == "lag_of_shortening";
    if of_shortening && beat.value("peak_shortening").is_none() {
        "none: the cell does not shorten"
    } else {
        "none: not reached within the beat"
    }
}

/// What the run took, in a line.
fn in_words(effort: &Effort) -> String {
    match *effort {
        Effort::OwnStepper { time_step_ms, steps, .. } => {
            format!("own stepper: {steps} steps of {time_step_ms:.4} ms")
        }
        Effort::Verlet { time_step_ms, stability_limit_ms, steps } => format!(
            "Verlet: {steps} steps of {time_step_ms:.4} ms, stable up to {stability_limit_ms:.4} ms"
        ),
        Effort::QuasiStatic {
            load_steps,
            newton_iterations,
            factorisations,
            interpolation_error_um,
            delay_ms,
        } => format!(
            "quasi-static: {load_steps} load steps, {newton_iterations} Newton iterations, \
             {factorisations} factorisations\n\
             positions to {interpolation_error_um:.1e} um; a motion with the same dampings lags {delay_ms:.2} ms"
        ),
        Effort::Field { equilibria, newton_iterations, factorisations } => format!(
            "quasi-static, tension by place: {equilibria} equilibria, {newton_iterations} Newton iterations, \
             {factorisations} factorisations"
        ),
    }
}

#[derive(Serialize)]
struct Plan<'a> {
    name: &'a str,
    model: &'a str,
    results: &'a Path,
    #[serde(flatten)]
    effort: Effort,
    #[serde(skip_serializing_if = "Option::is_none")]
    spring_updates: Option<f64>,
    estimated_s: f64,
    run_file: String,
    mesh: &'a myospring::mesh::quality::MeshReport,
    #[serde(skip_serializing_if = "Option::is_none")]
    fibres: Option<&'a FibreReport>,
}

fn plan(
    args: &RunArgs,
    run: &Run,
    simulation: &Simulation,
    prepared: &Ready,
    report: &myospring::mesh::quality::MeshReport,
    fibres: Option<&FibreReport>,
    target: &PathBuf,
) -> Result<(), Failure> {
    // The first interval of output tells how long the rest of a motion will take; a path is solved.
    let start = Instant::now();
    let first = prepared.run(|progress| progress.time <= 0.0);
    let intervals = match prepared {
        Ready::InTime(_) | Ready::FromRestToRest(_) => {
            run.duration / run.numerics.output_interval.max(1e-9)
        }
        Ready::AlongPath(_) => 1.0,
    };
    let estimate = start.elapsed().as_secs_f64() * intervals;
    let mut effort = first.effort;
    let mut spring_updates = None;
    if let (Ready::InTime(prepared), Effort::Verlet { steps, .. }) = (prepared, &mut effort) {
        let exchanges = (run.duration / run.numerics.exchange_interval).round();
        let whole = exchanges * prepared.steps_per_exchange as f64;
        *steps = whole as u64;
        spring_updates = Some(whole * simulation.mesh.springs.len() as f64);
    }
    if let Ready::AlongPath(path) = prepared
        && let Some(end) = &path.end
    {
        print::warn(&format!("the run will stop early: {end}"));
    }
    let plan = Plan {
        name: run.shape.name(),
        model: run.cell.name(),
        results: target,
        effort,
        spring_updates,
        estimated_s: estimate,
        run_file: resolved(run, simulation, report.spacing_um, effort.time_step()),
        mesh: report,
        fibres,
    };
    if args.output.json {
        print::out(&json::pretty(&plan)?)?;
        return Ok(());
    }
    let mut rows = vec![
        ("cell model", plan.model.to_owned()),
        ("beats", format!("{} in {} ms", run.protocol.beats, run.duration)),
        ("peak tension", format!("{} kPa", run.peak_tension)),
    ];
    rows.extend(fibres.map(|fibres| ("fibres", fibres.to_string())));
    match effort {
        Effort::Verlet { time_step_ms, stability_limit_ms, steps } => rows.extend([
            ("integrator", "Verlet, in time".to_owned()),
            ("time step", format!("{time_step_ms:.4} ms")),
            ("stability limit", format!("{stability_limit_ms:.4} ms")),
            ("steps", steps.to_string()),
        ]),
        Effort::QuasiStatic {
            load_steps,
            newton_iterations,
            interpolation_error_um,
            delay_ms,
            ..
        } => rows.extend([
            ("integrator", "quasi-static, along the path of equilibria".to_owned()),
            ("load steps", format!("{load_steps}, {newton_iterations} Newton iterations")),
            ("error of positions", format!("{interpolation_error_um:.1e} um")),
            ("lag of a motion", format!("{delay_ms:.2} ms")),
        ]),
        Effort::Field { .. } => {
            rows.push(("integrator", "quasi-static, tension by place".to_owned()));
        }
        Effort::OwnStepper { time_step_ms, .. } => rows.extend([
            ("integrator", "own stepper, in time".to_owned()),
            ("time step", format!("{time_step_ms:.4} ms")),
        ]),
    }
    if let Some(updates) = spring_updates {
        rows.push(("spring updates", format!("{updates:.2e}")));
    }
    rows.push(("estimated time", format!("{:.1} s", plan.estimated_s)));
    rows.push(("results would go to", target.display().to_string()));
    let rows: Vec<Vec<String>> =
        rows.into_iter().map(|(name, value)| vec![name.to_owned(), value]).collect();
    // Warnings have gone to stderr.
    let mesh = report.to_string();
    let mesh: Vec<&str> = mesh.lines().filter(|line| !line.starts_with("warning")).collect();
    print::out(&format!("Mesh\n{}\n\nPlan\n{}", mesh.join("\n"), aligned(&rows, &[])))?;
    print::out("nothing was written (--dry-run)")?;
    Ok(())
}
