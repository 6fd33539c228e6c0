//! When the frames of a table were taken.

use super::column;
use super::error::ReadError;
use super::number::Cell;
use super::options::Options;
use super::sheet::{Row, Sheet};
use crate::units::{self, Dimension};

/// By how much times and a frame rate may differ.
const AGREE: f64 = 0.02;

/// Times between frames of cameras and detectors, ms: 4 to 2000 a second.
const FRAME_MS: [f64; 2] = [0.5, 250.0];

/// Intervals of times in s, that no times in ms have; those between may be either.
const FRAME_S: [f64; 2] = [0.0005, 0.05];

/// Where times come from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// A column of times, and what turns them into ms.
    Times { column: usize, to_ms: f64 },
    /// A column of frames, the first frame of the file, and ms a frame.
    Frames { column: usize, first: f64, ms: f64 },
    /// Each row is the next frame.
    Rows { ms: f64 },
}

impl Clock {
    /// Of a frame rate, for rows without times.
    pub(super) fn of_rate(options: &Options) -> Result<Option<f64>, String> {
        match options.frame_rate_per_s {
            None => Ok(None),
            Some(rate) if rate.is_finite() && rate > 0.0 && rate <= 1e6 => Ok(Some(1e3 / rate)),
            Some(rate) => Err(format!(
                "the frame rate is {rate} /s; it must be above 0 and at most 1000000 frames a second"
            )),
        }
    }

    /// Of a column of times; `frames` of one of frames. Says what it took for granted.
    pub(super) fn of_column(
        sheet: &Sheet,
        at: usize,
        frames: bool,
        options: &Options,
        notes: &mut Vec<String>,
    ) -> Result<Self, String> {
        let rate = Self::of_rate(options)?;
        let numbers = sheet.rows.iter().filter_map(|row| match sheet.cell(row, at) {
            Cell::Number(number) => Some(number),
            _ => None,
        });
        let numbers: Vec<f64> = numbers.collect();
        let name = sheet.name(at);
        if frames {
            let ms = rate.ok_or_else(|| {
                format!(
                    "column `{name}` has frames, and no column has times; give the frame rate \
                     (--frame-rate 250), in frames a second"
                )
            })?;
            return Ok(Self::Frames {
                column: at,
                first: numbers.first().copied().unwrap_or(0.0),
                ms,
            });
        }
        let step = step(&numbers);
        let to_ms = match unit(sheet, at, options) {
            Some(unit) => units::parse(&format!("1 {unit}"), Dimension::Time)
                .map_err(|_| format!("column `{name}` has `{unit}`, which is no unit of time"))?,
            None if options.units_required => {
                return Err(format!(
                    "the column `{name}` has no unit that is known; call it `time (ms)` or `time (s)`"
                ));
            }
            None => {
                let to_ms = match rate {
                    Some(ms) => {
                        let near = |factor: f64| (step * factor / ms - 1.0).abs() < AGREE;
                        [1.0, 1e3].into_iter().find(|factor| near(*factor))
                    }
                    None if (FRAME_S[0]..=FRAME_S[1]).contains(&step) => Some(1e3),
                    None if (FRAME_MS[0]..=FRAME_MS[1]).contains(&step) => Some(1.0),
                    None => None,
                };
                let to_ms = to_ms.ok_or_else(|| {
                    format!(
                        "column `{name}` has times {step} apart without a unit, which fits neither ms nor s{}; give \
                         the unit (--time-unit s)",
                        if rate.is_some() { " at this frame rate" } else { "" }
                    )
                })?;
                let (unit, other) = if to_ms == 1.0 { ("ms", "s") } else { ("s", "ms") };
                notes.push(format!(
                    "column `{name}` has no unit: taken as {unit}, {:.4} frames a second (--time-unit {other} if not)",
                    1e3 / (step * to_ms)
                ));
                to_ms
            }
        };
        if let Some(ms) = rate
            && numbers.len() > 1
            && (step * to_ms / ms - 1.0).abs() > AGREE
        {
            return Err(format!(
                "the times in column `{name}` are {:.4} frames a second, and the frame rate given is {:.4}; leave \
                 one of them out",
                1e3 / (step * to_ms),
                1e3 / ms
            ));
        }
        Ok(Self::Times { column: at, to_ms })
    }

    /// The column that it reads.
    pub(super) fn column(self) -> Option<usize> {
        match self {
            Self::Times { column, .. } | Self::Frames { column, .. } => Some(column),
            Self::Rows { .. } => None,
        }
    }

    /// The time of a row, ms, the `index`-th of its curve; `None` where its field is empty.
    pub(super) fn time(
        self,
        path: &str,
        sheet: &Sheet,
        row: &Row,
        index: usize,
    ) -> Result<Option<f64>, ReadError> {
        let (column, offset, factor) = match self {
            Self::Rows { ms } => return Ok(Some(index as f64 * ms)),
            Self::Times { column, to_ms } => (column, 0.0, to_ms),
            Self::Frames { column, first, ms } => (column, first, ms),
        };
        match sheet.cell(row, column) {
            Cell::Number(number) => Ok(Some((number - offset) * factor)),
            Cell::Missing => Ok(None),
            Cell::Text => Err(ReadError::Field {
                path: path.to_owned(),
                line: row.line,
                column: sheet.name(column),
                cause: format!("\"{}\" is no finite number", row.fields[column]),
            }),
        }
    }
}

/// The unit of a column of times.
fn unit(sheet: &Sheet, at: usize, options: &Options) -> Option<String> {
    if let Some(unit) = &options.time_unit {
        return Some(column::unit(unit).unwrap_or_else(|| unit.clone()));
    }
    let title = column::title(sheet.header.get(at).map_or("", String::as_str));
    Some(title.unit).filter(|unit| !unit.is_empty())
}

/// Median distance of neighbours.
fn step(numbers: &[f64]) -> f64 {
    let mut steps: Vec<f64> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}
