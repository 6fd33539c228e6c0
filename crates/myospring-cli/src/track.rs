//! `myospring track`.

mod posts;
mod told;

use crate::analyse::table::frame_rate;
use crate::args::TrackArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input;
use crate::terminal::Terminal;
use myospring::experiment::run::NONE;
use myospring::experiment::track::{
    HeadlineReport, Output, Track, TrackCells, TrackReport, TrackedCells,
};
use myospring::experiment::{Experiment, Folder};
use myospring::microscopy::motion::TrackingSettings;
use myospring::study::Status;
use myospring::units::{self, Dimension};
use std::num::NonZeroUsize;
use std::path::Path;
use told::told;

pub(crate) fn track(args: &TrackArgs) -> Result<ExitCode, Failure> {
    let mut experiment = Track {
        settings: args.settings.overrides(),
        frame_rate: args.frame_rate.as_deref().map(frame_rate).transpose()?,
        subset_um: args.subset.as_deref().map_or(Ok(TrackingSettings::SUBSET_UM), subset)?,
        threads: args.threads.map(NonZeroUsize::get),
        outputs: outputs(&args.outputs)?,
        ..Track::of(&args.input)
    };
    if args.posts {
        return posts::track(args, experiment);
    }
    let name = experiment.check(&FILES)?;
    experiment.refused = Some(input::refusals(&args.output, &name));
    let target = args.output.output.clone();
    let target = target.unwrap_or_else(|| Path::new("results").join(format!("{name}_track")));
    // Before the work, so that it is not lost if nothing can be written.
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    if args.settings.all_cells() {
        let outcome = TrackCells(experiment).run(&FILES, &terminal)?;
        told(args, &outcome, folder, &terminal, || of_cells(&outcome))?;
        return Ok(ExitCode::from(u8::from(outcome.count(Status::Failed) > 0)));
    }
    let outcome = experiment.run(&FILES, &terminal)?;
    told(args, &outcome, folder, &terminal, || for_people(&outcome.report))?;
    Ok(ExitCode::SUCCESS)
}

/// A line a cell.
fn of_cells(tracked: &TrackedCells) -> String {
    let mut lines = vec![format!("{}: {}", tracked.film, tracked.words())];
    if let Some(film) = tracked.of_film() {
        lines.push(of_film(film));
    }
    lines.extend(tracked.cells.iter().map(|cell| {
        let name = &cell.name;
        let Ok(tracked) = &cell.found else {
            return format!("cell {name}: {}: {}", cell.status(), cell.reason());
        };
        let TrackReport { headline, resting_length_um, .. } = &*tracked.report;
        let HeadlineReport { column, peak_contraction_pct, peak_frame, .. } = headline;
        format!(
            "cell {name}: contracts by {peak_contraction_pct:.2} % (frame {peak_frame}), read from {column}; length \
             {resting_length_um:.1} um at rest"
        )
    }));
    lines.join("\n")
}

/// What holds for all cells of a film.
fn of_film(report: &TrackReport) -> String {
    format!(
        "{} of {} frames at {} /s ({}), pixels of {} um; at rest in frame {}; motion of the stage: {}, up to {:.2} um",
        report.frames_followed,
        report.frames,
        rounded(report.frames_per_second),
        report.frame_rate_source,
        rounded(report.pixel_size_um),
        report.rest_frame,
        report.stage,
        report.stage_largest_um
    )
}

fn outputs(words: &[String]) -> Result<Vec<Output>, Failure> {
    if words.len() > 1 && words.iter().any(|word| word == NONE) {
        return Err(Failure::new(format!("--outputs {}: `none` stands alone", words.join(",")))
            .advise("leave out `none` or everything else"));
    }
    let named = |output: &Output| words.iter().any(|word| word == output.word());
    Ok(Output::ALL.into_iter().filter(named).collect())
}

fn subset(text: &str) -> Result<f64, Failure> {
    let [least, most] = TrackingSettings::SUBSETS_UM;
    let um = units::parse(text, Dimension::Length)
        .map_err(|error| Failure::new(format!("--subset: {error}")))?;
    if (least..=most).contains(&um) {
        return Ok(um);
    }
    Err(Failure::new(format!("--subset is {um} um; it must be between {least} and {most} um"))
        .advise("two sarcomeres are a good size: --subset \"4 um\""))
}

fn for_people(report: &TrackReport) -> String {
    let mut lines = vec![format!(
        "{}: {} of {} frames at {} /s ({}), pixels of {} um; at rest in frame {}",
        report.film,
        report.frames_followed,
        report.frames,
        rounded(report.frames_per_second),
        report.frame_rate_source,
        rounded(report.pixel_size_um),
        report.rest_frame
    )];
    let HeadlineReport { column, peak_contraction_pct, peak_frame, because, .. } = &report.headline;
    lines.push(format!(
        "contracts by {peak_contraction_pct:.2} % (frame {peak_frame}), read from {column}: {because}"
    ));
    lines.push(format!(
        "length {:.1} um at rest, shortens by {:.2} % (frame {})",
        report.resting_length_um, report.peak_shortening_pct, report.peak_frame
    ));
    lines.push(format!(
        "strains of the whole cell: stretch_1 at least {:.4} (frame {})",
        report.least_stretch, report.least_stretch_frame
    ));
    if let (Some(rest), Some([low, high])) =
        (report.sarcomere_rest_um, report.sarcomere_rest_interval_um)
        && let (Some(least), Some(shorter), Some([from, to])) = (
            report.sarcomere_least_um,
            report.sarcomere_shortening_pct,
            report.sarcomere_shortening_interval_pct,
        )
    {
        lines.push(format!(
            "sarcomeres {rest:.3} um at rest ({low:.3} to {high:.3}), {least:.3} um at least: {shorter:.1} % shorter \
             ({from:.1} to {to:.1}); mean of {} places in {} parts of the cell, 95 % intervals",
            report.sarcomere_places, report.sarcomere_parts
        ));
    }
    lines.push(format!(
        "{} points, subsets of {:.1} um, interpolated {:.1} % on average, {:.1} % at most",
        report.points, report.subset_um, report.interpolated_pct_mean, report.interpolated_pct_most
    ));
    lines.push(format!(
        "motion of the stage: {}, up to {:.2} um",
        report.stage, report.stage_largest_um
    ));
    lines.join("\n")
}

/// Rounded, since a file states it as a ratio of whole numbers.
fn rounded(value: f64) -> f64 {
    (1e6 * value).round() / 1e6
}
