//! `myospring fit`.

mod words;

use crate::analyse::table::{self, quantity};
use crate::args::FitArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{input, interrupt, print};
use myospring::experiment::fit::{EndSprings, FitCell, RecordedCalcium, TractionCurve};
use myospring::experiment::{Folder, Outcome as _};
use myospring::fit::FitOptions;
use myospring::output::json;
use myospring::settings::Value;
use myospring::units::Dimension;
use std::path::{Path, PathBuf};
use std::time::Instant;

pub(crate) fn fit(args: &FitArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    input::one_cell(args.settings.all_cells())?;
    let asked = asked(args)?;
    let (terminal, quiet) = (Terminal::new(args.output.quiet), args.output.quiet);
    let read = args.input.iter().chain(&args.to).chain(&args.recorded_calcium);
    read.for_each(|path| FILES.note(path));
    if let Some(target) = &args.output.output {
        Folder::check(target, args.output.force, &FILES)?;
    }
    let ready = asked.ready(&FILES, &terminal)?;
    let target = args.output.output.clone();
    let target = target.unwrap_or_else(|| Path::new("results").join(ready.results()));
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    interrupt::heed(interrupt::WRITING);
    let fits = ready.run(&terminal)?;
    terminal.clear();
    if fits.cells.is_empty() && fits.film.is_none() {
        print::note("interrupted: nothing was fitted");
        return Ok(ExitCode::from(1));
    }
    fits.save(&folder, &terminal)?;
    let target = folder.finish(&terminal)?;
    if fits.cells.is_empty() {
        print::note(&format!(
            "interrupted: nothing was fitted; the frames that were followed are in {}",
            target.display()
        ));
        return Ok(ExitCode::from(1));
    }
    if args.output.json {
        print::out(&json::pretty(&fits.numbers())?)?;
    } else {
        print::out(&words::for_people(&fits))?;
        let seconds = start.elapsed().as_secs_f64();
        print::out(&format!("\nresults in {} ({seconds:.1} s)", target.display()))?;
    }
    if !quiet {
        fits.warnings().iter().for_each(|warning| print::warn(warning));
    }
    Ok(if fits.is_whole() { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The fit that the arguments describe.
fn asked(args: &FitArgs) -> Result<FitCell, Failure> {
    let pixel = args.settings.get("shape.pixel_size").and_then(Value::as_text);
    let named = args.input.as_ref().or(args.to.first()).and_then(|path| path.file_stem());
    let name = named.unwrap_or_default().to_string_lossy();
    let until = args.until.as_deref().map(|until| ("--until", until));
    Ok(FitCell {
        cell: args.input.clone(),
        to: args.to.clone(),
        settings: args.settings.overrides(),
        table: table::options(&args.table, pixel, until)?,
        beats: table::beats(&args.stimuli, None, false)?,
        loaded: args.loaded.iter().map(|text| spring(text)).collect::<Result<_, _>>()?,
        traction: args.traction.iter().map(|text| traction(text)).collect::<Result<_, _>>()?,
        traction_error: args
            .traction_error
            .as_deref()
            .map(|text| Ok::<_, Failure>(percent("--traction-error", text)? / 100.0))
            .transpose()?,
        calcium: RecordedCalcium {
            path: args.recorded_calcium.clone(),
            rest_um: concentration("--calcium-rest", args.calcium_rest.as_deref())?,
            peak_um: concentration("--calcium-peak", args.calcium_peak.as_deref())?,
        },
        sought: FitOptions {
            free: args.free.clone(),
            fix: args.fix.clone(),
            bounds: args.bounds.iter().map(|text| bounds(text)).collect::<Result<_, _>>()?,
            starts: args.starts.get(),
            seed: args.fit_seed,
            peak_shortening_pct: args
                .peak_shortening
                .as_deref()
                .map(|text| percent("--peak-shortening", text))
                .transpose()?,
        },
        threads: None,
        refused: Some(input::refusals(&args.output, name.trim_end_matches(".ome"))),
    })
}

/// `10 %`, or 10.
fn percent(option: &str, text: &str) -> Result<f64, Failure> {
    text.trim().trim_end_matches('%').trim_end().parse().map_err(|_| {
        Failure::new(format!("{option}: `{text}` is not a number of %"))
            .advise(format!("write it like {option} \"10 %\""))
    })
}

/// `0.1 uM`
fn concentration(option: &str, text: Option<&str>) -> Result<Option<f64>, Failure> {
    text.map(|text| quantity(option, text, Dimension::Concentration)).transpose()
}

/// `100 nN/um=fibres.csv`
fn spring(text: &str) -> Result<EndSprings, Failure> {
    let (stiffness, path) = text.split_once('=').ok_or_else(|| {
        Failure::new(format!("--loaded: `{text}` is not a stiffness and a table"))
            .advise("write it like --loaded \"100 nN/um=fibres.csv\"")
    })?;
    let stiffness = quantity("--loaded", stiffness.trim(), Dimension::Stiffness)?;
    Ok(EndSprings { stiffness, path: PathBuf::from(path.trim()) })
}

/// `10 kPa=force.csv`, or `force.csv`
fn traction(text: &str) -> Result<TractionCurve, Failure> {
    let (modulus, path) = text.split_once('=').map_or((None, text), |(a, b)| (Some(a), b));
    let modulus =
        modulus.map(|modulus| quantity("--traction", modulus.trim(), Dimension::Pressure));
    Ok(TractionCurve { gel_modulus: modulus.transpose()?, path: PathBuf::from(path.trim()) })
}

/// `c_0=0.01:0.05`
fn bounds(text: &str) -> Result<(String, [f64; 2]), Failure> {
    let read = || {
        let (name, ends) = text.split_once('=')?;
        let (low, high) = ends.split_once(':')?;
        let ends = [low.trim().parse().ok()?, high.trim().parse().ok()?];
        Some((name.trim().to_owned(), ends))
    };
    read().ok_or_else(|| {
        Failure::new(format!("--bounds: `{text}` is not a parameter with its bounds"))
            .advise("write it like --bounds c_0=0.01:0.05, in the unit of the parameter")
    })
}
