//! Metrics of a contraction, per beat.
//!
//! Two conventions for the time to peak are in use: from the stimulus (`IonOptix`) and from the
//! crossing of 10 % of the peak (`MUSCLEMOTION`); both are given, with different names.

use super::pulse::{Pulse, Top};
use super::rows::{Context, between, peak_times, per_second, recorded, row, times_ms};
use super::{Metric, Missing};
use super::{rest, trace};

/// Least peak shortening of a contraction: a millionth of the length.
const LEAST: f64 = 1e-6;

/// Metrics of one beat from its length (um) over time (ms) and the time of its stimulus.
///
/// The baseline is the mean of the samples before the stimulus. Levels of 10, 50 and 90 % are parts
/// of the peak shortening. A value is `None` if the beat does not reach it.
///
/// # Example
/// ```
/// use myospring::analysis::{contraction, value};
/// let times: Vec<f64> = (0..=600).map(f64::from).collect();
/// // A bell of 12 % shortening, 150 ms after the stimulus at 20 ms, 50 ms broad.
/// let bell = |t: f64| (-0.5 * ((t - 170.0) / 50.0_f64).powi(2)).exp();
/// let length: Vec<f64> = times.iter().map(|&t| 100.0 * (1.0 - 0.12 * bell(t))).collect();
/// let metrics = contraction::metrics(&times, &length, 20.0);
/// assert!((value(&metrics, "peak_shortening").unwrap() - 12.0).abs() < 0.1);
/// assert!((value(&metrics, "time_to_peak_from_stimulus").unwrap() - 150.0).abs() < 0.1);
/// ```
pub fn metrics(times: &[f64], length: &[f64], stimulus: f64) -> Vec<Metric> {
    let rest = trace::baseline(times, length, stimulus);
    above(times, length, stimulus, rest, rest::BEFORE_STIMULUS)
}

/// Like [`metrics`], with a known length at rest.
pub fn above(
    times: &[f64],
    length: &[f64],
    stimulus: f64,
    rest: Option<f64>,
    rest_is: &'static str,
) -> Vec<Metric> {
    let shortening: Vec<f64> =
        rest.map(|rest| length.iter().map(|l| 1.0 - l / rest).collect()).unwrap_or_default();
    let pulse = Pulse::new(times, &shortening, stimulus, Top::Vertex).above(LEAST);
    let context = Context { stimulus: Some(stimulus), onset: None, rest: rest_is };
    of_length(&pulse, rest, "um", &context)
}

/// Metrics of a length, from the pulse of its shortening relative to the length at rest.
pub fn of_length(
    pulse: &Pulse,
    rest: Option<f64>,
    unit: &'static str,
    context: &Context,
) -> Vec<Metric> {
    let peak = pulse.peak();
    let mut rows = vec![
        row("resting_length", recorded(rest), unit, context.rest),
        row(
            "minimum_length",
            recorded(rest).and_then(|rest| Ok(rest * (1.0 - peak?.value))),
            unit,
            "length at the peak of shortening",
        ),
        row(
            "peak_shortening",
            peak.map(|peak| 100.0 * peak.value),
            "%",
            "largest (resting length - length) / resting length",
        ),
        row(
            "peak_lengthening",
            pulse.lowest().map(|least| (-100.0 * least).max(0.0)),
            "%",
            "largest (length - resting length) / resting length, 0 if it is never longer",
        ),
    ];
    rows.extend(timing(pulse, context));
    rows.extend(rates(pulse, rest, unit));
    rows.extend([
        row(
            "relaxation_time_constant",
            pulse.time_constant(),
            "ms",
            "slope of log shortening between 50 % and 90 % relengthened",
        ),
        row(
            "area_under_curve",
            pulse.area().map(|area| 100.0 * area),
            "% ms",
            "integral of the shortening over the beat",
        ),
        row(
            "residual_shortening",
            pulse.last().map(|last| 100.0 * last),
            "%",
            "shortening at the end of the beat",
        ),
    ]);
    let without_peak = rows.iter_mut().filter(|row| row.missing == Some(Missing::NoRise));
    without_peak.for_each(|row| row.lose(Missing::NoShortening));
    rows
}

