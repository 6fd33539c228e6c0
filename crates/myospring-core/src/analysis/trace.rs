//! Peaks, crossings and slopes of a sampled curve.

use std::ops::Range;

/// A point of a curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Time, ms.
    pub time: f64,
    /// Value in the curve's unit.
    pub value: f64,
}

/// The curve's maximum: the vertex of the parabola through the largest sample and its neighbours;
/// if the curve is straight on both sides, the point where the two lines meet. `None` if no sample
/// is finite.
///
/// # Example
/// ```
/// use myospring::analysis::trace::peak;
/// let times: Vec<f64> = (0..10).map(f64::from).collect();
/// let values: Vec<f64> = times.iter().map(|t| 4.0 - (t - 3.3) * (t - 3.3)).collect();
/// let top = peak(&times, &values).unwrap();
/// assert!((top.time - 3.3).abs() < 1e-12 && (top.value - 4.0).abs() < 1e-12);
/// ```
pub fn peak(times: &[f64], values: &[f64]) -> Option<Point> {
    let top = index_of_largest(values)?;
    let sample = Point { time: times[top], value: values[top] };
    if top == 0 || top + 1 == values.len() {
        return Some(sample);
    }
    if let Some(corner) = corner(times, values, top) {
        return Some(corner);
    }
    let (before, after) = (times[top] - times[top - 1], times[top + 1] - times[top]);
    let (down, up) = (values[top] - values[top - 1], values[top + 1] - values[top]);
    // Newton's form of the parabola through the three samples.
    let curvature = (up / after - down / before) / (before + after);
    let slope = (down / before * after + up / after * before) / (before + after);
    if curvature >= 0.0 || !curvature.is_finite() {
        return Some(sample);
    }
    let shift = -0.5 * slope / curvature;
    Some(Point { time: sample.time + shift, value: sample.value + 0.5 * slope * shift })
}

/// Largest bend between three samples of a straight side, as a part of the whole bend at the
/// corner; for a parabola it would be a third.
const STRAIGHT: f64 = 0.05;

/// Intersection of the lines through the samples on both sides of a top, if the curve is straight
/// there.
fn corner(times: &[f64], values: &[f64], top: usize) -> Option<Point> {
    if top < 3 || top + 3 >= values.len() {
        return None;
    }
    let slope = |at: usize| (values[at + 1] - values[at]) / (times[at + 1] - times[at]);
    let (left, right) = (slope(top - 2), slope(top + 1));
    let bend = left - right;
    let bent = (left - slope(top - 3)).abs().max((right - slope(top + 2)).abs());
    if left <= 0.0 || right >= 0.0 || bent > STRAIGHT * bend {
        return None;
    }
    let time =
        (values[top + 1] - values[top - 1] + left * times[top - 1] - right * times[top + 1]) / bend;
    let value = values[top - 1] + left * (time - times[top - 1]);
    // Lines through sides that are not quite straight may meet slightly below a corner at the
    // sample itself.
    let least = values[top] - STRAIGHT * bend * (times[top + 1] - times[top - 1]);
    let between = (times[top - 1]..=times[top + 1]).contains(&time) && value >= least;
    between.then_some(Point { time, value: value.max(values[top]) })
}

/// The largest sample, for curves with corners that no parabola fits (an upstroke). `None` if no
/// sample is finite.
pub fn largest(times: &[f64], values: &[f64]) -> Option<Point> {
    index_of_largest(values).map(|top| Point { time: times[top], value: values[top] })
}

fn index_of_largest(values: &[f64]) -> Option<usize> {
    (0..values.len())
        .filter(|&i| values[i].is_finite())
        .reduce(|best, i| if values[i] > values[best] { i } else { best })
}

/// First time from `from` (ms) on at which the curve rises through `level`, interpolated linearly.
pub fn rises_through(times: &[f64], values: &[f64], level: f64, from: f64) -> Option<f64> {
    crossing(times, values, from, |a, b| a < level && b >= level, level)
}

/// Last time from `from` to `until` (ms) at which the curve rises through `level`, interpolated
/// linearly.
pub fn last_rise_through(
    times: &[f64],
    values: &[f64],
    level: f64,
    from: f64,
    until: f64,
) -> Option<f64> {
    let last = times.partition_point(|time| *time < until).min(times.len().checked_sub(1)?);
    (1..=last).rev().take_while(|&i| times[i] >= from).find_map(|i| {
        let (a, b) = (values[i - 1], values[i]);
        let time = times[i - 1] + (level - a) / (b - a) * (times[i] - times[i - 1]);
        (a < level && b >= level && (from..=until).contains(&time)).then_some(time)
    })
}

/// First time from `from` (ms) on at which the curve falls through `level`, interpolated linearly.
pub fn falls_through(times: &[f64], values: &[f64], level: f64, from: f64) -> Option<f64> {
    crossing(times, values, from, |a, b| a > level && b <= level, level)
}

fn crossing(
    times: &[f64],
    values: &[f64],
    from: f64,
    crosses: impl Fn(f64, f64) -> bool,
    level: f64,
) -> Option<f64> {
    (1..times.len()).filter(|&i| times[i] >= from).find_map(|i| {
        let (a, b) = (values[i - 1], values[i]);
        if !crosses(a, b) {
            return None;
        }
        let time = times[i - 1] + (level - a) / (b - a) * (times[i] - times[i - 1]);
        (time >= from).then_some(time)
    })
}

