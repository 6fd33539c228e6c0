//! Cells without a mesh as members of a study: action potential and tension of each cell, one row
//! per beat.
//!
//! They are integrated together if their model can be ([`batch`]), on all threads of the study,
//! with results that are identical to the last bit to those of single cells.
//!
//! # Example
//! Cells whose slow inward current differs:
//! ```
//! use myospring::cell::solve::{CellMethod, SolverSettings};
//! use myospring::cell::{self, pacing::Protocol};
//! use myospring::study::cells::{PacedCell, run, settings};
//! use myospring::study::{Journal, Threads};
//!
//! let published = cell::model("coelho_2021")?;
//! let mut cells = Vec::new();
//! for percent in [90.0, 100.0, 110.0] {
//!     let mut parameters = published.parameters().clone();
//!     parameters.set("tau_si", 1.76816 * percent / 100.0)?;
//!     let model = published.with_parameters(parameters)?;
//!     let protocol = Protocol::once(published.default_stimulus());
//!     cells.push(PacedCell { name: format!("{percent} %"), model, protocol, duration_ms: 600.0 });
//! }
//! # let folder = tempfile::tempdir()?;
//! let method = SolverSettings::of(CellMethod::Adaptive);
//! let journal = Journal::open(&folder.path().join("tau_si"), &settings(method))?;
//! let report = run(&cells, method, &journal, &Threads::new(None)?, &())?;
//! let apd: Vec<f64> = report.rows.iter().filter_map(|row| row.beat?.apd90_ms).collect();
//! assert!(apd[0] > apd[1] && apd[1] > apd[2]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use super::{
    Cause, Interrupted, Journal, Member, Row, Status, StudyError, StudyObserver, StudyReport,
    Threads, run_together, sha256,
};
use crate::cell::CellModel;
use crate::cell::batch::{self, BatchSettings, CellBeat, Paced, TOGETHER};
use crate::cell::pacing::Protocol;
use crate::cell::solve::{SolveError, SolverSettings};
use crate::output::table::{Column, Table};
use serde::{Deserialize, Serialize};
use std::num::NonZeroUsize;
use std::sync::Arc;

/// Largest number of cells that are started and recorded together: enough to keep the lanes nearly
/// always full.
const GROUP: usize = 8 * TOGETHER;

/// A cell and its pacing.
#[derive(Clone)]
pub struct PacedCell {
    /// Name in the table.
    pub name: String,
    /// Model: equations and constants.
    pub model: Arc<dyn CellModel>,
    /// Pacing protocol.
    pub protocol: Protocol,
    /// Simulated duration, ms.
    pub duration_ms: f64,
}

impl Member for PacedCell {
    const KIND: &'static str = "cell";
    type Row = BeatRow;

    fn name(&self) -> &str {
        &self.name
    }

    /// Hash of the model's name, every parameter to the last bit, the protocol and the duration.
    fn key(&self) -> Option<String> {
        let Self { model, protocol, duration_ms, .. } = self;
        let rows = model.parameters().rows().iter();
        let parameters: Vec<String> =
            rows.map(|row| format!("{} = {:?} {}", row.name, row.value, row.unit)).collect();
        let text = format!(
            "{}\n{}\n{protocol:?}\n{duration_ms:?} ms",
            model.name(),
            parameters.join("\n")
        );
        Some(sha256(text.as_bytes()))
    }
}

/// A beat of a cell, or a cell that failed or was never stimulated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BeatRow {
    /// Name of the cell.
    pub cell: String,
    /// Outcome.
    pub status: Status,
    /// Reason if the status is not ok; else empty.
    pub reason: String,
    /// Number of the beat, from 1.
    pub number: Option<u32>,
    /// The beat.
    pub beat: Option<CellBeat>,
}

impl Row for BeatRow {
    fn failed(cell: &str, reason: String) -> Self {
        Self { status: Status::Failed, reason, ..Self::at_rest(cell) }
    }

    fn status(&self) -> Status {
        self.status
    }

