//! The numbers of a beat by name.

use myospring::analysis::Metric;
use myospring::analysis::beat::{Beats, beats, energy};
use myospring::recording::{END_FORCE, Recording, Sample, Signal};
use pyo3::prelude::*;

/// All metrics of a beat in the order of reading: name, unit, definition.
#[pyfunction]
pub(crate) fn metrics() -> Vec<(&'static str, &'static str, &'static str)> {
    // The names hang on nothing that was recorded.
    let still = Sample {
        t_ms: 0.0,
        u: Some(0.0),
        vm_mv: Some(0.0),
        ta_kpa: 0.0,
        length_um: 1.0,
        width_um: 1.0,
        area_um2: 1.0,
        shortening_pct: 0.0,
        elastic_energy_fj: 0.0,
        kinetic_energy_fj: 0.0,
        active_work_fj: 0.0,
        dissipated_energy_fj: 0.0,
        momentum_nn_ms: 0.0,
        angular_momentum_nn_um_ms: 0.0,
    };
    let end_force = Signal { name: END_FORCE.into(), unit: "nN".into(), values: vec![0.0] };
    let recording =
        Recording { samples: vec![still], signals: vec![end_force], ..Recording::default() };
    let beats = beats(&recording, &[0.0]);
    let of_beat = beats.first().into_iter().flat_map(|beat| beat.metrics().cloned());
    let all = of_beat.chain(energy(&recording.samples));
    all.map(|Metric { name, unit, definition, .. }| (name, unit, definition)).collect()
}

/// The value of a metric: of several beats their mean, over those that show it.
pub(crate) fn value(beats: &Beats, name: &str) -> Option<f64> {
    if let Some(metric) = beats.energy.iter().find(|metric| metric.name == name) {
        return metric.value;
    }
    let values: Vec<f64> = beats.iter().filter_map(|beat| beat.value(name)).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}
