//! `myospring compare`.

mod report;
mod side;
mod words;

use crate::args::CompareArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input;
use crate::interrupt;
use crate::print::{self, progress_bar};
use crate::terminal::Terminal;
use myospring::analysis::beat::{Band, Beats, band};
use myospring::compare::PHENOMENOLOGICAL;
use myospring::compare::dose::{self, Dose};
use myospring::compare::factor::{self, Factor, Scaled};
use myospring::compare::metric::{self, Row};
use myospring::compare::setting::{self, Different};
use myospring::experiment::Folder;
use myospring::experiment::inputs::{self, Inputs};
use myospring::output::figure::{self, Compared, ContractionOptions, Theme};
use myospring::output::{csv, json};
use myospring::run_file::RunFile;
use myospring::study::Threads;
use rayon::prelude::*;
use serde::Serialize;
use side::{Job, Side};
use std::path::Path;
use std::time::Instant;

/// comparison.json.
#[derive(Serialize)]
struct Record<'a> {
    program: &'static str,
    version: &'static str,
    runs: Vec<Told<'a>>,
    warnings: &'a [String],
    /// In which the runs differ.
    settings: &'a [Different],
    metrics: &'a [Row],
    total_s: f64,
}

/// A run in comparison.json.
#[derive(Serialize)]
struct Told<'a> {
    label: &'a str,
    /// Where it comes from.
    source: &'a str,
    scaled: &'a [Scaled],
    /// Why it ended early.
    #[serde(skip_serializing_if = "Option::is_none")]
    stop: Option<&'a str>,
}

pub(crate) fn compare(args: &CompareArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    input::one_cell(args.settings.all_cells())?;
    let jobs = jobs(args)?;
    // Before any of them has taken its time.
    jobs.iter().filter(|job| job.folder.is_none()).try_for_each(|job| job.run().map(drop))?;
    let target =
        args.output.output.clone().unwrap_or_else(|| Path::new("results").join("comparison"));
    interrupt::heed_soon("nothing is written");
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let threads = Threads::new(args.jobs.map(usize::from))?;
    let bar = progress_bar(args.output.quiet);
    bar.set_length(jobs.len() as u64 * side::PROGRESS);
    let sides: Result<Vec<Side>, Failure> =
        threads.install(|| jobs.into_par_iter().map(|job| job.side(&bar)).collect());
    bar.finish_and_clear();
    if interrupt::asked() {
        return Ok(ExitCode::from(1));
    }
    let mut sides = sides?;
    let mut inputs = Inputs::default();
    for side in &mut sides {
        inputs.keep(&folder, side.file.clone(), |file| FILES.bytes(file))?;
        side.file = inputs.renamed(side.file.clone(), "../");
        if Path::new(&side.source).is_absolute() {
            side.source = inputs::relative(Path::new(&side.source), &target)
                .unwrap_or_else(|| side.source.clone());
        }
    }

    let labels: Vec<&str> = sides.iter().map(|side| side.label.as_str()).collect();
    let files: Vec<&RunFile> = sides.iter().map(|side| &side.file).collect();
    let settings = setting::different(&files);
    let mut warnings: Vec<String> = sides.iter().flat_map(|side| side.notes.clone()).collect();
    warnings.extend(setting::warnings(&settings, &labels));
    warnings.extend(side::other_pictures(&sides));
    let parameters = settings.iter().any(|different| different.key.starts_with("cell.parameters."));
    let lumped = |file: &&RunFile| file.resolve().is_ok_and(|run| run.cell.lumps_currents());
    if (args.doses.is_some() || parameters) && files.iter().any(lumped) {
        warnings.push(PHENOMENOLOGICAL.to_owned());
    }
    if !args.output.quiet {
        for warning in &warnings {
            print::warn(warning);
        }
    }
    let beats: Vec<Beats> =
        sides.iter().map(|side| Beats::of(&side.recording, &side.stimuli, side.s2_ms)).collect();
    let metrics = metric::rows(&beats.iter().collect::<Vec<_>>());
    for (number, side) in (1..).zip(&sides) {
        folder.write(&format!("runs/traces_{number}.csv"), csv::traces(&side.recording)?)?;
        folder.write(&format!("runs/run_{number}.toml"), side.file.to_toml())?;
    }
    folder.write("metrics.csv", words::csv(&labels, &metrics)?)?;
    figures(&folder, &sides)?;
    let differences = words::differences(&settings, &sides);
    let look = report::write(&folder, &sides, &differences, &warnings, &inputs)?;
    let record = Record {
        program: "myospring",
        version: env!("CARGO_PKG_VERSION"),
        runs: sides.iter().map(Side::told).collect(),
        warnings: &warnings,
        settings: &settings,
        metrics: &metrics,
        total_s: start.elapsed().as_secs_f64(),
    };
    let record_text = json::for_people(&record)?;
    folder.write("comparison.json", &record_text)?;
    let target = folder.finish(&Terminal::new(true))?;
    if args.output.json {
        print::out(&record_text)?;
    } else {
        print::out(&words::for_people(&labels, &differences, &metrics))?;
        print::out(&format!(
            "\nresults in {} ({:.1} s)\nopen {}",
            target.display(),
            record.total_s,
            target.join(look).display()
        ))?;
    }
    let stopped = sides.iter().any(|side| side.stop.is_some());
    Ok(if stopped { ExitCode::from(1) } else { ExitCode::SUCCESS })
}