    fn table(rows: &[Self]) -> Table {
        let text = |name: &str, read: fn(&Self) -> String| Column::Text {
            name: name.to_owned(),
            values: rows.iter().map(|row| Some(read(row))).collect(),
        };
        let number = |name: &str, read: fn(&Self) -> Option<f64>| Column::Number {
            name: name.to_owned(),
            values: rows.iter().map(read).collect(),
        };
        Table {
            columns: vec![
                text("cell", |row| row.cell.clone()),
                text("status", |row| row.status.to_string()),
                text("reason", |row| row.reason.clone()),
                number("beat", |row| row.number.map(f64::from)),
                number("stimulus_ms", |row| Some(row.beat?.stimulus_ms)),
                number("resting_potential", |row| Some(row.beat?.resting_potential)),
                number("peak_potential", |row| Some(row.beat?.peak_potential)),
                number("peak_tension", |row| Some(row.beat?.peak_tension)),
                number("peak_tension_ms", |row| Some(row.beat?.peak_tension_ms)),
                number("apd90_ms", |row| row.beat?.apd90_ms),
            ],
        }
    }
}

impl BeatRow {
    fn at_rest(cell: &str) -> Self {
        let (cell, reason) = (cell.to_owned(), String::new());
        Self { cell, status: Status::Ok, reason, number: None, beat: None }
    }

    /// Returns one row per beat of a cell, or one row without a beat if it has none.
    fn of(cell: &str, beats: Vec<CellBeat>) -> Vec<Self> {
        if beats.is_empty() {
            return vec![Self::at_rest(cell)];
        }
        let numbered = (1..).zip(beats);
        let row =
            |(number, beat)| Self { number: Some(number), beat: Some(beat), ..Self::at_rest(cell) };
        numbered.map(row).collect()
    }
}

/// Returns, as text for [`Journal::open`], the settings on which the rows depend besides the cells.
pub fn settings(method: SolverSettings) -> String {
    let SolverSettings { method, step_ms, tolerance } = method;
    let version = env!("CARGO_PKG_VERSION");
    format!(
        "# The settings of the beats in this folder.\n# version {version}\nmethod = \"{method}\"\n\
         step_ms = {step_ms:?}\ntolerance = {tolerance:?}\n"
    )
}

/// Simulates every cell that the journal does not contain, many at a time.
///
/// # Errors
/// An invalid step or tolerance, and those of [`run`](super::run).
pub fn run(
    cells: &[PacedCell],
    method: SolverSettings,
    journal: &Journal<PacedCell>,
    threads: &Threads,
    observer: &impl StudyObserver<PacedCell>,
) -> Result<StudyReport<Vec<BeatRow>>, StudyError> {
    method.validate()?;
    let settings = BatchSettings { method, sample_interval_ms: None };
    // A few cells are distributed among all threads.
    let together = cells.len().div_ceil(threads.count()).clamp(1, GROUP);
    let together = NonZeroUsize::new(together).unwrap_or(NonZeroUsize::MIN);
    let interruption = observer.interruption();
    run_together(cells, journal, threads, observer, together, |group| {
        side_by_side(group, &settings, &|| !interruption.is_requested())
    })
}

/// Returns the rows of each cell of a group.
fn side_by_side(
    group: &[&PacedCell],
    settings: &BatchSettings,
    goes_on: &dyn Fn() -> bool,
) -> Vec<Result<Vec<BeatRow>, Cause>> {
    let task =
        |cell: &&PacedCell| Paced::new(Arc::clone(&cell.model), cell.protocol, cell.duration_ms);
    let tasks: Vec<Result<Paced, SolveError>> = group.iter().map(task).collect();
    let possible: Vec<Paced> = tasks.iter().flatten().cloned().collect();
    let mut outcomes = match batch::run_while(&possible, settings, goes_on) {
        Ok(Some(outcomes)) => outcomes.into_iter(),
        Ok(None) => return group.iter().map(|_| Err(Interrupted.into())).collect(),
        Err(error) => return group.iter().map(|_| Err(error.clone().into())).collect(),
    };
    let rows = |(cell, task): (&&PacedCell, Result<Paced, SolveError>)| {
        let outcome = task.map_or_else(|error| Some(Err(error)), |_| outcomes.next())?;
        Some(outcome.map(|outcome| BeatRow::of(&cell.name, outcome.beats)).map_err(Cause::from))
    };
    group.iter().zip(tasks).map_while(rows).collect()
}
