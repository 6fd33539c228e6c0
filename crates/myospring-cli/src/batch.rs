//! `myospring batch`: every picture of a folder or a table, one row per cell.

use crate::args::BatchArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::terminal::Terminal;
use crate::{interrupt, print};
use myospring::experiment::Outcome;
use myospring::experiment::batch::{Batch, Batched, Pictures};
use myospring::output::json;
use myospring::study::Status;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

pub(crate) fn batch(args: &BatchArgs) -> Result<ExitCode, Failure> {
    let (quiet, target) = (args.output.quiet, target(args));
    let pictures = match (&args.table, &args.folder) {
        (Some(table), folder) => Pictures::Table { table: table.clone(), folder: folder.clone() },
        (None, Some(folder)) => {
            Pictures::Folder { folder: folder.clone(), pattern: args.pattern.clone() }
        }
        // The arguments do not allow this.
        (None, None) => {
            return Err(Failure::new("neither a folder nor a table of pictures was given"));
        }
    };
    let batch = Batch {
        pictures,
        stacks: args.stacks,
        settings: args.settings.given().to_vec(),
        figures: args.figures,
        jobs: args.jobs.map(usize::from),
        target: Some(target.clone()),
        force: args.output.force,
    };
    let prepared = batch.prepare(&FILES, &interrupt::interruption())?;
    if !quiet {
        for note in &prepared.notes {
            print::warn(note);
        }
    }
    interrupt::heed_soon("unfinished pictures are discarded");
    let observer = Terminal::new(quiet);
    let batched = prepared.run(&observer)?;
    interrupt::tidies();
    observer.clear();
    if args.output.json {
        print::out(&json::pretty(&batched.numbers())?)?;
    } else {
        print::out(&summary(&batched, &target))?;
    }
    if batched.interrupted {
        let done: BTreeSet<&str> = batched.rows.iter().map(|row| row.picture.as_str()).collect();
        print::note(&format!(
            "interrupted: {} of {} pictures are done and kept; the same command continues with the others",
            done.len(),
            batched.pictures
        ));
    }
    Ok(ExitCode::from(u8::from(batched.count(Status::Failed) > 0)))
}

fn counted(count: usize, what: &str) -> String {
    format!("{count} {what}{}", if count == 1 { "" } else { "s" })
}

fn summary(batched: &Batched, target: &Path) -> String {
    let count = |status: Status, words: &str| match batched.count(status) {
        0 => String::new(),
        count => format!(", {count} {words}"),
    };
    format!(
        "{}: {} beat{}{}\nresults in {} ({:.1} s)",
        counted(batched.pictures, "picture"),
        counted(batched.count(Status::Ok), "cell"),
        count(Status::LeftOut, "left out (cut by the frame, of unusual size or doubtful)"),
        count(Status::Failed, "failed (the column reason says why)"),
        target.display(),
        batched.seconds
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
