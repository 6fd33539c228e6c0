//! Measured curves: reads tables of laboratory programs into times and values with a kind and a
//! unit.
//!
//! Reads text in any encoding and all sheets of workbooks (.xlsx). Delimiter, decimal mark, header,
//! lines above it, encoding and line ends are detected; a column is recognised by its name and
//! unit, or chosen by name or number. Each row may be a frame, with one curve per column; or a
//! curve, with one frame or time per column, as `SarcGraph` and `BeatProfiler` write them; or
//! curves may follow one another, identified by a column such as `sarc_id`. [`Table::notes`] lists
//! what was assumed.
//!
//! | kind of curve | unit of its values | columns, for example |
//! |---|---|---|
//! | length, sarcomere length | um; px without a pixel size | `length_um`, `Length (µm)`, `Sarc Length [um]` |
//! | normalised length | 1, of a length of reference | `stretch_1`, `lambda1`, `L/L0`, `length (%)` |
//! | shortening | % of the length at rest | `shortening_pct`, `Fractional shortening` |
//! | contraction | um, px, % or a.u., as it was | `contraction`, `displacement (um)` |
//! | force; tension | nN; kPa; a.u. without a unit | `force_nN`; `stress (mN/mm2)` |
//! | calcium; ratio; fluorescence | uM; 1; a.u. | `Ca_nM`; `ratio`; `F/F0` |
//! | membrane potential | mV; a.u. without a unit | `Vm (mV)` |

mod column;
mod curve;
mod decode;
mod error;
mod number;
mod options;
mod pick;
mod sheet;
#[cfg(test)]
mod tests;
mod times;
mod workbook;

pub use crate::analysis::kind::Kind;
pub use curve::{Curve, Table};
pub use decode::decoded;
pub use error::ReadError;
pub use options::{Column, Layout, TableOptions};
pub(crate) use pick::listed;
use std::path::Path;

/// Reads the curves of a file.
///
/// # Errors
/// A file that cannot be read, is not text, or has no curve; a field that is not a number; times
/// that do not increase; neither times nor a frame rate, or both if they contradict each other. The
/// message has file, line, column, value and how to correct it.
pub fn read(path: &Path, options: &TableOptions) -> Result<Table, ReadError> {
    let name = path.display().to_string();
    let bytes =
        std::fs::read(path).map_err(|cause| ReadError::Read { path: name.clone(), cause })?;
    read_bytes(&name, &bytes, options)
}

/// Reads the curves from the bytes of a file; `path` is its name in errors, and helps to recognise
/// columns without names.
///
/// # Errors
/// As [`read`].
///
/// # Example
/// ```
/// use myospring::measured::{Kind, TableOptions, read_bytes};
/// let file = "Zeit (s);Länge (µm)\n0,00;120,5\n0,01;118,2\n0,02;115,0\n";
/// let table = read_bytes("cell.csv", file.as_bytes(), &TableOptions::default())?;
/// let curve = &table.curves[0];
/// assert_eq!((curve.kind, curve.unit), (Kind::Length, "um"));
/// assert_eq!(curve.times_ms, [0.0, 10.0, 20.0]);
/// assert_eq!(curve.values, [120.5, 118.2, 115.0]);
/// # Ok::<(), myospring::measured::ReadError>(())
/// ```
pub fn read_bytes(path: &str, bytes: &[u8], options: &TableOptions) -> Result<Table, ReadError> {
    pick::table(path, bytes, options)
}
