//! The run that repeats a fit.

use super::answer::{Fit, RecordedCourse};
use super::error::FitError;
use super::fitter::Fitter;
use super::fitter::ONE_BEAT;
use super::unknown::Unknown;
use crate::cell::pacing::Protocol;
use crate::cell::steady::pace;
use crate::cell::tension::lag::Lag;
use crate::cell::tension::train::Potential;
use crate::cell::tension::{Rates, Tension};
use crate::cell::{CellModel, TensionKind};
use crate::integrate::Method;
use crate::settings::{Calibration, Run};
use std::sync::Arc;

impl Fitter {
    /// The run with the fitted numbers and as many beats as the first curve, from its first
    /// stimulus on. A cell that had beaten before is paced first, if that makes it steady. `myospring run` repeats the
    /// fitted curve.
    ///
    /// # Errors
    /// Numbers that the model does not take.
    pub fn fitted(&self, mut run: Run, fit: &Fit) -> Result<Run, FitError> {
        if let Some(own) = &fit.own_tension {
            return own.run(run, fit, self.modulus());
        }
        let mut parameters = self.simulation().cell.parameters().clone();
        let mut tension = self.tension();
        for estimate in &fit.estimates {
            match &estimate.unknown {
                Some(Unknown::Parameter(name)) => parameters.set(name, estimate.value)?,
                Some(Unknown::YoungModulus) => {
                    let by = estimate.value / self.modulus();
                    run.material.stiffen(by);
                    tension *= by;
                }
                _ => {}
            }
        }
        if let Some(ratio) = fit.estimate(Unknown::TensionOverStiffness.name()) {
            tension *= ratio.value / self.tension_over_stiffness();
        }
        let cell = &self.simulation().cell;
        if let TensionKind::Relative { published_peak } = cell.tension_kind() {
            run.cell = cell.with_parameters(parameters)?;
            // The fitted peak is that of this cell; the setting is that of the published
            // parameters.
            let of_tension = fit.estimates.iter().all(|estimate| match &estimate.unknown {
                Some(Unknown::Parameter(name)) => Rates::NAMES.contains(&name.as_str()),
                _ => true,
            });
            let law = run.cell.tension_of_potential().filter(|_| of_tension);
            run.peak_tension = match law {
                Some(law) => {
                    tension * published_peak / own_peak(&run.cell, law, run.protocol, fit)?
                }
                None => tension,
            };
        } else {
            if let Some(name) = cell.in_fits().strength {
                parameters.set(name, tension)?;
            }
            run.cell = cell.with_parameters(parameters)?;
        }
        if let Some(curve) = fit.curves.first() {
            let stimuli = &curve.stimuli_ms;
            let (first, last) = (stimuli[0], stimuli[stimuli.len() - 1]);
            run.protocol.beats = stimuli.len() as u32;
            if stimuli.len() > 1 {
                let cycle = (last - first) / (stimuli.len() - 1) as f64;
                run.protocol.cycle_length_ms = (cycle * WRITTEN).round() / WRITTEN;
            }
            let end = curve.times_ms.last().copied().unwrap_or_default();
            run.duration = (run.protocol.start_ms + end - first).max(1.0).ceil();
        }
        if run.cell.tension_of_potential().is_some() {
            let (protocol, settings) = (run.protocol, run.cell_settings());
            // Very fast trains may never become steady; then the run begins at rest.
            let paced =
                || pace(&run.cell, protocol, settings, STEADY, &self.simulation().interruption);
            run.steady_state = (fit.beats_before > 0 && paced().is_ok()).then_some(STEADY);
        }
        if fit.calcium.as_ref().is_some_and(|calcium| calcium.drives) {
            // The caller writes it.
            run.calcium = Some(RecordedCourse::FILE.to_owned());
            run.calibration = Calibration::default();
        }
        run.numerics.method = Method::QuasiStatic;
        Ok(run)
    }
}

/// The run of a train that began before the curve is paced until no state changes by more than this.
const STEADY: f64 = 1e-3;
/// Cycle lengths are rounded to this part of a ms.
pub(super) const WRITTEN: f64 = 1e6;

/// The largest `Ta` of the fitted beats.
fn own_peak(
    cell: &Arc<dyn CellModel>,
    law: &Tension,
    protocol: Protocol,
    fit: &Fit,
) -> Result<f64, FitError> {
    let stimuli = fit.curves.first().map_or(&[0.0][..], |curve| &curve.stimuli_ms);
    let beats = stimuli.len();
    let spread = stimuli[beats - 1] - stimuli[0];
    let cycle = if beats > 1 { spread / (beats - 1) as f64 } else { ONE_BEAT };
    let potential = Potential::solve(cell, law, protocol, fit.beats_before, beats, cycle)?;
    let regular: Vec<f64> = (0..beats).map(|beat| beat as f64 * cycle).collect();
    let end = [regular[beats - 1] + cycle];
    Ok(potential.tension(&Rates::of(law, Lag::NONE), &regular, &end, &mut Vec::new()))
}
