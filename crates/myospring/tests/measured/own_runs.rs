//! One mechanism: the table of curves that a run writes, measured, has the run's own metrics, whatever its cell model.

use crate::common::Sample;
use myospring::analysis::Metric;
use myospring::analysis::beats::Beats;
use myospring::analysis::curve::{self, Analysis};
use myospring::analysis::value;
use myospring::cell::{self, TensionKind};
use myospring::measured::{Column, Curve, Kind, Table, TableOptions, read_bytes};
use myospring::output::csv::traces;
use myospring::prelude::*;
use std::sync::Arc;

/// Significant digits of the table.
const DIGITS: i32 = 9;

/// Metrics that one curve alone does not have, and the one that runs and measured curves define in different ways.
const OTHERS: [&str; 3] = ["lag_of_shortening", "tension_at_end", "maximum_upstroke_velocity"];

/// The beats of two stimuli, before the second of which some models are not yet at rest, and the table of their curves.
fn beaten(model: &str) -> (Beats, Table, String) {
    let mut simulation = Simulation::new(lattice::rectangle(20, 4, 5.0).unwrap());
    simulation.cell = cell::model(model).unwrap();
    let once = Protocol::once(simulation.cell.default_stimulus());
    simulation.protocol = Protocol { cycle_length_ms: 1000.0, beats: 2, ..once };
    simulation.duration = 50.0 + 2.0 * 1000.0;
    simulation.numerics.method = Method::QuasiStatic;
    let outcome = simulation.build().unwrap().run(|_progress| true);
    let csv = traces(&outcome.recording).unwrap();
    let table = read_bytes("traces.csv", csv.as_bytes(), &TableOptions::default()).unwrap();
    (outcome.beats(), table, csv)
}

fn analysed(curve: &Curve, beats: &Beats) -> Analysis {
    let options = curve::CurveOptions {
        stimuli_ms: beats.iter().map(|beat| beat.stimulus_ms).collect(),
        keep_drift: true,
        smoothing_ms: Some(0.0),
    };
    curve::analyse(&curve.times_ms, &curve.values, curve.kind, curve.unit, &options).unwrap()
}

/// How far a number may be off that was read from numbers with nine digits: a few of the last digits of the curve. Slopes
/// are differences over a step. The time of a flat top moves by a step times that digit over the second difference there.
fn tolerance(name: &str, curve: &Curve, run: &[Metric]) -> f64 {
    let most = curve.values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let digit = 4.0 * 10.0_f64.powi(most.log10().floor() as i32 + 1 - DIGITS);
    let step = curve.times_ms[1] - curve.times_ms[0];
    let relative = digit / most;
    let peak = ["time_of_peak", "time_of_peak_tension"];
    let top_ms = peak.iter().find_map(|name| value(run, name)).map_or(0.0, |peak| {
        let at =
            curve.times_ms.partition_point(|time| *time < peak).clamp(1, curve.values.len() - 2);
        let [before, top, after] = [at - 1, at, at + 1].map(|at| curve.values[at]);
        step * digit / (before - 2.0 * top + after).abs()
    });
    let own = value(run, name).unwrap_or(0.0).abs();
    let unit = run.iter().find(|metric| metric.name == name).map_or("", |metric| metric.unit);
    let rounding = match unit {
        // A small part of a beat is the difference of two lengths.
        "%" => 100.0 * relative,
        "ms" => step * 1e-4 + top_ms,
        "L0/s" => 1e3 * relative / step,
        "1/s" => 1e3 * relative / step / 0.01,
        "um/s" | "kPa/s" => 1e3 * digit / step,
        _ => 1e3 * digit,
    };
    rounding + 1e-6 * own
}

#[test]
#[ignore = "slow"]
fn the_curves_of_every_models_run_measure_as_the_run_says() {
    let pulls = |model: &&Arc<dyn CellModel>| model.tension_kind() != TensionKind::None;
    let mut sample = Sample::one_in(11);
    for model in cell::models().iter().filter(|model| pulls(model)).map(|model| model.name()) {
        if sample.leaves_out() {
            continue;
        }
        let (beats, table, csv) = beaten(model);
        let mut compared = 0;
        let chosen = |column: &str, kind| {
            let values = vec![Column::of(column)];
            let options = TableOptions { values, kind, ..TableOptions::default() };
            read_bytes("traces.csv", csv.as_bytes(), &options).unwrap().curves.remove(0)
        };
        // A potential without a unit does not say that it is one.
        let potential = beats[0].action_potential.first().map(|metric| match metric.unit {
            "mV" => chosen("vm_mV", None),
            _ => chosen("u", Some(Kind::Potential)),
        });
        let of_kind = |kind| table.curves.iter().find(|curve| curve.kind == kind).cloned();
        for curve in
            [of_kind(Kind::Tension), of_kind(Kind::Length), potential].into_iter().flatten()
        {
            let analysis = analysed(&curve, &beats);
            assert_eq!(analysis.beats.len(), beats.len(), "{model}, {}", curve.name);
            for (measured, run) in analysis.beats.iter().zip(&*beats) {
                let own = match curve.kind {
                    Kind::Tension => &run.tension,
                    Kind::Length => &run.contraction,
                    _ => &run.action_potential,
                };
                for metric in own.iter().filter(|metric| !OTHERS.contains(&metric.name)) {
                    let found = measured.metrics.iter().find(|other| other.name == metric.name);
                    let what = format!("{model}, {}, {}", curve.name, metric.name);
                    let found =
                        found.unwrap_or_else(|| panic!("{what}: measured curves have none"));
                    let off = match (found.value, metric.value) {
                        (Some(found), Some(own)) => (found - own).abs(),
                        (None, None) => 0.0,
                        (found, own) => panic!("{what}: {found:?}, and the run says {own:?}"),
                    };
                    let least = tolerance(metric.name, &curve, own);
                    assert!(
                        off <= least,
                        "{what}: {found:?}, and the run says {:?}: {off:e} is more than {least:e}",
                        metric.value
                    );
                    compared += 1;
                }
            }
        }
        assert!(compared > 40, "{model}: {compared} numbers");
    }
}

#[test]
fn no_gate_or_current_of_a_run_is_taken_for_a_time_a_length_or_calcium() {
    let (_, table, _) = beaten("tor_ord_land");
    let names: Vec<&str> = table.curves.iter().map(|curve| &*curve.name).collect();
    let calcium = ["Ca_i_uM", "Ca_cyt_mM", "Ca_ss_mM", "Ca_nsr_mM", "Ca_jsr_mM"];
    let own = ["vm_mV", "ta_kPa", "length_um", "shortening_pct"];
    assert_eq!(names, [&own[..], &calcium].concat());
    assert!(table.curves.iter().all(|curve| curve.times_ms[2] == 1.0), "a clock other than `t_ms`");
}
