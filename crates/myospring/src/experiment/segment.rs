//! The cells of a picture: outlines, confidence, shape in numbers, fibres.

mod formats;
pub(super) mod report;
mod whole_frame;

pub use formats::ENDINGS;
pub use report::{CellReport, Chosen, LatticeReport, LeftOut, SegmentReport};
pub use whole_frame::{FieldOfView, FrameFibres, FrameReport, ReadWholeFrame};

use super::error::ExperimentError;
use super::files::Files;
use super::folder::Folder;
use super::observer::Observer;
use super::overlay::{self, Lattice};
use super::refused::{Place, Refused};
use super::{Experiment, Outcome, fibres};
use crate::microscopy::cells::{CellError, PictureCell, PictureCells};
use crate::microscopy::outlines::NamedOutline;
use crate::microscopy::segment::{Choice, SegmentError};
use crate::output::figure::{Figure, FigureError};
use crate::output::json;
use crate::run_file::{Shape, ShapeError, Source};
use crate::settings::{PictureSource, Run};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Resolution of the overlay, dots per inch.
const DPI: f64 = 200.0;

/// Finds the cells of a picture, without a simulation.
pub struct Segment {
    /// The picture, as people named it.
    pub picture: String,
    /// How it is read and segmented, and how fibres are looked for.
    pub run: Run,
    /// Whether to return all cells, not only the one that the run chooses.
    pub all: bool,
    /// Where an overlay goes that shows why no cell is taken.
    pub refused: Option<Place>,
    /// Files of outlines that are written even if the frame cuts the cell; they then hold the part
    /// within the frame.
    pub of_cut: Vec<PathBuf>,
}

/// The cells that were found.
pub struct Segmented {
    /// The picture, as people named it.
    pub picture: String,
    /// The picture with all its cells.
    pub cells: PictureCells,
    /// Those that were asked for.
    pub chosen: Vec<Chosen>,
    /// Cells that were requested with all others but are not accepted.
    pub left_out: Vec<LeftOut>,
    all: bool,
}

impl Experiment for Segment {
    type Outcome = Segmented;

    fn run(&self, files: &Files, observer: &dyn Observer) -> Result<Segmented, ExperimentError> {
        let shape = &self.run.clone().interrupted_by(&observer.interruption()).shape;
        let Source::Picture(source) = &shape.source else {
            let message = format!("`{}` is not a picture", self.picture);
            return Err(ExperimentError::new(message).advise("give a picture (.png, .tif, .tiff)"));
        };
        let bytes = shape.bytes(|file| files.bytes(file))?;
        let refused = Refused { picture: &self.picture, shape, place: self.refused.clone(), files };
        observer.stage("outlines", 1);
        let cells = source.cells(&bytes).map_err(|cause| refused.without_cells(cause, &bytes))?;
        let (chosen, mut left_out) = match chosen(&cells, source, self.all, source.allow_cut) {
            Ok(chosen) => chosen,
            Err(cause) => {
                let is_cut = matches!(cause, CellError::Segment(SegmentError::Cut { .. }));
                let error = refused.with_cells(source.failed(cause), &cells, self.all);
                let left = if is_cut { self.write_cut(source, &cells, files)? } else { Vec::new() };
                if left.is_empty() {
                    return Err(error);
                }
                let left = left.join(", ");
                return Err(error.also(&format!("the part within the frame was written: {left}")));
            }
        };
        let (chosen, impossible) = of_possible_size(shape, &cells, chosen);
        let first = impossible.into_iter().map(|(number, cause)| {
            left_out.push(LeftOut { number, reason: cause.to_string(), cut: false });
            cause
        });
        if let (Some(cause), true) = (first.last(), chosen.is_empty()) {
            return Err(refused.with_cells(cause, &cells, self.all));
        }
        observer.reached(1);
        let mut chosen = Chosen::of(shape, &cells, chosen);
        observer.stage("fibres of cells", chosen.len() as u64);
        for (done, cell) in (1..).zip(&mut chosen) {
            cell.look_for_fibres(self.run.fibre, &cells)?;
            observer.reached(done);
            observer.interruption().check().map_err(ExperimentError::new)?;
        }
        Ok(Segmented { picture: self.picture.clone(), cells, chosen, left_out, all: self.all })
    }
}

impl Segment {
    /// Writes the parts of cells within the frame; returns the names of the files.
    fn write_cut(
        &self,
        source: &PictureSource,
        cells: &PictureCells,
        files: &Files,
    ) -> Result<Vec<String>, ExperimentError> {
        let (cut, _) =
            chosen(cells, source, self.all, true).map_err(|cause| source.failed(cause))?;
        let (cut, frame) = (named(cut.iter()), cells.frame().map_err(ExperimentError::new)?);
        let encoded: Vec<Vec<u8>> = self
            .of_cut
            .iter()
            .map(|file| formats::encoded(file, &cut, &frame))
            .collect::<Result<_, _>>()?;
        write_files(self.of_cut.iter().zip(&encoded), files)
    }
}

