//! `track.csv`: a tracked cell, one row per frame of the film.

use crate::csv::{CsvError, number};

/// A cell in one frame of a film.
#[derive(Debug, Clone, Copy, PartialEq, Default, serde::Serialize)]
pub struct TrackRow {
    /// Number of the frame in the film, from 0.
    pub frame: usize,
    /// Time from the first frame of the film, ms.
    pub t_ms: f64,
    /// Length along the long axis after rigid rotation is removed, um: at rest the distance between
    /// its ends, scaled by the distance between the means of both ends.
    pub length_um: f64,
    /// Shortening against the frame at rest, per cent of its length.
    pub shortening_pct: f64,
    /// Width across the long axis, um: at rest the largest extent, scaled by the distance between
    /// the means of both sides.
    pub width_um: f64,
    /// Projected area of the lattice, um^2.
    pub area_um2: f64,
    /// Smaller principal stretch of the whole cell.
    pub stretch_1: f64,
    /// Larger principal stretch of the whole cell.
    pub stretch_2: f64,
    /// Mean length of the sarcomeres, um, if the picture shows stripes.
    pub sarcomere_um: Option<f64>,
    /// Part of the points that were interpolated from their neighbours, per cent.
    pub interpolated_pct: f64,
    /// Median zero-normalised correlation of the points that were found.
    pub correlation: Option<f64>,
    /// Motion of the stage that was subtracted, um, x to the right and y upward.
    pub stage_um: [f64; 2],
}

/// Columns of `track.csv` in their order.
const COLUMNS: [&str; 13] = [
    "frame",
    "t_ms",
    "length_um",
    "shortening_pct",
    "width_um",
    "area_um2",
    "stretch_1",
    "stretch_2",
    "sarcomere_um",
    "interpolated_pct",
    "correlation",
    "stage_x_um",
    "stage_y_um",
];

/// The rows as the text of `track.csv`; unknown values are empty.
///
/// # Errors
/// A row that cannot be written.
///
/// # Example
/// ```
/// use myospring::output::track::{TrackRow, to_csv};
/// let row = TrackRow { t_ms: 20.0, length_um: 101.5, ..TrackRow::default() };
/// let table = to_csv(&[row])?;
/// assert!(table.starts_with("frame,t_ms,length_um,shortening_pct,width_um,area_um2,stretch_1,stretch_2,sarcomere_um"));
/// assert!(table.ends_with("\n0,20,101.5,0,0,0,0,0,,0,,0,0\n"));
/// # Ok::<(), myospring::output::csv::CsvError>(())
/// ```
pub fn to_csv(rows: &[TrackRow]) -> Result<String, CsvError> {
    let mut writer = ::csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS).map_err(|source| CsvError::Row { row: 0, source })?;
    for (at, row) in rows.iter().enumerate() {
        let [stage_x, stage_y] = row.stage_um;
        let values = [
            Some(row.t_ms),
            Some(row.length_um),
            Some(row.shortening_pct),
            Some(row.width_um),
            Some(row.area_um2),
            Some(row.stretch_1),
            Some(row.stretch_2),
            row.sarcomere_um,
            Some(row.interpolated_pct),
            row.correlation,
            Some(stage_x),
            Some(stage_y),
        ];
        let values = values.map(|value| value.map_or_else(String::new, number));
        writer
            .write_record([row.frame.to_string()].into_iter().chain(values))
            .map_err(|source| CsvError::Row { row: at, source })?;
    }
    let failed = |source| CsvError::Row { row: rows.len(), source };
    let bytes = writer.into_inner().map_err(|error| failed(error.into_error().into()))?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}
