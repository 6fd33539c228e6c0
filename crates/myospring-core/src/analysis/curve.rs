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
mod clipped;
mod detect;
mod noise;
mod possible;
mod remarks;
mod rhythm;
mod smooth;
mod smoothing;
mod span;
mod upstroke;

use super::holes;
use super::kind::Kind;
use super::rest;
pub use agreement::compare;
use answer::LEAST_FRAMES;
pub use answer::{Analysis, Artefact, CurveBeat, CurveError, Mark, State, Treatment};
pub use clipped::{Clipped, clipped};
use detect::Known;
use noise::Noise;
use smoothing::{Smoothing, median_step};
use span::Reader;
use std::cmp::Ordering;

/// Shortest beat at half its height, ms: contractions and transients of mice last about 50 ms
/// (their action potentials about 5 ms). Lamps and cameras flicker faster.
const SHORTEST_MS: f64 = 15.0;
const SHORTEST_POTENTIAL_MS: f64 = 2.0;

/// A pulse that stays above half of its height for longer may be drift, ms; human ventricular
/// potentials last about 400 ms.
const LONGEST_MS: f64 = 1500.0;

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
    let Cleaned { rises, signal, bad, artefacts, hum, against, usual, replaced } =
        clean(times, values, kind);
    let sign = if rises { 1.0 } else { -1.0 };
    // Lines that replace artefacts have no noise and are left out.
    let noise = noise_of(&artefacts::without(&signal, &replaced), usual.as_ref());
    let stimuli = stimuli_within(times, &options.stimuli_ms)?;
    let known = Known {
        plateau: kind == Kind::Potential,
        height: usual.as_ref().map(|usual| usual.height),
        width: usual.as_ref().map(|usual| usual.width),
        noise: Some(noise),
        stimuli: stimuli.as_deref().unwrap_or_default(),
    };
    let found = detect::beats(times, &signal, known);
    let no_beat = |hint| CurveError::NoBeat { noise: noise.sd, least: found.least, unit, hint };
    if found.peaks.is_empty() {
        return Err(no_beat(direction_hint(times, &signal, kind)));
    }
    let smoothing = Smoothing::of(times, &signal, &found, noise, options.smoothing_ms);
    let holes = holes::of(times);
    let step = median_step(times);
    let reader = Reader {
        times,
        signal: &signal,
        smoothed: &smoothing.values,
        slopes: smoothing.slopes.as_deref(),
        level: noise.rough,
        noise: noise.behind(smoothing.half),
        noise_ms: noise.memory * (noise.sd / (REST_TO * found.usual)).powi(2) * step,
        sign,
        kind,
        unit,
        found: &found,
        keep_drift: options.keep_drift,
        artefacts: &artefacts,
        holes: &holes,
        half: smoothing.widest(),
    };
    let mut beats = match &stimuli {
        Some(stimuli) => reader.after(stimuli),
        None => reader.found(),
    };
    if !beats.iter().any(|beat| beat.state != State::Missed) {
        return Err(no_beat(" after any stimulus"));
    }
    possible::check_beats(&beats, times, kind, unit)?;
    let mut remarks = remarks::on_artefacts(&artefacts, &beats);
    remarks.extend(remarks::on_holes(&holes));
    remarks.extend(clipped(values).map(|found| found.words(unit)));
    remarks.extend(possible::doubt(&beats, kind));
    remarks.extend(rhythm::remarks(&mut beats, stimuli.is_some()));
    let rivalled = usual.as_ref().is_some_and(|usual| usual.rivalled);
    remarks.extend(rhythm::crowded(&beats, artefacts.len() + bad.len(), rivalled));
    if against || beats.len() > 1 && is_lopsided(times, &signal, &found, kind) {
        remarks.push(remarks::on_direction(kind, rises));
    }
    remarks.extend(remarks::on_sampling(&beats, kind, step));
    let read = smoothing.values.iter().map(|value| sign * value).collect();
    let treatment = Treatment {
        rises,
        beats: remarks::of_search(stimuli.as_deref(), found.least.max(0.2 * found.usual), unit),
        baseline: if stimuli.is_some() { rest::BEFORE_STIMULUS } else { rest::BEFORE_ONSET },
        drift: if options.keep_drift {
            "left in"
        } else {
            "subtracted: the line from the rest before each beat to that before the next, medians of three"
        },
        smoothing: smoothing.words(step),
        rates: match kind {
            Kind::Potential => remarks::of_upstrokes(&beats),
            _ => smoothing.words_of_slopes(step),
        },
        noise: noise.sd,
        bad_frames: bad.iter().map(|at| at + 1).collect(),
        artefacts,
        holes,
        hum,
    };
    Ok(Analysis { beats, treatment, remarks, read })
}

/// What to try where no pulse is found: whether the curve has pulses that point the other way.
fn direction_hint(times: &[f64], signal: &[f64], kind: Kind) -> &'static str {
    let known = Known { plateau: kind == Kind::Potential, ..Known::default() };
    let has_beats_turned = || !detect::beats(times, &turned(signal), known).peaks.is_empty();
    if kind.rises().is_some() && !departs_upward(signal) && has_beats_turned() {
        "; its pulses point the other way: is its kind right?"
    } else {
        ""
    }
}

/// Whether the pulses of a curve may point against the direction of its kind. A curve of beats with rest in
/// between is asymmetric; inverted, the rest forms broad pulses.
fn is_lopsided(times: &[f64], signal: &[f64], found: &detect::Found, kind: Kind) -> bool {
    kind.rises().is_some()
        && !departs_upward(signal)
        && detect::beats(times, &turned(signal), Known::default()).usual > 0.8 * found.usual
}

fn turned(signal: &[f64]) -> Vec<f64> {
    signal.iter().map(|value| -value).collect()
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

/// A curve without artefacts and hum.
struct Cleaned {
    rises: bool,
    /// The curve, with sign such that beats rise.
    signal: Vec<f64>,
    /// Single frames that were replaced.
    bad: Vec<usize>,
    artefacts: Vec<Artefact>,
    /// Frequency, Hz, and amplitude of the mains hum that was subtracted.
    hum: Option<[f64; 2]>,
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

/// Replaces artefacts by lines, subtracts hum, and determines the direction of a curve if its kind does not.
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
    let hum = noise::hum(times, &signal).map(|hum| {
        signal.iter_mut().zip(&hum.wave).for_each(|(value, wave)| *value -= wave);
        [hum.frequency_hz, hum.amplitude]
    });
    Cleaned { rises, signal, bad, artefacts, hum, against, usual: beats, replaced }
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
