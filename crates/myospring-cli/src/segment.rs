//! `myospring segment`.

pub(crate) mod report;
mod whole_frame;

use crate::args::SegmentArgs;
use crate::exit::ExitCode;
use crate::failure::Failure;
use crate::fibres;
use crate::files::FILES;
use crate::overlay::{self, Lattice};
use crate::refused::{self, Place, Refused};
use crate::terminal::Terminal;
use crate::{input, interrupt, print};
use myospring::experiment::Folder;
use myospring::microscopy::cells::{CellError, PictureCell, PictureCells};
use myospring::microscopy::outlines::raster::{write_labels_png, write_mask_png};
use myospring::microscopy::outlines::{
    NamedOutline, PixelFrame, write_cellpose, write_geojson, write_roi, write_roi_set,
};
use myospring::microscopy::segment::{Choice, SegmentError};
use myospring::output::figure::Figure;
use myospring::output::json;
use myospring::run_file::{Shape, ShapeError, Source};
use myospring::settings::PictureSource;
use report::{Chosen, LeftOut, Report};
use std::path::{Path, PathBuf};

/// Resolution of the overlay, dots per inch.
const DPI: f64 = 200.0;

/// Endings of files of outlines, in the order of the help.
const ENDINGS: [&str; 6] = ["geojson", "json", "roi", "zip", "txt", "png"];

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
    let (name, run) = input::settle(Some(&args.input), args.settings.overrides())?;
    let Source::Picture(source) = &run.shape.source else {
        let message = format!("`{}` is not a picture", args.input.display());
        return Err(Failure::new(message).advise("give a picture (.png, .tif, .tiff)"));
    };
    if args.whole_frame {
        return whole_frame::read(args, &name, &run, source);
    }
    let target = into.unwrap_or_else(|| folder(&name));
    if args.output.iter().all(|output| *output == target) {
        Folder::check(&target, args.force || refused::is_all_there_is(&target), &FILES)?;
    } else {
        may_be_written(args)?;
    }
    let bytes = run.shape.bytes(|file| FILES.bytes(file))?;
    let picture = args.input.display().to_string();
    let place = match args.output.first().filter(|file| **file != target) {
        Some(first) => Place::File(beside(first)),
        None => Place::Folder(target.clone()),
    };
    let refused = Refused { picture: &picture, shape: &run.shape, place };
    let cells = match source.cells(&bytes) {
        Ok(cells) => cells,
        Err(cause) => return Err(refused.without_cells(cause, &bytes)),
    };
    let all = args.settings.all_cells();
    let (chosen, left_out) = match chosen(&cells, source, all, source.allow_cut) {
        Ok(chosen) => chosen,
        Err(cause) => {
            let is_cut = matches!(cause, CellError::Segment(SegmentError::Cut { .. }));
            let failure = refused.with_cells(source.failed(cause), &cells, all);
            let left = if is_cut { write_cut(args, source, &cells, all)? } else { Vec::new() };
            if left.is_empty() {
                return Err(failure);
            }
            let left = left.join(", ");
            return Err(failure.also(&format!("what the frame leaves of it was written: {left}")));
        }
    };
    let (chosen, mut left_out) = (chosen, left_out);
    let (chosen, impossible) = of_possible_size(&run.shape, &cells, chosen);
    let first = impossible.into_iter().map(|(number, cause)| {
        left_out.push(LeftOut { number, reason: cause.to_string(), cut: false });
        cause
    });
    if let (Some(cause), true) = (first.last(), chosen.is_empty()) {
        return Err(refused.with_cells(cause, &cells, all));
    }
    let mut chosen = Chosen::of(&run.shape, &cells, chosen);
    for cell in &mut chosen {
        cell.look_for_fibres(run.fibre, &cells)?;
    }

    let report = Report::of(picture, &cells, &chosen, left_out);
    let notes = report::notes(&cells, &chosen, &report.left_out, all);
    let figure = draw(&report, &cells, &chosen, &notes)?;
    let written = write(args, &target, &cells, &chosen, &report, &figure)?;
    if args.json {
        print::out(&json::for_people(&report)?)?;
    } else {
        print::out(&report.for_people(&cells))?;
        print::out(&format!("\nwritten: {}", written.join(", ")))?;
    }
    if !args.quiet {
        for note in &notes {
            print::warn(note);
        }
    }
    Ok(ExitCode::SUCCESS)
}

/// The cells that were asked for, and of all of them those that are left out, each with the reason.
fn chosen(
    cells: &PictureCells,
    source: &PictureSource,
    all: bool,
    allow_cut: bool,
) -> Result<(Vec<PictureCell>, Vec<LeftOut>), CellError> {
    if !all {
        return Ok((vec![cells.cell(source.choice, allow_cut)?], Vec::new()));
    }
    let (mut every, mut left_out, mut first) = (Vec::new(), Vec::new(), None);
    for number in 1..=cells.len() as u32 {
        match cells.cell(Choice::Number(number), allow_cut) {
            Ok(cell) => every.push(cell),
            Err(error) => {
                let cut = matches!(error, CellError::Segment(SegmentError::Cut { .. }));
                left_out.push(LeftOut { number, reason: error.to_string(), cut });
                first.get_or_insert(error);
            }
        }
    }
    match first {
        Some(error) if every.is_empty() => Err(error),
        _ => Ok((every, left_out)),
    }
}

