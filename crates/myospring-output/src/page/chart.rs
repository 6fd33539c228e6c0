//! Charts over time, thinned to the samples that a screen can show.

use crate::digits::rounded;
use crate::figure::{DrawnFit, DrawnTension, Measured, around, shown};
use myospring_core::analysis::curve::{Analysis, Mark, State};
use myospring_core::analysis::kind::Family;
use serde::Serialize;

/// Numbers in all charts of a page together.
const ALL: usize = 120_000;
/// Samples of a curve beyond which it is thinned, and to which it is at least.
const MOST: usize = 4000;
const LEAST: usize = 300;

/// One quantity over time: of one cell or of several, measured or simulated.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Chart {
    /// The quantity.
    pub name: String,
    /// Its unit.
    pub unit: String,
    /// How to read the chart, a few words; empty where that is clear.
    pub note: String,
    /// A band of values behind the curves.
    pub band: Option<[f64; 2]>,
    /// The curves.
    pub series: Vec<Series>,
    /// Stimuli that were captured, or may have been, ms.
    pub stimuli_ms: Vec<f64>,
    /// Stimuli that were not, ms.
    pub missed_ms: Vec<f64>,
    /// Highlighted intervals.
    pub spans: Vec<Span>,
    /// Marked points of the curve.
    pub dots: Vec<Dot>,
}

/// A curve.
#[derive(Debug, Clone, PartialEq)]
pub struct Series {
    /// Its run or quantity.
    pub label: String,
    /// Its colour, by what it shows.
    pub tone: Tone,
    /// Points without a line: what was measured.
    pub dotted: bool,
    /// Times, ms.
    pub times_ms: Vec<f64>,
    /// Values; what is not finite is a gap.
    pub values: Vec<f64>,
}

/// What a curve shows, which gives its colour.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Tone {
    /// Membrane potential.
    Potential,
    /// Tension or force.
    Tension,
    /// Shortening, length and other motion.
    Shortening,
    /// Calcium, and other signals of a cell model.
    Signal,
    /// Measured samples of a fit.
    Measured,
    /// Measured samples before processing.
    Raw,
    /// Samples that were left out.
    Out,
    /// The n-th of several runs.
    Run(usize),
}

/// A highlighted interval.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Span {
    /// First time, ms.
    pub from_ms: f64,
    /// Last time, ms.
    pub to_ms: f64,
    /// What it is: `artefact, left out`.
    pub words: &'static str,
}

/// A place on a curve.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Dot {
    /// Time, ms.
    pub t_ms: f64,
    /// Value.
    pub value: f64,
    /// Its label; empty where labels would overlap.
    pub words: String,
    /// Where the words are.
    pub side: Side,
    /// Whether it counts; others are grey.
    pub counts: bool,
}

/// Where the words of a place are.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Left of it.
    Left,
    /// Right of it.
    Right,
    /// Above it, or below where it is low on the chart.
    Out,
}

/// Beats that are numbered, at most.
const NUMBERED: usize = 40;

impl Chart {
    /// A measured curve with what was read of it (beats by their number, onsets, artefacts, missing frames), and one beat
    /// with the places where its metrics were read.
    pub fn of_curve(curve: &Measured) -> Vec<Self> {
        let analysis = curve.analysis;
        let mut whole = Self::between(curve, [f64::NEG_INFINITY, f64::INFINITY]);
        whole.note = notes(curve).join("; ");
        let few = analysis.beats.len() <= NUMBERED;
        for beat in &analysis.beats {
            let counts = matches!(beat.state, State::Whole | State::CutAtEnd);
            let number = beat.number.to_string();
            let marks = beat.marks.iter().filter(|mark| matches!(mark.name, "peak" | "onset"));
            whole.dots.extend(marks.map(|mark| {
                let words = if few && mark.name == "peak" { number.clone() } else { String::new() };
                Dot { words, counts, ..dot(mark) }
            }));
        }
        let one = shown(analysis).and_then(|beat| Some((beat, around(beat)?)));
        let one = one.map(|(beat, span)| Self {
            name: format!("Beat {}", beat.number),
            note: "dots: where its metrics were read".to_owned(),
            dots: {
                let within = |mark: &&Mark| (span[0]..=span[1]).contains(&mark.point.time);
                beat.marks.iter().filter(within).map(dot).collect()
            },
            ..Self::between(curve, span)
        });
        [Some(whole), one].into_iter().flatten().collect()
    }

