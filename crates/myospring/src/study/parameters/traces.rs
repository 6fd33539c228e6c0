//! Curves of the members: potential, tension and shortening at a few hundred times each, in one file.

use super::super::{Cause, Interrupted, StudyError};
use super::member::{Variation, VariationRow};
use super::shard::Shard;
use crate::output::files::{FileError, Manifest, sha256};
use crate::output::npy::Records;
use serde::Serialize;
use std::path::Path;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Name of the file: 32-bit floats by member, quantity and time; NaN where a member has no such curve.
pub const TRACES: &str = "traces.npy";

/// Time between two values, ms, and how many there are at most.
const INTERVAL_MS: f64 = 2.5;
const MOST: f64 = 1000.0;

/// What the curves of all members have in common.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct TraceAxes {
    /// The quantities with their units, in order: `Active tension (kPa)`.
    pub quantities: Vec<&'static str>,
    /// Time between two values, ms; the first is at 0 ms.
    pub interval_ms: f64,
    /// How many there are.
    pub times: usize,
}

impl TraceAxes {
    /// For runs of this duration.
    pub(super) fn new(duration_ms: f64, quantities: Vec<&'static str>) -> Self {
        let interval_ms = INTERVAL_MS.max(duration_ms / MOST);
        Self { quantities, interval_ms, times: (duration_ms / interval_ms + 1e-9) as usize + 1 }
    }

    /// The times, ms.
    pub fn times_ms(&self) -> Vec<f64> {
        (0..self.times).map(|count| count as f64 * self.interval_ms).collect()
    }

    /// Bytes of a member.
    pub fn bytes(&self) -> usize {
        4 * self.quantities.len() * self.times
    }

    /// Quantities of samples at these times, between neighbours; NaN after the last.
    pub(super) fn resampled<T>(
        &self,
        samples: &[T],
        t_ms: fn(&T) -> f64,
        quantities: &[fn(&T) -> f64],
    ) -> Vec<f32> {
        let mut numbers = Vec::with_capacity(self.quantities.len() * self.times);
        for value in quantities {
            let mut after = 0;
            numbers.extend(self.times_ms().into_iter().map(|t| {
                while samples.get(after).is_some_and(|sample| t_ms(sample) < t) {
                    after += 1;
                }
                let Some(next) = samples.get(after) else { return f32::NAN };
                let Some(before) = after.checked_sub(1).and_then(|at| samples.get(at)) else {
                    return value(next) as f32;
                };
                let part = (t - t_ms(before)) / (t_ms(next) - t_ms(before));
                (value(before) + part * (value(next) - value(before))) as f32
            }));
        }
        numbers
    }
}

/// The file of a part of a study.
#[derive(Debug)]
pub(super) struct Traces {
    records: Mutex<Records>,
    part: Shard,
    failed: Mutex<Option<FileError>>,
}

impl Traces {
    pub(super) fn open(
        folder: &Path,
        axes: &TraceAxes,
        part: Shard,
        members: usize,
    ) -> Result<Self, StudyError> {
        let shape = [members, axes.quantities.len(), axes.times];
        let path = Manifest::of(folder).changing(TRACES)?;
        let records = Mutex::new(Records::open(&path, &shape)?);
        Ok(Self { records, part, failed: Mutex::new(None) })
    }

    /// Where the curves of a member are.
    fn place(&self, member: usize) -> usize {
        (member - self.part.part) / self.part.of
    }

    /// Whether the curves of a row have not changed since it was recorded.
    pub(super) fn has(&self, row: &VariationRow) -> Result<bool, FileError> {
        let curves = self.records().read(self.place(row.member))?;
        Ok(if row.curves.is_empty() {
            curves.iter().all(|number| number.is_nan())
        } else {
            hash(&curves) == row.curves
        })
    }

    fn records(&self) -> MutexGuard<'_, Records> {
        self.records.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Writes the curves of some members, which are on the disk when this returns; returns the hash
    /// of each, empty for a member without curves.
    ///
    /// # Errors
    /// [`Interrupted`], if they cannot be written; the study ends, and [`Traces::failure`] says
    /// why.
    pub(super) fn keep(
        &self,
        members: &[&Variation],
        curves: &[Vec<f32>],
    ) -> Result<Vec<String>, Cause> {
        let mut records = self.records();
        let mut all = || {
            let mut hashes = Vec::with_capacity(members.len());
            for (member, curves) in members.iter().zip(curves) {
                let written = records.write(self.place(member.number), curves)?;
                hashes.push(if curves.is_empty() { String::new() } else { hash(&written) });
            }
            records.sync()?;
            Ok(hashes)
        };
        all().map_err(|error| {
            *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error);
            Interrupted.into()
        })
    }

    pub(super) fn failure(&self) -> Option<FileError> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).take()
    }
}

fn hash(curves: &[f32]) -> String {
    sha256(&curves.iter().copied().flat_map(f32::to_le_bytes).collect::<Vec<u8>>())
}

/// The rows of a part whose curves in its folder have not changed since the row was recorded.
///
/// # Errors
/// A file that cannot be read or written.
pub fn with_whole_curves(
    folder: &Path,
    axes: &TraceAxes,
    part: Shard,
    members: usize,
    mut rows: Vec<VariationRow>,
) -> Result<Vec<VariationRow>, StudyError> {
    let traces = Traces::open(folder, axes, part, part.size(members))?;
    let mut failed = None;
    rows.retain(|row| traces.has(row).unwrap_or_else(|error| failed.replace(error).is_some()));
    failed.map_or(Ok(rows), |error| Err(error.into()))
}

/// Puts the curves of parts, each in its folder, together in `target`.
///
/// # Errors
/// Files that cannot be read or written.
pub fn merge_traces(
    target: &Path,
    axes: &TraceAxes,
    members: usize,
    parts: &[(Shard, &Path)],
) -> Result<(), StudyError> {
    let shape = |members: usize| [members, axes.quantities.len(), axes.times];
    let path = Manifest::of(target).changing(TRACES)?;
    let mut whole = Records::open(&path, &shape(members))?;
    for (shard, folder) in parts {
        let Shard { part, of } = *shard;
        let count = (members + of - part) / of;
        let mut records = Records::open(&folder.join(TRACES), &shape(count))?;
        for record in 0..count {
            let curves = records.read(record)?;
            // Overlapping parts agree, but one may contain more members than the other.
            if curves.iter().any(|number| !number.is_nan()) {
                whole.write(part - 1 + record * of, &curves)?;
            }
        }
    }
    Ok(whole.sync()?)
}