/// The cells whose size a heart cell may have, and the numbers of the others with the reason.
fn of_possible_size(
    shape: &Shape,
    cells: &PictureCells,
    chosen: Vec<PictureCell>,
) -> (Vec<PictureCell>, Vec<(u32, ShapeError)>) {
    let (mut possible, mut impossible) = (Vec::new(), Vec::new());
    for cell in chosen {
        match shape.check_size(cells, &cell) {
            Ok(()) => possible.push(cell),
            Err(cause) => impossible.push((cell.number, cause)),
        }
    }
    (possible, impossible)
}

/// The overlay; with lattice and fibres where there is one cell.
fn draw(
    report: &Report<'_>,
    cells: &PictureCells,
    chosen: &[Chosen],
    notes: &[String],
) -> Result<Figure, Failure> {
    let all: Vec<&PictureCell> = chosen.iter().map(|chosen| &chosen.cell).collect();
    let lattice = match chosen {
        [one] => one.mesh_and_fibres().map(|(mesh, fibres)| Lattice { mesh, fibres }),
        _ => None,
    };
    Ok(overlay::draw(&report.picture, cells, &all, lattice, notes)?)
}

/// Writes what was asked for and the overlay; the names of the files or of their folder.
fn write(
    args: &SegmentArgs,
    target: &Path,
    cells: &PictureCells,
    chosen: &[Chosen],
    report: &Report<'_>,
    figure: &Figure,
) -> Result<Vec<String>, Failure> {
    interrupt::heed(interrupt::WRITING);
    let frame = cells.frame().map_err(Failure::new)?;
    let named = named(chosen.iter().map(|chosen| &chosen.cell));
    if args.output.iter().all(|output| output == target) {
        let force = args.force || refused::is_all_there_is(target);
        let folder = Folder::claim(target, force, &FILES)?;
        let one = if named.len() == 1 { "cell.roi" } else { "cells.zip" };
        for file in ["outline.geojson", "mask.png", one] {
            folder.write(file, encoded(Path::new(file), &named, &frame)?)?;
        }
        folder.write("overlay.png", figure.to_png(DPI)?)?;
        folder.write("report.json", json::for_people(report)?)?;
        let with_fibres = chosen.iter().filter_map(|chosen| {
            let (mesh, fibres) = chosen.mesh_and_fibres()?;
            Some((chosen.cell.name.as_str(), mesh, fibres))
        });
        fibres::write(&folder, with_fibres)?;
        return Ok(vec![folder.finish(&Terminal::new(true))?.display().to_string()]);
    }
    let overlay = beside(&args.output[0]);
    let encoded: Vec<Vec<u8>> =
        args.output.iter().map(|file| encoded(file, &named, &frame)).collect::<Result<_, _>>()?;
    let png = figure.to_png(DPI)?;
    write_files(args.output.iter().zip(&encoded).chain([(&overlay, &png)]))
}

fn named<'a>(cells: impl Iterator<Item = &'a PictureCell>) -> Vec<NamedOutline> {
    let named = |cell: &PictureCell| NamedOutline {
        name: cell.name.clone(),
        outline: cell.outline.clone(),
    };
    cells.map(named).collect()
}

/// Refuses to write over what is there, and ever over what is read.
fn may_be_written(args: &SegmentArgs) -> Result<(), Failure> {
    let overlay = args.output.first().map(|first| beside(first));
    for file in args.output.iter().chain(&overlay) {
        FILES.check_writable(file)?;
        if file.exists() && !args.force {
            let message = format!("`{}` already exists", file.display());
            let failure = Failure::new(message);
            return Err(failure.advise("choose another name, or replace it with --force"));
        }
    }
    Ok(())
}

fn write_files<'a>(
    files: impl Iterator<Item = (&'a PathBuf, &'a Vec<u8>)>,
) -> Result<Vec<String>, Failure> {
    files
        .map(|(file, content)| {
            FILES.write_in_folder(file, content)?;
            Ok(file.display().to_string())
        })
        .collect()
}

/// Writes what the frame leaves of cells to the files that were named and are not there yet; their names.
fn write_cut(
    args: &SegmentArgs,
    source: &PictureSource,
    cells: &PictureCells,
    all: bool,
) -> Result<Vec<String>, Failure> {
    let files: Vec<&PathBuf> = args
        .output
        .iter()
        .filter(|file| into(&args.output).is_none() && (args.force || !file.exists()))
        .collect();
    let (cut, _) = chosen(cells, source, all, true).map_err(|cause| source.failed(cause))?;
    let (cut, frame) = (named(cut.iter()), cells.frame().map_err(Failure::new)?);
    let encoded: Vec<Vec<u8>> =
        files.iter().map(|file| encoded(file, &cut, &frame)).collect::<Result<_, _>>()?;
    write_files(files.into_iter().zip(&encoded))
}

/// The folder that was asked for: the only output, which has no ending or is one already.
fn into(outputs: &[PathBuf]) -> Option<PathBuf> {
    let [only] = outputs else { return None };
    let text = only.to_string_lossy();
    let is_folder = ending(only).is_empty() || text.ends_with(['/', '\\']) || only.is_dir();
    is_folder.then(|| only.clone())
}

/// Where the outlines of a picture of this name go unless they are named.
pub(crate) fn folder(name: &str) -> PathBuf {
    Path::new("results").join(format!("{name}_outline"))
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
