//! Pictures as members of a study: the cells of each picture are found, meshed and simulated, one
//! row per cell.

mod left_out;
mod row;
mod table;

pub use row::CellRow;
pub use table::{TableError, TableSetting, read_table};

use left_out::{LeftOut, notes};

use super::{Cause, Interrupted, Member, Row as _, Status, sha256};
use crate::analysis::summary::Summary;
use crate::clock::Stopwatch;
use crate::mesh::outline::Outline;
use crate::microscopy::cells::{PictureCell, PictureCells};
use crate::microscopy::segment::Choice;
use crate::output::files;
use crate::settings::{Fibres, MeshedRun, PictureSource, Run, ShapeError, Shaped, Source};
use crate::simulation::{Outcome, Simulation, StopReason};
use std::path::PathBuf;

/// Largest number of skipped cells that the reason of a picture without usable cells names.
const FEW: usize = 3;

/// A picture of a study, or one of its cells with its own settings.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// Name, unique in the study.
    pub name: String,
    /// Name in the table of results; several cells may share it.
    pub file: String,
    /// Path of the file.
    pub path: PathBuf,
    /// Group to which it belongs, for statistics.
    pub group: Option<String>,
    /// Its own settings.
    pub given: Vec<TableSetting>,
    /// Files that these settings name.
    pub files: Vec<PathBuf>,
    /// Whether it is a stack of slices, with one thick cell.
    pub is_stack: bool,
}

impl Picture {
    /// Creates a picture without its own settings.
    pub fn new(name: String, path: PathBuf) -> Self {
        let (file, group, is_stack) = (name.clone(), None, false);
        Self { name, file, path, group, given: Vec::new(), files: Vec::new(), is_stack }
    }

    /// Returns the row of this picture if only the reason for its failure is known.
    pub fn failed(&self, reason: String) -> CellRow {
        CellRow { group: self.group.clone(), ..CellRow::failed(&self.file, reason) }
    }
}

impl Member for Picture {
    const KIND: &'static str = "picture";
    type Row = CellRow;

    fn name(&self) -> &str {
        &self.name
    }

    /// Hash of the picture and of its own settings and files.
    fn key(&self) -> Option<String> {
        let picture = sha256(&files::read(&self.path).ok()?);
        if self.given.is_empty() && self.group.is_none() && !self.is_stack {
            return Some(picture);
        }
        let mut parts = vec![picture, format!("{:?}", self.group)];
        parts.extend(self.is_stack.then(|| "stack".to_owned()));
        parts.extend(self.given.iter().map(|given| format!("{} = {}", given.key, given.value)));
        for file in &self.files {
            parts.push(sha256(&files::read(file.as_ref()).ok()?));
        }
        Some(sha256(parts.join("\n").as_bytes()))
    }
}

/// Choice of the cells of a picture to simulate. Cells that are cut by the frame, doubtful, or of
/// an unexpected area are skipped with the reason, unless one is chosen explicitly: by its number,
/// label or position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ChosenCell {
    /// All cells.
    Every,
    /// The cell that the run chooses; it is an error if the frame cuts it.
    Chosen,
}

/// A simulated cell.
pub struct SimulatedCell<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// Name of the cell.
    pub cell: &'a str,
    /// Settings, which choose this cell.
    pub run: &'a Run,
    /// Distance between neighbouring nodes, um.
    pub spacing_um: f64,
    /// Simulation of the cell on its mesh.
    pub simulation: &'a Simulation,
    /// Outline that was meshed, um.
    pub outline: &'a Outline,
    /// Fibres of the cell, and what the picture shows of them.
    pub fibres: &'a Fibres,
    /// Outcome of the run.
    pub finished: &'a Outcome,
    /// Summary of the run.
    pub summary: &'a Summary,
}

