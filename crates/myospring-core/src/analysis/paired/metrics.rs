//! Metrics of a beat in both curves, and what is odd about them.

use super::answer::{Direction, Paired, PairedBeat};
use super::course::{Course, Loop};
use super::recorded::Recorded;
use crate::analysis::curve::{CurveBeat, State};
use crate::analysis::kind::{Family, Kind};
use crate::analysis::rows::row;
use crate::analysis::{Metric, Missing, Reading, value};

/// Times the standard error beyond which a mean differs from 0.
const SURE: f64 = 2.0;

/// Standard deviation of the delays, as a part of the interval between beats, above which the curves may not belong
/// together.
const UNSTEADY: f64 = 0.1;

/// Definitions of the metrics, for shortening or tension.
struct Definitions {
    onset: &'static str,
    half_rise: &'static str,
    peak: &'static str,
    half_fall: &'static str,
    at_rise: &'static str,
    at_fall: &'static str,
    part_at_rise: &'static str,
    part_at_fall: &'static str,
    area: &'static str,
    part: &'static str,
}

macro_rules! definitions {
    ($motion:literal) => {
        Definitions {
            onset: concat!("from the onset of calcium to that of the ", $motion),
            half_rise: concat!(
                "from half of the rise of calcium to half of the rise of the ",
                $motion
            ),
            peak: concat!("from the peak of calcium to that of the ", $motion),
            half_fall: concat!(
                "from half of the decay of calcium to half of the fall of the ",
                $motion
            ),
            at_rise: concat!("calcium when the ", $motion, " has risen to half of its peak"),
            at_fall: concat!("calcium when the ", $motion, " has fallen to half of its peak"),
            part_at_rise: concat!(
                "the same above the level at rest, of the amplitude of calcium, where the ",
                $motion,
                " rises"
            ),
            part_at_fall: concat!(
                "the same above the level at rest, of the amplitude of calcium, where the ",
                $motion,
                " falls"
            ),
            area: concat!(
                "area of the loop of ",
                $motion,
                " over calcium; above 0 counter-clockwise: the ",
                $motion,
                " follows calcium"
            ),
            part: "area of the loop, of the product of both amplitudes",
        }
    };
}

const SHORTENING: Definitions = definitions!("shortening");
const TENSION: Definitions = definitions!("tension");

/// The metrics of a beat; without a value if it does not count.
pub(super) fn of_beat(
    courses: [&Course; 2],
    beats: [&CurveBeat; 2],
    course: Result<&Loop, &Missing>,
    counts: bool,
) -> Vec<Metric> {
    let [calcium, motion] = courses;
    let words = if motion.kind.family() == Family::Tension { &TENSION } else { &SHORTENING };
    let mark = |side: usize, name: &str| -> Reading {
        let mark = beats[side].marks.iter().find(|mark| mark.name == name);
        mark.map(|mark| mark.point.time).ok_or(Missing::NotReached)
    };
    let delay = |name: &str| -> Reading { Ok(mark(1, name)? - mark(0, name)?) };
    let level = |name: &str| -> Reading { Ok(calcium.at(mark(1, name)?)) };
    let part = |name: &str| -> Reading {
        let ends = beats[0].baseline.ok_or(Missing::NoRise)?;
        let height = |time| calcium.height(beats[0], ends, time);
        Ok(100.0 * height(mark(1, name)?) / calcium.amplitude(beats[0])?.abs())
    };
    let area = || course.map_err(|why| *why);
    let mut metrics = vec![
        row("delay_of_onset", delay("onset"), "ms", words.onset),
        row("delay_of_half_rise", delay("50 % up"), "ms", words.half_rise),
        row("delay_of_peak", delay("peak"), "ms", words.peak),
        row("delay_of_half_fall", delay("50 % down"), "ms", words.half_fall),
        row("calcium_at_half_rise", level("50 % up"), calcium.unit, words.at_rise),
        row("calcium_at_half_fall", level("50 % down"), calcium.unit, words.at_fall),
        row("relative_calcium_at_half_rise", part("50 % up"), "%", words.part_at_rise),
        row("relative_calcium_at_half_fall", part("50 % down"), "%", words.part_at_fall),
        row("loop_area", area().map(Loop::area), product(calcium.unit, motion.unit), words.area),
        row(
            "relative_loop_area",
            area().and_then(|course| {
                let [own, other] = [calcium.amplitude(beats[0])?, motion.amplitude(beats[1])?];
                Ok(100.0 * course.area() / (own * other).abs())
            }),
            "%",
            words.part,
        ),
    ];
    if !counts {
        let lost = beats.iter().find_map(|beat| match beat.state {
            State::Interrupted => Some(Missing::Hole),
            State::Disturbed => Some(Missing::Artefact),
            State::CutAtStart => Some(Missing::Cut),
            _ => None,
        });
        for metric in &mut metrics {
            metric.lose(lost.unwrap_or(Missing::NotRecorded));
        }
    }
    metrics
}