    /// A part of a measured curve. Samples of artefacts and bad frames are left out, so that they do not make the beats
    /// small.
    fn between(curve: &Measured, [from, to]: [f64; 2]) -> Self {
        let Analysis { beats, treatment, read, .. } = curve.analysis;
        let within = |time: &f64| (from..=to).contains(time);
        let good = |frame: usize, time: f64| {
            let mut artefacts = treatment.artefacts.iter();
            !treatment.bad_frames.contains(&(frame + 1))
                && !artefacts.any(|artefact| (artefact.from_ms..=artefact.to_ms).contains(&time))
        };
        let samples =
            || curve.times_ms.iter().copied().enumerate().filter(|(_, time)| within(time));
        let series = |label: &str, tone, values: &dyn Fn(usize, f64) -> f64| Series {
            label: label.to_owned(),
            tone,
            dotted: false,
            times_ms: samples().map(|(_, time)| time).collect(),
            values: samples().map(|(frame, time)| values(frame, time)).collect(),
        };
        let tone = match curve.kind.family() {
            Family::Contraction => Tone::Shortening,
            Family::Tension => Tone::Tension,
            Family::Calcium => Tone::Signal,
            Family::ActionPotential => Tone::Potential,
        };
        let measured = |frame: usize, time| {
            if good(frame, time) { curve.values[frame] } else { f64::NAN }
        };
        let mut lines = vec![series("as read", tone, &|frame, _| read[frame])];
        if curve.values != read.as_slice() {
            lines.insert(0, series("as measured", Tone::Raw, &measured));
        }
        let span = |from_ms, to_ms, words| Span { from_ms, to_ms, words };
        let artefacts = treatment.artefacts.iter().map(|it| span(it.from_ms, it.to_ms, "artefact"));
        let holes = treatment.holes.iter().map(|it| span(it.from_ms, it.to_ms, "no frames"));
        let stimuli = |missed: bool| {
            let of = beats.iter().filter(move |beat| (beat.state == State::Missed) == missed);
            of.filter_map(|beat| beat.stimulus_ms).filter(within).collect()
        };
        Self {
            name: curve.title.to_owned(),
            unit: curve.unit.to_owned(),
            series: lines,
            stimuli_ms: stimuli(false),
            missed_ms: stimuli(true),
            spans: artefacts
                .chain(holes)
                .filter(|it| it.to_ms >= from && it.from_ms <= to)
                .collect(),
            ..Self::default()
        }
    }

    /// A tension that a curve asks for, with its band.
    pub fn of_tension(drawn: &DrawnTension) -> Self {
        let DrawnTension { times_ms, tension_kpa, band_kpa: [low, high], stimuli_ms, .. } = drawn;
        let series = |label: &str, tone, values: &[f64]| Series {
            label: label.to_owned(),
            tone,
            dotted: false,
            times_ms: times_ms.clone(),
            values: values.to_vec(),
        };
        Self {
            name: "Tension of the curve".to_owned(),
            unit: "kPa".to_owned(),
            note: "between the thin lines: 95 % band".to_owned(),
            series: vec![
                series("lower end", Tone::Raw, low),
                series("upper end", Tone::Raw, high),
                series("tension", Tone::Tension, tension_kpa),
            ],
            stimuli_ms: stimuli_ms.clone(),
            ..Self::default()
        }
    }

