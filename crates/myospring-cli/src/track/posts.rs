//! `myospring track --posts`.

use super::told::told;
use crate::analyse::table::quantity;
use crate::args::TrackArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::table::number;
use crate::terminal::Terminal;
use myospring::experiment::posts::{self, FollowPosts, FollowedPosts};
use myospring::experiment::track::Track;
use myospring::experiment::{Experiment, Folder};
use myospring::mechanics::post;
use myospring::units::Dimension;
use std::path::Path;

pub(super) fn track(args: &TrackArgs, track: Track) -> Result<ExitCode, Failure> {
    let posts = args.post_places.as_deref().map(posts::places).transpose()?;
    let name = track.check(&FILES)?;
    let experiment = FollowPosts { track, posts, stiffness: stiffness(args)? };
    let target = args.output.output.clone();
    let target = target.unwrap_or_else(|| Path::new("results").join(format!("{name}_posts")));
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let terminal = Terminal::new(args.output.quiet);
    let outcome = experiment.run(&FILES, &terminal)?;
    told(args, &outcome, folder, &terminal, || for_people(&outcome))?;
    Ok(ExitCode::SUCCESS)
}

/// Force per displacement of one post, nN/um, if it is stated.
fn stiffness(args: &TrackArgs) -> Result<Option<f64>, Failure> {
    if let Some(text) = &args.post_stiffness {
        return quantity("--post-stiffness", text, Dimension::Stiffness).map(Some);
    }
    let length = |option: &str, text: &Option<String>| {
        text.as_deref().map(|text| quantity(option, text, Dimension::Length)).transpose()
    };
    let modulus = args.post_modulus.as_deref();
    let modulus =
        modulus.map(|text| quantity("--post-modulus", text, Dimension::Pressure)).transpose()?;
    let (Some(long), Some(width), Some(modulus)) = (
        length("--post-length", &args.post_length)?,
        length("--post-width", &args.post_width)?,
        modulus,
    ) else {
        return Ok(None);
    };
    let load_height = length("--post-load-height", &args.post_load_height)?;
    if load_height.is_some_and(|height| height > long) {
        return Err(Failure::new(
            "--post-load-height is above the tip of the posts, --post-length",
        ));
    }
    let thickness = length("--post-thickness", &args.post_thickness)?;
    let post = post::Post { length: long, load_height, width, thickness, modulus };
    Ok(Some(post.stiffness()))
}

fn for_people(followed: &FollowedPosts) -> String {
    let report = &followed.report;
    let middle = |post: usize| {
        let [column, row] = report.posts[post].middle_px;
        format!("column {column:.0}, row {row:.0}")
    };
    let how = match report.stands_out {
        Some(ratio) => {
            format!("found; their edges are {ratio:.1} times as strong as those of anything else")
        }
        None => "as stated".to_owned(),
    };
    let mut lines = vec![
        format!(
            "{}: {} of {} frames at {} /s, pixels of {} um; at rest in frame {}",
            report.film,
            report.frames_followed,
            report.frames,
            number(report.frames_per_second),
            number(report.pixel_size_um),
            report.rest_frame
        ),
        format!(
            "posts at {} and {} ({how}), {} um apart",
            middle(0),
            middle(1),
            number(report.distance_um)
        ),
    ];
    if let (Some(approach), Some(frame), Some(error)) =
        (report.largest_approach_um, report.largest_approach_frame, report.approach_error_um)
    {
        lines.push(format!(
            "they come nearer by {} um at most (frame {frame}), with an error of {} um in a frame",
            number(approach),
            number(error)
        ));
    }
    if let (Some(force), Some(stiffness)) = (report.largest_force_nn, report.stiffness_nn_per_um) {
        lines.push(format!(
            "force on each post up to {} uN, with posts of {} uN/um",
            number(1e-3 * force),
            number(1e-3 * stiffness)
        ));
    } else {
        lines.push(
            "their stiffness is not stated, so there is no force (--post-stiffness)".to_owned(),
        );
    }
    if let Ok(beats) = &followed.beats {
        let found = beats.curves.iter().filter_map(|read| read.found.as_ref().ok());
        let count: usize = found.map(|found| found.beats.len()).sum();
        lines.push(format!("{count} beats; their numbers are in metrics.csv and report.html"));
    }
    lines.join("\n")
}
