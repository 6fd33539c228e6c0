//! Metrics of an action potential, per beat.

use super::pulse::{Pulse, Top};
use super::rows::{Context, between, recorded, row};
use super::{Metric, Missing, Reading};
use super::{rest, trace};

/// Metrics of one action potential from a potential over time (ms), in any unit.
///
/// Durations run from the stimulus to repolarisation by 30, 50, 80 and 90 % of the way from the peak
/// to the potential before the stimulus. `unit` names the potential's unit: `mV`, or nothing.
pub fn metrics(times: &[f64], potential: &[f64], stimulus: f64, unit: &'static str) -> Vec<Metric> {
    let rest = trace::baseline(times, potential, stimulus);
    let stimuli = [stimulus, f64::INFINITY];
    above(times, potential, stimuli, unit, rest, rest::BEFORE_STIMULUS)
}

/// Like [`metrics`], with a known resting value, for an action potential during which another
/// stimulus may come: upstroke and peak are searched between the stimulus and the next one,
/// repolarisation in all samples.
pub fn above(
    times: &[f64],
    potential: &[f64],
    [stimulus, next]: [f64; 2],
    unit: &'static str,
    rest: Option<f64>,
    rest_is: &'static str,
) -> Vec<Metric> {
    let heights: Vec<f64> =
        rest.map(|rest| potential.iter().map(|v| v - rest).collect()).unwrap_or_default();
    let own = times.partition_point(|time| *time < next);
    let before = &heights[..own.min(heights.len())];
    let upstroke = Pulse::new(&times[..own], before, stimulus, Top::Sample);
    let context = Context { stimulus: Some(stimulus), onset: None, rest: rest_is };
    let mut rows = of_pulse(&upstroke.followed_by(times, &heights), rest, unit, &context);
    // The sample itself, to avoid rounding of rest and height.
    let peak = trace::largest(&times[..own], &potential[..own]);
    if let Some(peak) = peak.filter(|_| upstroke.peak().is_ok()) {
        (rows[1].value, rows[1].missing) = (Some(peak.value), None);
    }
    rows
}

const MEASURED_UPSTROKE: &str = "largest slope of the upstroke: of the least-squares cubic over upstroke_window, between two samples where these are \
     too few";

/// Further metrics of a measured upstroke: the time over which its slope was read; and, for a cell
/// without stimuli, the maximum diastolic potential after it and the time since the previous
/// upstroke.
pub(super) fn of_upstroke(
    window: Reading,
    spontaneous: Option<Reading>,
    unit: &'static str,
) -> Vec<Metric> {
    let mut rows = vec![row(
        "upstroke_window",
        window,
        "ms",
        "time over which the largest slope was read: a quarter of the time that the whole upstroke would take at that \
         slope, up to 0.7 of it in noise",
    )];
    if let Some(diastolic) = spontaneous {
        rows.push(row(
            "maximum_diastolic_potential",
            diastolic,
            unit,
            "lowest potential between this action potential and the next, as a mean over a fiftieth of the cycle",
        ));
        rows.push(row(
            "cycle_length",
            Err(Missing::First),
            "ms",
            "from the steepest rise of the previous action potential",
        ));
    }
    rows
}

/// The durations: part of the repolarisation, name, and definition with a stimulus and without.
const DURATIONS: [(f64, &str, [&str; 2]); 4] = [
    (
        0.3,
        "action_potential_duration_30",
        [
            "from the stimulus to 30 % repolarisation",
            "from the steepest rise to 30 % repolarisation",
        ],
    ),
    (
        0.5,
        "action_potential_duration_50",
        [
            "from the stimulus to 50 % repolarisation",
            "from the steepest rise to 50 % repolarisation",
        ],
    ),
    (
        0.8,
        "action_potential_duration_80",
        [
            "from the stimulus to 80 % repolarisation",
            "from the steepest rise to 80 % repolarisation",
        ],
    ),
    (
        0.9,
        "action_potential_duration_90",
        [
            "from the stimulus to 90 % repolarisation",
            "from the steepest rise to 90 % repolarisation",
        ],
    ),
];

/// Metrics of an action potential from the pulse of its height above rest; durations run from the
/// stimulus, or from the steepest rise if no stimulus is known.
pub fn of_pulse(
    pulse: &Pulse,
    rest: Option<f64>,
    unit: &'static str,
    context: &Context,
) -> Vec<Metric> {
    let peak = pulse.peak();
    let upstroke = pulse.upstroke();
    let start = match context.stimulus {
        Some(stimulus) => Ok(stimulus),
        None => upstroke.map(|upstroke| upstroke.time),
    };
    let duration = |part: f64| between(pulse.falls(1.0 - part), start);
    let mut rows = vec![
        row("resting_potential", recorded(rest), unit, context.rest),
        row(
            "peak_potential",
            recorded(rest).and_then(|rest| Ok(rest + peak?.value)),
            unit,
            "largest potential",
        ),
    ];
    rows.extend(DURATIONS.map(|(part, name, definitions)| {
        row(name, duration(part), "ms", definitions[usize::from(context.stimulus.is_none())])
    }));
    rows.extend([
        row("triangulation", between(duration(0.9), duration(0.3)), "ms", "APD90 - APD30"),
        row(
            "maximum_upstroke_velocity",
            upstroke.map(|point| point.value),
            match unit {
                "mV" => "mV/ms",
                "a.u." => "a.u./ms",
                _ => "1/ms",
            },
            match (context.onset, context.stimulus) {
                (Some(_), _) => MEASURED_UPSTROKE,
                (None, Some(_)) => {
                    "largest slope between samples, an instantaneous stimulus included"
                }
                (None, None) => "largest slope between samples",
            },
        ),
    ]);
    if context.onset.is_some() {
        rows.push(row(
            "action_potential_amplitude",
            peak.map(|peak| peak.value),
            unit,
            "peak above rest",
        ));
        rows.push(row(
            "time_of_upstroke",
            upstroke.map(|at| at.time),
            "ms",
            "time of the steepest rise",
        ));
    }
    rows
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::value;

    #[test]
    fn durations_of_a_trapezoid_have_their_closed_forms() {
        let times: Vec<f64> = (0..=500).map(f64::from).collect();
        let potential: Vec<f64> = times
            .iter()
            .map(|&t| match t {
                t if t < 50.0 => -80.0,
                t if t <= 52.0 => -80.0 + 60.0 * (t - 50.0),
                t if t < 152.0 => 40.0,
                t if t < 252.0 => 40.0 - 1.2 * (t - 152.0),
                _ => -80.0,
            })
            .collect();
        let metrics = metrics(&times, &potential, 50.0, "mV");
        for (name, expected) in [
            ("resting_potential", -80.0),
            ("peak_potential", 40.0),
            ("action_potential_duration_30", 132.0),
            ("action_potential_duration_50", 152.0),
            ("action_potential_duration_90", 192.0),
            ("triangulation", 60.0),
            ("maximum_upstroke_velocity", 60.0),
        ] {
            let measured = value(&metrics, name).unwrap();
            assert!((measured - expected).abs() < 1e-9, "{name}: {measured} not {expected}");
        }
    }
}