    /// A measured curve with the one that was fitted to it, and below it the residual.
    pub fn of_fit(curve: &DrawnFit, several: bool) -> [Self; 2] {
        let DrawnFit { label, unit, times_ms, measured, fitted, used, noise, .. } = curve;
        let series = |label: &str, tone, dotted, values| Series {
            label: label.to_owned(),
            tone,
            dotted,
            times_ms: times_ms.clone(),
            values,
        };
        let counted = |values: Vec<f64>, wanted: bool| -> Vec<f64> {
            let values = values.into_iter().zip(used);
            values.map(|(value, used)| if *used == wanted { value } else { f64::NAN }).collect()
        };
        let residual =
            measured.iter().zip(fitted).map(|(measured, fitted)| measured - fitted).collect();
        let left_out = used.contains(&false);
        let mut lines =
            vec![series("measured", Tone::Measured, true, counted(measured.clone(), true))];
        if left_out {
            lines.push(series("left out", Tone::Out, true, counted(measured.clone(), false)));
        }
        lines.push(series("fitted", Tone::Shortening, false, fitted.clone()));
        let name = match label.rsplit_once(" (") {
            Some((name, _)) if !unit.is_empty() => name,
            _ => label,
        };
        let orange = if left_out { ", orange dots: left out" } else { "" };
        let above = Self {
            name: name.to_owned(),
            unit: unit.clone(),
            note: format!("dots: measured, line: fitted{orange}"),
            series: lines,
            stimuli_ms: curve.stimuli_ms.clone(),
            ..Self::default()
        };
        let below = Self {
            name: if several { format!("{name}, residual") } else { "Residual".to_owned() },
            note: "measured \u{2212} fitted, grey: noise".to_owned(),
            band: Some([-noise, *noise]),
            series: vec![series("residual", Tone::Measured, true, counted(residual, true))],
            ..above.clone()
        };
        [above, below]
    }
}

/// A point where a metric was read; the steepest points have no label.
fn dot(mark: &Mark) -> Dot {
    let (words, side) = match mark.name.split_once(" % ") {
        Some((part, "up")) => (format!("{part} %"), Side::Left),
        Some((part, "down")) => (format!("{part} % back"), Side::Right),
        _ if matches!(mark.name, "peak" | "onset") => (mark.name.to_owned(), Side::Out),
        _ => (String::new(), Side::Out),
    };
    Dot { t_ms: mark.point.time, value: mark.point.value, words, side, counts: true }
}

/// How to read the chart of a measured curve.
fn notes(curve: &Measured) -> Vec<&'static str> {
    let Analysis { beats, treatment, read, .. } = curve.analysis;
    let mut notes = vec!["dots: onset and peak"];
    notes.extend((curve.values != read.as_slice()).then_some("grey: as measured"));
    notes.extend((!treatment.artefacts.is_empty()).then_some("shaded: artefacts, left out"));
    notes.extend((!treatment.holes.is_empty()).then_some("shaded: frames are missing"));
    let missed = beats.iter().any(|beat| beat.state == State::Missed);
    notes.extend(missed.then_some("\u{25bd} stimulus without a beat"));
    notes
}

/// Times of curves, each list once, and which of their samples are drawn.
#[derive(Debug, Default)]
pub(super) struct Times<'a> {
    lists: Vec<(&'a [f64], Vec<&'a [f64]>)>,
    kept: Vec<Vec<usize>>,
}

#[derive(Debug, Serialize)]
pub(super) struct ChartData<'a> {
    name: &'a str,
    unit: &'a str,
    note: &'a str,
    band: Option<[f64; 2]>,
    series: Vec<SeriesData<'a>>,
    stimuli_ms: &'a [f64],
    missed_ms: &'a [f64],
    spans: &'a [Span],
    dots: &'a [Dot],
}

#[derive(Debug, Serialize)]
struct SeriesData<'a> {
    label: &'a str,
    tone: String,
    dotted: bool,
    /// Which of the lists of times.
    times: usize,
    values: Vec<f64>,
}

impl<'a> Times<'a> {
    /// The times of all charts of a page, thinned so that they fit together.
    pub(super) fn of(charts: impl Iterator<Item = &'a Chart>) -> Self {
        let mut lists: Vec<(&[f64], Vec<&[f64]>)> = Vec::new();
        for series in charts.flat_map(|chart| &chart.series) {
            match lists.iter_mut().find(|(times, _)| *times == series.times_ms) {
                Some((_, values)) => values.push(&series.values),
                None => lists.push((&series.times_ms, vec![&series.values])),
            }
        }
        let numbers: usize = lists.iter().map(|(_, values)| 1 + values.len()).sum();
        let most = (ALL / numbers.max(1)).clamp(LEAST, MOST);
        let kept = lists.iter().map(|(times, values)| kept(times.len(), values, most)).collect();
        Self { lists, kept }
    }

