//! Metrics of an action potential, per beat.

use super::Metric;
use super::trace::{self, Point};

/// Metrics of one action potential from a potential over time (ms), in any unit.
///
/// Durations run from the stimulus to repolarisation by 30, 50, 80 and 90 % of the way from the peak
/// to the potential before the stimulus. `unit` names the potential's unit: `mV`, or nothing.
pub fn metrics(times: &[f64], potential: &[f64], stimulus: f64, unit: &'static str) -> Vec<Metric> {
    let rest = trace::baseline(times, potential, stimulus);
    let peak = trace::largest(times, potential).filter(|peak| Some(peak.value) > rest);
    let duration = |part: f64| {
        let Point { time, value } = peak?;
        let level = value - part * (value - rest?);
        Some(trace::falls_through(times, potential, level, time)? - stimulus)
    };
    let (middles, rates) = trace::slopes(times, potential);
    let upstroke = trace::largest(&middles, &rates).filter(|_| peak.is_some());
    let row = |name, value, unit, definition| Metric { name, value, unit, definition };
    vec![
        row("resting_potential", rest, unit, "mean potential before the stimulus"),
        row("peak_potential", peak.map(|peak| peak.value), unit, "largest potential"),
        row(
            "action_potential_duration_30",
            duration(0.3),
            "ms",
            "from the stimulus to 30 % repolarisation",
        ),
        row(
            "action_potential_duration_50",
            duration(0.5),
            "ms",
            "from the stimulus to 50 % repolarisation",
        ),
        row(
            "action_potential_duration_80",
            duration(0.8),
            "ms",
            "from the stimulus to 80 % repolarisation",
        ),
        row(
            "action_potential_duration_90",
            duration(0.9),
            "ms",
            "from the stimulus to 90 % repolarisation",
        ),
        row(
            "triangulation",
            Some(()).and_then(|()| Some(duration(0.9)? - duration(0.3)?)),
            "ms",
            "APD90 - APD30",
        ),
        row(
            "maximum_upstroke_velocity",
            upstroke.map(|point| point.value),
            if unit == "mV" { "mV/ms" } else { "1/ms" },
            "largest slope between samples, an instantaneous stimulus included",
        ),
    ]
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
