//! Spiral waves: how fast they turn, and how their tip drifts.

use super::{Metric, Missing};
use crate::recording::{Wave, WaveTip};

/// Median time from one activation of a place to the next.
pub const ROTATION_PERIOD: &str = "rotation_period";
/// Speed of the mean place of the tip.
pub const TIP_DRIFT: &str = "tip_drift";

/// Waves in the muscle of a heart are slower, um/ms (1 m/s): two tips farther apart are not the same.
const FASTEST: f64 = 1000.0;
/// A path of a tip goes on after a gap of at most this time, ms: tips are not seen while two lines of equal potential lie on each other.
const GAP_MS: f64 = 10.0;
/// Fewest periods whose mean places tell a drift.
const FEWEST_PERIODS: usize = 3;

/// Period and drift of a spiral wave within a time, ms; both missing where none turns.
///
/// The drift is the slope of a straight line through the mean places of the tip in successive periods, so that a tip that meanders about
/// one place has none. It is that of the tip that was followed for the longest time.
///
/// # Example
/// ```
/// use myospring::analysis::{spiral, value};
/// use myospring::recording::{LocalBeat, Wave, WaveTip};
/// // A tip that circles once in 100 ms and goes to the right by 2 um/ms = 2 mm/s.
/// let tips = (0..500).map(|at| {
///     let t_ms = 2.0 * f64::from(at);
///     let (sine, cosine) = (std::f64::consts::TAU * t_ms / 100.0).sin_cos();
///     WaveTip { t_ms, x_um: 2.0 * t_ms + 300.0 * cosine, y_um: 300.0 * sine }
/// });
/// let beat = |at: i32| LocalBeat { activated_ms: 100.0 * f64::from(at), repolarised_ms: None };
/// let wave = Wave { beats: vec![(0..10).map(beat).collect()], tips: tips.collect(), ..Wave::default() };
/// let metrics = spiral::metrics(&wave, [0.0, f64::INFINITY]);
/// assert_eq!(value(&metrics, "rotation_period"), Some(100.0));
/// assert!((value(&metrics, "tip_drift").unwrap() - 2.0).abs() < 1e-9);
/// ```
pub fn metrics(wave: &Wave, within_ms: [f64; 2]) -> Vec<Metric> {
    let is_within = |t_ms: f64| (within_ms[0]..within_ms[1]).contains(&t_ms);
    let path = longest_path(wave.tips.iter().copied().filter(|tip| is_within(tip.t_ms)));
    // Waves that meet have tips for a moment, too: one that turns lasts for a turn.
    let period = rotation_period(wave, is_within).filter(|period| lasted(&path) >= *period);
    let drift = period
        .ok_or(Missing::NotRecorded)
        .and_then(|period| drift(&path, period).ok_or(Missing::Cut));
    vec![
        Metric::new(
            ROTATION_PERIOD,
            period.ok_or(Missing::NotRecorded),
            "ms",
            "median of all times from one activation of a place to the next, in a tissue where a wave turns about a tip",
        ),
        Metric::new(
            TIP_DRIFT,
            drift,
            "mm/s",
            "speed of the mean place of the tip in each period, by a straight line; it takes a tip that lasts for three periods",
        ),
    ]
}

/// These metrics where a spiral wave turns; none where none does.
pub(super) fn of_turning(wave: &Wave, within_ms: [f64; 2]) -> Vec<Metric> {
    let metrics = metrics(wave, within_ms);
    if metrics.iter().all(|metric| metric.value.is_none()) { Vec::new() } else { metrics }
}

/// The median time from one activation of a place to the next, ms; `None` where no place is activated twice.
fn rotation_period(wave: &Wave, is_within: impl Fn(f64) -> bool) -> Option<f64> {
    let mut times = Vec::new();
    for beats in &wave.beats {
        let own = || beats.iter().map(|beat| beat.activated_ms).filter(|time| is_within(*time));
        times.extend(own().zip(own().skip(1)).map(|(one, next)| next - one));
    }
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().filter(|period| *period > 0.0)
}

/// How long a tip was followed, ms.
fn lasted(path: &[WaveTip]) -> f64 {
    path.first().zip(path.last()).map_or(0.0, |(first, last)| last.t_ms - first.t_ms)
}

