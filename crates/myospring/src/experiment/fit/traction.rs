//! Forces of a cell on gels, as traction-force microscopy measures them.

use crate::analysis::kind::Kind;
use crate::experiment::tables::is_of_tables;
use crate::experiment::track::{Followed, open_film};
use crate::experiment::traction::{Beads, CellPlace, FoundTractions, Traction};
use crate::experiment::{
    BeatOptions, Experiment as _, ExperimentError, Files, Observer, Outcome as _,
};
use crate::fit::{Loaded, Observed};
use crate::measured::{Curve, TableOptions, listed};
use crate::mechanics::gel::Gel;
use crate::mechanics::support::SupportKind;
use crate::microscopy::picture::Selection;
use crate::recording::{AXIAL_FORCE, CONTRACTILE_MOMENT, TRACTION_FORCE};
use crate::settings::{self, Setting};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Relative standard deviation of the scale of measured forces, unless stated: what traction microscopy of simulated beads gets wrong
/// (`docs/reference/accuracy.md`).
pub const SCALE_ERROR: f64 = 0.05;

/// The relative standard deviation of the scale of measured forces: this, or [`SCALE_ERROR`].
///
/// # Errors
/// Below 0, or 1 and above.
pub fn scale_error(given: Option<f64>) -> Result<f64, ExperimentError> {
    let error = given.unwrap_or(SCALE_ERROR);
    if (0.0..1.0).contains(&error) {
        return Ok(error);
    }
    Err(ExperimentError::new(format!(
        "--traction-error: {} %; it must be at least 0 % and below 100 %",
        100.0 * error
    )))
}

/// A curve of the force of the cell on a gel.
#[derive(Debug, Clone, PartialEq)]
pub struct TractionCurve {
    /// Young's modulus of the gel, kPa; `None`: the gel of the run.
    pub gel_modulus: Option<f64>,
    /// The table of the curve, or a film of the beads in the gel.
    pub path: PathBuf,
}

/// A force on a gel as it was read.
pub(super) struct ReadForce {
    pub(super) loaded: Loaded,
    /// Which column it is, and what was odd.
    pub(super) notes: Vec<String>,
    /// Of a film.
    pub(super) tractions: Option<FoundTractions>,
}

/// What forces on gels are read with.
pub(super) struct ForceReader<'a> {
    pub(super) support: SupportKind,
    pub(super) options: &'a TableOptions,
    pub(super) beats: &'a BeatOptions,
    /// The cell of the film to which it is fitted, and the picture of the cell.
    pub(super) film: Option<&'a Arc<Followed>>,
    pub(super) picture: Option<&'a Path>,
    pub(super) threads: Option<usize>,
    pub(super) files: &'a Files,
    pub(super) observer: &'a dyn Observer,
}

impl ForceReader<'_> {
    pub(super) fn read(&self, curve: &TractionCurve) -> Result<ReadForce, ExperimentError> {
        self.files.note(&curve.path);
        let name = curve.path.display();
        let (curves, tractions) = if is_of_tables(&curve.path) {
            // Columns and kind are those of the cell's own curve.
            let options = TableOptions { values: Vec::new(), kind: None, ..self.options.clone() };
            (self.files.table(&curve.path, &options)?.curves, None)
        } else {
            let gel = gel((self.support, curve.gel_modulus))?;
            let found = self.follow(&curve.path, gel)?;
            (found.force().into_iter().collect(), Some(found))
        };
        let (loaded, note) = on_gel(&curves, (self.support, curve.gel_modulus), self.beats)
            .map_err(|error| error.also(&format!("the force is that of `{name}`")))?;
        let warnings = tractions.iter().flat_map(FoundTractions::warnings);
        let notes = std::iter::once(note).chain(warnings);
        let notes = notes.map(|note| format!("{name}: {note}")).collect();
        Ok(ReadForce { loaded, notes, tractions })
    }

    /// The tractions of a film of beads at the cell, which the film or the picture of the cell shows in the same window.
    fn follow(&self, path: &Path, gel: Gel) -> Result<FoundTractions, ExperimentError> {
        let beads = Beads { pixel_size_um: self.options.pixel_size_um, ..Beads::of(path) };
        let shown = open_film(path, &Selection::default(), 1, self.files)?.size();
        let film = self.film.filter(|film| film.film.size() == shown);
        let cell = film.map(|film| CellPlace::Followed(Arc::clone(film)));
        let Some(cell) = cell.or_else(|| self.picture.map(CellPlace::of)) else {
            let name = path.display();
            return Err(ExperimentError::new(format!(
                "--traction: it is not known where in `{name}` the cell is, so its force is not either"
            ))
            .advise(format!(
                "fit a film or a picture of the cell in the same window; or `myospring traction {name} --cell OUTLINE`, then \
                 --traction with its traction.csv"
            )));
        };
        let traction = Traction {
            cell: Some(cell),
            frame_rate_per_s: self.options.frame_rate_per_s,
            threads: self.threads,
            ..Traction::of_beads(beads, gel)
        };
        let found = traction.run(self.files, self.observer)?;
        self.observer.interruption().check().map_err(ExperimentError::new)?;
        Ok(found)
    }
}

