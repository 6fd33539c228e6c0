//! Metrics and curves of cells without a mesh, as far as their models have them.

use crate::cell::batch::{CellBeat, CellSample};
use crate::cell::{CellModel, Input, TensionKind};
use crate::settings::Run;

/// A sample and its time, ms.
pub(super) type Timed = (f64, CellSample);

/// The quantities of curves of cells of a model.
pub(super) fn quantities(model: &dyn CellModel) -> Vec<&'static str> {
    shown(model).into_iter().map(|(name, _)| name).collect()
}

/// A quantity of a sample whose tension is in kPa.
pub(super) type Shown = (&'static str, fn(&Timed) -> f64);

pub(super) fn shown(model: &dyn CellModel) -> Vec<Shown> {
    let (state, rest) = (model.initial_state(), Input::REST);
    let mut shown: Vec<Shown> = Vec::new();
    if model.membrane_potential_mv(&state).is_some() {
        shown.push(("Potential (mV)", |(_, it)| it.potential_mv.unwrap_or(f64::NAN)));
    } else if model.potential(&state).is_some() {
        shown.push(("Potential u (\u{2013})", |(_, it)| it.potential.unwrap_or(f64::NAN)));
    }
    if model.calcium_um(&state, &rest).is_some() {
        shown.push(("Calcium (\u{b5}M)", |(_, it)| it.calcium_um.unwrap_or(f64::NAN)));
    }
    if model.tension_kind() != TensionKind::None {
        shown.push(("Active tension (kPa)", |(_, it)| it.tension));
    }
    shown
}

/// Metrics of the cells of a run, with their units.
pub(super) fn metrics(run: &Run) -> Vec<(&'static str, &'static str)> {
    let model = &*run.cell;
    let (state, rest) = (model.initial_state(), Input::REST);
    let pulls = model.tension_kind() != TensionKind::None;
    let beats = model.potential(&state).is_some();
    let mut all = Vec::new();
    if pulls {
        all.extend([("peak_tension", "kPa"), ("time_to_peak_tension", "ms")]);
    }
    if beats {
        let unit = unit(model);
        all.extend([
            ("action_potential_duration_90", "ms"),
            ("peak_potential", unit),
            ("resting_potential", unit),
        ]);
    }
    if model.calcium_um(&state, &rest).is_some() {
        all.extend([("diastolic_level", "uM"), ("systolic_level", "uM")]);
    }
    if run.protocol.s2_interval_ms.is_some() {
        all.push(("coupling_interval", "ms"));
        all.extend(beats.then_some(("diastolic_interval", "ms")));
        all.extend(pulls.then_some(("relative_peak_tension", "%")));
    }
    all
}

/// A metric that beats have without samples; `scale` is in kPa per unit of their tension.
pub(super) fn metric_of_beat(beat: &CellBeat, name: &str, scale: f64) -> Option<f64> {
    match name {
        "peak_tension" => Some(scale * beat.peak_tension),
        "time_to_peak_tension" => Some(beat.peak_tension_ms - beat.stimulus_ms),
        "action_potential_duration_90" => beat.apd90_ms,
        "peak_potential" => Some(beat.peak_potential),
        "resting_potential" => Some(beat.resting_potential),
        _ => None,
    }
}

/// Metrics that beats have without samples.
pub(super) const FROM_BEATS: [&str; 5] = [
    "peak_tension",
    "time_to_peak_tension",
    "action_potential_duration_90",
    "peak_potential",
    "resting_potential",
];

/// Unit of a model's potential.
pub(super) fn unit(model: &dyn CellModel) -> &'static str {
    if model.potential_unit() == "mV" { "mV" } else { "" }
}