/// What is to be compared: every input as it is, then with each set of factors, then at each dose.
fn jobs(args: &CompareArgs) -> Result<Vec<Job>, Failure> {
    let variants = variants(args)?;
    let overrides = args.settings.overrides();
    let inputs: Vec<Option<&Path>> = match args.inputs.as_slice() {
        [] => vec![None],
        inputs => inputs.iter().map(|path| Some(path.as_path())).collect(),
    };
    let alone = inputs.len() == 1;
    let mut jobs = Vec::new();
    for path in inputs {
        let folder = path.filter(|path| path.is_dir());
        if let Some(folder) = folder {
            side::check_folder(folder)?;
            if !overrides.is_empty() {
                let file = folder.join("run.toml");
                return Err(Failure::new(format!(
                    "`{}` holds results, which options do not change",
                    folder.display()
                ))
                .advise(format!("give {} to run it anew", file.display())));
            }
        }
        let file = folder.map(|folder| folder.join("run.toml"));
        let path = file.as_deref().or(path);
        let (name, run) = input::settle(path, &overrides)?;
        let name =
            folder.and_then(Path::file_name).map_or(name, |name| name.to_string_lossy().into());
        let name = if run.title.is_empty() { name } else { run.title };
        let base = if alone && !variants.is_empty() { "control".to_owned() } else { name.clone() };
        jobs.push(Job {
            label: base,
            folder: folder.map(Path::to_owned),
            path: path.map(Path::to_owned),
            overrides: overrides.clone(),
            factors: Vec::new(),
        });
        for Dose { label, factors } in &variants {
            let label = if alone { label.clone() } else { format!("{name}, {label}") };
            jobs.push(Job {
                label,
                folder: None,
                path: path.map(Path::to_owned),
                overrides: overrides.clone(),
                factors: factors.clone(),
            });
        }
    }
    if jobs.len() < 2 {
        return Err(Failure::new("one run is nothing to compare").advise(
            "give two or more result folders or run files, or change one with --scale or --doses",
        ));
    }
    for index in 1..jobs.len() {
        let (before, label) = (&jobs[..index], jobs[index].label.clone());
        let count = before.iter().filter(|job| job.label == label).count();
        if count > 0 {
            jobs[index].label = format!("{label} ({})", index + 1);
        }
    }
    Ok(jobs)
}

/// The factors of `--scale` and of the doses, each with a label.
fn variants(args: &CompareArgs) -> Result<Vec<Dose>, Failure> {
    let mut variants = Vec::new();
    for text in &args.scale {
        let factors = factor::parse(text)?;
        let label = |Factor { name, factor }: &Factor| format!("{name} \u{d7} {factor}");
        let label = factors.iter().map(label).collect::<Vec<_>>().join(", ");
        variants.push(Dose { label, factors });
    }
    if let Some(path) = &args.doses {
        let text = FILES.text(path)?;
        let doses = dose::read(&text)
            .map_err(|error| Failure::new(format!("{}: {error}", path.display())))?;
        variants.extend(doses.into_iter().filter(|dose| !dose.factors.is_empty()));
    }
    Ok(variants)
}

fn figures(folder: &Folder, sides: &[Side]) -> Result<(), Failure> {
    let compared: Vec<Compared<'_>> = sides.iter().map(Side::compared).collect();
    let curves: Vec<_> = sides.iter().map(|side| (side.label.as_str(), &side.recording)).collect();
    let reference = band("peak_shortening")
        .map(|Band { low, high, .. }| ([*low, *high], "adult ventricular myocytes, unloaded"));
    let options = ContractionOptions { stimulus_times_ms: Vec::new(), reference_band: reference };
    folder.figures(
        Theme::default(),
        &[
            ("compared", &|| figure::compared(&compared)),
            ("contraction", &|| figure::contraction(&curves, &options)),
        ],
        &Terminal::new(true),
    )
}
