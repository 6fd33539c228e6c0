//! How the beat that represents a run spread over a tissue: a table and a figure.

use super::finished::Finished;
use crate::analysis::wave::WaveMap;
use crate::experiment::{ExperimentError, Folder, waves};
use crate::output::field::Fields;
use crate::output::figure::{DrawnCell, Figure, FigureError};
use crate::output::table::{Column, Table};
use crate::recording::{Wave, WaveTip};

const TIPS: &str = "tips.csv";

/// The wave of a finished run, and the map of the beat that represents it; `None` of a single cell.
fn of<'a>(finished: &'a Finished<'_>) -> Option<(&'a Wave, WaveMap)> {
    finished.outcome.recording.wave.as_ref().zip(finished.outcome.wave_map())
}

/// Writes the tables of a tissue, that of tips if waves have some; nothing of a single cell.
pub(super) fn write(folder: &Folder, finished: &Finished<'_>) -> Result<(), ExperimentError> {
    let Some((wave, map)) = of(finished) else { return Ok(()) };
    folder.write(waves::FILE, waves::table(wave, &map)?)?;
    if wave.tips.is_empty() {
        return Ok(());
    }
    let column =
        |(name, values): (&str, Vec<Option<f64>>)| Column::Number { name: name.to_owned(), values };
    let of = |number: fn(&WaveTip) -> f64| wave.tips.iter().map(|tip| Some(number(tip))).collect();
    let columns =
        [("t_ms", of(|tip| tip.t_ms)), ("x_um", of(|tip| tip.x_um)), ("y_um", of(|tip| tip.y_um))];
    let table = Table { columns: columns.map(column).into() };
    folder.write(TIPS, table.for_people().to_csv()?)
}

/// Draws when each place was activated, and for how long.
pub(super) fn draw(finished: &Finished<'_>) -> Result<Figure, FigureError> {
    let (wave, map) = of(finished).ok_or(FigureError::Nothing { what: "waves" })?;
    let simulation = finished.simulation;
    let fields = Fields::new(&simulation.mesh, &simulation.fibres, None)?;
    let cell = DrawnCell::new(fields, Some(finished.outline))?;
    waves::draw(&cell, wave, &map, "After the stimulus (ms)")
}