impl Segmented {
    /// What was found, as `report.json` has it.
    pub fn report(&self) -> SegmentReport<'_> {
        SegmentReport::of(&self.picture, &self.cells, &self.chosen, &self.left_out)
    }

    /// The picture with its outlines; with lattice and fibres where there is one cell.
    ///
    /// # Errors
    /// A picture that cannot be drawn.
    pub fn overlay(&self) -> Result<Figure, FigureError> {
        let all: Vec<&PictureCell> = self.chosen.iter().map(|chosen| &chosen.cell).collect();
        let lattice = match self.chosen.as_slice() {
            [one] => one.mesh_and_fibres().map(|(mesh, fibres)| Lattice { mesh, fibres }),
            _ => None,
        };
        overlay::draw(&self.picture, &self.cells, &all, lattice, &self.warnings())
    }

    /// Writes the outlines to files, each in the format that its ending names ([`ENDINGS`]), and an
    /// overlay next to the first; returns the names of all files.
    ///
    /// # Errors
    /// A format that cannot hold these outlines, and a file that cannot be written.
    pub fn write(
        &self,
        outlines: &[PathBuf],
        files: &Files,
    ) -> Result<Vec<String>, ExperimentError> {
        let Some(first) = outlines.first() else { return Ok(Vec::new()) };
        let encoded: Vec<Vec<u8>> =
            outlines.iter().map(|file| self.encoded(file)).collect::<Result<_, _>>()?;
        let (overlay, png) = (overlay_path(first), self.overlay()?.to_png(DPI)?);
        write_files(outlines.iter().zip(&encoded).chain([(&overlay, &png)]), files)
    }

    /// The outlines in the format that the ending of a file names ([`ENDINGS`]).
    ///
    /// # Errors
    /// A format that is not known, or that cannot hold these outlines.
    pub fn encoded(&self, file: &Path) -> Result<Vec<u8>, ExperimentError> {
        let frame = self.cells.frame().map_err(ExperimentError::new)?;
        formats::encoded(file, &named(self.chosen.iter().map(|chosen| &chosen.cell)), &frame)
    }
}

impl Outcome for Segmented {
    fn numbers(&self) -> impl Serialize {
        self.report()
    }

    fn warnings(&self) -> Vec<String> {
        report::notes(&self.cells, &self.chosen, &self.left_out, self.all)
    }

    fn save(&self, folder: &Folder, _: &dyn Observer) -> Result<(), ExperimentError> {
        let one = if self.chosen.len() == 1 { "cell.roi" } else { "cells.zip" };
        for file in ["outline.geojson", "mask.png", one] {
            folder.write(file, self.encoded(Path::new(file))?)?;
        }
        folder.write("overlay.png", self.overlay()?.to_png(DPI)?)?;
        folder.write("report.json", json::for_people(&self.report())?)?;
        let with_fibres = self.chosen.iter().filter_map(|chosen| {
            let (mesh, fibres) = chosen.mesh_and_fibres()?;
            Some((chosen.cell.name.as_str(), mesh, fibres))
        });
        fibres::write(folder, with_fibres)
    }
}

/// The requested cells and, if all were requested, those that are left out, each with the reason.
pub(super) fn chosen(
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
pub(super) fn of_possible_size(
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

fn named<'a>(cells: impl Iterator<Item = &'a PictureCell>) -> Vec<NamedOutline> {
    let named = |cell: &PictureCell| NamedOutline {
        name: cell.name.clone(),
        outline: cell.outline.clone(),
    };
    cells.map(named).collect()
}

fn write_files<'a>(
    contents: impl Iterator<Item = (&'a PathBuf, &'a Vec<u8>)>,
    files: &Files,
) -> Result<Vec<String>, ExperimentError> {
    contents
        .map(|(file, content)| {
            files.write_in_folder(file, content)?;
            Ok(file.display().to_string())
        })
        .collect()
}

/// Refuses to overwrite outlines, and the overlay next to the first, unless `force`; files that are
/// read are never overwritten.
///
/// # Errors
///
/// A file that exists or is read.
pub fn check(outlines: &[PathBuf], force: bool, files: &Files) -> Result<(), ExperimentError> {
    let overlay = outlines.first().map(|first| overlay_path(first));
    for file in outlines.iter().chain(&overlay) {
        files.check_writable(file)?;
        if file.exists() && !force {
            let message = format!("`{}` already exists", file.display());
            return Err(ExperimentError::new(message)
                .advise("choose another name, or replace it with --force"));
        }
    }
    Ok(())
}

/// The path of the overlay of a file of outlines: `cell.roi` gives `cell_overlay.png`.
pub fn overlay_path(file: &Path) -> PathBuf {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    file.with_file_name(format!("{stem}_overlay.png"))
}
