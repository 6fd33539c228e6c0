//! A measured course of calcium, from a table.
//!
//! The table has a column of times and one of calcium, each with its unit: `time (ms)` or `t_ms`,
//! `calcium (uM)` or `Ca_nM`; other columns are ignored. Time starts at the stimulus. Instead of
//! calcium it may have a `ratio` of two fluorescences, with a calibration after `grynkiewicz_1985`:
//! ```text
//! Ca = K (R - R_min) / (R_max - R)
//! ```

use crate::analysis::holes::{self, Hole};
use crate::cell::CellModel;
use crate::cell::calcium::{CalciumTrace, TraceError};
use crate::measured::{self, Curve, Kind, ReadError, TableOptions};
use std::io;
use std::sync::Arc;

/// Endings of files with a course of calcium, without the dot.
pub const CALCIUM_ENDINGS: &[&str] = &["csv", "txt", "tsv"];

/// Jump of calcium at the next stimulus, as a part of its height, above which a warning is given.
const JUMP: f64 = 0.05;

/// The longest accepted gap in the times during the rise of calcium, ms; the rise takes about 40
/// ms.
const LONGEST_HOLE_MS: f64 = 10.0;

/// Calibration of a ratio of fluorescences.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Calibration {
    /// Dissociation constant of the dye times the ratio of its fluorescence without and with calcium at the second
    /// wavelength, uM.
    pub dissociation_um: Option<f64>,
    /// Ratio without calcium.
    pub ratio_min: Option<f64>,
    /// Ratio with the dye saturated.
    pub ratio_max: Option<f64>,
}

/// Why a table is not a course of calcium.
#[derive(Debug, thiserror::Error)]
pub enum CalciumError {
    /// The cell model computes calcium itself.
    #[error(
        "cell model `{model}` takes no calcium from a table; choose `land_2017`, or leave the table out"
    )]
    Model {
        /// The model.
        model: String,
    },
    /// The file could not be read, or a field is not a number or has an impossible value.
    #[error(transparent)]
    Read(ReadError),
    /// It is not a table of calcium.
    #[error(
        "`{path}`: {cause}; a table of calcium has a column of times and one of calcium or of a ratio, with their \
         units in the header, such as `time (ms),calcium (uM)`"
    )]
    Table {
        /// The file.
        path: String,
        /// What is wrong.
        cause: String,
    },
    /// The samples are not a valid course.
    #[error("`{path}`: {cause}")]
    Course {
        /// The file.
        path: String,
        /// Why.
        cause: TraceError,
    },
    /// Frames are missing where calcium rises.
    #[error(
        "`{path}`, line {line}, column `{column}`: there is no frame from {from_ms} to {to_ms} ms, although \
         frames usually come every {usual_ms} ms. Calcium rises or peaks in this gap, so its course is not known; give a recording \
         without this gap"
    )]
    Hole {
        /// The file.
        path: String,
        /// The line before the gap, from 1.
        line: u64,
        /// The column of calcium as its header calls it.
        column: String,
        /// Time before the gap, ms.
        from_ms: f64,
        /// Time after it, ms.
        to_ms: f64,
        /// The usual time between frames, ms.
        usual_ms: f64,
    },
    /// A ratio without calibration.
    #[error(
        "`{path}` has a ratio in the column `{column}`, and {missing} of its calibration is missing: give \
         calcium_dissociation (like \"0.8 uM\"), ratio_min and ratio_max in [cell], by \
         Ca = K (R - R_min) / (R_max - R)"
    )]
    Uncalibrated {
        /// The file.
        path: String,
        /// The column as its header calls it.
        column: String,
        /// What is missing.
        missing: &'static str,
    },
    /// Ratios in the wrong order.
    #[error("ratio_min = {min} must be below ratio_max = {max}")]
    Order {
        /// Ratio without calcium.
        min: f64,
        /// Ratio with the dye saturated.
        max: f64,
    },
}

