//! A measured curve with its beats, and one beat with the points at which its metrics were read.

use super::FigureError;
use super::chart::{Axis, Chart, Curve, ends};
use super::font::text_width;
use super::sheet::{Anchor, Figure, Path, Sheet, Stroke, Style};
use super::theme::{
    CALCIUM, Colour, DOUBLE, HAIR, INK, LABEL, LETTER, MUTED, POTENTIAL, REST, SHORTENING, TENSION,
    TICK,
};
use myospring_core::analysis::curve::{Analysis, CurveBeat, State};
use myospring_core::analysis::kind::{Family, Kind};
use myospring_core::analysis::trace::Point;

/// Recordings longer than this are shown in s, ms.
const LONG: f64 = 3000.0;
/// Height of the recording and of the one beat, px.
const HEIGHTS: [f64; 2] = [120.0, 190.0];
/// Space left of the labels of the plots, and least space left of the plots, px.
const MARGIN: f64 = 18.0;
const LEFT: f64 = 58.0;
/// Colour of raw samples behind smoothed ones.
const RAW: Colour = Colour(0xc4c4c4);
/// Room for labels of peaks and onsets, px.
const ROOM: f64 = 16.0;
/// Largest number of beats that are numbered.
const NUMBERED: usize = 20;

/// A curve and its analysis.
#[derive(Debug, Clone, Copy)]
pub struct Measured<'a> {
    /// Its title.
    pub title: &'a str,
    /// Kind of its values.
    pub kind: Kind,
    /// Their unit.
    pub unit: &'a str,
    /// Times, ms.
    pub times_ms: &'a [f64],
    /// The samples as they were measured.
    pub values: &'a [f64],
    /// Its analysis.
    pub analysis: &'a Analysis,
    /// Numbers listed beside the one beat: name and value.
    pub numbers: &'a [[String; 2]],
}

/// Draws the recording above, and below it one enlarged beat with the points at which its metrics
/// were read, and numbers.
///
/// # Errors
/// A curve without samples.
pub fn measured(curve: &Measured) -> Result<Figure, FigureError> {
    if curve.times_ms.is_empty() || curve.times_ms.len() != curve.values.len() {
        return Err(FigureError::NoSamples { what: format!("the curve `{}`", curve.title) });
    }
    let mut sheet = Sheet::default();
    sheet.text([8.0, 16.0], curve.title, Style::new(LETTER).bold());
    let top = 34.0;
    let below = top + HEIGHTS[0] + 62.0;
    let (first, last) = (curve.times_ms[0], curve.times_ms[curve.times_ms.len() - 1]);
    let scale = if last - first > LONG { 1e-3 } else { 1.0 };
    let mut whole = chart(curve, [first, last], scale, HEIGHTS[0]);
    let mut one = shown(curve.analysis).and_then(|beat| {
        let ends = around(beat)?;
        Some((beat, chart(curve, ends, 1.0, HEIGHTS[1])))
    });
    // Both plots begin right of the widest tick labels.
    let offsets = one.iter().map(|(_, chart)| chart.label_offset()).chain([whole.label_offset()]);
    let left = offsets.fold(LEFT - MARGIN, f64::max) + MARGIN;
    let width = 0.56 * (DOUBLE - left);
    (whole.place, whole.size[0]) = ([left, top], DOUBLE - left - 12.0);
    recording(&mut sheet, curve, &whole, scale);
    if let Some((beat, chart)) = &mut one {
        (chart.place, chart.size[0]) = ([left, below], width);
        one_beat(&mut sheet, curve, beat, chart);
    }
    numbers(&mut sheet, curve, [left + width + 26.0, below - 12.0]);
    Ok(sheet.finish(DOUBLE, below + HEIGHTS[1] + 44.0))
}

/// The beat that is shown: the first complete one.
pub(crate) fn shown(analysis: &Analysis) -> Option<&CurveBeat> {
    let with_marks = || analysis.beats.iter().filter(|beat| !beat.marks.is_empty());
    with_marks().find(|beat| beat.state == State::Whole).or_else(|| with_marks().next())
}

pub(super) fn colour(kind: Kind) -> Colour {
    match kind.family() {
        Family::Contraction => SHORTENING,
        Family::Tension => TENSION,
        Family::Calcium => CALCIUM,
        Family::ActionPotential => POTENTIAL,
    }
}

/// Label of the axis of a quantity.
pub(super) fn label(kind: Kind, unit: &str) -> String {
    let name = match kind {
        Kind::Unknown => "value",
        Kind::Length => "length",
        kind => kind.name(),
    };
    let mut letters = name.chars();
    let first = letters.next().map(|letter| letter.to_uppercase().to_string()).unwrap_or_default();
    match unit {
        "" => format!("{first}{}", letters.as_str()),
        unit => format!(
            "{first}{} ({})",
            letters.as_str(),
            unit.replace("um", "\u{b5}m").replace("uM", "\u{b5}M")
        ),
    }
}

