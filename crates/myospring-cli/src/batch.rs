//! `myospring batch`: every picture of a folder or a table, one row a cell.

mod kept;
mod members;

use crate::args::BatchArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::{interrupt, print, progress};
use indicatif::ProgressBar;
use kept::Kept;
use myospring::experiment::inputs;
use myospring::output::files::Manifest;
use myospring::output::json;
use myospring::settings::{Run, Value};
use myospring::study::pictures::{self, CellRow, Picture};
use myospring::study::{self, Cause, Journal, Observer, Row, Status, Threads};
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// What happened, for machines.
#[derive(Serialize)]
struct Outcome {
    results: PathBuf,
    pictures: usize,
    resumed: usize,
    cells: usize,
    left_out: usize,
    failed: usize,
    /// Whether it was stopped before its last picture.
    interrupted: bool,
    seconds: f64,
}

pub(crate) fn batch(args: &BatchArgs) -> Result<ExitCode, Failure> {
    let start = Instant::now();
    let target = target(args);
    let (pictures, notes) = members::pictures(args, &target)?;
    // Every setting is checked once, before any picture is opened.
    for picture in &pictures {
        members::settled(args, picture)?;
    }
    let common = Picture::new(String::new(), pictures[0].path.clone());
    let settings = settings(args, &members::settled(args, &common)?, &target);
    if !args.output.quiet {
        for note in &notes {
            print::warn(note);
        }
    }
    let journal = if args.output.force {
        Journal::begin_anew(&target, &settings, &FILES.reads())?
    } else {
        Journal::open_beside(&target, &settings, &FILES.reads())?
    };
    let manifest = journal.manifest().unwrap_or_else(|| Manifest::of(&target));
    interrupt::heed_soon("the pictures under way are given up");
    let bar = progress::of_members(args.output.quiet, pictures.len(), "pictures");
    let seen = Seen { bar: &bar, quiet: args.output.quiet, manifest: &manifest };
    let kept = Kept { figures: args.figures, manifest: &manifest };
    let threads = Threads::new(args.jobs.map(usize::from))?;
    let report = study::run(&pictures, &journal, &threads, &seen, |picture| {
        let run = members::settled(args, picture)?;
        pictures::rows(picture, &run, members::which(&args.settings, picture), &kept)
    })?;
    interrupt::tidies();
    bar.finish_and_clear();
    manifest.settle()?;

    let outcome = Outcome {
        results: target.clone(),
        pictures: pictures.len(),
        resumed: report.resumed,
        cells: report.count(Status::Ok),
        left_out: report.count(Status::LeftOut),
        failed: report.count(Status::Failed),
        interrupted: report.stopped,
        seconds: start.elapsed().as_secs_f64(),
    };
    if args.output.json {
        print::out(&json::pretty(&outcome)?)?;
    } else {
        print::out(&summary(&outcome))?;
    }
    if report.stopped {
        let done: BTreeSet<&str> = report.rows.iter().map(|row| row.picture.as_str()).collect();
        print::note(&format!(
            "interrupted: {} of {} pictures are done and kept; the same command goes on with the others",
            done.len(),
            pictures.len()
        ));
    }
    Ok(ExitCode::from(u8::from(outcome.failed > 0)))
}

/// What people see of a batch while it goes on, and its table.
struct Seen<'a> {
    bar: &'a ProgressBar,
    quiet: bool,
    manifest: &'a Manifest,
}

impl Observer<Picture> for Seen<'_> {
    fn begins(&self, done: usize, pictures: usize) {
        if !self.quiet && done > 0 {
            print::note(&format!("going on: {done} of {pictures} pictures are done"));
        }
        self.bar.inc(done as u64);
    }

    fn damaged(&self, pictures: usize) {
        print::warn(&damaged(pictures, "pictures"));
    }

    fn finished(&self, picture: &Picture, rows: &[CellRow]) -> bool {
        let failed = rows.iter().filter(|row| row.status == Status::Failed && !self.quiet);
        for row in failed {
            self.bar.suspend(|| print::warn(&format!("{}: {}", picture.name, row.reason)));
        }
        self.bar.inc(1);
        !interrupt::asked()
    }

    fn table(&self, rows: &[CellRow]) -> Result<(), Cause> {
        let table = CellRow::table(rows);
        self.manifest.write(kept::CSV, table.clone().for_people().to_csv()?)?;
        Ok(self.manifest.write(kept::PARQUET, table.to_parquet()?)?)
    }
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

/// What to say of members whose kept results are damaged.
pub(crate) fn damaged(count: usize, members: &str) -> String {
    format!(
        "the results of {count} {members} that were kept here were changed or damaged since; they are computed anew"
    )
}

fn summary(outcome: &Outcome) -> String {
    let Outcome { pictures, cells, left_out, failed, seconds, .. } = outcome;
    let count = |count: &usize, words: &str| match count {
        0 => String::new(),
        count => format!(", {count} {words}"),
    };
    format!(
        "{}: {} beat{}{}\nresults in {} ({seconds:.1} s)",
        counted(*pictures, "picture"),
        counted(*cells, "cell"),
        count(left_out, "left out (cut by the frame, of unusual size or doubtful)"),
        count(failed, "failed (the column reason says why)"),
        outcome.results.display()
    )
}

/// The folder for the results.
fn target(args: &BatchArgs) -> PathBuf {
    args.output.output.clone().unwrap_or_else(|| {
        let of = args.folder.as_deref().or(args.table.as_deref()).unwrap_or(Path::new(""));
        let of = std::path::absolute(of).unwrap_or_else(|_| of.to_owned());
        let name = if of.is_dir() { of.file_name() } else { of.file_stem() };
        let name = name.map_or_else(|| "folder".into(), |name| name.to_string_lossy());
        Path::new("results").join(format!("{name}_batch"))
    })
}

/// Every setting that results depend on, as text.
fn settings(args: &BatchArgs, run: &Run, target: &Path) -> String {
    let mut file = run.to_run_file();
    file.remove("shape.picture");
    for path in file.paths_mut() {
        *path = inputs::relative(Path::new(&*path), target).unwrap_or_else(|| path.clone());
    }
    let text = file.to_toml();
    let cells = args.settings.get("segmentation.cell").and_then(Value::as_text).unwrap_or("all");
    let (version, figures) = (env!("CARGO_PKG_VERSION"), args.figures);
    format!(
        "# What the results in this folder depend on; myospring batch goes on only with the same.\n\
         # version {version}, cells {cells}, figures {figures}\n\n{text}"
    )
}
