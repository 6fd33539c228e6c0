//! `myospring segment`.

use crate::args::SegmentArgs;
use crate::failure::Failure;
use crate::overlay::{self, Lattice};
use crate::results::Folder;
use crate::{input, interrupt, print};
use myospring::mesh::Mesh;
use myospring::mesh::quality::MeshReport;
use myospring::microscopy::cells::{CellError, PictureCell, PictureCells};
use myospring::microscopy::outlines::raster::{write_labels_png, write_mask_png};
use myospring::microscopy::outlines::{
    NamedOutline, PixelFrame, write_cellpose, write_geojson, write_roi, write_roi_set,
};
use myospring::microscopy::report::ShapeReport;
use myospring::microscopy::segment::{Choice, Confidence, SegmentError};
use myospring::output::figure::Figure;
use myospring::output::{files, json};
use myospring::run_file::{Run, ShapeError, Source};
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
    lattice: Option<LatticeReport>,
}

/// The lattice that `myospring run` would take, with the same --spacing.
#[derive(Serialize)]
struct LatticeReport {
    spacing_um: f64,
    masses: usize,
    springs: usize,
    triangles: usize,
}

/// A cell with its lattice, where the pixels give one.
struct Chosen {
    cell: PictureCell,
    lattice: Result<(Mesh, MeshReport), ShapeError>,
}