/// Times of a contraction.
fn timing(pulse: &Pulse, context: &Context) -> Vec<Metric> {
    let peak = pulse.peak().map(|peak| peak.time);
    let on_clock = "time of the largest shortening on the clock of the run or recording";
    let from_stimulus = "from the stimulus to the largest shortening (IonOptix)";
    let mut rows = peak_times(
        peak,
        context,
        [["time_of_peak", on_clock], ["time_to_peak_from_stimulus", from_stimulus]],
        "time_to_peak_from_onset",
    );
    rows.extend([
        row(
            "time_to_peak_from_10_percent",
            between(peak, pulse.rises(0.1)),
            "ms",
            "from 10 % of the peak shortening to the peak (MUSCLEMOTION)",
        ),
        row(
            "rise_time_10_90",
            between(pulse.rises(0.9), pulse.rises(0.1)),
            "ms",
            "from 10 % to 90 % of the peak shortening",
        ),
        row(
            "relaxation_time_50",
            between(pulse.falls(0.5), peak),
            "ms",
            "from the peak until 50 % relengthened",
        ),
        row(
            "relaxation_time_90",
            between(pulse.falls(0.1), peak),
            "ms",
            "from the peak until 90 % relengthened",
        ),
        row(
            "contraction_duration_10",
            pulse.duration(0.1),
            "ms",
            "time above 10 % of the peak shortening",
        ),
        row(
            "contraction_duration_50",
            pulse.duration(0.5),
            "ms",
            "time above 50 % of the peak shortening",
        ),
        row(
            "contraction_duration_90",
            pulse.duration(0.9),
            "ms",
            "time above 90 % of the peak shortening",
        ),
    ]);
    rows
}

/// Largest rates of shortening and relengthening.
fn rates(pulse: &Pulse, rest: Option<f64>, unit: &'static str) -> Vec<Metric> {
    // 1/ms to 1/s
    let fastest = |sign: f64| pulse.fastest(sign).map(|top| 1e3 * top.value);
    let velocity = |sign: f64| Ok(fastest(sign)? * recorded(rest)?);
    let mut rows = vec![
        row(
            "maximum_shortening_rate",
            fastest(1.0),
            "L0/s",
            "largest rate of shortening per resting length",
        ),
        row(
            "shortening_rate_over_peak",
            pulse.peak().and_then(|peak| Ok(fastest(1.0)? / peak.value)),
            "1/s",
            "largest rate of shortening over the peak shortening: the shape of a beat, whatever its size",
        ),
        row(
            "maximum_relengthening_rate",
            fastest(-1.0),
            "L0/s",
            "largest rate of relengthening per resting length",
        ),
    ];
    // For a dimensionless length, velocities equal these rates.
    if !unit.is_empty() {
        rows.extend([
            row(
                "maximum_shortening_velocity",
                velocity(1.0),
                per_second(unit),
                "largest velocity of shortening, end to end",
            ),
            row(
                "maximum_relengthening_velocity",
                velocity(-1.0),
                per_second(unit),
                "largest velocity of relengthening, end to end",
            ),
        ]);
    }
    rows
}

