//! Metrics of curves whose numbers are known in closed form, as a table: metric, closed form, how far frames let it be off.

use myospring::analysis::curve::{CurveOptions, analyse};
use myospring::analysis::kind::Kind;
use std::f64::consts::PI;

/// A beat is `A sin^2(pi t / w)`: 10 % of 120 um, over 400 ms, each second, 30 ms after its stimulus.
const HEIGHT_PCT: f64 = 10.0;
const WIDTH_MS: f64 = 400.0;
const DELAY_MS: f64 = 30.0;

/// Time from the foot until a part of the height is reached, ms.
fn until(part: f64) -> f64 {
    part.sqrt().asin() * WIDTH_MS / PI
}

/// Metric, its closed form, and its tolerance: what rounding and smoothing make of it, and what the straight line between
/// two frames does, which grows with the square of their distance (per ms^2).
struct Row(&'static str, fn() -> f64, [f64; 2]);

const ROWS: [Row; 9] = [
    Row("peak_shortening", || HEIGHT_PCT, [5e-3, 1e-4]),
    Row("resting_length", || 120.0, [1e-3, 5e-5]),
    Row("time_to_peak_from_stimulus", || DELAY_MS + 0.5 * WIDTH_MS, [0.05, 1e-3]),
    Row("rise_time_10_90", || until(0.9) - until(0.1), [0.05, 6e-3]),
    Row("contraction_duration_50", || 0.5 * WIDTH_MS, [0.05, 1e-3]),
    Row("relaxation_time_50", || 0.25 * WIDTH_MS, [0.05, 2e-3]),
    Row("relaxation_time_90", || 0.5 * WIDTH_MS - until(0.1), [0.05, 3e-3]),
    Row("maximum_shortening_rate", || HEIGHT_PCT / 100.0 * PI / WIDTH_MS * 1e3, [1e-3, 5e-5]),
    Row("area_under_curve", || 0.5 * HEIGHT_PCT * WIDTH_MS, [2.0, 0.01]),
];

#[test]
fn metrics_have_their_closed_forms_at_any_frame_rate() {
    for frames_per_s in [50.0, 100.0, 250.0, 1000.0] {
        let step = 1e3 / frames_per_s;
        let times: Vec<f64> = (0..(5000.0 / step) as usize).map(|at| at as f64 * step).collect();
        let length = |t: &f64| {
            let since = (t - 300.0 - DELAY_MS).rem_euclid(1000.0);
            let part = if since < WIDTH_MS { (PI * since / WIDTH_MS).sin().powi(2) } else { 0.0 };
            120.0 * (1.0 - HEIGHT_PCT / 100.0 * part)
        };
        let length: Vec<f64> = times.iter().map(length).collect();
        let stimuli_ms = (0..5).map(|beat| 300.0 + 1000.0 * f64::from(beat)).collect();
        let options = CurveOptions { stimuli_ms, ..CurveOptions::default() };
        let found = analyse(&times, &length, Kind::Length, "um", &options).unwrap();
        for Row(name, closed_form, [fixed, per_ms2]) in ROWS {
            let (ours, known) = (found.mean(name).unwrap(), closed_form());
            let allowed = fixed + per_ms2 * step * step;
            let off = (ours - known).abs();
            assert!(off <= allowed, "{name} at {frames_per_s} /s: {ours}, not {known} ({off:.1e})");
        }
    }
}