/// Writes results other than rows, such as drawings; `()` writes nothing. If writing fails, the row
/// fails.
pub trait Keeper: Sync {
    /// Called after the cells of a picture were found. The cells `to_beat` will be simulated;
    /// `notes` are for users, such as why there is no cell.
    ///
    /// # Errors
    /// Whatever cannot be written; the picture fails.
    fn found(
        &self,
        _picture: &Picture,
        _cells: &PictureCells,
        _to_beat: &[&PictureCell],
        _notes: &[String],
    ) -> Result<(), Cause> {
        Ok(())
    }

    /// Called after a cell was simulated, to the end or up to an early stop.
    ///
    /// # Errors
    /// Whatever cannot be written; the cell fails.
    fn beaten(&self, _beaten: &SimulatedCell<'_>) -> Result<(), Cause> {
        Ok(())
    }
}

impl Keeper for () {}

/// Finds the cells of a picture and simulates them. `run` has the settings, with the picture as its
/// shape. Returns at least one row: an error of the picture or of a cell is a row with the reason.
///
/// Each simulation uses as many threads as the run states, by default one.
///
/// # Errors
/// Only [`Interrupted`], if the run is asked to end early.
pub fn rows(
    picture: &Picture,
    run: &Run,
    which: ChosenCell,
    keeper: &impl Keeper,
) -> Result<Vec<CellRow>, Cause> {
    let mut rows = match found_and_beaten(picture, run, which, keeper) {
        // After an interruption, any other error is a consequence of it.
        Err(_) if run.interruption.is_requested() => return Err(Interrupted.into()),
        Err(cause) => vec![picture.failed(cause.to_string())],
        Ok(rows) => rows,
    };
    for row in &mut rows {
        row.group.clone_from(&picture.group);
    }
    Ok(rows)
}

fn found_and_beaten(
    picture: &Picture,
    run: &Run,
    which: ChosenCell,
    keeper: &impl Keeper,
) -> Result<Vec<CellRow>, Cause> {
    let start = Stopwatch::start();
    let Source::Picture(source) = &run.shape.source else {
        return Err("the run has no picture as its shape; set shape.picture".into());
    };
    let bytes = run.shape.bytes(|file| files::read(file.as_ref()))?;
    if run.shape.slices().is_some() {
        let shaped = run.shape.mesh(&bytes)?;
        if let Some((cells, cell)) = shaped.stack.as_deref().and_then(|stack| stack.seen.as_ref()) {
            keeper.found(picture, cells, &[cell], &shaped.report.warnings)?;
        }
        let mut row = CellRow::of_stack(&picture.file, &shaped);
        row.number("segment_s", start.elapsed().as_secs_f64());
        let beaten = beat(picture, run, shaped, &mut row, keeper);
        return ended(beaten, run, row).map(|row| vec![row]);
    }
    // The overlay is written even if the picture is refused.
    let refused = |seen: &PictureCells, cause: ShapeError| -> Cause {
        let notes = [vec![cause.to_string()], seen.notes.clone()].concat();
        match keeper.found(picture, seen, &[], &notes) {
            Ok(()) => cause.into(),
            Err(unkept) => format!("{cause}; and its overlay cannot be written: {unkept}").into(),
        }
    };
    let cells = match source.cells(&bytes) {
        Ok(cells) => cells,
        Err(cause) => match source.unsegmented(&bytes) {
            Ok(seen) => return Err(refused(&seen, cause)),
            Err(_) => return Err(cause.into()),
        },
    };
    let segment_s = start.elapsed().as_secs_f64();
    let (chosen, mut rows) =
        chosen(source, &cells, which, &picture.file).map_err(|cause| refused(&cells, cause))?;
    let pointed_at = which == ChosenCell::Chosen && source.choice != Choice::Largest;
    let reason = |cell: &PictureCell| {
        if pointed_at { None } else { LeftOut::of(&cells, cell, source.allow_cut) }
    };
    let to_beat: Vec<&PictureCell> = chosen.iter().filter(|cell| reason(cell).is_none()).collect();
    run.interruption.check()?;
    let mut notes = notes(&cells, &chosen, reason);
    notes.extend(rows.iter().map(|row: &CellRow| row.reason.clone()));
    keeper.found(picture, &cells, &to_beat, &notes)?;
    for cell in chosen {
        let mut row = CellRow::of(&picture.file, &cells, &cell);
        row.number("segment_s", segment_s);
        if let Some(reason) = reason(&cell) {
            row.is_not_ok(Status::LeftOut, reason.to_string());
            rows.push(row);
            continue;
        }
        let mut run = run.clone();
        if let Some(choice) = run.shape.source.choice_mut() {
            *choice = Choice::Number(cell.number);
        }
        let shaped = run.shape.mesh_cell(cells.clone(), cell).map_err(Cause::from);
        let beaten = shaped.and_then(|shaped| beat(picture, &run, shaped, &mut row, keeper));
        rows.push(ended(beaten, &run, row)?);
    }
    if rows.iter().all(|row| row.status == Status::LeftOut) {
        let reasons: Vec<String> = rows
            .iter()
            .take(FEW)
            .map(|row| format!("cell {}: {}", row.cell.as_deref().unwrap_or("?"), row.reason))
            .collect();
        let none = "no cell is complete, of sufficient confidence and of an expected size";
        rows.push(picture.failed(format!("{none}: {}", reasons.join("; "))));
    }
    Ok(rows)
}

