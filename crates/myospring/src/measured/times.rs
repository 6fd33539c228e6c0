//! Determines the times of the rows of a table.

use super::column;
use super::error::ReadError;
use super::number::Cell;
use super::options::TableOptions;
use super::sheet::{Row, Sheet};
use crate::analysis::curve;
use crate::analysis::kind::{Family, Kind};
use crate::units::{self, Dimension};

/// Latest time that is accepted, ms: 30 000 years, more than any clock shows.
const LONGEST_MS: f64 = 1e15;

/// Largest relative difference between the frame rate of the times and the given one.
const AGREE: f64 = 0.02;

/// Frame rates of cameras and other optical detectors, in frames per second.
const CAMERA: [f64; 2] = [4.0, 2000.0];

/// Sampling rates of other instruments, in samples per second: amplifiers of patch clamps reach 50
/// kHz.
const AMPLIFIER: [f64; 2] = [4.0, 60_000.0];

/// Shortest recording, ms.
const SHORTEST_MS: f64 = 25.0;

/// Smallest number of frames in which a beat can be found.
const ENOUGH: usize = 8;

/// Range of the duration of beats at half of their height, for length, force or calcium, ms: from
/// mice at body temperature to cells in the cold.
const WIDTHS_MS: [f64; 2] = [40.0, 2000.0];

/// Units of clocks that count ticks, with their length in ms. No camera has such large whole
/// numbers as times in ms.
const TICKS: [(&str, f64); 2] = [("us", 0.001), ("0.01 ms", 0.01)];

/// Source of times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Clock {
    /// A column of times, and the factor that converts them to ms.
    Times { column: usize, to_ms: f64 },
    /// A column of frame numbers, the first frame number of the file, and the interval in ms.
    Frames { column: usize, first: f64, ms: f64 },
    /// Each row is the next frame, with this interval in ms.
    Rows { ms: f64 },
}

/// A column of times or frames, with what is known of the values of its curves.
pub(super) struct Timed<'a> {
    pub(super) at: usize,
    /// Whether it contains frame numbers.
    pub(super) frames: bool,
    /// Kinds of its curves, as far as they are stated.
    pub(super) kinds: &'a [Kind],
    /// Values of the first curve, one for each row with a time.
    pub(super) values: &'a [f64],
}

impl Clock {
    /// Returns the interval in ms of the given frame rate, for rows without times.
    pub(super) fn of_rate(options: &TableOptions) -> Result<Option<f64>, String> {
        match options.frame_rate_per_s {
            None => Ok(None),
            Some(rate) if rate.is_finite() && rate > 0.0 && rate <= 1e6 => Ok(Some(1e3 / rate)),
            Some(rate) => Err(format!(
                "the frame rate is {rate} /s; it must be above 0 and at most 1000000 frames a second"
            )),
        }
    }