/// The chart of the curve between two times; place and width are set later.
fn chart(curve: &Measured, [from, to]: [f64; 2], scale: f64, height: f64) -> Chart {
    let samples = || curve.times_ms.iter().zip(curve.values).zip(&curve.analysis.read);
    let within = || samples().filter(|((time, _), _)| (from..=to).contains(*time));
    let x = Axis::time([from * scale, to * scale]);
    let x = if scale < 1.0 { Axis { label: "Time (s)".to_owned(), ..x } } else { x };
    // Bad frames and artefacts may lie outside the plot.
    let treatment = &curve.analysis.treatment;
    let bad: Vec<f64> =
        treatment.bad_frames.iter().map(|frame| curve.times_ms[frame - 1]).collect();
    let is_artefact =
        |time: f64| treatment.artefacts.iter().any(|it| (it.from_ms..=it.to_ms).contains(&time));
    let good = |time: &f64, value: &f64| {
        if bad.contains(time) || is_artefact(*time) { f64::NAN } else { *value }
    };
    let [low, high] = ends(within().flat_map(|((time, value), read)| [good(time, value), *read]));
    // Room for the labels of peaks and onsets.
    let room = ROOM / height * (high - low);
    let [low, high] = [low - room, high + room];
    let y = Axis::upright(&label(curve.kind, curve.unit), [low, high], height);
    let raw = within().map(|((time, value), _)| [time * scale, good(time, value)]);
    let read = within().map(|((time, _), read)| [time * scale, *read]);
    let mut curves = Vec::new();
    if curve.values != curve.analysis.read {
        curves.push(Curve::solid(raw.collect(), RAW));
    }
    curves.push(Curve::solid(read.collect(), colour(curve.kind)));
    let beats = curve.analysis.beats.iter().filter(|beat| beat.state != State::Missed);
    let stimuli = beats.filter_map(|beat| beat.stimulus_ms);
    let marks = stimuli.map(|time| time * scale).collect();
    Chart { marks, ..Chart::new(0.0, height, [x, y], curves) }
}

fn recording(sheet: &mut Sheet, curve: &Measured, chart: &Chart, scale: f64) {
    let Chart { place, size, .. } = *chart;
    chart.draw(sheet, chart.label_offset());
    let at = |point: Point| chart.at([point.time * scale, point.value]);
    let rises = curve.analysis.treatment.rises;
    let few = curve.analysis.beats.len() <= NUMBERED;
    for beat in &curve.analysis.beats {
        if let Some(ends) = beat.baseline {
            sheet.path(Path::line(ends.map(at)), Stroke::new(MUTED, HAIR).dash(3.0, 2.0));
        }
        let counts = matches!(beat.state, State::Whole | State::CutAtEnd | State::Missed);
        let dot = if counts { INK } else { REST };
        for mark in beat.marks.iter().filter(|mark| mark.name == "peak" || mark.name == "onset") {
            let [x, y] = at(mark.point);
            sheet.dot([x, y], dot);
            if mark.name == "peak" && few {
                let y = if rises { y - 6.0 } else { y + 14.0 };
                let style = Style::new(TICK).anchor(Anchor::Middle).colour(MUTED);
                sheet.text([x, y], &beat.number.to_string(), style);
            }
        }
    }
    let missed = curve.analysis.beats.iter().filter(|beat| beat.state == State::Missed);
    let missed: Vec<f64> =
        missed.filter_map(|beat| beat.stimulus_ms).map(|time| time * scale).collect();
    chart.draw_missed(sheet, &missed, "no beat");
    for artefact in &curve.analysis.treatment.artefacts {
        let [from, to] = [artefact.from_ms, artefact.to_ms]
            .map(|time| chart.at([time * scale, 0.0])[0].clamp(place[0], place[0] + size[0]));
        let y = place[1] + 2.0;
        // Wide enough to be visible.
        let to = to.max(from + 2.0);
        sheet.path(Path::line([[from, y], [to, y]]), Stroke::new(TENSION, 3.0));
    }
    let mut notes = Vec::new();
    if !curve.analysis.treatment.artefacts.is_empty() {
        notes.push("red bars: artefacts, left out");
    }
    if curve.values != curve.analysis.read {
        notes.push("grey: as measured");
    }
    notes.push("dots: onset and peak");
    notes.push("dashed: baseline");
    let style = Style::new(TICK).anchor(Anchor::End).colour(MUTED);
    sheet.text([place[0] + size[0], place[1] - 8.0], &notes.join("; "), style);
}