/// The product of a unit of calcium and one of motion.
fn product(calcium: &str, motion: &'static str) -> &'static str {
    match (calcium, motion) {
        ("", motion) => motion,
        ("uM", "%") => "uM %",
        ("uM", "um") => "uM um",
        ("uM", "px") => "uM px",
        ("uM", "kPa") => "uM kPa",
        ("uM", "nN") => "uM nN",
        ("uM", "") => "uM",
        _ => "a.u.",
    }
}

/// Mean and standard deviation of values; `None` of fewer than two.
fn spread(values: &[f64]) -> Option<[f64; 2]> {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let squares: f64 = values.iter().map(|value| (value - mean).powi(2)).sum();
    (values.len() > 1).then(|| [mean, (squares / (count - 1.0)).sqrt()])
}

/// Which way round the loops go, if noise and differences between beats allow to say so.
pub(super) fn direction(paired: &Paired) -> Direction {
    let Some(mean) = &paired.mean_loop else { return Direction::Unknown };
    let areas: Vec<f64> = paired.loops.iter().map(|(_, one)| one.area()).collect();
    let area = areas.iter().sum::<f64>() / areas.len() as f64;
    let between =
        spread(&areas).map_or(0.0, |[_, deviation]| deviation / (areas.len() as f64).sqrt());
    if area.abs() <= SURE * mean.area_error.max(between) {
        Direction::Unknown
    } else if area > 0.0 {
        Direction::CounterClockwise
    } else {
        Direction::Clockwise
    }
}

/// What is odd about two curves of the same beats, as sentences.
pub(super) fn remarks(paired: &Paired, calcium: &Recorded, motion: &Recorded) -> Vec<String> {
    let mut remarks = Vec::new();
    let name = motion.kind.name();
    if calcium.kind != Kind::Calcium {
        remarks.push(format!(
            "the curve of calcium is a {} without calibration: its levels at half of the motion are not concentrations, and a dye \
             follows calcium with a delay of its own",
            calcium.kind.name()
        ));
    }
    let alone =
        |side: fn(&PairedBeat) -> bool| paired.beats.iter().filter(|beat| side(beat)).count();
    let only = [
        ("calcium", alone(|beat| beat.motion_beat.is_none())),
        (name, alone(|beat| beat.calcium_beat.is_none())),
    ];
    for (name, count) in only.into_iter().filter(|(_, count)| *count > 0) {
        let all = paired.beats.len();
        remarks.push(format!("{count} of {all} beats: found in {name} only, left out of pairs"));
    }
    let counted: Vec<&PairedBeat> = paired.beats.iter().filter(|beat| beat.counts).collect();
    let delays: Vec<f64> =
        counted.iter().filter_map(|beat| value(&beat.metrics, "delay_of_onset")).collect();
    let Some(mean) = paired.mean("delay_of_onset") else { return remarks };
    let slower = Course::of(calcium).step.max(Course::of(motion).step);
    let error =
        spread(&delays).map_or(0.0, |[_, deviation]| deviation / (delays.len() as f64).sqrt());
    if mean < -slower.max(SURE * error) {
        remarks.push(format!(
            "the onset of {name} comes {:.0} ms before that of calcium: check that both curves have one clock, and their \
             kinds",
            -mean
        ));
    } else if mean.abs() < slower {
        remarks.push(format!(
            "the delay of the onset, {mean:.1} ms, is shorter than the {slower:.1} ms between frames: it is interpolated \
             between them; the delay of the half rise has less error"
        ));
    }
    let onsets: Vec<f64> = calcium.analysis.beats.iter().filter_map(|beat| beat.onset_ms).collect();
    let interval = crate::analysis::order::median(onsets.windows(2).map(|pair| pair[1] - pair[0]));
    if let (Some([_, deviation]), Some(interval)) = (spread(&delays), interval)
        && deviation > (UNSTEADY * interval).max(slower)
    {
        remarks.push(format!(
            "the delay of the onset differs by {deviation:.0} ms (SD) between beats: check that both curves were recorded \
             together"
        ));
    }
    remarks
}