    /// Returns the clock of a column of times or frames, and a note of what was assumed.
    pub(super) fn of_column(
        sheet: &Sheet,
        timed: &Timed<'_>,
        options: &TableOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, String> {
        let at = timed.at;
        let rate = Self::of_rate(options)?;
        let numbers = sheet.rows.iter().filter_map(|row| match sheet.cell(row, at) {
            Cell::Number(number) => Some(number),
            _ => None,
        });
        let numbers: Vec<f64> = numbers.collect();
        let name = sheet.name(at);
        if timed.frames {
            let ms = rate.ok_or_else(|| {
                if sheet.turned.is_empty() {
                    format!(
                        "column `{name}` has frames, and no column has times; give the frame rate \
                         (--frame-rate 250), in frames a second"
                    )
                } else {
                    "its rows are curves, without times; give the frame rate (--frame-rate 30), in frames a second"
                        .to_owned()
                }
            })?;
            return Ok(Self::Frames {
                column: at,
                first: numbers.first().copied().unwrap_or(0.0),
                ms,
            });
        }
        let step = step(&numbers);
        let to_ms = match unit(sheet, at, options)? {
            Some(unit) => time_of(&unit).ok_or_else(|| {
                format!("column `{name}` has `{unit}`, which is not a unit of time")
            })?,
            None if options.units_required => {
                return Err(format!(
                    "the column `{name}` has no known unit; name it `time (ms)` or `time (s)`"
                ));
            }
            None => {
                let (unit, to_ms) = found(&numbers, step, rate, timed).map_err(|cause| {
                    format!("column `{name}` has times {step} apart without a unit: {cause}")
                })?;
                let note = format!(
                    "column `{name}` has no unit: read as {unit}, {:.4} frames a second (change it by --time-unit)",
                    1e3 / (step * to_ms)
                );
                if !notes.contains(&note) {
                    notes.push(note);
                }
                to_ms
            }
        };
        if let Some(ms) = rate
            && numbers.len() > 1
            && (step * to_ms / ms - 1.0).abs() > AGREE
        {
            return Err(format!(
                "the times in column `{name}` are {:.4} frames a second, but the given frame rate is {:.4}; leave \
                 one of them out",
                1e3 / (step * to_ms),
                1e3 / ms
            ));
        }
        Ok(Self::Times { column: at, to_ms })
    }

    /// Returns the same clock for another column of times.
    pub(super) fn of_other(self, column: usize) -> Self {
        match self {
            Self::Times { to_ms, .. } => Self::Times { column, to_ms },
            other => other,
        }
    }

    /// Returns the column that it reads, if any.
    pub(super) fn column(self) -> Option<usize> {
        match self {
            Self::Times { column, .. } | Self::Frames { column, .. } => Some(column),
            Self::Rows { .. } => None,
        }
    }

    /// Returns the time of a row, the `index`-th of its curve, in ms; `None` if its field is empty.
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
        let wrong = |cause| {
            let (line, column) = sheet.place(row, column);
            Err(ReadError::Field { path: path.to_owned(), line, column, cause })
        };
        match sheet.cell(row, column) {
            Cell::Number(number) => match (number - offset) * factor {
                ms if ms.abs() <= LONGEST_MS => Ok(Some(ms)),
                ms => wrong(format!(
                    "time {ms:e} ms is later than any clock shows (at most {LONGEST_MS:e} ms); is the unit of time right?"
                )),
            },
            Cell::Missing => Ok(None),
            Cell::Text => wrong(format!("\"{}\" is not a finite number", row.fields[column])),
        }
    }
}

