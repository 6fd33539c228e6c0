//! What is said of a curve: its artefacts and gaps, how it was read, and doubts about the results.

use super::answer::{Artefact, CurveBeat, State};
use super::rhythm::listed;
use crate::analysis::holes::Hole;
use crate::analysis::kind::Kind;
use crate::analysis::order::median;
use crate::analysis::{Metric, value};

/// Shortest and longest plausible interval between beats, ms.
const INTERVALS_MS: [f64; 2] = [60.0, 30_000.0];

/// Remarks on artefacts and on the beats that they affect.
pub(super) fn on_artefacts(artefacts: &[Artefact], beats: &[CurveBeat]) -> Vec<String> {
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
        let times = short.iter().map(|it| format!("{:.0} to {:.0} ms", it.from_ms, it.to_ms));
        let (what, are) = if short.len() == 1 { ("artefact", "is") } else { ("artefacts", "are") };
        remarks.push(format!("{} {what} {are} left out: {}", short.len(), listed(times)));
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
pub(super) fn on_holes(holes: &[Hole]) -> Option<String> {
    let times = holes.iter().map(|hole| format!("{:.0} to {:.0} ms", hole.from_ms, hole.to_ms));
    let usual = holes.first()?.usual_ms;
    Some(format!(
        "frames are missing from {}, where one should come every {usual:.4} ms: no metric is read across such a gap",
        listed(times)
    ))
}

/// How beats were searched, in words.
pub(super) fn of_search(stimuli: Option<&[f64]>, least: f64, unit: &str) -> String {
    match stimuli {
        Some(stimuli) => format!("the pulse after each of {} stimuli", stimuli.len()),
        None => format!(
            "pulses higher than {least:.4} {unit}, which noise does not reach, and than a fifth of the usual one"
        ),
    }
}

/// The time over which the slopes of upstrokes were read, in words.
pub(super) fn of_upstrokes(beats: &[CurveBeat]) -> String {
    median_of(beats, "upstroke_window").map_or_else(String::new, |window| {
        format!("the upstroke's slope over {window:.2} ms, chosen by the steepness of the upstroke")
    })
}

fn median_of(beats: &[CurveBeat], name: &str) -> Option<f64> {
    median(beats.iter().filter_map(|beat| value(&beat.metrics, name)))
}

/// Doubt about the kind of a curve whose pulses point the other way.
pub(super) fn on_direction(kind: Kind, rises: bool) -> String {
    format!(
        "the curve's pulses point {}, but {} {} in a beat: is its kind right?",
        if rises { "downward" } else { "upward" },
        kind.name(),
        if rises { "rises" } else { "falls" },
    )
}

/// Doubts about what frames `step` ms apart can show.
pub(super) fn on_sampling(beats: &[CurveBeat], kind: Kind, step: f64) -> Vec<String> {
    let mut doubts = Vec::new();
    if let Some(rise) = median(beats.iter().filter_map(|beat| rise_time(&beat.metrics)))
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
    if let Some(interval) = median_of(beats, "interval")
        && !(INTERVALS_MS[0]..=INTERVALS_MS[1]).contains(&interval)
    {
        doubts.push(format!(
            "beats come every {interval:.4} ms, which is implausible for a heart cell: is the frame rate, or the unit of time, right?"
        ));
    }
    doubts
}

fn rise_time(metrics: &[Metric]) -> Option<f64> {
    value(metrics, "rise_time_10_90").or_else(|| value(metrics, "tension_rise_time_10_90"))
}
