//! Beats of a measured curve and their metrics.
//!
//! A beat is a pulse above the curve's own noise. The same code (`pulse`) reads the metrics of
//! simulated beats; the additional steps for measured curves are here, and [`Treatment`] states
//! each of them:
//!
//! 1. *Direction.* Curves that fall in a beat (lengths) are inverted. For an unknown kind, beats
//!    point in the direction of the largest and shortest departures.
//! 2. *Artefacts* (departures that are unlike the beats) and single *bad frames* are replaced by
//!    lines and listed; mains hum is subtracted if it is visible in the spectrum.
//! 3. *Noise* is measured by the median of fourth differences, which vanish in a smooth curve.
//! 4. *Beats* are maxima whose prominence exceeds what noise of this size reaches in as many
//!    samples; prominence, and height times width, are at least a fifth of the usual beat's. With
//!    stimuli, a beat is the pulse between one stimulus and the next.
//! 5. *Rest* of a beat is the mean of the last 15 % of the cycle before it; with a stimulus, of the
//!    20 ms before it, or longer in noise (`rest`).
//! 6. *Drift*: the line from this rest to the next is subtracted from the beat. Each rest is the
//!    median of three neighbours, so that one early beat does not tilt the line. For the last beat,
//!    the drift of the previous beat and that up to the end of the recording are used as far as
//!    they agree.
//! 7. *Smoothing*: local parabolas over a window that reduces noise to half a per cent of a beat,
//!    at most an eighth of a beat's width to each side; none if there is less noise.

mod agreement;
mod answer;
mod artefacts;
mod beat;
mod detect;
mod noise;
mod possible;
mod rhythm;
mod smooth;
#[cfg(test)]
mod tests;
mod upstroke;

use super::holes::{self, Hole};
use super::kind::Kind;
use super::order::median;
use super::{Metric, rest, trace};
pub use agreement::compare;
use answer::LEAST_FRAMES;
pub use answer::{Analysis, Artefact, CurveBeat, CurveError, Mark, State, Treatment};
use beat::Reader;
use detect::Known;
use noise::Noise;
use std::cmp::Ordering;

/// Shortest beat at half its height, ms: contractions and transients of mice last about 50 ms
/// (their action potentials about 5 ms). Lamps and cameras flicker faster.
const SHORTEST_MS: f64 = 15.0;
const SHORTEST_POTENTIAL_MS: f64 = 2.0;

/// A pulse that stays above half of its height for longer may be drift, ms; human ventricular
/// potentials last about 400 ms.
const LONGEST_MS: f64 = 1500.0;

/// Noise after smoothing, as a part of a beat's height.
const SMOOTH_TO: f64 = 0.005;

/// Noise of a beat's mean resting value, as a part of a beat's height.
const REST_TO: f64 = 0.002;

/// Options of the analysis.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct CurveOptions {
    /// Stimulus times, ms on the clock of the curve; without any, beats are searched everywhere.
    pub stimuli_ms: Vec<f64>,
    /// Half of the smoothing window, ms; `None` chooses it by the noise, 0 disables smoothing.
    pub smoothing_ms: Option<f64>,
    /// Do not subtract the drift of the baseline.
    pub keep_drift: bool,
}

