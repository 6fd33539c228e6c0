//! A prescribed active tension, from a table.
//!
//! The table has a column of times and one of tension, each with its unit: `time (ms)` or `t_ms`,
//! `tension (kPa)` or `ta_kPa`, so that the curves of a run can be taken as they are; or tension
//! over Young's modulus, `tension_over_stiffness`, which the run multiplies by its own. Other
//! columns are ignored.

use crate::cell::CellModel;
use crate::cell::calcium::TraceError;
use crate::cell::given_tension::{TensionClock, TensionCourse};
use crate::measured::{self, Curve, Kind, ReadError, TableOptions};
use std::io;
use std::sync::Arc;

/// Endings of files with a course of tension, without the dot.
pub const TENSION_ENDINGS: &[&str] = &["csv", "txt", "tsv"];

/// Part of a column's name by which it is tension over Young's modulus.
const OVER_STIFFNESS: &str = "over stiffness";

/// Jump of the tension at the next stimulus, as a part of its peak, above which a warning is given.
const JUMP: f64 = 0.05;

/// Why a table is not a course of tension.
#[derive(Debug, thiserror::Error)]
pub enum TensionError {
    /// The cell model computes its tension.
    #[error(
        "cell model `{model}` takes no tension from a table; choose `given_tension`, or leave the table out"
    )]
    Model {
        /// The model.
        model: String,
    },
    /// The file could not be read.
    #[error("cannot read `{path}`: {cause}")]
    Read {
        /// The file.
        path: String,
        /// What the system says.
        cause: io::Error,
    },
    /// It is not a table of tension.
    #[error(
        "`{path}`: {cause}; a table of tension has a column of times and one of tension, with their units in the \
         header, such as `time (ms),tension (kPa)` or `time (ms),tension_over_stiffness`"
    )]
    Table {
        /// The file.
        path: String,
        /// What is wrong.
        cause: String,
    },
    /// A field that is not a number, or an impossible value.
    #[error("`{path}`, line {line}, column `{column}`: {cause}")]
    Field {
        /// The file.
        path: String,
        /// Its line, from 1.
        line: u64,
        /// The column as its header calls it.
        column: String,
        /// What is wrong, with the value.
        cause: String,
    },
}

/// The cell model with the tension of a table, and a warning if there is one; `modulus` is Young's
/// modulus of the run, kPa; `read` reads a file by its name as written.
pub(super) fn with_tension(
    cell: &Arc<dyn CellModel>,
    path: &str,
    clock: TensionClock,
    modulus: f64,
    read: impl Fn(&str) -> io::Result<Vec<u8>>,
) -> Result<(Arc<dyn CellModel>, Option<String>), TensionError> {
    let bytes = read(path).map_err(|cause| TensionError::Read { path: path.to_owned(), cause })?;
    let (course, mut remarks) = of_table(path, &bytes, modulus)?;
    let [start, end] = course.ends();
    if clock == TensionClock::Stimulus && (end - start).abs() > JUMP * course.peak() {
        remarks.push(format!(
            "`{path}` begins at {start:.3} kPa and ends at {end:.3} kPa: the tension stays there until the next stimulus and \
             then jumps; take one beat from rest to rest"
        ));
    }
    let warning = (!remarks.is_empty()).then(|| remarks.join("; "));
    let model = cell
        .with_tension(&course, clock)
        .ok_or_else(|| TensionError::Model { model: cell.name().to_owned() })?;
    Ok((model, warning))
}

fn is_over_stiffness(curve: &Curve) -> bool {
    curve.name.to_lowercase().replace('_', " ").contains(OVER_STIFFNESS)
}

