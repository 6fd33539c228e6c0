//! Which cells go side by side in stiff steps, and what is told of them.

use crate::cell::solve::Method;
use crate::cell::tomek_2019::{TomekModel, Variant};
use crate::settings::Run;
use std::any::Any;

/// Metrics of cells, with their units; those of the tension first, which only some have.
const METRICS: [(&str, &str); 7] = [
    ("peak_tension", "kPa"),
    ("time_to_peak_tension", "ms"),
    ("action_potential_duration_90", "ms"),
    ("peak_potential", "mV"),
    ("resting_potential", "mV"),
    ("diastolic_level", "uM"),
    ("systolic_level", "uM"),
];
const OF_TENSION: usize = 2;

/// The model of a run whose cells go side by side in stiff steps.
pub(super) fn tor_ord(run: &Run) -> Option<&TomekModel> {
    (&*run.cell as &dyn Any).downcast_ref()
}

/// The metrics that cells of this model have.
pub(super) fn metrics(model: &TomekModel) -> &'static [(&'static str, &'static str)] {
    if model.variant() == Variant::Land { &METRICS } else { &METRICS[OF_TENSION..] }
}

/// What curves show of cells of this model.
pub(super) fn quantities(model: &TomekModel) -> Vec<&'static str> {
    let mut quantities = vec!["Potential (mV)", "Calcium (\u{b5}M)"];
    if model.variant() == Variant::Land {
        quantities.push("Active tension (kPa)");
    }
    quantities
}

/// Why cells of a run cannot go side by side in stiff steps, if they cannot.
pub(super) fn refusal(run: &Run) -> Option<String> {
    let method = run.numerics.cell.method;
    (method != Method::Stiff)
        .then(|| format!("cells of {} go by stiff steps, not by {method}", run.cell.name()))
}
