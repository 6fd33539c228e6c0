//! `myospring segment --whole-frame`: the fibres and sarcomeres of all that the picture shows, without an outline.

use super::DPI;
use crate::args::SegmentArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::files::FILES;
use crate::overlay;
use crate::print;
use crate::terminal::Terminal;
use myospring::experiment::Folder;
use myospring::microscopy::cells::PictureCells;
use myospring::microscopy::fibres::{Fibre as Place, FibreSettings, SarcomereDoubt, Stain};
use myospring::microscopy::whole_frame::WholeFrame;
use myospring::output::fibres::{FibreRow, to_csv};
use myospring::output::figure::{Sarcomeres, Tick};
use myospring::output::json;
use myospring::settings::{Fibre, PictureSource, Run};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What was read.
#[derive(Serialize)]
struct Report<'a> {
    picture: String,
    /// Size of the frame, um.
    width_um: f64,
    height_um: f64,
    pixel_size_um: f64,
    pixel_size_source: &'static str,
    spacing_um: f64,
    fibres: FibreReport,
    notes: &'a [String],
}

#[derive(Serialize)]
struct FibreReport {
    stain: Stain,
    /// Part of the frame that was read, per cent; the numbers below are those of this part.
    read_pct: f64,
    /// Mean direction, degrees counter-clockwise from x, above -90 and up to 90.
    direction_deg: Option<f64>,
    /// How parallel the fibres are, 0 to 1.
    alignment: Option<f64>,
    sarcomere_um: Option<f64>,
    sarcomere_q1_um: Option<f64>,
    sarcomere_q3_um: Option<f64>,
    /// Why that length is doubtful, if it is.
    #[serde(skip_serializing_if = "Option::is_none")]
    sarcomere_doubt: Option<SarcomereDoubt>,
}

pub(super) fn read(
    args: &SegmentArgs,
    name: &str,
    run: &Run,
    source: &PictureSource,
) -> Result<ExitCode, Failure> {
    let target = super::into(&args.output);
    if let (Some(file), None) = (args.output.first(), &target) {
        let message = format!("--whole-frame finds no outline to write to `{}`", file.display());
        return Err(Failure::new(message).advise("leave --output away, or name a folder"));
    }
    let target = target.unwrap_or_else(|| folder(name));
    Folder::check(&target, args.force, &FILES)?;
    let settings = match run.fibre {
        Fibre::Auto(asked) => asked.settings(),
        Fibre::Picture(settings) => settings,
        Fibre::LongAxis | Fibre::Angle(_) => {
            let message = "--whole-frame reads the fibres from the picture";
            return Err(Failure::new(message).advise("leave --fibre away, or give --fibre picture"));
        }
    };
    let bytes = run.shape.bytes(|file| FILES.bytes(file))?;
    let cells = source.unsegmented(&bytes)?;
    let frame = WholeFrame::read(&cells, &settings, run.shape.spacing).map_err(Failure::new)?;
    let fibres = report(&frame, &settings);
    let mut notes = cells.notes.clone();
    notes.extend(frame.note().map(str::to_owned));
    let report = Report {
        picture: args.input.display().to_string(),
        width_um: frame.size_um[0],
        height_um: frame.size_um[1],
        pixel_size_um: cells.pixel_size.um(),
        pixel_size_source: cells.pixel_size_source,
        spacing_um: frame.spacing_um,
        fibres,
        notes: &notes,
    };
    let written = write(args, &target, &cells, &frame, &report)?;
    if args.json {
        print::out(&json::pretty(&report)?)?;
    } else {
        print::out(&for_people(&report))?;
        print::out(&format!("\nwritten: {}", written.display()))?;
    }
    if !args.quiet {
        for note in &notes {
            print::warn(note);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Of the places that were read.
fn report(frame: &WholeFrame, settings: &FibreSettings) -> FibreReport {
    let summary = &frame.summary;
    let quartiles = summary.sarcomere_quartiles_um;
    FibreReport {
        stain: settings.stain,
        read_pct: 100.0 * summary.share_from_picture,
        direction_deg: frame.direction_deg,
        alignment: frame.alignment,
        sarcomere_um: summary.median_sarcomere_um,
        sarcomere_q1_um: quartiles.map(|[first, _]| first),
        sarcomere_q3_um: quartiles.map(|[_, third]| third),
        sarcomere_doubt: summary.sarcomere_doubt,
    }
}

fn for_people(report: &Report<'_>) -> String {
    let FibreReport { read_pct, direction_deg, alignment, .. } = &report.fibres;
    let mut lines = vec![
        format!(
            "{}: the whole frame, {:.0} x {:.0} um, pixels of {} um ({}); no cell was outlined",
            report.picture,
            report.width_um,
            report.height_um,
            report.pixel_size_um,
            report.pixel_size_source
        ),
        format!("{:<20} read in {read_pct:.0} % of the frame", "fibres"),
    ];
    if let (Some(direction), Some(alignment)) = (direction_deg, alignment) {
        lines.push(format!(
            "{:<20} {direction:.0} degrees from x, alignment {alignment:.2} (1 is parallel, 0 is every direction)",
            "mean direction"
        ));
    }
    let FibreReport { sarcomere_um, sarcomere_q1_um, sarcomere_q3_um, .. } = &report.fibres;
    if let (Some(median), Some(q1), Some(q3)) = (sarcomere_um, sarcomere_q1_um, sarcomere_q3_um) {
        let doubt = report.fibres.sarcomere_doubt;
        let doubt = doubt.map_or_else(String::new, |doubt| format!(", doubtful: {doubt}"));
        lines.push(format!(
            "{:<20} {median:.2} um (quartiles {q1:.2}, {q3:.2}){doubt}",
            "sarcomeres"
        ));
    }
    lines.join("\n")
}

fn write(
    args: &SegmentArgs,
    target: &Path,
    cells: &PictureCells,
    frame: &WholeFrame,
    report: &Report<'_>,
) -> Result<PathBuf, Failure> {
    let places = &frame.places;
    let ticks: Vec<Tick> = places.iter().map(overlay::tick).collect();
    let lengths: Vec<f64> = places.iter().filter_map(|(_, place)| place.sarcomere_um).collect();
    let sarcomeres = report.fibres.sarcomere_um.map(|median_um| Sarcomeres {
        lengths_um: &lengths,
        median_um,
        read_pct: report.fibres.read_pct,
    });
    let figure = overlay::of_frame(&report.picture, cells, &ticks, sarcomeres, report.notes)?;
    let is_doubtful = frame.doubtful_lengths();
    let row = |&(point_um, place): &([f64; 2], Place)| FibreRow {
        point_um,
        direction_deg: place.from_picture.then(|| place.angle_deg()),
        sarcomere_um: place.sarcomere_um,
        sarcomere_doubtful: place.sarcomere_um.map(&is_doubtful),
        order: place.from_picture.then_some(place.order),
        coverage: place.from_picture.then_some(place.coverage),
    };
    let folder = Folder::claim(target, args.force, &FILES)?;
    folder.write(crate::fibres::FILE, to_csv(&[("frame", places.iter().map(row).collect())])?)?;
    folder.write("overlay.png", figure.to_png(DPI)?)?;
    folder.write("report.json", json::pretty(report)?)?;
    folder.finish(&Terminal::new(true))
}

/// Where the fibres of a whole frame go.
fn folder(name: &str) -> PathBuf {
    Path::new("results").join(format!("{name}_whole_frame"))
}