/// Beats of a curve over times in ms, and their metrics.
///
/// # Errors
/// Lists of different length, fewer than 8 frames, values that are not finite, a constant curve, a
/// curve without pulses above its noise, impossible values for its kind (such as a negative
/// length), stimuli outside the recording.
///
/// # Example
/// ```
/// use myospring::analysis::curve::{CurveOptions, analyse};
/// use myospring::analysis::kind::Kind;
/// // 120 um, shorter by a tenth each second, in half sines of 300 ms.
/// let times: Vec<f64> = (0..1000).map(|i| 4.0 * f64::from(i)).collect();
/// let length: Vec<f64> = times
///     .iter()
///     .map(|t| {
///         let t = (t - 200.0).rem_euclid(1000.0);
///         120.0 - if t < 300.0 { 12.0 * (std::f64::consts::PI * t / 300.0).sin() } else { 0.0 }
///     })
///     .collect();
/// let analysis = analyse(&times, &length, Kind::Length, "um", &CurveOptions::default())?;
/// assert_eq!(analysis.beats.len(), 4);
/// assert!((analysis.mean("peak_shortening").unwrap() - 10.0).abs() < 0.01); // %
/// assert!((analysis.mean("interval").unwrap() - 1000.0).abs() < 0.1); // ms
/// # Ok::<(), myospring::analysis::curve::CurveError>(())
/// ```
pub fn analyse(
    times: &[f64],
    values: &[f64],
    kind: Kind,
    unit: &'static str,
    options: &CurveOptions,
) -> Result<Analysis, CurveError> {
    check(times, values)?;
    possible::check_values(values, kind, unit)?;
    let plateau = kind == Kind::Potential;
    let Cleaned { rises, mut signal, bad, artefacts, against, usual, replaced } =
        clean(times, values, kind);
    let height = usual.as_ref().map(|usual| usual.height);
    let sign = if rises { 1.0 } else { -1.0 };
    let hum = noise::hum(times, &signal);
    if let Some(hum) = &hum {
        signal.iter_mut().zip(&hum.wave).for_each(|(value, wave)| *value -= wave);
    }
    // Lines that replace artefacts have no noise and are left out.
    let noise = noise_of(&artefacts::without(&signal, &replaced), usual.as_ref());
    let level = noise.sd;
    let stimuli = stimuli_within(times, &options.stimuli_ms)?;
    let known = Known {
        plateau,
        height,
        width: usual.as_ref().map(|usual| usual.width),
        noise: Some(noise),
        stimuli: stimuli.as_deref().unwrap_or_default(),
    };
    let found = detect::beats(times, &signal, known);
    if found.peaks.is_empty() {
        let turned: Vec<f64> = signal.iter().map(|value| -value).collect();
        let known = Known { plateau, ..Known::default() };
        let beats_turned = || !detect::beats(times, &turned, known).peaks.is_empty();
        let hint = if kind.rises().is_some() && !departs_upward(&signal) && beats_turned() {
            "; its pulses point the other way: is its kind right?"
        } else {
            ""
        };
        return Err(CurveError::NoBeat { noise: level, least: found.least, unit, hint });
    }
    let half = half_window(times, &signal, &found, noise, options);
    let smoothed = smooth::smooth(times, &signal, half);
    let steep = half_of_slopes(times, &signal, &found, noise, options);
    let slopes = (steep > 0).then(|| smooth::slopes(times, &signal, steep));
    let holes = holes::of(times);
    let reader = Reader {
        slopes: slopes.as_deref(),
        times,
        signal: &signal,
        smoothed: &smoothed,
        level: noise.rough,
        noise: noise.behind(half),
        noise_ms: noise.memory * (noise.sd / (REST_TO * found.usual)).powi(2) * median_step(times),
        sign,
        kind,
        unit,
        found: &found,
        keep_drift: options.keep_drift,
        artefacts: &artefacts,
        holes: &holes,
        half: half.max(steep),
    };
    let mut beats = match &stimuli {
        Some(stimuli) => reader.after(stimuli),
        None => reader.found(),
    };
    if !beats.iter().any(|beat| beat.state != State::Missed) {
        return Err(CurveError::NoBeat {
            noise: level,
            least: found.least,
            unit,
            hint: " after any stimulus",
        });
    }
    possible::check_beats(&beats, times, kind, unit)?;
    let mut remarks = artefact_remarks(&artefacts, &beats);
    remarks.extend(hole_remark(&holes));
    remarks.extend(possible::doubt(&beats, kind));
    remarks.extend(rhythm::remarks(&mut beats, stimuli.is_some()));
    let rivalled = usual.as_ref().is_some_and(|usual| usual.rivalled);
    remarks.extend(rhythm::crowded(&beats, artefacts.len() + bad.len(), rivalled));
    remarks.extend(doubts(times, &signal, &beats, &found, kind, rises, against));
    let step = median_step(times);
    let window =
        |half: usize| format!("{} frames, {:.1} ms", 2 * half + 1, 2.0 * half as f64 * step);
    let treatment = Treatment {
        rises,
        beats: match &stimuli {
            Some(stimuli) => format!("the pulse after each of {} stimuli", stimuli.len()),
            None => format!(
                "pulses higher than {:.4} {unit}, which noise does not reach, and than a fifth of the usual one",
                found.least.max(0.2 * found.usual)
            ),
        },
        baseline: if stimuli.is_some() { rest::BEFORE_STIMULUS } else { rest::BEFORE_ONSET },
        drift: if options.keep_drift {
            "left in"
        } else {
            "subtracted: the line from the rest before each beat to that before the next, medians of three"
        },
        smoothing: match half {
            0 => "none".to_owned(),
            half => format!("local parabolas over {}", window(half)),
        },
        rates: match (plateau, steep) {
            (true, _) => upstroke_words(&beats),
            (false, 0) => "slopes between frames".to_owned(),
            (false, steep) => format!("slopes of lines over {}", window(steep)),
        },
        noise: level,
        bad_frames: bad.iter().map(|at| at + 1).collect(),
        artefacts,
        holes,
        hum: hum.map(|hum| [hum.frequency_hz, hum.amplitude]),
    };
    let read = smoothed.iter().map(|value| sign * value).collect();
    Ok(Analysis { beats, treatment, remarks, read })
}

