//! `myospring analyse`.

mod files;
pub(crate) mod folder;
pub(crate) mod table;
mod words;

use crate::args::AnalyseArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{interrupt, print, progress};
use myospring::analysis::curve::{self, Analysis};
use myospring::experiment::Folder;
use myospring::measured::Curve;
use myospring::output::figure::Theme;
use myospring::output::json;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// Curves of which a figure is drawn, at most: each takes some 50 ms.
const FIGURES: usize = 500;

/// Notes that a failure has.
const NAMED: usize = 10;

/// A curve, where it stands and what was read of it.
pub(crate) struct Read {
    /// The file as it was named.
    pub(crate) file: String,
    pub(crate) curve: Curve,
    /// What was read, or why nothing was.
    pub(crate) found: Result<Analysis, String>,
}

impl Read {
    /// File and column.
    pub(crate) fn title(&self) -> String {
        let name = Path::new(&self.file).file_name().unwrap_or_default().to_string_lossy();
        format!("{name}: {}", self.curve.name)
    }
}

pub(crate) fn analyse(args: &AnalyseArgs) -> Result<ExitCode, Failure> {
    let options = table::options(
        &args.table,
        args.pixel_size.as_deref(),
        args.to.as_deref().map(|to| ("--to", to)),
    )?;
    let beats = table::Beats::of(&args.stimuli, args.smooth.as_deref(), args.keep_drift)?;
    let (mut all, mut notes) = (Vec::new(), Vec::new());
    let inputs = folder::tables(&args.inputs)?;
    for path in &inputs {
        FILES.note(path);
    }
    let target = args.output.output.clone().unwrap_or_else(|| folder(&args.inputs));
    Folder::check(&target, args.output.force, &FILES)?;
    for path in &inputs {
        let file = path.display().to_string();
        let table = match FILES.table(path, &options) {
            Ok(table) => table,
            Err(error) if inputs.len() == 1 => return Err(Failure::new(error)),
            // The others are as good as they were.
            Err(error) => {
                notes.push(format!("left out: {error}"));
                continue;
            }
        };
        notes.extend(table.notes.iter().map(|note| format!("{file}: {note}")));
        let first = all.len();
        for curve in table.curves {
            let options = beats.within(&curve);
            let found =
                curve::analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options);
            let found = found.map_err(|error| match error.frame() {
                Some(frame) => format!("{error} (line {} of the file)", curve.lines[frame - 1]),
                None => error.to_string(),
            });
            all.push(Read { file: file.clone(), curve, found });
        }
        compare(&mut all[first..]);
    }
    if let Some(failure) = none_beats(&all, &notes) {
        return Err(failure);
    }
    if all.len() > FIGURES {
        notes.push(format!(
            "figures are drawn of the first {FIGURES} of {} curves; --columns chooses others",
            all.len()
        ));
    }
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    interrupt::heed(interrupt::WRITING);
    folder.write("metrics.csv", files::metrics(&all)?)?;
    folder.write("summary.csv", files::summary(&all)?)?;
    let record = files::Record::of(&all, &notes);
    folder.write("summary.json", json::for_people(&record)?)?;
    let drawn = all.len().min(FIGURES);
    let bar = progress::of_members(args.output.quiet, drawn, "figures");
    let names = files::figure_names(&all);
    for (read, name) in all.iter().zip(&names).take(FIGURES) {
        if let Ok(analysis) = &read.found {
            let draw = || files::figure(read, analysis);
            folder.figures(Theme::Light, &[(name, &draw)], &Terminal::new(true))?;
        }
        bar.inc(1);
        if interrupt::asked() {
            break;
        }
    }
    bar.finish_and_clear();
    let target = folder.finish(&Terminal::new(true))?;
    if args.output.json {
        print::out(&json::for_people(&record)?)?;
    } else {
        print::out(&words::tables(&all))?;
        print::out(&format!("\nwritten: {}", target.display()))?;
    }
    if !args.output.quiet {
        for note in notes.iter().chain(&words::remarks(&all)) {
            print::warn(note);
        }
    }
    let whole = all.iter().map(|read| &read.file).collect::<BTreeSet<_>>().len() == inputs.len();
    Ok(if whole { ExitCode::SUCCESS } else { ExitCode::from(1) })
}

/// Compares the beats of a table's curves that have the same times.
fn compare(table: &mut [Read]) {
    let Some(times) = table.first().map(|read| read.curve.times_ms.clone()) else { return };
    let alike = table.iter_mut().filter(|read| read.curve.times_ms == times);
    let mut found: Vec<_> = alike
        .filter_map(|read| Some((read.curve.name.as_str(), read.found.as_mut().ok()?)))
        .collect();
    curve::compare(&mut found);
}

/// The failure where no curve has a beat.
fn none_beats(all: &[Read], notes: &[String]) -> Option<Failure> {
    if all.iter().any(|read| read.found.is_ok()) {
        return None;
    }
    let Some(first) = all.first() else {
        let failure = Failure::new("none of the files can be read as a table of curves");
        return Some(notes.iter().fold(failure, |failure, note| failure.also(note)));
    };
    let why = first.found.as_ref().err()?;
    let message = match all.len() {
        1 => format!("`{}`, column `{}`: {why}", first.file, first.curve.name),
        count => format!(
            "none of {count} curves has a beat; `{}`, column `{}`: {why}",
            first.file, first.curve.name
        ),
    };
    let mut failure = Failure::new(message).advise(
        "look at the curve; --kind says what it is, --columns chooses it, --frame-rate and --time-unit say how fast \
         it was recorded",
    );
    for note in notes.iter().take(NAMED) {
        failure = failure.also(note);
    }
    match notes.len().saturating_sub(NAMED) {
        0 => Some(failure),
        more => Some(failure.also(&format!("and {more} more notes like these"))),
    }
}

/// Where results go unless that is said.
fn folder(inputs: &[PathBuf]) -> PathBuf {
    let name = match inputs {
        [one] => {
            let stem = one.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            // MUSCLEMOTION calls all of its curves the same; its folders tell them apart.
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
