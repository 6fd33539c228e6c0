//! The curves that cells are fitted to.

use crate::analysis::kind::Family;
use crate::experiment::tables::tables;
use crate::experiment::{BeatOptions, ExperimentError, Files};
use crate::fit::{FitError, Loaded, Observed, of_each_cell};
use crate::measured::{Curve, Table, TableOptions};
use crate::mechanics::support::SupportKind;
use crate::settings::{self, Setting};
use std::path::PathBuf;

/// A curve by its name, or why it cannot be read.
pub type Named = (String, Result<Curve, ExperimentError>);

/// The curves that are fitted, the curves of calcium beside them, and the assumptions.
pub(super) type CurvesOfTables = (Vec<Named>, Vec<Curve>, Vec<String>);

/// The curves of a table that are fitted, one for each cell, and the assumptions.
pub fn of_table(table: Table, options: &TableOptions) -> (Vec<Curve>, Vec<String>) {
    let Table { curves, mut notes, .. } = table;
    if !options.values.is_empty() || options.kind.is_some() {
        return (curves, notes);
    }
    let (curves, note) = of_each_cell(curves);
    notes.extend(note);
    (curves, notes)
}

/// The curves of files and folders, the curves of calcium beside them, and the assumptions. If one of several files cannot be read, it
/// counts as a cell that cannot be fitted.
pub(super) fn of_tables(
    paths: &[PathBuf],
    options: &TableOptions,
    files: &Files,
) -> Result<CurvesOfTables, ExperimentError> {
    let paths = tables(paths)?;
    let (mut curves, mut notes): (Vec<Named>, _) = (Vec::new(), Vec::new());
    let mut calcium = Vec::new();
    let several = paths.len() > 1;
    for path in &paths {
        let stem = path.file_stem().unwrap_or_default().to_string_lossy();
        let table = match files.table(path, options) {
            Ok(table) => table,
            Err(error) if several => {
                curves.push((stem.into_owned(), Err(error.into())));
                continue;
            }
            Err(error) => return Err(error.into()),
        };
        let (own, others): (Vec<Curve>, Vec<Curve>) =
            table.curves.into_iter().partition(|curve| curve.kind.family() == Family::Calcium);
        let curves_of_table = if others.is_empty() { own.clone() } else { others };
        calcium.extend(own);
        let table = Table { curves: curves_of_table, notes: table.notes };
        let (taken, more) = of_table(table, options);
        notes.extend(more.iter().map(|note| format!("{}: {note}", path.display())));
        for mut curve in taken {
            if several {
                curve.name = format!("{stem} {}", curve.name);
            }
            curves.push((curve.name.clone(), Ok(curve)));
        }
    }
    if let Some((_, Err(error))) = curves.first()
        && curves.iter().all(|(_, curve)| curve.is_err())
    {
        let many = format!("none of {} files can be read as a table of curves", curves.len());
        return Err(ExperimentError::new(many).also(&error.to_string()));
    }
    Ok((curves, calcium, notes))
}

/// A curve of the cell between two springs, such as carbon fibres.
#[derive(Debug, Clone, PartialEq)]
pub struct EndSprings {
    /// Stiffness of each spring, nN/um.
    pub stiffness: f64,
    /// The table of the curve.
    pub path: PathBuf,
}

impl EndSprings {
    pub(super) fn read(
        &self,
        options: &TableOptions,
        beats: &BeatOptions,
        files: &Files,
    ) -> Result<Loaded, ExperimentError> {
        let table = files.table(&self.path, options)?;
        let [curve] = table.curves.as_slice() else {
            return Err(ExperimentError::new(format!(
                "`{}` has {} curves; --loaded takes one",
                self.path.display(),
                table.curves.len()
            ))
            .advise("--mean uses the mean of all, --columns chooses one"));
        };
        between_springs(self.stiffness, curve, beats)
    }
}

/// A curve of the cell between springs of this stiffness, nN/um.
///
/// # Errors
/// A stiffness out of the bounds of the setting `mechanics.end_stiffness`, or a curve without a beat.
pub fn between_springs(
    stiffness: f64,
    curve: &Curve,
    beats: &BeatOptions,
) -> Result<Loaded, ExperimentError> {
    let bounds = settings::find("mechanics.end_stiffness").and_then(Setting::bounds);
    if let Some(bounds) = bounds.filter(|bounds| !bounds.contains(stiffness)) {
        let words = bounds.words().unwrap_or_default();
        return Err(ExperimentError::new(format!(
            "--loaded: {stiffness} nN/um; it must be {words}"
        )));
    }
    let mut observed = observed(curve, beats, None)?;
    observed.name = format!("{stiffness} nN/um");
    Ok(Loaded::exact(SupportKind::SpringHeldEnds { stiffness }, observed))
}

/// A curve as a fit sees it.
///
/// # Errors
/// Those of [`Observed::of`].
pub(super) fn observed(
    curve: &Curve,
    beats: &BeatOptions,
    peak_shortening_pct: Option<f64>,
) -> Result<Observed, FitError> {
    let stimuli = beats.within(curve).stimuli_ms;
    Observed::of(curve, (!stimuli.is_empty()).then_some(stimuli.as_slice()), peak_shortening_pct)
}
