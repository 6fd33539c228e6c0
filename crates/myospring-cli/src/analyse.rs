//! `myospring analyse`.

mod film;
pub(crate) mod table;
mod words;

use crate::args::AnalyseArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{interrupt, print};
use myospring::experiment::analyse::Analyse;
use myospring::experiment::optical::MapWaves;
use myospring::experiment::{Experiment, Folder, Outcome, tables};
use myospring::output::json;
use std::path::{Path, PathBuf};

pub(crate) fn analyse(args: &AnalyseArgs) -> Result<ExitCode, Failure> {
    if let [film] = &args.inputs[..]
        && MapWaves::takes(film)
    {
        return film::analyse(args, film);
    }
    if args.light.is_some() {
        return Err(Failure::new("--light is for a film of light; these are tables of curves"));
    }
    let experiment = Analyse {
        table: table::options(
            &args.table,
            args.pixel_size.as_deref(),
            args.to.as_deref().map(|to| ("--to", to)),
        )?,
        beats: table::beats(&args.stimuli, args.smooth.as_deref(), args.keep_drift)?,
        paths: tables::tables(&args.inputs)?,
        ..Analyse::default()
    };
    experiment.paths.iter().for_each(|path| FILES.note(path));
    let target = args.output.output.clone().unwrap_or_else(|| folder(&args.inputs));
    Folder::check(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    let outcome = experiment.run(&FILES, &terminal)?;
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    interrupt::heed(interrupt::WRITING);
    outcome.save(&folder, &terminal)?;
    let target = folder.finish(&terminal)?;
    terminal.clear();
    if args.output.json {
        print::out(&json::for_people(&outcome.numbers())?)?;
    } else {
        print::out(&words::tables(&outcome.curves))?;
        if !outcome.pairs.is_empty() {
            print::out(&words::pairs(&outcome.curves, &outcome.pairs))?;
        }
        print::out(&format!("\nwritten: {}", target.display()))?;
    }
    if !args.output.quiet {
        outcome.warnings().iter().for_each(|warning| print::warn(warning));
    }
    Ok(if outcome.left_out == 0 { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// The default folder for the results.
fn folder(inputs: &[PathBuf]) -> PathBuf {
    let name = match inputs {
        [one] => {
            let stem = one.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            // MUSCLEMOTION gives all its curves the same name; the names of its folders differ.
            let parent = one
                .parent()
                .and_then(Path::file_name)
                .map(|name| name.to_string_lossy().into_owned());
            match parent {
                Some(parent) if stem == "contraction" => format!("{parent}_beats"),
                _ => format!("{stem}_beats"),
            }
        }
        _ => "beats".to_owned(),
    };
    Path::new("results").join(name)
}