fn of_table(
    path: &str,
    bytes: &[u8],
    modulus: f64,
) -> Result<(TensionCourse, Vec<String>), TensionError> {
    let table = |cause: String| TensionError::Table { path: path.to_owned(), cause };
    let options = TableOptions { units_required: true, ..TableOptions::default() };
    let read = measured::read_bytes(path, bytes, &options).map_err(|error| match error {
        ReadError::Field { path, line, column, cause } => {
            TensionError::Field { path, line, column, cause }
        }
        ReadError::Table { cause, .. } => table(cause),
        other => table(other.to_string()),
    })?;
    let tensions: Vec<&Curve> =
        read.curves.iter().filter(|curve| curve.kind == Kind::Tension).collect();
    let serves = |curve: &&&Curve| curve.unit == "kPa" || is_over_stiffness(curve);
    let Some(curve) = tensions.iter().find(serves) else {
        let Some(other) = tensions.first() else {
            let names = read.curves.iter().map(|curve| format!("`{}`", curve.name));
            let names: Vec<String> = names.collect();
            return Err(table(format!(
                "it has no column of tension, only of {}",
                names.join(", ")
            )));
        };
        return Err(table(format!(
            "the column `{}` has no known unit; name it `tension (kPa)` or `tension_over_stiffness`",
            other.name
        )));
    };
    let mut remarks = Vec::new();
    if tensions.len() > 1 {
        let names: Vec<String> = tensions.iter().map(|curve| format!("`{}`", curve.name)).collect();
        remarks.push(format!(
            "`{path}` has several columns of tension, {}; `{}` was taken: remove the others if that is wrong",
            names.join(", "),
            curve.name
        ));
    }
    let by = if is_over_stiffness(curve) { modulus } else { 1.0 };
    let tensions: Vec<f64> = curve.values.iter().map(|value| by * value).collect();
    let below: Vec<f64> = tensions.iter().copied().filter(|tension| *tension < 0.0).collect();
    if tensions.iter().all(|tension| *tension <= 0.0) {
        let cause = format!(
            "no value of the column `{}` is above 0; a tension that shortens the cell is positive",
            curve.name
        );
        return Err(table(cause));
    }
    if !below.is_empty() {
        let lowest = below.iter().copied().fold(0.0, f64::min);
        remarks.push(format!(
            "{} of {} rows of `{path}` are below 0, the lowest {lowest:.3} kPa: a cell cannot push, so they count as 0",
            below.len(),
            tensions.len()
        ));
    }
    let tensions: Vec<f64> = tensions.into_iter().map(|tension| tension.max(0.0)).collect();
    let course = TensionCourse::new(&curve.times_ms, &tensions).map_err(|cause| match cause {
        TraceError::Time { sample, .. } | TraceError::Value { sample, .. } => TensionError::Field {
            path: path.to_owned(),
            line: curve.lines[sample],
            column: curve.name.clone(),
            cause: cause.to_string(),
        },
        cause => table(cause.to_string()),
    })?;
    Ok((course, remarks))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cell;

    fn read(text: &str) -> Result<(Arc<dyn CellModel>, Option<String>), TensionError> {
        let model = cell::model("given_tension").unwrap();
        let read = |_: &str| Ok(text.as_bytes().to_vec());
        with_tension(&model, "t.csv", TensionClock::Stimulus, 200.0, read)
    }

    #[test]
    fn a_tension_is_read_in_any_unit_over_stiffness_and_from_the_curves_of_a_run() {
        for text in [
            "time (ms),tension (kPa)\n0,0\n100,20\n400,0\n",
            "t_s,stress (mN/mm2)\n0,0\n0.1,20\n0.4,0\n",
            "t_ms,tension_over_stiffness\n0,0\n100,0.1\n400,0\n",
            "t_ms,length_um,ta_kPa\n0,120,0\n100,110,20\n400,120,0\n",
        ] {
            let (model, told) = read(text).unwrap_or_else(|error| panic!("{text}: {error}"));
            let peak = model.given_peak().unwrap();
            assert!((peak - 20.0).abs() < 1e-12 && told.is_none(), "{text}: {peak}, {told:?}");
        }
    }

    #[test]
    fn a_table_that_is_no_tension_is_refused_and_what_is_odd_is_said() {
        for (text, part) in [
            ("t_ms,force_nN\n0,0\n1,1\n2,0\n", "no column of tension, only of `force_nN`"),
            ("t_ms,tension\n0,0\n1,1\n2,0\n", "the column `tension` has no known unit"),
            ("t_ms,tension_kPa\n0,0\n1,-1\n2,-2\n", "is above 0"),
            ("t_ms,tension_kPa\n0,0\n1,900\n2,0\n", "line 3, column `tension_kPa`: tension is 900"),
            ("t_ms,tension_kPa\n0,0\n5,1\n5,0\n", "line 4, column"),
        ] {
            let error = read(text).err().unwrap().to_string();
            assert!(error.contains(part), "{text}: {error}");
        }
        for (text, part) in [
            ("t_ms,tension_kPa\n0,0\n1,9\n2,-0.1\n", "1 of 3 rows of `t.csv` are below 0"),
            ("t_ms,tension_kPa\n0,0\n1,9\n2,5\n", "then jumps"),
            ("t_ms,a_tension_kPa,b_tension_kPa\n0,0,0\n1,9,1\n2,0,0\n", "several columns"),
        ] {
            let told = read(text).unwrap().1.unwrap();
            assert!(told.contains(part), "{text}: {told}");
        }
        let other = cell::model("coelho_2021").unwrap();
        let text = |_: &str| Ok(b"t_ms,tension_kPa\n0,0\n1,9\n2,0\n".to_vec());
        let error = with_tension(&other, "t.csv", TensionClock::Run, 1.0, text).err().unwrap();
        assert!(error.to_string().contains("`coelho_2021` takes no tension"), "{error}");
    }
}
