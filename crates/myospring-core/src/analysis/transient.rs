//! Metrics of a calcium transient, or of a signal of calcium such as fluorescence, per beat.

use super::Metric;
use super::kind::Kind;
use super::pulse::Pulse;
use super::rows::{Context, between, peak_times, per_second, row, times_ms};

/// Metrics of a transient, from the pulse of its height above its baseline; the baseline may drift
/// from the diastolic level at the beginning to another one under the peak.
pub fn of_pulse(
    pulse: &Pulse,
    [rest, under]: [f64; 2],
    kind: Kind,
    unit: &'static str,
    context: &Context,
) -> Vec<Metric> {
    let peak = pulse.peak();
    let fastest = |sign: f64| pulse.fastest(sign).map(|top| 1e3 * top.value);
    let mut rows = vec![
        row("diastolic_level", Ok(rest), unit, context.rest),
        row("systolic_level", peak.map(|peak| under + peak.value), unit, "largest value"),
        row(
            "transient_amplitude",
            peak.map(|peak| peak.value),
            unit,
            "systolic above diastolic level",
        ),
    ];
    if kind != Kind::Calcium && under > 0.0 {
        rows.push(row(
            "amplitude_over_rest",
            peak.map(|peak| peak.value / under),
            "",
            "(F - F0) / F0 at the peak, F0 the baseline there; meaningful only if the background was subtracted",
        ));
    }
    rows.extend(timing(pulse, context));
    rows.extend([
        row("maximum_rise_rate", fastest(1.0), per_second(unit), "largest slope of the rise"),
        row(
            "maximum_decay_rate",
            fastest(-1.0),
            per_second(unit),
            "largest slope of the fall, as a positive number",
        ),
        row(
            "decay_time_constant",
            pulse.time_constant(),
            "ms",
            "slope of the logarithm between 50 % and 90 % decayed",
        ),
        row(
            "area_under_curve",
            pulse.area(),
            times_ms(unit),
            "integral above the diastolic level over the beat",
        ),
    ]);
    rows
}

/// Times of a transient.
fn timing(pulse: &Pulse, context: &Context) -> Vec<Metric> {
    let peak = pulse.peak().map(|peak| peak.time);
    let mut rows = peak_times(
        peak,
        context,
        [
            ["time_of_peak", "time of the largest value on the clock of the recording"],
            ["time_to_peak_from_stimulus", "from the stimulus to the peak (IonOptix)"],
        ],
        "time_to_peak_from_onset",
    );
    rows.extend([
        row(
            "rise_time_10_90",
            between(pulse.rises(0.9), pulse.rises(0.1)),
            "ms",
            "from 10 % to 90 % of the amplitude",
        ),
        row(
            "decay_time_50",
            between(pulse.falls(0.5), peak),
            "ms",
            "from the peak until 50 % decayed",
        ),
        row(
            "decay_time_90",
            between(pulse.falls(0.1), peak),
            "ms",
            "from the peak until 90 % decayed",
        ),
        row(
            "transient_duration_50",
            pulse.duration(0.5),
            "ms",
            "time above 50 % of the amplitude (CaTD50)",
        ),
        row(
            "transient_duration_80",
            pulse.duration(0.2),
            "ms",
            "time above 20 % of the amplitude (CaTD80)",
        ),
        row(
            "transient_duration_90",
            pulse.duration(0.1),
            "ms",
            "time above 10 % of the amplitude (CaTD90)",
        ),
    ]);
    rows
}