fn check(times: &[f64], values: &[f64]) -> Result<(), CurveError> {
    if times.len() != values.len() {
        return Err(CurveError::Lengths { times: times.len(), values: values.len() });
    }
    if times.len() < LEAST_FRAMES {
        return Err(CurveError::Few { frames: times.len() });
    }
    let mut before = f64::NEG_INFINITY;
    for (frame, (&time, &value)) in (1..).zip(times.iter().zip(values)) {
        if !(time.is_finite() && value.is_finite() && time > before) {
            return Err(CurveError::Sample { frame, time, value });
        }
        before = time;
    }
    if values.iter().all(|value| *value == values[0]) {
        return Err(CurveError::Still { frames: values.len(), value: values[0] });
    }
    Ok(())
}

/// A curve without artefacts.
struct Cleaned {
    rises: bool,
    /// The curve, with sign such that beats rise.
    signal: Vec<f64>,
    /// Single frames that were replaced.
    bad: Vec<usize>,
    artefacts: Vec<Artefact>,
    /// Whether the pulses of the curve point against the direction of its kind.
    against: bool,
    /// The usual beat.
    usual: Option<artefacts::Beats>,
    /// Frames that were replaced by lines.
    replaced: Vec<bool>,
}

/// The analysis of a curve for one direction: whether beats rise, and the curve without the
/// artefacts found for that direction.
type Side = (bool, artefacts::Bridged);

/// Whether the beats of a curve rise, from the analyses for both directions.
fn rises_by_itself(up: &Side, down: &Side) -> bool {
    // Without many artefacts, both analyses agree. If they disagree, the wrong one has many
    // artefacts, because it treats the beats as such.
    let upward = departs_upward(&up.1.0);
    let downward = departs_upward(&down.1.0);
    if upward != downward {
        return upward;
    }
    let alike = |of: &Side| of.1.2.as_ref().map_or(0.0, |beats| beats.alike);
    match removed(up).cmp(&removed(down)) {
        Ordering::Less => true,
        Ordering::Greater => false,
        Ordering::Equal => alike(up) >= alike(down),
    }
}

/// Number of frames in artefacts.
fn removed(of: &Side) -> usize {
    of.1.1.iter().map(|artefact| artefact.to + 1 - artefact.from).sum()
}