    /// The lists as a page has them.
    pub(super) fn data(&self) -> Vec<Vec<f64>> {
        let lists = self.lists.iter().zip(&self.kept);
        lists.map(|((times, _), kept)| picked(times, kept)).collect()
    }

    pub(super) fn chart(&self, chart: &'a Chart) -> ChartData<'a> {
        let series = chart.series.iter().map(|series| {
            let times = self.lists.iter().position(|(times, _)| *times == series.times_ms);
            let times = times.unwrap_or_default();
            SeriesData {
                label: &series.label,
                tone: series.tone.word(),
                dotted: series.dotted,
                times,
                values: picked(&series.values, &self.kept[times]),
            }
        });
        let Chart { name, unit, note, band, stimuli_ms, missed_ms, spans, dots, .. } = chart;
        let (series, band) = (series.collect(), *band);
        ChartData { name, unit, note, band, series, stimuli_ms, missed_ms, spans, dots }
    }
}

impl Tone {
    fn word(self) -> String {
        match self {
            Self::Potential => "potential".to_owned(),
            Self::Tension => "tension".to_owned(),
            Self::Shortening => "shortening".to_owned(),
            Self::Signal => "signal".to_owned(),
            Self::Measured => "measured".to_owned(),
            Self::Raw => "raw".to_owned(),
            Self::Out => "out".to_owned(),
            Self::Run(index) => index.to_string(),
        }
    }
}

fn picked(values: &[f64], kept: &[usize]) -> Vec<f64> {
    kept.iter().map(|&at| rounded(values[at])).collect()
}

/// Which samples to keep: all, or the first, last, least and greatest of each curve in each of many stretches.
fn kept(samples: usize, curves: &[&[f64]], most: usize) -> Vec<usize> {
    if samples <= most {
        return (0..samples).collect();
    }
    let stretches = (most / (3 * curves.len() + 2)).max(1);
    let mut kept = Vec::new();
    for stretch in 0..stretches {
        let (start, end) = (stretch * samples / stretches, (stretch + 1) * samples / stretches);
        kept.extend([start, end - 1]);
        for values in curves {
            let by_value = |a: &usize, b: &usize| values[*a].total_cmp(&values[*b]);
            let finite = || (start..end).filter(|&at| values[at].is_finite());
            kept.extend(finite().min_by(by_value));
            kept.extend(finite().max_by(by_value));
            // So that a gap stays one.
            kept.extend((start..end).find(|&at| !values[at].is_finite()));
        }
    }
    kept.sort_unstable();
    kept.dedup();
    kept
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_curves_keep_their_peaks() {
        let values: Vec<f64> = (0..100_000)
            .map(|i| if i == 54_321 { 9.0 } else { (f64::from(i) * 0.01).sin() })
            .collect();
        let kept = kept(100_000, &[&values], MOST);
        assert!(kept.len() <= MOST && kept.contains(&54_321), "{}", kept.len());
        assert_eq!((kept[0], kept[kept.len() - 1]), (0, 99_999));
        assert!(kept.is_sorted());
    }

    #[test]
    fn curves_with_the_same_times_have_them_once_and_all_charts_together_are_bounded() {
        let times: Vec<f64> = (0..20_000).map(f64::from).collect();
        let chart = |shift: f64| {
            let times_ms: Vec<f64> = times.iter().map(|time| time + shift).collect();
            let values = times.iter().map(|time| (0.01 * time).sin()).collect();
            let label = String::new();
            let series = Series { label, tone: Tone::Signal, dotted: false, times_ms, values };
            Chart { series: vec![series.clone(), series], ..Chart::default() }
        };
        let same = [chart(0.0), chart(0.0)];
        assert_eq!(Times::of(same.iter()).data().len(), 1);
        let many: Vec<Chart> = (0..60).map(|index| chart(f64::from(index))).collect();
        let pool = Times::of(many.iter());
        let numbers: usize = pool.data().iter().map(|times| 3 * times.len()).sum();
        assert!(numbers <= ALL, "{numbers}");
    }
}
