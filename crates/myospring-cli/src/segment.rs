//! `myospring segment`.

use crate::args::SegmentArgs;
use crate::failure::Failure;
use crate::results::Folder;
use crate::{input, overlay, print};
use myospring::microscopy::cells::{PictureCell, PictureCells};
use myospring::microscopy::outlines::raster::{write_labels_png, write_mask_png};
use myospring::microscopy::outlines::{
    NamedOutline, PixelFrame, write_cellpose, write_geojson, write_roi, write_roi_set,
};
use myospring::microscopy::report::ShapeReport;
use myospring::microscopy::segment::{Choice, Confidence};
use myospring::output::{files, json};
use myospring::run_file::Source;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Resolution of the overlay, dots per inch.
const DPI: f64 = 200.0;

/// Endings of files of outlines, in the order of the help.
const ENDINGS: [&str; 6] = ["geojson", "json", "roi", "zip", "txt", "png"];

/// What was found, for machines.
#[derive(Serialize)]
struct Report<'a> {
    picture: String,
    modality: &'static str,
    pixel_size_um: f64,
    pixel_size_source: &'static str,
    threshold: Option<f64>,
    cells: Vec<CellReport<'a>>,
    notes: &'a [String],
}

#[derive(Serialize)]
struct CellReport<'a> {
    number: u32,
    name: &'a str,
    confidence: &'a Confidence,
    #[serde(flatten)]
    shape: &'a ShapeReport,
}

pub(crate) fn segment(args: &SegmentArgs) -> Result<ExitCode, Failure> {
    for file in &args.output {
        if !ENDINGS.contains(&ending(file).as_str()) {
            let message = format!("`{}` has an ending that is not known", file.display());
            return Err(Failure::new(message)
                .advise("write .geojson, .roi, .zip (RoiSet), .txt (Cellpose) or .png (mask)"));
        }
    }
    let (name, run) = input::settle(Some(&args.input), args.overrides())?;
    let Source::Picture(source) = &run.shape.source else {
        let message = format!("`{}` is not a picture", args.input.display());
        return Err(Failure::new(message).advise("give a picture (.png, .tif, .tiff)"));
    };
    let bytes = run.shape.bytes(|file| std::fs::read(file))?;
    let cells = source.cells(&bytes)?;
    let chosen = if args.segmentation.all() {
        (1..=cells.len() as u32)
            .map(|number| cells.cell(Choice::Number(number), true))
            .collect::<Result<Vec<_>, _>>()
    } else {
        cells.cell(source.choice, source.allow_cut).map(|cell| vec![cell])
    }
    .map_err(|cause| source.failed(cause))?;

    let report = report(args, &cells, &chosen);
    let notes = notes(&cells, &chosen);
    let written = write(args, &name, &cells, &chosen, &report, &notes)?;
    if args.json {
        print::out(&json::pretty(&report)?);
    } else {
        print::out(&for_people(&report));
        print::out(&format!("\nwritten: {}", written.join(", ")));
    }
    if !args.quiet {
        for note in &notes {
            print::warn(note);
        }
    }
    Ok(ExitCode::SUCCESS)
}

fn report<'a>(
    args: &SegmentArgs,
    cells: &'a PictureCells,
    chosen: &'a [PictureCell],
) -> Report<'a> {
    let threshold = cells.segmentation().map(|found| found.threshold);
    let cell = |cell: &'a PictureCell| CellReport {
        number: cell.number,
        name: &cell.name,
        confidence: &cell.confidence,
        shape: &cell.shape,
    };
    Report {
        picture: args.input.display().to_string(),
        modality: cells.modality(),
        pixel_size_um: cells.pixel_size_um,
        pixel_size_source: cells.pixel_size_source,
        threshold: threshold.filter(|threshold| *threshold != 0.0),
        cells: chosen.iter().map(cell).collect(),
        notes: &cells.notes,
    }
}

/// What a person should look at.
fn notes(cells: &PictureCells, chosen: &[PictureCell]) -> Vec<String> {
    let mut notes = cells.notes.clone();
    if chosen.len() < cells.len() {
        notes.push(format!(
            "the picture has {} cells; --cell all writes all of them, --cell N or --seed X,Y another",
            cells.len()
        ));
    }
    for cell in chosen {
        let who = if chosen.len() > 1 { format!("cell {}: ", cell.name) } else { String::new() };
        if cell.confidence.is_doubtful() {
            notes.push(format!(
                "{who}the outline is doubtful (confidence {:.2} of 1): {}; look at the overlay",
                cell.confidence.score,
                cell.confidence.reasons.join("; ")
            ));
        }
        notes.extend(cell.shape.warnings.iter().map(|warning| format!("{who}{warning}")));
    }
    notes
}