/// Replaces artefacts by lines, and determines the direction of a curve if its kind does not.
fn clean(times: &[f64], values: &[f64], kind: Kind) -> Cleaned {
    let plateau = kind == Kind::Potential;
    let lasts = [if plateau { SHORTEST_POTENTIAL_MS } else { SHORTEST_MS }, LONGEST_MS];
    let lasts = lasts.map(|ms| ms / median_step(times));
    let of = |rises: bool| {
        let sign = if rises { 1.0 } else { -1.0 };
        let signal: Vec<f64> = values.iter().map(|value| sign * value).collect();
        (rises, artefacts::bridge(&signal, plateau, lasts))
    };
    let (own, against) = if let Some(rises) = kind.rises() {
        let own = of(rises);
        // In the wrong direction, the beats appear as artefacts.
        let against = removed(&own) > values.len() / 20 && {
            let other = of(!rises);
            let (up, down) = if rises { (&own, &other) } else { (&other, &own) };
            rises_by_itself(up, down) != rises && removed(&own) > 2 * removed(&other)
        };
        (own, against)
    } else {
        let (up, down) = (of(true), of(false));
        (if rises_by_itself(&up, &down) { up } else { down }, false)
    };
    let (rises, (mut signal, found, beats)) = own;
    let (single, longer): (Vec<_>, Vec<_>) =
        found.into_iter().partition(|artefact| artefact.from == artefact.to);
    let mut replaced = vec![false; signal.len()];
    for artefact in &longer {
        replaced[artefact.from..=artefact.to].fill(true);
    }
    let range = beats.as_ref().map_or_else(|| noise::range(&signal, 0.02), |beats| beats.height);
    let mut bad = noise::bad_frames(
        &signal,
        noise_of(&artefacts::without(&signal, &replaced), beats.as_ref()).sd,
        range,
    );
    for &at in &bad {
        let part = (times[at] - times[at - 1]) / (times[at + 1] - times[at - 1]);
        signal[at] = signal[at - 1] + part * (signal[at + 1] - signal[at - 1]);
    }
    bad.extend(single.iter().map(|artefact| artefact.from));
    bad.sort_unstable();
    bad.dedup();
    let sign = if rises { 1.0 } else { -1.0 };
    let artefacts = longer.iter().map(|artefact| Artefact {
        from_ms: times[artefact.from],
        to_ms: times[artefact.to],
        frames: [artefact.from + 1, artefact.to + 1],
        height: sign * artefact.height,
        long: artefact.long,
    });
    let artefacts = artefacts.collect();
    Cleaned { rises, signal, bad, artefacts, against, usual: beats, replaced }
}

/// The noise of a curve, with a correlation time shorter than a beat.
fn noise_of(values: &[f64], beats: Option<&artefacts::Beats>) -> Noise {
    let longest = beats.map_or(usize::MAX, |beats| (0.25 * beats.width) as usize);
    Noise::up_to(longest, values)
}

/// Whether a curve spends less time above its middle than below: beats are shorter than rest.
fn departs_upward(values: &[f64]) -> bool {
    let count = values.len() as f64;
    // Linear drift is subtracted.
    let half = values.len() / 2;
    let mean = |part: &[f64]| part.iter().sum::<f64>() / part.len().max(1) as f64;
    let slope = (mean(&values[half..]) - mean(&values[..half])) / (0.5 * count);
    let level = mean(values) - 0.5 * slope * count;
    let departures = values.iter().enumerate().map(|(at, value)| value - level - slope * at as f64);
    departures.map(|departure| departure.powi(3)).sum::<f64>() >= 0.0
}

/// Number of samples to each side in the smoothing window.
fn half_window(
    times: &[f64],
    signal: &[f64],
    found: &detect::Found,
    noise: Noise,
    options: &CurveOptions,
) -> usize {
    let step = median_step(times);
    if let Some(half_ms) = options.smoothing_ms {
        return (half_ms / step).round().max(0.0) as usize;
    }
    if noise.sd <= SMOOTH_TO * found.usual {
        return 0;
    }
    let rough = smooth::smooth(times, signal, found.half);
    let mut widths: Vec<f64> =
        found.peaks.iter().map(|peak| detect::width_at_half(times, &rough, peak)).collect();
    widths.sort_by(f64::total_cmp);
    let width = widths.get(widths.len() / 2).copied().unwrap_or(0.0);
    // 3/2 / sqrt((2 half + 1) / memory) sd = SMOOTH_TO usual
    let wanted = (noise.memory * (1.5 * noise.sd / (SMOOTH_TO * found.usual)).powi(2) - 1.0) / 2.0;
    wanted.min(width / 8.0 / step).round().max(0.0) as usize
}