pub(crate) fn segment(args: &SegmentArgs) -> Result<ExitCode, Failure> {
    for file in &args.output {
        if !ENDINGS.contains(&ending(file).as_str()) {
            let message = format!("`{}` has an ending that is not known", file.display());
            return Err(Failure::new(message)
                .advise("write .geojson, .roi, .zip (RoiSet), .txt (Cellpose) or .png (mask)"));
        }
    }
    let (name, run) = input::settle(Some(&args.input), args.settings.overrides())?;
    let Source::Picture(source) = &run.shape.source else {
        let message = format!("`{}` is not a picture", args.input.display());
        return Err(Failure::new(message).advise("give a picture (.png, .tif, .tiff)"));
    };
    let bytes = run.shape.bytes(|file| std::fs::read(file))?;
    let cells = source.cells(&bytes)?;
    let all = args.settings.all_cells();
    let chosen = if all {
        every_cell(&cells, source.allow_cut)
    } else {
        cells.cell(source.choice, source.allow_cut).map(|cell| vec![cell])
    }
    .map_err(|cause| source.failed(cause))?;
    let meshed = |cell| Chosen { lattice: run.shape.lattice(&cells, &cell), cell };
    let chosen: Vec<Chosen> = chosen.into_iter().map(meshed).collect();

    let report = report(args, &cells, &chosen);
    let notes = notes(&cells, &chosen, all);
    let figure = draw(&report, &run, &cells, &chosen, &notes)?;
    let written = write(args, &name, &cells, &chosen, &report, &figure)?;
    if args.json {
        print::out(&json::pretty(&report)?)?;
    } else {
        print::out(&for_people(&report))?;
        print::out(&format!("\nwritten: {}", written.join(", ")))?;
    }
    if !args.quiet {
        for note in &notes {
            print::warn(note);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// Every cell; those that the frame cuts only where that is allowed, or if there are no others an error.
fn every_cell(cells: &PictureCells, allow_cut: bool) -> Result<Vec<PictureCell>, CellError> {
    let mut cut = None;
    let mut every = Vec::new();
    for number in 1..=cells.len() as u32 {
        match cells.cell(Choice::Number(number), allow_cut) {
            Ok(cell) => every.push(cell),
            Err(CellError::Segment(error @ SegmentError::Cut { .. })) => {
                cut.get_or_insert(error);
            }
            Err(error) => return Err(error),
        }
    }
    match cut {
        Some(error) if every.is_empty() => Err(error.into()),
        _ => Ok(every),
    }
}

fn report<'a>(args: &SegmentArgs, cells: &'a PictureCells, chosen: &'a [Chosen]) -> Report<'a> {
    let threshold = cells.segmentation().map(|found| found.threshold);
    let cell = |Chosen { cell, lattice }: &'a Chosen| CellReport {
        number: cell.number,
        name: &cell.name,
        confidence: &cell.confidence,
        shape: &cell.shape,
        lattice: lattice.as_ref().ok().map(|(mesh, report)| LatticeReport {
            spacing_um: report.spacing_um,
            masses: mesh.len(),
            springs: mesh.springs.len(),
            triangles: mesh.simplices.len(),
        }),
    };
    Report {
        picture: args.input.display().to_string(),
        modality: cells.modality(),
        pixel_size_um: cells.pixel_size.um(),
        pixel_size_source: cells.pixel_size_source,
        threshold: threshold.filter(|threshold| *threshold != 0.0),
        cells: chosen.iter().map(cell).collect(),
        notes: &cells.notes,
    }
}

/// What a person should look at.
fn notes(cells: &PictureCells, chosen: &[Chosen], all: bool) -> Vec<String> {
    let mut notes = cells.notes.clone();
    let left_out = cells.len() - chosen.len();
    if all && left_out > 0 {
        notes.push(format!(
            "{left_out} of {} cells are cut by the frame and were left out; --allow-cut takes them",
            cells.len()
        ));
    } else if left_out > 0 {
        notes.push(format!(
            "the picture has {} cells; --cell all writes all of them, --cell N or --seed X,Y another",
            cells.len()
        ));
    }
    for Chosen { cell, lattice } in chosen {
        let who = if chosen.len() > 1 { format!("cell {}: ", cell.name) } else { String::new() };
        let warnings = cell.confidence.warning().into_iter().chain(cell.shape.warnings.clone());
        notes.extend(warnings.map(|warning| format!("{who}{warning}")));
        notes.extend(lattice.as_ref().err().map(|error| format!("{who}no lattice: {error}")));
    }
    notes
}

/// The overlay; with lattice and fibres where there is one cell.
fn draw(
    report: &Report<'_>,
    run: &Run,
    cells: &PictureCells,
    chosen: &[Chosen],
    notes: &[String],
) -> Result<Figure, Failure> {
    let all: Vec<&PictureCell> = chosen.iter().map(|chosen| &chosen.cell).collect();
    let mesh = match chosen {
        [Chosen { lattice: Ok((mesh, _)), .. }] => Some(mesh),
        _ => None,
    };
    let fibres = mesh.map(|mesh| run.fibres(mesh, None)).unwrap_or_default();
    let lattice = mesh.map(|mesh| Lattice { mesh, fibres: &fibres, field: None });
    Ok(overlay::draw(&report.picture, cells, &all, lattice, notes)?)
}

/// Writes what was asked for and the overlay; the names of the files or of their folder.
fn write(
    args: &SegmentArgs,
    name: &str,
    cells: &PictureCells,
    chosen: &[Chosen],
    report: &Report<'_>,
    figure: &Figure,
) -> Result<Vec<String>, Failure> {
    interrupt::heed(interrupt::WRITING);
    let frame = cells.frame().map_err(Failure::new)?;
    let named: Vec<NamedOutline> = chosen
        .iter()
        .map(|Chosen { cell, .. }| NamedOutline {
            name: cell.name.clone(),
            outline: cell.outline.clone(),
        })
        .collect();
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
        // Warnings go to stderr.
        let shape = cell.shape.to_string();
        let lines: Vec<&str> = shape.lines().filter(|line| !line.starts_with("warning")).collect();
        parts.push(lines.join("\n"));
        if let Some(LatticeReport { spacing_um, masses, springs, triangles }) = &cell.lattice {
            parts.push(format!(
                "{:<20} {masses} masses, {springs} springs, {triangles} triangles, spacing {spacing_um} um",
                "lattice"
            ));
        }
        parts.push(String::new());
    }
    parts.join("\n")
}