/// Writes what was asked for and the overlay; the names of the files or of their folder.
fn write(
    args: &SegmentArgs,
    name: &str,
    cells: &PictureCells,
    chosen: &[PictureCell],
    report: &Report<'_>,
    notes: &[String],
) -> Result<Vec<String>, Failure> {
    let frame = cells.frame().map_err(Failure::new)?;
    let named: Vec<NamedOutline> = chosen
        .iter()
        .map(|cell| NamedOutline { name: cell.name.clone(), outline: cell.outline.clone() })
        .collect();
    let all: Vec<&PictureCell> = chosen.iter().collect();
    let figure = overlay::draw(&report.picture, cells, &all, None, None, notes)?;
    if args.output.is_empty() {
        let target = Path::new("results").join(format!("{name}_outline"));
        let folder = Folder::claim(&target, args.force)?;
        let one = if named.len() == 1 { "cell.roi" } else { "cells.zip" };
        for file in ["outline.geojson", "mask.png", one] {
            folder.write(file, encoded(Path::new(file), &named, &frame)?)?;
        }
        folder.write("overlay.png", figure.to_png(DPI)?)?;
        folder.write("report.json", json::pretty(report)?)?;
        return Ok(vec![folder.finish()?.display().to_string()]);
    }
    let overlay = beside(&args.output[0]);
    let taken = args.output.iter().chain([&overlay]).find(|file| file.exists());
    if let (Some(file), false) = (taken, args.force) {
        let message = format!("`{}` already exists", file.display());
        return Err(Failure::new(message).advise("choose another name, or replace it with --force"));
    }
    let encoded: Vec<Vec<u8>> =
        args.output.iter().map(|file| encoded(file, &named, &frame)).collect::<Result<_, _>>()?;
    let png = figure.to_png(DPI)?;
    let files = args.output.iter().zip(&encoded).chain([(&overlay, &png)]);
    files
        .map(|(file, content)| {
            if let Some(folder) = file.parent().filter(|folder| !folder.as_os_str().is_empty()) {
                files::create_folder(folder)?;
            }
            files::write(file, content)?;
            Ok(file.display().to_string())
        })
        .collect()
}

/// `cell.roi` gives `cell_overlay.png`.
fn beside(file: &Path) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_overlay.png"))
}

fn ending(file: &Path) -> String {
    file.extension().unwrap_or_default().to_string_lossy().to_lowercase()
}

/// The outlines in the format that the ending names.
fn encoded(file: &Path, cells: &[NamedOutline], frame: &PixelFrame) -> Result<Vec<u8>, Failure> {
    let ending = ending(file);
    let encoded = match (ending.as_str(), cells) {
        ("roi", [cell]) => Ok(write_roi(cell, frame)),
        ("roi", _) => {
            let message = format!("`{}` can hold one outline, not {}", file.display(), cells.len());
            return Err(
                Failure::new(message).advise("write several as a RoiSet: --output cells.zip")
            );
        }
        ("zip", _) => write_roi_set(cells, frame),
        ("txt", _) => write_cellpose(cells, frame).map(String::into_bytes),
        ("png", [cell]) => write_mask_png(cell, frame),
        ("png", _) => write_labels_png(cells, frame),
        _ => Ok(write_geojson(cells).into_bytes()),
    };
    encoded.map_err(|error| Failure::new(format!("`{}`: {error}", file.display())))
}

fn for_people(report: &Report<'_>) -> String {
    let threshold =
        report.threshold.map(|threshold| format!(", threshold {threshold:.4}")).unwrap_or_default();
    let mut parts = vec![format!(
        "{}: {} picture, pixels of {} um ({}){threshold}",
        report.picture, report.modality, report.pixel_size_um, report.pixel_size_source
    )];
    for cell in &report.cells {
        let contrast = cell.confidence.contrast;
        let contrast = contrast.map(|contrast| format!(", contrast {contrast:.1} times the noise"));
        parts.push(format!(
            "cell {}, confidence {:.2} of 1{}",
            cell.name,
            cell.confidence.score,
            contrast.unwrap_or_default()
        ));
        parts.extend(cell.confidence.reasons.iter().map(|reason| format!("  {reason}")));
        // Warnings go to stderr.
        let shape = cell.shape.to_string();
        let lines: Vec<&str> = shape.lines().filter(|line| !line.starts_with("warning")).collect();
        parts.push(lines.join("\n") + "\n");
    }
    parts.join("\n")
}