/// Metrics of a contraction without known length: a shortening in %, a displacement, an amplitude
/// in any unit.
pub fn of_motion(pulse: &Pulse, rest: f64, unit: &'static str, context: &Context) -> Vec<Metric> {
    let peak = pulse.peak().map(|peak| peak.value);
    let fastest = |sign: f64| pulse.fastest(sign).map(|top| 1e3 * top.value);
    let mut rows = vec![
        row("baseline", Ok(rest), unit, context.rest),
        row("peak_amplitude", peak, unit, "largest value above the baseline"),
    ];
    rows.extend(timing(pulse, context));
    rows.extend([
        row(
            "maximum_contraction_rate",
            fastest(1.0),
            per_second(unit),
            "largest slope of the rise",
        ),
        row(
            "shortening_rate_over_peak",
            peak.and_then(|peak| Ok(fastest(1.0)? / peak)),
            "1/s",
            "largest slope of the rise over the peak: the shape of a beat, whatever its size",
        ),
        row(
            "maximum_relaxation_rate",
            fastest(-1.0),
            per_second(unit),
            "largest slope of the fall, as a positive number",
        ),
        row(
            "relaxation_time_constant",
            pulse.time_constant(),
            "ms",
            "slope of the logarithm between 50 % and 90 % relaxed",
        ),
        row(
            "area_under_curve",
            pulse.area(),
            times_ms(unit),
            "integral above the baseline over the beat",
        ),
        row(
            "residual_amplitude",
            pulse.last(),
            unit,
            "value above the baseline at the end of the beat",
        ),
    ]);
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::value;

    /// Shortening of 10 % that rises linearly for 100 ms from 50 ms on, then decays with 80 ms.
    fn ramp_and_decay() -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..=2000).map(|i| f64::from(i) * 0.5).collect();
        let length = times
            .iter()
            .map(|&t| {
                let part = if t < 50.0 {
                    0.0
                } else if t < 150.0 {
                    (t - 50.0) / 100.0
                } else {
                    (-(t - 150.0) / 80.0).exp()
                };
                120.0 * (1.0 - 0.1 * part)
            })
            .collect();
        (times, length)
    }

    #[test]
    fn metrics_of_a_ramp_and_decay_have_their_closed_forms() {
        let (times, length) = ramp_and_decay();
        let metrics = metrics(&times, &length, 50.0);
        for (name, expected, tolerance) in [
            ("resting_length", 120.0, 1e-9),
            ("minimum_length", 108.0, 0.05),
            ("peak_shortening", 10.0, 0.05),
            ("time_to_peak_from_stimulus", 100.0, 0.5),
            ("time_to_peak_from_10_percent", 90.0, 0.5),
            ("rise_time_10_90", 80.0, 0.1),
            ("relaxation_time_50", 80.0 * 2.0_f64.ln(), 0.5),
            ("relaxation_time_90", 80.0 * 10.0_f64.ln(), 0.5),
            ("contraction_duration_50", 50.0 + 80.0 * 2.0_f64.ln(), 0.5),
            ("maximum_shortening_rate", 1.0, 1e-6),
            ("maximum_shortening_velocity", 120.0, 1e-4),
            ("maximum_relengthening_rate", 0.1 / 80.0 * 1e3, 0.01),
            ("relaxation_time_constant", 80.0, 1e-6),
            ("area_under_curve", 10.0 * (50.0 + 80.0), 1.0),
        ] {
            let measured = value(&metrics, name).unwrap();
            assert!((measured - expected).abs() <= tolerance, "{name}: {measured} not {expected}");
        }
    }

    #[test]
    fn a_cell_that_lengthens_says_by_how_much() {
        let metrics = metrics(&[0.0, 1.0, 2.0, 3.0], &[100.0, 100.0, 104.0, 100.0], 1.0);
        assert!((value(&metrics, "peak_lengthening").unwrap() - 4.0).abs() < 1e-9);
        assert_eq!(value(&metrics, "peak_shortening"), None);
        assert_eq!(value(&metrics, "time_to_peak_from_stimulus"), None);
    }

    #[test]
    fn a_beat_that_is_cut_short_has_no_relaxation() {
        let (times, length) = ramp_and_decay();
        let metrics = metrics(&times[..320], &length[..320], 50.0);
        assert!(value(&metrics, "peak_shortening").is_some());
        assert_eq!(value(&metrics, "relaxation_time_90"), None);
    }

    #[test]
    fn a_cell_that_never_shortens_has_no_peak() {
        let metrics = metrics(&[0.0, 1.0, 2.0], &[100.0, 100.0 - 1e-12, 100.0], 0.0);
        assert_eq!(value(&metrics, "peak_shortening"), None);
        assert_eq!(value(&metrics, "peak_lengthening"), Some(0.0));
        assert!(value(&metrics, "resting_length").is_some());
    }
}