/// The curve of a table that is fitted, and what it is: the force along the cell, which noise does not raise, rather than the sum of
/// absolute forces, and that rather than the contractile moment.
fn chosen(curves: &[Curve]) -> Option<(&Curve, &'static str)> {
    let named = |curve: &Curve, word: &str| curve.name.to_lowercase().contains(word);
    let find = |is: &dyn Fn(&Curve) -> bool| curves.iter().find(|curve| is(curve));
    let is_force = |curve: &Curve| curve.kind == Kind::Force;
    let axial = find(&|curve| is_force(curve) && named(curve, "axial"));
    // What noise alone would make is in the same unit.
    let total = || find(&|curve| is_force(curve) && !named(curve, "noise"));
    let moment = || find(&|curve| curve.kind == Kind::Moment);
    let axial = axial.map(|curve| (curve, AXIAL_FORCE));
    let total = || total().map(|curve| (curve, TRACTION_FORCE));
    axial.or_else(total).or_else(|| moment().map(|curve| (curve, CONTRACTILE_MOMENT)))
}

/// The force, or the contractile moment, of the cell on a gel: of this modulus (kPa), or that of the run; and which of the curves it is.
///
/// # Errors
/// Curves of which none is a force, a run without a gel and no modulus, a modulus out of the bounds of the setting
/// `mechanics.gel_modulus`, or a curve without a beat.
pub fn on_gel(
    curves: &[Curve],
    (support, gel_modulus): (SupportKind, Option<f64>),
    beats: &BeatOptions,
) -> Result<(Loaded, String), ExperimentError> {
    let Some((curve, load)) = chosen(curves) else {
        let names: Vec<String> = curves.iter().map(|curve| curve.name.clone()).collect();
        return Err(ExperimentError::new(format!(
            "--traction needs a force in nN or uN, or a contractile moment; the table has {}",
            listed(&names)
        ))
        .advise("write the unit into the head of the column, like force_nN"));
    };
    let gel = gel((support, gel_modulus))?;
    let stimuli = beats.within(curve).stimuli_ms;
    let stimuli = (!stimuli.is_empty()).then_some(stimuli.as_slice());
    let mut observed = Observed::of_load(curve, stimuli, load)?;
    let what = if load == CONTRACTILE_MOMENT { "moment" } else { "force" };
    observed.name = format!("{what} on {} kPa", gel.modulus);
    let note = format!("`{}` is fitted as the {}", curve.name, meaning(load));
    Ok((Loaded::exact(SupportKind::Gel(gel), observed), note))
}

/// The gel of a force: of this modulus (kPa), or that of the run.
fn gel((support, gel_modulus): (SupportKind, Option<f64>)) -> Result<Gel, ExperimentError> {
    let bounds = settings::find("mechanics.gel_modulus").and_then(Setting::bounds);
    let out = |modulus: &f64| bounds.is_some_and(|bounds| !bounds.contains(*modulus));
    if let Some(modulus) = gel_modulus.filter(out) {
        let words = bounds.and_then(|bounds| bounds.words()).unwrap_or_default();
        return Err(ExperimentError::new(format!(
            "--traction: a gel of {modulus} kPa; it must be {words}"
        )));
    }
    Ok(match (support, gel_modulus) {
        (SupportKind::Gel(gel), Some(modulus)) => Gel { modulus, ..gel },
        (SupportKind::Gel(gel), None) => gel,
        (_, Some(modulus)) => Gel::half_space(modulus),
        (_, None) => {
            return Err(ExperimentError::new(
                "--traction needs the gel on which the force was measured",
            )
            .advise(
                "give --support gel with --gel-modulus if the shape was measured on that gel, or write the modulus before the file: \
                 --traction \"10 kPa=force.csv\"",
            ));
        }
    })
}

fn meaning(load: &str) -> &'static str {
    match load {
        AXIAL_FORCE => {
            "force along the long axis with which the halves of the cell draw the gel together"
        }
        CONTRACTILE_MOMENT => "contractile moment",
        _ => "sum of the absolute forces of the cell on the gel",
    }
}

/// The label of an axis.
pub(super) fn label(load: &str) -> &'static str {
    match load {
        AXIAL_FORCE => "Axial force",
        CONTRACTILE_MOMENT => "Contractile moment",
        _ => "Force on the gel",
    }
}
