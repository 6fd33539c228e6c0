//! Pictures as members of a study: the cells of each found, meshed and beaten, one row a cell.

mod row;

pub use row::CellRow;

use super::{Cause, Interrupted, Member, Row as _, Status, sha256};
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::segment::Choice;
use crate::output::report::Summary;
use crate::settings::{Made, PictureSource, Run, ShapeError, Source};
use crate::simulation::{Outcome, Progress, Simulation, StopReason};
use std::fs;
use std::path::PathBuf;
use std::time::Instant;

/// How many cells the reason of a picture without any names.
const FEW: usize = 3;

/// A picture of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Its name in the table.
    pub name: String,
    /// The file.
    pub path: PathBuf,
}

impl Member for Picture {
    const KIND: &'static str = "picture";
    type Row = CellRow;

    fn name(&self) -> &str {
        &self.name
    }

    fn key(&self) -> Option<String> {
        fs::read(&self.path).ok().map(|bytes| sha256(&bytes))
    }
}

/// Which cells of a picture are beaten.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Which {
    /// All that the frame does not cut and that are not doubtful; the others are left out with the reason.
    Every,
    /// The one that the run chooses, whatever speaks against it.
    Chosen,
}

/// A cell that has beaten.
pub struct Beaten<'a> {
    /// The picture's name.
    pub picture: &'a str,
    /// The cell's name.
    pub cell: &'a str,
    /// The settings.
    pub run: &'a Run,
    /// The cell on its mesh.
    pub simulation: &'a Simulation,
    /// What came of it.
    pub finished: &'a Outcome,
    /// Its numbers.
    pub summary: &'a Summary,
}

/// Keeps more than rows, such as drawings; `()` keeps nothing. What it cannot keep fails the row.
pub trait Keeper: Sync {
    /// A picture's cells were found; those `to_beat` will be beaten.
    ///
    /// # Errors
    /// Whatever cannot be kept; the picture fails.
    fn found(
        &self,
        _picture: &str,
        _cells: &PictureCells,
        _to_beat: &[&PictureCell],
    ) -> Result<(), Cause> {
        Ok(())
    }

    /// A cell has beaten, to its end or up to a stop.
    ///
    /// # Errors
    /// Whatever cannot be kept; the cell fails.
    fn beaten(&self, _beaten: &Beaten<'_>) -> Result<(), Cause> {
        Ok(())
    }

    /// Asked often while a cell beats; `false` leaves the picture undone, with [`Interrupted`].
    fn goes_on(&self) -> bool {
        true
    }
}

impl Keeper for () {}

/// Finds the cells of a picture and beats them; `run` has the settings, with the picture as its shape.
///
/// Each beat is moved by as many threads as the run says, one unless told otherwise.
///
/// # Errors
/// A run without a picture, a picture that cannot be read or shows no cell, or what `keeper` says; [`Interrupted`]
/// where it ends the beats. What is wrong with one of several cells is a row.
pub fn rows(
    picture: &str,
    run: &Run,
    which: Which,
    keeper: &impl Keeper,
) -> Result<Vec<CellRow>, Cause> {
    let start = Instant::now();
    let Source::Picture(source) = &run.shape.source else {
        return Err("the run takes its shape from no picture; give it shape.picture".into());
    };
    let bytes = run.shape.bytes(|file| fs::read(file))?;
    let cells = source.cells(&bytes)?;
    let segment_s = start.elapsed().as_secs_f64();
    let (chosen, mut rows) = chosen(source, &cells, which, picture)?;
    let reason = |cell: &PictureCell| left_out(cell, which, source.allow_cut);
    let to_beat: Vec<&PictureCell> = chosen.iter().filter(|cell| reason(cell).is_none()).collect();
    if !keeper.goes_on() {
        return Err(Interrupted.into());
    }
    keeper.found(picture, &cells, &to_beat)?;
    for cell in chosen {
        let mut row = CellRow::of(picture, &cells, &cell);
        row.number("segment_s", segment_s);
        if let Some(reason) = reason(&cell) {
            row.is_not_ok(Status::LeftOut, reason);
        } else if let Err(cause) = beat(run, &cells, cell, &mut row, keeper) {
            if cause.is::<Interrupted>() {
                return Err(cause);
            }
            row.is_not_ok(Status::Failed, cause.to_string());
        }
        rows.push(row);
    }
    if rows.iter().all(|row| row.status == Status::LeftOut) {
        let reasons: Vec<String> = rows
            .iter()
            .take(FEW)
            .map(|row| format!("cell {}: {}", row.cell.as_deref().unwrap_or("?"), row.reason))
            .collect();
        let reason = format!("no cell is whole and sure enough to beat: {}", reasons.join("; "));
        rows.push(CellRow::failed(picture, reason));
    }
    Ok(rows)
}

