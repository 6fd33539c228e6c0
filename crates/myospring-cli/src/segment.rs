//! `myospring segment`.

mod words;

use crate::args::SegmentArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input::ending;
use crate::terminal::Terminal;
use crate::{input, interrupt, print};
use myospring::experiment::refused::{Place, is_all_there_is};
use myospring::experiment::segment::{ENDINGS, ReadWholeFrame, Segment, check, overlay_path};
use myospring::experiment::{Experiment, Folder, Outcome, save};
use myospring::output::json;
use myospring::settings::Run;
use std::path::{Path, PathBuf};

pub(crate) fn segment(args: &SegmentArgs) -> Result<ExitCode, Failure> {
    let into = into(&args.output);
    for file in args.output.iter().filter(|_| into.is_none()) {
        if !ENDINGS.contains(&ending(file).as_str()) {
            let message = format!("`{}` has an ending that is not known", file.display());
            return Err(Failure::new(message)
                .advise(
                "write .geojson, .roi, .zip (RoiSet), .txt (Cellpose) or .png (mask), or one folder",
            ));
        }
    }
    let (name, run) = input::settle(Some(&args.input), &args.settings.overrides())?;
    if args.whole_frame {
        return whole_frame(args, &name, run, into);
    }
    let target = into.unwrap_or_else(|| input::outlines(&name));
    let is_folder = args.output.iter().all(|output| *output == target);
    let force = args.force || is_folder && is_all_there_is(&target, &FILES);
    if is_folder {
        Folder::check(&target, force, &FILES)?;
    } else {
        check(&args.output, args.force, &FILES)?;
    }
    let segment = Segment {
        picture: args.input.display().to_string(),
        run,
        all: args.settings.all_cells(),
        refused: Some(match args.output.first().filter(|_| !is_folder) {
            Some(first) => Place::File(overlay_path(first)),
            None => Place::Folder(target.clone()),
        }),
        of_cut: args
            .output
            .iter()
            .filter(|file| !is_folder && (args.force || !file.exists()))
            .cloned()
            .collect(),
    };
    let observer = Terminal::new(args.quiet);
    let found = segment.run(&FILES, &observer)?;
    interrupt::heed(interrupt::WRITING);
    let written = if is_folder {
        let force = args.force || is_all_there_is(&target, &FILES);
        vec![save(&found, &target, force, &FILES, &observer)?.display().to_string()]
    } else {
        found.write(&args.output, &FILES)?
    };
    let report = found.report();
    let text = if args.json {
        json::for_people(&report)?
    } else {
        let text = words::for_people(&report, &found.cells);
        format!("{}\n\nwritten: {}", text.trim_end(), written.join(", "))
    };
    told(args, &text, &found.warnings())
}

/// The fibres and sarcomeres of the whole picture, without an outline.
fn whole_frame(
    args: &SegmentArgs,
    name: &str,
    run: Run,
    into: Option<PathBuf>,
) -> Result<ExitCode, Failure> {
    if let (Some(file), None) = (args.output.first(), &into) {
        let message =
            format!("--whole-frame gives no outline that `{}` could hold", file.display());
        return Err(Failure::new(message).advise("leave --output out, or name a folder"));
    }
    let target = into.unwrap_or_else(|| Path::new("results").join(format!("{name}_whole_frame")));
    Folder::check(&target, args.force, &FILES)?;
    let observer = Terminal::new(args.quiet);
    let frame = ReadWholeFrame { picture: args.input.display().to_string(), run };
    let frame = frame.run(&FILES, &observer)?;
    let written = save(&frame, &target, args.force, &FILES, &observer)?;
    let report = frame.report();
    let text = if args.json {
        json::pretty(&report)?
    } else {
        format!("{}\n\nwritten: {}", words::of_frame(&report), written.display())
    };
    told(args, &text, &frame.warnings())
}

/// Prints the report and the warnings.
fn told(args: &SegmentArgs, text: &str, notes: &[String]) -> Result<ExitCode, Failure> {
    print::out(text)?;
    if !args.quiet {
        for note in notes {
            print::warn(note);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The requested folder: the only output, if it has no ending or is an existing folder.
fn into(outputs: &[PathBuf]) -> Option<PathBuf> {
    let [only] = outputs else { return None };
    let text = only.to_string_lossy();
    let is_folder = ending(only).is_empty() || text.ends_with(['/', '\\']) || only.is_dir();
    is_folder.then(|| only.clone())
}