/// The path of the tip that was followed for the longest time.
fn longest_path(tips: impl Iterator<Item = WaveTip>) -> Vec<WaveTip> {
    let mut paths: Vec<Vec<WaveTip>> = Vec::new();
    for tip in tips {
        let apart = |path: &Vec<WaveTip>| {
            let last = path.last()?;
            let (over, away) =
                (tip.t_ms - last.t_ms, (tip.x_um - last.x_um).hypot(tip.y_um - last.y_um));
            (over > 0.0 && over <= GAP_MS && away <= FASTEST * over).then_some(away)
        };
        let nearest = paths
            .iter_mut()
            .filter_map(|path| Some((apart(path)?, path)))
            .min_by(|(one, _), (other, _)| one.total_cmp(other));
        match nearest {
            Some((_, path)) => path.push(tip),
            None => paths.push(vec![tip]),
        }
    }
    paths.into_iter().max_by(|one, other| lasted(one).total_cmp(&lasted(other))).unwrap_or_default()
}

/// The speed of the mean place in successive periods, counted back from the end of a path, um/ms; `None` if there are too few.
fn drift(path: &[WaveTip], period: f64) -> Option<f64> {
    let end = path.last()?.t_ms;
    let mut means: Vec<[f64; 3]> = Vec::new();
    for back in 0.. {
        let (from, to) = (end - f64::from(back + 1) * period, end - f64::from(back) * period);
        if from < path[0].t_ms {
            break;
        }
        let own = path.iter().filter(|tip| (from..to).contains(&tip.t_ms));
        let (mut count, mut sum) = (0.0, [0.0; 3]);
        for tip in own {
            count += 1.0;
            sum = [sum[0] + tip.t_ms, sum[1] + tip.x_um, sum[2] + tip.y_um];
        }
        if count > 0.0 {
            means.push(sum.map(|sum| sum / count));
        }
    }
    if means.len() < FEWEST_PERIODS {
        return None;
    }
    let count = means.len() as f64;
    let middle = [0, 1, 2].map(|of: usize| means.iter().map(|mean| mean[of]).sum::<f64>() / count);
    let with = |of: usize| -> f64 {
        means.iter().map(|mean| (mean[0] - middle[0]) * (mean[of] - middle[of])).sum()
    };
    Some((with(1) / with(0)).hypot(with(2) / with(0)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::value;
    use crate::recording::LocalBeat;

    fn tip(t_ms: f64, x_um: f64, y_um: f64) -> WaveTip {
        WaveTip { t_ms, x_um, y_um }
    }

    /// A place that is activated every 80 ms, in a tissue with these tips.
    fn wave(tips: Vec<WaveTip>) -> Wave {
        let beat = |at: i32| LocalBeat { activated_ms: 80.0 * f64::from(at), repolarised_ms: None };
        Wave { beats: vec![(0..12).map(beat).collect()], tips, ..Wave::default() }
    }

    #[test]
    fn a_tip_that_meanders_about_one_place_does_not_drift() {
        let turning = |at: i32| {
            let t_ms = 2.0 * f64::from(at);
            let (sine, cosine) = (std::f64::consts::TAU * t_ms / 80.0).sin_cos();
            tip(t_ms, 5e3 + 800.0 * cosine, 4e3 + 500.0 * sine)
        };
        let metrics = metrics(&wave((0..480).map(turning).collect()), [0.0, f64::INFINITY]);
        assert!(value(&metrics, TIP_DRIFT).unwrap() < 1e-9);
    }

    #[test]
    fn the_tip_that_lasts_is_followed_through_gaps_and_past_others() {
        let mut tips = Vec::new();
        for at in 0..480 {
            let t_ms = 2.0 * f64::from(at);
            // For a moment another one passes, and the lasting one is not always seen.
            if (100..110).contains(&at) {
                tips.push(tip(t_ms, 9e3, 9e3));
            }
            if at % 10 != 3 {
                tips.push(tip(t_ms, 1e3 + 3.0 * t_ms, 1e3 - 4.0 * t_ms));
            }
        }
        let metrics = metrics(&wave(tips), [0.0, f64::INFINITY]);
        assert!((value(&metrics, TIP_DRIFT).unwrap() - 5.0).abs() < 1e-9);
    }

    #[test]
    fn waves_without_tips_or_that_meet_do_not_turn_and_a_short_turn_has_no_drift() {
        let meeting = (0..10).map(|at| tip(2.0 * f64::from(at), 1e3, 1e3)).collect();
        for tips in [Vec::new(), meeting] {
            let none = metrics(&wave(tips), [0.0, f64::INFINITY]);
            assert!(none.iter().all(|metric| metric.value.is_none()));
        }
        let short = (0..50).map(|at| tip(2.0 * f64::from(at), 1e3, 1e3)).collect();
        let short = metrics(&wave(short), [0.0, f64::INFINITY]);
        assert_eq!(value(&short, ROTATION_PERIOD), Some(80.0));
        assert_eq!(short[1].missing, Some(Missing::Cut));
    }
}