/// The cells to be looked at, and rows of those that cannot be outlined.
fn chosen(
    source: &PictureSource,
    cells: &PictureCells,
    which: Which,
    picture: &str,
) -> Result<(Vec<PictureCell>, Vec<CellRow>), ShapeError> {
    if which == Which::Chosen {
        let cell = cells.cell(source.choice, source.allow_cut);
        return Ok((vec![cell.map_err(|cause| source.failed(cause))?], Vec::new()));
    }
    let (mut chosen, mut failed) = (Vec::new(), Vec::new());
    for number in 1..=cells.len() as u32 {
        match cells.cell(Choice::Number(number), true) {
            Ok(cell) => chosen.push(cell),
            Err(error) => {
                let row = CellRow::failed(picture, error.to_string());
                failed.push(CellRow { cell: Some(number.to_string()), ..row });
            }
        }
    }
    Ok((chosen, failed))
}

/// Why a cell is not beaten.
fn left_out(cell: &PictureCell, which: Which, allow_cut: bool) -> Option<String> {
    if which == Which::Chosen {
        return None;
    }
    let on_frame = cell.shape.pixels_on_frame;
    if on_frame > 0 && !allow_cut {
        return Some(format!(
            "the frame cuts it ({on_frame} pixels); --allow-cut beats it nevertheless"
        ));
    }
    if cell.confidence.is_doubtful() {
        let reasons = cell.confidence.reasons.join("; ");
        return Some(format!("doubtful, confidence {:.2} of 1: {reasons}", cell.confidence.score));
    }
    None
}

/// Beats one cell and adds its numbers to the row.
fn beat(
    run: &Run,
    cells: &PictureCells,
    cell: PictureCell,
    row: &mut CellRow,
    keeper: &impl Keeper,
) -> Result<(), Cause> {
    let start = Instant::now();
    let name = cell.name.clone();
    let shaped = run.shape.mesh_cell(cells.clone(), cell)?;
    let Made { simulation, report, field, .. } = run.make(shaped, |file| std::fs::read(file))?;
    row.number("spacing_um", report.spacing_um);
    row.number("masses", simulation.mesh.len() as f64);
    row.number("springs", simulation.mesh.springs.len() as f64);
    row.number("triangles", simulation.mesh.simplices.len() as f64);
    if let Some(field) = &field {
        let fibres = field.summary();
        row.number("fibres_from_picture_pct", 100.0 * fibres.share_from_picture);
        row.number("fibre_angle_to_axis_deg", fibres.mean_angle_deg);
        row.number("fibre_order", fibres.alignment);
    }
    let prepared = simulation.build()?;
    let finished = prepared.run(|Progress { .. }| keeper.goes_on());
    if matches!(finished.stop, Some(StopReason::Interrupted { .. })) {
        return Err(Interrupted.into());
    }
    let mut warnings = run.warnings(&report);
    warnings.extend(prepared.warnings());
    row.warnings = warnings.join("; ");
    let summary = Summary::new(&finished.recording, &run.stimulus_times(), report, warnings);
    row.metrics(&summary);
    let (picture, simulation, finished) = (row.picture.as_str(), &simulation, &finished);
    keeper.beaten(&Beaten {
        picture,
        cell: &name,
        run,
        simulation,
        finished,
        summary: &summary,
    })?;
    row.number("beat_s", start.elapsed().as_secs_f64());
    match &finished.stop {
        Some(stop) => Err(format!("the beat stopped early: {stop}").into()),
        None => Ok(()),
    }
}
