//! `myospring track`.

pub(crate) mod follow;
mod open;
mod outputs;
pub(crate) mod report;

pub(crate) use outputs::{DEFAULT, words};

use crate::args::TrackArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::input;
use crate::interrupt;
use crate::print;
use crate::terminal::Terminal;
use follow::Asked;
use myospring::experiment::Folder;
use myospring::microscopy::outlines::{NamedOutline, write_geojson};
use myospring::output::{json, track as table};
use report::Report;
use std::path::Path;

pub(crate) fn track(args: &TrackArgs) -> Result<ExitCode, Failure> {
    input::one_cell(args.settings.all_cells())?;
    let asked = Asked::of(args)?;
    asked.settled()?;
    let name = open::name(&args.input)?;
    let target = args.output.output.clone();
    let target = target.unwrap_or_else(|| Path::new("results").join(format!("{name}_track")));
    // Before the work, so that nothing is worked on that cannot be written.
    let folder = Folder::claim(&target, args.output.force, &FILES)?;
    let found = follow::cell(&args.input, &asked, &args.output)?;
    interrupt::heed("the frames that are done are written");
    let followed = follow::film(found, &asked, args.output.quiet)?;
    let report = Report::of(&args.input, &followed);
    if !args.output.quiet {
        for warning in &report.warnings {
            print::warn(warning);
        }
    }
    folder.write("track.csv", table::to_csv(&report.rows)?)?;
    folder.write("track.json", json::for_people(&report)?)?;
    folder.write("rest.tif", &followed.rest_picture)?;
    let outline = NamedOutline { name, outline: followed.shaped.outline.clone() };
    folder.write("outline.geojson", write_geojson(&[outline]))?;
    outputs::write(&folder, &args.outputs, &followed, &report)?;
    let target = folder.finish(&Terminal::new(true))?;
    if args.output.json {
        print::out(&json::for_people(&report)?)?;
    } else {
        print::out(&report.for_people())?;
        print::out(&format!("\nwritten: {}", target.display()))?;
    }
    Ok(ExitCode::SUCCESS)
}