/// Number of samples to each side in the lines whose slopes are the rates: enough to reduce their
/// noise to a fiftieth of the usual rise's slope, over at most half of that rise.
fn half_of_slopes(
    times: &[f64],
    signal: &[f64],
    found: &detect::Found,
    noise: Noise,
    options: &CurveOptions,
) -> usize {
    if noise.sd <= SMOOTH_TO * SMOOTH_TO * found.usual || options.smoothing_ms == Some(0.0) {
        return 0;
    }
    let rough = smooth::smooth(times, signal, found.half);
    let mut rises: Vec<f64> = found
        .peaks
        .iter()
        .filter_map(|peak| {
            let top = rough[peak.at];
            let crossing = |part: f64| {
                let level = top - (1.0 - part) * peak.prominence;
                trace::last_rise_through(times, &rough, level, times[0], times[peak.at])
            };
            Some(crossing(0.9)? - crossing(0.1)?)
        })
        .collect();
    rises.sort_by(f64::total_cmp);
    let Some(&rise) = rises.get(rises.len() / 2) else { return 0 };
    let step = median_step(times);
    let slope = 0.8 * found.usual / rise.max(step);
    // sd sqrt(12 memory / frames^3) / step = slope / 50
    let wanted = (12.0 * noise.memory * (50.0 * noise.sd / (slope * step)).powi(2)).cbrt();
    let frames = wanted.min(0.5 * rise / step);
    ((frames - 1.0) / 2.0).round().max(0.0) as usize
}

fn median_step(times: &[f64]) -> f64 {
    median(times.windows(2).map(|pair| pair[1] - pair[0])).unwrap_or(1.0)
}

/// The stimuli within the recording, in order; `None` if none were given.
fn stimuli_within(times: &[f64], stimuli: &[f64]) -> Result<Option<Vec<f64>>, CurveError> {
    if stimuli.is_empty() {
        return Ok(None);
    }
    let (from, to) = (times[0], times[times.len() - 1]);
    let mut within: Vec<f64> =
        stimuli.iter().copied().filter(|time| (from..to).contains(time)).collect();
    within.sort_by(f64::total_cmp);
    within.dedup();
    if within.is_empty() {
        return Err(CurveError::Stimuli { count: stimuli.len(), from, to });
    }
    Ok(Some(within))
}

/// Remarks on artefacts and on the beats that they affect.
fn artefact_remarks(artefacts: &[Artefact], beats: &[CurveBeat]) -> Vec<String> {
    let mut remarks = Vec::new();
    let (long, short): (Vec<&Artefact>, Vec<&Artefact>) =
        artefacts.iter().partition(|artefact| artefact.long);
    for artefact in long {
        remarks.push(format!(
            "{:.1} s, from {:.0} to {:.0} ms, are left out: the signal there is not that of beats",
            1e-3 * (artefact.to_ms - artefact.from_ms),
            artefact.from_ms,
            artefact.to_ms
        ));
    }
    if !short.is_empty() {
        let (what, are) = if short.len() == 1 { ("artefact", "is") } else { ("artefacts", "are") };
        let times = listed(short.iter().map(|artefact| [artefact.from_ms, artefact.to_ms]));
        remarks.push(format!("{} {what} {are} left out: {times}", short.len()));
    }
    let touched = beats.iter().filter(|beat| beat.state == State::Disturbed).count();
    if touched > 0 {
        let (what, count) = if touched == 1 { ("beat", "counts") } else { ("beats", "count") };
        remarks.push(format!(
            "{touched} {what} of {} that artefacts touch {count} in no mean",
            beats.len()
        ));
    }
    remarks
}

