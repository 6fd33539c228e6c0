//! Metrics of a twitch: active tension or force, per beat.

use super::Metric;
use super::pulse::Pulse;
use super::rows::{Context, between, peak_times, per_second, row, times_ms};

/// Metrics of a force or tension, from the pulse of its height above rest.
pub fn of_pulse(pulse: &Pulse, rest: f64, unit: &'static str, context: &Context) -> Vec<Metric> {
    let peak = pulse.peak();
    let time = peak.map(|peak| peak.time);
    let fastest = |sign: f64| pulse.fastest(sign).map(|top| 1e3 * top.value);
    let mut rows = vec![
        row("resting_tension", Ok(rest), unit, context.rest),
        row("peak_tension", peak.map(|peak| rest + peak.value), unit, "largest tension"),
        row(
            "developed_tension",
            peak.map(|peak| peak.value),
            unit,
            "largest tension above that at rest",
        ),
    ];
    let on_clock = "time of the largest tension on the clock of the run or recording";
    rows.extend(peak_times(
        time,
        context,
        [
            ["time_of_peak_tension", on_clock],
            ["time_to_peak_tension", "from the stimulus to the largest tension"],
        ],
        "time_to_peak_tension_from_onset",
    ));
    rows.extend([
        row(
            "tension_rise_time_10_90",
            between(pulse.rises(0.9), pulse.rises(0.1)),
            "ms",
            "from 10 % to 90 % of the developed tension",
        ),
        row(
            "tension_relaxation_time_50",
            between(pulse.falls(0.5), time),
            "ms",
            "from the peak until the developed tension has fallen by 50 %",
        ),
        row(
            "tension_relaxation_time_90",
            between(pulse.falls(0.1), time),
            "ms",
            "from the peak until the developed tension has fallen by 90 %",
        ),
        row(
            "twitch_duration_50",
            pulse.duration(0.5),
            "ms",
            "time above 50 % of the developed tension",
        ),
        row(
            "maximum_tension_rate",
            fastest(1.0),
            per_second(unit),
            "largest slope of the rise, (dF/dt)max",
        ),
        row(
            "maximum_tension_fall_rate",
            fastest(-1.0),
            per_second(unit),
            "largest slope of the fall, as a positive number, -(dF/dt)min",
        ),
        row(
            "tension_time_constant",
            pulse.time_constant(),
            "ms",
            "slope of the logarithm of the developed tension between 50 % and 10 % of its peak",
        ),
        row(
            "tension_time_integral",
            pulse.area(),
            times_ms(unit),
            "integral of the developed tension over the beat",
        ),
    ]);
    rows
}