/// Range in which the one beat is shown: after its fall, as long again as it takes to fall, within
/// the recording.
pub(crate) fn around(beat: &CurveBeat) -> Option<[f64; 2]> {
    let [start, end] = beat.baseline?;
    let onset = beat.onset_ms.unwrap_or(start.time);
    let fallen = beat.marks.iter().find(|mark| mark.name == "90 % down");
    let fallen = fallen.map_or(end.time, |mark| mark.point.time);
    let to = (fallen + 0.35 * (fallen - onset)).min(end.time);
    Some([start.time.max(onset - 0.25 * (to - onset)), to])
}

fn one_beat(sheet: &mut Sheet, curve: &Measured, beat: &CurveBeat, chart: &Chart) {
    let Some([start, end]) = beat.baseline else { return };
    let Some([from, to]) = around(beat) else { return };
    let Chart { place, size, .. } = *chart;
    chart.draw(sheet, chart.label_offset());
    let at = |point: Point| chart.at([point.time, point.value]);
    let base = |time: f64| {
        start.value + (end.value - start.value) * (time - start.time) / (end.time - start.time)
    };
    let line = [from, to].map(|time| at(Point { time, value: base(time) }));
    sheet.path(Path::line(line), Stroke::new(MUTED, HAIR).dash(3.0, 2.0));
    let down = !curve.analysis.treatment.rises;
    for mark in &beat.marks {
        let [x, y] = at(mark.point);
        if !(place[0]..=place[0] + size[0]).contains(&x) {
            continue;
        }
        let above = if down { y + 15.0 } else { y - 8.0 };
        let below = if down { y - 8.0 } else { y + 15.0 };
        // A label, its position, and the side of its dot; if it does not fit into the plot, it is
        // put on the other side.
        let (text, anchor, [x_text, y_text], other) = match mark.name {
            "10 % up" => ("10 %", Anchor::End, [x - 7.0, y + 3.5], y + 3.5),
            "50 % up" => ("50 %", Anchor::End, [x - 7.0, y + 3.5], y + 3.5),
            "90 % up" => ("90 %", Anchor::End, [x - 7.0, y + 3.5], y + 3.5),
            "50 % down" => ("50 % back", Anchor::Start, [x + 7.0, y + 3.5], below),
            "90 % down" => ("90 % back", Anchor::Start, [x + 5.0, above], below),
            "peak" => ("peak", Anchor::Middle, [x, above], above),
            "onset" => ("onset", Anchor::End, [x - 4.0, below], below),
            _ => {
                tangent(sheet, curve, chart, mark.point);
                continue;
            }
        };
        let width = text_width(text, TICK);
        let [left, right] = [place[0] + 2.0, place[0] + size[0]];
        let (anchor, x_text, y_text) = match anchor {
            Anchor::Start if x_text + width > right => (Anchor::End, 2.0 * x - x_text, other),
            Anchor::End if x_text - width < left => (Anchor::Start, 2.0 * x - x_text, other),
            Anchor::Middle => {
                let half = 0.5 * width;
                (anchor, x_text.clamp(left + half, (right - half).max(left + half)), y_text)
            }
            _ => (anchor, x_text, y_text),
        };
        sheet.dot([x, y], INK);
        sheet.text([x_text, y_text], text, Style::new(TICK).anchor(anchor).colour(MUTED));
    }
    let title = format!("Beat {}: where its metrics were read; short lines: steepest", beat.number);
    sheet.text([place[0], place[1] - 12.0], &title, Style::new(LABEL));
}

/// A short line along the curve at its steepest.
fn tangent(sheet: &mut Sheet, curve: &Measured, chart: &Chart, point: Point) {
    let right = curve.times_ms.partition_point(|time| *time < point.time);
    let right = right.clamp(1, curve.times_ms.len() - 1);
    let ends = [right - 1, right].map(|i| chart.at([curve.times_ms[i], curve.analysis.read[i]]));
    let way = [0, 1].map(|axis| ends[1][axis] - ends[0][axis]);
    let length = way[0].hypot(way[1]).max(f64::MIN_POSITIVE);
    let [x, y] = chart.at([point.time, point.value]);
    let half = way.map(|part| 16.0 * part / length);
    let line = [[x - half[0], y - half[1]], [x + half[0], y + half[1]]];
    sheet.path(Path::line(line), Stroke::new(INK, 1.2).round_ends());
}

