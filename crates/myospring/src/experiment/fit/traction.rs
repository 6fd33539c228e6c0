//! Forces of a cell on gels, as traction-force microscopy measures them.

use crate::analysis::kind::Kind;
use crate::experiment::{BeatOptions, ExperimentError, Files};
use crate::fit::{Loaded, Observed};
use crate::measured::{Curve, TableOptions, listed};
use crate::mechanics::gel::Gel;
use crate::mechanics::support::SupportKind;
use crate::recording::{AXIAL_FORCE, CONTRACTILE_MOMENT, TRACTION_FORCE};
use crate::settings::{self, Setting};
use std::path::PathBuf;

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
    /// The table of the curve.
    pub path: PathBuf,
}

impl TractionCurve {
    /// The curve, on the gel on which it was measured, and which column it is.
    pub(super) fn read(
        &self,
        support: SupportKind,
        options: &TableOptions,
        beats: &BeatOptions,
        files: &Files,
    ) -> Result<(Loaded, String), ExperimentError> {
        files.note(&self.path);
        // Columns and kind are those of the cell's own curve.
        let options = TableOptions { values: Vec::new(), kind: None, ..options.clone() };
        let table = files.table(&self.path, &options)?;
        let (loaded, note) = on_gel(&table.curves, (support, self.gel_modulus), beats)
            .map_err(|error| error.also(&format!("the table is `{}`", self.path.display())))?;
        Ok((loaded, format!("{}: {note}", self.path.display())))
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
    let bounds = settings::find("mechanics.gel_modulus").and_then(Setting::bounds);
    let out = |modulus: &f64| bounds.is_some_and(|bounds| !bounds.contains(*modulus));
    if let Some(modulus) = gel_modulus.filter(out) {
        let words = bounds.and_then(|bounds| bounds.words()).unwrap_or_default();
        return Err(ExperimentError::new(format!(
            "--traction: a gel of {modulus} kPa; it must be {words}"
        )));
    }
    let gel = match (support, gel_modulus) {
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
    };
    let stimuli = beats.within(curve).stimuli_ms;
    let stimuli = (!stimuli.is_empty()).then_some(stimuli.as_slice());
    let mut observed = Observed::of_load(curve, stimuli, load)?;
    let what = if load == CONTRACTILE_MOMENT { "moment" } else { "force" };
    observed.name = format!("{what} on {} kPa", gel.modulus);
    let note = format!("`{}` is fitted as the {}", curve.name, meaning(load));
    Ok((Loaded::exact(SupportKind::Gel(gel), observed), note))
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