/// Returns the cells to consider, and the rows of those that cannot be outlined.
fn chosen(
    source: &PictureSource,
    cells: &PictureCells,
    which: ChosenCell,
    picture: &str,
) -> Result<(Vec<PictureCell>, Vec<CellRow>), ShapeError> {
    if which == ChosenCell::Chosen {
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

/// The row of a cell whose simulation has ended, with the reason if it failed; an error only if it was interrupted.
fn ended(beaten: Result<(), Cause>, run: &Run, mut row: CellRow) -> Result<CellRow, Cause> {
    if let Err(cause) = beaten {
        run.interruption.check()?;
        row.is_not_ok(Status::Failed, cause.to_string());
    }
    Ok(row)
}

/// Simulates one cell, which the run chooses, and adds its numbers to the row.
fn beat(
    picture: &Picture,
    run: &Run,
    shaped: Shaped,
    row: &mut CellRow,
    keeper: &impl Keeper,
) -> Result<(), Cause> {
    let start = Stopwatch::start();
    let name = row.cell.clone().unwrap_or_default();
    let MeshedRun { simulation, report, outline, fibres, .. } =
        run.make(shaped, |file| files::read(file.as_ref()))?;
    let spacing_um = report.spacing_um;
    row.number("spacing_um", spacing_um);
    row.number("masses", simulation.mesh.len() as f64);
    row.number("springs", simulation.mesh.springs.len() as f64);
    row.number("triangles", simulation.mesh.simplices.len() as f64);
    row.fibres(&fibres.report(), picture.is_stack);
    let prepared = simulation.build()?;
    let finished = prepared.run(|_progress| true);
    if matches!(finished.stop, Some(StopReason::Interrupted { .. })) {
        return Err(Interrupted.into());
    }
    let mut warnings = run.warnings(&report);
    warnings.extend(prepared.warnings());
    warnings.extend(prepared.warnings_after(&finished));
    row.warnings = warnings.join("; ");
    let (stimuli, s2_ms) = (run.stimulus_times(), run.s2_ms());
    let summary = Summary::new(&finished.recording, &stimuli, s2_ms, report, warnings)
        .with_about_model(simulation.pace(&finished.beats()).about_model());
    row.metrics(&summary);
    let own = Run { fibre: fibres.taken, ..run.clone() };
    let (simulation, finished, run) = (&simulation, &finished, &own);
    keeper.beaten(&SimulatedCell {
        picture,
        cell: &name,
        run,
        spacing_um,
        simulation,
        outline: &outline,
        fibres: &fibres,
        finished,
        summary: &summary,
    })?;
    row.number("beat_s", start.elapsed().as_secs_f64());
    match &finished.stop {
        Some(stop) => Err(format!("the beat stopped early: {stop}").into()),
        None => Ok(()),
    }
}