fn numbers(sheet: &mut Sheet, curve: &Measured, [left, top]: [f64; 2]) {
    let right = DOUBLE - 12.0;
    let mut y = top;
    sheet.text([left, y], "Mean \u{b1} SD over beats", Style::new(LABEL).bold());
    for [name, value] in curve.numbers {
        y += 16.0;
        sheet.text([left, y], name, Style::new(TICK));
        let style = Style::new(TICK).anchor(Anchor::End);
        let room = right - left - text_width(name, TICK) - 6.0;
        if text_width(value, TICK) > room {
            y += 12.0;
        }
        sheet.text([right, y], value, style);
    }
}

#[cfg(test)]
mod tests {
    use super::super::theme::MISSED;
    use super::*;
    use myospring_core::analysis::curve::{CurveOptions, analyse};

    fn drawn(kind: Kind, unit: &'static str, beat: [f64; 3], scale: f64) -> Figure {
        let [cycle, up, back] = beat;
        let times: Vec<f64> = (0..1500).map(|frame| 4.0 * f64::from(frame)).collect();
        let value = |time: &f64| {
            let phase = (time + 0.3 * cycle) % cycle - 0.3 * cycle;
            let rise = (phase / up).clamp(0.0, 1.0);
            let fall = (1.0 - (phase - up) / back).clamp(0.0, 1.0);
            let pulse = if phase < up { rise } else { fall };
            if kind.rises() == Some(false) { scale * (10.0 - pulse) } else { scale * (1.0 + pulse) }
        };
        let values: Vec<f64> = times.iter().map(value).collect();
        let analysis = analyse(&times, &values, kind, unit, &CurveOptions::default()).unwrap();
        measured(&Measured {
            title: "cell",
            kind,
            unit,
            times_ms: &times,
            values: &values,
            analysis: &analysis,
            numbers: &[],
        })
        .unwrap()
    }

    #[test]
    fn words_beside_a_beat_stay_in_its_panel_whichever_way_it_goes_and_however_soon_the_next_one_comes()
     {
        // A beat that has just come to rest, and one that rests long.
        for beat in [[500.0, 60.0, 425.0], [800.0, 100.0, 600.0], [1000.0, 60.0, 100.0]] {
            for (kind, unit) in [(Kind::Length, "um"), (Kind::Calcium, "uM")] {
                let figure = drawn(kind, unit, beat, 1.0);
                let right = LEFT + 0.56 * (DOUBLE - LEFT);
                let names = ["50 % back", "90 % back", "peak", "onset", "10 %", "50 %", "90 %"];
                let mut beyond = figure.beyond([LEFT, right]);
                beyond.retain(|(text, _)| names.contains(&text.as_str()));
                assert!(beyond.is_empty(), "{kind} {beat:?}: {beyond:?}");
            }
        }
    }

    #[test]
    fn a_stimulus_that_no_beat_follows_has_a_colour_of_its_own() {
        let times: Vec<f64> = (0..1500).map(|frame| 4.0 * f64::from(frame)).collect();
        let pulse = |t: f64| (t / 80.0).min((300.0 - t) / 220.0).max(0.0);
        let beats = [0.0, 1.0, 3.0, 4.0, 5.0].map(|second| 1e3 * second + 210.0);
        let value = |t: &f64| 1.0 + beats.iter().map(|begin| pulse(t - begin)).fold(0.0, f64::max);
        let values: Vec<f64> = times.iter().map(value).collect();
        let of = |stimuli: &[f64]| {
            let options = CurveOptions { stimuli_ms: stimuli.to_vec(), ..CurveOptions::default() };
            let analysis = analyse(&times, &values, Kind::Calcium, "uM", &options).unwrap();
            let curve = Measured {
                title: "cell",
                kind: Kind::Calcium,
                unit: "uM",
                times_ms: &times,
                values: &values,
                analysis: &analysis,
                numbers: &[],
            };
            let svg = measured(&curve).unwrap().to_svg();
            let of_missed = MISSED.to_string();
            (svg.matches("no beat").count(), svg.matches(&of_missed).count())
        };
        assert_eq!(of(&beats), (0, 0));
        // The line and its name.
        assert_eq!(of(&[200.0, 1200.0, 2200.0, 3200.0, 4200.0, 5200.0]), (1, 2));
    }

    #[test]
    fn no_label_is_clipped_however_large_or_small_the_numbers() {
        for scale in [1e-9, 1e-6, 1e-3, 1.0, 1e3, 1e5, 1e9] {
            for (kind, unit) in [(Kind::Length, "um"), (Kind::Force, "nN"), (Kind::Unknown, "")] {
                let figure = drawn(kind, unit, [800.0, 100.0, 300.0], scale);
                assert_eq!(figure.beyond([0.0, DOUBLE]), [], "{kind} {scale}");
            }
        }
    }
}