/// Returns the unit of times without a stated unit, and the factor that converts them to ms; or a
/// message with the possible units and the option that states one.
fn found(
    numbers: &[f64],
    step: f64,
    rate: Option<f64>,
    timed: &Timed<'_>,
) -> Result<(&'static str, f64), String> {
    const UNITS: [(&str, f64); 2] = [("s", 1e3), ("ms", 1.0)];
    if let Some(ms) = rate {
        let near = |(_, factor): &(&str, f64)| (step * factor / ms - 1.0).abs() < AGREE;
        let all = UNITS.into_iter().chain(TICKS);
        return all.into_iter().find(near).ok_or_else(|| {
            "no unit fits this frame rate; give the unit (--time-unit s)".to_owned()
        });
    }
    let by_eye = |kind: &Kind| {
        !matches!(kind.family(), Family::ActionPotential | Family::Tension)
            && *kind != Kind::Unknown
    };
    let range =
        if !timed.kinds.is_empty() && timed.kinds.iter().all(by_eye) { CAMERA } else { AMPLIFIER };
    let rate_of = |factor: f64| 1e3 / (step * factor);
    let has_rate =
        |(_, factor): &(&'static str, f64)| (range[0]..=range[1]).contains(&rate_of(*factor));
    let mut may: Vec<(&'static str, f64)> = UNITS.into_iter().filter(has_rate).collect();
    if may.len() > 1 && numbers.len() >= ENOUGH {
        let long = |(_, factor): &(&'static str, f64)| {
            let last = numbers.last().copied().unwrap_or(0.0);
            (last - numbers[0]) * factor >= SHORTEST_MS
        };
        may.retain(long);
    }
    let whole = step >= 1.0 && numbers.iter().all(|number| number.fract() == 0.0);
    if may.is_empty() && whole {
        may = TICKS.into_iter().filter(has_rate).collect();
        // The duration of beats decides: with times ten times longer or shorter, few curves still
        // have beats of a cell.
        if may.len() > 1 {
            let beats: Vec<(&'static str, f64)> = may
                .iter()
                .copied()
                .filter(|(_, factor)| beats(numbers, timed.values, *factor))
                .collect();
            if beats.len() == 1 {
                may = beats;
            }
        }
    }
    match may[..] {
        [one] => Ok(one),
        [] => Err("neither s nor ms fits; give the unit (--time-unit s, ms, us or \"0.01 ms\")"
            .to_owned()),
        _ => {
            let candidates: Vec<String> = may
                .iter()
                .map(|(unit, factor)| {
                    format!("{} frames a second if they are {unit}", rounded(rate_of(*factor)))
                })
                .collect();
            let options: Vec<String> = may
                .iter()
                .map(|(unit, _)| {
                    let quote = if unit.contains(' ') { "\"" } else { "" };
                    format!("--time-unit {quote}{unit}{quote}")
                })
                .collect();
            Err(format!("{}; say which: {}", candidates.join(", "), options.join(" or ")))
        }
    }
}

/// Whether the curve has beats at this time scale that are as long as those of cells.
fn beats(numbers: &[f64], values: &[f64], to_ms: f64) -> bool {
    let count = numbers.len().min(values.len());
    let times: Vec<f64> = numbers[..count].iter().map(|number| number * to_ms).collect();
    let found = curve::analyse(
        &times,
        &values[..count],
        Kind::Unknown,
        "a.u.",
        &curve::CurveOptions::default(),
    );
    let width = found.ok().and_then(|analysis| analysis.mean("contraction_duration_50"));
    width.is_some_and(|width| (WIDTHS_MS[0]..=WIDTHS_MS[1]).contains(&width))
}

fn rounded(rate: f64) -> f64 {
    if rate >= 100.0 { rate.round() } else { (100.0 * rate).round() / 100.0 }
}

/// Returns a unit of time (`s`), or a multiple of one (`0.01 ms`), in ms.
fn time_of(unit: &str) -> Option<f64> {
    let text = if unit.starts_with(|letter: char| letter.is_ascii_digit() || letter == '.') {
        unit.to_owned()
    } else {
        format!("1 {unit}")
    };
    units::parse(&text, Dimension::Time).ok().filter(|ms| *ms > 0.0)
}

/// Returns the unit of a column of times, stated by its name or by an option; the two must agree.
fn unit(sheet: &Sheet, at: usize, options: &TableOptions) -> Result<Option<String>, String> {
    let title = column::title(sheet.header.get(at).map_or("", String::as_str));
    let named = Some(title.unit).filter(|unit| !unit.is_empty());
    let given =
        options.time_unit.as_ref().map(|unit| column::unit(unit).unwrap_or_else(|| unit.clone()));
    if let (Some(named), Some(given)) = (&named, &given)
        && let Some(own) = time_of(named)
        && time_of(given) != Some(own)
    {
        return Err(format!(
            "column `{}` says that its times are in {named}, and --time-unit says {given}; leave --time-unit out, or \
             correct the header",
            sheet.name(at)
        ));
    }
    Ok(given.or(named))
}

/// Returns the median interval.
fn step(numbers: &[f64]) -> f64 {
    let mut steps: Vec<f64> = numbers.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.sort_by(f64::total_cmp);
    steps.get(steps.len() / 2).copied().unwrap_or(0.0)
}
