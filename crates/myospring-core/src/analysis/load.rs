//! Force and work loop of a cell whose ends are held, and forces of one on a gel.

use super::{Metric, Missing, rest, trace};
use crate::recording::{AXIAL_FORCE, CONTRACTILE_MOMENT, GEL_ENERGY, TRACTION_FORCE};

/// The metrics of one beat from length (um) and the force at the ends (nN) over time (ms).
///
/// The end of systole is the moment when force divided by length is largest: the largest force in
/// an isometric beat, the shortest length against a constant load, both against springs.
///
/// # Example
/// ```
/// use myospring::analysis::{load, value};
/// let times: Vec<f64> = (0..=200).map(f64::from).collect();
/// // Isometric up to 100 nN, then shorter by 5 um under that force, and back.
/// let force = |t: f64| (10.0 * (t - 10.0)).clamp(0.0, 100.0);
/// let forces: Vec<f64> = times.iter().map(|&t| force(t.min(220.0 - t))).collect();
/// let length = |t: f64| 100.0 - (0.1 * (t - 20.0)).clamp(0.0, 5.0);
/// let lengths: Vec<f64> = times.iter().map(|&t| length(t.min(190.0 - t))).collect();
/// let metrics = load::metrics(&times, &lengths, &forces, 10.0);
/// assert_eq!(value(&metrics, "peak_end_force"), Some(100.0));
/// assert_eq!(value(&metrics, "end_systolic_length"), Some(95.0));
/// assert!((value(&metrics, "work_on_load").unwrap() - 500.0).abs() < 1e-9);
/// ```
pub fn metrics(times: &[f64], lengths: &[f64], forces: &[f64], stimulus: f64) -> Vec<Metric> {
    let rest = trace::baseline(times, forces, stimulus);
    above(times, lengths, forces, stimulus, rest, rest::BEFORE_STIMULUS)
}

/// Like [`metrics`], with a known force at rest.
pub fn above(
    times: &[f64],
    lengths: &[f64],
    forces: &[f64],
    stimulus: f64,
    rest: Option<f64>,
    rest_is: &'static str,
) -> Vec<Metric> {
    let after = times.partition_point(|time| *time < stimulus);
    let most = |of: &dyn Fn(usize) -> f64| {
        // The first of several equal ones.
        (after..times.len().min(forces.len()))
            .reduce(|best, here| if of(here) > of(best) { here } else { best })
    };
    let strongest = most(&|k| forces[k]).filter(|&k| forces[k] > 0.0);
    let end = most(&|k| forces[k] / lengths[k]).filter(|_| strongest.is_some());
    // W = -int F dL
    let work = end.map(|end| {
        let part = |k: usize| 0.5 * (forces[k] + forces[k + 1]) * (lengths[k] - lengths[k + 1]);
        (after..end).map(part).sum::<f64>()
    });
    let row = |name, value: Option<f64>, unit, definition| {
        Metric::new(name, value.ok_or(Missing::NoRise), unit, definition)
    };
    vec![
        row("end_force_at_rest", rest, "nN", rest_is),
        row(
            "peak_end_force",
            strongest.map(|k| forces[k]),
            "nN",
            "largest force with which the cell pulls its ends inward",
        ),
        row(
            "time_to_peak_end_force",
            strongest.map(|k| times[k] - stimulus),
            "ms",
            "from the stimulus to the largest force",
        ),
        row(
            "end_systolic_force",
            end.map(|k| forces[k]),
            "nN",
            "force at the end of systole, when force divided by length is largest",
        ),
        row("end_systolic_length", end.map(|k| lengths[k]), "um", "length at the end of systole"),
        row(
            "time_to_end_systole",
            end.map(|k| times[k] - stimulus),
            "ms",
            "from the stimulus to the end of systole",
        ),
        row(
            "work_on_load",
            work,
            "fJ",
            "work on what holds the ends, from the stimulus to the end of systole",
        ),
    ]
}

/// The metrics of one beat of a cell on a gel, from the signals of its forces; empty where they were not recorded.
///
/// # Example
/// ```
/// use myospring::analysis::{load, value};
/// let times: Vec<f64> = (0..=200).map(f64::from).collect();
/// let force: Vec<f64> = times.iter().map(|t| 30.0 - (t - 80.0).abs().min(30.0)).collect();
/// let metrics = load::on_gel(&times, |_| Some(&force), 10.0);
/// assert_eq!(value(&metrics, "peak_traction_force"), Some(30.0));
/// assert_eq!(value(&metrics, "time_to_peak_traction_force"), Some(70.0));
/// assert_eq!(value(&metrics, "traction_relaxation_time_50"), Some(15.0));
/// ```
pub fn on_gel<'a>(
    times: &[f64],
    signal: impl Fn(&str) -> Option<&'a [f64]>,
    stimulus: f64,
) -> Vec<Metric> {
    let Some(force) = signal(TRACTION_FORCE) else { return Vec::new() };
    let after = times.partition_point(|time| *time < stimulus);
    let peak = |values: &[f64]| {
        let values = values.get(after..times.len())?;
        trace::peak(&times[after..], values).filter(|peak| peak.value > 0.0)
    };
    let top = peak(force);
    let rest = trace::baseline(times, force, stimulus).unwrap_or_default();
    let half = top.and_then(|top| {
        let level = f64::midpoint(top.value, rest);
        Some(trace::falls_through(times, force, level, top.time)? - top.time)
    });
    let row = |name, value: Option<f64>, unit, definition| {
        Metric::new(name, value.ok_or(Missing::NoRise), unit, definition)
    };
    let largest = |name, of, unit, definition| {
        row(name, signal(of).and_then(|values| Some(peak(values)?.value)), unit, definition)
    };
    vec![
        row(
            "peak_traction_force",
            top.map(|top| top.value),
            "nN",
            "largest sum of the absolute forces of the cell on the gel",
        ),
        row(
            "time_to_peak_traction_force",
            top.map(|top| top.time - stimulus),
            "ms",
            "from the stimulus to the largest sum of forces",
        ),
        row(
            "traction_relaxation_time_50",
            half,
            "ms",
            "from the largest sum of forces to half way back to rest",
        ),
        largest(
            "peak_axial_force",
            AXIAL_FORCE,
            "nN",
            "largest force of half the cell on the gel along the long axis",
        ),
        largest(
            "peak_contractile_moment",
            CONTRACTILE_MOMENT,
            "fJ",
            "largest contractile moment: minus the sum of force times place at rest",
        ),
        largest("peak_gel_energy", GEL_ENERGY, "fJ", "largest elastic energy of the gel"),
    ]
}
