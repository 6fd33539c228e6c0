//! How a thick cell changes its thickness, its volume and the lengths of its faces in a beat.

use super::{Metric, Missing, trace};
use crate::recording::{LENGTH_BOTTOM, LENGTH_TOP, THICKNESS, VOLUME};

/// The metrics of one beat of a thick cell, from the signals of its thickness; empty where they were not recorded, as of a flat
/// cell.
///
/// # Example
/// ```
/// use myospring::analysis::{thickness, value};
/// let times: Vec<f64> = (0..=200).map(f64::from).collect();
/// let rise = |from: f64, by: f64| -> Vec<f64> {
///     times.iter().map(|t| from + by * (1.0 - ((t - 80.0).abs() / 60.0).min(1.0))).collect()
/// };
/// let (thick, volume, length) = (rise(8.0, 0.4), rise(9000.0, -45.0), rise(100.0, -12.0));
/// let signal = |name: &str| match name {
///     "thickness" => Some(&thick[..]),
///     "volume" => Some(&volume[..]),
///     _ => Some(&length[..]),
/// };
/// let metrics = thickness::metrics(&times, signal, 10.0);
/// assert_eq!(value(&metrics, "thickness_at_rest"), Some(8.0));
/// assert!((value(&metrics, "peak_thickening").unwrap() - 5.0).abs() < 1e-9);
/// assert!((value(&metrics, "volume_change").unwrap() + 0.5).abs() < 1e-9);
/// assert!((value(&metrics, "bottom_shortening").unwrap() - 12.0).abs() < 1e-9);
/// ```
pub fn metrics<'a>(
    times: &[f64],
    signal: impl Fn(&str) -> Option<&'a [f64]>,
    stimulus: f64,
) -> Vec<Metric> {
    if signal(THICKNESS).is_none() {
        return Vec::new();
    }
    let after = times.partition_point(|time| *time < stimulus);
    let rest = |name: &str| {
        let values = signal(name)?;
        trace::baseline(times, values, stimulus).or(values.first().copied())
    };
    // Per cent of the value at rest, where it is furthest from that in a direction, or in both.
    let change = |name: &str, size: fn(f64) -> f64| {
        let (rest, values) = (rest(name)?, signal(name)?.get(after..)?);
        let changes = values.iter().map(|value| 100.0 * (value / rest - 1.0));
        changes.max_by(|a, b| size(*a).total_cmp(&size(*b)))
    };
    let row = |name, value: Option<f64>, unit, definition| {
        Metric::new(name, value.ok_or(Missing::NoRise), unit, definition)
    };
    let shorter = |name| change(name, |change| -change).map(|change| -change);
    vec![
        row(
            "thickness_at_rest",
            rest(THICKNESS),
            "um",
            "mean thickness before the stimulus: volume over the area seen from above",
        ),
        row(
            "peak_thickening",
            change(THICKNESS, |change| change),
            "%",
            "largest increase of the mean thickness",
        ),
        row(
            "volume_change",
            change(VOLUME, f64::abs),
            "%",
            "largest change of the volume, with its sign",
        ),
        row("top_shortening", shorter(LENGTH_TOP), "%", "largest shortening of the upper face"),
        row(
            "bottom_shortening",
            shorter(LENGTH_BOTTOM),
            "%",
            "largest shortening of the lower face",
        ),
    ]
}
