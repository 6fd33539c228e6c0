//! `myospring fit`.

mod files;
mod film;
mod map;
mod page;
mod shapes;
mod words;

use crate::analyse::table::{self, quantity};
use crate::args::FitArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::{self, Input};
use crate::options::Given;
use crate::terminal::Terminal;
use crate::{interrupt, print, progress};
use files::Cell;
use map::Mapped;
use myospring::experiment::track::Report;
use myospring::experiment::{Beats, Folder, tables};
use myospring::fit::{Fit, FitError, Fitter, Loaded, Observed, Settings, Unknown, of_each_cell};
use myospring::measured::{Curve, Options};
use myospring::mechanics::support::SupportKind;
use myospring::output::json;
use myospring::settings::{self, Run, Setting, Value};
use myospring::study::Threads;
use myospring::units::Dimension;
use shapes::Shapes;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Of a bar.
const WHOLE: f64 = 1000.0;

pub(crate) fn fit(args: &FitArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    input::one_cell(args.settings.all_cells())?;
    let pixel = args.settings.get("segmentation.pixel_size").and_then(Value::as_text);
    let options =
        table::options(&args.table, pixel, args.until.as_deref().map(|until| ("--until", until)))?;
    let beats = table::beats(&args.stimuli, None, false)?;
    args.input.iter().chain(&args.to).for_each(|path| FILES.note(path));
    if let Some(target) = &args.output.output {
        Folder::check(target, args.output.force, &FILES)?;
    }
    let film = film::named(args)?;
    let (overrides, taken) = overrides(args);
    let followed = film.as_deref().map(|film| film::follow(args, film, &overrides)).transpose()?;
    let tracked = followed.as_ref().zip(film.as_deref());
    let tracked = tracked.map(|(followed, film)| Report::of(film, followed));
    if let (Some(followed), Some(report), true) = (&followed, &tracked, interrupt::asked()) {
        let name = args.input.as_ref().or(film.as_ref()).and_then(|path| path.file_stem());
        let name = name.unwrap_or_default().to_string_lossy();
        let target = args.output.output.clone().unwrap_or_else(|| target(&name, args, &[]));
        let folder = Folder::claim(&target, args.output.force, &FILES)?;
        film::write(&folder, &target, followed, report, &name, &mut followed.run.clone(), false)?;
        return film::only_followed(folder);
    }
    let (curves, mut notes) = match &tracked {
        Some(report) => {
            let curve = film::curve(args, &report.rows)?;
            let curve = curve.part(options.from_ms, options.until_ms).map_err(Failure::new)?;
            (vec![(curve.name.clone(), Ok(curve))], report.warnings.clone())
        }
        None => curves(&tables::tables(&args.to)?, &options)?,
    };
    notes.extend(taken);
    let loaded = args
        .loaded
        .iter()
        .map(|text| held(text, &options, &beats))
        .collect::<Result<Vec<_>, _>>()?;
    if curves.len() > 1 && !loaded.is_empty() {
        return Err(Failure::new(format!(
            "--loaded is of one cell, and there are {} curves in --to",
            curves.len()
        ))
        .advise("--columns chooses the cell's own"));
    }
    // A film that stands alone is its own picture.
    let own = args.input.as_ref().is_none_or(|input| Some(input) == film.as_ref());
    let (name, mut run, shaped) = match &followed {
        Some(followed) if own => {
            let name = film.as_deref().and_then(Path::file_stem).unwrap_or_default();
            (name.to_string_lossy().into_owned(), followed.run.clone(), followed.shaped.clone())
        }
        _ => {
            let read = input::read(args.input.as_deref(), &overrides, Some(&args.output));
            let Input { name, run, shaped, .. } = read?;
            (name, run, shaped)
        }
    };
    let made = run.make(shaped, |file| FILES.bytes(file))?;
    run.fibre = made.fibres.taken;
    let (report, outline) = (made.report, made.outline);
    let fitter = Fitter::new(made.simulation).map_err(Failure::new)?;
    let settings = sought(args, &run, !loaded.is_empty())?;
    let target = args.output.output.clone().unwrap_or_else(|| target(&name, args, &curves));
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    interrupt::heed(interrupt::WRITING);

    let quiet = args.output.quiet;
    let bar = progress::of_members(quiet, WHOLE as usize, "‰ of the fits");
    let done = AtomicU64::new(0);
    let count = curves.len();
    let threads = Threads::new(None)?;
    let with_loaded = |observed| {
        let mut all = vec![Loaded { support: fitter.simulation().support, observed }];
        all.extend(loaded.iter().cloned());
        all
    };
    // A curve that is none says so below.
    let first = curves.iter().find_map(|(_, curve)| observed(curve.as_ref().ok()?, &beats).ok());
    let takes = first.and_then(|first| fitter.will_take(&with_loaded(first), &settings).ok());
    if let Some(one) = takes.flatten().filter(|_| !quiet) {
        print::note(&words::will_take(one, count, threads.count()));
    }
    let mut cells = Vec::new();
    for (number, (name, curve)) in curves.iter().enumerate() {
        let curve = match curve {
            Ok(curve) => curve,
            Err(error) => {
                cells.push(Cell { name: name.clone(), found: Err(error.clone()) });
                continue;
            }
        };
        let goes_on = |part: f64| {
            let all = (number as f64 + part) / count as f64;
            let reached = done.fetch_max((WHOLE * all) as u64, Ordering::Relaxed);
            bar.set_position(reached.max((WHOLE * all) as u64));
            !interrupt::asked()
        };
        let found = observed(curve, &beats).and_then(|observed| {
            let all = with_loaded(observed);
            threads.install(|| fitter.fit_loaded(&all, &settings, &goes_on))
        });
        match found {
            Ok(Some(fit)) => cells.push(Cell { name: name.clone(), found: Ok(fit) }),
            Ok(None) => break,
            Err(error) if count == 1 => return Err(failed(&error, &notes)),
            Err(error) => {
                cells.push(Cell { name: name.clone(), found: Err(error.to_string()) });
            }
        }
    }
    bar.finish_and_clear();
    if cells.is_empty() {
        let (Some(followed), Some(report)) = (&followed, &tracked) else {
            print::note("interrupted: nothing was fitted");
            return Ok(ExitCode::from(1));
        };
        film::write(&folder, &target, followed, report, &name, &mut run, own)?;
        return film::only_followed(folder);
    }
    // Of the film's own shape: that of another picture has other points.
    let mapped = match followed.as_ref().filter(|_| own) {
        None => None,
        Some(followed) => match Mapped::of(followed, fitter.simulation()) {
            Ok(mapped) => Some(mapped),
            Err(error) => {
                notes.push(format!("there is no map of tension: {error}"));
                None
            }
        },
    };
    let first = cells.first().and_then(|cell| cell.found.as_ref().ok());
    let shapes = match followed.as_ref().filter(|_| own).zip(first) {
        Some(_) if interrupt::asked() => None,
        Some((followed, fit)) => Shapes::of(followed, &fitter, &run, fit)?,
        None => None,
    };
    if let (Some(followed), Some(report)) = (&followed, &tracked) {
        film::write(&folder, &target, followed, report, &name, &mut run, own)?;
    }
    let context = files::Context {
        run: &run,
        fitter: &fitter,
        report: &report,
        outline: &outline,
        name: &name,
        notes: &notes,
        mapped: mapped.as_ref(),
        shapes: shapes.as_ref(),
    };
    files::write(&folder, &cells, &context)?;
    let target = folder.finish(&Terminal::new(true))?;
    if args.output.json {
        print::out(&json::pretty(&files::records(&cells, &context))?)?;
    } else {
        print::out(&words::for_people(&cells))?;
        if let Some(shapes) = &shapes {
            print::out(&shapes.words())?;
        }
        if let Some(mapped) = &mapped {
            print::out(&mapped.words())?;
        }
        print::out(&format!(
            "\nresults in {} ({:.1} s)",
            target.display(),
            start.elapsed().as_secs_f64()
        ))?;
    }
    if !quiet {
        for note in &notes {
            print::warn(note);
        }
        for (cell, fit) in cells.iter().filter_map(|cell| Some((cell, cell.found.as_ref().ok()?))) {
            for verdict in &fit.verdicts {
                let of = if count > 1 { format!("{}: ", cell.name) } else { String::new() };
                print::warn(&format!("{of}{verdict}"));
            }
        }
        for verdict in mapped.iter().flat_map(Mapped::verdicts) {
            print::warn(&format!("map of tension: {verdict}"));
        }
    }
    let whole = cells.len() == count && cells.iter().all(|cell| cell.found.is_ok());
    Ok(if whole { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// A bed of no stated stiffness has this one: that of `examples/gel.toml`.
const BED: &str = "0.5 kPa/um";

/// The settings that options give, and the word on one that was taken for granted.
fn overrides(args: &FitArgs) -> (Vec<Given>, Option<String>) {
    let mut given = args.settings.overrides();
    // A fit goes along equilibria, so a viscous cell need not be told to.
    if args.settings.get("material.retardation_time").is_some()
        && args.settings.get("numerics.integrator").is_none()
        && let Some(setting) = settings::find("numerics.integrator")
    {
        given.push((setting, Value::Text("quasi-static".to_owned())));
    }
    let bed = "mechanics.bed_stiffness";
    let on_bed =
        args.settings.get("mechanics.support").and_then(Value::as_text) == Some("elastic-bed");
    if on_bed
        && args.settings.get(bed).is_none()
        && let Some(setting) = settings::find(bed)
    {
        given.push((setting, Value::Text(BED.to_owned())));
        let word = format!(
            "how stiff the cell's bed is was not said: {BED} was taken, and tension over stiffness rests on it \
             (--bed-stiffness)"
        );
        return (given, Some(word));
    }
    (given, None)
}

/// A curve by its name, or why it cannot be read.
type Named = (String, Result<Curve, String>);

/// The curves of files, and what was taken for granted of them. Of several files one that cannot be read is a cell that
/// cannot be fitted.
fn curves(paths: &[PathBuf], options: &Options) -> Result<(Vec<Named>, Vec<String>), Failure> {
    let (mut curves, mut notes) = (Vec::new(), Vec::new());
    let several = paths.len() > 1;
    for path in paths {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let table = match FILES.table(path, options) {
            Ok(table) => table,
            Err(error) if several => {
                curves.push((stem.into_owned(), Err(error.to_string())));
                continue;
            }
            Err(error) => return Err(Failure::new(error)),
        };
        notes.extend(table.notes.iter().map(|note| format!("{}: {note}", path.display())));
        let (taken, note) = if options.values.is_empty() && options.kind.is_none() {
            of_each_cell(table.curves)
        } else {
            (table.curves, None)
        };
        notes.extend(note.map(|note| format!("{}: {note}", path.display())));
        for mut curve in taken {
            if several {
                curve.name = format!("{stem} {}", curve.name);
            }
            curves.push((curve.name.clone(), Ok(curve)));
        }
    }
    if let Some((_, Err(error))) = curves.first()
        && curves.iter().all(|(_, curve)| curve.is_err())
    {
        let many = format!("none of {} files can be read as a table of curves", curves.len());
        return Err(Failure::new(many).also(error));
    }
    Ok((curves, notes))
}

fn observed(curve: &Curve, beats: &Beats) -> Result<Observed, FitError> {
    let stimuli = beats.within(curve).stimuli_ms;
    Observed::of(curve, (!stimuli.is_empty()).then_some(stimuli.as_slice()))
}

/// A curve of the cell between springs: `100 nN/um=fibres.csv`.
fn held(text: &str, options: &Options, beats: &Beats) -> Result<Loaded, Failure> {
    let wrong = || {
        Failure::new(format!("--loaded: `{text}` is no stiffness and no table"))
            .advise("write like --loaded \"100 nN/um=fibres.csv\"")
    };
    let (stiffness, path) = text.split_once('=').ok_or_else(wrong)?;
    let stiffness = quantity("--loaded", stiffness.trim(), Dimension::Stiffness)?;
    let bounds = settings::find("mechanics.end_stiffness").and_then(Setting::bounds);
    if let Some(bounds) = bounds.filter(|bounds| !bounds.contains(stiffness)) {
        let words = bounds.words().unwrap_or_default();
        return Err(Failure::new(format!("--loaded: {stiffness} nN/um; it must be {words}")));
    }
    let path = PathBuf::from(path.trim());
    FILES.note(&path);
    let table = FILES.table(&path, options).map_err(Failure::new)?;
    let [curve] = table.curves.as_slice() else {
        return Err(Failure::new(format!(
            "`{}` has {} curves; a loaded curve is one",
            path.display(),
            table.curves.len()
        ))
        .advise("--mean takes the mean of all, --columns chooses one"));
    };
    let mut observed = observed(curve, beats).map_err(Failure::new)?;
    observed.name = format!("{stiffness} nN/um");
    Ok(Loaded { support: SupportKind::SpringHeldEnds { stiffness }, observed })
}

/// What is sought.
fn sought(args: &FitArgs, run: &Run, loaded: bool) -> Result<Settings, Failure> {
    let free = Settings::asked(&*run.cell, &args.free, &args.fix, loaded);
    let free = free.map_err(|error| match error {
        FitError::NotSought { name, sought } => {
            Failure::new(format!("--fix: `{name}` is not sought anyway"))
                .advise(format!("sought are {sought}"))
        }
        error => Failure::new(error),
    })?;
    let bound = |text: &String| {
        let read = || {
            let (name, ends) = text.split_once('=')?;
            let (low, high) = ends.split_once(':')?;
            let (low, high) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
            Some((Unknown::named(name.trim()), [low, high]))
        };
        let (unknown, ends) = read().ok_or_else(|| {
            Failure::new(format!("--bounds: `{text}` is none"))
                .advise("write like --bounds c_0=0.01:0.05, in the unit of the parameter")
        })?;
        if !free.contains(&unknown) {
            let known: Vec<&str> = free.iter().map(Unknown::name).collect();
            return Err(Failure::new(format!("--bounds: `{unknown}` is not sought"))
                .advise(format!("sought are {}; --free adds others", known.join(", "))));
        }
        Ok((unknown, ends))
    };
    let bounds = args.bounds.iter().map(bound).collect::<Result<_, _>>()?;
    Ok(Settings { free: Some(free), bounds, starts: args.starts.get(), seed: args.fit_seed })
}

fn failed(error: &FitError, notes: &[String]) -> Failure {
    let advice = match error {
        FitError::Curve { .. } | FitError::NoBeat { .. } => {
            "`myospring analyse` shows the curve and what is seen in it"
        }
        FitError::TooMany { .. } => {
            "`--fix Ca50_ref` holds one; without --free the other two are sought"
        }
        FitError::Kind { .. } => "--columns chooses another column, --kind says what it is",
        _ => return notes.iter().fold(Failure::new(error), |failure, note| failure.also(note)),
    };
    notes.iter().fold(Failure::new(error).advise(advice), |failure, note| failure.also(note))
}

/// Where results go unless that is said.
fn target(name: &str, args: &FitArgs, curves: &[Named]) -> PathBuf {
    let stem = args.to.first().and_then(|path| path.file_stem());
    let of = match stem {
        Some(stem) if args.input.is_none() => stem.to_string_lossy().into_owned(),
        _ => name.to_owned(),
    };
    let many = if curves.len() > 1 { "fits" } else { "fit" };
    Path::new("results").join(format!("{of}_{many}"))
}

/// The fits that there are.
fn fits(cells: &[Cell]) -> impl Iterator<Item = (&Cell, &Fit)> {
    cells.iter().filter_map(|cell| Some((cell, cell.found.as_ref().ok()?)))
}