/// Remark on missing frames.
fn hole_remark(holes: &[Hole]) -> Option<String> {
    let usual = holes.first()?.usual_ms;
    let times = listed(holes.iter().map(|hole| [hole.from_ms, hole.to_ms]));
    Some(format!(
        "frames are missing from {times}, where one should come every {usual:.4} ms: no metric is read across such a gap"
    ))
}

/// The first of some intervals, ms, in words, and how many there are more.
fn listed(intervals: impl ExactSizeIterator<Item = [f64; 2]>) -> String {
    let more = match intervals.len().saturating_sub(rhythm::LISTED) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    let words = intervals.take(rhythm::LISTED).map(|[from, to]| format!("{from:.0} to {to:.0} ms"));
    words.collect::<Vec<_>>().join(", ") + &more
}

/// The time over which the slopes of upstrokes were read, in words.
fn upstroke_words(beats: &[CurveBeat]) -> String {
    median_of(beats, "upstroke_window").map_or_else(String::new, |window| {
        format!("the upstroke's slope over {window:.2} ms, chosen by the steepness of the upstroke")
    })
}

fn median_of(beats: &[CurveBeat], name: &str) -> Option<f64> {
    median(beats.iter().filter_map(|beat| super::value(&beat.metrics, name)))
}

/// Shortest and longest plausible interval between beats, ms.
const INTERVALS_MS: [f64; 2] = [60.0, 30_000.0];

/// Doubts about the results.
fn doubts(
    times: &[f64],
    signal: &[f64],
    beats: &[CurveBeat],
    found: &detect::Found,
    kind: Kind,
    rises: bool,
    against: bool,
) -> Vec<String> {
    let mut doubts = Vec::new();
    if kind.rises().is_some() {
        let turned: Vec<f64> = signal.iter().map(|value| -value).collect();
        let other = detect::beats(times, &turned, Known::default());
        // A curve of beats with rest in between is asymmetric; inverted, the rest forms broad
        // pulses.
        let lopsided = !departs_upward(signal) && other.usual > 0.8 * found.usual;
        if against || lopsided && beats.len() > 1 {
            doubts.push(format!(
                "the curve's pulses point {}, but {} {} in a beat: is its kind right?",
                if rises { "downward" } else { "upward" },
                kind.name(),
                if rises { "rises" } else { "falls" },
            ));
        }
    }
    let mut rises_ms: Vec<f64> = beats.iter().filter_map(|beat| rise_time(&beat.metrics)).collect();
    rises_ms.sort_by(f64::total_cmp);
    let step = median_step(times);
    if let Some(&rise) = rises_ms.get(rises_ms.len() / 2)
        && rise < 3.0 * step
        && kind != Kind::Potential
    {
        doubts.push(format!(
            "the rise from 10 to 90 % takes {rise:.1} ms, {:.1} frames: its times and rates are limited by the camera's frame rate",
            rise / step
        ));
    }
    if kind == Kind::Potential
        && let Some(window) = median_of(beats, "upstroke_window")
        && window < 1.5 * step
    {
        let wanted = 10.0 * step.recip();
        doubts.push(format!(
            "the upstroke is faster than the sampling, every {step:.4} ms, can show: the maximum upstroke velocity is at \
             least the given value; record at {wanted:.0} kHz or more to measure it"
        ));
    }
    let mut intervals: Vec<f64> =
        beats.iter().filter_map(|beat| super::value(&beat.metrics, "interval")).collect();
    intervals.sort_by(f64::total_cmp);
    if let Some(&interval) = intervals.get(intervals.len() / 2)
        && !(INTERVALS_MS[0]..=INTERVALS_MS[1]).contains(&interval)
    {
        doubts.push(format!(
            "beats come every {interval:.4} ms, which is implausible for a heart cell: is the frame rate, or the unit of time, right?"
        ));
    }
    doubts
}

fn rise_time(metrics: &[Metric]) -> Option<f64> {
    super::value(metrics, "rise_time_10_90")
        .or_else(|| super::value(metrics, "tension_rise_time_10_90"))
}