/// Slopes between neighbouring samples, per ms, at the middle times.
pub fn slopes(times: &[f64], values: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let middle = times.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])).collect();
    let slope = times
        .windows(2)
        .zip(values.windows(2))
        .map(|(t, v)| (v[1] - v[0]) / (t[1] - t[0]))
        .collect();
    (middle, slope)
}

/// Mean of the samples before `until` (ms), or the first sample if there is none.
pub fn baseline(times: &[f64], values: &[f64], until: f64) -> Option<f64> {
    let before = times.iter().take_while(|time| **time < until).count();
    let samples = &values[..before.max(1).min(values.len())];
    if samples.is_empty() {
        return None;
    }
    Some(samples.iter().sum::<f64>() / samples.len() as f64)
}

/// Area between the curve and zero by the trapezoidal rule, unit times ms.
pub fn integral(times: &[f64], values: &[f64]) -> f64 {
    times.windows(2).zip(values.windows(2)).map(|(t, v)| 0.5 * (v[0] + v[1]) * (t[1] - t[0])).sum()
}

/// Index at which the largest rise of a curve begins, and its height.
pub fn largest_rise(values: &[f64]) -> Option<(usize, f64)> {
    let (mut foot, mut found, mut rise) = (0, None, 0.0);
    for (place, value) in values.iter().enumerate() {
        if *value < values[foot] {
            foot = place;
        } else if value - values[foot] > rise {
            rise = value - values[foot];
            found = Some((foot, rise));
        }
    }
    found
}

/// The samples of the twitch after a stimulus, in values that rise in a twitch: all samples, unless
/// the largest value comes before the stimulus because the previous twitch has not ended. Then the
/// samples begin with the largest rise after the stimulus, or at the stimulus if nothing rises.
pub fn twitch(times: &[f64], values: &[f64], stimulus: f64) -> Range<usize> {
    let all = 0..values.len();
    if index_of_largest(values).is_none_or(|top| times[top] > stimulus) {
        return all;
    }
    let first = times.partition_point(|time| *time < stimulus).min(values.len());
    match largest_rise(&values[first..]) {
        Some((foot, _)) => first + foot..all.end,
        None => first..all.end,
    }
}

/// Samples with `start <= time < end`.
pub fn window<'a>(
    times: &'a [f64],
    values: &'a [f64],
    start: f64,
    end: f64,
) -> (&'a [f64], &'a [f64]) {
    let first = times.partition_point(|time| *time < start);
    let last = times.partition_point(|time| *time < end).max(first);
    (&times[first..last], &values[first..last])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sine() -> (Vec<f64>, Vec<f64>) {
        let times: Vec<f64> = (0..=1000).map(|i| f64::from(i) * 0.01).collect();
        let values = times.iter().map(|t| t.sin()).collect();
        (times, values)
    }

    #[test]
    fn peak_and_crossings_of_a_sine_are_found_between_samples() {
        let (times, values) = sine();
        let top = peak(&times[..500], &values[..500]).unwrap();
        assert!((top.time - std::f64::consts::FRAC_PI_2).abs() < 1e-6, "{top:?}");
        assert!((top.value - 1.0).abs() < 1e-9);
        let up = rises_through(&times, &values, 0.5, 0.0).unwrap();
        assert!((up - std::f64::consts::FRAC_PI_6).abs() < 1e-4);
        let down = falls_through(&times, &values, 0.5, up).unwrap();
        assert!((down - 5.0 * std::f64::consts::FRAC_PI_6).abs() < 1e-4);
        assert_eq!(rises_through(&times, &values, 2.0, 0.0), None);
    }

    #[test]
    fn a_corner_is_found_wherever_it_lies_between_samples() {
        for shift in [0.0, 0.2, 0.5, 0.8] {
            let times: Vec<f64> = (0..40).map(f64::from).collect();
            let at = 20.0 + shift;
            let line = |t: &f64| if *t < at { (t - at) / 10.0 } else { (at - t) / 30.0 };
            let values: Vec<f64> = times.iter().map(line).collect();
            let top = peak(&times, &values).unwrap();
            assert!((top.time - at).abs() < 1e-9 && top.value.abs() < 1e-12, "{top:?}");
        }
    }

    #[test]
    fn a_peak_at_the_border_is_the_sample_itself() {
        let top = peak(&[0.0, 1.0, 2.0], &[3.0, 2.0, 1.0]).unwrap();
        assert_eq!((top.time, top.value), (0.0, 3.0));
        assert_eq!(peak(&[], &[]), None);
        assert_eq!(peak(&[0.0], &[f64::NAN]), None);
    }

    #[test]
    fn integral_baseline_and_window_of_a_ramp_are_exact() {
        let times: Vec<f64> = (0..=10).map(f64::from).collect();
        assert_eq!(integral(&times, &times), 50.0);
        assert_eq!(baseline(&times, &times, 3.0), Some(1.0));
        assert_eq!(window(&times, &times, 2.0, 5.0).0, [2.0, 3.0, 4.0]);
        assert!(slopes(&times, &times).1.iter().all(|slope| *slope == 1.0));
    }
}