/// The cell model with calcium from a table, and a warning if there is one; `read` reads a file by
/// its name as written.
pub(super) fn with_calcium(
    cell: &Arc<dyn CellModel>,
    path: &str,
    calibration: Calibration,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<(Arc<dyn CellModel>, Option<String>), CalciumError> {
    let unread = |cause| CalciumError::Read(ReadError::Read { path: path.to_owned(), cause });
    let bytes = read(path).map_err(unread)?;
    let (trace, mut remarks) = of_table(path, &bytes, calibration)?;
    let [rest, last, peak] = trace.ends();
    if (last - rest).abs() > JUMP * (peak - rest) {
        remarks.push(format!(
            "`{path}` ends at {last:.3} uM and rests at {rest:.3} uM: calcium stays at that level until the next stimulus and \
             then jumps; record until it has returned, or use a single beat"
        ));
    }
    let warning = (!remarks.is_empty()).then(|| remarks.join("; "));
    let driven = cell.with_calcium(&trace);
    Ok((driven.ok_or_else(|| CalciumError::Model { model: cell.name().to_owned() })?, warning))
}

/// The gaps in a course across which calcium is interpolated, in words.
fn holes(path: &str, curve: &Curve, calcium: &[f64]) -> Result<Vec<String>, CalciumError> {
    let top = (0..calcium.len()).max_by(|a, b| calcium[*a].total_cmp(&calcium[*b])).unwrap_or(0);
    let mut remarks = Vec::new();
    for hole in holes::of(&curve.times_ms) {
        let Hole { after_frame, from_ms, to_ms, usual_ms } = hole;
        // The highest frame may be the last before a gap that contains the peak.
        if after_frame <= top + 1 && hole.length_ms() > LONGEST_HOLE_MS {
            let (path, column) = (path.to_owned(), curve.name.clone());
            let line = curve.lines[after_frame - 1];
            return Err(CalciumError::Hole { path, line, column, from_ms, to_ms, usual_ms });
        }
        remarks.push(format!(
            "`{path}` has no frame from {from_ms} to {to_ms} ms; calcium is interpolated linearly there"
        ));
    }
    Ok(remarks)
}

fn of_table(
    path: &str,
    bytes: &[u8],
    calibration: Calibration,
) -> Result<(CalciumTrace, Vec<String>), CalciumError> {
    let table = |cause: String| CalciumError::Table { path: path.to_owned(), cause };
    let options = TableOptions { units_required: true, ..TableOptions::default() };
    let read = measured::read_bytes(path, bytes, &options).map_err(|error| match error {
        error @ ReadError::Field { .. } => CalciumError::Read(error),
        ReadError::Table { cause, .. } => table(cause),
        other => table(other.to_string()),
    })?;
    let find = |kind| read.curves.iter().find(|curve| curve.kind == kind);
    let Some(curve) = find(Kind::Calcium).or_else(|| find(Kind::CalciumRatio)) else {
        let names: Vec<String> =
            read.curves.iter().map(|curve| format!("`{}`", curve.name)).collect();
        let names = names.join(", ");
        return Err(table(match find(Kind::Fluorescence) {
            Some(bright) => format!(
                "the column `{}` has no known unit; name it `calcium (uM)` or `calcium (nM)`",
                bright.name
            ),
            None => format!("it has no column of calcium or of a ratio, only of {names}"),
        }));
    };
    let of_kind: Vec<String> = read
        .curves
        .iter()
        .filter(|other| other.kind == curve.kind)
        .map(|curve| format!("`{}`", curve.name))
        .collect();
    let mut remarks = Vec::new();
    if of_kind.len() > 1 {
        remarks.push(format!(
            "`{path}` has several columns of calcium, {}; the first was taken: remove the others if that is wrong",
            of_kind.join(", ")
        ));
    }
    let calcium = calibrated(path, curve, calibration)?;
    let field = |sample: usize, cause: String| {
        let (path, line, column) = (path.to_owned(), curve.lines[sample], curve.name.clone());
        CalciumError::Read(ReadError::Field { path, line, column, cause })
    };
    let values = curve.values.iter().enumerate();
    let values =
        values.map(|(sample, &value)| calcium(value).map_err(|cause| field(sample, cause)));
    let values = values.collect::<Result<Vec<f64>, _>>()?;
    let trace =
        CalciumTrace::new(&curve.times_ms, &values).map_err(|cause| match cause.sample() {
            Some(sample) => field(sample, cause.to_string()),
            None => CalciumError::Course { path: path.to_owned(), cause },
        })?;
    remarks.extend(holes(path, curve, &values)?);
    Ok((trace, remarks))
}

/// Converts a number to calcium, uM, or returns why it cannot.
type ToCalcium = Box<dyn Fn(f64) -> Result<f64, String>>;

/// The conversion of a column's numbers to calcium.
fn calibrated(
    path: &str,
    curve: &Curve,
    calibration: Calibration,
) -> Result<ToCalcium, CalciumError> {
    if curve.kind != Kind::CalciumRatio {
        return Ok(Box::new(Ok));
    }
    let needed = |value: Option<f64>, missing: &'static str| {
        let (path, column) = (path.to_owned(), curve.name.clone());
        value.ok_or(CalciumError::Uncalibrated { path, column, missing })
    };
    let k = needed(calibration.dissociation_um, "calcium_dissociation")?;
    let min = needed(calibration.ratio_min, "ratio_min")?;
    let max = needed(calibration.ratio_max, "ratio_max")?;
    if min >= max {
        return Err(CalciumError::Order { min, max });
    }
    Ok(Box::new(move |ratio| {
        if !(min..max).contains(&ratio) {
            return Err(format!(
                "the ratio {ratio} lies outside the calibration, from ratio_min = {min} to below ratio_max = {max}"
            ));
        }
        // Ca = K (R - R_min) / (R_max - R)
        Ok(k * (ratio - min) / (max - ratio))
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;

    fn read(text: &str, calibration: Calibration) -> Result<CalciumTrace, CalciumError> {
        of_table("trace.csv", text.as_bytes(), calibration).map(|(trace, _)| trace)
    }

    const NONE: Calibration =
        Calibration { dissociation_um: None, ratio_min: None, ratio_max: None };

    #[test]
    fn the_same_course_is_read_in_any_unit_and_form_of_header() {
        let course = CalciumTrace::new(&[0.0, 50.0, 400.0], &[0.07, 0.5, 0.08]).unwrap();
        for text in [
            "time (ms),calcium (uM)\n0,0.07\n50,0.5\n400,0.08\n",
            "# cell 3\nt_s,Ca_nM\n0,70\n0.05,500\n0.4,80\n",
            "\u{feff}Time [s];note;[Ca2+]i [nM]\n0;rest;70\n0,05;;500\n0,4;;80\n",
            "Ca_i_uM\ttime_ms\n0.07\t0\n0.5\t50\n0.08\t400\n",
        ] {
            let found = read(text, NONE).unwrap_or_else(|error| panic!("{text}: {error}"));
            for at in [0.0, 20.0, 50.0, 300.0, 900.0] {
                assert!((found.at(at) - course.at(at)).abs() < 1e-12, "{text}: {at} ms");
            }
        }
    }

    #[test]
    fn a_ratio_becomes_calcium_by_its_calibration() {
        let text = "time (ms),ratio\n0,0.8\n50,2.0\n400,0.9\n";
        let whole =
            Calibration { dissociation_um: Some(0.8), ratio_min: Some(0.4), ratio_max: Some(6.0) };
        let trace = read(text, whole).unwrap();
        // 0.8 uM (2.0 - 0.4) / (6 - 2)
        assert!((trace.at(50.0) - 0.32).abs() < 1e-12);
        for (calibration, part) in [
            (NONE, "column `ratio`, and calcium_dissociation of its calibration is missing"),
            (Calibration { ratio_max: None, ..whole }, "ratio_max of its calibration is missing"),
            (Calibration { ratio_max: Some(0.4), ..whole }, "ratio_min = 0.4 must be below"),
            (
                Calibration { ratio_max: Some(1.5), ..whole },
                "line 3, column `ratio`: the ratio 2 lies",
            ),
        ] {
            let error = read(text, calibration).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }

    #[test]
    fn a_table_that_is_no_course_is_refused_with_file_line_column_and_value() {
        for (text, part) in [
            ("", "`trace.csv`: it has no line with numbers"),
            ("time (ms),force\n0,1\n", "no column of calcium or of a ratio, only of `force`"),
            (
                "time,calcium (uM)\n0,1\n",
                "the column `time` has no known unit; name it `time (ms)`",
            ),
            (
                "time (ms),calcium (mV)\n0,1\n",
                "column `calcium`: `1 mV` is a potential, but a concentration is needed",
            ),
            (
                "time (ms),calcium (uM)\n0,0.1\n10,much\n",
                "`trace.csv`, line 3, column `calcium (uM)`: \"much\" is not a finite number",
            ),
            (
                "time (ms),calcium (uM)\n0,0.1\n10,0.2\n10,0.2\n",
                "line 4, column `time (ms)`: time 10 ms does not come after 10 ms",
            ),
            (
                "time (ms),calcium (uM)\n0,70\n10,500\n20,80\n",
                "line 3, column `calcium (uM)`: calcium is 500 uM; it must be between 0 and 100 uM",
            ),
            ("time (ms),calcium (uM)\n0,0.1\n", "0 samples after the stimulus"),
        ] {
            let error = read(text, NONE).unwrap_err().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
    }

    /// A course of 400 ms that rises from 10 ms on, peaks at 60 ms, and has no frames in some times.
    fn with_a_hole(from_ms: u32, to_ms: u32) -> String {
        let value = |t: u32| match t {
            0..10 => 0.08,
            10..60 => 0.08 + 0.01 * f64::from(t - 10),
            _ => 0.08 + 0.5 * (-f64::from(t - 60) / 80.0).exp(),
        };
        let times = (0..400).step_by(2).filter(|t| !(from_ms + 1..to_ms).contains(t));
        times.fold("time (ms),calcium (uM)\n".to_owned(), |text, t| {
            text + &format!("{t},{}\n", value(t))
        })
    }

    #[test]
    fn calcium_with_a_hole_across_its_rise_is_refused_and_one_behind_it_is_said() {
        for (from, to) in [(6, 246), (30, 50), (40, 80), (60, 90)] {
            let error = read(&with_a_hole(from, to), NONE).unwrap_err().to_string();
            let line = from / 2 + 2;
            assert!(error.contains(&format!("line {line}, column `calcium (uM)`")), "{error}");
            assert!(
                error.contains(&format!("there is no frame from {from} to {to} ms")),
                "{error}"
            );
        }
        for (from, to, said) in [(100, 160, 1), (30, 34, 0), (30, 38, 1), (0, 2, 0)] {
            let text = with_a_hole(from, to);
            let (_, remarks) = of_table("a.csv", text.as_bytes(), NONE).unwrap();
            assert_eq!(remarks.len(), said, "{from} to {to} ms: {remarks:?}");
        }
        // Points that were read off a figure.
        let text = "time (ms),calcium (uM)\n0,0.1\n5,0.2\n10,0.5\n20,0.8\n50,0.6\n100,0.4\n200,0.2\n500,0.1\n";
        assert_eq!(of_table("a.csv", text.as_bytes(), NONE).unwrap().1.len(), 0);
    }

    #[test]
    fn only_a_cell_whose_calcium_is_given_takes_it_and_a_jump_is_told() {
        let text = "time (ms),calcium (uM)\n0,0.07\n50,0.5\n400,0.2\n";
        let read = |_: &str| Ok(text.as_bytes().to_vec());
        let cell = |name| cell::model(name).unwrap();
        let (land, warning) = with_calcium(&cell("land_2017"), "a.csv", NONE, read).unwrap();
        assert!(warning.unwrap().contains("ends at 0.200 uM and rests at 0.070 uM"));
        let outputs = land.outputs().iter().map(|output| &*output.name);
        assert_eq!(outputs.collect::<Vec<_>>(), ["Ca_i"]);
        let error = with_calcium(&cell("coelho_2021"), "a.csv", NONE, read).err().unwrap();
        assert!(error.to_string().contains("`coelho_2021` takes no calcium"), "{error}");
    }
}
